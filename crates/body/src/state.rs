//! [`State`]: an equilibrium, as a value.

use crate::controls::Controls;
use crate::history::History;
use crate::strategy::StrategyCounts;
use nastic_linear::{LinearSolver, LinearWork, Solver};
use serde::{Deserialize, Deserializer, Serialize};
use std::sync::Arc;

/// A converged equilibrium, or the end of a time step. It holds no factor: that stays in the `Workspace`.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct State {
    /// Displacement, flat: entry `dim * node + component`.
    pub u: Arc<Vec<f64>>,
    /// The controls it belongs to.
    pub controls: Arc<Controls>,
    /// Multiple of the dead loads and of the prescribed displacements it belongs to (1 for an answer, less on the way).
    pub load: f64,
    /// Time, 0 of a static problem.
    pub time: f64,
    /// Velocity, flat, in a problem with time.
    pub velocity: Option<Arc<Vec<f64>>>,
    /// Acceleration, flat, where a time scheme carries one.
    pub acceleration: Option<Arc<Vec<f64>>>,
    /// The internal variables that the step which led to it began with; none of a static state.
    pub history: Arc<History>,
    /// How it was found.
    pub report: SolveReport,
}

impl State {
    /// A state of a static problem.
    pub fn equilibrium(u: Vec<f64>, controls: Controls, load: f64, report: SolveReport) -> Self {
        let (u, controls, history) = (Arc::new(u), Arc::new(controls), Arc::default());
        State { u, controls, load, time: 0.0, velocity: None, acceleration: None, history, report }
    }

    /// Whether it has the lengths of another state, which is of the body at hand: of one that was read.
    pub fn fits(&self, like: &State) -> bool {
        let (own, others) = (&self.controls, &like.controls);
        let mut rates = self.velocity.iter().chain(&self.acceleration);
        self.u.len() == like.u.len()
            && rates.all(|rate| rate.len() == like.u.len())
            && own.len() == others.len()
            && (0..own.len()).all(|k| own.slots(k) == others.slots(k) && own.values(k).len() == others.values(k).len())
    }
}

/// The name of a linear solver. By this name serde does not see a reference that it would borrow from what it reads.
pub type SolverName = &'static str;

/// What a solve took and how good its answer is.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SolveReport {
    /// Name of what solved the last tangent system; "direct" where there was none.
    #[serde(deserialize_with = "solver_name")]
    pub solver: SolverName,
    /// Newton iterations, those of abandoned load steps included.
    pub newton: usize,
    /// Numeric factorisations.
    pub factorisations: usize,
    /// Newton steps that were found with a factor or a multigrid hierarchy kept from earlier, as preconditioner.
    pub reused: usize,
    /// Back substitutions, each conjugate-gradient iteration counting one.
    pub back_substitutions: usize,
    /// Multigrid hierarchies built.
    pub hierarchies: usize,
    /// Multigrid cycles, one per conjugate-gradient iteration.
    pub cycles: usize,
    /// Tangent systems solved without a matrix: products of cells stood for its entries.
    pub unassembled: usize,
    /// Load steps that led to the answer.
    pub load_steps: usize,
    /// Load steps that were abandoned and shortened.
    pub cuts: usize,
    /// Norm of the residual relative to the norm of the summed absolute element forces of laws, actuations and loads.
    pub residual: f64,
    /// Smallest J at a quadrature point.
    pub min_j: f64,
    /// Total potential: the sum over contributions.
    pub energy: f64,
    /// Times the way from the state nearby failed and that from rest was taken: the answer may lie on another branch.
    pub restarts: usize,
    /// Times a tangent had to be shifted to be positive definite: the way led over an unstable region.
    pub shifted: usize,
    /// Times that steps with predicted pressures led nowhere, and steps by the displacement alone began again where these had.
    pub unpredicted: usize,
    /// What was tried beside Newton's method on the displacement.
    pub strategies: StrategyCounts,
}

/// The name of a linear solver; "own" of one that is not in the catalogue.
fn solver_name<'de, D: Deserializer<'de>>(input: D) -> Result<&'static str, D::Error> {
    Ok(Solver::named(&String::deserialize(input)?).map_or("own", |factory| factory.name()))
}

impl Default for SolveReport {
    fn default() -> Self {
        SolveReport {
            solver: Solver::DIRECT.name(),
            newton: 0,
            factorisations: 0,
            reused: 0,
            back_substitutions: 0,
            hierarchies: 0,
            cycles: 0,
            unassembled: 0,
            load_steps: 0,
            cuts: 0,
            residual: 0.0,
            min_j: 0.0,
            energy: 0.0,
            restarts: 0,
            shifted: 0,
            unpredicted: 0,
            strategies: StrategyCounts::default(),
        }
    }
}

impl SolveReport {
    /// Adds the work of a linear system.
    pub fn add_linear(&mut self, solver: &dyn LinearSolver, work: &LinearWork) {
        self.solver = solver.state().name;
        self.factorisations += work.factorisations;
        self.reused += work.reused;
        self.back_substitutions += work.back_substitutions;
        self.hierarchies += work.hierarchies;
        self.cycles += work.cycles;
        self.shifted += work.shifted;
    }

    /// Adds the work of another solve; the quality figures stay.
    pub fn add_work(&mut self, other: &SolveReport) {
        self.newton += other.newton;
        self.factorisations += other.factorisations;
        self.reused += other.reused;
        self.back_substitutions += other.back_substitutions;
        self.hierarchies += other.hierarchies;
        self.cycles += other.cycles;
        self.unassembled += other.unassembled;
        self.cuts += other.cuts;
        self.restarts += other.restarts;
        self.shifted += other.shifted;
        self.unpredicted += other.unpredicted;
        self.strategies.add(&other.strategies);
    }
}
