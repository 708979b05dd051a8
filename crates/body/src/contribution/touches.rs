//! [`Touches`]: contact, as a contribution reports it: [`Touch`], and the [`RigidPose`] of an obstacle.

use crate::contribution::Contribution;
use crate::contribution::sensitivities::Sensitivities;
use crate::error::Inadmissible;
use crate::instant::Instant;
use crate::rotation::{rotation, vector};
use nastic_tensor::{Mat3, Vec3};
use std::sync::Arc;

/// What a contribution by which a surface touches something reports.
pub trait Touches {
    /// Where the rigid obstacle is that it touches, if there is one, under the name of its pose.
    fn pose(&self, at: &Instant) -> Option<RigidPose>;

    /// What the contact carries. With friction in a step alone ([`Instant::in_step`]): else velocities count as zero. `None` where the body
    /// cannot be (the log law inside the obstacle).
    fn touch(&self, at: &Instant) -> Option<Touch>;

    /// How deep it is inside between samples ([`Touch::between`]); `None` where that is not looked for.
    fn between(&self, _: &Instant, _: &Touch) -> Option<(f64, [f64; 3])> {
        None
    }

    /// What it carries, with what is between samples: for reports.
    fn told(&self, at: &Instant) -> Option<Touch> {
        let touch = self.touch(at)?;
        Some(Touch { between: self.between(at, &touch), ..touch })
    }

    /// What it was given, or took where it was given nothing.
    fn parameters(&self) -> TouchParameters;

    /// `sum_s w_s g(p_s)` over the pressures p and areas w of the samples within the layer, of which `by` gives g and its derivative; adds
    /// the derivatives by the displacement and by the controls.
    ///
    /// # Errors
    /// [`Inadmissible`] where u is.
    fn add_pressing(
        &self,
        at: &Instant,
        by: &dyn Fn(f64) -> [f64; 2],
        by_u: &mut [f64],
        into: &mut Sensitivities,
    ) -> Result<f64, Inadmissible>;

    /// The same of the pressures that are reported (`largest_pressure`, [`nodal_pressures`](Self::nodal_pressures)), over their places and areas. Those of the samples before an
    /// obstacle; between surfaces of bodies means, since samples of both sides share what presses unevenly.
    ///
    /// # Errors
    /// [`Inadmissible`] where u is.
    fn add_pressures(
        &self,
        at: &Instant,
        by: &dyn Fn(f64) -> [f64; 2],
        by_u: &mut [f64],
        into: &mut Sensitivities,
    ) -> Result<f64, Inadmissible> {
        self.add_pressing(at, by, by_u, into)
    }

    /// `sum_s w_s p_s (|v_t| / e)^2q` over the pressures p, areas w and velocities of sliding v_t of the samples within the layer, e the slip speed, at the end
    /// of a step ([`Instant::in_step`]); adds the derivatives by the displacement at fixed velocities, and by the latter and the controls at both ends of
    /// the step. `None` without friction.
    ///
    /// # Errors
    /// [`Inadmissible`] where u is.
    fn add_slip(
        &self,
        at: &Instant,
        q: u32,
        by_u: &mut [f64],
        into: &mut Sensitivities,
    ) -> Result<Option<f64>, Inadmissible>;

    /// Displacements that what touches at an instant resists, each a sum of weighted unknowns: `n . u` of every sample in the layer. `None` where
    /// the body cannot be.
    fn resists_at(&self, at: &Instant) -> Option<Vec<Vec<(u32, f64)>>>;

    /// Which of its samples touch and slip, and how many are about to change that. With friction in a step ([`Instant::in_step`]). `None` where the body cannot be.
    fn onsets(&self, at: &Instant) -> Option<Onsets>;

    /// The same contact with multipliers by a state, so that its layer takes up no gap; `None` where there is no such thing.
    fn exact(&self, _: &Instant) -> Option<ExactContact> {
        None
    }

    /// The pressure at every node of the surface (Pa): the mean of its samples, by their shares of the node; between surfaces of bodies the
    /// one of [`add_pressures`](Self::add_pressures).
    fn nodal_pressures(&self, at: &Instant) -> Vec<(u32, f64)>;
}

/// What a sample of a contact does: where that changes, second derivatives jump.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SampleState {
    /// It is beyond the layer.
    Free,
    /// It touches; with friction it slides slower than the slip speed.
    Touches,
    /// It slides at the slip speed or faster.
    Slips,
}

/// What the samples of a contact do.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Onsets {
    /// By sample.
    pub states: Vec<SampleState>,
    /// How many are within 1 % of another state, by the gap over the thickness and the velocity over the slip speed.
    pub near: usize,
}

impl Onsets {
    /// Within what share of an onset a sample is near to it.
    const NEAR: f64 = 0.01;

    /// Adds a sample with a gap as a share of the thickness, that slides, if it touches, with these shares of the slip speed.
    pub fn add(&mut self, gap: f64, slides: &[f64]) {
        let near = |share: &f64| (share - 1.0).abs() < Self::NEAR;
        let slides = if gap < 1.0 { slides } else { &[] };
        self.near += usize::from(near(&gap) || slides.iter().any(near));
        self.states.push(match () {
            () if gap >= 1.0 => SampleState::Free,
            () if slides.iter().any(|share| *share >= 1.0) => SampleState::Slips,
            () => SampleState::Touches,
        });
    }
}

/// A contact with multipliers by a state.
#[derive(Debug, Clone)]
pub struct ExactContact {
    /// What takes its place.
    pub contribution: Arc<dyn Contribution>,
    /// Largest gap of a sample that is pressed, and depth of one that is not, in thicknesses of the layer.
    pub violation: f64,
    /// Samples that touch almost without a pressure.
    pub weakly_active: usize,
}

/// What a contact is made of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TouchParameters {
    /// Thickness of the layer, m.
    pub thickness: f64,
    /// How deep inside the obstacle gaps count from, of a body that touches at rest, m.
    pub inset: f64,
    /// Stiffness at rest, Pa.
    pub stiffness: f64,
    /// Friction coefficient at rest and slip speed, if it has friction.
    pub friction: Option<(f64, f64)>,
    /// Whether friction takes its normal forces where a step begins.
    pub lagged: bool,
    /// Area of the surface.
    pub area: f64,
    /// Number of samples.
    pub samples: usize,
    /// How deep a round obstacle enters between samples at their mean distance h, `h^2 / (8 R)`; zero of a plane one.
    pub between_samples: f64,
}

/// What a contact carries at an instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Touch {
    /// Force on the body, of two surfaces on the first, N, in plane strain per unit of thickness.
    pub force: [f64; 3],
    /// What it presses with: the sum of pressures times areas.
    pub pressing: f64,
    /// Its moment about the obstacle's centre, of surfaces about the origin, N m.
    pub moment: [f64; 3],
    /// Reference area of the samples within the layer.
    pub area: f64,
    /// Smallest signed distance of a sample; below zero it is inside the obstacle.
    pub smallest_gap: f64,
    /// Where that sample is.
    pub deepest: [f64; 3],
    /// The same with places between samples, four times as dense, and where it is smallest; of obstacles, for reports ([`Touches::told`]).
    pub between: Option<(f64, [f64; 3])>,
    /// Largest pressure, Pa.
    pub largest_pressure: f64,
    /// Mean gap that remains, weighted by the pressure; zero where nothing touches.
    pub mean_gap: f64,
    /// How deep the undeformed body would overlap the obstacle where that is now; zero where it would not, and between surfaces.
    pub approach: f64,
    /// Where gaps count from (see `Contact::settled`) less the gap of that sample: above zero the pressure is larger
    /// than the stiffness.
    pub sunk: f64,
    /// With friction how it slides.
    pub sliding: Option<Sliding>,
}

/// How a contact with friction slides in a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sliding {
    /// Share of the normal force whose samples slide slower than the slip speed; 1 where nothing touches.
    pub sticking: f64,
    /// Largest velocity at which a sample within the layer slides.
    pub speed: f64,
    /// The speed below which friction is smoothed.
    pub slip_speed: f64,
}

impl Touch {
    /// Of what does not touch, by its smallest gap and where that is.
    pub fn none(smallest_gap: f64, deepest: [f64; 3]) -> Self {
        Touch {
            force: [0.0; 3],
            pressing: 0.0,
            moment: [0.0; 3],
            area: 0.0,
            smallest_gap,
            deepest,
            between: None,
            largest_pressure: 0.0,
            mean_gap: 0.0,
            approach: 0.0,
            sunk: 0.0,
            sliding: None,
        }
    }

    /// As named numbers, of a body in so many dimensions.
    #[must_use]
    pub fn quantities(&self, dim: usize) -> Vec<(&'static str, f64)> {
        let (force, moment) = (self.force, self.moment);
        let mut found = vec![("force_x", force[0]), ("force_y", force[1])];
        if dim == 3 {
            found.extend([("force_z", force[2]), ("moment_x", moment[0]), ("moment_y", moment[1])]);
        }
        found.extend([
            ("moment_z", moment[2]),
            ("pressing", self.pressing),
            ("area", self.area),
            ("smallest_gap", self.smallest_gap),
            ("mean_gap", self.mean_gap),
            ("approach", self.approach),
            ("largest_pressure", self.largest_pressure),
        ]);
        found.extend(self.between.map(|(gap, _)| ("gap_between", gap)));
        let sliding = self.sliding.map(|sliding| [("sticking", sliding.sticking), ("sliding_speed", sliding.speed)]);
        found.extend(sliding.into_iter().flatten());
        found
    }
}

/// A rigid motion `x = c + tau + R(theta) (X - c)` of what touches the body, with its name.
#[derive(Debug, Clone, PartialEq)]
pub struct RigidPose {
    /// What is moved.
    pub name: String,
    centre: Vec3,
    translation: Vec3,
    rotation: Mat3,
}

impl RigidPose {
    /// By a translation (m) and a rotation vector (radians) about a centre.
    #[must_use]
    pub fn new(name: &str, centre: [f64; 3], translation: [f64; 3], theta: [f64; 3]) -> Self {
        let [centre, translation, theta] = [centre, translation, theta].map(Vec3::from);
        RigidPose { name: name.to_owned(), centre, translation, rotation: rotation(&theta) }
    }

    /// Where a point that moves with the obstacle is when that goes to another pose.
    #[must_use]
    pub fn carry(&self, to: &RigidPose, x: [f64; 3]) -> [f64; 3] {
        let own = self.centre + self.rotation.transpose() * (Vec3::from(x) - self.centre - self.translation);
        to.apply(own.into())
    }

    /// Where its centre is.
    pub fn pivot(&self) -> Vec3 {
        self.centre + self.translation
    }

    /// The way of its centre to another pose, and the vector of the rotation that leads there.
    pub fn way(&self, to: &RigidPose) -> [Vec3; 2] {
        [to.pivot() - self.pivot(), vector(&(to.rotation * self.rotation.transpose()))]
    }

    /// Where a point goes.
    #[must_use]
    pub fn apply(&self, x: [f64; 3]) -> [f64; 3] {
        (self.centre + self.translation + self.rotation * (Vec3::from(x) - self.centre)).into()
    }
}
