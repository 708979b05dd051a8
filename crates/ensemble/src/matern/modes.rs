//! [`MaternModes`]: the modes of a field with the largest variance.

use super::Matern;
use super::reference_basis::refer;
use nastic_control::{ControlError, FieldOperator};
use nastic_linear::{DefiniteProblem, leading_eigenpairs};
use nastic_numeric::Random;

/// How many modes are kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kept {
    /// So many.
    Count(usize),
    /// As many as it takes to keep this share of the variance, in (0, 1).
    Share(f64),
}

/// Modes at most.
const MOST_MODES: usize = 512;
/// Modes that the first search is for, where a share is asked for.
const FIRST_MODES: usize = 16;
/// Random vectors that estimate the variance that is not kept.
const PROBES: usize = 64;
/// How many of them are solved for at once.
const PROBES_AT_ONCE: usize = 16;
/// Correlation at the distance that is told.
const FALLEN: f64 = 0.14;

/// `g(X) = sum_k a_k(X) xi_k` at the cells, xi independent standard normal: `a_k = sqrt(l_k) phi_k(X) / sqrt(v(X))`, `v = sum_k l_k phi_k^2`, so that the
/// variance of g is 1 everywhere however few modes are kept and wherever the boundary is.
///
/// `K phi = lambda M phi`, `phi . M phi = 1`, and `l = c^2 / (1 + L^2 lambda)^2`: the smallest lambda are the largest l. A value at a cell is the mean of those at its corners.
#[derive(Debug)]
pub struct MaternModes {
    /// The eigenvalues lambda of the modes kept, ascending (1/length^2).
    pub lambda: Vec<f64>,
    /// `a_k`, by mode, then by cell of the regions.
    pub at_cells: Vec<Vec<f64>>,
    /// The cells.
    pub cells: Vec<u32>,
    /// Whether the pivots of a factor show that no mode is missing.
    pub counted: bool,
    /// Share of the integral of the variance that these modes keep, and the standard error of it: the rest is estimated by 64 seeded vectors.
    pub share: [f64; 2],
    /// The least and largest variance v of the modes kept, before scaling, as a share of that in the whole space.
    pub before: [f64; 2],
    /// The distance from the cell in the middle of the body at which the correlation of the field as scaled first falls to 0.14, if it does.
    pub distance: Option<f64>,
}

struct Pairs {
    lambda: Vec<f64>,
    vectors: Vec<Vec<f64>>,
    counted: bool,
}

impl Matern {
    /// The modes with the largest variance.
    ///
    /// # Errors
    /// No mode, more than there are nodes or than 512; a share that these do not keep; an eigenproblem that is not solved.
    pub fn modes(&self, kept: Kept) -> Result<MaternModes, ControlError> {
        let fail = |what: String| Err(ControlError::Cost { what });
        let most = MOST_MODES.min(self.masses.len());
        let (mut count, wanted) = match kept {
            Kept::Count(count) if (1..=most).contains(&count) => (count, 0.0),
            Kept::Share(share) if share > 0.0 && share < 1.0 => (FIRST_MODES.min(most), share),
            Kept::Count(count) => return fail(format!("{count} modes of a random field; it has 1 to {most} here")),
            Kept::Share(share) => {
                return fail(format!(
                    "a share {share} of a random field's variance; give one between 0 and 1, or a number of modes"
                ));
            }
        };
        loop {
            let mut pairs = self.pairs(count)?;
            let variance: Vec<f64> = pairs.lambda.iter().map(|lambda| self.variance(*lambda)).collect();
            let [rest, error] = self.rest(&pairs.vectors);
            let total = rest + variance.iter().sum::<f64>();
            let mut sum = 0.0;
            let enough = variance.iter().position(|l| {
                sum += l;
                sum >= wanted * total
            });
            match (enough, wanted > 0.0) {
                (None, true) if count < most => count = most.min(2 * count),
                (None, true) => {
                    return fail(format!(
                        "{most} modes, the most that are taken, keep {:.1} % of a random field's variance, less than the {:.1} % that are asked for: a \
                         field of the length {} has more in this body; give their number, as \"modes\": 100, or a longer length",
                        100.0 * sum / total,
                        100.0 * wanted,
                        self.length
                    ));
                }
                (Some(last), true) => {
                    let _ = (pairs.lambda.split_off(last + 1), pairs.vectors.split_off(last + 1));
                    return self.scaled(pairs, [total, error]);
                }
                _ => return self.scaled(pairs, [total, error]),
            }
        }
    }

    /// `c^2 / (1 + L^2 lambda)^2`.
    fn variance(&self, lambda: f64) -> f64 {
        (self.scale / (1.0 + self.length * self.length * lambda)).powi(2)
    }

    /// The smallest eigenpairs of A by M, as those of K.
    fn pairs(&self, count: usize) -> Result<Pairs, ControlError> {
        let FieldOperator { matrix, factor } = &self.operator;
        let problem = DefiniteProblem { matrix, factor, masses: &self.masses, parallel: true };
        let found = leading_eigenpairs(&problem, count)
            .map_err(|e| ControlError::Cost { what: format!("modes of a random field: {e}") })?;
        // what rounding leaves of the zero of a constant may be negative
        let lambda = found.values.iter().map(|value| ((value - 1.0) / (self.length * self.length)).max(0.0)).collect();
        let mut vectors = found.vectors;
        let end = |k: usize, sign: f64| sign * self.positions.iter().map(|x| sign * x[k]).fold(f64::INFINITY, f64::min);
        let [low, high] = [1.0, -1.0].map(|sign| [0, 1, 2].map(|k| end(k, sign)));
        refer(&found.values, &mut vectors, &self.masses, &self.positions, [low, high]);
        Ok(Pairs { lambda, vectors, counted: found.counted })
    }

    /// The trace of the covariance by M on what is orthogonal to these vectors, `E |M^(1/2) c A^-1 M^(1/2) z|^2` less their part, and its standard error.
    fn rest(&self, kept: &[Vec<f64>]) -> [f64; 2] {
        let n = self.masses.len();
        let roots: Vec<f64> = self.masses.iter().map(|mass| mass.sqrt()).collect();
        let mut random = Random::new(0);
        let mut squares = Vec::with_capacity(PROBES);
        for _ in 0..PROBES / PROBES_AT_ONCE {
            let mut columns: Vec<f64> = (0..PROBES_AT_ONCE)
                .flat_map(|_| {
                    roots.iter().map(|root| if random.unit() < 0.5 { -root } else { *root }).collect::<Vec<_>>()
                })
                .collect();
            self.operator.factor.solve(&mut columns, PROBES_AT_ONCE);
            for column in columns.chunks_exact(n) {
                let weighted: Vec<f64> = column.iter().zip(&self.masses).map(|(x, mass)| x * mass).collect();
                let all: f64 = column.iter().zip(&weighted).map(|(x, y)| x * y).sum();
                let part: f64 =
                    kept.iter().map(|phi| phi.iter().zip(&weighted).map(|(x, y)| x * y).sum::<f64>().powi(2)).sum();
                squares.push(self.scale * self.scale * (all - part).max(0.0));
            }
        }
        let count = squares.len() as f64;
        let mean = squares.iter().sum::<f64>() / count;
        let spread = squares.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (count - 1.0);
        [mean, (spread / count).sqrt()]
    }

    fn scaled(&self, pairs: Pairs, [total, error]: [f64; 2]) -> Result<MaternModes, ControlError> {
        let Pairs { lambda, vectors, counted } = pairs;
        let mut at_cells: Vec<Vec<f64>> = vectors.iter().map(|phi| self.at_cells(phi)).collect();
        for (a, lambda) in at_cells.iter_mut().zip(&lambda) {
            let root = self.variance(*lambda).sqrt();
            a.iter_mut().for_each(|a| *a *= root);
        }
        let mut v = vec![0.0; self.cells.len()];
        at_cells.iter().for_each(|a| v.iter_mut().zip(a).for_each(|(v, a)| *v += a * a));
        let before = v.iter().fold([f64::INFINITY, 0.0f64], |[least, most], v| [least.min(*v), most.max(*v)]);
        if before[0] <= 0.0 {
            return Err(ControlError::Cost {
                what: "the modes kept of a random field are all zero in a cell; keep more of them".to_owned(),
            });
        }
        at_cells.iter_mut().for_each(|a| a.iter_mut().zip(&v).for_each(|(a, v)| *a /= v.sqrt()));
        let kept: f64 = lambda.iter().map(|lambda| self.variance(*lambda)).sum();
        let distance = self.distance(&at_cells);
        let share = [(kept / total).min(1.0), kept * error / (total * total)];
        Ok(MaternModes { lambda, at_cells, cells: self.cells.clone(), counted, share, before, distance })
    }

    /// Where the correlation with the cell in the middle first falls to [`FALLEN`].
    fn distance(&self, at_cells: &[Vec<f64>]) -> Option<f64> {
        let centres: Vec<[f64; 3]> = {
            let by_axis = [0, 1, 2].map(|k| self.at_cells(&self.positions.iter().map(|x| x[k]).collect::<Vec<_>>()));
            (0..self.cells.len()).map(|c| [by_axis[0][c], by_axis[1][c], by_axis[2][c]]).collect()
        };
        let count = centres.len().max(1) as f64;
        let middle = centres.iter().fold([0.0; 3], |sum, x| [0, 1, 2].map(|k| sum[k] + x[k] / count));
        let apart = |x: &[f64; 3], y: &[f64; 3]| (0..3).map(|k| (x[k] - y[k]).powi(2)).sum::<f64>().sqrt();
        let from =
            (0..centres.len()).min_by(|a, b| apart(&centres[*a], &middle).total_cmp(&apart(&centres[*b], &middle)))?;
        let correlation = |c: usize| at_cells.iter().map(|a| a[from] * a[c]).sum::<f64>();
        let fallen = (0..centres.len()).filter(|c| correlation(*c) <= FALLEN);
        fallen.map(|c| apart(&centres[c], &centres[from])).min_by(f64::total_cmp)
    }
}
