//! What stands behind the body: states as glass, targets, obstacles.

use super::state::{self, State};
use crate::error::ReportError;
use crate::folder::ResultFolder;
use crate::obstacles_label;
use nastic_mesh::Snapshot;
use nastic_picture::{Appearance, Body, Colour, Face};
use std::mem::take;

/// The states of these names, or the start and the targets; obstacles in any case.
pub(super) fn bodies(
    folder: &ResultFolder,
    shown: &State<'_>,
    wanted: Option<&[String]>,
) -> Result<Vec<Body>, ReportError> {
    let mut out = Vec::new();
    let stem = shown.stem();
    let usual = || begin(folder, shown).filter(|name| *name != shown.name);
    let names: Vec<String> = wanted.map_or_else(|| usual().into_iter().collect(), <[String]>::to_vec);
    let states: Vec<&String> = names.iter().filter(|name| *name != "target").collect();
    for (k, name) in states.iter().enumerate() {
        let ghost = State::find(folder, Some(name.as_str()))?;
        let label = state::label(folder, stem, &ghost.name)?;
        out.push(Body::of(&label, &ghost.shot).appearance(Appearance::Glass(grey(k, states.len()))));
    }
    let with_target = with_targets(wanted);
    let member = shown.member;
    for file in member.iter().flat_map(|member| &member.targets).filter(|file| with_target && folder.wrote(file)) {
        out.extend(target(&folder.snapshot(file)?));
    }
    let moving = format!("{}_obstacles.vtu", shown.name);
    let obstacles = member.iter().flat_map(|member| &member.obstacles).cloned().chain([moving]);
    let mut label = member.map_or_else(String::new, |member| obstacles_label(&member.obstacle_names));
    for file in obstacles.filter(|file| folder.wrote(file)) {
        out.push(
            Body::of(&take(&mut label), &folder.snapshot(&file)?)
                .appearance(Appearance::Solid(Colour::GREY))
                .lines(false),
        );
    }
    Ok(out)
}

/// Where what is shown began: a motion, ramp or path at its first state, an optimum at the start controls.
fn begin(folder: &ResultFolder, shown: &State<'_>) -> Option<String> {
    let stem = shown.stem();
    let own = shown.name.strip_prefix(stem).unwrap_or(&shown.name);
    // those of an optimisation have motions too, of the optimum
    let of_series = ["motion", "ramp", "path"].into_iter().find(|series| own.starts_with(series));
    let first = |series: &str| state::first_of(folder, stem, series);
    let start = format!("{stem}start");
    match of_series {
        Some(series) => first(series),
        None => first("motion").or_else(|| folder.wrote(&format!("{start}.vtu")).then_some(start)),
    }
}

/// The k-th of some states behind: the later, the darker.
fn grey(k: usize, count: usize) -> Colour {
    let darker = if count > 1 { 0.55 * k as f64 / (count - 1) as f64 } else { 0.0 };
    Colour(Colour::GREY.0.map(|byte| (f64::from(byte) * (1.0 - darker)) as u8))
}

/// Whether targets are drawn: unless other names are given alone.
pub(super) fn with_targets(wanted: Option<&[String]>) -> bool {
    wanted.is_none_or(|wanted| wanted.iter().any(|name| name == "target"))
}

/// A target shape, or the part that is tracked; nothing of single points.
fn target(shot: &Snapshot) -> Option<Body> {
    let body = Body::of("target", shot).appearance(Appearance::Glass(Colour::RED));
    let Some(tracked) = shot.point_array("tracked") else { return Some(body) };
    let marked: Vec<bool> = tracked.values.iter().map(|mark| *mark == 1.0).collect();
    let is_drawn = |face: &Face| face.nodes.iter().all(|node| marked[*node as usize]);
    let any = Face::all(&shot.mesh).iter().any(is_drawn);
    any.then(|| if marked.iter().all(|mark| *mark) { body } else { body.part(marked) })
}
