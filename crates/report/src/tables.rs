//! The tables of the page: scenarios, controls and their bounds, gradient certificate, stability, mesh, run.

use crate::html::{escape, folded, paragraph, section, table};
use crate::number::{count, duration, number, short};
use crate::scene::entry;
use crate::summary::stability;
use nastic_mesh::Snapshot;
use serde_json::Value;

/// Rows of scenarios that are not folded away.
const OPEN: usize = 12;

/// Cost, distance and stability of every scenario and load case; measures of risk.
pub(crate) fn members(result: &Value) -> String {
    let members: Vec<&Value> = result["members"].as_array().into_iter().flatten().collect();
    if members.len() < 2 {
        return String::new();
    }
    let length = result["units"]["length"].as_str().unwrap_or_default();
    let row = |member: &&Value| {
        let (own, begin) = (entry(result, member), entry(&result["start"], member));
        let scenario = &result["scenarios"][member["scenario"].as_str().unwrap_or_default()];
        let weight = [&scenario["probability"], &own["weight"]].into_iter().find(|value| value.is_number());
        vec![
            member["name"].as_str().unwrap_or_default().to_owned(),
            weight.map_or_else(|| "–".to_owned(), |weight| number(weight, "")),
            number(&begin["cost"]["total"], ""),
            number(&own["cost"]["total"], ""),
            number(&own["hausdorff"]["true"], length),
            number(&own["min_J"], ""),
            stability(own).0.to_owned(),
        ]
    };
    let rows: Vec<Vec<String>> = members.iter().map(row).collect();
    let head =
        ["state", "probability or weight", "cost at the start", "cost", "true distance", "smallest J", "stability"];
    let all = told_columns(&head, rows);
    let mut content = if members.len() > OPEN { folded(&count(members.len() as u64, "state"), &all) } else { all };
    let measures = result["risk"]["measures"].as_object().into_iter().flatten();
    let rows: Vec<Vec<String>> = measures
        .map(|(name, one)| vec![measure(name, &one["level"]), number(&one["value"], ""), number(&one["exact"], "")])
        .collect();
    content += &table(&["measure of risk", "value", "without smoothing"], &rows);
    section("members", "Scenarios and load cases", &content)
}

/// A measure of risk with its level, where it has one.
pub(crate) fn measure(name: &str, level: &Value) -> String {
    let level = level.as_f64().map_or_else(String::new, |level| format!(" (level {})", short(level)));
    name.replace('_', " ") + &level
}

/// The table without the columns that say nothing.
fn told_columns(head: &[&str], rows: Vec<Vec<String>>) -> String {
    let told: Vec<usize> = (0..head.len()).filter(|k| rows.iter().any(|row| row[*k] != "–")).collect();
    let head: Vec<&str> = told.iter().map(|k| head[*k]).collect();
    let rows: Vec<Vec<String>> = rows.iter().map(|row| told.iter().map(|k| row[*k].clone()).collect()).collect();
    table(&head, &rows)
}

/// Range and active bounds of every control.
pub(crate) fn controls(result: &Value) -> String {
    let controls = result["controls"].as_object().into_iter().flatten();
    let row = |(name, control): (&String, &Value)| {
        let unit = control["unit"].as_str().unwrap_or_default();
        let share = control["active_share"].as_f64().map_or_else(String::new, |x| format!(" ({:.0} %)", 100.0 * x));
        vec![
            name.clone(),
            control["space"].as_str().unwrap_or("–").to_owned(),
            number(&control["unknowns"], ""),
            number(&control["min"], unit),
            number(&control["max"], unit),
            number(&control["lower"], unit),
            number(&control["upper"], unit),
            format!("{}{share}", number(&control["active"], "")),
            number(&control["total_variation"], ""),
        ]
    };
    let rows: Vec<Vec<String>> = controls.map(row).collect();
    let head = [
        "control",
        "space",
        "values",
        "least",
        "largest",
        "lower bound",
        "upper bound",
        "on a bound",
        "total variation",
    ];
    section("controls", "Controls and active bounds", &told_columns(&head, rows))
}

/// The gradient check that a run begins with, and those of further starts.
pub(crate) fn certificate(result: &Value) -> String {
    let check = &result["gradient_check"];
    let Some(verdict) = check["verdict"].as_str() else { return String::new() };
    let mismatch = check["mismatch"].as_f64().map_or_else(String::new, |x| {
        format!(" Relative mismatch with differences of the cost along a random admissible direction: {}.", short(x))
    });
    let text = format!("Adjoint derivative at the start: {verdict}.{mismatch}");
    section("certificate", "Gradient certificate", &paragraph(&text))
}

/// Critical values of ramps, limit points and bifurcations of paths.
pub(crate) fn events(result: &Value) -> String {
    let mut rows = Vec::new();
    for (name, own) in entries(result) {
        for (list, kind) in [(&own["ramp"]["critical"], "critical value"), (&own["path"]["events"], "")] {
            for event in list.as_array().into_iter().flatten() {
                let unit = own["ramp"]["unit"].as_str().unwrap_or_default();
                let kind = event["kind"].as_str().unwrap_or(kind);
                let pivots = |key: &str| number(&event[key], "");
                rows.push(vec![
                    format!("{name}{kind}"),
                    number(&event["value"], unit),
                    format!("{} to {}", pivots("before"), pivots("after")),
                ]);
            }
        }
    }
    section("events", "Critical points", &table(&["kind", "value", "negative pivots"], &rows))
}

/// Probes, reactions, cavities, tendons and springs of the result's state, or of every load case.
pub(crate) fn states(result: &Value) -> String {
    let units = &result["units"];
    let unit = |key: &str| units[key].as_str().unwrap_or_default();
    let vector = |value: &Value| -> Vec<String> {
        (0..3).map(|k| value[k].as_f64().map_or_else(|| "–".to_owned(), short)).collect()
    };
    let (mut probes, mut reactions) = (Vec::new(), Vec::new());
    let mut others: Vec<Vec<String>> = Vec::new();
    let (mut cavities, mut tendons, mut springs) = (Vec::new(), Vec::new(), Vec::new());
    for (name, own) in entries(result) {
        for (probe, entry) in own["probes"].as_object().into_iter().flatten() {
            let mut row = vec![format!("{name}{probe}")];
            row.extend(vector(&entry["displacement"]));
            row.extend(vector(&entry["position"]));
            probes.push(row);
        }
        for (support, force) in own["reactions"].as_object().into_iter().flatten() {
            let mut row = vec![format!("{name}{support}")];
            row.extend(vector(force));
            reactions.push(row);
        }
        for (contribution, entry) in own["contributions"].as_object().into_iter().flatten() {
            let of = |key: &str, unit: &str| number(&entry[key], unit);
            if entry.get("force_x").is_some() && entry.get("pressure").is_none() {
                let mut row = vec![format!("{name}{contribution}")];
                row.extend(["force_x", "force_y", "force_z"].map(|key| number(&entry[key], "")));
                reactions.push(row);
                continue;
            }
            if entry.get("tension").is_some() {
                let slack = if entry["slack"] == 1.0 { "slack" } else { "taut" };
                let mut row = vec![format!("{name}{contribution}"), slack.to_owned(), of("tension", unit("force"))];
                row.extend(["length", "reference_length"].map(|key| of(key, unit("length"))));
                tendons.push(row);
                continue;
            }
            if entry.get("rest_length").is_some() {
                let mut row = vec![format!("{name}{contribution}"), of("force", unit("force"))];
                row.extend(["length", "rest_length"].map(|key| of(key, unit("length"))));
                springs.push(row);
                continue;
            }
            if entry.get("volume").is_none() {
                for (quantity, value) in entry.as_object().into_iter().flatten() {
                    others.push(vec![format!("{name}{contribution}"), quantity.replace('_', " "), number(value, "")]);
                }
                continue;
            }
            let volume = format!("{}^3", unit("length"));
            cavities.push(vec![
                format!("{name}{contribution}"),
                of("pressure", unit("pressure")),
                of("volume", &volume),
                of("reference_volume", &volume),
            ]);
        }
    }
    let length = unit("length");
    let heads = ["u x", "u y", "u z", "x", "y", "z"].map(|head| format!("{head} [{length}]"));
    let head: Vec<&str> = ["probe"].into_iter().chain(heads.iter().map(String::as_str)).collect();
    let forces = ["x", "y", "z"].map(|head| format!("{head} [{}]", unit("force")));
    let force_head: Vec<&str> = ["reaction at"].into_iter().chain(forces.iter().map(String::as_str)).collect();
    let content = table(&head, &probes)
        + &table(&force_head, &reactions)
        + &table(&["cavity", "pressure", "volume", "volume at rest"], &cavities)
        + &table(&["contribution", "", ""], &others)
        + &table(&["tendon", "", "tension", "length", "length at rest"], &tendons)
        + &table(&["spring", "force", "length", "rest length"], &springs);
    section("states", "Probes, reactions, cavities, tendons, springs", &content)
}

/// The result's own entries, or those of its load cases with their names.
fn entries(result: &Value) -> Vec<(String, &Value)> {
    match result["load_cases"].as_object() {
        Some(cases) => cases.iter().map(|(name, entry)| (format!("{name}: "), entry)).collect(),
        None => vec![(String::new(), result)],
    }
}

/// Inertia, modes, self-intersection.
pub(crate) fn stabilities(result: &Value) -> String {
    let mut content = String::new();
    if result.get("inertia").is_some() {
        let (what, why) = stability(result);
        content += &paragraph(&format!("{what}: {why}."));
    }
    if let Some(cells) = result["self_intersection"]["cells"].as_u64() {
        let text = match cells {
            0 => "The deformed body does not intersect itself.".to_owned(),
            n => format!("The deformed body intersects itself in {}.", count(n, "cell")),
        };
        content += &paragraph(&text);
    }
    let values = result["modes"]["eigenvalues"].as_array().into_iter().flatten().enumerate();
    let unit = result["modes"]["unit"].as_str().unwrap_or_default();
    let rows: Vec<Vec<String>> =
        values.map(|(k, value)| vec![format!("mode {}", k + 1), number(value, unit)]).collect();
    content += &table(&["mode of the tangent", "eigenvalue"], &rows);
    let values = result["modes"]["frequencies"].as_array().into_iter().flatten().enumerate();
    let told = |value: &Value| if value.is_null() { "unstable".to_owned() } else { number(value, "Hz") };
    let rows: Vec<Vec<String>> = values.map(|(k, value)| vec![format!("mode {}", k + 1), told(value)]).collect();
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
pub(crate) fn run(result: &Value) -> String {
    let mut content = String::new();
    let starts = result["starts"].as_array().into_iter().flatten().enumerate();
    let rows: Vec<Vec<String>> = starts
        .map(|(k, start)| {
            let end = start["stop"].as_str().or(start["failed"].as_str()).unwrap_or_default();
            let mark = if result["best_start"].as_u64() == Some(k as u64) { " (the best)" } else { "" };
            vec![
                format!("{}{mark}", k + 1),
                number(&start["start_cost"], ""),
                number(&start["cost"], ""),
                number(&start["iterations"], ""),
                end.to_owned(),
            ]
        })
        .collect();
    content += &table(&["start", "cost at the start", "cost", "iterations", "end"], &rows);
    let work = [
        ("newton_iterations", "Newton iterations"),
        ("factorisations", "factorisations"),
        ("reused_factorisations", "reused factorisations"),
        ("back_substitutions", "back substitutions"),
        ("multigrid_cycles", "multigrid cycles"),
    ];
    let told = work.iter().filter(|(key, _)| result[*key].as_u64().is_some_and(|n| n > 0));
    let rows: Vec<Vec<String>> = told.map(|(key, name)| vec![(*name).to_owned(), number(&result[*key], "")]).collect();
    content += &table(&["work", "count"], &rows);
    let times = result["seconds"].as_object().into_iter().flatten();
    let rows: Vec<Vec<String>> =
        times.filter_map(|(phase, seconds)| Some(vec![phase.replace('_', " "), duration(seconds.as_f64()?)])).collect();
    content += &table(&["phase", "time"], &rows);
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let rows = [
        vec!["case".to_owned(), text(&result["case"])],
        vec!["hash of the case and its files".to_owned(), text(&result["case_hash"])],
        vec!["nastic".to_owned(), text(&result["versions"]["nastic"])],
        vec!["linear solver".to_owned(), text(&result["linear_solver"])],
        vec!["exit code".to_owned(), number(&result["exit"], "")],
    ];
    let rows: Vec<Vec<String>> = rows.into_iter().filter(|row| !row[1].is_empty()).collect();
    content += &table(&["run", ""], &rows);
    let files: Vec<&str> = result["files"].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
    if !files.is_empty() {
        content += &folded(&count(files.len() as u64, "file"), &paragraph(&files.join(", ")));
    }
    section("run", "Run", &content)
}

/// The case itself, folded.
pub(crate) fn case(text: Option<&str>) -> String {
    let Some(text) = text else { return String::new() };
    let content = format!("<pre tabindex=\"0\" aria-label=\"Case file\">{}</pre>\n", escape(text));
    section("case", "Case", &folded("The case with its overrides, comments left out", &content))
}
