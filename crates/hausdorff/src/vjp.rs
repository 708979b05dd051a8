//! The transpose of the derivative of the log sums: from seeds on log A and log B to the body's points.

use rayon::prelude::*;

use super::aligned::Aligned;
use super::kernel::with_form;
use super::lanes::WIDTH;
use super::leaf_pairs::{LeafPair, LeafPairs, Log2Sums, Scale};
use super::lower_bounds::BoundedSet;
use super::point_set::padded;
use super::together::is_own;
use super::vjp_tiles::{VJP, VjpTile, WideVjpTile, collect};

/// Per row: the force (units of `Kernel::gradient_factor`) and the mass, see `vjp_tiles`.
pub(super) type PointVjp = [f64; 4];

/// Seeds (tree order, padded) and the sums they belong to.
pub(super) struct VjpSums<'a> {
    pub summed: LeafPairs<'a>,
    pub row_seed: &'a [f64],
    pub column_seed: &'a [f64],
    pub log2: &'a Log2Sums,
    /// seed / sum at the points, in powers of two of the leaf.
    row_quotient: Vec<f64>,
    column_quotient: Aligned,
}

impl<'a> VjpSums<'a> {
    pub fn new(summed: LeafPairs<'a>, row_seed: &'a [f64], column_seed: &'a [f64], log2: &'a Log2Sums) -> Self {
        let quotient = |set: &BoundedSet, seed: &[f64], log2: &[f64]| -> Vec<f64> {
            let mut quotient = vec![0.0; seed.len()];
            for leaf in set.points.leaves() {
                let lower = set.bounds.lower[leaf as usize];
                set.points.node(leaf).range().for_each(|k| quotient[k] = seed[k] * (lower - log2[k]).exp2());
            }
            quotient
        };
        let row_quotient = quotient(summed.rows, row_seed, &log2.rows);
        let column_quotient = quotient(summed.columns, column_seed, &log2.columns).into_iter().collect();
        Self { summed, row_seed, column_seed, log2, row_quotient, column_quotient }
    }

    /// At every row, in tree order.
    pub fn run(&self) -> Vec<PointVjp> {
        let panel = |(k, leaves): (usize, &Vec<u32>)| -> Vec<PointVjp> {
            if !is_own(self.summed.together, k) {
                return vec![[0.0; 4]; self.summed.points_of(leaves)];
            }
            let (mut all, mut spread) = (Vec::new(), Aligned::default());
            for &row in leaves {
                spread.reset(self.summed.rows.points.node(row).count as usize * VJP);
                for column in self.summed.columns_of(row) {
                    self.tile(LeafPair { row, column }, &mut spread);
                }
                all.extend(spread.chunks_exact(VJP).map(collect::<4>));
            }
            all
        };
        let mut all = self.summed.panels().par_iter().enumerate().map(panel).collect::<Vec<_>>().concat();
        if let Some(together) = self.summed.together {
            together.add_up(all.as_flattened_mut());
        }
        all
    }

    fn tile(&self, pair: LeafPair, out: &mut [f64]) {
        let LeafPairs { kernel, instructions, rows, columns, .. } = self.summed;
        let row_range = rows.points.node(pair.row).range();
        let column_range = padded(columns.points.node(pair.column));
        let (rows, columns) = (rows.points.rows(pair.row), columns.points.columns(pair.column));
        if self.summed.is_wide(pair) {
            with_form!(kernel, form => instructions.run(WideVjpTile {
                form,
                rows,
                seed_row: &self.row_seed[row_range.clone()],
                log_row: &self.log2.rows[row_range],
                columns,
                seed_column: &self.column_seed[column_range.clone()],
                log_column: &self.log2.columns[column_range],
                out,
            }));
        } else {
            let Scale { shift, row_factor, column_factor } = self.summed.scale(pair);
            let (row_quotient, column_quotient) = (&self.row_quotient[row_range], &self.column_quotient[column_range]);
            with_form!(kernel, form => instructions.run(VjpTile {
                form, rows, row_quotient, columns, column_quotient, shift, row_factor, column_factor, out,
            }));
        }
    }
}

const _: () = assert!(VJP == 4 * WIDTH);
