//! [`Study`]: an optimisation of a program's own problem, with all that `nastic optimize` does for a case file.

pub(crate) mod control_set;
mod error;
pub(crate) mod record;
mod running;

pub use crate::run::study::control_set::ControlSet;
pub use crate::run::study::error::StudyError;

use crate::console::Console;
use crate::run::outcome::Outcome;
use crate::run::spectrum_request::SpectrumRequest;
use crate::run::states::States;
use nastic_control::Reduced;
use nastic_ensemble::{Ensemble, LoadCase};
use nastic_language::quantity::Units;
use nastic_report::OnTrial;
use nastic_uncertainty::risk::Mean;
use std::io::Write;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

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
/// use nastic_run::run::Study;
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
    early_stopping: bool,
    restart: bool,
    report: bool,
    spectrum: Option<SpectrumRequest>,
    console: Console,
    on_trial: OnTrial,
    threads: Option<usize>,
    cancel: Option<Arc<AtomicBool>>,
    interruptible: bool,
}

/// Where a [`Study`] ended.
#[derive(Debug)]
pub struct Optimum {
    /// How it ended ([`Exit::Done`](crate::run::error::Exit::Done) where it converged), and the content of `result.json`.
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
            early_stopping: true,
            restart: false,
            report: true,
            spectrum: None,
            console: Console::silent(),
            on_trial: OnTrial::default(),
            threads: None,
            cancel: None,
            interruptible: false,
        }
    }

    /// Where a control may be: [`Bounds`](nastic_opt::Bounds) of scalars, a [`Sphere`](nastic_opt::Sphere) or a
    /// [`Ball`](nastic_opt::Ball) of vectors. One that nothing is said of is unbounded, of which a warning says so. A nodal field on a sphere
    /// needs [`Reduced::of_length`] too, for its vectors between the nodes.
    ///
    /// The inner product is that of the problem: several fields are weighed by their ranges only where [`Reduced::weigh`] says so, while
    /// case files do it by themselves.
    #[must_use]
    pub fn within(mut self, control: &str, set: impl Into<ControlSet>) -> Self {
        self.sets.push((control.to_owned(), set.into()));
        self
    }

    /// Where a control begins: one value for each of its components, cells or nodes; a single value is that of all of them. Zero if nothing
    /// is said.
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

    /// Further starts, drawn within the bounds from a seed; the best of all is kept. As many run at once as there are threads, each with a
    /// factor of its own.
    #[must_use]
    pub fn random_starts(mut self, count: usize, seed: u64) -> Self {
        (self.random_starts, self.seed) = (count, seed);
        self
    }

    /// Whether starts that cannot reach the best one any more are stopped, as they are by default.
    #[must_use]
    pub fn early_stopping(mut self, early_stopping: bool) -> Self {
        self.early_stopping = early_stopping;
        self
    }

    /// Begins anew also where the directory holds an optimisation that was interrupted; [`resume`](Self::resume) then does what
    /// [`optimize`](Self::optimize) does.
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

    /// Finds leading eigenpairs of the reduced Hessian at the optimum, too.
    #[must_use]
    pub fn spectrum(mut self, request: SpectrumRequest) -> Self {
        self.spectrum = Some(request);
        self
    }

    /// Calls somebody after every trial with its line of `history.jsonl`.
    #[must_use]
    pub fn on_trial(mut self, shown: OnTrial) -> Self {
        self.on_trial = shown;
        self
    }

    /// Number of threads; all processors if never said. Results do not depend on it.
    #[must_use]
    pub fn threads(mut self, threads: usize) -> Self {
        self.threads = Some(threads);
        self
    }

    /// A flag that stops the optimisation, and the state solve at hand, once it is raised; what was found is kept. It comes in the place of
    /// flags given to [`Reduced::cancelled_by`] or [`EnsembleBuilder::cancelled_by`](nastic_ensemble::EnsembleBuilder::cancelled_by), which
    /// end state solves alone, and which a study without a flag leaves as they are.
    #[must_use]
    pub fn cancelled_by(mut self, flag: Arc<AtomicBool>) -> Self {
        self.cancel = Some(flag);
        self
    }

    /// Lets the first Ctrl-C (SIGINT) or SIGTERM of the whole program stop the optimisation as [`cancelled_by`](Self::cancelled_by)
    /// does, in whose place it comes; the second ends the program.
    ///
    /// There is one flag for the whole program, and nothing lowers it: of several studies that are run one after the other, those after the
    /// first Ctrl-C stop at once.
    #[must_use]
    pub fn interruptible(mut self) -> Self {
        self.interruptible = true;
        self
    }
}
