//! The sums A_t = sum_q p_q E_qt and B_q = sum_t s_t E_qt in logarithms, every exponential computed once for both.

use rayon::prelude::*;

use super::aligned::Aligned;
use super::kernel::{Kernel, with_form};
use super::lanes::{InstructionSet, WIDTH};
use super::lower_bounds::BoundedSet;
use super::point_set::padded;
use super::sum_tiles::{SumTile, WideSumTile};
use super::together::{Together, is_own};
use super::truncation::columns_of;

/// Groups of leaves of rows that are handled independently; fixed, so that sums do not depend on threads. While sums are
/// formed each group has a separate sum for every column.
const MAX_PANELS: usize = 64;

/// Leaves of a panel.
const MIN_LEAVES_PER_PANEL: usize = 4;

/// log2 of the sums at the points of both sets, tree order, padded to a multiple of `WIDTH`.
#[derive(Debug)]
pub(super) struct Log2Sums {
    pub rows: Vec<f64>,
    pub columns: Vec<f64>,
}

/// The pairs of leaves of two point sets that are summed.
#[derive(Clone, Copy)]
pub(super) struct LeafPairs<'a> {
    pub kernel: &'a Kernel,
    pub instructions: InstructionSet,
    pub log2_tolerance: f64,
    pub rows: &'a BoundedSet,
    pub columns: &'a BoundedSet,
    pub together: Option<&'a dyn Together>,
}

/// A pair of leaves.
#[derive(Clone, Copy)]
pub(super) struct LeafPair {
    pub row: u32,
    pub column: u32,
}

/// What E between two leaves is divided by, as powers of two and as factors that make up for it.
pub(super) struct Scale {
    pub shift: f64,
    pub row_factor: f64,
    pub column_factor: f64,
}

impl LeafPairs<'_> {
    /// Leaves of rows, in order, in groups for one thread each.
    pub fn panels(&self) -> Vec<Vec<u32>> {
        let leaves = self.rows.points.leaves();
        let size = leaves.len().div_ceil(MAX_PANELS).max(MIN_LEAVES_PER_PANEL);
        leaves.chunks(size).map(<[u32]>::to_vec).collect()
    }

    /// The leaves of columns that a leaf of rows is summed with.
    pub fn columns_of(&self, row: u32) -> Vec<u32> {
        columns_of(self.kernel, self.log2_tolerance, self.rows, row, self.columns)
    }

    /// Whether the points of a pair need a scale each.
    pub fn is_wide(&self, LeafPair { row, column }: LeafPair) -> bool {
        self.rows.bounds.wide[row as usize] || self.columns.bounds.wide[column as usize]
    }

    pub fn scale(&self, LeafPair { row, column }: LeafPair) -> Scale {
        let gap = self.rows.points.boxes[row as usize].gap(&self.columns.points.boxes[column as usize]);
        let shift = self.kernel.at(gap);
        let row_factor = (shift - self.rows.bounds.lower[row as usize]).exp2();
        let column_factor = (shift - self.columns.bounds.lower[column as usize]).exp2();
        Scale { shift, row_factor, column_factor }
    }

    pub fn log2_sums(&self) -> Log2Sums {
        let of_panel = |(k, leaves): (usize, &Vec<u32>)| match is_own(self.together, k) {
            true => self.panel(leaves),
            false => [vec![0.0; self.points_of(leaves)], vec![]],
        };
        let panels: Vec<[Vec<f64>; 2]> = self.panels().par_iter().enumerate().map(of_panel).collect();
        let mut rows: Vec<f64> = panels.iter().flat_map(|[rows, _]| rows).copied().collect();
        let mut columns = vec![0.0; self.columns.points.weight.len()];
        for [_, part] in &panels {
            columns.iter_mut().zip(part).for_each(|(sum, part)| *sum += part);
        }
        if let Some(together) = self.together {
            rows.append(&mut columns);
            together.add_up(&mut rows);
            columns = rows.split_off(rows.len() - self.columns.points.weight.len());
        }
        let logs = |set: &BoundedSet, mut sums: Vec<f64>| {
            let count = set.points.cloud.len();
            sums[..count].iter_mut().zip(&set.bounds.scale).for_each(|(sum, scale)| *sum = sum.log2() + scale);
            sums.resize(count.next_multiple_of(WIDTH), 0.0);
            sums
        };
        Log2Sums { rows: logs(self.rows, rows), columns: logs(self.columns, columns) }
    }

    /// How many points some leaves of rows have.
    pub fn points_of(&self, leaves: &[u32]) -> usize {
        leaves.iter().map(|&row| self.rows.points.node(row).count as usize).sum()
    }

    /// The sums of some leaves of rows, and their part of the sums of all columns.
    fn panel(&self, leaves: &[u32]) -> [Vec<f64>; 2] {
        let mut rows = Vec::new();
        let mut columns = Aligned::zeros(self.columns.points.weight.len());
        let mut spread = Aligned::default();
        for &row in leaves {
            // Sums at the points of the row stay spread over lanes until all columns are through.
            spread.reset(self.rows.points.node(row).count as usize * WIDTH);
            for column in self.columns_of(row) {
                let part = &mut columns[padded(self.columns.points.node(column))];
                self.tile(LeafPair { row, column }, &mut spread, part);
            }
            rows.extend(spread.chunks_exact(WIDTH).map(|spread| spread.iter().sum::<f64>()));
        }
        [rows, columns.to_vec()]
    }

    fn tile(&self, pair: LeafPair, row_sums: &mut [f64], column_sums: &mut [f64]) {
        let (rows, columns) = (self.rows.points.rows(pair.row), self.columns.points.columns(pair.column));
        if self.is_wide(pair) {
            let row_scale = &self.rows.bounds.scale[self.rows.points.node(pair.row).range()];
            let column_scale = &self.columns.bounds.scale[padded(self.columns.points.node(pair.column))];
            with_form!(self.kernel, form => self.instructions.run(WideSumTile {
                form, rows, columns, row_scale, column_scale, row_sums, column_sums,
            }));
        } else {
            let Scale { shift, row_factor, column_factor } = self.scale(pair);
            with_form!(self.kernel, form => self.instructions.run(SumTile {
                form, rows, columns, shift, row_factor, column_factor, row_sums, column_sums,
            }));
        }
    }
}
