//! Problems through the program.

use crate::problem::{Failure, Problem, Task, options};
use nastic::fem::schemes::SCHEMES;
use nastic::fem::{Scheme, StateError, StepTo, TimeStepping, Trajectory, Workspace};
use nastic::prelude::*;

/// Newton iterations of a problem at most.
pub const BUDGET: usize = 6000;

/// An answer.
pub struct Solved {
    /// Of an equilibrium one, of a motion all.
    pub states: Vec<State>,
    /// Of a motion.
    pub scheme: Option<Scheme>,
    pub newton: usize,
}

/// None.
pub struct Unsolved {
    pub why: Failure,
    /// Cut by a budget of Newton iterations.
    pub cut: bool,
    /// The last state that was found.
    pub last: Option<State>,
}

impl From<Failure> for Unsolved {
    fn from(why: Failure) -> Self {
        Unsolved { why, cut: false, last: None }
    }
}

fn unsolved(error: StateError, reached: Option<&State>) -> Unsolved {
    let inner = match &error {
        StateError::InStep { source, .. } => source,
        other => other,
    };
    let cut = matches!(inner, StateError::NoConvergence { budget: Some(_), .. });
    let last = match inner {
        StateError::Inadmissible { last, .. } | StateError::NoConvergence { last, .. } => Some((**last).clone()),
        _ => None,
    };
    Unsolved { cut, last: last.or(reached.cloned()), why: error.into() }
}

/// # Errors
/// [`Unsolved`].
pub fn solve(problem: &Problem) -> Result<Solved, Unsolved> {
    let solid = &problem.solid;
    match &problem.task {
        Task::Rest(controls) => {
            let state = solid.solve(controls, &options()).map_err(|error| unsolved(error, None))?;
            let newton = state.report.newton;
            Ok(Solved { states: vec![state], scheme: None, newton })
        }
        Task::Motion { scheme, begin, dt, controls } => {
            let row = SCHEMES.iter().find(|row| row.name == *scheme);
            let row = row.ok_or_else(|| Failure::from(format!("no scheme {scheme}")))?;
            let scheme = (row.build)().map_err(Failure::from)?;
            let mut trajectory = Trajectory::from_given((**begin).clone());
            let (mut workspace, mut newton) = (Workspace::default(), 0);
            for controls in controls {
                let step = [StepTo { dt: *dt, controls: controls.clone() }];
                let made = solid.model().advance(&mut trajectory, &scheme, &step, &options(), &mut workspace);
                made.map_err(|error| unsolved(error, Some(trajectory.end())))?;
                newton += trajectory.end().report.newton;
                if newton > BUDGET {
                    let why = format!("{newton} Newton iterations until t = {:.3e}", trajectory.end().time).into();
                    return Err(Unsolved { why, cut: true, last: Some(trajectory.end().clone()) });
                }
            }
            Ok(Solved { states: trajectory.states().to_vec(), scheme: Some(scheme), newton })
        }
    }
}
