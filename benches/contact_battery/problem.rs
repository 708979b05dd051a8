//! What a problem is: a body for the program, what it has to do, and the facts for the judge.

use crate::judge::law::Law;
use crate::judge::shape::Shape;
use nastic::fem::{Controls, SolveOptions, Strategies};
use nastic::prelude::*;
use std::sync::OnceLock;

pub type Failure = Box<dyn std::error::Error>;

/// A problem, and what it is in words.
pub struct Problem {
    pub about: String,
    pub solid: Solid,
    pub facts: Facts,
    pub task: Task,
}

/// What is to be done.
pub enum Task {
    /// An equilibrium under controls.
    Rest(Controls),
    /// A motion.
    Motion { scheme: &'static str, begin: Box<State>, dt: f64, controls: Vec<Controls> },
}

/// What the judge knows of a body beside its mesh.
#[derive(Debug, Clone, Default)]
pub struct Facts {
    pub regions: Vec<Region>,
    /// Force per mass.
    pub gravity: Vec3,
    pub touching: Vec<Touching>,
    /// Contacts of surfaces: their names and the two surfaces.
    pub pairs: Vec<(String, [String; 2])>,
    pub chamber: Option<Chamber>,
    /// Surfaces that are held, in all components.
    pub held: Vec<String>,
    pub friction: f64,
}

#[derive(Debug, Clone)]
pub struct Region {
    pub name: String,
    pub law: Law,
    pub density: f64,
    pub mean_dilatation: bool,
    pub rigid: bool,
}

/// A contact with an obstacle.
#[derive(Debug, Clone)]
pub struct Touching {
    pub name: String,
    pub surface: String,
    pub shape: Shape,
    pub centre: Vec3,
}

/// A closed surface that a pressure presses on, or whose volume is given.
#[derive(Debug, Clone)]
pub struct Chamber {
    pub name: String,
    pub surface: String,
    pub by_volume: bool,
}

/// Newton iterations of a solve or step at most.
pub const STEP_BUDGET: usize = 1500;

/// What may be tried, of all problems of a run.
pub static STRATEGIES: OnceLock<Strategies> = OnceLock::new();

pub fn options() -> SolveOptions<'static> {
    let strategies = *STRATEGIES.get_or_init(|| Strategies::ALL);
    SolveOptions { budget: Some(STEP_BUDGET), strategies, ..SolveOptions::default() }
}

/// The place of the controls of an actuation, contact or motion.
pub fn block(solid: &Solid, name: &str) -> Option<usize> {
    solid.model().controllable().iter().position(|controllable| controllable.name == name)
}
