//! The tables of the page: scenarios, controls and their bounds, gradient certificate, stability, mesh, run.

use crate::html::{escape, folded, paragraph, section, table};
use crate::number::{count, duration, number, short};
use crate::record::{
    ContributionKind, ContributionRecord, ControlRecord, MemberRecord, Nullable, Number, ProbesRecord, RangeRecord,
    RunRecord, StateRecord, WidthRecord,
};
use crate::summary::stability;
use nastic_mesh::Snapshot;

/// Rows of scenarios that are not folded away.
const OPEN: usize = 12;

/// Cost, distance and stability of every scenario and load case; measures of risk.
pub(crate) fn members(result: &RunRecord) -> String {
    if result.members.as_ref().map_or(0, Vec::len) < 2 {
        return String::new();
    }
    let none = StateRecord::default();
    let row = |member: &MemberRecord| {
        let own = result.member(member).unwrap_or(&none);
        let begin = result.start.member(member).unwrap_or(&none);
        let scenario = member.scenario.as_ref().and_then(|name| result.scenarios.get(name));
        vec![
            member.name.clone(),
            number(scenario.and_then(|scenario| scenario.probability).or(own.weight), ""),
            number(begin.cost.total, ""),
            number(own.cost.total, ""),
            number(own.hausdorff.as_ref().and_then(|distances| *distances.exact), &result.units.length),
            number(own.min_j, ""),
            stability(own).0.to_owned(),
        ]
    };
    let rows: Vec<Vec<String>> = result.members.iter().flatten().map(row).collect();
    let head =
        ["state", "probability or weight", "cost at the start", "cost", "true distance", "smallest J", "stability"];
    let (count_of, all) = (rows.len(), told_columns(&head, rows));
    let mut content = if count_of > OPEN { folded(&count(count_of, "state"), &all) } else { all };
    let measures = result.risk.measures.iter().flatten();
    let rows: Vec<Vec<String>> = measures
        .map(|(name, one)| {
            let smoothed = (*one.exact).and(*one.value);
            vec![measure(name, one.level), number(one.plain(), ""), number(smoothed, "")]
        })
        .collect();
    content += &table(&["measure of risk", "value", "smoothed, as it is optimised"], &rows);
    section("members", "Scenarios and load cases", &content)
}

/// A measure of risk with its level, where it has one.
pub(crate) fn measure(name: &str, level: Option<f64>) -> String {
    let level = level.map_or_else(String::new, |level| format!(" (level {})", short(level)));
    name.replace('_', " ") + &level
}

/// The table without the columns that say nothing.
fn told_columns(head: &[&str], rows: Vec<Vec<String>>) -> String {
    let shown: Vec<usize> = (0..head.len()).filter(|k| rows.iter().any(|row| row[*k] != "–")).collect();
    let head: Vec<&str> = shown.iter().map(|k| head[*k]).collect();
    let rows: Vec<Vec<String>> = rows.iter().map(|row| shown.iter().map(|k| row[*k].clone()).collect()).collect();
    table(&head, &rows)
}

/// The unit that people read for one of results, and what its numbers are multiplied by: electric fields in kV/mm.
fn readable(unit: &str) -> (f64, &str) {
    match unit {
        "V/m" => (1e-6, "kV/mm"),
        "mV/m" => (1e-9, "kV/mm"),
        other => (1.0, other),
    }
}

/// In thousands.
fn kilo(value: Number) -> String {
    number(value.map(|value| 1e-3 * value), "")
}

/// A width and where it is.
fn width(own: &Option<WidthRecord>, unit: &str) -> String {
    let Some(own) = own else { return "–".to_owned() };
    let place: Vec<String> = own.position.iter().map(|x| number(*x, "")).collect();
    format!("{} at ({})", number(own.width, unit), place.join(", "))
}

/// Range and active bounds of every control.
pub(crate) fn controls(result: &RunRecord) -> String {
    let row = |(name, control): (&String, &ControlRecord)| {
        let (factor, unit) = readable(control.unit.as_deref().unwrap_or_default());
        let number = |value: Number, unit: &str| number(value.map(|value| factor * value), unit);
        let count = |n: Option<usize>| crate::number::number(n.map(|n| n as f64), "");
        let volts = |range: &RangeRecord| format!("{} to {} kV", kilo(range.min), kilo(range.max));
        let share = control.active_share.map_or_else(String::new, |x| format!(" ({:.0} %)", 100.0 * x));
        vec![
            name.clone(),
            control.space.as_deref().unwrap_or("–").to_owned(),
            count(control.unknowns),
            number(control.min, unit),
            number(control.max, unit),
            number(control.lower, unit),
            number(control.upper, unit),
            control.voltage.as_ref().map_or_else(|| "–".to_owned(), volts),
            format!("{}{share}", count(control.active)),
            crate::number::number(control.total_variation, ""),
            crate::number::number(control.volume, ""),
            crate::number::number(control.greyness, ""),
            width(&control.smallest_bar, &result.units.length),
            width(&control.smallest_gap, &result.units.length),
        ]
    };
    let rows: Vec<Vec<String>> = result.controls.iter().flatten().map(row).collect();
    let head = [
        "control",
        "space",
        "values",
        "least",
        "largest",
        "lower bound",
        "upper bound",
        "voltage at rest",
        "on a bound",
        "total variation",
        "mean",
        "greyness",
        "smallest bar",
        "smallest gap",
    ];
    section("controls", "Controls and active bounds", &told_columns(&head, rows))
}

/// The gradient check that a run begins with, and those of further starts.
pub(crate) fn certificate(result: &RunRecord) -> String {
    let check = &result.gradient_check;
    let Some(verdict) = &check.verdict else { return String::new() };
    let mismatch = check.mismatch.map_or_else(String::new, |x| {
        format!(" Relative mismatch with differences of the cost along a random admissible direction: {}.", short(x))
    });
    let text = format!("Adjoint derivative at the start: {verdict}.{mismatch}");
    section("certificate", "Gradient certificate", &paragraph(&text))
}

fn pivots(count: &Nullable<usize>) -> String {
    number(count.map(|n| n as f64), "")
}

/// Critical values of ramps, limit points and bifurcations of paths.
pub(crate) fn events(result: &RunRecord) -> String {
    let mut rows = Vec::new();
    for (name, own) in entries(result) {
        for series in own.ramp.iter().chain(&own.path) {
            for event in series.critical.iter().chain(&series.events).flatten() {
                rows.push(vec![
                    format!("{name}{}", event.kind.as_deref().unwrap_or("critical value")),
                    number(event.value, series.unit.as_deref().unwrap_or_default()),
                    format!("{} to {}", pivots(&event.before), pivots(&event.after)),
                ]);
            }
        }
    }
    section("events", "Critical points", &table(&["kind", "value", "negative pivots"], &rows))
}

/// Probes, reactions and what contributions report, of the result's state, or of every load case.
pub(crate) fn states(result: &RunRecord) -> String {
    let length = &result.units.length;
    let vector =
        |value: &[Number]| -> Vec<String> { (0..3).map(|k| number(value.get(k).and_then(|x| **x), "")).collect() };
    let (mut probes, mut reported) = (Vec::new(), Vec::new());
    for (name, own) in entries(result) {
        for (probe, entry) in own.probes.iter().flatten() {
            let (displacement, position) = match entry {
                ProbesRecord::One(probe) => (probe.displacement.as_slice(), probe.position.as_slice()),
                ProbesRecord::OfLoadCase(_) => Default::default(),
            };
            let mut row = vec![format!("{name}{probe}")];
            row.extend(vector(displacement));
            row.extend(vector(position));
            probes.push(row);
        }
        let supports = own.reactions.iter().flatten();
        reported.extend(supports.map(|(own, force)| (format!("{name}{own}"), ContributionRecord::of_support(force))));
        reported.extend(own.contributions.iter().map(|(own, record)| (format!("{name}{own}"), record.clone())));
        let half = own.half_thickness.iter().flat_map(|half| half.contacts.iter().flatten());
        reported.extend(half.map(|(own, entry)| (format!("{name}{own}, its layer half as thick"), entry.clone())));
    }
    let heads = ["u x", "u y", "u z", "x", "y", "z"].map(|head| format!("{head} [{length}]"));
    let head: Vec<&str> = ["probe"].into_iter().chain(heads.iter().map(String::as_str)).collect();
    let mut content = table(&head, &probes);
    let mut shown = "Probes".to_owned();
    for kind in ContributionKind::ALL {
        let heads = kind.heads(&result.units);
        let own = reported.iter().filter(|(_, record)| record.kind == kind);
        let rows: Vec<Vec<String>> = own.flat_map(|(name, record)| record.rows(name, &result.units)).collect();
        content += &table(&heads.iter().map(String::as_str).collect::<Vec<_>>(), &rows);
        let several = kind.row().several;
        shown += &if several.is_empty() { String::new() } else { format!(", {several}") };
    }
    section("states", &shown, &content)
}

/// The result's own entries, or those of its load cases with their names.
fn entries(result: &RunRecord) -> Vec<(String, &StateRecord)> {
    match result.load_cases.is_empty() {
        true => vec![(String::new(), &result.state)],
        false => result.load_cases.iter().map(|(name, entry)| (format!("{name}: "), entry)).collect(),
    }
}

/// Inertia, modes, self-intersection.
pub(crate) fn stabilities(result: &RunRecord) -> String {
    let mut content = String::new();
    if result.inertia.is_stated() {
        let (what, why) = stability(result);
        content += &paragraph(&format!("{what}: {why}."));
    }
    if let Some(cells) = result.self_intersection.as_ref().map(|found| found.cells) {
        let text = match cells {
            0 => "The deformed body does not intersect itself.".to_owned(),
            n => format!("The deformed body intersects itself in {}.", count(n, "cell")),
        };
        content += &paragraph(&text);
    }
    let values = result.modes.eigenvalues.iter().flatten().enumerate();
    let unit = result.modes.unit.as_deref().unwrap_or_default();
    let rows: Vec<Vec<String>> =
        values.map(|(k, value)| vec![format!("mode {}", k + 1), number(*value, unit)]).collect();
    content += &table(&["mode of the tangent", "eigenvalue"], &rows);
    let values = result.modes.frequencies.iter().flatten().enumerate();
    let shown = |value: Number| if value.is_none() { "unstable".to_owned() } else { number(value, "Hz") };
    let rows: Vec<Vec<String>> = values.map(|(k, value)| vec![format!("mode {}", k + 1), shown(*value)]).collect();
    content += &table(&["mode of vibration", "frequency"], &rows);
    section("stability", "Stability", &content)
}

/// Shapes of the cells at the start of the run, in the reference body and at its end.
pub(crate) fn mesh(first: Option<&Snapshot>, last: Option<&Snapshot>) -> String {
    let (Some(first), Some(last)) = (first, last) else { return String::new() };
    let mesh = &first.mesh;
    let kinds: Vec<String> =
        mesh.blocks().iter().map(|block| format!("{} {}", block.len(), block.kind.name())).collect();
    let text = format!("{} cells ({}), {} nodes.", mesh.cells(), kinds.join(", "), mesh.points().len());
    let row = |what: &str, positions: &[[f64; 3]]| {
        let quality = mesh.quality_at(positions);
        let aspect = quality.cells.iter().map(|cell| cell.aspect).fold(0.0, f64::max);
        vec![
            what.to_owned(),
            short(quality.scaled_jacobian()),
            short(quality.jacobian_ratio()),
            short(aspect),
            short(quality.shortest_edge),
            short(quality.longest_edge),
        ]
    };
    let rows = [row("reference body", mesh.points()), row("last state", &last.positions())];
    let head = [
        "",
        "least scaled Jacobian",
        "least Jacobian ratio in a cell",
        "largest aspect",
        "shortest edge",
        "longest edge",
    ];
    section("mesh", "Mesh quality", &(paragraph(&text) + &table(&head, &rows)))
}

/// Times, work, starts, versions, files.
pub(crate) fn run(result: &RunRecord) -> String {
    let mut content = String::new();
    let starts = result.optimum.starts.iter().flatten().enumerate();
    let rows: Vec<Vec<String>> = starts
        .map(|(k, start)| {
            let end = start.stop.as_ref().or(start.failed.as_ref()).cloned().unwrap_or_default();
            let mark = if result.optimum.best_start == Some(k) { " (the best)" } else { "" };
            vec![
                format!("{}{mark}", k + 1),
                number(start.start_cost, ""),
                number(start.cost, ""),
                number(start.iterations.map(|n| n as f64), ""),
                end,
            ]
        })
        .collect();
    content += &table(&["start", "cost at the start", "cost", "iterations", "end"], &rows);
    let work = [
        (result.newton_iterations, "Newton iterations"),
        (result.factorisations, "factorisations"),
        (result.reused_factorisations, "reused factorisations"),
        (result.back_substitutions, "back substitutions"),
        (result.multigrid_cycles, "multigrid cycles"),
        (result.unassembled_systems, "systems without an assembled tangent"),
    ];
    let shown = work.into_iter().filter_map(|(n, name)| Some((n.filter(|n| *n > 0)?, name)));
    let rows: Vec<Vec<String>> = shown.map(|(n, name)| vec![name.to_owned(), short(n as f64)]).collect();
    content += &table(&["work", "count"], &rows);
    let times = result.seconds.iter();
    let rows: Vec<Vec<String>> =
        times.filter_map(|(phase, seconds)| Some(vec![phase.replace('_', " "), duration((**seconds)?)])).collect();
    content += &table(&["phase", "time"], &rows);
    let rows = [
        vec!["case".to_owned(), result.case.clone().unwrap_or_default()],
        vec!["hash of the case and its files".to_owned(), result.case_hash.clone()],
        vec!["nastic".to_owned(), result.versions.nastic.clone()],
        vec!["linear solver".to_owned(), result.linear_solver.clone().unwrap_or_default()],
        vec!["exit code".to_owned(), result.exit.map_or_else(String::new, |code| code.to_string())],
    ];
    let rows: Vec<Vec<String>> = rows.into_iter().filter(|row| !row[1].is_empty()).collect();
    content += &table(&["run", ""], &rows);
    if let Some(files) = result.files.as_ref().filter(|files| !files.is_empty()) {
        content += &folded(&count(files.len(), "file"), &paragraph(&files.join(", ")));
    }
    section("run", "Run", &content)
}

/// The case itself, folded.
pub(crate) fn case(text: Option<&str>) -> String {
    let Some(text) = text else { return String::new() };
    let content = format!("<pre tabindex=\"0\" aria-label=\"Case file\">{}</pre>\n", escape(text));
    section("case", "Case", &folded("The case with its overrides, comments left out", &content))
}
