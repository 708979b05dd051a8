//! The transpose of the derivative of the log sums: from seeds on log A and log B to the body's points.

use rayon::prelude::*;

use super::aligned::Aligned;
use super::blocks::Blocks;
use super::brief::BriefPull;
use super::chebyshev::nodes;
use super::kernel::{Kernel, with_form};
use super::lanes::{Machine, WIDTH};
use super::mask::Mask;
use super::plan::{Kept, Pair, Plan};
use super::pull::{FIELD, FIELDS, Field, PULL, Pull, WidePull, collect};
use super::side::padded;
use super::single::{Rounded, SinglePull};
use super::sums::{Half, Log2Sums, brief_tile, single_tile, tilt};
use super::transform::{Proxy, Tables, add_from_nodes, expand};

/// Per row: the force (units of `Kernel::gradient_factor`) and the mass, see `pull`.
pub(super) type Pulled = [f64; 4];

/// Seeds (tree order, padded) and the sums they belong to.
pub(super) struct Adjoint<'a> {
    pub kernel: &'a Kernel,
    pub machine: Machine,
    pub tables: &'a Tables,
    pub rows: Half<'a>,
    pub columns: Half<'a>,
    pub row_seed: &'a [f64],
    pub column_seed: &'a [f64],
    pub log2: &'a Log2Sums,
    /// seed / sum at the points, in powers of two of the leaf.
    row_charge: Vec<f64>,
    column_charge: Aligned,
    /// The same in single precision.
    rounded_pull: Rounded,
    rounded_charge: Rounded,
    column_moments: Vec<Vec<f64>>,
    charge_moments: Vec<Vec<f64>>,
}

/// What one panel of rows adds up: leaf by leaf at the points, node by node the coefficients of the seven fields.
struct Panel {
    points: Vec<(u32, Vec<Pulled>)>,
    grids: Blocks,
}

impl<'a> Adjoint<'a> {
    #[allow(clippy::too_many_arguments)]
    pub fn new(
        kernel: &'a Kernel,
        machine: Machine,
        tables: &'a Tables,
        rows: Half<'a>,
        columns: Half<'a>,
        row_seed: &'a [f64],
        column_seed: &'a [f64],
        log2: &'a Log2Sums,
    ) -> Self {
        let charge = |half: Half, seed: &[f64], log2: &[f64], node: u32| -> Vec<f64> {
            let range = half.side.node(node).range();
            let lower = half.lower(node);
            let mut charge: Vec<f64> =
                range.clone().zip(&log2[range.clone()]).map(|(k, log)| seed[k] * (lower - log).exp2()).collect();
            charge.resize(range.len().next_multiple_of(WIDTH), 0.0);
            charge
        };
        let by_leaf = |half: Half, seed: &[f64], log2: &[f64]| -> Vec<f64> {
            half.side.leaves().par_iter().map(|&leaf| charge(half, seed, log2, leaf)).collect::<Vec<_>>().concat()
        };
        let row_charge = by_leaf(rows, row_seed, &log2.rows);
        let column_charge: Aligned = by_leaf(columns, column_seed, &log2.columns).into_iter().collect();
        let (rounded_pull, rounded_charge) = (Rounded::new(&row_charge), Rounded::new(&column_charge));
        let column_moments = columns.moments(machine, |node| columns.side.columns(node).weight.to_vec());
        let charge_moments = columns.moments(machine, |node| charge(columns, column_seed, &log2.columns, node));
        Self {
            kernel,
            machine,
            tables,
            rows,
            columns,
            row_seed,
            column_seed,
            log2,
            row_charge,
            column_charge,
            rounded_pull,
            rounded_charge,
            column_moments,
            charge_moments,
        }
    }

    pub fn run(&self, plan: &Plan) -> Vec<Pulled> {
        let panels: Vec<Panel> = plan.panels.par_iter().map(|pairs| self.panel(pairs)).collect();
        let mut points: Vec<Option<&[Pulled]>> = vec![None; self.rows.side.tree().nodes.len()];
        for (node, pulled) in panels.iter().flat_map(|panel| &panel.points) {
            points[*node as usize] = Some(pulled);
        }
        // A row node belongs to one panel only.
        let fields = |(number, grid): (usize, &Kept)| {
            let mut fields = vec![0.0; FIELDS * nodes(grid.orders)];
            panels.iter().for_each(|panel| panel.grids.add_to(number as u32, &mut fields));
            fields
        };
        let grids: Vec<Vec<f64>> = self.rows.grids.par_iter().enumerate().map(fields).collect();
        let leaf = |&leaf: &u32| {
            let mut pulled = match points[leaf as usize] {
                Some(pulled) => pulled.to_vec(),
                None => vec![[0.0; 4]; self.rows.side.node(leaf).count as usize],
            };
            self.add_grids(leaf, &grids, &mut pulled);
            pulled
        };
        self.rows.side.leaves().par_iter().map(leaf).collect::<Vec<_>>().concat()
    }

    fn panel(&self, pairs: &[Pair]) -> Panel {
        let mut panel = Panel { points: Vec::new(), grids: Blocks::new(self.rows.grids.len()) };
        let mut work = Work::default();
        for same_row in pairs.chunk_by(|a, b| a.row == b.row) {
            let row = same_row[0].row;
            let at_points = same_row.iter().any(|pair| pair.row_grid.is_none());
            if at_points {
                work.point_sums.reset(self.rows.side.node(row).count as usize * PULL);
            }
            for pair in same_row {
                self.pair(pair, &mut work, &mut panel.grids);
            }
            if at_points {
                panel.points.push((row, work.point_sums.chunks_exact(PULL).map(collect).collect()));
            }
        }
        panel
    }

    fn pair(&self, pair: &Pair, work: &mut Work, grids: &mut Blocks) {
        if self.rows.floor.wide[pair.row as usize] || self.columns.floor.wide[pair.column as usize] {
            return self.wide(pair, &mut work.point_sums);
        }
        if pair.single != Mask::NONE {
            self.single(pair, &mut work.point_sums);
        }
        if pair.double == Mask::NONE {
            return;
        }
        if pair.brief {
            return self.brief(pair, &mut work.point_sums);
        }
        let gap = self.rows.side.boxes[pair.row as usize].gap(&self.columns.side.boxes[pair.column as usize]);
        let shift = self.kernel.at(gap);
        let row_factor = (shift - self.rows.lower(pair.row)).exp2();
        let column_factor = (shift - self.columns.lower(pair.column)).exp2();
        let Work { row_proxy, column_proxy, charges, point_sums, grid_sums, values, scratch } = work;
        let (columns, charge) = match pair.column_grid {
            Some(via) => {
                let kept = self.columns.place(self.tables, via, column_proxy).orders;
                column_proxy.weigh(self.tables, via.orders, &self.charge_moments[via.kept as usize], kept);
                let charge = charges.reset(column_proxy.weight.len());
                charge.copy_from_slice(&column_proxy.weight);
                column_proxy.weigh(self.tables, via.orders, &self.column_moments[via.kept as usize], kept);
                (column_proxy.columns(), &*charge)
            }
            None => {
                let points = padded(self.columns.side.node(pair.column));
                (self.columns.side.columns(pair.column), &self.column_charge[points])
            }
        };
        let Some(via) = pair.row_grid else {
            let rows = self.rows.side.rows(pair.row);
            let pull = &self.row_charge[self.rows.side.node(pair.row).range()];
            with_form!(self.kernel, form => self.machine.run(Pull {
                form, rows, pull, columns, charge, mask: pair.double, shift, row_factor, column_factor, out: point_sums,
            }));
            return;
        };
        let kept = self.rows.place(self.tables, via, row_proxy).orders;
        let out = grid_sums.reset(row_proxy.count() * FIELD);
        with_form!(self.kernel, form => self.machine.run(Field {
            form, rows: row_proxy.row_points(), columns, charge, shift, row_factor, column_factor, out,
        }));
        let coefficients = grids.get_mut(via.kept, FIELDS * nodes(kept));
        for (field, coefficients) in coefficients.chunks_exact_mut(nodes(kept)).enumerate() {
            values.clear();
            let spread = grid_sums.chunks_exact(FIELD).map(|row| &row[field * WIDTH..][..WIDTH]);
            values.extend(spread.map(|spread| spread.iter().sum::<f64>()));
            tilt(values, row_proxy);
            add_from_nodes(self.tables, via.orders, values, kept, coefficients, scratch);
        }
    }

    fn brief(&self, pair: &Pair, out: &mut [f64]) {
        let (rows, columns) = (self.rows.side, self.columns.side);
        let tile = brief_tile(rows, columns, pair);
        self.machine.run(BriefPull {
            tile,
            row_weights: rows.rows(pair.row).weight,
            pull: &self.row_charge[rows.node(pair.row).range()],
            column_weights: columns.columns(pair.column).weight,
            charge: &self.column_charge[padded(columns.node(pair.column))],
            row_factor: (tile.shift - self.rows.lower(pair.row)).exp2(),
            column_factor: (tile.shift - self.columns.lower(pair.column)).exp2(),
            out,
        });
    }

    fn single(&self, pair: &Pair, out: &mut [f64]) {
        let (rows, columns) = (self.rows.side, self.columns.side);
        let (row, column) = (rows.first(pair.row), columns.first(pair.column));
        let tile = single_tile(rows, columns, pair);
        self.machine.run(SinglePull {
            tile,
            row_weights: rows.rounded_weight.leaf(row),
            pull: self.rounded_pull.leaf(row),
            column_weights: columns.rounded_weight.leaf(column),
            charge: self.rounded_charge.leaf(column),
            row_factor: (tile.shift - self.rows.lower(pair.row)).exp2(),
            column_factor: (tile.shift - self.columns.lower(pair.column)).exp2(),
            out,
        });
    }

    fn wide(&self, pair: &Pair, out: &mut [f64]) {
        let rows = self.rows.side.node(pair.row).range();
        let columns = padded(self.columns.side.node(pair.column));
        with_form!(self.kernel, form => self.machine.run(WidePull {
            form,
            rows: self.rows.side.rows(pair.row),
            seed_row: &self.row_seed[rows.clone()],
            log_row: &self.log2.rows[rows],
            columns: self.columns.side.columns(pair.column),
            seed_column: &self.column_seed[columns.clone()],
            log_column: &self.log2.columns[columns],
            out,
        }));
    }

    /// Adds what the grids of a leaf and of the nodes above it give at its points.
    fn add_grids(&self, leaf: u32, grids: &[Vec<f64>], pulled: &mut [Pulled]) {
        let points = self.rows.side.columns(leaf);
        let range = self.rows.side.node(leaf).range();
        let n = points.weight.len();
        let mut values = vec![0.0; FIELDS * n];
        for (number, grid) in self.rows.grids_over(leaf) {
            values.fill(0.0);
            expand(self.machine, points, self.rows.patch(grid), &grids[number], &mut values);
            let lower = self.rows.lower(grid.node);
            for (k, (pulled, q)) in pulled.iter_mut().zip(range.clone()).enumerate() {
                let by_weight = self.row_seed[q] * (lower - self.log2.rows[q]).exp2();
                for d in 0..3 {
                    pulled[d] += self.rows.side.weight[q] * values[d * n + k] + by_weight * values[(3 + d) * n + k];
                }
                pulled[3] += values[6 * n + k];
            }
        }
    }
}

/// What a panel writes on, over and over.
#[derive(Default)]
struct Work {
    row_proxy: Proxy,
    column_proxy: Proxy,
    charges: Aligned,
    /// Per row of a leaf `PULL` numbers.
    point_sums: Aligned,
    /// Per node of a grid `FIELD` numbers.
    grid_sums: Aligned,
    values: Vec<f64>,
    scratch: [Vec<f64>; 2],
}
