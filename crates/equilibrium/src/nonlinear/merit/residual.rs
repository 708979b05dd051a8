//! [`Residual`]: the norm of the residual.

use super::{Line, Merit};
use crate::nonlinear::equations::{Equations, Evaluated};
use crate::nonlinear::iterate::Iterate;
use nastic_body::error::Inadmissible;

/// `|r|`; under constraints and with further fields, which have other units than forces, the largest of the norms relative to the scale of each.
pub(crate) struct Residual(f64);

impl Residual {
    pub fn new(equations: &Equations, here: &Iterate) -> Self {
        Residual(size(equations, here.residual, here.relative))
    }
}

fn size(equations: &Equations, residual: &[f64], relative: f64) -> f64 {
    let space = equations.model.unknowns();
    let of_one_kind = space.multipliers() == 0 && space.has_one_nodal_field();
    if of_one_kind { space.norm(residual) } else { relative }
}

impl Merit for Residual {
    fn line(&self) -> Line {
        Line { start: self.0, slope: -self.0, noise: 0.0 }
    }

    fn value<'e>(
        &self,
        equations: &Equations<'e>,
        trial: &[f64],
        _length: f64,
    ) -> Result<(f64, Evaluated<'e>), Inadmissible> {
        let now = equations.evaluate(trial)?;
        let (residual, relative) = equations.residual(&now.sums);
        Ok((size(equations, &residual, relative), now))
    }

    fn is_energy(&self) -> bool {
        false
    }
}
