//! Tables of test data: CSV with a line of column names and units, stresses and stretches or the forces and extensions of a specimen.

use super::test_stiffness;
use nastic_fit::{FitError, Mode, Response, Test};
use nastic_language::number::short;
use nastic_language::quantity::{Dimension, Unit};
use nastic_language::schema::{FitData, FitKind, FitTest};
use nastic_language::syntax::{Diagnostic, Diagnostics, Document, quoted};
use std::path::Path;

/// The columns that may stand for a deformation.
const STRETCH: &[&str] = &["stretch", "strain", EXTENSION];
const EXTENSION: &str = "extension";
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

const FORCE: &str = "force";

/// What a table of forces and extensions does not say, in SI.
#[derive(Clone, Copy, Default)]
struct Specimen {
    area: Option<f64>,
    length: Option<f64>,
}

/// Where something is wrong: line and column from 1, 0 for the file as a whole.
type Wrong = (usize, usize, String);

/// Strains beyond this, 1000 %, no rubber bears: percent were meant.
const LARGEST_STRAIN: f64 = 10.0;

/// The tables of a data file, with what deserves attention in them.
///
/// # Errors
/// A file that cannot be read, a row that is none: all that is wrong with any.
pub fn read_tests(document: &Document, asked: &FitData) -> Result<(Vec<Test>, Vec<String>), Diagnostics> {
    let (mut tests, mut doubtful, mut problems) = (Vec::new(), Vec::new(), Vec::new());
    for test in &asked.tests {
        match read(document, test, mode(test)) {
            Ok((read, doubt)) => {
                tests.push(read);
                doubtful.extend(doubt);
            }
            Err(found) => problems.extend(found.list().iter().cloned()),
        }
    }
    Diagnostics::new(problems).into_result().map(|()| (tests, doubtful))
}

fn mode(test: &FitTest) -> Mode {
    match test.kind {
        FitKind::Uniaxial => Mode::Uniaxial,
        FitKind::Equibiaxial => Mode::Equibiaxial,
        FitKind::Planar => Mode::Planar,
        FitKind::SimpleShear => Mode::SimpleShear,
        // the schema has seen to it that there is one
        FitKind::Inflation => Mode::Inflation { thickness_to_radius: test.thickness_to_radius.unwrap_or(f64::NAN) },
        FitKind::Volumetric => Mode::Volumetric,
    }
}

/// Reads the table of a test, and what deserves attention in it.
fn read(document: &Document, test: &FitTest, mode: Mode) -> Result<(Test, Vec<String>), Diagnostics> {
    let path = document.resolve(&test.file);
    let text = std::fs::read_to_string(&path).map_err(|error| {
        document.complain(&test.at.key("file"), format!("{} cannot be read: {error}", path.display()))
    })?;
    let specimen = Specimen { area: test.area, length: test.length };
    let Table { response, rows, is_strain, uses } = parse(&text, mode, specimen).map_err(|wrong| {
        let report = |(line, column, message)| Diagnostic {
            file: path.display().to_string(),
            path: String::new(),
            line,
            column,
            message,
        };
        Diagnostics::new(wrong.into_iter().map(report).collect())
    })?;
    for (key, given, column, used) in [("area", test.area, FORCE, uses[0]), ("length", test.length, EXTENSION, uses[1])]
    {
        if given.is_some() && !used {
            let message = format!("{} has no column \"{column}\" that it would be for", path.display());
            return Err(document.complain(&test.at.key(key), message).into());
        }
    }
    let stem =
        || Path::new(&test.file).file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    let name = test.name.clone().unwrap_or_else(stem);
    let points = rows.iter().map(|row| row.point).collect();
    let largest = rows.iter().map(|row| row.point[0] - 1.0).fold(0.0, f64::max);
    let doubtful = (is_strain && largest > LARGEST_STRAIN).then(|| {
        format!(
            "{}: \"strain\" reaches {}, which is {} %: if it is in percent, write \"strain [%]\"",
            path.display(),
            short(largest),
            short(100.0 * largest)
        )
    });
    let doubtful: Vec<String> = doubtful.into_iter().collect();
    let made = Test::new(&name, mode, response, points).map_err(|error| match &error {
        FitError::Point { point, .. } => Diagnostics::from(Diagnostic {
            file: path.display().to_string(),
            path: String::new(),
            line: rows[*point].line,
            column: 1,
            message: error.to_string(),
        }),
        _ => document.complain(&test.at, error.to_string()).into(),
    })?;
    let made = match test.fibers.as_ref().map(|fibers| fibers.fibers()) {
        None => made,
        Some(fibers) => {
            made.loaded(fibers).map_err(|error| document.complain(&test.at.key("fibers"), error.to_string()))?
        }
    };
    let made = made.weighted(test.weight);
    let made = made.map_err(|error| document.complain(&test.at.key("weight"), error.to_string()))?;
    let stiffness = test_stiffness::doubtful(&made, &path.display().to_string());
    Ok((made, doubtful.into_iter().chain(stiffness).collect()))
}

/// What a table holds.
struct Table {
    response: Response,
    rows: Vec<Row>,
    /// Whether the deformations are strains as plain numbers.
    is_strain: bool,
    /// Whether they are forces over an area, and extensions over a length.
    uses: [bool; 2],
}

/// A row that was measured.
struct Row {
    line: usize,
    point: [f64; 2],
}

/// A column of use: its place, and how a number of it becomes one in SI.
struct Column<'a> {
    name: &'a str,
    index: usize,
    factor: f64,
    shift: f64,
}

fn parse(text: &str, mode: Mode, specimen: Specimen) -> Result<Table, Vec<Wrong>> {
    let lines = text.trim_start_matches('\u{feff}').lines().enumerate().map(|(k, line)| (k + 1, line));
    let mut lines = lines.filter(|(_, line)| !line.trim().is_empty() && !line.trim_start().starts_with('#'));
    let Some((line, head)) = lines.next() else {
        let example = "stretch,nominal_stress [MPa]";
        return Err(vec![(0, 0, format!("the table is empty: a line of columns is wanted, as in \"{example}\""))]);
    };
    let (x, y, response) = columns(line, head, mode, specimen)?;
    let named = cells(head).count();
    let (mut rows, mut wrong) = (Vec::new(), Vec::new());
    for (line, row) in lines {
        if let Some((column, _)) = cells(row).nth(named) {
            wrong.push((line, column, surplus(row, named)));
            continue;
        }
        let value = |column: &Column| number(line, row, column.index).map(|v| v * column.factor + column.shift);
        match (value(&x), value(&y)) {
            (Ok(x), Ok(y)) => rows.push(Row { line, point: [x, y] }),
            (x, y) => wrong.extend([x, y].into_iter().filter_map(Result::err)),
        }
    }
    if rows.is_empty() && wrong.is_empty() {
        wrong.push((0, 0, "the table has no rows below its line of columns".to_owned()));
    }
    let is_strain = x.name == "strain" && x.factor == 1.0;
    let uses = [y.name == FORCE, x.name == EXTENSION];
    if wrong.is_empty() { Ok(Table { response, rows, is_strain, uses }) } else { Err(wrong) }
}

/// A decimal comma splits a number into two cells, and the rest of the row moves on by one column.
fn surplus(row: &str, named: usize) -> String {
    let comma = if separator(row) == ',' {
        ": are there decimal commas? Numbers have a point, or semicolons separate the columns"
    } else {
        ""
    };
    format!("the row has {} cells, but the line of columns has {named}{comma}", cells(row).count())
}

fn number(line: usize, row: &str, index: usize) -> Result<f64, Wrong> {
    let Some((column, cell)) = cells(row).nth(index) else {
        return Err((line, row.chars().count() + 1, format!("the row has no column {}", index + 1)));
    };
    match cell.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err((line, column, format!("{} is no number; leave out rows without one", quoted(cell)))),
    }
}

/// Cells with their columns in the line, from 1, without blanks around them.
fn cells(row: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut at = 1;
    row.split(separator(row)).map(move |cell| {
        let blanks = cell.chars().take_while(|c| c.is_whitespace()).count();
        let place = at + blanks;
        at += cell.chars().count() + 1;
        (place, cell.trim())
    })
}

fn separator(row: &str) -> char {
    if row.contains(';') { ';' } else { ',' }
}

/// The columns of deformation and response.
fn columns(
    line: usize,
    head: &str,
    mode: Mode,
    specimen: Specimen,
) -> Result<(Column<'_>, Column<'_>, Response), Vec<Wrong>> {
    let known = match mode {
        Mode::SimpleShear => SHEAR,
        Mode::Volumetric => RATIO,
        _ => STRETCH,
    };
    let answers: Vec<&(&str, Response)> = RESPONSES.iter().filter(|(_, response)| mode.takes(*response)).collect();
    let (mut xs, mut ys, mut wrong) = (Vec::new(), Vec::new(), Vec::new());
    for (index, (place, cell)) in cells(head).enumerate() {
        let name = cell.split('[').next().unwrap_or(cell).trim();
        let answer = answers.iter().find(|(known, _)| *known == name);
        let is_deformation = known.contains(&name);
        if answer.is_none() && !is_deformation {
            continue;
        }
        let read = unit_of(cell).and_then(|unit| match answer {
            Some((_, response)) => {
                let factor = if name == FORCE { specimen.stress(unit) } else { pressure_unit(unit) };
                factor.map(|factor| ys.push((name, place, Column { name, index, factor, shift: 0.0 }, *response)))
            }
            None => {
                let numbers = if name == EXTENSION { specimen.stretch(unit) } else { strain_unit(name, unit) };
                numbers.map(|[factor, shift]| xs.push((name, place, Column { name, index, factor, shift })))
            }
        });
        wrong.extend(read.err().map(|why| (line, place, format!("\"{name}\" {why}"))));
    }
    let both = |first: &str, second: &str| {
        format!("the columns \"{first}\" and \"{second}\" are both there: leave out one, or give it a name of its own")
    };
    wrong.extend(xs.windows(2).map(|pair| (line, pair[1].1, both(pair[0].0, pair[1].0))));
    wrong.extend(ys.windows(2).map(|pair| (line, pair[1].1, both(pair[0].0, pair[1].0))));
    if wrong.is_empty() {
        let found: Vec<&str> = cells(head).map(|(_, cell)| cell).collect();
        let lacks = |names: &[&str]| {
            let (what, kind) = (names.join("\" or \""), mode.name());
            (line, 1, format!("no column \"{what}\" for a test of kind \"{kind}\"; found: {}", found.join(", ")))
        };
        let names: Vec<&str> = answers.iter().map(|(name, _)| *name).collect();
        match (xs.pop(), ys.pop()) {
            (Some((_, _, x)), Some((_, _, y, response))) => return Ok((x, y, response)),
            (None, _) => wrong.push(lacks(known)),
            (_, None) => wrong.push(lacks(&names)),
        }
    }
    Err(wrong)
}

/// What stands in brackets behind the name of a column.
fn unit_of(cell: &str) -> Result<Option<&str>, String> {
    let Some((_, unit)) = cell.split_once('[') else { return Ok(None) };
    let inner = unit.strip_suffix(']').ok_or_else(|| format!("has a bracket that is not closed: {}", quoted(cell)))?;
    Ok(Some(inner.trim()))
}

/// Factor and shift from a column of deformations to stretches, amounts of shear and ratios of volumes.
fn strain_unit(name: &str, unit: Option<&str>) -> Result<[f64; 2], String> {
    match unit {
        None | Some("1" | "-" | "") => Ok([1.0, f64::from(name == "strain")]),
        Some("%") if name == "strain" => Ok([0.01, 1.0]),
        Some(unit) => Err(format!("is a pure number, not in {}", quoted(unit))),
    }
}

impl Specimen {
    /// Nominal stress per unit of a column of forces: `P = force / area`.
    fn stress(self, unit: Option<&str>) -> Result<f64, String> {
        let newton = scale(unit, Dimension::FORCE, "a force", "as in \"force [N]\" (N, mN, kN)")?;
        let missing = "needs the area at rest of the cross-section: \"area\" of the test, as \"40 mm^2\" (--area of a table alone)";
        self.area.map(|area| newton / area).ok_or_else(|| missing.to_owned())
    }

    /// Factor and shift from a column of extensions to stretches: `l = 1 + extension / length`.
    fn stretch(self, unit: Option<&str>) -> Result<[f64; 2], String> {
        let metre = scale(unit, Dimension::LENGTH, "a length", "as in \"extension [mm]\" (mm, cm, m)")?;
        let missing = "needs the length at rest that was extended: \"length\" of the test, as \"33 mm\" (--length of a table alone)";
        self.length.map(|length| [metre / length, 1.0]).ok_or_else(|| missing.to_owned())
    }
}

/// SI per unit of a column that has this dimension.
fn scale(unit: Option<&str>, dimension: Dimension, what: &str, example: &str) -> Result<f64, String> {
    let Some(symbol) = unit else { return Err(format!("has no unit: it stands in brackets, {example}")) };
    match Unit::named(symbol) {
        Some(unit) if unit.dimension == dimension => Ok(10f64.powi(unit.exponent)),
        _ => Err(format!("has the unit {}, but {what} is wanted, {example}", quoted(symbol))),
    }
}

/// Pa per unit of a column.
fn pressure_unit(unit: Option<&str>) -> Result<f64, String> {
    let example = "as in \"nominal_stress [MPa]\" (Pa, kPa, MPa, GPa, bar, mbar)";
    scale(unit, Dimension::PRESSURE, "a pressure", example)
}
