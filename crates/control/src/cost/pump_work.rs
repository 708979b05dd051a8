//! [`PumpWork`]: the work it takes to bring a body from rest to its state.

use super::{Cost, CostContext, CostForm, CostPoint, Partials, check_weight};
use nastic_energy::Slot;
use nastic_fem::Solid;
use nastic_fields::{ControlError, ControlTarget, Layout};
use nastic_numeric::vector::{axpy, dot};
use std::sync::Arc;

/// Work of the pumps, and of whatever else drives the body, on a slow way from rest:
///
/// ```text
/// j(u) = weight W(u),    W = int Psi(F) dX - f . u
/// ```
///
/// with the energy Psi that the passive materials store and the dead loads f. On a way of equilibria whose cavities alone change,
/// `dW = sum_k p_k dV_k` (the potential is stationary under the volumes as constraints), so W is the work `sum_k int p_k dV_k` of the
/// pumps, on every such way; `p (V - V_0)` is not: of a linear body it is twice the work. Other actuations and moved supports add
/// theirs. Work of backflow is counted as regained. Beside springs, foundations and elastic tendons, whose energy it does not
/// know, and of controls that change the body itself, it is refused. Units: N m (N in plane strain: per thickness).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PumpWork {
    weight: f64,
}

impl PumpWork {
    /// Its name.
    pub const NAME: &'static str = "pump_work";

    /// With a weight.
    ///
    /// # Errors
    /// A weight that is not a positive number.
    pub fn new(weight: f64) -> Result<Self, ControlError> {
        Ok(PumpWork { weight: check_weight(Self::NAME, weight)? })
    }
}

impl Cost for PumpWork {
    fn name(&self) -> &str {
        Self::NAME
    }

    fn depends_on_materials(&self) -> bool {
        true
    }

    fn at(&self, at: &CostContext) -> Result<Arc<dyn CostPoint>, ControlError> {
        check_stored(at.solid)?;
        check_layout(at.solid, at.layout)?;
        let body = at.solid.body();
        // Without their controls actuations store nothing.
        let mut sums = body.evaluate(at.u, &body.controls(), true, false)?;
        let lifted = dot(at.solid.dead_load(), at.u);
        axpy(-1.0, at.solid.dead_load(), &mut sums.force);
        let value = self.weight * (sums.energy - lifted);
        Ok(Arc::new(EvaluatedCost {
            weight: self.weight,
            solid: at.solid.clone(),
            u: at.u.to_vec(),
            value,
            force: sums.force,
        }))
    }
}

/// Refuses what stores energy beside the body, which the work would leave out.
fn check_stored(solid: &Solid) -> Result<(), ControlError> {
    if solid.body().grows() {
        let what = "the work of pumps does not count that of a growth; leave one of them out".to_owned();
        return Err(ControlError::Cost { what });
    }
    let Some(name) = solid.model().properties().storing() else { return Ok(()) };
    let what = format!(
        "the work of pumps is that of the body alone: what \"{name}\" stores is not counted; leave one of them out"
    );
    Err(ControlError::Cost { what })
}

/// Refuses controls that are numbers of the body or its fill: the work is that of the body at rest values of these.
fn check_layout(solid: &Solid, layout: &Layout) -> Result<(), ControlError> {
    let all = solid.model().controllable();
    let of_body = |target: &ControlTarget| {
        let own = &all[target.actuation];
        own.regions.is_some() && own.slots.get(target.slot).is_some_and(Slot::is_design)
    };
    let Some(block) = layout.blocks().iter().find(|block| block.targets.iter().any(of_body)) else { return Ok(()) };
    let what = format!(
        "the work of pumps takes the body as it is at rest, and \"{}\" changes it: leave one of them out",
        block.shown.name
    );
    Err(ControlError::Cost { what })
}

/// How it stands in case files.
pub(super) const FORM: CostForm = CostForm::new(
    PumpWork::NAME,
    "work of the pumps of cavities, and of whatever else drives the body, from rest",
    &[],
    |on| {
        check_stored(on.solid)?;
        Ok(Box::new(PumpWork { weight: on.weight }))
    },
);

#[derive(Debug)]
struct EvaluatedCost {
    weight: f64,
    solid: Solid,
    u: Vec<f64>,
    value: f64,
    /// `dW/du`.
    force: Vec<f64>,
}

impl CostPoint for EvaluatedCost {
    fn value(&self) -> f64 {
        self.value
    }

    fn add_partials(&self, out: &mut Partials) -> Result<(), ControlError> {
        axpy(self.weight, &self.force, &mut out.u);
        Ok(())
    }

    fn add_second_partials(&self, along: &Partials, out: &mut Partials) -> Result<(), ControlError> {
        let body = self.solid.body();
        let mut change = vec![0.0; self.u.len()];
        body.tangent_product(&self.u, &body.controls(), &along.u[..self.u.len()], &mut change, false)?;
        axpy(self.weight, &change, &mut out.u);
        Ok(())
    }
}
