//! [`Feedback`]: the matrix by which measured deviations change controls step by step.

use nalgebra::{DMatrix, Schur};

/// Sweeps of the QR iteration at most, per row of a matrix whose eigenvalues are sought.
const MOST_SWEEPS: usize = 1000;

/// Sweeps over the controls in a step that bounds cut.
const MOST_SWEEPS_OF_STEP: usize = 1000;
/// Change of a control in a sweep, as a share of its scale, at which these end.
const STEP_TOLERANCE: f64 = 1e-13;

/// What a feedback is made of.
#[derive(Clone, Copy, Debug)]
pub struct FeedbackInputs<'a> {
    /// S = dy/dm by rows, shape `[outputs][controls]`.
    pub jacobian: &'a [Vec<f64>],
    /// The diagonal of Q, weights of `1/2 (y_i - y*_i)^2`.
    pub weights: &'a [f64],
    /// d_j: a change of control j that counts as one.
    pub scales: &'a [f64],
    /// rho >= 0.
    pub damping: f64,
    /// A singular value below this share of the largest is zero.
    pub rounding: f64,
}

/// The quasi-static law `m <- m - L (y - y*)` of outputs y with targets y*,
///
/// ```text
/// L = (S^T Q S + R)^-1 S^T Q,    R = rho sigma_1^2 D^-2,    D = diag(d_j)
/// ```
///
/// by the singular values `Q^1/2 S D = U Sigma V^T`: `L = D V diag(sigma_k / (sigma_k^2 + rho sigma_1^2)) U^T Q^1/2`. R weighs the change of the controls in a step, not the
/// controls: the law comes to rest where `S^T Q (y - y*) = 0`, or on bounds where that presses against them. Its error along direction k shrinks by `rho sigma_1^2 / (sigma_k^2 + rho sigma_1^2)` per step.
/// Directions with sigma_k = 0 are left out: no control moves such outputs.
/// Source: a Gauss-Newton step with R as of Levenberg and Marquardt; docs/gains.md.
#[derive(Clone, Debug, PartialEq)]
pub struct Feedback {
    /// L by rows, shape `[controls][outputs]`.
    pub gain: Vec<Vec<f64>>,
    /// The diagonal of R, in 1/m_j^2 times the unit of the cost.
    pub penalty: Vec<f64>,
    /// Directions that controls move, the largest singular value first.
    pub moved: Vec<MovedDirection>,
    /// Orthonormal combinations of the outputs `Q^1/2 y` that no control moves.
    pub unmoved: Vec<Vec<f64>>,
    /// `U^T Q^1/2` and `D V diag(..)`, whose product is L.
    left: DMatrix<f64>,
    right: DMatrix<f64>,
    /// `S^T Q`, and `S^T Q S + R`, by rows.
    slope: Vec<Vec<f64>>,
    curvature: Vec<Vec<f64>>,
    scales: Vec<f64>,
}

/// A singular value with its directions, both of length 1.
#[derive(Clone, Debug, PartialEq)]
pub struct MovedDirection {
    /// sigma_k: by how much the weighted outputs change where the scaled controls change by 1.
    pub value: f64,
    /// u_k: components of `Q^1/2 y`, the largest positive.
    pub outputs: Vec<f64>,
    /// v_k: components of `D^-1 m`.
    pub controls: Vec<f64>,
}

impl Feedback {
    /// The law; `None` where no control moves an output, or the singular values are not found (entries that are not finite).
    pub fn of(inputs: &FeedbackInputs<'_>) -> Option<Self> {
        let FeedbackInputs { jacobian, weights, scales, damping, rounding } = *inputs;
        let (outputs, controls) = (jacobian.len(), scales.len());
        let scaled = DMatrix::from_fn(outputs, controls, |i, j| weights[i].sqrt() * jacobian[i][j] * scales[j]);
        if outputs == 0 || controls == 0 || scaled.iter().any(|entry| !entry.is_finite()) {
            return None;
        }
        let svd = scaled.try_svd(true, true, f64::EPSILON, MOST_SWEEPS * outputs.max(controls))?;
        let (u, vt) = (svd.u?, svd.v_t?);
        let largest = svd.singular_values.iter().fold(0.0, |most: f64, value| most.max(*value));
        let mut order: Vec<usize> = (0..svd.singular_values.len()).collect();
        order.retain(|&k| svd.singular_values[k] > rounding * largest);
        order.sort_by(|&a, &b| svd.singular_values[b].total_cmp(&svd.singular_values[a]));
        if order.is_empty() {
            return None;
        }
        let direction = |&k: &usize| {
            let column: Vec<f64> = u.column(k).iter().copied().collect();
            let most = column.iter().fold(0.0, |most: f64, part| if part.abs() > most.abs() { *part } else { most });
            let sign = most.signum();
            MovedDirection {
                value: svd.singular_values[k],
                outputs: column.iter().map(|part| sign * part).collect(),
                controls: vt.row(k).iter().map(|part| sign * part).collect(),
            }
        };
        let moved: Vec<MovedDirection> = order.iter().map(direction).collect();
        let damped = damping * largest * largest;
        let left = DMatrix::from_fn(moved.len(), outputs, |k, i| moved[k].outputs[i] * weights[i].sqrt());
        let right = DMatrix::from_fn(controls, moved.len(), |j, k| {
            let MovedDirection { value, controls, .. } = &moved[k];
            scales[j] * controls[j] * value / (value * value + damped)
        });
        let product = &right * &left;
        let gain = product.row_iter().map(|row| row.iter().copied().collect()).collect();
        let penalty: Vec<f64> = scales.iter().map(|scale| damped / (scale * scale)).collect();
        let slope: Vec<Vec<f64>> =
            (0..controls).map(|j| (0..outputs).map(|i| jacobian[i][j] * weights[i]).collect()).collect();
        let entry = |j: usize, k: usize| {
            let own = (0..outputs).map(|i| slope[j][i] * jacobian[i][k]).sum::<f64>();
            if j == k { own + penalty[j] } else { own }
        };
        let curvature = (0..controls).map(|j| (0..controls).map(|k| entry(j, k)).collect()).collect();
        let scales = scales.to_vec();
        let unmoved = complement(moved.iter().map(|one| one.outputs.clone()).collect(), outputs);
        Some(Feedback { gain, penalty, moved, unmoved, left, right, slope, curvature, scales })
    }

    /// The controls behind a step from m: `m + d`, where d minimises `1/2 |y - y* + S d|_Q^2 + 1/2 d . R d` with m + d within the bounds, `-L (y - y*)` where these do not cut it; else by
    /// coordinates in turn, from its cut.
    pub fn step(&self, m: &[f64], errors: &[f64], bounds: &[[f64; 2]]) -> Vec<f64> {
        let along = |row: &Vec<f64>| row.iter().zip(errors).map(|(own, error)| own * error).sum::<f64>();
        let whole: Vec<f64> = m.iter().zip(&self.gain).map(|(m, row)| m - along(row)).collect();
        let cut = |value: f64, [lower, upper]: [f64; 2]| value.max(lower).min(upper);
        let mut next: Vec<f64> = whole.iter().zip(bounds).map(|(value, own)| cut(*value, *own)).collect();
        if next == whole {
            return next;
        }
        let slope: Vec<f64> = self.slope.iter().map(along).collect();
        for _ in 0..MOST_SWEEPS_OF_STEP {
            let mut most = 0.0_f64;
            for j in 0..m.len() {
                let row = &self.curvature[j];
                if row[j] <= 0.0 {
                    continue;
                }
                let pull = row.iter().zip(&next).zip(m).map(|((own, next), m)| own * (next - m)).sum::<f64>();
                let value = cut(next[j] - (slope[j] + pull) / row[j], bounds[j]);
                most = most.max((value - next[j]).abs() / self.scales[j]);
                next[j] = value;
            }
            if most <= STEP_TOLERANCE {
                break;
            }
        }
        next
    }

    /// By how much errors shrink per step, in the end, on a body whose outputs change by other derivatives: the spectral radius of `1 - L S` on the range of L
    /// (`1 - U^T Q^1/2 S D V diag(..)`), that of `1 - S L` on the outputs that L sees. Below 1 the law converges from nearby, while no control is on a bound.
    /// `None` where the eigenvalues are not found.
    pub fn contraction(&self, jacobian: &[Vec<f64>]) -> Option<f64> {
        let count = self.moved.len();
        let own = DMatrix::from_fn(self.left.ncols(), self.right.nrows(), |i, j| jacobian[i][j]);
        let matrix = DMatrix::identity(count, count) - &self.left * own * &self.right;
        if matrix.iter().any(|entry| !entry.is_finite()) {
            return None;
        }
        let schur = Schur::try_new(matrix, f64::EPSILON, MOST_SWEEPS * count)?;
        Some(schur.complex_eigenvalues().iter().map(|value| value.norm()).fold(0.0, f64::max))
    }
}

/// An orthonormal basis of what is orthogonal to orthonormal vectors, unit vectors with the largest part there first.
fn complement(mut known: Vec<Vec<f64>>, length: usize) -> Vec<Vec<f64>> {
    let first = known.len();
    while known.len() < length {
        let part = |k: usize| 1.0 - known.iter().map(|v| v[k] * v[k]).sum::<f64>();
        let most = (0..length).reduce(|a, b| if part(b) > part(a) + 1e-12 { b } else { a }).unwrap_or(0);
        let mut new = vec![0.0; length];
        new[most] = 1.0;
        // twice: once leaves rounding
        for v in known.iter().chain(&known) {
            let along: f64 = v.iter().zip(&new).map(|(a, b)| a * b).sum();
            new.iter_mut().zip(v).for_each(|(own, v)| *own -= along * v);
        }
        let size = new.iter().map(|own| own * own).sum::<f64>().sqrt();
        new.iter_mut().for_each(|own| *own /= size);
        known.push(new);
    }
    known.split_off(first)
}
