//! Walls of chambers in the colour of their pressure.

use super::fields::PRESSURE;
use super::lumen;
use super::paths;
use super::state::State;
use crate::error::ReportError;
use crate::folder::ResultFolder;
use crate::record::number_of;
use nastic_mesh::MeshError;
use nastic_picture::{Appearance, Body, Field};
use serde_json::Value;

/// A chamber as the case lists it.
struct Chamber {
    name: String,
    surfaces: Vec<String>,
}

/// The chambers of the case.
fn all(folder: &ResultFolder) -> Vec<Chamber> {
    let case: Value = folder.case.as_deref().and_then(|text| serde_json::from_str(text).ok()).unwrap_or_default();
    let text = |entry: &Value, key: &str| entry[key].as_str().map(str::to_owned);
    let of = |entry: &Value| {
        let is_chamber = entry["kind"].as_str() == Some("cavity");
        let surfaces = match &entry["surface"] {
            Value::Array(names) => names.iter().filter_map(Value::as_str).map(str::to_owned).collect(),
            name => vec![name.as_str()?.to_owned()],
        };
        is_chamber.then(|| Some(Chamber { name: text(entry, "name")?, surfaces }))?
    };
    case["actuation"].as_array().into_iter().flatten().filter_map(of).collect()
}

pub(super) fn names(folder: &ResultFolder) -> Vec<String> {
    all(folder).into_iter().map(|chamber| chamber.name).collect()
}

/// Whether there are chambers, and the results have all their pressures in this state: those of paths and kept iterations they have not.
pub(super) fn are_known(folder: &ResultFolder, state: &State<'_>) -> bool {
    let names = names(folder);
    !names.is_empty() && names.iter().all(|name| pressure(folder, state, name).is_ok())
}

/// The pressures of all chambers in a state, from zero.
pub(super) fn range(folder: &ResultFolder, state: &State<'_>) -> Result<[f64; 2], ReportError> {
    let pressures: Vec<f64> =
        names(folder).iter().map(|name| pressure(folder, state, name)).collect::<Result<_, _>>()?;
    Ok(pressures.into_iter().fold([0.0, 0.0], |[low, high]: [f64; 2], p| [low.min(p), high.max(p)]))
}

/// One body for the walls of each chamber, all on one scale from zero.
pub(super) fn bodies(
    folder: &ResultFolder,
    state: &State<'_>,
    range: Option<[f64; 2]>,
) -> Result<Vec<Body>, ReportError> {
    let shot = &state.shot;
    let mut found = Vec::new();
    for chamber in all(folder) {
        let walls: Result<Vec<_>, _> = chamber.surfaces.iter().map(|name| shot.mesh.surface(name)).collect();
        let facets = walls.map(|walls| walls.concat()).map_err(|error| {
            folder.content(&format!("{}.vtu", state.name), format!("the wall of chamber \"{}\": {error}", chamber.name))
        })?;
        let body = if shot.mesh.dim() == 2 {
            let positions = shot.positions();
            let bad = |error: MeshError| folder.content(&format!("{}.vtu", state.name), error.to_string());
            Body::new("", lumen::mesh(&shot.mesh, &positions, &facets).map_err(bad)?)
        } else {
            let mut marked = vec![false; shot.mesh.points().len()];
            shot.mesh.nodes_of_facets(&facets).iter().for_each(|node| marked[*node as usize] = true);
            Body::of("", shot).part(marked)
        };
        found.push((pressure(folder, state, &chamber.name)?, body));
    }
    let (low, high) = found.iter().fold((0.0, 0.0), |(low, high): (f64, f64), (p, _)| (low.min(*p), high.max(*p)));
    let [low, high] = range.unwrap_or([low, high]);
    let unit = &folder.result.units.pressure;
    let body = |(pressure, body): (f64, Body)| {
        let field = Field::at_nodes(PRESSURE, unit, vec![pressure; body.nodes()]).range(low, high);
        body.appearance(Appearance::Field(field)).lines(false)
    };
    Ok(found.into_iter().map(body).collect())
}

/// The pressure of a chamber in the state that is shown: what the result says of it or of the ramp's equilibrium, of an instant what `motion.csv` does.
fn pressure(folder: &ResultFolder, state: &State<'_>, chamber: &str) -> Result<f64, ReportError> {
    let stem = state.stem();
    let own = state.name.strip_prefix(stem).unwrap_or(&state.name);
    if own.starts_with("motion_") {
        return paths::at_instant(folder, state, &format!("{chamber}.{PRESSURE}"));
    }
    let row = own.strip_prefix("ramp_").and_then(|number| number.parse::<usize>().ok());
    // the result speaks of the optimum, or of the equilibrium of a solve
    let is_reported = own == "optimum" || own == "start" && !folder.wrote(&format!("{stem}optimum.vtu"));
    let reported = match (row, state.record.and_then(|record| record.ramp.as_ref())) {
        (Some(row), Some(ramp)) => ramp.points.get(row).map(|point| &point.state),
        _ => state.record.filter(|_| is_reported),
    };
    reported
        .and_then(|record| number_of(record.contributions.get(chamber)?, PRESSURE))
        .ok_or_else(|| ReportError::NoPressure { chamber: chamber.to_owned(), state: state.name.clone() })
}
