//! Which pairs of nodes are summed point by point, which through Chebyshev grids, and which are too small to count.
//!
//! Why no sum S at a point, B_q or A_t, errs by more than tol S. Let L <= S be the lower bound of both nodes' sums
//! (`Floor`), and recall that the weights of the other side add up to one. Every pair of points is in exactly one pair of
//! nodes of the plan, which is of one of these kinds:
//!
//! 1. Left out: E <= tol/2 L for all pairs of points, by the least distance of their boxes, nodes or blocks of a tile.
//! 2. On grids, measured by the sums: the interpolation errs by at most tol/2 L, being within 2^budget of E between the
//!    centres times the waves (`chebyshev`), and the waves within their height.
//! 3. On grids, measured by E: the interpolation errs by at most tol/2 E, for E falls short of its waves by the dip at
//!    most.
//! 4. Point by point in single precision: its error times the largest E is at most tol/2 L (`single`), with E and L of
//!    blocks of a tile: a few points on either side (`mask`).
//! 5. Point by point in brief: errs by at most `brief::ERROR` of itself, which comes off tol before it is shared out.
//! 6. Point by point: exact.
//!
//! The bounds tol/2 L of kinds 1 and 4 hold each pair to its weight's part of the error; most pairs stay far below theirs.
//! Where there are no grids they are therefore raised to 2^`RAISED` as much at first, and what the pairs may err by is
//! added up (`account`): while that exceeds tol/2 S anywhere, all is planned anew with lower bounds, at last as they are.
//!
//! Kinds 1, 2 and 4 together err by at most sum w tol/2 L <= tol/2 S, kind 3 by sum w tol/2 E <= tol/2 S. A grid's error is
//! shared out: three quarters for the interpolation, a quarter for the rounding that its Lebesgue constants amplify. The
//! derivative's functions are E times at most the slope S' of log E, with errors in the same proportion to S' E or S' L;
//! divided by the sums and summed over the rows this is the bound on `Method`, the other half of it being the error of the
//! sums themselves.

use super::account::{Account, Holder};
use super::bounds::norm;
use super::brief;
use super::chebyshev::{FarPair, Grid, Orders, Wave, lebesgue, nodes};
use super::floor::Floor;
use super::frame::{Frame, frames};
use super::kernel::Kernel;
use super::mask::Mask;
use super::side::Side;
use super::single;
use rayon::prelude::*;

/// Row nodes (of about equal size) that are worked on independently; fixed, so that sums do not depend on threads.
const PANELS: usize = 64;

/// A panel holds up to so many points at least.
const PANEL: usize = 256;

/// What one far pair costs beyond its pairs of nodes, per node and in all, in pairs.
const OVERHEAD_NODE: usize = 12;
const OVERHEAD: usize = 300;

/// Pairs in single precision that cost what one in double precision does.
const SINGLE: usize = 3;

/// Powers of two by which bounds are raised at first, and lowered by as long as they allow too much: on skins a little
/// more than the first passes.
const RAISED: f64 = 4.0;
const LOWERED: f64 = 2.0;

/// The least tolerance with which tiles are summed in brief.
const BRIEF_FROM: f64 = 1e-10;

const LOG2_4_3: f64 = 0.41503749927884376;

/// A pair of nodes and how each side enters: through a grid, or point by point (then it is a leaf).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Pair<G = Via> {
    pub row: u32,
    pub column: u32,
    pub row_grid: Option<G>,
    pub column_grid: Option<G>,
    /// What is summed in double and in single precision. What is in neither is too small to count.
    pub double: Mask,
    pub single: Mask,
    /// In double precision eleven digits are enough, and come from `brief`.
    pub brief: bool,
}

/// A grid of a pair: no finer in any direction than the one that is kept, whose number this is in `Plan`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Via {
    pub kept: u32,
    pub orders: Orders,
}

/// The finest grid that is in use on a node for one wave.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Kept {
    pub node: u32,
    pub wave: Wave,
    pub orders: Orders,
}

/// What a sum may be off by.
#[derive(Clone, Copy, Debug)]
pub(super) struct Accuracy {
    /// Bound of the relative error of every sum.
    pub tolerance: f64,
    /// Grids are used.
    pub far: bool,
    /// Single precision is used.
    pub single: bool,
}

impl Accuracy {
    /// The tolerance is wide enough for tiles in brief, whose error comes off it.
    fn brief(&self) -> bool {
        self.single && self.tolerance >= BRIEF_FROM
    }
}

/// All pairs of nodes to be summed.
#[derive(Debug)]
pub(super) struct Plan {
    /// One list for each panel of rows, sorted.
    pub panels: Vec<Vec<Pair>>,
    /// Sorted by node.
    pub row_grids: Vec<Kept>,
    pub column_grids: Vec<Kept>,
    /// Per node, if there are grids.
    pub row_frames: Vec<Frame>,
    pub column_frames: Vec<Frame>,
}

impl Plan {
    pub fn new(kernel: &Kernel, rows: (&Side, &Floor), columns: (&Side, &Floor), accuracy: Accuracy) -> Self {
        let brief = accuracy.brief() && kernel.is_exponential();
        let tolerance = accuracy.tolerance - if brief { brief::ERROR } else { 0.0 };
        let holder = |(side, floor)| Holder { side, floor };
        let mut planner = Planner {
            kernel,
            rows: holder(rows),
            columns: holder(columns),
            raised: if accuracy.far { 0.0 } else { RAISED },
            log_tolerance: tolerance.log2(),
            brief,
            single: accuracy.single && kernel.is_exponential(),
            far: accuracy.far.then(|| Far { row_frames: frames(rows.0), column_frames: frames(columns.0) }),
        };
        let share = rows.0.cloud.len().div_ceil(PANELS).max(PANEL);
        let roots = rows.0.tree().cut(share);
        let (mut panels, mut error) = planner.panels(&roots);
        while error > 0.5 * tolerance && planner.raised > 0.0 {
            planner.raised -= LOWERED;
            (panels, error) = planner.panels(&roots);
        }
        let row_grids = kept(&panels, |pair| (pair.row, pair.row_grid));
        let column_grids = kept(&panels, |pair| (pair.column, pair.column_grid));
        let number = |pair: &Pair<Grid>| Pair {
            row: pair.row,
            column: pair.column,
            row_grid: via(&row_grids, pair.row, pair.row_grid),
            column_grid: via(&column_grids, pair.column, pair.column_grid),
            double: pair.double,
            single: pair.single,
            brief: pair.brief,
        };
        let panels = panels.par_iter().map(|panel| panel.iter().map(number).collect()).collect();
        let (row_frames, column_frames) =
            planner.far.map_or_else(Default::default, |far| (far.row_frames, far.column_frames));
        Self { panels, row_grids, column_grids, row_frames, column_frames }
    }
}

/// The grids in use on one side.
fn kept(panels: &[Vec<Pair<Grid>>], of: impl Fn(&Pair<Grid>) -> (u32, Option<Grid>)) -> Vec<Kept> {
    let used = |(node, grid): (u32, Option<Grid>)| grid.map(|(wave, orders)| Kept { node, wave, orders });
    let mut all: Vec<Kept> = panels.iter().flatten().map(of).filter_map(used).collect();
    all.sort_unstable();
    all.dedup_by(|next, first| {
        let same = (next.node, next.wave) == (first.node, first.wave);
        if same {
            first.orders = std::array::from_fn(|d| first.orders[d].max(next.orders[d]));
        }
        same
    });
    all
}

fn via(grids: &[Kept], node: u32, grid: Option<Grid>) -> Option<Via> {
    let (wave, orders) = grid?;
    let kept = grids.partition_point(|kept| (kept.node, kept.wave) < (node, wave)) as u32;
    Some(Via { kept, orders })
}

struct Planner<'a> {
    kernel: &'a Kernel,
    rows: Holder<'a>,
    columns: Holder<'a>,
    log_tolerance: f64,
    /// Powers of two by which the bounds of kinds 1 and 4 are raised, subject to the account.
    raised: f64,
    single: bool,
    brief: bool,
    far: Option<Far>,
}

/// What it takes to choose grids.
struct Far {
    row_frames: Vec<Frame>,
    column_frames: Vec<Frame>,
}

/// What to do with a pair of nodes, and what it costs in pairs of points.
#[derive(Clone, Copy)]
enum Choice {
    /// Nothing: too small to count.
    Skip,
    /// This, at this cost.
    Sum(Pair<Grid>, usize),
    /// It must be split; in the worst case it costs all its pairs.
    Split(usize),
}

impl Choice {
    fn cost(&self) -> usize {
        match *self {
            Self::Skip => 0,
            Self::Sum(_, cost) | Self::Split(cost) => cost,
        }
    }
}

/// What one panel comes to.
struct Found {
    pairs: Vec<Pair<Grid>>,
    /// If bounds are raised.
    account: Option<Account>,
}

impl Planner<'_> {
    /// The pairs of every panel, and what the sums may err by if bounds are raised.
    fn panels(&self, roots: &[u32]) -> (Vec<Vec<Pair<Grid>>>, f64) {
        let panel = |&root: &u32| {
            let account = (self.raised > 0.0).then(|| Account::new(self.rows.side, self.columns.side));
            let mut found = Found { pairs: Vec::new(), account };
            self.visit(root, 0, self.choose(root, 0), &mut found);
            found.pairs.sort_unstable();
            found
        };
        let found: Vec<Found> = roots.par_iter().map(panel).collect();
        let mut all = Account::new(self.rows.side, self.columns.side);
        found.iter().filter_map(|found| found.account.as_ref()).for_each(|account| all.add(account));
        (found.into_iter().map(|found| found.pairs).collect(), all.worst())
    }

    fn visit(&self, row: u32, column: u32, choice: Choice, out: &mut Found) {
        if let Choice::Skip = choice {
            return self.account(row, column, (Mask::NONE, Mask::NONE), out);
        }
        let parts = self.split(row, column).map(|parts| parts.map(|(r, c)| (r, c, self.choose(r, c))));
        match (choice, parts) {
            (Choice::Sum(pair, _), None) => {
                self.account(row, column, (pair.double, pair.single), out);
                out.pairs.push(pair);
            }
            (Choice::Sum(pair, cost), Some(parts)) if cost <= parts.iter().map(|p| p.2.cost()).sum() => {
                out.pairs.push(pair);
            }
            (_, Some(parts)) => parts.into_iter().for_each(|(r, c, choice)| self.visit(r, c, choice, out)),
            (_, None) => {}
        }
    }

    fn account(&self, row: u32, column: u32, blocks: (Mask, Mask), out: &mut Found) {
        let Some(account) = &mut out.account else { return };
        let (rows, columns) = ((self.rows, row), (self.columns, column));
        let leaves = self.rows.side.node(row).is_leaf() && self.columns.side.node(column).is_leaf();
        if leaves && blocks.0 != Mask::ALL {
            let error = single::error(&self.rows.side.boxes[row as usize], &self.columns.side.boxes[column as usize]);
            account.tile(self.kernel, rows, columns, blocks, error.unwrap_or(1.0));
        } else if !leaves {
            account.leave_out(self.kernel, rows, columns);
        }
    }

    /// The pair with its larger node split, unless both are leaves.
    fn split(&self, row: u32, column: u32) -> Option<[(u32, u32); 2]> {
        let (r, c) = (self.rows.side.node(row), self.columns.side.node(column));
        let size = |of: Holder, node: u32| of.side.boxes[node as usize].reach(&of.side.boxes[node as usize]);
        let row_first = !r.is_leaf() && (c.is_leaf() || size(self.rows, row) >= size(self.columns, column));
        if row_first {
            Some(self.rows.side.tree().children(row).map(|child| (child, column)))
        } else if !c.is_leaf() {
            Some(self.columns.side.tree().children(column).map(|child| (row, child)))
        } else {
            None
        }
    }

    fn choose(&self, row: u32, column: u32) -> Choice {
        let (here, there) = (&self.rows.side.boxes[row as usize], &self.columns.side.boxes[column as usize]);
        let gaps = here.gaps(there);
        let gap = norm(gaps);
        let highest = self.kernel.at(gap);
        let (low_row, low_column) = (self.rows.floor.lower[row as usize], self.columns.floor.lower[column as usize]);
        let lowest = low_row.min(low_column);
        // Half of the error is for what is left out; the shares of the columns add up to one.
        if highest < lowest + self.log_tolerance - 1.0 {
            return Choice::Skip;
        }
        let (r, c) = (self.rows.side.node(row), self.columns.side.node(column));
        let wide = self.rows.floor.wide[row as usize] || self.columns.floor.wide[column as usize];
        let all_pairs = r.count as usize * c.count as usize;
        let (best, near_cost) = if r.is_leaf() && c.is_leaf() {
            let (double, single) = if wide { (Mask::ALL, Mask::NONE) } else { self.precision(row, column) };
            if double.join(single) == Mask::NONE {
                return Choice::Skip;
            }
            let brief = self.brief && !wide && brief::fits(here, there);
            let cost = |mask: Mask| mask.blocks() * all_pairs / Mask::ALL.blocks();
            let cost = cost(double) + cost(single) / SINGLE;
            (Choice::Sum(Pair { row, column, row_grid: None, column_grid: None, double, single, brief }, cost), cost)
        } else {
            (Choice::Split(all_pairs), all_pairs)
        };
        let Some(far) = self.far.as_ref().filter(|_| !wide) else { return best };
        match self.far(far, row, column, gaps, lowest) {
            Some((pair, cost)) if cost < near_cost => Choice::Sum(pair, cost),
            _ => best,
        }
    }

    /// The blocks of a tile in double and in single precision.
    fn precision(&self, row: u32, column: u32) -> (Mask, Mask) {
        let (here, there) = (&self.rows.side.boxes[row as usize], &self.columns.side.boxes[column as usize]);
        let single_from = self.log_tolerance - 1.0 + self.raised;
        let error = if self.single { single::error(here, there) } else { None };
        let double_from = single_from - error.map_or(0.0, f64::log2);
        let (mut double, mut single) = (Mask::NONE, Mask::NONE);
        for (i, row) in self.rows.side.chunks_of(row).enumerate() {
            for (j, column) in self.columns.side.chunks_of(column).enumerate() {
                let gap = self.rows.side.chunks[row].gap(&self.columns.side.chunks[column]);
                let share = self.kernel.at(gap) - self.rows.floor.chunks[row].min(self.columns.floor.chunks[column]);
                if share >= double_from || share >= single_from && gap < single::NEAREST {
                    double.insert(i, j);
                } else if share >= single_from {
                    single.insert(i, j);
                }
            }
        }
        // One block is not worth the change of precision.
        if single.blocks() == 1 {
            (double, single) = (double.join(single), Mask::NONE);
        }
        (double, single)
    }

    /// The smallest grids that keep the error within the other half of the tolerance.
    fn far(&self, far: &Far, row: u32, column: u32, gaps: [f64; 3], lowest: f64) -> Option<(Pair<Grid>, usize)> {
        let (r, c) = (self.rows.side.node(row), self.columns.side.node(column));
        let near_cost = r.count as usize * c.count as usize;
        let frames = [&far.row_frames[row as usize], &far.column_frames[column as usize]];
        let pair = FarPair::new(self.kernel, frames, gaps)?;
        // Errors are in proportion to the waves. They may be measured by E itself, which falls short of its waves by
        // the dip, or by the least of the sums against the top of the waves, whichever allows more.
        let (dip, height) = pair.dip_and_height();
        let measure = -dip.min(pair.centre + height - lowest);
        // An eighth for rounding, the rest for the interpolations.
        let budget = self.log_tolerance - 1.0 + measure;
        let all_directions = budget - LOG2_4_3;
        let [m, n] = [(0, r.count), (1, c.count)]
            .map(|(side, count)| pair.least_nodes(side, all_directions).min(f64::from(count)) as usize);
        let hopeless = [m >= r.count as usize, n >= c.count as usize];
        if hopeless[0] && (hopeless[1] || !r.is_leaf()) || hopeless[1] && !c.is_leaf() || cost(m, n) >= near_cost {
            return None;
        }
        let row_grid = pair.grid(0, all_directions, 1.0, r.count as usize);
        if row_grid.is_none() && !r.is_leaf() {
            return None;
        }
        let amplified = row_grid.map_or(1.0, |grid| lebesgue(grid.1));
        let column_grid = pair.grid(1, all_directions, amplified, c.count as usize);
        if column_grid.is_none() && (!c.is_leaf() || row_grid.is_none()) {
            return None;
        }
        let rounding: f64 = [row_grid, column_grid].iter().flatten().map(|grid| lebesgue(grid.1).log2()).sum();
        if rounding + f64::EPSILON.log2() > budget - 2.0 {
            return None;
        }
        let size = |grid: Option<Grid>, count: u32| grid.map_or(count as usize, |(_, orders)| nodes(orders));
        let (m, n) = (size(row_grid, r.count), size(column_grid, c.count));
        let (double, single) = (Mask::ALL, Mask::NONE);
        Some((Pair { row, column, row_grid, column_grid, double, single, brief: false }, cost(m, n)))
    }
}

/// What a far pair costs with so many nodes on either side.
fn cost(m: usize, n: usize) -> usize {
    m * n + OVERHEAD_NODE * (m + n) + OVERHEAD
}
