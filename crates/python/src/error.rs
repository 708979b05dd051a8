//! Errors as the exceptions of `nastic.errors`.

use nastic_case::lower::StepsError;
use nastic_control::ControlError;
use nastic_ensemble::EnsembleError;
use nastic_language::syntax::Diagnostics;
use nastic_opt::Failed;
use nastic_run::run::{Exit, RunError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

/// An exception of `nastic.errors` with a message and attributes.
fn exception(py: Python<'_>, class: &str, message: String, attributes: &Bound<'_, PyDict>) -> PyErr {
    let made = py.import("nastic.errors").and_then(|errors| errors.getattr(class)?.call((message,), Some(attributes)));
    made.map_or_else(|error| error, PyErr::from_value)
}

/// `CaseError` with a message alone.
pub(crate) fn input(py: Python<'_>, message: impl ToString) -> PyErr {
    exception(py, "CaseError", message.to_string(), &PyDict::new(py))
}

/// `CaseError` with all problems of a case.
pub(crate) fn problems(py: Python<'_>, found: &Diagnostics) -> PyErr {
    let attributes = || -> PyResult<Bound<'_, PyDict>> {
        let list = PyList::empty(py);
        for problem in found.list() {
            let one = PyDict::new(py);
            one.set_item("file", &problem.file)?;
            one.set_item("path", &problem.path)?;
            one.set_item("line", (problem.line > 0).then_some(problem.line))?;
            one.set_item("column", (problem.line > 0).then_some(problem.column))?;
            one.set_item("message", &problem.message)?;
            list.append(one)?;
        }
        let out = PyDict::new(py);
        out.set_item("problems", list)?;
        Ok(out)
    };
    attributes().map_or_else(|error| error, |attributes| exception(py, "CaseError", found.to_string(), &attributes))
}

/// The exception of a command that has no result.
pub(crate) fn of_run(py: Python<'_>, error: &RunError) -> PyErr {
    match error.cause() {
        RunError::Input(found) => problems(py, found),
        RunError::Forward { member, error: source, file, .. } => {
            let file = file.as_ref().map(|file| file.display().to_string());
            solve(py, error.to_string(), member, code(source), file)
        }
        other => {
            let class = match other.exit() {
                Exit::BadInput => "CaseError",
                Exit::ForwardFailed => "SolveError",
                Exit::NotWritten => "OutputError",
                _ => "Error",
            };
            exception(py, class, error.to_string(), &PyDict::new(py))
        }
    }
}

/// The exception of time steps that could not be found.
pub(crate) fn of_steps(py: Python<'_>, error: &StepsError) -> PyErr {
    match error {
        StepsError::Input(found) => problems(py, found),
        StepsError::Motion { error: source, .. } => solve(py, error.to_string(), "", code(source), None),
    }
}

/// The exception of an evaluation that failed.
pub(crate) fn of_evaluation(py: Python<'_>, failed: &Failed) -> PyErr {
    match failed.downcast_ref::<EnsembleError>() {
        Some(error) if error.lacks_second_derivatives() => exception(py, "Error", failed.to_string(), &PyDict::new(py)),
        Some(EnsembleError::Member { who, source }) => solve(py, failed.to_string(), who, code(source), None),
        Some(EnsembleError::Length { .. }) => input(py, failed),
        _ => solve(py, failed.to_string(), "", None, None),
    }
}

/// What kind of failure it was, as in the entry `failure` of results.
fn code(error: &ControlError) -> Option<&'static str> {
    match error {
        ControlError::State(state) => Some(state.code()),
        ControlError::LimitPoint { .. } => Some("limit_point"),
        _ => None,
    }
}

fn solve(py: Python<'_>, message: String, member: &str, kind: Option<&str>, file: Option<String>) -> PyErr {
    let attributes = || -> PyResult<Bound<'_, PyDict>> {
        let out = PyDict::new(py);
        out.set_item("member", member)?;
        out.set_item("kind", kind)?;
        out.set_item("file", file)?;
        Ok(out)
    };
    attributes().map_or_else(|error| error, |attributes| exception(py, "SolveError", message, &attributes))
}
