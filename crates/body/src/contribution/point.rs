//! [`ContributionPoint`]: a contribution at one displacement.

use crate::contribution::sensitivities::{Increment, SecondSensitivities, Sensitivities};
use crate::contribution::{Demand, Sums};
use crate::controls::Controls;
use crate::error::{Inadmissible, SecondDerivativeError};
use crate::instant::Instant;
use nastic_linear::SparseMatrix;

/// What follows the residual at a displacement: what of its kinematics is worth keeping.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Need {
    /// Nothing.
    Residual,
    /// The tangent, or another derivative, or a longest step.
    Derivatives,
}

/// A [`Contribution`](crate::contribution::Contribution) at one displacement: `r(u; ..)` and its derivatives for a u whose kinematics are found once.
///
/// Every method is given the instant: its u is that of [`Contribution::at`](crate::contribution::Contribution::at), while multipliers, controls, load and
/// time step may be others, on which kinematics do not depend. A contribution that has none worth keeping is its own point.
pub trait ContributionPoint {
    /// Adds potential (in a time step the incremental one) and residual, as wanted, and what their rounding is measured against.
    ///
    /// # Errors
    /// [`Inadmissible`] where u is.
    fn add_residual(&self, at: &Instant, demand: Demand, sums: &mut Sums) -> Result<(), Inadmissible>;

    /// Adds the tangent by the displacement, supports not eliminated: [`SparseMatrix::add_pairs`], with `?` where nodes are not coupled;
    /// [`SparseMatrix::add_beyond`] for pairs of nodes that change with the state.
    ///
    /// # Errors
    /// [`Inadmissible`] where u is.
    fn add_tangent(&self, at: &Instant, tangent: &mut SparseMatrix) -> Result<(), Inadmissible>;

    /// Adds `dr/dp_k = -dg_k/du` for each of its multipliers to a column over the displacement, where it
    /// [constrains](crate::contribution::Contribution::constrains) the body.
    ///
    /// # Errors
    /// [`Inadmissible`] where u is.
    fn add_border(&self, _at: &Instant, _columns: &mut [Vec<f64>]) -> Result<(), Inadmissible> {
        Ok(())
    }

    /// Adds the product of its tangent with v, where it can say it without a matrix; false where it cannot.
    ///
    /// # Errors
    /// [`Inadmissible`] where u is.
    fn add_tangent_product(&self, _at: &Instant, _v: &[f64], _out: &mut [f64]) -> Result<bool, Inadmissible> {
        Ok(false)
    }

    /// The longest step `s <= 1` along du that it bears.
    ///
    /// # Errors
    /// [`Inadmissible`] where u itself is not admissible.
    fn max_step(&self, _at: &Instant, _du: &[f64]) -> Result<f64, Inadmissible> {
        Ok(1.0)
    }

    /// Adds `lambda . dr/d(controls, velocity, acceleration)`, and by the state before; nothing where r depends on the displacement
    /// and the load alone.
    ///
    /// # Errors
    /// [`Inadmissible`] where u is.
    fn vjp(&self, _at: &Instant, _lambda: &[f64], _into: &mut Sensitivities) -> Result<(), Inadmissible> {
        Ok(())
    }

    /// Adds `dr/dm v`, the change of the residual along a change v of the controls. A contribution with slots implements it for
    /// second derivatives of costs.
    ///
    /// # Errors
    /// [`SecondDerivativeError`] where it does not, or J <= 0.
    fn add_control_product(&self, _at: &Instant, _v: &Controls, _out: &mut [f64]) -> Result<(), SecondDerivativeError> {
        Err(no_second_derivatives("add_control_product"))
    }

    /// Adds the change of `K^T lambda` and of `lambda . dr/dm` along a change of u and of the controls: second derivatives of
    /// `lambda . r`, symmetric as a whole. Second derivatives of costs ask for it.
    ///
    /// # Errors
    /// [`SecondDerivativeError`] where it is not implemented, or J <= 0.
    fn second_vjp(
        &self,
        _at: &Instant,
        _lambda: &[f64],
        _along: &Increment,
        _into: &mut SecondSensitivities,
    ) -> Result<(), SecondDerivativeError> {
        Err(no_second_derivatives("second_vjp"))
    }
}

fn no_second_derivatives(method: &'static str) -> SecondDerivativeError {
    SecondDerivativeError::Contribution { name: String::new(), method }
}

/// A contribution that is its own point, by reference.
impl<T: ContributionPoint + ?Sized> ContributionPoint for &T {
    fn add_residual(&self, at: &Instant, demand: Demand, sums: &mut Sums) -> Result<(), Inadmissible> {
        (**self).add_residual(at, demand, sums)
    }

    fn add_tangent(&self, at: &Instant, tangent: &mut SparseMatrix) -> Result<(), Inadmissible> {
        (**self).add_tangent(at, tangent)
    }

    fn add_border(&self, at: &Instant, columns: &mut [Vec<f64>]) -> Result<(), Inadmissible> {
        (**self).add_border(at, columns)
    }

    fn add_tangent_product(&self, at: &Instant, v: &[f64], out: &mut [f64]) -> Result<bool, Inadmissible> {
        (**self).add_tangent_product(at, v, out)
    }

    fn max_step(&self, at: &Instant, du: &[f64]) -> Result<f64, Inadmissible> {
        (**self).max_step(at, du)
    }

    fn vjp(&self, at: &Instant, lambda: &[f64], into: &mut Sensitivities) -> Result<(), Inadmissible> {
        (**self).vjp(at, lambda, into)
    }

    fn add_control_product(&self, at: &Instant, v: &Controls, out: &mut [f64]) -> Result<(), SecondDerivativeError> {
        (**self).add_control_product(at, v, out)
    }

    fn second_vjp(
        &self,
        at: &Instant,
        lambda: &[f64],
        along: &Increment,
        into: &mut SecondSensitivities,
    ) -> Result<(), SecondDerivativeError> {
        (**self).second_vjp(at, lambda, along, into)
    }
}
