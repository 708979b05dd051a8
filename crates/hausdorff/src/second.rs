//! Second derivatives of functionals of the sums, along a motion of the body.

use rayon::prelude::*;

use super::aligned::Aligned;
use super::error::HausdorffError;
use super::kernel::with_form;
use super::lanes::WIDTH;
use super::leaf_pairs::{LeafPairs, Log2Sums};
use super::pairs::{LogSums, Pairs, check};
use super::point_set::{in_cloud_order, in_tree_order, padded};
use super::second_tiles::{RateTile, RowMotion, SECOND, SecondTile};
use super::vjp_tiles::collect;

/// A change of the body's points (metres) and weights.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// By point.
    pub points: Vec<[f64; 3]>,
    /// By point, in the unit of the weights.
    pub weights: Vec<f64>,
}

/// Changes of the log sums along a motion, in the numbering of the clouds.
#[derive(Clone, Debug, PartialEq)]
pub struct Rates {
    /// Of log A_t.
    pub target: Vec<f64>,
    /// Of log B_q.
    pub body: Vec<f64>,
}

/// Seeds of a functional J, dJ/dlog A_t and dJ/dlog B_q, with their changes along a motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Seeds {
    /// dJ/dlog A_t.
    pub target: Vec<f64>,
    /// Its change.
    pub target_change: Vec<f64>,
    /// dJ/dlog B_q.
    pub body: Vec<f64>,
    /// Its change.
    pub body_change: Vec<f64>,
}

/// What becomes of a `Vjp` along a motion.
#[derive(Clone, Debug, PartialEq)]
pub struct SecondVjp {
    /// The change of dJ/dx_q.
    pub points: Vec<[f64; 3]>,
    /// The change of dJ/dw_q through A.
    pub weights: Vec<f64>,
    /// dJ/dw_q through A itself, as `Vjp::weights`.
    pub first: Vec<f64>,
}

impl Pairs {
    /// The changes of log A and log B along a motion, in one pass over the pairs:
    /// `dlog A_t = sum_q (p_q e_qt + omega_q/|Omega|) E_qt / A_t - sum_q omega_q/|Omega|`, `dlog B_q = sum_t s_t e_qt E_qt / B_q`, e the
    /// change of log phi^alpha. Pairs whose kink of phi lies where their points meet contribute zero.
    ///
    /// Errors: a motion of another number of points.
    pub fn rates(&self, sums: &LogSums, motion: &Motion) -> Result<Rates, HausdorffError> {
        let motion = self.in_units(motion)?;
        let (rows, columns) = Second { summed: self.summed(), log2: &sums.log2, motion: &motion }.rates();
        let target = in_cloud_order(self.target(), &columns).into_iter().map(|rate| rate - motion.total).collect();
        Ok(Rates { target, body: in_cloud_order(self.body(), &rows) })
    }

    /// The change of [`vjp`](Self::vjp) along a motion whose rates of the log sums are known, in one pass over the pairs.
    ///
    /// Errors: numbers of points that differ.
    pub fn second_vjp(
        &self,
        sums: &LogSums,
        motion: &Motion,
        rates: &Rates,
        seeds: &Seeds,
    ) -> Result<SecondVjp, HausdorffError> {
        for (values, cloud) in [
            (&rates.target, self.target()),
            (&seeds.target, self.target()),
            (&seeds.target_change, self.target()),
            (&rates.body, self.body()),
            (&seeds.body, self.body()),
            (&seeds.body_change, self.body()),
        ] {
            check("second derivatives by log A and log B", values, cloud)?;
        }
        let motion = self.in_units(motion)?;
        // What E/A and E/B change by beside e is part of the seeds' changes.
        let change = |seed: &[f64], change: &[f64], rate: &[f64], offset: f64| -> Vec<f64> {
            (0..seed.len()).map(|k| change[k] - seed[k] * (rate[k] + offset)).collect()
        };
        let columns = change(&seeds.target, &seeds.target_change, &rates.target, motion.total);
        let rows = change(&seeds.body, &seeds.body_change, &rates.body, 0.0);
        let of_rows = [in_tree_order(self.body(), &seeds.body), in_tree_order(self.body(), &rows)];
        let of_columns = [in_tree_order(self.target(), &seeds.target), in_tree_order(self.target(), &columns)];
        let found = Second { summed: self.summed(), log2: &sums.log2, motion: &motion }.second(&of_rows, &of_columns);
        let found = in_cloud_order(self.body(), &found);
        let (factor, measure) = (self.gradient_factor(), self.body().measure());
        let (total, changed) = (seeds.target.iter().sum::<f64>(), seeds.target_change.iter().sum::<f64>());
        Ok(SecondVjp {
            points: found.iter().map(|p| [factor * p[0], factor * p[1], factor * p[2]]).collect(),
            weights: found.iter().map(|p| (p[3] - changed + motion.total * total) / measure).collect(),
            first: found.iter().map(|p| (p[4] - total) / measure).collect(),
        })
    }

    fn in_units(&self, motion: &Motion) -> Result<TreeMotion, HausdorffError> {
        let (body, measure) = (self.body(), self.body().measure());
        check("a motion", &motion.weights, body)?;
        let along = |d: usize| motion.points.iter().map(|v| v[d] / self.unit()).collect::<Vec<f64>>();
        check("a motion", &along(0), body)?;
        let v = [0, 1, 2].map(|d| in_tree_order(body, &along(d)));
        let omega: Vec<f64> = motion.weights.iter().map(|w| w / measure).collect();
        Ok(TreeMotion { v, omega: in_tree_order(body, &omega), total: omega.iter().sum() })
    }
}

/// A motion in units of the kernel and of the measure, in tree order.
struct TreeMotion {
    v: [Aligned; 3],
    omega: Aligned,
    /// Sum of omega.
    total: f64,
}

struct Second<'a> {
    summed: LeafPairs<'a>,
    log2: &'a Log2Sums,
    motion: &'a TreeMotion,
}

impl Second<'_> {
    /// By row and by column, in tree order.
    fn rates(&self) -> (Vec<f64>, Vec<f64>) {
        let panels: Vec<[Vec<f64>; 2]> = self.summed.panels().par_iter().map(|leaves| self.rates_of(leaves)).collect();
        let rows = panels.iter().flat_map(|[rows, _]| rows).copied().collect();
        let mut columns = vec![0.0; self.summed.columns.points.weight.len()];
        for [_, part] in &panels {
            columns.iter_mut().zip(part).for_each(|(sum, part)| *sum += part);
        }
        (rows, columns)
    }

    fn rates_of(&self, leaves: &[u32]) -> [Vec<f64>; 2] {
        let LeafPairs { kernel, instructions, rows, columns, .. } = self.summed;
        let (mut by_row, mut by_column) = (Vec::new(), Aligned::zeros(columns.points.weight.len()));
        let mut spread = Aligned::default();
        for &row in leaves {
            let own = rows.points.node(row).range();
            spread.reset(own.len() * WIDTH);
            for column in self.summed.columns_of(row) {
                let range = padded(columns.points.node(column));
                with_form!(kernel, form => instructions.run(RateTile {
                    form,
                    rows: rows.points.rows(row),
                    motion: self.motion_of(own.clone()),
                    log_row: &self.log2.rows[own.clone()],
                    columns: columns.points.columns(column),
                    log_column: &self.log2.columns[range.clone()],
                    row_sums: &mut spread,
                    column_sums: &mut by_column[range],
                }));
            }
            by_row.extend(spread.chunks_exact(WIDTH).map(|spread| spread.iter().sum::<f64>()));
        }
        [by_row, by_column.to_vec()]
    }

    /// At every row, in tree order: seeds and changes of rows and of columns.
    fn second(&self, of_rows: &[Aligned; 2], of_columns: &[Aligned; 2]) -> Vec<[f64; 5]> {
        let LeafPairs { kernel, instructions, rows, columns, .. } = self.summed;
        let panel = |leaves: &Vec<u32>| -> Vec<[f64; 5]> {
            let (mut all, mut spread) = (Vec::new(), Aligned::default());
            for &row in leaves {
                let own = rows.points.node(row).range();
                spread.reset(own.len() * SECOND);
                for column in self.summed.columns_of(row) {
                    let range = padded(columns.points.node(column));
                    with_form!(kernel, form => instructions.run(SecondTile {
                        form,
                        rows: rows.points.rows(row),
                        motion: self.motion_of(own.clone()),
                        log_row: &self.log2.rows[own.clone()],
                        seed_row: &of_rows[0][own.clone()],
                        change_row: &of_rows[1][own.clone()],
                        columns: columns.points.columns(column),
                        log_column: &self.log2.columns[range.clone()],
                        seed_column: &of_columns[0][range.clone()],
                        change_column: &of_columns[1][range],
                        out: &mut spread,
                    }));
                }
                all.extend(spread.chunks_exact(SECOND).map(collect::<5>));
            }
            all
        };
        self.summed.panels().par_iter().map(panel).collect::<Vec<_>>().concat()
    }

    fn motion_of(&self, rows: std::ops::Range<usize>) -> RowMotion<'_> {
        let v = std::array::from_fn(|d| &self.motion.v[d][rows.clone()]);
        RowMotion { v, omega: &self.motion.omega[rows] }
    }
}
