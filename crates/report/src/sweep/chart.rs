//! The figures of a sweep over its first swept value.
//!
//! Which are shown: the one that was asked for; else cost, distances and uniform controls of optimisations, distances of solves; without any of them
//! the displacements of probes, or else the elastic energy. The cost at the start controls of a solve, whatever they are, is none of them.

use crate::number::short;
use crate::record::SweptRecord;
use crate::sweep::figure::Figure;
use crate::sweep::row::SweepRow;
use nastic_picture::{Chart, Curve};
use std::path::Path;

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

/// The chart of these figures in all rows; `None` where no run has a number.
pub(super) fn chart(
    title: &str,
    swept: &[SweptRecord],
    axis: &SweepAxis,
    figures: &[Figure],
    rows: &[SweepRow],
) -> Option<Chart> {
    let first = swept.first()?;
    let several = swept.len() > 1;
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
    let mut chart = match figures {
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
            let mut chart = Chart::new(title, &axis.label, &figure.label());
            for name in names {
                chart =
                    chart.curve(curve(&name, &mut rows.iter().filter(|row| others(row) == name), &figure.path, 1.0));
            }
            chart
        }
        [figure] => {
            let own = curve(&figure.path, &mut rows.iter(), &figure.path, 1.0);
            Chart::new(title, &axis.label, &figure.label()).curve(own)
        }
        figures => {
            let mut chart = Chart::new(title, &axis.label, "share of the largest absolute value of each curve");
            for Figure { path: figure, .. } in figures {
                let most = rows.iter().filter_map(|row| row.number(figure)).fold(0.0, |most: f64, x| most.max(x.abs()));
                let scale = if most > 0.0 { most } else { 1.0 };
                chart = chart.curve(curve(&format!("{figure} (1: {})", short(scale)), &mut rows.iter(), figure, scale));
            }
            chart
        }
    };
    if axis.is_named {
        for (value, place) in first.values.iter().zip(&axis.places) {
            chart = chart.name(*place, &short_name(value));
        }
    }
    Some(chart)
}

/// What a value of the axis is called: of a file its name without directory and ending.
pub(super) fn short_name(value: &str) -> String {
    let text = value.trim().trim_matches('"');
    let is_file = !text.starts_with(['{', '[']) && Path::new(text).extension().is_some();
    let stem = Path::new(text).file_stem().filter(|_| is_file);
    stem.map_or_else(|| text.to_owned(), |stem| stem.to_string_lossy().into_owned())
}

/// The figures that a sweep shows unless another one is asked for.
pub(super) fn usual(command: &str, rows: &[SweepRow]) -> Vec<String> {
    let known = known(rows);
    let optimizes = command == "optimize";
    let wanted = |path: &&str| {
        *path == "hausdorff/true"
            || path.starts_with("tracking/") && path.ends_with("/root_mean_square")
            || optimizes && (*path == "cost/total" || path.starts_with("controls/") && path.contains("/values"))
    };
    let displacements = |path: &&str| path.starts_with("probes/") && path.contains("/displacement/");
    let chosen = |which: &dyn Fn(&&str) -> bool| -> Vec<String> {
        known.iter().filter(|path| which(path)).take(CURVES).map(|path| (*path).to_owned()).collect()
    };
    let energy = |path: &&str| *path == "energy/elastic";
    let mut all = [chosen(&wanted), chosen(&displacements), chosen(&energy)].into_iter();
    all.find(|found| !found.is_empty()).unwrap_or_default()
}

/// The paths of all figures that are numbers in some row.
pub(super) fn known<'r>(rows: impl IntoIterator<Item = &'r SweepRow>) -> Vec<&'r str> {
    let mut known: Vec<&str> = Vec::new();
    for row in rows {
        let numbers = row.figures.iter().filter(|(_, value)| value.is_number()).map(|(path, _)| path.as_str());
        numbers.for_each(|path| {
            if !known.contains(&path) {
                known.push(path)
            }
        });
    }
    known
}
