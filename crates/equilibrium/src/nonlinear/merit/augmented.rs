//! [`Augmented`]: the augmented Lagrangian of constraints.

use super::{Line, Merit};
use crate::nonlinear::equations::{Equations, Evaluated, moved};
use crate::nonlinear::iterate::Iterate;
use nastic_body::contribution::Sums;
use nastic_body::error::Inadmissible;

/// Relative violation up to which the constraints of rigid bodies count as fulfilled: the penalty does not grow for less.
const MAX_FULFILLED_VIOLATION: f64 = 1e-9;

/// With the potential `P(u)`, constraints `g(u) = 0` and the multiplier `q = p + dp` behind the step, where the residual is `r + B dp` and
/// the slope along the step `-du . K du - c |g|^2`:
///
/// ```text
/// M(u) = P(u) - q g(u) + c/2 |g(u)|^2,    c |g|^2 = |a|, or 3 |a| where a < 0,    a = du . K du
/// ```
///
/// Multipliers of inequalities stay positive along a step, since q is, and what counts of an inequality with `q = 0` is its violation
/// `min(0, g)`. Source: Nocedal & Wright, "Numerical Optimization" (2006), sections 18.1 to 18.5.
pub(crate) struct Augmented {
    line: Line,
    /// `c` over the square of the constraint's scale.
    weights: Vec<f64>,
    /// q
    multipliers: Vec<f64>,
}

impl Augmented {
    pub fn new(equations: &Equations, here: &Iterate, dx: &[f64], scale: f64) -> Result<Self, Inadmissible> {
        let dofs = equations.dofs();
        let multipliers = moved(&here.x[dofs..], &dx[dofs..], 1.0);
        let line = Line { start: 0.0, slope: 0.0, noise: 64.0 * f64::EPSILON * scale };
        let mut merit = Augmented { line, weights: Vec::new(), multipliers };
        let at_new = equations.sums(here.point, &merit.with_multipliers(here.x, dofs))?;
        let (mut force, _) = equations.residual(&at_new);
        force.truncate(dofs);
        let slope = equations.model.unknowns().dot(&force, &dx[..dofs]);
        let relative: Vec<f64> = violations(&at_new, dofs).map(|(g, scale)| g / scale).collect();
        let size = equations.model.unknowns().norm(&relative).powi(2);
        let fulfilled = if equations.turns_rigid_bodies() { MAX_FULFILLED_VIOLATION } else { 0.0 };
        let bent = if slope < 0.0 { slope.abs() } else { 3.0 * slope.abs() };
        let weight = Some(bent / size.max(fulfilled * fulfilled)).filter(|weight| weight.is_finite()).unwrap_or(0.0);
        merit.weights = violations(&at_new, dofs).map(|(_, scale)| weight / (scale * scale)).collect();
        merit.line.start = merit.of(&at_new, dofs);
        // of c/2 |g|^2 along a step on whose linear model g vanishes
        merit.line.slope = slope - weight * size;
        Ok(merit)
    }

    /// A displacement with the multipliers of the whole step.
    fn with_multipliers(&self, x: &[f64], dofs: usize) -> Vec<f64> {
        x[..dofs].iter().chain(&self.multipliers).copied().collect()
    }

    fn of(&self, at_new: &Sums, dofs: usize) -> f64 {
        let weighted = violations(at_new, dofs).zip(&self.weights);
        at_new.energy + weighted.map(|((g, _), weight)| 0.5 * weight * g * g).sum::<f64>()
    }
}

/// Values of the constraints, and what they are measured against.
fn violations(now: &Sums, dofs: usize) -> impl Iterator<Item = (f64, f64)> {
    let scale = |scale: &f64| if *scale > 0.0 { *scale } else { 1.0 };
    now.force[dofs..].iter().map(|r| -r).zip(now.force_scale[dofs..].iter().map(scale))
}

impl Merit for Augmented {
    fn line(&self) -> Line {
        self.line
    }

    fn value<'e>(
        &self,
        equations: &Equations<'e>,
        trial: &[f64],
        _length: f64,
    ) -> Result<(f64, Evaluated<'e>), Inadmissible> {
        let dofs = equations.dofs();
        let at_new = equations.evaluate(&self.with_multipliers(trial, dofs))?;
        Ok((self.of(&at_new.sums, dofs), at_new))
    }

    fn accepted<'e>(
        &self,
        equations: &Equations<'e>,
        x: &[f64],
        length: f64,
        at_new: Evaluated<'e>,
    ) -> Result<Evaluated<'e>, Inadmissible> {
        if length == 1.0 {
            return Ok(at_new);
        }
        Ok(Evaluated { sums: equations.sums(&at_new.point, x)?, point: at_new.point })
    }
}
