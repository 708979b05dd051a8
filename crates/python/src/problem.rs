//! The cost as a function of the control vector.

use crate::error;
use crate::interrupt::{Callbacks, TrialLine, interruptible, send_line};
use crate::mesh::{Mesh, arrays};
use crate::run::document;
use crate::states::fields;
use nastic_case::lower::{Admitted, CaseMember, CaseProblem};
use nastic_control::StateFields;
use nastic_ensemble::{EnsemblePoint, EnsembleWorkspace};
use nastic_mesh::Snapshot;
use nastic_opt::{Budget, Constrained, Failed, Hessian, Objective, Request, Sense};
use nastic_run::run::thread_pool;
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use serde_json::json;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::Sender;
use std::sync::{Arc, Mutex, PoisonError};

/// Cost and derivative of a case at any control vector.
#[pyclass(frozen, module = "nastic._nastic")]
pub(crate) struct Problem {
    problem: CaseProblem,
    threads: rayon::ThreadPool,
    cancel: Arc<AtomicBool>,
    accuracy: f64,
    stage: usize,
    budget: Budget,
    /// TrialLine of every Newton iteration.
    callback: Option<Py<PyAny>>,
    /// Where iterations are reported while a call is under way.
    shown: Arc<Mutex<Option<Sender<TrialLine>>>>,
    history: Mutex<History>,
}

/// What one evaluation leaves for the next.
#[derive(Default)]
struct History {
    workspace: EnsembleWorkspace,
    /// The last evaluated point: answers for its control, and the next one starts from its states.
    last: Option<EnsemblePoint>,
    /// The derivative there, once it was asked for.
    derivative: Option<Vec<f64>>,
    /// Controls that were evaluated, from the beginning on.
    evaluations: usize,
}

impl History {
    /// The cost; solves unless the last point has the same control.
    fn value(&mut self, of: &Problem, m: &[f64]) -> Result<f64, Failed> {
        if !self.last.as_ref().is_some_and(|point| point.m == m) {
            let how = Request { near: self.last.as_ref(), accuracy: of.accuracy, stage: of.stage, budget: of.budget };
            let point = of.problem.ensemble.evaluate(m, &how, &mut self.workspace)?;
            (self.last, self.derivative) = (Some(point), None);
            self.evaluations += 1;
        }
        Ok(self.last.as_ref().map_or(f64::NAN, |point| of.problem.ensemble.value(point)))
    }

    /// Cost and derivative; the adjoint is solved once.
    fn derivative(&mut self, of: &Problem, m: &[f64]) -> Result<(f64, Vec<f64>), Failed> {
        let value = self.value(of, m)?;
        if let (None, Some(point)) = (&self.derivative, &mut self.last) {
            self.derivative = Some(of.problem.ensemble.derivative(point, &mut self.workspace)?);
        }
        Ok((value, self.derivative.clone().unwrap_or_default()))
    }
}

impl History {
    /// The values of the constraints.
    fn constraints(&mut self, of: &Problem, m: &[f64]) -> Result<Vec<f64>, Failed> {
        self.value(of, m)?;
        Ok(self.last.as_ref().map_or_else(Vec::new, |point| of.problem.ensemble.constraint_values(point)))
    }

    /// The derivative of `y . c`: one adjoint for each load case and scenario.
    fn constraint_derivative(&mut self, of: &Problem, m: &[f64], y: &[f64]) -> Result<Vec<f64>, Failed> {
        self.value(of, m)?;
        match &self.last {
            Some(point) => Ok(of.problem.ensemble.constraint_derivative(point, y, &mut self.workspace)?),
            None => Err(Failed::because("the control was not evaluated")),
        }
    }

    /// `sum_k (du_k/dm)^T w_k` over the members.
    fn displacement_vjp(&mut self, of: &Problem, m: &[f64], w: &[Vec<f64>]) -> Result<Vec<f64>, Failed> {
        self.value(of, m)?;
        match &self.last {
            Some(point) => Ok(of.problem.ensemble.displacement_vjp(point, w, &mut self.workspace)?),
            None => Err(Failed::because("the control was not evaluated")),
        }
    }

    /// Name and fields of the state of every member.
    fn shots(&mut self, of: &Problem, m: &[f64]) -> Result<Vec<(String, Snapshot)>, Failed> {
        self.value(of, m)?;
        let point = self.last.as_ref().ok_or_else(|| Failed::because("the control was not evaluated"))?;
        let shot = |member: CaseMember<'_>| {
            let at = &point.members[member.index()];
            let fields = StateFields::of(at);
            let shot = member.reduced().snapshot_of(&fields).map_err(|error| Failed::because(error.to_string()))?;
            Ok((member.name(), shot))
        };
        of.problem.members().map(shot).collect()
    }

    /// The second derivative along v: two linear solves, with state and adjoint of the control at hand.
    fn hessian_vector(&mut self, of: &Problem, m: &[f64], v: &[f64]) -> Result<Vec<f64>, Failed> {
        self.derivative(of, m)?;
        match &self.last {
            Some(point) => {
                Objective::hessian_vector(&of.problem.ensemble, point, v, Hessian::Exact, &mut self.workspace)
            }
            None => Err(Failed::because("the control was not evaluated")),
        }
    }
}

impl Problem {
    /// Works on the history without the interpreter lock.
    fn at<T: Send>(&self, py: Python<'_>, work: impl FnOnce(&mut History) -> Result<T, Failed> + Send) -> PyResult<T> {
        let callbacks = Callbacks { trial: self.callback.as_ref(), progress: None };
        let done = interruptible(py, &self.cancel, callbacks, move |lines| {
            // A panic leaves a history that is whole: its fields are replaced one by one, the point first.
            let mut history = self.history.lock().unwrap_or_else(PoisonError::into_inner);
            let history: &mut History = &mut history;
            let _listening = Listening::new(&self.shown, lines);
            self.threads.install(|| work(history))
        })?;
        done.map_err(|failed| error::of_evaluation(py, &failed))
    }
}

/// Calls the callback of the call under way, if there is one, and waits until it has returned.
fn send_to(shown: &Mutex<Option<Sender<TrialLine>>>, line: String) {
    let to = shown.lock().unwrap_or_else(PoisonError::into_inner).clone();
    if let Some(to) = to {
        send_line(&to, line);
    }
}

/// A call under way whose iterations are reported; a call ends only once nobody can report any more, so this goes with the work, also where that panics.
struct Listening<'a>(&'a Mutex<Option<Sender<TrialLine>>>);

impl<'a> Listening<'a> {
    fn new(shown: &'a Mutex<Option<Sender<TrialLine>>>, lines: Sender<TrialLine>) -> Self {
        *shown.lock().unwrap_or_else(PoisonError::into_inner) = Some(lines);
        Self(shown)
    }
}

impl Drop for Listening<'_> {
    fn drop(&mut self) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = None;
    }
}

#[pymethods]
impl Problem {
    #[new]
    #[pyo3(signature = (name, case, meshes, *, threads, accuracy, stage, max_newton, callback))]
    #[allow(clippy::too_many_arguments)] // all but the first three by name, from one place
    fn new(
        py: Python<'_>,
        name: &str,
        case: &str,
        meshes: BTreeMap<String, Py<Mesh>>,
        threads: Option<usize>,
        accuracy: f64,
        stage: Option<usize>,
        max_newton: Option<usize>,
        callback: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        if max_newton == Some(0) {
            return Err(error::input(py, "max_newton is 0; a solve takes one Newton iteration at least"));
        }
        let document = document(py, name, case, meshes)?;
        if !(accuracy > 0.0 && accuracy < 1.0) {
            return Err(error::input(py, format!("accuracy is {accuracy}; it must lie between 0 and 1, such as 1e-8")));
        }
        let threads = thread_pool(threads).map_err(|problem| error::of_run(py, &problem))?;
        let cancel = Arc::new(AtomicBool::new(false));
        let flag = cancel.clone();
        let lowered = py.detach(|| threads.install(|| CaseProblem::lower(document, flag)));
        let mut problem = lowered.map_err(|found| error::problems(py, &found))?;
        if problem.lacks_steps() {
            let flag = cancel.clone();
            let found = py.detach(|| threads.install(|| problem.with_adaptive_steps(accuracy, flag)));
            (problem, _) = found.map_err(|error| error::of_steps(py, &error))?;
        }
        problem.refuse_unstable_if_asked();
        let missing = match () {
            () if problem.start.is_empty() => Some(("controls", "a problem needs controls, and the case has none")),
            () if !problem.has_costs() => Some(("costs", "a problem needs costs, and the case has none")),
            () => None,
        };
        if let Some((key, message)) = missing {
            return Err(error::problems(py, &problem.complain(key, message)));
        }
        let stages = problem.stages();
        let stage = stage.unwrap_or(stages - 1);
        if stage >= stages {
            return Err(error::input(py, format!("stage {stage}: the costs have {stages} stages, numbered from 0")));
        }
        let shown: Arc<Mutex<Option<Sender<TrialLine>>>> = Arc::default();
        if callback.is_some() {
            let shown = shown.clone();
            problem.ensemble.watch_solves(move |member, now| {
                let line = json!({
                    "member": member, "load": now.load, "newton": now.newton,
                    "residual": now.residual, "step": now.step, "energy": now.energy
                });
                send_to(&shown, line.to_string());
            });
        }
        if max_newton.is_some() && problem.is_motion() {
            let what = "max_newton limits the iterations of an equilibrium, and the case is a motion: give shorter steps, or stop() it";
            return Err(error::input(py, what.to_owned()));
        }
        let budget = max_newton.map_or(Budget::Unlimited, Budget::Of);
        Ok(Self { problem, threads, cancel, accuracy, stage, budget, callback, shown, history: Mutex::default() })
    }

    /// The cost at `m`.
    fn value(&self, py: Python<'_>, m: PyReadonlyArray1<'_, f64>) -> PyResult<f64> {
        let m: Vec<f64> = m.as_array().to_vec();
        self.at(py, move |history| history.value(self, &m))
    }

    /// The cost at `m`, and its derivative.
    fn value_and_gradient<'py>(
        &self,
        py: Python<'py>,
        m: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<(f64, Bound<'py, PyArray1<f64>>)> {
        let m: Vec<f64> = m.as_array().to_vec();
        let (value, derivative) = self.at(py, move |history| history.derivative(self, &m))?;
        Ok((value, PyArray1::from_vec(py, derivative)))
    }

    /// The second derivative at `m` applied to `v`.
    fn hessian_vector<'py>(
        &self,
        py: Python<'py>,
        m: PyReadonlyArray1<'py, f64>,
        v: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let (m, v): (Vec<f64>, Vec<f64>) = (m.as_array().to_vec(), v.as_array().to_vec());
        let product = self.at(py, move |history| history.hessian_vector(self, &m, &v))?;
        Ok(PyArray1::from_vec(py, product))
    }

    /// The groups of constraints: `name`, `equal`, `len`, `scale`.
    fn constraints<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let out = PyList::empty(py);
        for group in self.problem.ensemble.constraints() {
            let one = PyDict::new(py);
            one.set_item("name", &group.name)?;
            one.set_item("equal", group.sense == Sense::Equal)?;
            one.set_item("len", group.len)?;
            one.set_item("scale", group.scale)?;
            out.append(one)?;
        }
        Ok(out)
    }

    /// The values of all constraints at `m`, group by group.
    fn constraint_values<'py>(
        &self,
        py: Python<'py>,
        m: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let m: Vec<f64> = m.as_array().to_vec();
        let values = self.at(py, move |history| history.constraints(self, &m))?;
        Ok(PyArray1::from_vec(py, values))
    }

    /// The derivative of `y . c` at `m`.
    fn constraint_vjp<'py>(
        &self,
        py: Python<'py>,
        m: PyReadonlyArray1<'py, f64>,
        y: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let (m, y): (Vec<f64>, Vec<f64>) = (m.as_array().to_vec(), y.as_array().to_vec());
        let product = self.at(py, move |history| history.constraint_derivative(self, &m, &y))?;
        Ok(PyArray1::from_vec(py, product))
    }

    /// The mesh that all members share.
    fn mesh<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        arrays(py, self.problem.mesh())
    }

    /// Names of the members, in their order.
    fn members(&self) -> Vec<String> {
        self.problem.members().map(|member| member.name()).collect()
    }

    /// Name, nodal and cell-wise fields of every member at `m`.
    fn states<'py>(&self, py: Python<'py>, m: PyReadonlyArray1<'py, f64>) -> PyResult<Bound<'py, PyList>> {
        let m: Vec<f64> = m.as_array().to_vec();
        let shots = self.at(py, move |history| history.shots(self, &m))?;
        fields(py, shots)
    }

    /// `sum_k (du_k/dm)^T w_k` at `m`; `w` by member, empty where there is none, else `[nodes][3]`.
    fn displacement_vjp<'py>(
        &self,
        py: Python<'py>,
        m: PyReadonlyArray1<'py, f64>,
        w: Vec<PyReadonlyArray1<'py, f64>>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let (m, dim) = (m.as_array().to_vec(), self.problem.mesh().dim());
        let of = |w: PyReadonlyArray1<'py, f64>| -> Vec<f64> {
            w.as_array().iter().enumerate().filter(|(k, _)| k % 3 < dim).map(|(_, w)| *w).collect()
        };
        let w: Vec<Vec<f64>> = w.into_iter().map(of).collect();
        let product = self.at(py, move |history| history.displacement_vjp(self, &m, &w))?;
        Ok(PyArray1::from_vec(py, product))
    }

    /// Ends the call under way, of whatever thread, with an error.
    fn stop(&self) {
        self.cancel.store(true, Ordering::Relaxed);
    }

    /// Forgets all states: the next evaluation starts from rest.
    fn reset(&self, py: Python<'_>) -> PyResult<()> {
        self.at(py, |history| {
            *history = History { evaluations: history.evaluations, ..History::default() };
            Ok(())
        })
    }

    /// How many controls were evaluated so far.
    fn evaluations(&self, py: Python<'_>) -> PyResult<usize> {
        self.at(py, |history| Ok(history.evaluations))
    }

    /// The control vector to start from.
    fn start<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.problem.start)
    }

    /// Lower and upper bounds of all entries, infinite where there are none.
    fn bounds<'py>(&self, py: Python<'py>) -> (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>) {
        let of = |(block, field): (&nastic_ensemble::EnsembleBlock, &nastic_case::lower::ControlField)| {
            let none = (f64::NEG_INFINITY, f64::INFINITY);
            let at = |k: usize| field.bounds.as_ref().map_or(none, |bounds| bounds.at(k));
            (0..block.len).map(at).collect::<Vec<_>>()
        };
        let blocks = self.problem.ensemble.blocks().iter().zip(&self.problem.controls);
        let (lower, upper): (Vec<f64>, Vec<f64>) = blocks.flat_map(of).unzip();
        (PyArray1::from_vec(py, lower), PyArray1::from_vec(py, upper))
    }

    /// The control fields: `name`, `first`, `len`, `space`, `components`, `unit`, `norm`, `max_norm`.
    fn layout<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let out = PyList::empty(py);
        for (block, field) in self.problem.ensemble.blocks().iter().zip(&self.problem.controls) {
            let own = &self.problem.member(block.owner).layout().blocks()[block.field];
            let (norm, max_norm) = match field.admitted {
                Admitted::Norm(length) => (Some(length), None),
                Admitted::MaxNorm(length) => (None, Some(length)),
                _ => (None, None),
            };
            let one = PyDict::new(py);
            one.set_item("name", &field.name)?;
            one.set_item("first", block.first)?;
            one.set_item("len", block.len)?;
            one.set_item("space", own.basis.space().name())?;
            one.set_item("components", own.components)?;
            one.set_item("unit", &field.unit)?;
            one.set_item("norm", norm)?;
            one.set_item("max_norm", max_norm)?;
            out.append(one)?;
        }
        Ok(out)
    }

    /// Number of stages of the costs, and the one that is evaluated.
    fn stages(&self) -> (usize, usize) {
        (self.problem.stages(), self.stage)
    }
}
