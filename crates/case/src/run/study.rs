//! [`Study`]: an optimisation of a program's own problem, with all that `nastic optimize` does for a case file.

mod control_set;
mod error;
mod record;

pub use control_set::ControlSet;
pub use error::StudyError;

use super::error::{Exit, RunError};
use super::optimize;
use super::session::Session;
use super::states::States;
use super::{OnTrial, Outcome, conclude, resume, thread_pool};
use crate::console::Console;
use crate::lower::{Assembled, CaseProblem, ControlProblem};
use crate::quantity::Units;
use crate::result::checkpoint_file::CheckpointError;
use crate::result::files::Directory;
use crate::schema::{Case, Command};
use crate::signals::cancelled_by_signals;
use crate::syntax::Document;
use nastic_control::{Ensemble, EnsembleBlock, LoadCase, Reduced};
use nastic_opt::Optimizer;
use nastic_uncertainty::risk::Mean;
use serde_json::json;
use std::io::Write;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

/// An optimisation of a problem that a program built itself - with its own law or cost, say - which leaves behind what
/// `nastic optimize` leaves behind for a case file: the same code runs both.
///
/// With a [`directory`](Self::directory): `result.json`, `history.jsonl` and `.csv`, `convergence.svg`, `controls.json`, `start.vtu` and
/// `optimum.vtu`, `target.vtu` where a cost has a target, snapshots of iterations, pictures, the page `report.html`, and a checkpoint, from which
/// [`resume`](Self::resume) goes on to the bit. With [`print`](Self::print): what the command line says. With
/// [`interruptible`](Self::interruptible): a Ctrl-C that keeps what was found. Nothing of these unasked. What needs a case file is left
/// out: `case.json`, expectations, warnings about elements, and the commands in what is advised.
///
/// ```
/// use nastic_case::run::Study;
/// use nastic_control::{Reduced, Space, Target, Tracking};
/// use nastic_energy::{FiberTension, NeoHooke};
/// use nastic_fem::Solid;
/// use nastic_mesh::{CellKind, box_mesh};
/// use nastic_opt::{Bounds, Lbfgs};
/// use nastic_tensor::Vec3;
///
/// let body = Solid::new(box_mesh([1.0, 0.2, 0.2], [3, 1, 2], CellKind::Hex8)?)?
///     .material("body", NeoHooke::from_young_poisson(3e5, 0.3)?)?
///     .actuate("body", "muscle", FiberTension::along(Vec3::x())?.muscle())?
///     .clamp("x-")?;
/// let shorter = Target::position(|x| [0.9 * x[0], x[1], x[2]]);
/// let problem = Reduced::new(body).control("muscle", Space::Cell)?.cost(Tracking::surface("x+", shorter))?;
///
/// # let directory = tempfile::tempdir()?;
/// # let out = directory.path().join("shorter");
/// let found = Study::new(problem)?
///     .within("muscle", Bounds::new(0.0, 2e5)?)
///     .title("A bar that shortens")
///     .directory(&out)
///     .optimize(&Lbfgs::default())?;
/// assert!(found.outcome.result["cost"]["total"].as_f64() < Some(1e-6));
/// assert!(out.join("report.html").is_file() && out.join("optimum.vtu").is_file());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Study {
    ensemble: Ensemble,
    sets: Vec<(String, ControlSet)>,
    starts: Vec<(String, Vec<f64>)>,
    whole_start: Option<Vec<f64>>,
    title: Option<String>,
    directory: Option<PathBuf>,
    units: Units,
    probes: Vec<(String, [f64; 3])>,
    every: usize,
    checkpoint: usize,
    random_starts: usize,
    seed: u64,
    restart: bool,
    report: bool,
    console: Console,
    on_trial: OnTrial,
    threads: Option<usize>,
    cancel: Option<Arc<AtomicBool>>,
    interruptible: bool,
}

/// Where a [`Study`] ended.
#[derive(Debug)]
pub struct Optimum {
    /// How it ended ([`Exit::Done`] where it converged), and the content of `result.json`.
    pub outcome: Outcome,
    /// The best control and its states, of which snapshots and pictures can be made.
    pub states: States,
}

impl Study {
    /// A study of one body.
    ///
    /// # Errors
    /// A body that is incomplete, or has nothing to control.
    pub fn new(problem: Reduced) -> Result<Self, StudyError> {
        let alone = vec![LoadCase::new("", 1.0, problem)];
        Ok(Self::of(Ensemble::new(Mean).scenario_of("", 1.0, alone).build()?))
    }

    /// A study of several: scenarios, load cases.
    #[must_use]
    pub fn of(ensemble: Ensemble) -> Self {
        Self {
            ensemble,
            sets: vec![],
            starts: vec![],
            whole_start: None,
            title: None,
            directory: None,
            units: Units::default(),
            probes: vec![],
            every: 10,
            checkpoint: 10,
            random_starts: 0,
            seed: 0,
            restart: false,
            report: true,
            console: Console::silent(),
            on_trial: OnTrial::default(),
            threads: None,
            cancel: None,
            interruptible: false,
        }
    }

    /// Where a control may be: [`Bounds`](nastic_opt::Bounds) of scalars, a [`Sphere`](nastic_opt::Sphere) or a
    /// [`Ball`](nastic_opt::Ball) of vectors. One that nothing is said of is unbounded, which a warning tells.
    #[must_use]
    pub fn within(mut self, control: &str, set: impl Into<ControlSet>) -> Self {
        self.sets.push((control.to_owned(), set.into()));
        self
    }

    /// Where a control begins: one value for each of its components, cells or nodes; zero if nothing is said.
    #[must_use]
    pub fn start(mut self, control: &str, values: impl Into<Vec<f64>>) -> Self {
        self.starts.push((control.to_owned(), values.into()));
        self
    }

    /// Where all controls begin: the whole control vector.
    #[must_use]
    pub fn start_at(mut self, m: impl Into<Vec<f64>>) -> Self {
        self.whole_start = Some(m.into());
        self
    }

    /// The title of pictures and of the page.
    #[must_use]
    pub fn title(mut self, title: &str) -> Self {
        self.title = Some(title.to_owned());
        self
    }

    /// Where all files go. No other program may write there meanwhile; those of an earlier run are replaced.
    #[must_use]
    pub fn directory(mut self, directory: impl Into<PathBuf>) -> Self {
        self.directory = Some(directory.into());
        self
    }

    /// Writes what the command line shows, line by line.
    #[must_use]
    pub fn print(mut self, out: impl Write + Send + 'static) -> Self {
        self.console = Console::new(out);
        self
    }

    /// The consistent system in which the program computes, for the labels of results; SI if never said.
    #[must_use]
    pub fn units(mut self, units: Units) -> Self {
        self.units = units;
        self
    }

    /// A point of the body to report: its reference position.
    #[must_use]
    pub fn probe(mut self, name: &str, point: [f64; 3]) -> Self {
        self.probes.push((name.to_owned(), point));
        self
    }

    /// A snapshot is written every so many iterations, 0 for none (default: 10).
    #[must_use]
    pub fn snapshots_every(mut self, iterations: usize) -> Self {
        self.every = iterations;
        self
    }

    /// A checkpoint is written every so many iterations, 0 for none (default: 10). Factors are forgotten there, so that bits do not
    /// depend on an interruption.
    #[must_use]
    pub fn checkpoints_every(mut self, iterations: usize) -> Self {
        self.checkpoint = iterations;
        self
    }

    /// Further starts, drawn within the bounds from a seed; the best of all is kept.
    #[must_use]
    pub fn random_starts(mut self, count: usize, seed: u64) -> Self {
        (self.random_starts, self.seed) = (count, seed);
        self
    }

    /// Begins anew also where the directory holds an optimisation that was interrupted.
    #[must_use]
    pub fn restart(mut self, restart: bool) -> Self {
        self.restart = restart;
        self
    }

    /// Whether the page `report.html` is written (default: it is).
    #[must_use]
    pub fn report(mut self, report: bool) -> Self {
        self.report = report;
        self
    }

    /// Calls somebody after every trial with its line of `history.jsonl`.
    #[must_use]
    pub fn on_trial(mut self, told: OnTrial) -> Self {
        self.on_trial = told;
        self
    }

    /// Number of threads; all processors if never said. Results do not depend on it.
    #[must_use]
    pub fn threads(mut self, threads: usize) -> Self {
        self.threads = Some(threads);
        self
    }

    /// A flag that stops the optimisation, and the state solve at hand, once it is raised; what was found is kept.
    #[must_use]
    pub fn cancelled_by(mut self, flag: Arc<AtomicBool>) -> Self {
        self.cancel = Some(flag);
        self
    }

    /// Lets the first Ctrl-C (SIGINT) or SIGTERM of the whole program stop the optimisation as [`cancelled_by`](Self::cancelled_by)
    /// does, in whose place it comes; the second ends the program.
    #[must_use]
    pub fn interruptible(mut self) -> Self {
        self.interruptible = true;
        self
    }

    /// Optimises from the start. Its derivative is checked first.
    ///
    /// # Errors
    /// [`StudyError`]. A stop before convergence is none: see [`Outcome::exit`].
    pub fn optimize(self, optimizer: &(impl Optimizer + Sync)) -> Result<Optimum, StudyError> {
        self.run(optimizer, false)
    }

    /// Goes on with an optimisation of the same problem from the last checkpoint in the directory: the result is that of a run without
    /// interruption, to the bit but for times and the entry `resumed`. Begins where there is no checkpoint yet, so that a program that is
    /// simply run again goes on.
    ///
    /// # Errors
    /// As [`optimize`](Self::optimize); a checkpoint of another problem: other meshes, controls, sets, starts, names of costs, options, or a law or
    /// a cost that gives the control of the checkpoint another value.
    pub fn resume(self, optimizer: &(impl Optimizer + Sync)) -> Result<Optimum, StudyError> {
        self.run(optimizer, true)
    }

    fn run(self, optimizer: &(impl Optimizer + Sync), goes_on: bool) -> Result<Optimum, StudyError> {
        let pool = thread_pool(self.threads)?;
        let began = Instant::now();
        let console = self.console.clone();
        let own = self.cancel.clone().unwrap_or_default();
        let cancel = if self.interruptible { stop_by_signals(&console) } else { own };
        let (directory, restart) = (self.directory.clone(), self.restart);
        let (report, on_trial) = (self.report, self.on_trial.clone());
        let mut problem = self.assemble(optimizer)?;
        problem.ensemble.cancel_by(&cancel);
        let run = || -> Result<(Outcome, Option<States>), RunError> {
            let mut session = Session::on(Command::Optimize, problem, cancel, &console, began);
            (session.report, session.on_trial) = (report, on_trial);
            let exit = match directory {
                Some(directory) if goes_on => resume_in(&mut session, optimizer, directory),
                Some(directory) => {
                    session.out = Some(Directory::claim(directory)?);
                    optimize::begin(&mut session, optimizer, restart)
                }
                None => optimize::begin(&mut session, optimizer, restart),
            };
            conclude(session, exit, true)
        };
        let (outcome, states) = pool.install(run).map_err(StudyError::of)?;
        match states {
            Some(states) => Ok(Optimum { outcome, states }),
            None => Err(StudyError::Derivative { mismatch: outcome.result["gradient_check"]["mismatch"].as_f64() }),
        }
    }

    fn assemble(self, optimizer: &dyn Optimizer) -> Result<CaseProblem, StudyError> {
        let controls = self.controls()?;
        let name = self.name();
        let case = self.case(&name, optimizer)?;
        let identity = record::identity(&self.ensemble, &controls, optimizer, &case);
        let document = Document::from_json(&name, &identity);
        let Self { ensemble, probes, .. } = self;
        let controls = controls.into_iter().map(|(_, control)| control).collect();
        Ok(CaseProblem::assemble(Assembled { ensemble, controls, probes, case, document })?)
    }

    /// The last part of the directory's name.
    fn name(&self) -> String {
        let last = self.directory.as_ref().and_then(|directory| directory.file_name());
        last.map_or_else(|| "study".to_owned(), |name| name.to_string_lossy().into_owned())
    }

    /// Set and start of every control field.
    fn controls(&self) -> Result<Vec<(ControlSet, ControlProblem)>, StudyError> {
        let blocks = self.ensemble.blocks();
        let named = self.sets.iter().map(|(name, _)| name).chain(self.starts.iter().map(|(name, _)| name));
        for name in named {
            if !blocks.iter().any(|block| block.name == *name) {
                let known = blocks.iter().map(|block| block.name.clone()).collect::<Vec<_>>().join(", ");
                return Err(StudyError::UnknownControl { name: name.clone(), known });
            }
        }
        let len = blocks.iter().map(|block| block.len).sum();
        if let Some(found) = self.whole_start.as_ref().map(Vec::len).filter(|found| *found != len) {
            return Err(StudyError::Length { found, expected: len });
        }
        Ok(blocks.iter().map(|block| self.control(block)).collect())
    }

    fn control(&self, block: &EnsembleBlock) -> (ControlSet, ControlProblem) {
        let last = self.sets.iter().rev().find(|(name, _)| *name == block.name);
        let set = last.map_or_else(ControlSet::none, |(_, set)| set.clone());
        let own = self.starts.iter().rev().find(|(name, _)| *name == block.name);
        let start = match (own, &self.whole_start) {
            (Some((_, values)), _) if values.len() == 1 => vec![values[0]; block.len],
            (Some((_, values)), _) => values.clone(),
            (None, Some(m)) => block.of(m).to_vec(),
            (None, None) => vec![0.0; block.len],
        };
        let control = ControlProblem { admitted: set.admission(), set: set.set(), start };
        (set, control)
    }

    /// What of a case file a program says otherwise.
    fn case(&self, name: &str, optimizer: &dyn Optimizer) -> Result<Case, StudyError> {
        let empty = json!({ "nastic": 1, "mesh": name, "materials": [] });
        let mut case = Case::read_variant(&Document::from_json(name, &empty), self.units).map_err(RunError::from)?;
        let options = optimizer.options();
        (case.units, case.title) = (self.units, self.title.clone());
        (case.output.every, case.output.checkpoint) = (self.every, self.checkpoint);
        (case.optimizer.starts, case.optimizer.seed) = (1 + self.random_starts, self.seed);
        (case.optimizer.max_iterations, case.optimizer.tolerance) = (options.max_iterations, options.tolerance);
        case.optimizer.method = crate::schema::Method::named(optimizer.name()).unwrap_or_default();
        Ok(case)
    }
}

fn stop_by_signals(console: &Console) -> Arc<AtomicBool> {
    let console = console.clone();
    cancelled_by_signals(move |told| console.say(told))
}

/// Goes on where the directory holds a checkpoint of the same problem beyond its start; begins elsewhere.
fn resume_in(session: &mut Session<'_>, optimizer: &dyn Optimizer, directory: PathBuf) -> Result<Exit, RunError> {
    match resume::read(&directory) {
        Err(RunError::Checkpoint(CheckpointError::Missing { .. })) => {
            session.out = Some(Directory::claim(directory)?);
            optimize::begin(session, optimizer, true)
        }
        Err(error) => Err(error),
        Ok((out, checkpoint)) => {
            checkpoint.case.check(&session.problem, &directory)?;
            session.out = Some(out);
            optimize::resume(session, optimizer, checkpoint.position.filter(|position| !position.is_start()))
        }
    }
}
