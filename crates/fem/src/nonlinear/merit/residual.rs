//! [`Residual`]: the norm of the residual.

use super::{Line, Merit};
use crate::error::Inadmissible;
use crate::nonlinear::equations::{Equations, Evaluated};
use crate::nonlinear::iteration::Iterate;
use nastic_numeric::vector::norm;

/// `|r|`; under constraints, which have other units than forces, the largest of the norms relative to the scale of each.
pub(in crate::nonlinear) struct Residual(f64);

impl Residual {
    pub fn new(equations: &Equations, here: &Iterate) -> Self {
        Residual(size(equations, here.residual, here.relative))
    }
}

fn size(equations: &Equations, residual: &[f64], relative: f64) -> f64 {
    if equations.model.unknowns().scalars > 0 { relative } else { norm(residual) }
}

impl Merit for Residual {
    fn line(&self) -> Line {
        Line { start: self.0, slope: -self.0, noise: 0.0 }
    }

    fn value<'e>(&self, equations: &Equations<'e>, trial: &[f64]) -> Result<(f64, Evaluated<'e>), Inadmissible> {
        let now = equations.evaluate(trial)?;
        let (residual, relative) = equations.residual(&now.sums);
        Ok((size(equations, &residual, relative), now))
    }

    fn is_energy(&self) -> bool {
        false
    }
}
