//! Values over the time from CSV files, as formulas of t.

use super::context::Context;
use crate::warning::UNITS;
use nastic_language::expression::Formula;
use nastic_language::number::short;
use nastic_language::schema::{
    Case, Coordinates, Cost, CostTerm, Fixed, KeyValue, Obstacle, Parameter, Start, TimeTable, VectorField,
    VectorInTime,
};
use nastic_language::syntax::{At, quoted};

/// A table of which the motion takes so small a share is hardly in its unit.
const APART: f64 = 50.0;

/// Puts what the files say in the place of their names; one that cannot be read is complained about and left.
pub(super) fn resolve(case: &mut Case, context: &mut Context<'_>) {
    let end = case.time.as_ref().map(|time| time.end);
    for control in &mut case.controls {
        let Some(Start::Table(table)) = &control.start else { continue };
        if let Some(formulas) = formulas(table, end, &control.at.key("start"), context) {
            control.start = Some(match <[Formula; 1]>::try_from(formulas) {
                Ok([formula]) => Start::Scalar(formula),
                Err(several) => Start::Vector(several),
            });
        }
    }
    resolve_poses(&mut case.obstacles, end, context);
    for load in &mut case.loads {
        let at = load.at.clone();
        let parts =
            [("traction", &mut load.traction), ("body_force", &mut load.body_force), ("gravity", &mut load.gravity)];
        resolve_vectors(parts, &at, end, context);
    }
    for block in &mut case.costs {
        if let Cost::Term(term) = block {
            resolve_paths(term, end, context);
        }
    }
    for actuation in &mut case.actuation {
        for (key, fixed) in &mut actuation.fixed {
            let Fixed::Table(table) = fixed else { continue };
            if let Some(formulas) = formulas(table, end, &actuation.at.key(key), context) {
                *fixed = match <[Formula; 1]>::try_from(formulas) {
                    Ok([formula]) => Fixed::Scalar(Parameter::Formula(formula)),
                    Err(several) => Fixed::Vector(VectorField::Formulas(several)),
                };
            }
        }
    }
}

/// The same of positions that a term aims at.
fn resolve_paths(term: &mut CostTerm, end: Option<f64>, context: &mut Context<'_>) {
    for (key, value) in &mut term.values {
        let KeyValue::Path(table) = value else { continue };
        let at = term.at.key(key);
        if let Some(formulas) = formulas(table, end, &at, context) {
            let mut given = formulas.into_iter();
            let by_component = table.components().into_iter().map(|column| column.and_then(|_| given.next())).collect();
            *value = KeyValue::Position(Box::new(Coordinates::of(by_component, &at)));
        }
    }
}

/// The same of the poses of obstacles.
fn resolve_poses(obstacles: &mut [Obstacle], end: Option<f64>, context: &mut Context<'_>) {
    for obstacle in obstacles {
        let at = obstacle.at.clone();
        let parts = [("translation", &mut obstacle.translation), ("rotation", &mut obstacle.rotation)];
        resolve_vectors(parts, &at, end, context);
    }
}

/// The same of vectors by their keys.
fn resolve_vectors<const N: usize>(
    parts: [(&str, &mut Option<VectorInTime>); N],
    at: &At,
    end: Option<f64>,
    context: &mut Context<'_>,
) {
    for (key, part) in parts {
        let Some(VectorInTime(fixed)) = part else { continue };
        let Fixed::Table(table) = fixed else { continue };
        if let Some(formulas) = formulas(table, end, &at.key(key), context) {
            *fixed = Fixed::Vector(VectorField::Formulas(formulas));
        }
    }
}

fn formulas(table: &TimeTable, end: Option<f64>, at: &At, context: &mut Context<'_>) -> Option<Vec<Formula>> {
    let path = context.file(&table.file);
    let text = std::fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()));
    let text = context.take(&at.key("file"), text)?;
    let columns = columns(&text, &table.names()).map_err(|why| format!("{}: {why}", table.file));
    let columns = context.take(&at.key("file"), columns)?;
    if let (Some(end), Some(rows)) = (end, columns.first()) {
        check_unit(table, rows, end, &at.key("file"), context);
    }
    let named =
        |(name, rows): (&str, Vec<(f64, f64)>)| Formula::over_time(&format!("{name} of {}", table.file), rows.into());
    Some(table.names().into_iter().zip(columns).map(named).collect())
}

/// Warns of times that look as if they were in another unit than that of the motion.
fn check_unit(table: &TimeTable, rows: &[(f64, f64)], end: f64, at: &At, context: &mut Context<'_>) {
    let last = rows.last().map_or(0.0, |(t, _)| *t);
    // one row is a constant, whatever its time
    if rows.len() < 2 || last <= end * APART {
        return;
    }
    let unit = context.units.time().symbol;
    let message = format!(
        "t of {} ends at {} {unit}, the motion at {} {unit}: t is in the case's unit of time, {unit}; is it in another one there?",
        table.file,
        short(last),
        short(end)
    );
    context.warn(&UNITS, at, message);
}

/// The columns over that of the time.
fn columns(text: &str, names: &[&str]) -> Result<Vec<Vec<(f64, f64)>>, String> {
    let mut lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    let (_, head) = lines.next().ok_or("the file is empty; its first line names the columns, one of them \"t\"")?;
    let head: Vec<&str> = head.split(',').map(|name| name.trim().trim_matches('"')).collect();
    let place = |name: &str| {
        let known = || format!("no column {}; it has: {}", quoted(name), head.join(", "));
        if head.iter().filter(|column| **column == name).count() > 1 {
            return Err(format!("two columns are called {}: leave out one, or name it differently", quoted(name)));
        }
        head.iter().position(|column| *column == name).ok_or_else(known)
    };
    let (t, wanted) = (place("t")?, names.iter().map(|name| place(name)).collect::<Result<Vec<_>, _>>()?);
    let mut out: Vec<Vec<(f64, f64)>> = wanted.iter().map(|_| Vec::new()).collect();
    for (number, line) in lines {
        let cells: Vec<&str> = line.split(',').collect();
        let value = |column: usize| {
            let cell = cells.get(column).map_or("", |cell| cell.trim());
            let value = cell.parse::<f64>().ok().filter(|value| value.is_finite());
            value.ok_or_else(|| {
                format!("line {}: {} in column \"{}\" is no number", number + 1, quoted(cell), head[column])
            })
        };
        let time = value(t)?;
        for (rows, &column) in out.iter_mut().zip(&wanted) {
            if let Some((before, _)) = rows.last().filter(|(before, _)| *before >= time) {
                return Err(format!("line {}: t = {time} does not lie behind {before}", number + 1));
            }
            rows.push((time, value(column)?));
        }
    }
    if out.iter().any(Vec::is_empty) { Err("no line of numbers below the names".to_owned()) } else { Ok(out) }
}
