//! Tables of test data: CSV with a line of column names and units.

use crate::quantity::{Dimension, Unit};
use crate::schema::FitTest;
use crate::syntax::{Diagnostic, Diagnostics, Document, quoted};
use nastic_fit::{FitError, Mode, Response, Test};
use std::path::Path;

/// The columns that may stand for a deformation.
const STRETCH: &[&str] = &["stretch", "strain"];
const SHEAR: &[&str] = &["shear"];
const RATIO: &[&str] = &["volume_ratio"];
/// The columns of responses.
const RESPONSES: [(&str, Response); 4] = [
    ("nominal_stress", Response::Nominal),
    ("cauchy_stress", Response::Cauchy),
    ("shear_stress", Response::Shear),
    ("pressure", Response::Pressure),
];

/// Where something is wrong: line and column from 1, 0 for the file as a whole.
type Wrong = (usize, usize, String);

/// Reads the table of a test.
pub(super) fn read(document: &Document, test: &FitTest, mode: Mode) -> Result<Test, Diagnostics> {
    let path = document.resolve(&test.file);
    let text = std::fs::read_to_string(&path).map_err(|error| {
        document.complain(&test.at.key("file"), format!("{} cannot be read: {error}", path.display()))
    })?;
    let (response, rows) = parse(&text, mode).map_err(|wrong| {
        let report = |(line, column, message)| Diagnostic {
            file: path.display().to_string(),
            path: String::new(),
            line,
            column,
            message,
        };
        Diagnostics::new(wrong.into_iter().map(report).collect())
    })?;
    let stem =
        || Path::new(&test.file).file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    let name = test.name.clone().unwrap_or_else(stem);
    let points = rows.iter().map(|row| row.point).collect();
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
    Ok(made.weighted(test.weight))
}

/// A row that was measured.
struct Row {
    line: usize,
    point: [f64; 2],
}

/// A column of use: its place, and how a number of it becomes one in SI.
struct Column {
    index: usize,
    factor: f64,
    shift: f64,
}

fn parse(text: &str, mode: Mode) -> Result<(Response, Vec<Row>), Vec<Wrong>> {
    let lines = text.trim_start_matches('\u{feff}').lines().enumerate().map(|(k, line)| (k + 1, line));
    let mut lines = lines.filter(|(_, line)| !line.trim().is_empty() && !line.trim_start().starts_with('#'));
    let Some((line, head)) = lines.next() else {
        let example = "stretch,nominal_stress [MPa]";
        return Err(vec![(0, 0, format!("the table is empty: a line of columns is wanted, as in \"{example}\""))]);
    };
    let (x, y, response) = columns(line, head, mode)?;
    let (mut rows, mut wrong) = (Vec::new(), Vec::new());
    for (line, row) in lines {
        let value = |column: &Column| number(line, row, column.index).map(|v| v * column.factor + column.shift);
        match (value(&x), value(&y)) {
            (Ok(x), Ok(y)) => rows.push(Row { line, point: [x, y] }),
            (x, y) => wrong.extend([x, y].into_iter().filter_map(Result::err)),
        }
    }
    if rows.is_empty() && wrong.is_empty() {
        wrong.push((0, 0, "the table has no rows below its line of columns".to_owned()));
    }
    if wrong.is_empty() { Ok((response, rows)) } else { Err(wrong) }
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
    let separator = if row.contains(';') { ';' } else { ',' };
    let mut at = 1;
    row.split(separator).map(move |cell| {
        let blanks = cell.chars().take_while(|c| c.is_whitespace()).count();
        let place = at + blanks;
        at += cell.chars().count() + 1;
        (place, cell.trim())
    })
}

/// The columns of deformation and response.
fn columns(line: usize, head: &str, mode: Mode) -> Result<(Column, Column, Response), Vec<Wrong>> {
    let known = match mode {
        Mode::SimpleShear => SHEAR,
        Mode::Volumetric => RATIO,
        _ => STRETCH,
    };
    let (mut x, mut y, mut wrong) = (None, None, Vec::new());
    for (index, (place, cell)) in cells(head).enumerate() {
        let (name, unit) = match cell.split_once('[') {
            Some((name, unit)) => (name.trim(), Some(unit.trim_end_matches(']').trim())),
            None => (cell, None),
        };
        if known.contains(&name) && x.is_none() {
            match unit {
                None | Some("1" | "-" | "") => {
                    x = Some(Column { index, factor: 1.0, shift: f64::from(name == "strain") })
                }
                Some("%") if name == "strain" => x = Some(Column { index, factor: 0.01, shift: 1.0 }),
                Some(unit) => {
                    wrong.push((line, place, format!("\"{name}\" is a pure number, not in {}", quoted(unit))))
                }
            }
        } else if let (Some((_, response)), None) = (RESPONSES.iter().find(|(known, _)| *known == name), &y) {
            match pressure_unit(unit) {
                Ok(factor) => y = Some((Column { index, factor, shift: 0.0 }, *response)),
                Err(why) => wrong.push((line, place, format!("\"{name}\" {why}"))),
            }
        }
    }
    match (x, y) {
        (Some(x), Some((y, response))) if wrong.is_empty() => Ok((x, y, response)),
        (x, y) => {
            let found: Vec<&str> = cells(head).map(|(_, cell)| cell).collect();
            let lacks = |what: &str| {
                format!("no column {what} for a test of kind \"{}\"; found: {}", mode.name(), found.join(", "))
            };
            if wrong.is_empty() && x.is_none() {
                wrong.push((line, 1, lacks(&format!("\"{}\"", known.join("\" or \"")))));
            }
            if wrong.is_empty() && y.is_none() {
                let names: Vec<&str> = RESPONSES.iter().map(|(name, _)| *name).collect();
                wrong.push((line, 1, lacks(&format!("\"{}\"", names.join("\" or \"")))));
            }
            Err(wrong)
        }
    }
}

/// Pa per unit of a column.
fn pressure_unit(unit: Option<&str>) -> Result<f64, String> {
    let example = "as in \"nominal_stress [MPa]\" (Pa, kPa, MPa, GPa, bar, mbar)";
    let Some(symbol) = unit else { return Err(format!("has no unit: it stands in brackets, {example}")) };
    match Unit::named(symbol) {
        Some(unit) if unit.dimension == Dimension::PRESSURE => Ok(10f64.powi(unit.exponent)),
        _ => Err(format!("has the unit {}, but a pressure is wanted, {example}", quoted(symbol))),
    }
}
