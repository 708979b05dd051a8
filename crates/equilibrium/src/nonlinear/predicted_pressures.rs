//! [`PredictedPressures`]: pressures of nearly incompressible bodies that are not those of the displacement.
//!
//! A Newton step du changes the volumes V that nearly incompressible laws see by `B du` to first order, and by an error e of second order. The bulk modulus k makes a pressure
//! `k e` of that, which is many times the pressure of the answer: the next tangent has it in its geometric part, which is indefinite for
//! nothing else, and the potential has `k e^2 / 2`, for which a search along the step shortens it (a Maratos effect). With pressures as unknowns of their own the
//! step predicts `p + k B du`, and the next tangent has that:
//!
//! ```text
//! K_p du = -r(u),   K_p = K - sum_q w_q k_q e_q d^2 V_q / du^2,     e <- (1 - s) e + V(u_new) - V(u) - s B du
//! ```
//!
//! after a share s of the step, from e = 0. The residual is that of the displacement, so are equilibria, and there `e = 0`. This is Newton's method for the
//! principle of Hu and Washizu with its volumes and pressures eliminated from each step, exactly so where the energy is quadratic in V, else to first order.
//!
//! Sources: Magisano, Leonetti, Garcea, "How to improve efficiency and robustness of the Newton method in geometrically
//! non-linear structural problem discretized via displacement-based finite elements", CMAME 313 (2017); Nocedal & Wright, "Numerical Optimization" (2006), section 15.5, of
//! the Maratos effect.

use crate::nonlinear::equations::Equations;
use crate::nonlinear::iterate::Iterate;
use nastic_body::body_energy::dilatations::Dilatation;
use nastic_body::body_energy::volume_modes::{LEFT, STANDS_OUT};
use nastic_body::error::Inadmissible;
use nastic_body::kernels::displaced::Displaced;
use nastic_linear::SparseMatrix;

/// By quadrature points, what the last step made of the volumes.
pub(crate) struct PredictedPressures<'a> {
    equations: &'a Equations<'a>,
    /// The largest ratio of bulk to shear modulus.
    ratio: f64,
    /// e
    errors: Vec<f64>,
    /// w k
    stiffness: Vec<f64>,
    /// V, the changes of it that the step that is taken predicts, and its share.
    volumes: Vec<f64>,
    changes: Vec<f64>,
    length: f64,
    /// Of a step whose pressures are not those of `B du`: the start and the slope of its merit, beside those of the potential.
    apart: Option<[f64; 2]>,
    /// Share of the residual that errors of the volumes do not make.
    share: f64,
}

/// Least such share at which a decreasing residual indicates a saddle nearby.
const MIN_FORCE_SHARE: f64 = 0.5;

impl<'a> PredictedPressures<'a> {
    /// Those of the displacement that an iteration begins at; `None` where no cell resists changes of its volume much.
    pub fn new(equations: &'a Equations<'a>) -> Option<Self> {
        let ratio = equations.model.properties().bulk_over_shear();
        let [errors, stiffness, volumes, changes] = std::array::from_fn(|_| Vec::new());
        let pressures = PredictedPressures {
            equations,
            ratio,
            errors,
            stiffness,
            volumes,
            changes,
            length: 0.0,
            apart: None,
            share: 1.0,
        };
        (ratio >= STANDS_OUT).then_some(pressures)
    }

    /// Makes the tangent at the next iterate that with predicted pressures. What the residual is with these is a part of the residual, and forces that a
    /// solution may be wrong by are a share of it.
    pub fn add(&mut self, here: &Iterate, tangent: &mut SparseMatrix) -> Result<f64, Inadmissible> {
        let Equations { model, options, .. } = *self.equations;
        let at = here.point.displaced(here.x);
        let now = model.body.dilatations(at, Dilatation::Value, options.parallel)?;
        self.stiffness = model.body.dilatations(at, Dilatation::Stiffness, options.parallel)?;
        if self.errors.is_empty() {
            self.errors = vec![0.0; now.len()];
        } else {
            let s = self.length;
            let predicted = self.volumes.iter().zip(&self.changes).map(|(v, change)| v + s * change);
            let each = self.errors.iter_mut().zip(now.iter().zip(predicted));
            each.for_each(|(error, (now, predicted))| *error = (1.0 - s) * *error + (now - predicted));
        }
        self.volumes = now;
        let weighted: Vec<f64> = self.errors.iter().zip(&self.stiffness).map(|(e, k)| -k * e).collect();
        let mut residual = here.residual.to_vec();
        model.body.add_pressures(at, &weighted, &mut residual, tangent, options.parallel)?;
        model.supports.restrict(&mut residual);
        let space = model.unknowns();
        let (left, all) = (space.norm(&residual), space.norm(here.residual));
        self.share = if all > 0.0 { left / all } else { 1.0 };
        Ok(self.share.max(1.0 / self.ratio).min(1.0))
    }

    /// The changes of the volumes by which the next step corrects their errors.
    pub fn expected_changes(&self) -> Vec<f64> {
        self.errors.iter().map(|error| -error).collect()
    }

    /// Whether errors of the volumes make little of the residual, so that it says something of the equilibrium.
    pub fn are_settled(&self) -> bool {
        self.share >= MIN_FORCE_SHARE
    }

    /// Notes a step from there, and what it left by volume mode between its pressures and its changes of volume.
    pub fn begin(&mut self, here: &Iterate, dx: &[f64], left: Option<&[f64]>) -> Result<(), Inadmissible> {
        let (at, parallel) = (here.point.displaced(here.x), self.equations.options.parallel);
        let body = &self.equations.model.body;
        self.changes = body.dilatations(at, Dilatation::Change(dx), parallel)?;
        self.apart = None;
        if let Some(left) = left {
            let linear = self.changes.clone();
            let left = body.volume_modes_at_points(at, left, parallel)?;
            self.changes.iter_mut().zip(&left).for_each(|(change, left)| *change -= left);
            let share = self.share_of_errors();
            let sums = self.changes.iter().zip(&linear).zip(&self.stiffness);
            let [squares, products] = sums.fold([0.0, 0.0], |[squares, products], ((change, linear), k)| {
                [squares + k * change * change, products + k * change * linear]
            });
            self.apart = Some([-0.5 * share * squares, share * products]);
        }
        Ok(())
    }

    /// Notes how much of it was taken.
    pub fn end(&mut self, length: f64) {
        self.length = length;
    }

    /// Whether the pressures of the step are not those of its changes of volume.
    pub fn is_apart(&self) -> bool {
        self.apart.is_some()
    }

    /// What the merit of the step has beside the potential where it begins, and its derivative along the step: nothing where `e(0) = 0`.
    pub fn beside_potential(&self) -> [f64; 2] {
        self.apart.unwrap_or([0.0; 2])
    }

    /// `1/2 sum_q w_q k_q e_q^2` of what a share of the step leads to, less what errors would take of a body with a few times its shear modulus as bulk modulus;
    /// `e(s) = V(u(s)) - V - s B du`, or of a step whose pressures are not those of `B du`, which may go uphill in this, from the volumes of all of it.
    pub fn energy_of_errors(&self, at: Displaced, length: f64) -> Result<f64, Inadmissible> {
        let Equations { model, options, .. } = *self.equations;
        let now = model.body.dilatations(at, Dilatation::Value, options.parallel)?;
        let s = if self.apart.is_some() { 1.0 } else { length };
        let predicted = self.volumes.iter().zip(&self.changes).map(|(v, change)| v + s * change);
        let errors = now.iter().zip(predicted).map(|(now, predicted)| now - predicted);
        let sum: f64 = errors.zip(&self.stiffness).map(|(error, k)| 0.5 * k * error * error).sum();
        Ok(self.share_of_errors() * sum)
    }

    fn share_of_errors(&self) -> f64 {
        1.0 - LEFT / self.ratio
    }
}
