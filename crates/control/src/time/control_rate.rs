//! [`ControlRate`]: a cost of fast changes of a control.

use super::Timeline;
use super::trajectory_cost::{TrajectoryContext, TrajectoryCost, TrajectoryPartials};
use crate::cost::{CostForm, Key, check_weight};
use nastic_fields::{ControlBlock, ControlError, Layout, mass_product};

/// `j = (weight/2) int_0^T int |dm/dt|^2 dX dt` of a control in time, linear between its knots; of one that is constant between them, with
/// the differences of neighbouring values over the distance of the middles of their intervals. Together with
/// [`ControlNorm`](crate::ControlNorm) over the time it is the H1 norm in time.
///
/// Units: the weight's times Pa^2 m^3 / s for a tension.
#[derive(Debug, Clone)]
pub struct ControlRate {
    of: String,
    weight: f64,
}

impl ControlRate {
    /// Of the named control.
    ///
    /// # Errors
    /// A weight that is not positive.
    pub fn of(control: &str, weight: f64) -> Result<Self, ControlError> {
        Ok(ControlRate { of: control.to_owned(), weight: check_weight("control_rate", weight)? })
    }

    /// Calls back with each pair of neighbouring knots' entries in the control vector, their difference's image under the
    /// mass, and the factor `weight / dt`.
    fn for_each(
        &self,
        at: &TrajectoryContext,
        mut each: impl FnMut(&[f64], &[f64], f64, [usize; 2]),
    ) -> Result<(), ControlError> {
        let block = at.layout.block(&self.of)?;
        let size = block.size();
        let (m, disc) = (block.of(at.m), at.solid.discretization());
        for (k, dt) in intervals(block).into_iter().enumerate() {
            let change: Vec<f64> = (0..size).map(|i| m[(k + 1) * size + i] - m[k * size + i]).collect();
            let mut image = vec![0.0; size];
            for c in 0..block.components {
                let component: Vec<f64> = change.iter().skip(c).step_by(block.components).copied().collect();
                let own = mass_product(disc, &block.basis, &component);
                image.iter_mut().skip(c).step_by(block.components).zip(&own).for_each(|(out, a)| *out = *a);
            }
            each(&change, &image, self.weight / dt, [block.first + k * size, block.first + (k + 1) * size]);
        }
        Ok(())
    }
}

/// The distances in time of neighbouring values.
pub(super) fn intervals(block: &ControlBlock) -> Vec<f64> {
    let instants = block.knots.as_ref().map(|knots| knots.instants()).unwrap_or_default();
    instants.windows(2).map(|pair| pair[1] - pair[0]).collect()
}

/// Refuses controls without values in time.
pub(super) fn check_in_time(what: &str, of: &str, layout: &Layout) -> Result<(), ControlError> {
    match layout.block(of)?.knots {
        Some(_) => Ok(()),
        None => {
            let what = format!("{what} of \"{of}\", which is constant in time: give the control knots in time");
            Err(ControlError::Cost { what })
        }
    }
}

/// How it stands in case files.
pub(crate) const FORM: CostForm = CostForm::of_motion(
    "control_rate",
    "weight/2 int int |dm/dt|^2 dX dt of a control that changes in time",
    &[Key::CONTROL],
    |on| Ok(Box::new(ControlRate::of(&on.get::<String>("of")?, on.weight)?)),
)
.square()
.words(|words| format!("weight/2 int int |d{}/dt|^2", words.text("of")));

impl TrajectoryCost for ControlRate {
    fn name(&self) -> &str {
        "control_rate"
    }

    fn check(&self, layout: &Layout, _: &Timeline) -> Result<(), ControlError> {
        check_in_time("the rate", &self.of, layout)
    }

    fn needs_states(&self) -> bool {
        false
    }

    fn value(&self, at: &TrajectoryContext) -> Result<f64, ControlError> {
        let mut value = 0.0;
        self.for_each(at, |change, image, factor, _| {
            value += 0.5 * factor * change.iter().zip(image).map(|(a, b)| a * b).sum::<f64>();
        })?;
        Ok(value)
    }

    fn add_partials(&self, at: &TrajectoryContext, out: &mut TrajectoryPartials) -> Result<(), ControlError> {
        self.for_each(at, |_, image, factor, [here, there]| {
            for (i, a) in image.iter().enumerate() {
                out.m[here + i] -= factor * a;
                out.m[there + i] += factor * a;
            }
        })
    }
}
