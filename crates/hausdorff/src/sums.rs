//! The sums A_t = sum_q p_q E_qt and B_q = sum_t s_t E_qt in logarithms, every exponential computed once for both.

use rayon::prelude::*;

use super::aligned::Aligned;
use super::blocks::Blocks;
use super::brief::{BriefSums, BriefTile};
use super::chebyshev::nodes;
use super::floor::Floor;
use super::frame::Frame;
use super::kernel::{Kernel, with_form};
use super::lanes::{Machine, WIDTH};
use super::mask::Mask;
use super::plan::{Kept, Pair, Plan, Via};
use super::side::{Side, padded};
use super::single::{SingleSums, SingleTile};
use super::tile::{Slab, Sums, WideSums};
use super::transform::{Patch, Proxy, Tables, add_from_nodes, expand, moments};

/// One side of the pairs with what belongs to it.
#[derive(Clone, Copy)]
pub(super) struct Half<'a> {
    pub side: &'a Side,
    pub floor: &'a Floor,
    pub grids: &'a [Kept],
    pub frames: &'a [Frame],
}

impl<'a> Half<'a> {
    pub fn lower(&self, node: u32) -> f64 {
        self.floor.lower[node as usize]
    }

    pub fn patch(&self, grid: &Kept) -> Patch {
        Patch::new(&self.frames[grid.node as usize], grid.wave, grid.orders)
    }

    /// For every grid the moments of values at the points of its node (padded, tree order).
    pub fn moments(&self, machine: Machine, values: impl Fn(u32) -> Vec<f64> + Sync) -> Vec<Vec<f64>> {
        let of_node = |same_node: &[Kept]| -> Vec<Vec<f64>> {
            let weight = values(same_node[0].node);
            let points = Slab { weight: &weight, ..self.side.columns(same_node[0].node) };
            same_node.iter().map(|grid| moments(machine, points, self.patch(grid))).collect()
        };
        let by_node: Vec<&[Kept]> = self.grids.chunk_by(|a, b| a.node == b.node).collect();
        by_node.par_iter().map(|same_node| of_node(same_node)).collect::<Vec<_>>().concat()
    }

    /// Puts the nodes of a pair's grid in place.
    pub fn place(&self, tables: &Tables, via: Via, proxy: &mut Proxy) -> &'a Kept {
        let kept = &self.grids[via.kept as usize];
        proxy.place(tables, &self.frames[kept.node as usize], kept.wave, via.orders);
        kept
    }

    /// The grids of a leaf and of the nodes above it, with their numbers.
    pub fn grids_over(&self, leaf: u32) -> Vec<(usize, &'a Kept)> {
        let mut over = Vec::new();
        let mut node = leaf;
        loop {
            let first = self.grids.partition_point(|kept| kept.node < node);
            over.extend((first..).zip(self.grids[first..].iter().take_while(|kept| kept.node == node)));
            if node == 0 {
                return over;
            }
            node = self.side.node(node).parent;
        }
    }
}

/// log2 of the sums at the points of both sides, tree order.
#[derive(Debug)]
pub(super) struct Log2Sums {
    pub rows: Vec<f64>,
    pub columns: Vec<f64>,
}

impl Log2Sums {
    /// With both arrays padded to a multiple of `WIDTH`.
    pub fn padded(mut self) -> Self {
        for logs in [&mut self.rows, &mut self.columns] {
            logs.resize(logs.len().next_multiple_of(WIDTH), 0.0);
        }
        self
    }
}

/// What one panel of rows adds up: at its own points and grids, and at those of the columns it meets.
struct Panel {
    rows: Blocks,
    row_grids: Blocks,
    columns: Blocks,
    column_grids: Blocks,
}

pub(super) struct Summation<'a> {
    pub kernel: &'a Kernel,
    pub machine: Machine,
    pub tables: &'a Tables,
    pub rows: Half<'a>,
    pub columns: Half<'a>,
    row_moments: Vec<Vec<f64>>,
    column_moments: Vec<Vec<f64>>,
}

impl<'a> Summation<'a> {
    pub fn new(kernel: &'a Kernel, machine: Machine, tables: &'a Tables, rows: Half<'a>, columns: Half<'a>) -> Self {
        let of = |half: Half| half.moments(machine, |node| half.side.columns(node).weight.to_vec());
        let (row_moments, column_moments) = rayon::join(|| of(rows), || of(columns));
        Self { kernel, machine, tables, rows, columns, row_moments, column_moments }
    }

    pub fn run(&self, plan: &Plan) -> Log2Sums {
        let panels: Vec<Panel> = plan.panels.par_iter().map(|pairs| self.panel(pairs)).collect();
        let rows = || self.finish(self.rows, &panels, |panel| (&panel.rows, &panel.row_grids));
        let columns = || self.finish(self.columns, &panels, |panel| (&panel.columns, &panel.column_grids));
        let (rows, columns) = rayon::join(rows, columns);
        Log2Sums { rows, columns }
    }

    fn panel(&self, pairs: &[Pair]) -> Panel {
        let (m, n) = (self.rows.side.tree().nodes.len(), self.columns.side.tree().nodes.len());
        let mut panel = Panel {
            rows: Blocks::new(m),
            row_grids: Blocks::new(self.rows.grids.len()),
            columns: Blocks::new(n),
            column_grids: Blocks::new(self.columns.grids.len()),
        };
        let mut work = Work::default();
        for same_row in pairs.chunk_by(|a, b| a.row == b.row) {
            let row = same_row[0].row;
            let count = self.rows.side.node(row).count as usize;
            // Sums at the points of the row stay spread over lanes until all columns are through.
            let at_points = same_row.iter().any(|pair| pair.row_grid.is_none());
            if at_points {
                work.point_sums.reset(count * WIDTH);
            }
            for pair in same_row {
                self.pair(pair, &mut work, &mut panel);
            }
            if at_points {
                gather(&work.point_sums, &mut work.values);
                panel.rows.get_mut(row, count).copy_from_slice(&work.values);
            }
        }
        panel
    }

    fn pair(&self, pair: &Pair, work: &mut Work, panel: &mut Panel) {
        let Work { row_proxy, column_proxy, point_sums, grid_sums, column_sums, values, scratch } = work;
        let rows = match pair.row_grid {
            Some(via) => {
                let kept = self.rows.place(self.tables, via, row_proxy);
                row_proxy.weigh(self.tables, via.orders, &self.row_moments[via.kept as usize], kept.orders);
                grid_sums.reset(row_proxy.count() * WIDTH);
                row_proxy.rows()
            }
            None => self.rows.side.rows(pair.row),
        };
        let columns = match pair.column_grid {
            Some(via) => {
                let kept = self.columns.place(self.tables, via, column_proxy);
                column_proxy.weigh(self.tables, via.orders, &self.column_moments[via.kept as usize], kept.orders);
                column_proxy.columns()
            }
            None => self.columns.side.columns(pair.column),
        };
        let row_sums: &mut [f64] = if pair.row_grid.is_some() { grid_sums } else { point_sums };
        let column_sums = column_sums.reset(columns.weight.len());
        self.tile(pair, rows, columns, row_sums, column_sums);
        if let Some(via) = pair.row_grid {
            let kept = self.rows.grids[via.kept as usize].orders;
            let coefficients = panel.row_grids.get_mut(via.kept, nodes(kept));
            gather(row_sums, values);
            tilt(values, row_proxy);
            add_from_nodes(self.tables, via.orders, values, kept, coefficients, scratch);
        }
        if let Some(via) = pair.column_grid {
            let kept = self.columns.grids[via.kept as usize].orders;
            let coefficients = panel.column_grids.get_mut(via.kept, nodes(kept));
            let sums = &mut column_sums[..column_proxy.count()];
            tilt(sums, column_proxy);
            add_from_nodes(self.tables, via.orders, sums, kept, coefficients, scratch);
        } else {
            let block = panel.columns.get_mut(pair.column, column_sums.len());
            block.iter_mut().zip(column_sums).for_each(|(block, sum)| *block += *sum);
        }
    }

    fn tile(&self, pair: &Pair, rows: Slab, columns: Slab, row_sums: &mut [f64], column_sums: &mut [f64]) {
        let (row, column) = (pair.row as usize, pair.column as usize);
        if self.rows.floor.wide[row] || self.columns.floor.wide[column] {
            let row_scale = &self.rows.floor.scale[self.rows.side.node(pair.row).range()];
            let column_scale = &self.columns.floor.scale[padded(self.columns.side.node(pair.column))];
            with_form!(self.kernel, form => self.machine.run(WideSums {
                form, rows, columns, row_scale, column_scale, row_sums, column_sums,
            }));
            return;
        }
        if pair.single != Mask::NONE {
            let tile = single_tile(self.rows.side, self.columns.side, pair);
            self.machine.run(SingleSums {
                tile,
                row_weights: self.rows.side.rounded_weight.leaf(self.rows.side.first(pair.row)),
                column_weights: self.columns.side.rounded_weight.leaf(self.columns.side.first(pair.column)),
                row_factor: (tile.shift - self.rows.lower(pair.row)).exp2(),
                column_factor: (tile.shift - self.columns.lower(pair.column)).exp2(),
                row_sums: &mut *row_sums,
                column_sums: &mut *column_sums,
            });
        }
        if pair.double != Mask::NONE {
            let mask = pair.double;
            if pair.brief {
                let tile = brief_tile(self.rows.side, self.columns.side, pair);
                self.machine.run(BriefSums {
                    tile,
                    row_weights: rows.weight,
                    column_weights: columns.weight,
                    row_factor: (tile.shift - self.rows.lower(pair.row)).exp2(),
                    column_factor: (tile.shift - self.columns.lower(pair.column)).exp2(),
                    row_sums,
                    column_sums,
                });
                return;
            }
            let shift = self.kernel.at(self.rows.side.boxes[row].gap(&self.columns.side.boxes[column]));
            let row_factor = (shift - self.rows.lower(pair.row)).exp2();
            let column_factor = (shift - self.columns.lower(pair.column)).exp2();
            with_form!(self.kernel, form => self.machine.run(Sums {
                form, rows, columns, mask, shift, row_factor, column_factor, row_sums, column_sums,
            }));
        }
    }

    /// Adds up the panels in their order and evaluates the grids: log2 sums at the points of one side.
    fn finish<'p>(
        &self,
        half: Half,
        panels: &'p [Panel],
        of: impl Fn(&'p Panel) -> (&'p Blocks, &'p Blocks) + Sync,
    ) -> Vec<f64> {
        let on_grid = |(number, grid): (usize, &Kept)| {
            let mut sum = vec![0.0; nodes(grid.orders)];
            panels.iter().for_each(|panel| of(panel).1.add_to(number as u32, &mut sum));
            sum
        };
        let coefficients: Vec<Vec<f64>> = half.grids.par_iter().enumerate().map(on_grid).collect();
        let leaf = |&leaf: &u32| {
            let columns = half.side.columns(leaf);
            let node = half.side.node(leaf);
            let mut sums = vec![0.0; columns.weight.len()];
            panels.iter().for_each(|panel| of(panel).0.add_to(leaf, &mut sums[..node.count as usize]));
            let mut values = vec![0.0; sums.len()];
            for (number, grid) in half.grids_over(leaf) {
                // From the scale of the node to that of the leaf.
                let factor = (half.lower(grid.node) - half.lower(leaf)).exp2();
                values.fill(0.0);
                expand(self.machine, columns, half.patch(grid), &coefficients[number], &mut values);
                sums.iter_mut().zip(&values).for_each(|(sum, value)| *sum += factor * value);
            }
            sums.truncate(node.count as usize);
            let scale = &half.floor.scale[node.range()];
            sums.iter_mut().zip(scale).for_each(|(sum, scale)| *sum = sum.log2() + scale);
            sums
        };
        half.side.leaves().par_iter().map(leaf).collect::<Vec<_>>().concat()
    }
}

/// The part of a pair of leaves that is summed in single precision.
pub(super) fn single_tile<'a>(rows: &'a Side, columns: &'a Side, pair: &Pair) -> SingleTile<'a> {
    let (here, there) = (&rows.boxes[pair.row as usize], &columns.boxes[pair.column as usize]);
    SingleTile {
        rows: rows.rows(pair.row).x,
        columns: columns.local.leaf(columns.first(pair.column)),
        origin: there.centre(),
        mask: pair.single,
        shift: -here.gap(there).floor(),
    }
}

/// The part of a pair of leaves that is summed in double precision, in brief.
pub(super) fn brief_tile<'a>(rows: &'a Side, columns: &'a Side, pair: &Pair) -> BriefTile<'a> {
    let (here, there) = (&rows.boxes[pair.row as usize], &columns.boxes[pair.column as usize]);
    BriefTile {
        rows: rows.rows(pair.row).x,
        columns: columns.centred.leaf(padded(columns.node(pair.column))),
        origin: there.centre(),
        mask: pair.double,
        shift: -here.gap(there).floor(),
    }
}

/// Row sums without the spread over lanes.
fn gather(spread: &[f64], values: &mut Vec<f64>) {
    values.clear();
    values.extend(spread.chunks_exact(WIDTH).map(|spread| spread.iter().sum::<f64>()));
}

/// Takes the wave of a grid out of values at its nodes.
pub(super) fn tilt(values: &mut [f64], proxy: &Proxy) {
    values.iter_mut().zip(proxy.tilt()).for_each(|(value, tilt)| *value *= tilt);
}

/// What a panel writes on, over and over.
#[derive(Default)]
struct Work {
    row_proxy: Proxy,
    column_proxy: Proxy,
    point_sums: Aligned,
    grid_sums: Aligned,
    column_sums: Aligned,
    values: Vec<f64>,
    scratch: [Vec<f64>; 2],
}
