//! The page: sections, data and programs in one file.

use crate::ReportError;
use crate::case_name::case_name;
use crate::folder::ResultFolder;
use crate::html::{escape, paragraph, section};
use crate::plots::plots;
use crate::record::RunRecord;
use crate::scene::Scene;
use crate::{gains, identification, spectrum, summary, tables};
use serde_json::{Value, json};
use std::path::Path;

/// The page's name in a result folder.
pub const FILE: &str = "report.html";

/// The page of a result folder.
///
/// # Errors
/// [`ReportError`]: there is no `result.json`, or a file that the run wrote cannot be read.
pub fn html(directory: &Path) -> Result<String, ReportError> {
    let folder = ResultFolder::open(directory)?;
    let scene = Scene::of(&folder)?;
    Ok(page(&folder, &scene))
}

const THREE: &str = include_str!("../vendor/three.min.js");
const UPLOT: &str = include_str!("../vendor/uPlot.min.js");
const UPLOT_STYLE: &str = include_str!("../vendor/uPlot.min.css");
/// The licences stay with the copies.
const LICENCES: [&str; 2] = [include_str!("../vendor/three.LICENSE"), include_str!("../vendor/uPlot.LICENSE")];
const STYLE: [&str; 2] = [include_str!("../assets/page.css"), include_str!("../assets/view.css")];
const VIEW: &str = include_str!("../assets/view.html");
/// In one scope, in this order.
const PROGRAM: [&str; 12] = [
    include_str!("../assets/arrays.js"),
    include_str!("../assets/colours.js"),
    include_str!("../assets/surface.js"),
    include_str!("../assets/body.js"),
    include_str!("../assets/arrows.js"),
    include_str!("../assets/stage.js"),
    include_str!("../assets/bar.js"),
    include_str!("../assets/cut.js"),
    include_str!("../assets/figure.js"),
    include_str!("../assets/view.js"),
    include_str!("../assets/plots.js"),
    include_str!("../assets/main.js"),
];

/// Charts of ramps and paths.
const SERIES: [&str; 8] = [
    "ramp.svg",
    "ramp_reactions.svg",
    "ramp_energies.svg",
    "ramp_volumes.svg",
    "path.svg",
    "path_reactions.svg",
    "path_energies.svg",
    "path_volumes.svg",
];

/// The whole page.
pub(crate) fn page(folder: &ResultFolder, scene: &Scene) -> String {
    let result = &folder.result;
    let view = scene.json(&result.units.length);
    let plots = plots(result, &folder.history);
    let file = || result.case.as_deref().map(case_name);
    let title = result.title.as_ref().cloned().or_else(file).unwrap_or_else(|| "nastic".to_owned());
    let body = [
        summary::warnings(result),
        summary::summary(result),
        section("shape", "Shape", &shape(&view, scene)),
        section("convergence", "Plots", &plot_places(&plots)),
        section("motion", "Over the time", &drawings(folder, &["motion.svg", "energies.svg", "controls.svg"])),
        section("curves", "Equilibria along the path", &drawings(folder, &SERIES)),
        tables::events(result),
        tables::states(result),
        tables::members(result),
        tables::controls(result),
        identification::identification(result),
        gains::section_of(result),
        spectrum::spectrum(result),
        tables::certificate(result),
        tables::stabilities(result),
        tables::mesh(scene.first.as_ref(), scene.last.as_ref()),
        tables::run(result),
        tables::case(folder.case.as_deref()),
    ]
    .concat();
    // "</" would end the element, "<!--" before "<script" would let nothing end it
    let data = json!({ "view": view, "plots": plots, "fields": fields(result) }).to_string().replace('<', "\\u003c");
    let licences = LICENCES.join("\n").replace("-->", "-- >");
    format!(
        r#"<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<link rel="icon" href="data:,">
<title>{title} – nastic report</title>
<style>{UPLOT_STYLE}</style>
<style>
{style}</style>
</head>
<body>
<header>
<div><h1>{title}</h1><p>{subtitle}</p></div>
<button id="theme" type="button" aria-label="Switch between light and dark">Dark</button>
</header>
<main>
{body}</main>
<script type="application/json" id="data">{data}</script>
<!-- three.js and uPlot are part of this page under these licences:
{licences}-->
<script>{THREE}</script>
<script>{UPLOT}</script>
<script>
"use strict";
(() => {{
{program}}})();
</script>
</body>
</html>
"#,
        title = escape(&title),
        subtitle = escape(&subtitle(result)),
        style = STYLE.concat(),
        program = PROGRAM.concat(),
    )
}

fn subtitle(result: &RunRecord) -> String {
    let case = result.case.as_deref().unwrap_or_default();
    format!("nastic {} {}, {case}", result.versions.nastic, result.command)
}

/// The three-dimensional view, or in words why there is none; what is not shown.
fn shape(view: &Value, scene: &Scene) -> String {
    if view.is_null() {
        return paragraph("The run wrote no state that could be shown.");
    }
    let left_out: String = scene.left_out.iter().map(|what| paragraph(what)).collect();
    format!("{VIEW}{left_out}")
}

fn plot_places(plots: &[Value]) -> String {
    if plots.is_empty() {
        return String::new();
    }
    let place = |k: usize| format!("<figure class=\"plot\" id=\"plot-{k}\"></figure>\n");
    format!("<div class=\"plots\">\n{}</div>\n", (0..plots.len()).map(place).collect::<String>())
}

/// The charts of these names of every member, as the run drew them.
fn drawings(folder: &ResultFolder, names: &[&str]) -> String {
    let members = folder.result.members.iter().flatten();
    let stems: Vec<&str> = members.map(|member| member.stem.as_str()).chain([""]).collect();
    let is_one =
        |file: &&String| stems.iter().any(|stem| file.strip_prefix(stem).is_some_and(|own| names.contains(&own)));
    let drawn = folder.result.files.iter().flatten().filter(is_one);
    let figure = |file: &String| {
        let text = folder.text(file).ok().flatten()?;
        let start = text.find("<svg")?;
        Some(format!("<figure class=\"drawing\">{}</figure>\n", &text[start..]))
    };
    drawn.filter_map(figure).collect()
}

/// Name, unit and explanation of the fields that bodies are coloured by.
pub(crate) fn fields(result: &RunRecord) -> Value {
    let units = &result.units;
    let mut out = json!({
        "|u|": { "label": "displacement |u|", "unit": units.length },
        "J": { "label": "volume ratio J", "unit": "" },
        "energy": { "label": "energy density", "unit": units.pressure },
        "mises": { "label": "von Mises stress", "unit": units.pressure },
        "distance": { "label": "distance from the target", "unit": units.length },
        "deviation_norm": { "label": "standard deviation of positions", "unit": units.length },
        "mode": { "label": "mode", "unit": "" },
        "intersecting": { "label": "intersects itself", "unit": "" },
        "B_r": { "label": "remanence B_r (carried with the body)", "unit": units.field },
        "B_a": { "label": "applied field B_a", "unit": units.field },
        "fiber": { "label": "fibre of the material", "unit": "" },
    });
    for (_, control) in result.controls.iter().flatten() {
        if let Some(array) = &control.array {
            out[array] = json!({ "label": array, "unit": control.unit, "control": true });
        }
    }
    out
}
