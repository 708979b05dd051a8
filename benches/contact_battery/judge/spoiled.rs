//! Answers that are spoiled on purpose, to see that every check can fail.

use crate::problem::{Problem, block};
use crate::solve::Solved;
use nastic::fem::{State, Touch};
use nastic::numeric::Random;
use std::sync::Arc;

/// What is made wrong: by a share of its size, where nothing else is said.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Spoil {
    Displacement,
    Velocity,
    Acceleration,
    Force,
    Moment,
    /// Half of what presses is said.
    Pressing,
    /// Nodes lie deeper than is said, by two thicknesses of the layer.
    Gap,
    /// Samples are said to be pressed through.
    Sunk,
    Friction,
    Density,
    Law,
    /// What a chamber was to take in.
    Volume,
    /// The judge takes another surface for the wall of a chamber.
    Room,
    /// One surface is shaken into the other.
    Crossing,
    /// The body is three times as fast at the end.
    Energy,
}

impl Spoil {
    pub const ALL: [Spoil; 15] = [
        Spoil::Displacement,
        Spoil::Velocity,
        Spoil::Acceleration,
        Spoil::Force,
        Spoil::Moment,
        Spoil::Pressing,
        Spoil::Gap,
        Spoil::Sunk,
        Spoil::Friction,
        Spoil::Density,
        Spoil::Law,
        Spoil::Volume,
        Spoil::Room,
        Spoil::Crossing,
        Spoil::Energy,
    ];

    /// The facts of a problem.
    pub fn problem(self, problem: &mut Problem) {
        let facts = &mut problem.facts;
        match self {
            Spoil::Friction => facts.friction *= 0.3,
            Spoil::Density => facts.regions.iter_mut().for_each(|region| region.density *= 1.001),
            Spoil::Law => facts.regions.iter_mut().for_each(|region| region.law = region.law.scaled(1.001)),
            Spoil::Room => {
                let other = facts.touching.first().map(|touching| touching.surface.clone()).unwrap_or_default();
                facts.chamber.iter_mut().for_each(|chamber| chamber.surface.clone_from(&other));
            }
            _ => {}
        }
    }

    /// The last state.
    pub fn answer(self, problem: &Problem, solved: &mut Solved) {
        let Some(last) = solved.states.last_mut() else { return };
        let size = problem.solid.mesh().diagonal();
        match self {
            Spoil::Displacement => shake(&mut last.u, 1e-5 * size),
            Spoil::Velocity => rate(&mut last.velocity, 1.01),
            Spoil::Acceleration => rate(&mut last.acceleration, 1.01),
            Spoil::Energy => rate(&mut last.velocity, 3.0),
            Spoil::Crossing => crossed(problem, last, 0.05 * size),
            Spoil::Volume => {
                let chamber = problem.facts.chamber.as_ref().and_then(|chamber| block(&problem.solid, &chamber.name));
                if let Some(k) = chamber {
                    Arc::make_mut(&mut last.controls).values_mut(k)[0] *= 1.1;
                }
            }
            _ => {}
        }
    }

    /// What is reported of a contact.
    pub fn touch(self, touch: &mut Touch, thickness: f64) {
        match self {
            Spoil::Force => touch.force.iter_mut().for_each(|force| *force *= 1.001),
            Spoil::Moment => touch.moment.iter_mut().for_each(|moment| *moment *= 1.001),
            Spoil::Pressing => touch.pressing *= 0.5,
            Spoil::Gap => touch.smallest_gap += thickness * 2.0,
            Spoil::Sunk => touch.sunk += 2.0 * thickness,
            _ => {}
        }
    }
}

fn shake(u: &mut Arc<Vec<f64>>, by: f64) {
    let mut random = Random::new(7);
    Arc::make_mut(u).iter_mut().for_each(|u| *u += by * random.symmetric());
}

fn rate(of: &mut Option<Arc<Vec<f64>>>, factor: f64) {
    of.iter_mut().for_each(|of| Arc::make_mut(of).iter_mut().for_each(|value| *value *= factor));
}

/// The nodes of the last region, shaken up and down.
fn crossed(problem: &Problem, state: &mut State, by: f64) {
    let (mesh, dim) = (problem.solid.mesh(), problem.solid.mesh().dim());
    if problem.facts.pairs.is_empty() {
        return;
    }
    let cells = problem.facts.regions.last().and_then(|region| mesh.regions().get(&region.name));
    let nodes = mesh.nodes_of_cells(cells.map_or(&[], |cells| cells));
    let mut random = Random::new(3);
    let u = Arc::make_mut(&mut state.u);
    for node in nodes {
        u[dim * node as usize + dim - 1] += by * random.symmetric();
    }
}
