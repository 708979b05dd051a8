//! Distances between shapes, and their points.

use crate::error;
use nastic_mesh::GroupNames;
use nastic_report::{CompareRequest, ComparedPart};
use nastic_run::run::RunError;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use std::path::PathBuf;

/// Nodes, reference positions and positions of a state's part.
type Points<'py> = (Bound<'py, PyArray1<i64>>, Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>);

/// How far two shapes are apart, as JSON text.
#[pyfunction]
#[pyo3(signature = (a, b, *, surface, region, scale))]
pub(crate) fn compare(
    py: Python<'_>,
    a: PathBuf,
    b: PathBuf,
    surface: Vec<String>,
    region: Vec<String>,
    scale: Option<f64>,
) -> PyResult<String> {
    let request = CompareRequest { part: part(surface, region), scale };
    let found = py.detach(|| nastic_report::compare(&a, &b, &request));
    let found = found.map_err(|problem| error::of_run(py, &RunError::from(problem)))?;
    serde_json::to_string(&found).map_err(|problem| error::input(py, problem))
}

/// The points of a state.
#[pyfunction]
#[pyo3(signature = (directory, *, state, surface, region))]
pub(crate) fn cloud<'py>(
    py: Python<'py>,
    directory: PathBuf,
    state: Option<String>,
    surface: Vec<String>,
    region: Vec<String>,
) -> PyResult<Points<'py>> {
    let part = part(surface, region);
    let found = py.detach(|| nastic_report::cloud(&directory, state.as_deref(), &part));
    let found = found.map_err(|problem| error::of_run(py, &RunError::from(problem)))?;
    let rows = |points: &[[f64; 3]]| {
        let rows: Vec<Vec<f64>> = points.iter().map(|x| x.to_vec()).collect();
        PyArray2::from_vec2(py, &rows).map_err(|problem| error::input(py, problem))
    };
    let nodes: Vec<i64> = found.nodes.iter().map(|&node| node.into()).collect();
    Ok((PyArray1::from_vec(py, nodes), rows(&found.reference)?, rows(&found.points)?))
}

fn part(surface: Vec<String>, region: Vec<String>) -> ComparedPart {
    match (surface.is_empty(), region.is_empty()) {
        (false, _) => ComparedPart::Surface(GroupNames::from(surface)),
        (true, false) => ComparedPart::Region(GroupNames::from(region)),
        (true, true) => ComparedPart::Whole,
    }
}
