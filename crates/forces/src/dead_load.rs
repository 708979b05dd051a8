//! [`DeadLoad`]: forces that do not depend on the displacement.

use nastic_body::contribution::point::{ContributionPoint, Need};
use nastic_body::contribution::sensitivities::{Increment, SecondSensitivities};
use nastic_body::contribution::{Contribution, Demand, Sums};
use nastic_body::error::{Inadmissible, SecondDerivativeError};
use nastic_body::instant::Instant;
use nastic_linear::SparseMatrix;
use std::sync::Arc;

/// Nodal forces d times the load: potential `-load d . u`, residual `-load d`.
#[derive(Debug, Clone)]
pub struct DeadLoad(pub Arc<Vec<f64>>);

impl Contribution for DeadLoad {
    fn name(&self) -> &str {
        "dead load"
    }

    fn at<'a>(&'a self, _: &Instant, _: Need) -> Result<Box<dyn ContributionPoint + 'a>, Inadmissible> {
        Ok(Box::new(self))
    }
}

impl ContributionPoint for DeadLoad {
    fn add_residual(&self, at: &Instant, demand: Demand, sums: &mut Sums) -> Result<(), Inadmissible> {
        if demand.energy {
            let work: f64 = self.0.iter().zip(at.u).map(|(d, u)| d * u).sum();
            let scale: f64 = self.0.iter().zip(at.u).map(|(d, u)| (d * u).abs()).sum();
            sums.energy -= at.load * work;
            sums.energy_scale += at.load.abs() * scale;
        }
        if demand.force {
            for ((r, s), d) in sums.force.iter_mut().zip(&mut sums.force_scale).zip(self.0.iter()) {
                *r -= at.load * d;
                *s += (at.load * d).abs();
            }
        }
        Ok(())
    }

    fn add_tangent(&self, _: &Instant, _: &mut SparseMatrix) -> Result<(), Inadmissible> {
        Ok(())
    }

    fn add_tangent_product(&self, _: &Instant, _: &[f64], _: &mut [f64]) -> Result<bool, Inadmissible> {
        Ok(true)
    }

    fn second_vjp(
        &self,
        _: &Instant,
        _: &[f64],
        _: &Increment,
        _: &mut SecondSensitivities,
    ) -> Result<(), SecondDerivativeError> {
        Ok(())
    }
}
