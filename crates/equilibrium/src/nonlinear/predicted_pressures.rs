//! [`PredictedPressures`]: pressures of nearly incompressible bodies that differ from those of the displacement.
//!
//! A Newton step du changes the volumes V in nearly incompressible laws by `B du` to first order, and by an error e of second order. With the bulk modulus k
//! this error is a pressure `k e`, many times the pressure of the solution. It makes the geometric part of the next tangent indefinite, and its energy
//! `k e^2 / 2` makes the line search shorten the step (a Maratos effect). With pressures as independent unknowns the
//! step predicts `p + k B du`, and the next tangent uses this pressure:
//!
//! ```text
//! K_p du = -r(u),   K_p = K - sum_q w_q k_q e_q d^2 V_q / du^2,     e <- (1 - s) e + V(u_new) - V(u) - s B du
//! ```
//!
//! after a share s of the step, from e = 0, in a body that grows from `e = p / k`. Residual and equilibria are those of the displacement, and `e = 0` in equilibrium. This is Newton's method for the
//! principle of Hu and Washizu with volumes and pressures eliminated from each step, exactly where the energy is quadratic in V, else to first order.
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

/// Errors and changes of the volumes by the last step, by quadrature point.
pub(crate) struct PredictedPressures<'a> {
    equations: &'a Equations<'a>,
    /// The largest ratio of bulk to shear modulus.
    ratio: f64,
    /// e
    errors: Vec<f64>,
    /// w k
    stiffness: Vec<f64>,
    /// V, its changes as predicted by the present step, and the share of the step that is taken.
    volumes: Vec<f64>,
    changes: Vec<f64>,
    length: f64,
    /// For a step whose pressures are not those of `B du`: start and slope of the part of its merit that is added to the potential.
    apart: Option<[f64; 2]>,
    /// Share of the residual that errors of the volumes do not explain.
    share: f64,
}

/// Least such share at which a decreasing residual indicates a saddle nearby.
const MIN_FORCE_SHARE: f64 = 0.5;

impl<'a> PredictedPressures<'a> {
    /// The pressures of the displacement at the beginning of an iteration; `None` where no cell is nearly incompressible.
    pub fn new(equations: &'a Equations<'a>) -> Option<Self> {
        let ratio = equations.model.properties().bulk_over_shear(equations.controls());
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

    /// Corrects the tangent at the next iterate for the predicted pressures. The residual with these is a part of the whole residual, and bounds the errors of
    /// the linear solution.
    pub fn add(&mut self, here: &Iterate, tangent: &mut SparseMatrix) -> Result<f64, Inadmissible> {
        let Equations { model, options, .. } = *self.equations;
        let at = here.point.displaced(here.x);
        let controls = self.equations.controls();
        let now = model.body.dilatations(at, controls, Dilatation::Value, options.parallel)?;
        self.stiffness = model.body.dilatations(at, controls, Dilatation::Stiffness, options.parallel)?;
        if self.errors.is_empty() {
            // a body that has grown since, or has another shape, begins with other volumes than its laws keep: their pressures are none of the solution
            self.errors = match model.body.grows() {
                true => model.body.dilatations(at, controls, Dilatation::PressureError, options.parallel)?,
                false => vec![0.0; now.len()],
            };
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

    /// Whether errors of the volumes are a small share of the residual, which then indicates the distance from equilibrium.
    pub fn are_settled(&self) -> bool {
        self.share >= MIN_FORCE_SHARE
    }

    /// Records a step from `here`, and by volume mode the difference between its pressures and its changes of volume.
    pub fn begin(&mut self, here: &Iterate, dx: &[f64], left: Option<&[f64]>) -> Result<(), Inadmissible> {
        let (at, parallel) = (here.point.displaced(here.x), self.equations.options.parallel);
        let body = &self.equations.model.body;
        self.changes = body.dilatations(at, self.equations.controls(), Dilatation::Change(dx), parallel)?;
        self.apart = None;
        if let Some(left) = left {
            let linear = self.changes.clone();
            let left = body.volume_modes_at_points(at, self.equations.controls(), left, parallel)?;
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

    /// Records the share of the step that was taken.
    pub fn end(&mut self, length: f64) {
        self.length = length;
    }

    /// Whether the pressures of the step are not those of its changes of volume.
    pub fn is_apart(&self) -> bool {
        self.apart.is_some()
    }

    /// The part of the merit that is added to the potential at the start of the step, and its derivative along the step: zero where `e(0) = 0`.
    pub fn beside_potential(&self) -> [f64; 2] {
        self.apart.unwrap_or([0.0; 2])
    }

    /// `1/2 sum_q w_q k_q e_q^2` at a share of the step, less the energy of the same errors in a body whose bulk modulus is a few times its shear modulus;
    /// `e(s) = V(u(s)) - V - s B du`. For a step whose pressures are not those of `B du`, along which this may increase, e is relative to the volumes at its end.
    pub fn energy_of_errors(&self, at: Displaced, length: f64) -> Result<f64, Inadmissible> {
        let Equations { model, options, .. } = *self.equations;
        let controls = self.equations.controls();
        let now = model.body.dilatations(at, controls, Dilatation::Value, options.parallel)?;
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
