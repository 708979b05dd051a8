//! The figures of a sweep over its first swept value.

use crate::run::sweep::row::Row;
use nastic_case::lower::Swept;
use nastic_language::expression::Formula;
use nastic_language::number::short;
use nastic_language::quantity::Units;
use nastic_picture::{Chart, Curve};

/// Curves of one chart.
const CURVES: usize = 6;

/// The chart of all rows; `None` where no run has a number.
pub(super) fn chart(title: &str, options: &[Swept], rows: &[Row]) -> Option<Chart> {
    let first = options.iter().find(|one| one.is_swept())?;
    let axis = Axis::of(first);
    let several = options.iter().filter(|one| one.is_swept()).count() > 1;
    let figures = figures(rows);
    let place = |row: &Row| {
        let text = row.values.iter().find(|(path, _)| *path == first.path).map(|(_, text)| text);
        axis.places[first.values.iter().position(|value| Some(value) == text).unwrap_or(0)]
    };
    let curve = |label: &str, rows: &mut dyn Iterator<Item = &Row>, figure: &str, scale: f64| {
        let mut points: Vec<(f64, f64, bool)> =
            rows.filter_map(|row| Some((place(row), row.number(figure)? / scale, row.is_done()))).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        Curve::new(label, points)
    };
    let mut chart = match figures.as_slice() {
        [] => return None,
        // One figure for every combination of the other values.
        [figure, ..] if several => {
            let others = |row: &Row| -> String {
                let others = row.values.iter().filter(|(path, _)| *path != first.path);
                others.map(|(_, text)| text.as_str()).collect::<Vec<_>>().join(", ")
            };
            let mut names: Vec<String> = Vec::new();
            rows.iter().map(others).for_each(|name| {
                if !names.contains(&name) {
                    names.push(name)
                }
            });
            let mut chart = Chart::new(title, &axis.label, figure);
            for name in names {
                chart = chart.curve(curve(&name, &mut rows.iter().filter(|row| others(row) == name), figure, 1.0));
            }
            chart
        }
        [figure] => Chart::new(title, &axis.label, figure).curve(curve(figure, &mut rows.iter(), figure, 1.0)),
        figures => {
            let mut chart = Chart::new(title, &axis.label, "share of the largest absolute value of each curve");
            for figure in figures {
                let most = rows.iter().filter_map(|row| row.number(figure)).fold(0.0, |most: f64, x| most.max(x.abs()));
                let scale = if most > 0.0 { most } else { 1.0 };
                chart = chart.curve(curve(&format!("{figure} (1: {})", short(scale)), &mut rows.iter(), figure, scale));
            }
            chart
        }
    };
    if axis.is_named {
        for (value, place) in first.values.iter().zip(&axis.places) {
            chart = chart.mark(*place, value);
        }
    }
    Some(chart)
}

/// Cost, distances and uniform controls; without any of them the displacements of probes.
fn figures(rows: &[Row]) -> Vec<&str> {
    let mut known: Vec<&str> = Vec::new();
    for row in rows {
        let numbers = row.figures.iter().filter(|(_, value)| value.is_number()).map(|(path, _)| path.as_str());
        numbers.for_each(|path| {
            if !known.contains(&path) {
                known.push(path)
            }
        });
    }
    let wanted = |path: &&str| {
        ["cost/total", "hausdorff/true"].contains(path)
            || path.starts_with("tracking/") && path.ends_with("/root_mean_square")
            || path.starts_with("controls/") && path.contains("/values")
    };
    let mut out: Vec<&str> = known.iter().copied().filter(wanted).collect();
    if out.is_empty() {
        out = known.into_iter().filter(|path| path.starts_with("probes/") && path.contains("/displacement/")).collect();
    }
    out.truncate(CURVES);
    out
}

/// Where the values of an option stand.
struct Axis {
    label: String,
    places: Vec<f64>,
    /// Whether the places are numbers of the runs, and the values their names.
    is_named: bool,
}

impl Axis {
    /// Numbers with one unit as they were typed, other quantities in SI; anything else side by side.
    fn of(option: &Swept) -> Self {
        let parts: Option<Vec<(f64, &str)>> = option.values.iter().map(|text| split(text)).collect();
        if let Some(parts) = parts
            && parts.iter().all(|(_, unit)| *unit == parts[0].1)
        {
            let label =
                if parts[0].1.is_empty() { option.label.clone() } else { format!("{} ({})", option.label, parts[0].1) };
            return Self { label, places: parts.into_iter().map(|(number, _)| number).collect(), is_named: false };
        }
        let in_si = |text: &String| Formula::parse(text.trim_matches('"'), &Units::default()).ok()?.constant();
        if let Some(places) = option.values.iter().map(in_si).collect::<Option<Vec<f64>>>() {
            return Self { label: format!("{} (SI)", option.label), places, is_named: false };
        }
        let places = (0..option.values.len()).map(|k| k as f64).collect();
        Self { label: option.label.clone(), places, is_named: true }
    }

    /// Whether the places are in the order of the values.
    fn ascends(&self) -> bool {
        self.places.windows(2).all(|pair| pair[0] < pair[1])
    }
}

/// A number and the unit behind it.
fn split(text: &str) -> Option<(f64, &str)> {
    let text = text.trim().trim_matches('"');
    let unit = text.find(|c: char| c.is_whitespace()).unwrap_or(text.len());
    let number: f64 = text[..unit].parse().ok()?;
    number.is_finite().then_some((number, text[unit..].trim()))
}

/// The times of runs in a collection: the values of the one swept option where they ascend, else the index of the run.
pub(super) fn times(options: &[Swept], runs: usize) -> Vec<f64> {
    let swept: Vec<&Swept> = options.iter().filter(|one| one.is_swept()).collect();
    match swept.as_slice() {
        [one] if Axis::of(one).ascends() => Axis::of(one).places,
        _ => (0..runs).map(|k| k as f64).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_stand_where_their_units_put_them() {
        let axis = |text: &str| Axis::of(&Swept::read(&[format!("a/young={text}")]).unwrap()[0]);
        let same = axis("90 kPa,110 kPa");
        assert_eq!((same.label.as_str(), same.places.as_slice()), ("young (kPa)", [90.0, 110.0].as_slice()));
        let other = axis("90 kPa,0.2 MPa,0.1 MPa");
        assert_eq!((other.label.as_str(), other.places.as_slice()), ("young (SI)", [9e4, 2e5, 1e5].as_slice()));
        let names = axis("lbfgs,spectral");
        assert!(names.is_named && names.places == [0.0, 1.0]);
        assert_eq!(axis("[1,0,0],[0,1,0]").places, [0.0, 1.0]);
        assert!(!other.ascends() && same.ascends());
    }
}
