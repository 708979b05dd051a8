//! [`RayleighDamping`]: forces in proportion to mass and stiffness at rest.

use crate::inertia::add_linear;
use nastic_body::contribution::point::{ContributionPoint, Need};
use nastic_body::contribution::sensitivities::{Increment, SecondSensitivities, Sensitivities};
use nastic_body::contribution::{Contribution, Demand, Sums};
use nastic_body::error::{Inadmissible, SecondDerivativeError};
use nastic_body::instant::Instant;
use nastic_linear::SparseMatrix;
use nastic_numeric::vector::axpy;

/// **Residual.** `r = C v`, `C = a0 M + a1 K(0)`, M the mass of all contributions (a0 in 1/s) and K(0) the tangent of
/// the body at rest without controls (a1 in s), the cells of rigid bodies left out.
///
/// K of the present state may be indefinite and would then feed energy to the motion. The price: a rigid rotation is
/// damped by a1, any rigid motion by a0. The damping is not objective. A mode of small vibrations with frequency w
/// has the damping ratio `(a0/w + a1 w)/2`.
///
/// **Potential.** In a time step with `v = c u + b`: `v . C v / (2 c)`, the incremental one; its tangent is `c C`.
#[derive(Debug)]
pub struct RayleighDamping {
    matrix: SparseMatrix,
}

impl RayleighDamping {
    /// What it is called in messages and results.
    pub const NAME: &str = "rayleigh damping";

    /// With the matrix C.
    pub fn new(matrix: SparseMatrix) -> Self {
        RayleighDamping { matrix }
    }

    fn times(&self, v: &[f64], parallel: bool) -> Vec<f64> {
        let mut out = vec![0.0; v.len()];
        self.matrix.multiply_on(v, &mut out, parallel);
        out
    }
}

impl Contribution for RayleighDamping {
    fn name(&self) -> &str {
        Self::NAME
    }

    fn is_stiff(&self) -> bool {
        false
    }

    fn at<'a>(&'a self, _: &Instant, _: Need) -> Result<Box<dyn ContributionPoint + 'a>, Inadmissible> {
        Ok(Box::new(self))
    }
}

impl ContributionPoint for RayleighDamping {
    fn add_residual(&self, at: &Instant, demand: Demand, sums: &mut Sums) -> Result<(), Inadmissible> {
        let Some(step) = at.step else { return Ok(()) };
        let velocity: Vec<f64> = (0..at.u.len()).map(|dof| at.velocity(dof)).collect();
        let force = self.times(&velocity, at.parallel);
        add_linear(at, step.velocity.0, &velocity, &force, demand, sums);
        Ok(())
    }

    fn add_tangent(&self, at: &Instant, tangent: &mut SparseMatrix) -> Result<(), Inadmissible> {
        if let Some(step) = at.step {
            tangent.add_scaled(step.velocity.0, &self.matrix)?;
        }
        Ok(())
    }

    fn add_tangent_product(&self, at: &Instant, v: &[f64], out: &mut [f64]) -> Result<bool, Inadmissible> {
        if let Some(step) = at.step {
            axpy(step.velocity.0, &self.times(v, at.parallel), out);
        }
        Ok(true)
    }

    fn vjp(&self, at: &Instant, lambda: &[f64], into: &mut Sensitivities) -> Result<(), Inadmissible> {
        if at.step.is_some() {
            axpy(1.0, &self.times(lambda, at.parallel), &mut into.velocity);
        }
        Ok(())
    }

    fn second_vjp(
        &self,
        _: &Instant,
        _: &[f64],
        _: &Increment,
        _: &mut SecondSensitivities,
    ) -> Result<(), SecondDerivativeError> {
        Ok(()) // linear
    }
}
