//! Columns of test data: names, as machines write them too, and units.

use super::test_sheet::{Cell, Line};
use super::test_table::Wrong;
use nastic_fit::{Mode, Response};
use nastic_language::quantity::{Dimension, Unit};
use nastic_language::syntax::quoted;

/// The columns that may stand for a deformation.
const STRETCHES: &[&str] = &["stretch", STRAIN, EXTENSION];
pub(super) const STRAIN: &str = "strain";
pub(super) const EXTENSION: &str = "extension";
const SHEAR: &[&str] = &["shear"];
const RATIO: &[&str] = &["volume_ratio"];
/// The columns of responses.
const RESPONSES: [(&str, Response); 5] = [
    ("nominal_stress", Response::Nominal),
    ("cauchy_stress", Response::Cauchy),
    (FORCE, Response::Nominal),
    ("shear_stress", Response::Shear),
    ("pressure", Response::Pressure),
];
pub(super) const FORCE: &str = "force";

/// What machines call them, in small letters with `_` for blanks.
const ALIASES: &[(&str, &str)] = &[
    ("load", FORCE),
    ("axial_force", FORCE),
    ("standard_force", FORCE),
    ("displacement", EXTENSION),
    ("axial_displacement", EXTENSION),
    ("crosshead", EXTENSION),
    ("tensile_extension", EXTENSION),
    ("tensile_strain", STRAIN),
    ("engineering_strain", STRAIN),
    ("nominal_strain", STRAIN),
    ("stress", "nominal_stress"),
    ("tensile_stress", "nominal_stress"),
    ("engineering_stress", "nominal_stress"),
    ("true_stress", "cauchy_stress"),
    ("kraft", FORCE),
    ("standardkraft", FORCE),
    ("weg", EXTENSION),
    ("standardweg", EXTENSION),
    ("traversenweg", EXTENSION),
    ("dehnung", STRAIN),
    ("spannung", "nominal_stress"),
];
/// They do not say of which area.
const UNSAID: [&str; 2] = ["stress", "spannung"];

/// Units of machines that cases do not know, in SI.
const UNITS_OF_MACHINES: &[(&str, Dimension, f64)] = &[
    ("N/mm^2", Dimension::PRESSURE, 1e6),
    ("N/mm2", Dimension::PRESSURE, 1e6),
    ("N/mm\u{b2}", Dimension::PRESSURE, 1e6),
    ("MPA", Dimension::PRESSURE, 1e6),
    ("KPA", Dimension::PRESSURE, 1e3),
    ("N/m^2", Dimension::PRESSURE, 1.0),
    ("psi", Dimension::PRESSURE, POUND / (INCH * INCH)),
    ("PSI", Dimension::PRESSURE, POUND / (INCH * INCH)),
    ("ksi", Dimension::PRESSURE, 1e3 * POUND / (INCH * INCH)),
    ("lbf", Dimension::FORCE, POUND),
    ("lb", Dimension::FORCE, POUND),
    ("kgf", Dimension::FORCE, 9.80665),
    ("gf", Dimension::FORCE, 9.80665e-3),
    ("KN", Dimension::FORCE, 1e3),
    ("in", Dimension::LENGTH, INCH),
    ("inch", Dimension::LENGTH, INCH),
    ("MM", Dimension::LENGTH, 1e-3),
];
/// The pound as a force, N.
const POUND: f64 = 4.448_221_615_260_5;
/// m
const INCH: f64 = 0.0254;

/// What a table of forces and extensions does not say, in SI.
#[derive(Clone, Copy, Default)]
pub(super) struct Specimen {
    pub area: Option<f64>,
    pub length: Option<f64>,
}

/// A column of use: its place, and how a number of it becomes one in SI.
pub(super) struct Column {
    /// As in [`STRETCHES`] or [`RESPONSES`].
    pub name: &'static str,
    pub index: usize,
    pub factor: f64,
    pub shift: f64,
}

/// The columns of deformation and response.
pub(super) struct Columns {
    pub x: Column,
    pub y: Column,
    pub response: Response,
    /// The name of a column of stresses that does not say which.
    pub taken: Option<String>,
}

fn deformations(mode: Mode) -> &'static [&'static str] {
    match mode {
        Mode::SimpleShear => SHEAR,
        Mode::Volumetric => RATIO,
        _ => STRETCHES,
    }
}

/// Lines of columns that a test of this kind may have.
pub(super) fn wanted(mode: Mode) -> &'static [&'static str] {
    match mode {
        Mode::SimpleShear => &["shear,shear_stress [MPa]"],
        Mode::Volumetric => &["volume_ratio,pressure [MPa]"],
        Mode::Inflation { .. } => &["stretch,pressure [kPa]"],
        _ => &["stretch,nominal_stress [MPa]", "extension [mm],force [N]"],
    }
}

/// What a column is called here: a deformation, or a response, of this kind of test.
fn known(cell: &str, mode: Mode) -> Option<(&'static str, Option<Response>)> {
    let name = cell.split(['[', '(']).next().unwrap_or(cell).trim().to_lowercase();
    let name = name.split([' ', '_', '-']).filter(|word| !word.is_empty()).collect::<Vec<_>>().join("_");
    let name = ALIASES.iter().find(|(alias, _)| *alias == name).map_or(name.as_str(), |(_, own)| own);
    let deformation = deformations(mode).iter().find(|own| **own == name).map(|own| (*own, None));
    let responses = || RESPONSES.iter().filter(|(_, response)| mode.takes(*response));
    deformation.or_else(|| responses().find(|(own, _)| *own == name).map(|(own, response)| (*own, Some(*response))))
}

/// Whether these are a line of columns.
pub(super) fn names(cells: &[Cell], mode: Mode) -> bool {
    let has =
        |response: bool| cells.iter().any(|cell| known(&cell.text, mode).is_some_and(|(_, y)| y.is_some() == response));
    has(false) && has(true)
}

/// The columns of deformation and response; `units` is the line below the names.
pub(super) fn columns(
    head: &Line,
    units: Option<&[Cell]>,
    mode: Mode,
    specimen: Specimen,
) -> Result<Columns, Vec<Wrong>> {
    let line = head.number;
    let (mut xs, mut ys, mut wrong) = (Vec::new(), Vec::new(), Vec::new());
    let cells = head.cells(head.separator());
    for (index, cell) in cells.iter().enumerate() {
        let Some((name, response)) = known(&cell.text, mode) else { continue };
        let below =
            units.and_then(|units| units.get(index)).map(|cell| cell.text.trim_matches(['(', ')', '[', ']', ' ']));
        let unit = unit_of(&cell.text).map(|unit| unit.or(below));
        let read = unit.and_then(|unit| match response {
            Some(response) => {
                let factor = if name == FORCE { specimen.stress(unit) } else { pressure_unit(unit) };
                factor.map(|factor| ys.push((cell, Column { name, index, factor, shift: 0.0 }, response)))
            }
            None => {
                let numbers = if name == EXTENSION { specimen.stretch(unit) } else { strain_unit(name, unit) };
                numbers.map(|[factor, shift]| xs.push((cell, Column { name, index, factor, shift })))
            }
        });
        wrong.extend(read.err().map(|why| (line, cell.column, format!("\"{}\" {why}", bare(&cell.text)))));
    }
    let both = |first: &Cell, second: &Cell| {
        let (first, second) = (bare(&first.text), bare(&second.text));
        format!("the columns \"{first}\" and \"{second}\" are both there: leave out one, or give it a name of its own")
    };
    wrong.extend(xs.windows(2).map(|pair| (line, pair[1].0.column, both(pair[0].0, pair[1].0))));
    wrong.extend(ys.windows(2).map(|pair| (line, pair[1].0.column, both(pair[0].0, pair[1].0))));
    if wrong.is_empty() {
        match (xs.pop(), ys.pop()) {
            (Some((_, x)), Some((cell, y, response))) => {
                let taken = UNSAID
                    .iter()
                    .any(|own| bare(&cell.text).eq_ignore_ascii_case(own))
                    .then(|| bare(&cell.text).to_owned());
                return Ok(Columns { x, y, response, taken });
            }
            (None, _) => wrong.push((line, 1, lacks(deformations(mode), &cells, mode))),
            (_, None) => {
                let names = RESPONSES.iter().filter(|(_, response)| mode.takes(*response)).map(|(name, _)| *name);
                wrong.push((line, 1, lacks(&names.collect::<Vec<_>>(), &cells, mode)));
            }
        }
    }
    Err(wrong)
}

fn lacks(names: &[&str], cells: &[Cell], mode: Mode) -> String {
    let found: Vec<&str> = cells.iter().map(|cell| cell.text.as_str()).collect();
    let wanted: Vec<String> = wanted(mode).iter().map(|line| format!("`{line}`")).collect();
    format!(
        "no column \"{}\" for a test of kind \"{}\"; found: {}; the first line that is wanted is {}",
        names.join("\" or \""),
        mode.name(),
        found.join(", "),
        wanted.join(" or ")
    )
}

/// The name without its unit.
pub(super) fn bare(cell: &str) -> &str {
    cell.split(['[', '(']).next().unwrap_or(cell).trim()
}

/// What stands in brackets behind the name of a column.
pub(super) fn unit_of(cell: &str) -> Result<Option<&str>, String> {
    let Some(at) = cell.find(['[', '(']) else { return Ok(None) };
    let inner = cell[at + 1..].strip_suffix([']', ')']);
    let inner = inner.ok_or_else(|| format!("has a bracket that is not closed: {}", quoted(cell)))?;
    Ok(Some(inner.trim()))
}

/// Factor and shift from a column of deformations to stretches, amounts of shear and ratios of volumes.
fn strain_unit(name: &str, unit: Option<&str>) -> Result<[f64; 2], String> {
    match unit {
        None | Some("1" | "-" | "" | "mm/mm" | "m/m" | "in/in") => Ok([1.0, f64::from(name == STRAIN)]),
        Some("%") if name == STRAIN => Ok([0.01, 1.0]),
        Some(unit) => Err(format!("is a pure number, not in {}", quoted(unit))),
    }
}

impl Specimen {
    /// Nominal stress per unit of a column of forces: `P = force / area`.
    fn stress(self, unit: Option<&str>) -> Result<f64, String> {
        let newton = scale(unit, Dimension::FORCE, "a force", "as in \"force [N]\" (N, mN, kN, lbf, kgf)")?;
        let missing = "needs the area at rest of the cross-section: \"area\" of the test, as \"40 mm^2\" (--area of a table alone)";
        self.area.map(|area| newton / area).ok_or_else(|| missing.to_owned())
    }

    /// Factor and shift from a column of extensions to stretches: `l = 1 + extension / length`.
    fn stretch(self, unit: Option<&str>) -> Result<[f64; 2], String> {
        let metre = scale(unit, Dimension::LENGTH, "a length", "as in \"extension [mm]\" (mm, cm, m, in)")?;
        let missing = "needs the length at rest that was extended: \"length\" of the test, as \"33 mm\" (--length of a table alone)";
        self.length.map(|length| [metre / length, 1.0]).ok_or_else(|| missing.to_owned())
    }
}

/// SI per unit of a column that has this dimension.
pub(super) fn scale(unit: Option<&str>, dimension: Dimension, what: &str, example: &str) -> Result<f64, String> {
    let Some(symbol) = unit else { return Err(format!("has no unit: it stands in brackets, {example}")) };
    let own = Unit::named(symbol).filter(|unit| unit.dimension == dimension).map(|unit| 10f64.powi(unit.exponent));
    let of_machines =
        || UNITS_OF_MACHINES.iter().find(|(own, of, _)| *own == symbol && *of == dimension).map(|row| row.2);
    let wrong = || format!("has the unit {}, but {what} is wanted, {example}", quoted(symbol));
    own.or_else(of_machines).ok_or_else(wrong)
}

/// Pa per unit of a column.
fn pressure_unit(unit: Option<&str>) -> Result<f64, String> {
    let example = "as in \"nominal_stress [MPa]\" (Pa, kPa, MPa, GPa, bar, mbar, N/mm^2, psi)";
    scale(unit, Dimension::PRESSURE, "a pressure", example)
}
