//! The commands on cases that Python holds.

use crate::error;
use crate::interrupt::{Callbacks, TrialLine, interruptible, send_line, tell};
use crate::mesh::Mesh;
use crate::states::States;
use nastic_language::catalogue::Catalogue;
use nastic_language::schema::{Command, json_schema};
use nastic_language::syntax::{Diagnostics, Document};
use nastic_run::console::Console;
use nastic_run::run::{Analysis, FigureRequest, ModesRequest, OnTrial, Options, run_document};
use pyo3::prelude::*;
use std::collections::BTreeMap;
use std::io::Write;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::Sender;
use std::sync::{Arc, Mutex, PoisonError};

/// A case file as JSON text, without comments.
#[pyfunction]
pub(crate) fn read(py: Python<'_>, path: PathBuf) -> PyResult<String> {
    let document = py.detach(|| {
        let document = Document::open(&path)?;
        Diagnostics::new(document.problems().to_vec()).into_result()?;
        Ok::<_, Diagnostics>(document)
    });
    Ok(document.map_err(|found| error::problems(py, &found))?.canonical())
}

/// The JSON Schema of cases.
#[pyfunction]
pub(crate) fn schema() -> String {
    json_schema(&Catalogue::standard()).to_string()
}

/// The document of a case that Python holds. `name`: the file it came from, or a name in the directory that file names count from.
pub(crate) fn document(
    py: Python<'_>,
    name: &str,
    case: &str,
    meshes: BTreeMap<String, Py<Mesh>>,
) -> PyResult<Document> {
    let value = serde_json::from_str(case).map_err(|problem| error::input(py, format!("{name}: {problem}")))?;
    let meshes = meshes.into_iter().map(|(name, mesh)| (name, mesh.get().mesh.clone())).collect();
    Ok(Document::from_json(name, &value).with_meshes(meshes))
}

/// Runs a command: exit code, result as JSON text, what was said, and the states that were found.
#[pyfunction]
#[pyo3(signature = (command, name, case, meshes, *, asked, out, threads, report, restart, figure, callback, progress))]
#[allow(clippy::too_many_arguments)]
pub(crate) fn run(
    py: Python<'_>,
    command: &str,
    name: &str,
    case: &str,
    meshes: BTreeMap<String, Py<Mesh>>,
    asked: Option<(String, String)>,
    out: Option<PathBuf>,
    threads: Option<usize>,
    report: bool,
    restart: bool,
    figure: bool,
    callback: Option<Py<PyAny>>,
    progress: Option<Py<PyAny>>,
) -> PyResult<(u8, String, String, Option<States>)> {
    let command = match command {
        "check" => Command::Check,
        "solve" => Command::Solve,
        "modes" => Command::Modes,
        "gradient" => Command::Gradient,
        "optimize" => Command::Optimize,
        "identify" => Command::Identify,
        "gains" => Command::Gains,
        other => return Err(error::input(py, format!("there is no command \"{other}\""))),
    };
    let document = document(py, name, case, meshes)?;
    let cancel = Arc::new(AtomicBool::new(false));
    let said = Said::default();
    let console = Console::new(said.clone());
    let options = Options {
        out,
        in_memory: true,
        threads,
        no_report: !report,
        figure,
        analysis: asked.as_ref().map_or(Ok(Analysis::Equilibrium), |asked| analysis(py, asked))?,
        modes: asked.as_ref().map_or_else(ModesRequest::default, modes),
        restart,
        cancel: cancel.clone(),
        ..Options::default()
    };
    let callbacks = Callbacks { trial: callback.as_ref(), progress: progress.as_ref() };
    let [is_told, is_watched] = [callback.is_some(), progress.is_some()];
    let ran = interruptible(py, &cancel, callbacks, move |lines| {
        let on_trial = match is_told {
            true => {
                let lines = lines.clone();
                OnTrial::call(move |line| send_line(&lines, serde_json::to_string(line).unwrap_or_default()))
            }
            false => OnTrial::default(),
        };
        let listener = Listener(Arc::new(Mutex::new(is_watched.then_some(lines))));
        let console = if is_watched { listener.watch(console) } else { console };
        let ran = run_document(command, document, &Options { on_trial, ..options }, &console);
        // the states that are handed back hold the console
        listener.leave();
        ran
    })?;
    let (outcome, states) = ran.map_err(|problem| error::of_run(py, &problem))?;
    Ok((outcome.exit.code(), outcome.result.to_string(), said.text(), states.map(|states| States { states })))
}

/// What `solve` is asked for: its option without the dashes, and the value of that.
fn analysis(py: Python<'_>, (what, value): &(String, String)) -> PyResult<Analysis> {
    let count =
        || value.parse::<usize>().map_err(|_| error::input(py, format!("{what} is {value}; a count is needed")));
    Ok(match what.as_str() {
        "ramp" => Analysis::Ramp(value.clone()),
        "path" if value == "limit" => Analysis::PathToLimit,
        "path" => Analysis::Path,
        "minimum" => Analysis::Minimum,
        "exact_contact" => Analysis::ExactContact,
        "half_thickness" => Analysis::HalfThickness,
        "equilibria" => Analysis::Equilibria(count()?),
        "modes" => Analysis::Modes(count()?),
        // of the command `modes`
        _ => Analysis::Equilibrium,
    })
}

/// How many modes of `modes`, and about which state.
fn modes((what, value): &(String, String)) -> ModesRequest {
    let usual = ModesRequest::default();
    let count = value.parse().unwrap_or(usual.count);
    ModesRequest { count, undeformed: what == "undeformed" }
}

/// A mesh file: Gmsh, VTU or legacy VTK.
#[pyfunction]
pub(crate) fn read_mesh(py: Python<'_>, path: PathBuf, scale: f64) -> PyResult<Mesh> {
    let mesh = py.detach(|| nastic_io::read_mesh(&path, scale));
    Ok(Mesh { mesh: Arc::new(mesh.map_err(|problem| error::input(py, problem))?) })
}

/// Fits laws to test data: exit code, `fit.json` as text, what was said.
#[pyfunction]
pub(crate) fn fit(py: Python<'_>, data: PathBuf, out: PathBuf) -> PyResult<(u8, String, String)> {
    let said = Said::default();
    let console = Console::new(said.clone());
    let found = py.detach(|| nastic_run::run::fit(&data, Some(out), &console));
    let found = found.map_err(|problem| error::of_run(py, &problem))?;
    Ok((found.exit.code(), found.result.to_string(), said.text()))
}

/// Draws a state of a result directory for print, or with so many frames in a second all of a series, to a directory; where it is.
#[pyfunction]
#[pyo3(signature = (directory, file, *, frames, state, field, range, view, clip, size, behind, paths, edges))]
#[allow(clippy::too_many_arguments)] // all but the first two by name, from one place
pub(crate) fn figure(
    py: Python<'_>,
    directory: PathBuf,
    file: PathBuf,
    frames: Option<f64>,
    state: Option<String>,
    field: Option<String>,
    range: Option<[f64; 2]>,
    view: Option<[f64; 3]>,
    clip: Option<([f64; 3], f64)>,
    size: Option<[u32; 2]>,
    behind: Option<Vec<String>>,
    paths: Vec<String>,
    edges: bool,
) -> PyResult<PathBuf> {
    let asked = FigureRequest { state, field, range, view, clip, size, behind, paths, edges };
    let drawn = py.detach(|| match frames {
        None => nastic_run::run::figure(&directory, &asked, Some(&file)),
        Some(per_second) => nastic_run::run::frames(&directory, &asked, Some(&file), per_second, &|_, _| ()),
    });
    drawn.map_err(|problem| error::of_run(py, &problem))
}

/// Reports how far a command is, until it has ended.
#[derive(Clone)]
struct Listener(Arc<Mutex<Option<Sender<TrialLine>>>>);

impl Listener {
    fn watch(&self, console: Console) -> Console {
        let listener = self.clone();
        console.watched(move |standing| {
            if let Some(to) = &*listener.0.lock().unwrap_or_else(PoisonError::into_inner) {
                tell(to, serde_json::to_string(standing).unwrap_or_default());
            }
        })
    }

    fn leave(&self) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).take();
    }
}

/// What a command said.
#[derive(Clone, Default)]
struct Said(Arc<Mutex<Vec<u8>>>);

impl Said {
    fn text(&self) -> String {
        self.0.lock().map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).unwrap_or_default()
    }
}

impl Write for Said {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        if let Ok(mut own) = self.0.lock() {
            own.extend_from_slice(bytes);
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}
