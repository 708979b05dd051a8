//! The scalar that a body is coloured by.

use super::chambers;
use super::state::State;
use crate::error::ReportError;
use crate::folder::ResultFolder;
use crate::frame::DISPLACEMENT;
use crate::page;
use crate::record::UnitsRecord;
use nastic_mesh::NamedArray;
use nastic_picture::Field;
use serde_json::Value;

/// What a body is coloured by.
pub(super) enum Shown {
    Field(Field),
    /// The walls of chambers, by their pressures.
    Chambers,
    Nothing,
}

/// The field of chambers.
pub(super) const PRESSURE: &str = "pressure";
const NONE: &str = "none";
const AXES: &str = "xyz";

/// The name of the field that is shown: the one that is asked for, else the first controlled field that differs over the body, chambers, or the displacement.
pub(super) fn chosen(folder: &ResultFolder, state: &State<'_>, name: Option<&str>) -> String {
    let usual = || controlled(folder, state).unwrap_or_else(|| DISPLACEMENT.to_owned());
    name.map_or_else(usual, str::to_owned)
}

/// Whether that of a name is the pressure of chambers.
pub(super) fn is_of_chambers(folder: &ResultFolder, name: &str) -> bool {
    name == PRESSURE && !chambers::names(folder).is_empty()
}

/// The field of that name, or without a name of the one that is [chosen].
pub(super) fn shown(folder: &ResultFolder, state: &State<'_>, name: Option<&str>) -> Result<Shown, ReportError> {
    let has_chambers = !chambers::names(folder).is_empty();
    let name = chosen(folder, state, name);
    if name == NONE {
        return Ok(Shown::Nothing);
    }
    if name == PRESSURE && has_chambers {
        return Ok(Shown::Chambers);
    }
    let texts = page::fields(&folder.result);
    let shot = &state.shot;
    if name == DISPLACEMENT
        && let Some(u) = shot.point_array("displacement")
    {
        let values = u.values.chunks_exact(u.components).map(length).collect();
        let (label, unit) = text(&texts, &name);
        return Ok(Shown::Field(Field::at_nodes(&label, &unit, values)));
    }
    for (arrays, at_nodes) in [(&shot.point_data, true), (&shot.cell_data, false)] {
        if let Some((array, values)) = arrays.iter().find_map(|array| Some((array, values(array, &name)?))) {
            let (label, unit) = match beyond_the_page(&folder.result.units, &array.name) {
                Some((known, unit)) => (part_of(known, &name, &array.name), unit),
                None => {
                    let (known, unit) = text(&texts, &array.name);
                    (if name == array.name { known } else { name.clone() }, unit)
                }
            };
            let field = if at_nodes { Field::at_nodes } else { Field::at_cells };
            return Ok(Shown::Field(field(&label, &unit, values)));
        }
    }
    let mut has = vec![DISPLACEMENT.to_owned(), NONE.to_owned()];
    has.extend(has_chambers.then(|| PRESSURE.to_owned()));
    has.extend(shot.point_data.iter().chain(&shot.cell_data).map(|array| match array.components {
        1 => array.name.clone(),
        9 => format!("{0}.xx ..", array.name),
        _ => format!("|{0}| {0}.x ..", array.name),
    }));
    Err(ReportError::Unknown { what: "field", name, has })
}

/// The first control whose array is in the state and is no vector of one length; chambers whose pressures are known.
fn controlled(folder: &ResultFolder, state: &State<'_>) -> Option<String> {
    let fields =
        folder.result.controls.iter().flatten().filter(|(_, control)| control.space.as_deref() != Some("uniform"));
    let arrays = fields.filter_map(|(_, control)| control.array.clone());
    let shot = &state.shot;
    let of = |name: String| {
        let array = shot.point_array(&name).or_else(|| shot.cell_array(&name))?;
        let shown = if array.components == 1 { name } else { format!("|{name}|") };
        let values = values(array, &shown)?;
        let most = values.iter().fold(f64::MIN, |most, value| most.max(*value));
        let least = values.iter().fold(f64::MAX, |least, value| least.min(*value));
        (array.components == 1 || most - least > 1e-6 * most.abs()).then_some(shown)
    };
    let found = arrays.filter_map(of).next();
    found.or_else(|| chambers::are_known(folder, state).then(|| PRESSURE.to_owned()))
}

/// The values that a name asks of an array: its own, the lengths of vectors, a component.
fn values(array: &NamedArray, name: &str) -> Option<Vec<f64>> {
    let rows = array.values.chunks_exact(array.components.max(1));
    if name == array.name && array.components == 1 {
        return Some(array.values.clone());
    }
    if name.strip_prefix('|').and_then(|rest| rest.strip_suffix('|')) == Some(&array.name)
        || name == array.name && array.components == 3
    {
        return (array.components == 3).then(|| rows.map(length).collect());
    }
    let axes: Vec<usize> =
        name.strip_prefix(&array.name)?.strip_prefix('.')?.chars().map(|c| AXES.find(c)).collect::<Option<_>>()?;
    let index = match (axes[..].as_ref(), array.components) {
        (&[i], 2 | 3) if i < array.components => i,
        (&[i, j], 9) => 3 * i + j,
        _ => return None,
    };
    Some(rows.map(|row| row[index]).collect())
}

fn length(vector: &[f64]) -> f64 {
    vector.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Arrays that the page does not show: what they are called in a figure, and their units.
fn beyond_the_page(units: &UnitsRecord, array: &str) -> Option<(&'static str, String)> {
    let (name, unit) = match array {
        "contact_pressure" => ("contact pressure", &units.pressure),
        "velocity" => return Some(("velocity", format!("{}/{}", units.length, units.time))),
        "displacement" => ("displacement", &units.length),
        "target_distance" => ("distance from the target", &units.length),
        "reaction" => ("force of the supports", &units.force),
        "nodal_mises" => ("von Mises stress", &units.pressure),
        "cauchy_stress" | "nodal_cauchy_stress" => ("Cauchy stress", &units.pressure),
        "P" => ("first Piola-Kirchhoff stress", &units.pressure),
        "green_strain" => return Some(("Green-Lagrange strain", String::new())),
        _ => return None,
    };
    Some((name, unit.clone()))
}

/// The name of a component, or of a length.
fn part_of(known: &str, name: &str, array: &str) -> String {
    match name.strip_prefix(array).map(|rest| rest.trim_start_matches('.')) {
        Some("") => known.to_owned(),
        Some(component) => format!("{known} {component}"),
        None => format!("|{known}|"),
    }
}

/// What an array is called on the page, and its unit.
fn text(texts: &Value, name: &str) -> (String, String) {
    let of = |key: &str| texts[name][key].as_str().map(str::to_owned);
    (of("label").unwrap_or_else(|| name.to_owned()), of("unit").unwrap_or_default())
}
