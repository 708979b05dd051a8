//! Costs: terms j(u, m) of the objective functional.

mod aim;
mod automatic_stages;
mod body_cloud;
pub(crate) mod body_points;
mod bound_hausdorff;
mod catalogue;
mod compliance;
mod contact_load;
mod contact_resultant;
mod contact_slip;
mod cost_form;
mod cost_value;
mod curvature;
mod design;
mod facet_tangents;
mod figure;
mod markers;
mod mean_displacement;
mod mean_radius;
pub(crate) mod obstacle;
pub(crate) mod of_displacement;
mod orientation;
mod output;
mod position;
mod prior;
mod pump_work;
mod reaction;
mod reading;
mod regularization;
mod shape_shrinkage;
mod smoothed_hausdorff;
mod stretch;
mod target;
mod target_positions;
mod tracking;
mod volume;

pub use aim::Aim;
pub use bound_hausdorff::BoundHausdorff;
pub use catalogue::{CATALOGUE, CostExample, CostRow};
pub use compliance::Compliance;
pub use contact_load::ContactLoad;
pub use contact_resultant::ContactResultant;
pub use contact_slip::ContactSlip;
pub use cost_form::{CostForm, CostInputs, Counts, MakeCost};
pub use cost_value::{CostTaken, CostValue, CostWords};
pub use curvature::Curvature;
pub use design::DesignMean;
pub use figure::{DistanceInTime, Figure, FigureKind};
pub use markers::{Marker, Markers};
pub use mean_displacement::MeanDisplacement;
pub use mean_radius::MeanRadius;
pub use nastic_fem::catalogue::{Key, KeyKind, Need};
pub use obstacle::ObstaclePenetration;
pub use orientation::Orientation;
pub(crate) use output::AXES;
pub use output::{Output, OutputTarget};
pub use position::MeanPosition;
pub use prior::Prior;
pub use pump_work::PumpWork;
pub use reaction::Reaction;
pub use reading::Reading;
pub use regularization::{ControlNorm, ControlSmoothness};
pub use shape_shrinkage::ShapeShrinkage;
pub use smoothed_hausdorff::SmoothedHausdorff;
pub use stretch::LargestStretch;
pub use target::CostTarget;
pub use target_positions::Target;
pub use tracking::{BoundTracking, Tracking};
pub use volume::LumenVolume;

use crate::time::Timeline;
use nastic_fem::{Controls, Solid, State};
use nastic_fields::{ControlError, Layout};
use nastic_hausdorff::Smoothing;
use nastic_numeric::vector::axpy;
use std::fmt::Debug;
use std::sync::Arc;

/// The arguments of a cost.
#[derive(Clone, Copy)]
pub struct CostContext<'a> {
    /// The body.
    pub solid: &'a Solid,
    /// The control fields.
    pub layout: &'a Layout,
    /// Displacement, flat.
    pub u: &'a [f64],
    /// The equilibrium with displacement u; `None` where a displacement alone is given. A cost that needs its tangent refuses `None`.
    pub state: Option<&'a State>,
    /// Control vector.
    pub m: &'a [f64],
    /// Continuation stage; a cost with fewer stages uses its last one.
    pub stage: usize,
    /// The beginning of the step that led to the state, for a cost of a motion that [needs it](Cost::needs_step); `None` at the first state.
    pub step: Option<&'a StepBegin>,
}

/// The beginning of a step.
#[derive(Debug, Clone)]
pub struct StepBegin {
    /// Its instant.
    pub time: f64,
    /// The controls of all contributions.
    pub controls: Arc<Controls>,
    /// Control vector of that instant.
    pub m: Vec<f64>,
}

/// Partial derivatives of a cost of a state in motion beyond those by displacement and control; empty where they are zero.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MotionPartials {
    /// By the forces that supports exert, flat and zero on free unknowns.
    pub held: Vec<f64>,
    /// By the velocity, flat.
    pub velocity: Vec<f64>,
    /// By the control vector of the instant that the step begins at.
    pub before: Vec<f64>,
}

impl MotionPartials {
    /// Adds a multiple of others.
    pub fn add(&mut self, factor: f64, other: &MotionPartials) {
        let pairs =
            [(&mut self.held, &other.held), (&mut self.velocity, &other.velocity), (&mut self.before, &other.before)];
        for (own, other) in pairs {
            own.resize(own.len().max(other.len()), 0.0);
            axpy(factor, other, &mut own[..other.len()]);
        }
    }
}

/// Partial derivatives of a cost, to be added to; also a change of the variables.
#[derive(Debug, Clone, PartialEq)]
pub struct Partials {
    /// `dj/du`, flat, supported unknowns included, followed by `dj/dp` by the multipliers of constraints; or the change of u and p.
    pub u: Vec<f64>,
    /// `dj/dm`; or the change of m.
    pub m: Vec<f64>,
}

impl Partials {
    /// Zero, for these numbers of unknowns of the state and of controls.
    pub fn zero(u: usize, m: usize) -> Self {
        Partials { u: vec![0.0; u], m: vec![0.0; m] }
    }
}

/// A term of the objective, j(u, m), bound to a body.
///
/// Implement it for your own target; the library differentiates through the state equation. Contract: `add_partials`
/// of a [`CostPoint`] is the exact derivative of its `value` (the same quadrature), `add_second_partials`, where it is
/// implemented, that of `add_partials`, and all are deterministic.
///
/// ```
/// use nastic_control::{ControlError, Cost, CostContext, CostPoint, Partials, Reduced, Space};
/// use nastic_energy::{FiberTension, NeoHooke};
/// use nastic_fem::Solid;
/// use nastic_mesh::{CellKind, box_mesh};
/// use nastic_opt::{Bounds, Taylor, Verdict};
/// use nastic_tensor::Vec3;
/// use std::sync::Arc;
///
/// /// j(u) = weight/2 sum_a |u_a|^2 over the nodes a: the less the body moves, the better. u in m, weight in 1/m^2.
/// #[derive(Debug)]
/// struct Stillness {
///     weight: f64,
/// }
///
/// /// It at one displacement.
/// #[derive(Debug)]
/// struct Moved {
///     weight: f64,
///     u: Vec<f64>,
/// }
///
/// impl Cost for Stillness {
///     fn name(&self) -> &str {
///         "stillness"
///     }
///
///     fn at(&self, at: &CostContext) -> Result<Arc<dyn CostPoint>, ControlError> {
///         Ok(Arc::new(Moved { weight: self.weight, u: at.u.to_vec() }))
///     }
/// }
///
/// impl CostPoint for Moved {
///     fn value(&self) -> f64 {
///         0.5 * self.weight * self.u.iter().map(|u| u * u).sum::<f64>()
///     }
///
///     fn add_partials(&self, out: &mut Partials) -> Result<(), ControlError> {
///         out.u.iter_mut().zip(&self.u).for_each(|(d, u)| *d += self.weight * u);
///         Ok(())
///     }
/// }
///
/// let body = Solid::new(box_mesh([1.0, 0.2, 0.2], [3, 1, 1], CellKind::Hex8)?)?
///     .material("body", NeoHooke::from_young_poisson(3e5, 0.3)?)?
///     .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
///     .clamp("x-")?;
/// let problem = Reduced::new(body).control("tension", Space::Cell)?.cost(Stillness { weight: 1.0 })?;
/// let report = Taylor::default().test(&problem, &Bounds::new(-2e5, 0.0)?, &[-1e5, -5e4, -2e4])?;
/// assert_eq!(report.verdict(), Verdict::Right);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Cost: Debug + Send + Sync {
    /// Name of the term in tables and results.
    fn name(&self) -> &str;

    /// The cost evaluated at a displacement and a control: its value, and the data of its partials and figures. The point
    /// outlives the context: a line search drops it, an accepted trial calls its partials.
    ///
    /// # Errors
    /// Where the cost is not defined.
    fn at(&self, at: &CostContext) -> Result<Arc<dyn CostPoint>, ControlError>;

    /// Whether it supports a body over ranks ([`Solid::of_part`](nastic_fem::Solid::of_part)): its values are those of the whole body, the same on all ranks, and its partial
    /// derivatives sum up over the ranks to those of the whole. All ranks call [`at`](Self::at) together, and it calls
    /// [`all_accept`](nastic_fem::views::OverRanks::all_accept) before it sends messages. All ranks call the partial derivatives of points together too, but figures separately.
    fn spans_ranks(&self) -> bool {
        false
    }

    /// Whether it is bound to this body, and not to another with other nodes. A problem calls it when a cost is added.
    fn is_of(&self, _solid: &Solid) -> bool {
        true
    }

    /// Number of continuation stages.
    fn stages(&self) -> usize {
        1
    }

    /// The exponents of every stage, of a smoothed distance.
    fn smoothings(&self) -> Vec<Smoothing> {
        vec![]
    }

    /// Sizes that determine its run time, such as numbers of points, for checks before a solve.
    fn size(&self) -> Option<String> {
        None
    }

    /// Number of terms of a sum of squared deviations: near its minimum the cost determines no more directions of the control than
    /// this; `None` for any other cost.
    fn numbers(&self) -> Option<usize> {
        None
    }

    /// Whether its figures have the distance of one point from its target, with little work: a motion then reports it over its instants.
    fn has_position(&self) -> bool {
        false
    }

    /// Checks that it can be evaluated in a motion, and at its beginning if `at_start`.
    ///
    /// # Errors
    /// A requirement that the motion does not meet.
    fn check_in_motion(&self, _solid: &Solid, _timeline: &Timeline, _at_start: bool) -> Result<(), ControlError> {
        Ok(())
    }

    /// Whether it depends on numbers of materials also beside the displacement, as the force of a support and the stored energy do: derivatives by numbers that are not controls lack that part, and are
    /// refused.
    fn depends_on_materials(&self) -> bool {
        false
    }

    /// Whether it uses [the step](CostContext::step) that led to a state.
    fn needs_step(&self) -> bool {
        false
    }

    /// Warnings for the user, such as a smoothing length below the point spacing.
    fn warnings(&self, _solid: &Solid) -> Vec<String> {
        vec![]
    }

    /// Its target shape on a body, if it has one: pictures and `target.vtu` show it.
    fn target(&self, _solid: &Solid) -> Option<CostTarget> {
        None
    }

    /// The point that it measures under a displacement, and its target: tables of motions and paths in figures show them.
    fn aim(&self, _solid: &Solid, _u: &[f64]) -> Option<Aim> {
        None
    }
}

/// A cost evaluated at one (u, m): an immutable value.
pub trait CostPoint: Debug + Send + Sync {
    /// j(u, m), weight included.
    fn value(&self) -> f64;

    /// Adds `dj/du` and `dj/dm`.
    ///
    /// # Errors
    /// A derivative that is not finite.
    fn add_partials(&self, out: &mut Partials) -> Result<(), ControlError>;

    /// The same for a state of a motion: derivatives by the forces R that supports exert ([`PrescribedUnknowns::held_forces`](nastic_fem::views::PrescribedUnknowns::held_forces)), by
    /// velocities and by the controls at the beginning of the step are added to `more` and not to `out`.
    ///
    /// # Errors
    /// A derivative that is not finite.
    fn add_partials_in_motion(&self, out: &mut Partials, _more: &mut MotionPartials) -> Result<(), ControlError> {
        self.add_partials(out)
    }

    /// Adds the change of `dj/du` and `dj/dm` along a change `(du, v)`: `j_uu du + j_um v` and `j_mu du + j_mm v`.
    ///
    /// # Errors
    /// [`ControlError::NoSecondPartials`] where the cost does not implement it (the default).
    fn add_second_partials(&self, _along: &Partials, _out: &mut Partials) -> Result<(), ControlError> {
        Err(ControlError::NoSecondPartials { cost: std::any::type_name::<Self>().to_owned() })
    }

    /// Further figures, more expensive than the value: for accepted points alone.
    ///
    /// # Errors
    /// Where they are not defined.
    fn figures(&self) -> Result<Vec<Figure>, ControlError> {
        Ok(vec![])
    }

    /// The numbers that it compares with targets, so that its value is `sum weight/2 (y - target)^2`, or the number that it is, each with its own derivatives, which are longer vectors of
    /// zeros to begin with; none of a cost of many points, of controls alone or of an integral.
    ///
    /// # Errors
    /// A derivative that is not finite.
    fn outputs(&self, _zero: &Partials) -> Result<Vec<Output>, ControlError> {
        Ok(vec![])
    }

    /// The readings that it compares the body with, marker by marker; none of any other cost.
    fn readings(&self) -> Vec<Reading> {
        vec![]
    }
}

/// A description that becomes a cost once the body is known.
pub trait IntoCost {
    /// The name under which a body over ranks refuses it; `None` for a cost that [spans ranks](Cost::spans_ranks).
    fn not_over_ranks(&self) -> Option<String> {
        Some(format!("the cost {}", std::any::type_name::<Self>().rsplit("::").next().unwrap_or_default()))
    }

    /// Looks up surfaces, samples the target, checks.
    ///
    /// # Errors
    /// Unknown names, empty targets, arrays of the wrong size.
    fn bind(self, solid: &Solid) -> Result<Box<dyn Cost>, ControlError>;
}

/// The name under which a body over ranks refuses a cost.
fn not_spanning(cost: &dyn Cost) -> Option<String> {
    (!cost.spans_ranks()).then(|| format!("the cost \"{}\"", cost.name()))
}

fn check_body(cost: &dyn Cost, solid: &Solid) -> Result<(), ControlError> {
    match cost.is_of(solid) {
        true => Ok(()),
        false => Err(ControlError::OtherBody { cost: cost.name().to_owned() }),
    }
}

impl<C: Cost + 'static> IntoCost for C {
    fn not_over_ranks(&self) -> Option<String> {
        not_spanning(self)
    }

    fn bind(self, solid: &Solid) -> Result<Box<dyn Cost>, ControlError> {
        check_body(&self, solid)?;
        Ok(Box::new(self))
    }
}

impl IntoCost for Box<dyn Cost> {
    fn not_over_ranks(&self) -> Option<String> {
        not_spanning(self.as_ref())
    }

    fn bind(self, solid: &Solid) -> Result<Box<dyn Cost>, ControlError> {
        check_body(self.as_ref(), solid)?;
        Ok(self)
    }
}

/// A weight must be a positive number.
pub(crate) fn check_weight(what: &str, weight: f64) -> Result<f64, ControlError> {
    if weight.is_finite() && weight > 0.0 {
        return Ok(weight);
    }
    Err(ControlError::Cost { what: format!("{what} has weight {weight}; weights are positive numbers") })
}
