//! [`Covariance`]: the covariance of parameters at the optimum of a least-squares cost.

use crate::spectrum::Spectrum;

/// A parameter is not determined where the directions that are not seen, with the least variance that they may have, add more than this share to its variance.
const MOST_ADDED: f64 = 1e-2;

/// `C = (J^T S^-1 J)^-1 = sum_k v_k v_k^T / lambda_k` of a cost `j = 1/2 r . S^-1 r`, by the eigenpairs `H v = lambda G v` of its matrix of Gauss and Newton
/// `H = J^T S^-1 J` with `G = diag(1/d_i^2)`, d_i the scale of parameter i. A direction v_k has the deviation `1/sqrt(lambda_k)` in these scales.
///
/// Directions that the residuals do not see, `lambda_k <= rounding lambda_1`, are left out of C; their variance is `1/(rounding lambda_1)` or more, and a parameter that has a
/// part in it has no deviation. Source: docs/identify.md; G. A. F. Seber and
/// C. J. Wild (1989), "Nonlinear Regression", section 2.1.
#[derive(Clone, Debug, PartialEq)]
pub struct Covariance {
    /// C by rows; zero in rows of parameters that are on a bound.
    pub entries: Vec<Vec<f64>>,
    /// Whether each parameter is determined: free, and without a part in a direction that is not seen.
    pub determined: Vec<bool>,
    /// The directions, the least determined first.
    pub directions: Vec<Determined>,
}

/// A direction of the parameters and how far the residuals determine it.
#[derive(Clone, Debug, PartialEq)]
pub struct Determined {
    /// The standard deviation along it in the scales of the parameters; `None` where it is not seen.
    pub deviation: Option<f64>,
    /// Its components in these scales, of length 1, the largest positive.
    pub components: Vec<f64>,
}

impl Covariance {
    /// From all eigenpairs of the matrix of Gauss and Newton in the inner product `diag(1/d_i^2)`, whose rounding is a share of the largest eigenvalue.
    pub fn of(spectrum: &Spectrum, scales: &[f64], rounding: f64) -> Self {
        let count = scales.len();
        let largest = spectrum.values.iter().fold(0.0, |most: f64, value| most.max(*value));
        let mut entries = vec![vec![0.0; count]; count];
        let (mut parts, mut unseen, mut directions) = (vec![0.0; count], vec![0.0; count], Vec::new());
        for (value, v) in spectrum.values.iter().zip(&spectrum.vectors) {
            let components: Vec<f64> = v.iter().zip(scales).map(|(v, scale)| v / scale).collect();
            let deviation = Some(1.0 / value.sqrt()).filter(|_| *value > rounding * largest);
            if deviation.is_some() {
                for (row, a) in entries.iter_mut().zip(v) {
                    row.iter_mut().zip(v).for_each(|(entry, b)| *entry += a * b / value);
                }
            }
            let sums = if deviation.is_some() { &mut parts } else { &mut unseen };
            sums.iter_mut().zip(&components).for_each(|(sum, part)| *sum += part * part);
            directions.push(Determined { deviation, components });
        }
        directions.reverse();
        let is_determined = |i: usize| {
            let (own, added) = (entries[i][i] / (scales[i] * scales[i]), unseen[i] / (rounding * largest));
            // those on a bound have no part in any direction
            parts[i] > 0.0 && added <= MOST_ADDED * own
        };
        let determined = (0..count).map(is_determined).collect();
        Self { entries, determined, directions }
    }

    /// The standard deviation of parameter i; `None` where it is not determined.
    pub fn deviation(&self, i: usize) -> Option<f64> {
        (self.determined[i]).then(|| self.entries[i][i].sqrt())
    }

    /// The correlation of two parameters, where both are determined.
    pub fn correlation(&self, i: usize, j: usize) -> Option<f64> {
        Some(self.entries[i][j] / (self.deviation(i)? * self.deviation(j)?))
    }

    /// `sqrt(g . C g)`: how far the minimum of the quadratic model is from where the derivative is g, in deviations.
    pub fn distance(&self, derivative: &[f64]) -> f64 {
        let row = |row: &Vec<f64>| row.iter().zip(derivative).map(|(entry, g)| entry * g).sum::<f64>();
        let square: f64 = self.entries.iter().map(row).zip(derivative).map(|(step, g)| step * g).sum();
        square.max(0.0).sqrt()
    }

    /// Number of directions that are seen.
    pub fn seen(&self) -> usize {
        self.directions.iter().filter(|one| one.deviation.is_some()).count()
    }
}
