//! [`Projection`]: from grey to black and white.

use super::ControlMap;

/// `y = (tanh(b e) + tanh(b (x - e))) / (tanh(b e) + tanh(b (1 - e)))`, entry by entry: what is below the threshold e goes to 0, what is above to 1, the
/// more sharply the larger b. 0 and 1 stay.
///
/// **Source.** F. Wang, B. S. Lazarov & O. Sigmund, Struct. Multidisc. Optim. 43 (2011) 767-784, doi 10.1007/s00158-010-0602-y.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Projection {
    /// e
    pub threshold: f64,
    /// b > 0
    pub sharpness: f64,
}

impl Projection {
    /// `y, y', y''`
    fn at(&self, x: f64) -> [f64; 3] {
        let (b, e) = (self.sharpness, self.threshold);
        let (low, scale) = ((b * e).tanh(), (b * e).tanh() + (b * (1.0 - e)).tanh());
        let t = (b * (x - e)).tanh();
        let slope = b * (1.0 - t * t);
        [(low + t) / scale, slope / scale, -2.0 * b * t * slope / scale]
    }
}

impl ControlMap for Projection {
    fn describe(&self) -> String {
        format!("projection about {} with sharpness {}", self.threshold, self.sharpness)
    }

    /// Thresholds may differ: one design, eroded and dilated.
    fn shared(&self) -> String {
        format!("projection with sharpness {}", self.sharpness)
    }

    fn values(&self, x: &[f64]) -> Vec<f64> {
        x.iter().map(|x| self.at(*x)[0]).collect()
    }

    fn change(&self, x: &[f64], v: &[f64]) -> Vec<f64> {
        x.iter().zip(v).map(|(x, v)| self.at(*x)[1] * v).collect()
    }

    fn vjp(&self, x: &[f64], g: &[f64]) -> Vec<f64> {
        self.change(x, g)
    }

    fn second_vjp(&self, x: &[f64], v: &[f64], g: &[f64]) -> Option<Vec<f64>> {
        Some(x.iter().zip(v).zip(g).map(|((x, v), g)| self.at(*x)[2] * v * g).collect())
    }

    fn is_affine(&self) -> bool {
        false
    }
}
