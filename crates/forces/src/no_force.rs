//! [`NoForce`]: what acts through the unknowns that it holds alone.

use nastic_body::contribution::point::ContributionPoint;
use nastic_body::contribution::sensitivities::{Increment, SecondSensitivities};
use nastic_body::contribution::{Demand, Sums};
use nastic_body::controls::Controls;
use nastic_body::error::{Inadmissible, SecondDerivativeError};
use nastic_body::instant::Instant;
use nastic_linear::SparseMatrix;

/// The point of a contribution without a residual of its own.
pub(crate) struct NoForce;

impl ContributionPoint for NoForce {
    fn add_residual(&self, _: &Instant, _: Demand, _: &mut Sums) -> Result<(), Inadmissible> {
        Ok(())
    }

    fn add_tangent(&self, _: &Instant, _: &mut SparseMatrix) -> Result<(), Inadmissible> {
        Ok(())
    }

    fn add_tangent_product(&self, _: &Instant, _: &[f64], _: &mut [f64]) -> Result<bool, Inadmissible> {
        Ok(true)
    }

    fn add_control_product(&self, _: &Instant, _: &Controls, _: &mut [f64]) -> Result<(), SecondDerivativeError> {
        Ok(())
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
