//! Which constraints act: all equations, and of inequalities `g >= 0`, `p >= 0`, `p g = 0` those that hold the body.

use super::{Model, count};
use nastic_body::contribution::constrains::Constrains;
use nastic_body::contribution::point::Need;
use nastic_body::contribution::{Contribution, Sums};
use nastic_body::error::Inadmissible;
use nastic_body::instant::Instant;
use std::sync::Arc;

/// A constraint is at its onset where `g` is below this share of the scale of its rounding.
const ONSET_TOLERANCE: f64 = 64.0 * f64::EPSILON;

impl Model {
    /// By constraint, whether it is an inequality.
    pub(crate) fn inequalities(&self) -> Vec<bool> {
        let of = |c: &Arc<dyn Contribution>| std::iter::repeat_n(has_inequalities(c.as_ref()), count(c));
        self.others.iter().flat_map(of).collect()
    }

    /// By constraint, whether it acts on an equilibrium: of inequalities those with p > 0, and those at their onset, p = 0 and g = 0.
    ///
    /// # Errors
    /// [`Inadmissible`] where a constraint needs J > 0.
    pub(crate) fn acting(&self, at: &Instant) -> Result<Vec<bool>, Inadmissible> {
        let inequalities = self.inequalities();
        if !inequalities.contains(&true) {
            return Ok(vec![true; inequalities.len()]);
        }
        let sums = self.inequality_residuals(at)?;
        let dofs = self.unknowns().nodal();
        let touches = |k: usize| at.u[k] > 0.0 || sums.force[k] >= -ONSET_TOLERANCE * sums.force_scale[k];
        Ok(inequalities.iter().enumerate().map(|(k, inequality)| !inequality || touches(dofs + k)).collect())
    }

    /// Unknowns put onto the constraints of which that is known; `None` where there are none, or it cannot be.
    pub(crate) fn restored(&self, x: &[f64]) -> Option<Vec<f64>> {
        if self.supports.ties().is_empty() || !self.unknowns().has_one_nodal_field() {
            return None;
        }
        let mut restored = x.to_vec();
        for constraints in self.others.iter().filter_map(|contribution| contribution.constrains()) {
            constraints.restored(x).into_iter().flatten().for_each(|(dof, to)| restored[dof] = to);
        }
        self.supports.extend(&mut restored[..self.unknowns().nodal()]);
        Some(restored)
    }

    /// Whether there are constraints, and all of them can be [restored](Self::restored): those of rigid bodies.
    pub(crate) fn restores_all(&self) -> bool {
        let rest = vec![0.0; self.unknowns().nodal()];
        let restores = |c: &Arc<dyn Contribution>| {
            let of = |constraints: &dyn Constrains| c.slots().is_empty() && constraints.restored(&rest).is_some();
            count(c) == 0 || c.constrains().is_some_and(of)
        };
        self.unknowns().multipliers() > 0 && self.unknowns().has_one_nodal_field() && self.others.iter().all(restores)
    }

    /// Residuals of the contributions with inequalities alone.
    ///
    /// # Errors
    /// [`Inadmissible`] where one needs J > 0.
    pub(crate) fn inequality_residuals(&self, at: &Instant) -> Result<Sums, Inadmissible> {
        self.at(at, Need::Residual)?.inequality_residuals(at)
    }

    /// Takes the residuals `-g` of inequalities with p = 0 and g > 0, which are fulfilled, out of those of a displacement u with its
    /// multipliers.
    pub(crate) fn leave_out_slack(&self, u: &[f64], sums: &mut Sums) {
        let dofs = self.unknowns().nodal();
        for (k, _) in self.inequalities().iter().enumerate().filter(|(_, inequality)| **inequality) {
            if u[dofs + k] <= 0.0 && sums.force[dofs + k] < 0.0 {
                sums.force[dofs + k] = 0.0;
            }
        }
    }
}

pub(super) fn has_inequalities(contribution: &dyn Contribution) -> bool {
    contribution.constrains().is_some_and(Constrains::are_inequalities)
}
