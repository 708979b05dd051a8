//! [`Settings`]: what a contact is given; [`Layer`]: what comes of it, whatever the surface touches.

use super::friction::{Coulomb, Friction};
use super::law::Pressure;
use super::pose::{ByPose, Moved, Pose};
use super::{ContactLaw, defaults};
use crate::rigid_motion;
use nastic_body::body_energy::BodyEnergy;
use nastic_body::contribution::sensitivities::Sensitivities;
use nastic_body::error::{FemError, Inadmissible};
use nastic_body::instant::Instant;
use nastic_energy::Slot;
use nastic_mesh::{Facet, GroupNames};
use nastic_tensor::Vec3;

/// What was given; `None` what is to be found.
#[derive(Debug, Clone)]
pub(super) struct Settings {
    pub name: String,
    pub surface: GroupNames,
    pub law: ContactLaw,
    pub thickness: Option<f64>,
    pub stiffness: Option<f64>,
    pub friction: Option<Friction>,
    /// Friction takes its normal forces where the step begins.
    pub lagged: bool,
    pub refine: Option<usize>,
}

/// A surface by its name and its facets.
pub(super) struct Surface<'a> {
    pub name: &'a GroupNames,
    pub facets: Vec<Facet>,
}

impl Settings {
    pub fn new(name: &str, surface: GroupNames) -> Self {
        let (name, law) = (name.to_owned(), ContactLaw::default());
        Settings { name, surface, law, thickness: None, stiffness: None, friction: None, lagged: false, refine: None }
    }

    /// Why it is refused.
    pub fn refusal(&self, what: String) -> FemError {
        FemError::Meaningless { what: format!("contact \"{}\": {what}", self.name) }
    }

    /// The layer on some surfaces, with a thickness where none is given.
    ///
    /// # Errors
    /// Numbers that are NaN or infinite; no stiffness given and no material behind a surface.
    pub fn on(&self, surfaces: &[Surface], body: &BodyEnergy, thickness: f64) -> Result<Layer, FemError> {
        let refuse = |what| self.refusal(what);
        let thickness = positive("thickness", self.thickness.unwrap_or(thickness)).map_err(refuse)?;
        let stiffness = self.stiffness(surfaces, body).map_err(refuse)?;
        let friction = self.friction.map(|friction| friction.slot(&self.name)).transpose()?;
        let own = [Slot::design("stiffness", "Pa", stiffness)].into_iter().chain(friction);
        Ok(Layer {
            name: self.name.clone(),
            dim: body.discretization().mesh().dim(),
            law: self.law,
            thickness,
            slip_speed: self.friction.map(|friction| friction.slip_speed),
            lagged: self.lagged,
            slots: own.collect(),
            stiffness: 0,
            moved: None,
        })
    }

    /// That of the softer side where none is given.
    fn stiffness(&self, surfaces: &[Surface], body: &BodyEnergy) -> Result<f64, String> {
        let behind: Option<Vec<f64>> =
            surfaces.iter().map(|surface| defaults::stiffness(self.law, body, &surface.facets)).collect();
        let usual = behind.and_then(|behind| behind.into_iter().reduce(f64::min));
        defaults::check_stiffness(self.stiffness, usual)?;
        let names = || surfaces.iter().map(|surface| surface.name.to_string()).collect::<Vec<_>>().join(" or ");
        let stiffness = self
            .stiffness
            .or(usual)
            .ok_or_else(|| format!("no passive law behind {} says how stiff the body is: give a stiffness", names()))?;
        positive("stiffness", stiffness)
    }
}

fn positive(what: &str, value: f64) -> Result<f64, String> {
    match value > 0.0 && value.is_finite() {
        true => Ok(value),
        false => Err(format!("its {what} is {value}; it must be positive and finite")),
    }
}

/// The layer in which a contact acts.
#[derive(Debug, Clone)]
pub(super) struct Layer {
    pub name: String,
    pub dim: usize,
    pub law: ContactLaw,
    /// delta
    pub thickness: f64,
    /// e, with friction.
    pub slip_speed: Option<f64>,
    /// Friction takes its normal forces where the step begins.
    pub lagged: bool,
    /// Those of a pose, the stiffness and, with friction, its coefficient.
    pub slots: Vec<Slot>,
    /// The slot of the stiffness.
    pub stiffness: usize,
    /// The obstacle, whose pose its first slots are.
    pub moved: Option<Moved>,
}

impl Layer {
    /// Before something that is moved.
    pub fn before(self, moved: Moved) -> Self {
        let slots: Vec<Slot> = rigid_motion::SLOTS.into_iter().chain(self.slots).collect();
        Layer { slots, stiffness: rigid_motion::SLOTS.len(), moved: Some(moved), ..self }
    }

    /// The pose of the obstacle.
    pub fn pose(&self, at: &Instant) -> Option<Pose> {
        self.moved.as_ref().map(|moved| Pose::at(at, moved.centre))
    }

    /// The slot of the coefficient of friction.
    pub fn friction(&self) -> usize {
        self.stiffness + 1
    }

    /// Adds derivatives by the pose of the obstacle and its velocities.
    pub fn add_pose_vjp(&self, at: &Instant, by: &ByPose, into: &mut Sensitivities) {
        if let Some(pose) = self.pose(at) {
            pose.add_vjp(at, by, self.dim, into);
        }
    }

    /// The pressure at a gap, by the stiffness k; zero beyond the layer.
    pub fn pressure(&self, k: f64, gap: f64) -> Pressure {
        match gap < self.thickness {
            true => self.law.at(gap, self.thickness).times(k),
            false => Pressure::default(),
        }
    }

    /// Why a body cannot be where a sample is so deep inside.
    pub fn penetrates(&self, place: &Vec3, depth: f64) -> Inadmissible {
        Inadmissible::Penetrates { name: self.name.clone(), place: (*place).into(), depth }
    }

    /// Friction at an instant in a step.
    pub fn coulomb(&self, at: &Instant) -> Option<Coulomb> {
        let (step, slip_speed) = (at.step?, self.slip_speed?);
        Some(Coulomb { coefficient: at.control(self.friction()), slip_speed, rate: step.velocity.0 })
    }
}
