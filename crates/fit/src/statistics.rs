use std::cmp::Ordering;
use std::f64::consts::FRAC_PI_2;

use nalgebra_of_levenberg_marquardt::DMatrix;

/// A fitted parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// Its name in case files.
    pub name: &'static str,
    /// `"Pa"`, `"deg"`, `"1"` of a pure number.
    pub unit: &'static str,
    /// Its value.
    pub value: f64,
    /// Standard deviation; `None` for a parameter that the data do not determine, or that lies on the border of what the law admits.
    pub deviation: Option<f64>,
    /// Half-width of the 95 % confidence interval, Student's t times the deviation.
    pub half_width: Option<f64>,
    /// Whether it is the least that the law admits beside its other parameters, and the data ask for less.
    pub at_least: bool,
}

/// Information criteria of a fit with n points and k parameters, one more for the variance: the lower the better, comparable among
/// laws on the same points with the same weights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Criteria {
    /// `n log(S/n) + 2 K + 2 K (K + 1)/(n - K - 1)`, `K = k + 1`; infinite for `n <= K + 1`.
    pub aicc: f64,
    /// `n log(S/n) + K log n`.
    pub bic: f64,
}

impl Criteria {
    /// Of a sum of squares S (K. P. Burnham & D. R. Anderson, *Model Selection and Multimodel Inference* (2002), sections 2.4, 6.4).
    pub(crate) fn of(squares: f64, points: usize, parameters: usize) -> Self {
        let (n, k) = (points as f64, parameters as f64 + 1.0);
        let likelihood = n * (squares / n).ln();
        let room = n - k - 1.0;
        // a sum of squares of zero does not outweigh a correction that is infinite
        let aicc = if room > 0.0 { likelihood + 2.0 * k + 2.0 * k * (k + 1.0) / room } else { f64::INFINITY };
        Criteria { aicc, bic: likelihood + k * n.ln() }
    }

    /// The better first: by AICc, by BIC where AICc does not decide.
    pub fn compare(&self, other: &Self) -> Ordering {
        self.aicc.total_cmp(&other.aicc).then(self.bic.total_cmp(&other.bic))
    }
}

/// Two-sided 95 % point of Student's distribution with `nu` degrees of freedom, a whole number: of the closed forms of M. Abramowitz & I. A.
/// Stegun, 26.7.3 and 26.7.4, by Newton's method in `theta = atan(t / sqrt(nu))`; beyond 200 their series 26.7.5, to 1e-9.
pub fn student(nu: f64) -> f64 {
    let nu = nu.max(1.0);
    let z: f64 = 1.959_963_984_540_054;
    let terms = [
        (z.powi(3) + z) / 4.0,
        (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / 96.0,
        (3.0 * z.powi(7) + 19.0 * z.powi(5) + 17.0 * z.powi(3) - 15.0 * z) / 384.0,
    ];
    let series = z + terms.iter().rev().fold(0.0, |sum, term| (sum + term) / nu);
    if nu > 200.0 {
        return series;
    }
    // the probability is concave in theta: Newton's steps from below stay below
    let mut theta = (series / nu.sqrt()).atan();
    for _ in 0..50 {
        let (probability, slope) = student_within(nu as usize, theta);
        let step = (0.95 - probability) / slope;
        theta += step;
        if step.abs() <= f64::EPSILON * theta {
            break;
        }
    }
    nu.sqrt() * theta.tan()
}

/// The probability that `|t| < sqrt(nu) tan(theta)`, and its derivative.
fn student_within(nu: usize, theta: f64) -> (f64, f64) {
    let (sin, cos) = theta.sin_cos();
    let is_odd = !nu.is_multiple_of(2);
    let (mut power, mut term) = if is_odd { (1, cos) } else { (0, 1.0) };
    let mut sum = 0.0;
    while power + 2 <= nu {
        sum += term;
        term *= cos * cos * (power + 1) as f64 / (power + 2) as f64;
        power += 2;
    }
    let slope = nu as f64 * term / cos;
    if is_odd { ((theta + sin * sum) / FRAC_PI_2, slope / FRAC_PI_2) } else { (sin * sum, slope) }
}

/// Covariance of free numbers, `s^2 (J^T J)^-1` with the Jacobian J of the residuals (Gauss-Newton). Numbers on the border of
/// their range, and those that the residuals do not depend on, are left out: rows and columns of zeros; `None` if what is left is singular.
pub(crate) fn covariance(jacobian: &DMatrix<f64>, border: &[bool], variance: f64) -> Option<DMatrix<f64>> {
    let norms: Vec<f64> = jacobian.column_iter().map(|column| column.norm()).collect();
    let largest = norms.iter().fold(0.0f64, |most, norm| most.max(*norm));
    let kept: Vec<usize> = (0..norms.len()).filter(|k| !border[*k] && norms[*k] > NO_EFFECT * largest).collect();
    // columns of norm one: the inverse does not suffer from units
    let scaled = DMatrix::from_fn(jacobian.nrows(), kept.len(), |i, k| jacobian[(i, kept[k])] / norms[kept[k]]);
    let singular = scaled.singular_values();
    if kept.is_empty() || singular.min() < NO_EFFECT * singular.max() {
        return None;
    }
    let inverse = (scaled.transpose() * &scaled).try_inverse()?;
    let mut out = DMatrix::zeros(norms.len(), norms.len());
    for (a, i) in kept.iter().enumerate() {
        for (b, j) in kept.iter().enumerate() {
            out[(*i, *j)] = variance * inverse[(a, b)] / (norms[*i] * norms[*j]);
        }
    }
    Some(out)
}

/// Beside the largest, an effect of this share counts as zero.
const NO_EFFECT: f64 = 1e-7;
