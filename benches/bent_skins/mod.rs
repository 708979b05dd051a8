//! Two clouds of N points on the faces of a bar 1 x 0.2 x 0.2, one of them bent, and a functional of the sums between
//! them: the problem of a Python script that other codes are measured with, point for point.
//!
//! ```text
//! I(y) = (1/N sum_x phi(|y - x|)^alpha)^(1/alpha),    rho = mean_y (phi(0) - I(y)) + the same with x and y exchanged
//! ```

use nastic::hausdorff::{Cloud, HausdorffError, Pairs, Phi, Summation};

/// The angle per length by which the body is bent.
const BEND: f64 = 0.6;

/// PCG64 as numpy's `default_rng(0)` runs it.
struct Numpy {
    state: u128,
    /// The upper half of a number whose lower half has been used.
    half: Option<u32>,
}

impl Numpy {
    const MULTIPLIER: u128 = 47026247687942121848144207491837523525;
    const INCREMENT: u128 = 87136372517582989555478159403783844777;

    /// `default_rng(0)`.
    fn new() -> Self {
        Self { state: 35399562948360463058890781895381311971, half: None }
    }

    fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_mul(Self::MULTIPLIER).wrapping_add(Self::INCREMENT);
        (((self.state >> 64) ^ self.state) as u64).rotate_right((self.state >> 122) as u32)
    }

    /// `random()`.
    fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// `integers(0, 4)`.
    fn quarter(&mut self) -> u32 {
        let half = self.half.take().unwrap_or_else(|| {
            let bits = self.bits();
            self.half = Some((bits >> 32) as u32);
            bits as u32
        });
        half >> 30
    }

    fn skin(&mut self, n: usize) -> Vec<[f64; 3]> {
        let mut points: Vec<[f64; 3]> = (0..n).map(|_| [self.unit(), 0.2 * self.unit(), 0.2 * self.unit()]).collect();
        for x in &mut points {
            let face = self.quarter() as usize;
            x[1 + face / 2] = if face.is_multiple_of(2) { 0.0 } else { 0.2 };
        }
        points
    }
}

/// The problem.
pub struct BentSkins {
    points: Vec<[f64; 3]>,
    target: Cloud,
    phi: Phi,
    alpha: f64,
}

impl BentSkins {
    pub fn new(n: usize, phi: Phi, alpha: f64) -> Result<Self, HausdorffError> {
        let mut stream = Numpy::new();
        let (body, target) = (stream.skin(n), stream.skin(n));
        let bent = |[x, y, z]: [f64; 3]| {
            let radius = 1.0 / BEND;
            [(radius - z) * (BEND * x).sin(), y, radius - (radius - z) * (BEND * x).cos()]
        };
        let points = body.into_iter().map(bent).collect();
        Ok(Self { points, target: Cloud::new(target, vec![1.0; n])?, phi, alpha })
    }

    /// `exp` and `rat` as the script names them, and `smooth` for (1 + r^2)^(-1/2), at length 1.
    pub fn phi(name: &str) -> Option<Phi> {
        match name {
            "exp" => Some(Phi::Exponential { length: 1.0 }),
            "rat" => Some(Phi::Inverse { eps: 1.0 }),
            "smooth" => Some(Phi::SmoothInverse { eps: 1.0 }),
            _ => None,
        }
    }

    /// All that depends on the body: its tree and the choice of pairs.
    pub fn pairs(&self, summation: Summation) -> Result<Pairs, HausdorffError> {
        let body = Cloud::new(self.points.clone(), vec![1.0; self.points.len()])?;
        Pairs::new(&body, &self.target, self.phi, self.alpha, summation)
    }

    /// rho.
    pub fn value(&self, summation: Summation) -> Result<f64, HausdorffError> {
        let sums = self.pairs(summation)?.log_sums();
        Ok(self.mean(&sums.target).0 + self.mean(&sums.body).0)
    }

    /// rho and its derivative by the body's points.
    pub fn value_and_gradient(&self, summation: Summation) -> Result<(f64, Vec<[f64; 3]>), HausdorffError> {
        let pairs = self.pairs(summation)?;
        let sums = pairs.log_sums();
        let (to_body, by_target) = self.mean(&sums.target);
        let (to_target, by_body) = self.mean(&sums.body);
        Ok((to_body + to_target, pairs.vjp(&sums, &by_target, &by_body)?.points))
    }

    /// One of the two means, and its derivative by the logarithms.
    fn mean(&self, logs: &[f64]) -> (f64, Vec<f64>) {
        let (count, at_zero) = (logs.len() as f64, self.phi.value(0.0));
        let soft = logs.iter().map(|log| (log / self.alpha).exp());
        let mean = soft.clone().map(|soft| at_zero - soft).sum::<f64>() / count;
        (mean, soft.map(|soft| -soft / (self.alpha * count)).collect())
    }
}
