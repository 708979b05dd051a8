//! The figures of a sweep over its first swept value.

use crate::number::short;
use crate::record::SweptRecord;
use crate::sweep::row::SweepRow;
use nastic_picture::{Chart, Curve};

/// Curves of one chart.
const CURVES: usize = 6;

/// Where the values of the first swept option stand.
pub struct SweepAxis {
    /// What the axis is called.
    pub label: String,
    /// A place for every value.
    pub places: Vec<f64>,
    /// Whether the places are numbers of the runs, and the values their names.
    pub is_named: bool,
}

/// The chart of all rows; `None` where no run has a number.
pub(super) fn chart(title: &str, swept: &[SweptRecord], axis: &SweepAxis, rows: &[SweepRow]) -> Option<Chart> {
    let first = swept.first()?;
    let several = swept.len() > 1;
    let figures = figures(rows);
    let place = |row: &SweepRow| {
        let text = row.values.iter().find(|(path, _)| *path == first.path).map(|(_, text)| text);
        axis.places[first.values.iter().position(|value| Some(value) == text).unwrap_or(0)]
    };
    let curve = |label: &str, rows: &mut dyn Iterator<Item = &SweepRow>, figure: &str, scale: f64| {
        let mut points: Vec<(f64, f64, bool)> =
            rows.filter_map(|row| Some((place(row), row.number(figure)? / scale, row.is_done()))).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        Curve::new(label, points)
    };
    let mut chart = match figures.as_slice() {
        [] => return None,
        // One figure for every combination of the other values.
        [figure, ..] if several => {
            let others = |row: &SweepRow| -> String {
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
pub(super) fn figures(rows: &[SweepRow]) -> Vec<&str> {
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
