//! Which pairs of nodes are summed point by point, which through Chebyshev grids, and which are too small to count.
//!
//! Why no sum S at a point, B_q or A_t, errs by more than tol S. Let L <= S be the lower bound of both nodes' sums
//! (`Floor`), and recall that the weights of the other side add up to one. Every pair of points is in exactly one pair of
//! nodes of the plan, which is of one of these kinds:
//!
//! 1. Left out: E <= tol/2 L for all pairs of points, by the least distance of their boxes.
//! 2. On grids, measured by the sums: the interpolation errs by at most tol/2 L, being within 2^budget of E between the
//!    centres times the waves (`chebyshev`), and the waves within their height.
//! 3. On grids, measured by E: the interpolation errs by at most tol/2 E, for E falls short of its waves by the dip at
//!    most.
//! 4. Point by point in single precision: its error times the largest E is at most tol/2 L (`single`).
//! 5. Point by point: exact.
//!
//! Kinds 1, 2 and 4 together err by at most sum w tol/2 L <= tol/2 S, kind 3 by sum w tol/2 E <= tol/2 S. A grid's error is
//! shared out: three quarters for the interpolation, a quarter for the rounding that its Lebesgue constants amplify. The
//! derivative's functions are E times at most the slope S' of log E, with errors in the same proportion to S' E or S' L;
//! divided by the sums and summed over the rows this is the bound on `Method`, the other half of it being the error of the
//! sums themselves.

use super::bounds::norm;
use super::chebyshev::{FarPair, Grid, Orders, Wave, lebesgue, nodes};
use super::frame::{Frame, frames};
use super::kernel::Kernel;
use super::side::{Floor, Side};
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

const LOG2_4_3: f64 = 0.41503749927884376;

/// A pair of nodes and how each side enters: through a grid, or point by point (then it is a leaf).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Pair<G = Via> {
    pub row: u32,
    pub column: u32,
    pub row_grid: Option<G>,
    pub column_grid: Option<G>,
    /// Point by point in single precision.
    pub single: bool,
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
        let planner = Planner {
            kernel,
            rows: rows.0,
            row_floor: rows.1,
            columns: columns.0,
            column_floor: columns.1,
            log_tolerance: accuracy.tolerance.log2(),
            single: accuracy.single && kernel.is_exponential(),
            far: accuracy.far.then(|| Far { row_frames: frames(rows.0), column_frames: frames(columns.0) }),
        };
        let share = rows.0.cloud.len().div_ceil(PANELS).max(PANEL);
        let panels = planner.panels(rows.0.tree().cut(share));
        let row_grids = kept(&panels, |pair| (pair.row, pair.row_grid));
        let column_grids = kept(&panels, |pair| (pair.column, pair.column_grid));
        let number = |pair: &Pair<Grid>| Pair {
            row: pair.row,
            column: pair.column,
            row_grid: via(&row_grids, pair.row, pair.row_grid),
            column_grid: via(&column_grids, pair.column, pair.column_grid),
            single: pair.single,
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
    rows: &'a Side,
    row_floor: &'a Floor,
    columns: &'a Side,
    column_floor: &'a Floor,
    log_tolerance: f64,
    single: bool,
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

impl Planner<'_> {
    fn panels(&self, roots: Vec<u32>) -> Vec<Vec<Pair<Grid>>> {
        let panel = |&root: &u32| {
            let mut pairs = Vec::new();
            self.visit(root, 0, self.choose(root, 0), &mut pairs);
            pairs.sort_unstable();
            pairs
        };
        roots.par_iter().map(panel).collect()
    }

    fn visit(&self, row: u32, column: u32, choice: Choice, out: &mut Vec<Pair<Grid>>) {
        if let Choice::Skip = choice {
            return;
        }
        let parts = self.split(row, column).map(|parts| parts.map(|(r, c)| (r, c, self.choose(r, c))));
        match (choice, parts) {
            (Choice::Sum(pair, _), None) => out.push(pair),
            (Choice::Sum(pair, cost), Some(parts)) if cost <= parts.iter().map(|p| p.2.cost()).sum() => out.push(pair),
            (_, Some(parts)) => parts.into_iter().for_each(|(r, c, choice)| self.visit(r, c, choice, out)),
            (_, None) => {}
        }
    }

    /// The pair with its larger node split, unless both are leaves.
    fn split(&self, row: u32, column: u32) -> Option<[(u32, u32); 2]> {
        let (r, c) = (self.rows.node(row), self.columns.node(column));
        let size = |side: &Side, node: u32| side.boxes[node as usize].reach(&side.boxes[node as usize]);
        let row_first = !r.is_leaf() && (c.is_leaf() || size(self.rows, row) >= size(self.columns, column));
        if row_first {
            Some(self.rows.tree().children(row).map(|child| (child, column)))
        } else if !c.is_leaf() {
            Some(self.columns.tree().children(column).map(|child| (row, child)))
        } else {
            None
        }
    }

    fn choose(&self, row: u32, column: u32) -> Choice {
        let (here, there) = (&self.rows.boxes[row as usize], &self.columns.boxes[column as usize]);
        let gaps = here.gaps(there);
        let gap = norm(gaps);
        let highest = self.kernel.at(gap);
        let (low_row, low_column) = (self.row_floor.lower[row as usize], self.column_floor.lower[column as usize]);
        let lowest = low_row.min(low_column);
        // Half of the error is for what is left out; the shares of the columns add up to one.
        if highest < lowest + self.log_tolerance - 1.0 {
            return Choice::Skip;
        }
        let (r, c) = (self.rows.node(row), self.columns.node(column));
        let wide = self.row_floor.wide[row as usize] || self.column_floor.wide[column as usize];
        let mut near_cost = r.count as usize * c.count as usize;
        let best = if r.is_leaf() && c.is_leaf() {
            let enough = |error: f64| highest + error.log2() < lowest + self.log_tolerance - 1.0;
            let single = self.single && !wide && single::error(here, there, gap).is_some_and(enough);
            near_cost = if single { near_cost / SINGLE } else { near_cost };
            Choice::Sum(Pair { row, column, row_grid: None, column_grid: None, single }, near_cost)
        } else {
            Choice::Split(near_cost)
        };
        let Some(far) = self.far.as_ref().filter(|_| !wide) else { return best };
        match self.far(far, row, column, gaps, lowest) {
            Some((pair, cost)) if cost < near_cost => Choice::Sum(pair, cost),
            _ => best,
        }
    }

    /// The smallest grids that keep the error within the other half of the tolerance.
    fn far(&self, far: &Far, row: u32, column: u32, gaps: [f64; 3], lowest: f64) -> Option<(Pair<Grid>, usize)> {
        let (r, c) = (self.rows.node(row), self.columns.node(column));
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
        Some((Pair { row, column, row_grid, column_grid, single: false }, cost(m, n)))
    }
}

/// What a far pair costs with so many nodes on either side.
fn cost(m: usize, n: usize) -> usize {
    m * n + OVERHEAD_NODE * (m + n) + OVERHEAD
}
