//! [`Estimate`]: a mean from a sample, and how far off it may be.

/// The mean of a sample of independent values of equal weight, with its sampling error.
///
/// `mean = sum x_i / n`, `error = sqrt(sum (x_i - mean)^2 / (n (n-1)))`, the standard error: about two thirds of all
/// samples miss the true mean by less than it, 95 in 100 by less than twice it. Both have the unit of the values.
///
/// Two controls are compared on one sample by [`paired`](Self::paired): what a draw does to both cancels in the
/// difference, so its error is smaller than those of the two means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Mean of the sample.
    pub mean: f64,
    /// Standard error of the mean.
    pub error: f64,
}

impl Estimate {
    /// From a sample; `None` for fewer than two values.
    pub fn of(values: &[f64]) -> Option<Self> {
        if values.len() < 2 {
            return None;
        }
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let square: f64 = values.iter().map(|x| (x - mean).powi(2)).sum();
        Some(Estimate { mean, error: (square / (n * (n - 1.0))).sqrt() })
    }

    /// Of `a_i - b_i` on one sample; `None` for fewer than two pairs or lists of different lengths.
    pub fn paired(a: &[f64], b: &[f64]) -> Option<Self> {
        if a.len() != b.len() {
            return None;
        }
        let differences: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
        Self::of(&differences)
    }
}
