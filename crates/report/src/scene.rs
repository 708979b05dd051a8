//! The three-dimensional view: surfaces, and for every member its frames and targets.

use crate::encode::size;
use crate::error::ReportError;
use crate::folder::ResultFolder;
use crate::frame::{self, Amount};
use crate::iterates::Iterates;
use crate::number::short;
use crate::obstacles_label;
use crate::record::{MemberRecord, Number, RunRecord, SeriesRecord, StateRecord};
use crate::surface::BodySurface;
use nastic_mesh::Snapshot;
use rayon::prelude::*;
use serde_json::{Value, json};

/// Members that are shown: those of least and of largest cost are among them.
const MOST_MEMBERS: usize = 10;
/// Rows of a ramp or a path that are shown.
const MOST_ROWS: usize = 40;
/// Characters that the iterations of all load cases may take.
const ITERATES_SIZE: usize = 2_400_000;

/// What is shown, and what was left out.
#[derive(Debug, Default)]
pub(crate) struct Scene {
    surfaces: Vec<BodySurface>,
    pub views: Vec<Value>,
    /// What is not shown although the folder has it, in words.
    pub left_out: Vec<String>,
    /// The body at the start and at the end of the first member, for its mesh quality.
    pub first: Option<Snapshot>,
    pub last: Option<Snapshot>,
    material: Vec<String>,
}

/// One member as `result.json` lists it.
struct ListedMember<'a> {
    record: &'a MemberRecord,
    /// What the result says of it.
    state: Option<&'a StateRecord>,
    is_lead: bool,
}

impl Scene {
    /// Reads what the folder has.
    pub fn of(folder: &ResultFolder) -> Result<Self, ReportError> {
        let mut scene = Self { material: material_vectors(&folder.result), ..Self::default() };
        let members = listed(&folder.result);
        let shown = chosen(&members);
        if shown.len() < members.len() {
            scene.left_out.push(format!(
                "{} of {} states are shown in three dimensions: those of least and of largest cost, and some between",
                shown.len(),
                members.len()
            ));
        }
        let leads = members.iter().filter(|member| member.is_lead).count().max(1);
        for member in shown {
            scene.add_member(folder, member, ITERATES_SIZE / leads)?;
        }
        for lead in members.iter().filter(|member| member.is_lead) {
            let file = format!("{}mean_optimum.vtu", lead.record.case_stem);
            if folder.wrote(&file) {
                let shot = folder.snapshot(&file)?;
                let name = format!("mean over scenarios{}", case_name(lead));
                let surface = scene.surface(&shot);
                let view = scene.frame("mean of the optimum", &shot, surface, Amount::All);
                scene.views.push(json!({ "name": name, "surface": surface, "frames": [view], "targets": [] }));
            }
        }
        Ok(scene)
    }

    fn add_member(&mut self, folder: &ResultFolder, member: &ListedMember<'_>, most: usize) -> Result<(), ReportError> {
        let file = |name: &str| format!("{}{name}", member.record.stem);
        let mut names: Vec<(String, String)> = Vec::new();
        let start = if folder.wrote(&file("optimum.vtu")) { "start" } else { "equilibrium" };
        names.extend([(file("start.vtu"), start.to_owned()), (file("optimum.vtu"), "optimum".to_owned())]);
        names.extend(rows(folder, member, "ramp", |state| state.ramp.as_ref()));
        names.extend(rows(folder, member, "path", |state| state.path.as_ref()));
        let instants = instants(folder, member)?;
        if !instants.is_empty() && start != "start" {
            // the end of the motion, which is among the instants
            names.clear();
        }
        names.extend(instants);
        let others = folder.series(&file("equilibrium_"), ".vtu").into_iter().skip(1).enumerate();
        names.extend(others.map(|(k, name)| (name, format!("equilibrium {}", k + 2))));
        if member.is_lead && names.iter().all(|(name, _)| !folder.wrote(name)) {
            names.push(("failure.vtu".to_owned(), "last state before the failure".to_owned()));
        }
        names.retain(|(name, _)| folder.wrote(name));
        let shots: Vec<Snapshot> =
            names.par_iter().with_max_len(1).map(|(name, _)| folder.snapshot(name)).collect::<Result<_, _>>()?;
        let (Some(first), Some(last)) = (shots.first(), shots.last()) else { return Ok(()) };
        let surface = self.surface(first);
        let amount = if member.is_lead { Amount::All } else { Amount::Shape };
        let mut frames = Vec::new();
        for (shot, (name, label)) in shots.iter().zip(&names) {
            if label == "optimum" && member.is_lead {
                frames.extend(self.iterates(folder, member, surface, most)?);
            }
            frames.push(self.frame(label, shot, surface, amount));
            self.add_obstacles(folder, name, &mut frames)?;
            for mode in shot.point_data.iter().filter(|array| array.name.starts_with("mode_")) {
                let number = mode.name.trim_start_matches("mode_").parse::<usize>().unwrap_or(1);
                let modes = member.state.map(|state| &state.modes);
                let of = |list: &[Number]| list.get(number - 1).and_then(|number| **number).map(short);
                let value = modes
                    .and_then(|modes| of(modes.eigenvalues.as_deref()?))
                    .map(|value| format!(", eigenvalue {value}"));
                let frequency =
                    || modes.and_then(|modes| of(modes.frequencies.as_deref()?)).map(|value| format!(", {value} Hz"));
                let value = value.or_else(frequency);
                let label = format!("mode {number}{}", value.unwrap_or_default());
                frames.push(frame::of_mode(&label, shot, mode, &self.surfaces[surface]));
            }
        }
        if self.first.is_none() {
            (self.first, self.last) = (Some(first.clone()), Some(last.clone()));
        }
        let mut targets = self.targets(folder, "target", &member.record.targets)?;
        targets.extend(self.targets(folder, "obstacle", &member.record.obstacles)?);
        self.views
            .push(json!({ "name": member.record.name, "surface": surface, "frames": frames, "targets": targets, "obstacles": obstacles_label(&member.record.obstacle_names) }));
        Ok(())
    }

    /// The obstacles that move, where they are in the last of the frames: `{ "surface", "x" }`.
    fn add_obstacles(&mut self, folder: &ResultFolder, state: &str, frames: &mut [Value]) -> Result<(), ReportError> {
        let file = state.replace(".vtu", "_obstacles.vtu");
        let Some(frame) = frames.last_mut().filter(|_| folder.wrote(&file)) else { return Ok(()) };
        let shot = folder.snapshot(&file)?;
        let surface = self.index(BodySurface::of(&shot.mesh));
        frame["obstacles"] =
            json!({ "surface": surface, "x": frame::nodes(&shot.positions(), &self.surfaces[surface]) });
        Ok(())
    }

    fn frame(&self, label: &str, shot: &Snapshot, surface: usize, amount: Amount) -> Value {
        frame::of_snapshot(label, shot, &self.surfaces[surface], amount, &self.material)
    }

    /// The kept iterations behind the start, as many as fit.
    fn iterates(
        &mut self,
        folder: &ResultFolder,
        member: &ListedMember<'_>,
        surface: usize,
        most: usize,
    ) -> Result<Vec<Value>, ReportError> {
        let best = folder.result.optimum.best_start.unwrap_or(0);
        let names = ["iterates.bin".to_owned(), format!("start_{best}_iterates.bin")];
        let mut names = names.into_iter().map(|name| format!("{}{name}", member.record.case_stem));
        let Some(name) = names.find(|name| folder.wrote(name)) else { return Ok(Vec::new()) };
        let Some(bytes) = folder.bytes(&name)? else { return Ok(Vec::new()) };
        let iterates = Iterates::from_bytes(&bytes).map_err(|error| folder.content(&name, error.to_string()))?;
        let surface = &self.surfaces[surface];
        // The first is the start, the last the optimum: these are there already.
        let last = folder.result.optimum.iterations.unwrap_or(usize::MAX);
        let all = iterates.iterations().into_iter().enumerate().filter(|(_, k)| *k > 0 && *k < last);
        let frames: Option<Vec<Value>> = all.map(|(index, _)| frame::of_iterate(&iterates, index, surface)).collect();
        let foreign = || folder.content(&name, "it belongs to another mesh".to_owned());
        let mut frames = frames.ok_or_else(foreign)?;
        let total: usize = frames.iter().map(frame_size).sum();
        let step = total.div_ceil(most.max(1)).max(1);
        if step > 1 {
            self.left_out.push(format!("one of {step} kept iterations is shown, to keep this page small"));
            frames = frames.into_iter().step_by(step).collect();
        }
        Ok(frames)
    }

    /// Targets or obstacles as `{ "label", "surface", "x" }`; of a tracking target the faces that are tracked.
    fn targets(&mut self, folder: &ResultFolder, label: &str, files: &[String]) -> Result<Vec<Value>, ReportError> {
        let mut out = Vec::new();
        for file in files.iter().filter(|file| folder.wrote(file)) {
            let shot = folder.snapshot(file)?;
            let surface = match shot.point_array("tracked") {
                Some(tracked) => BodySurface::of_marked(&shot.mesh, |node| tracked.values[node as usize] == 1.0),
                None => BodySurface::of(&shot.mesh),
            };
            if surface.nodes.is_empty() {
                self.left_out.push(format!("{file}: single target points are not drawn"));
                continue;
            }
            let index = self.index(surface);
            let x = frame::nodes(&shot.positions(), &self.surfaces[index]);
            out.push(json!({ "label": label, "surface": index, "x": x }));
        }
        Ok(out)
    }

    fn surface(&mut self, shot: &Snapshot) -> usize {
        self.index(BodySurface::of(&shot.mesh))
    }

    fn index(&mut self, surface: BodySurface) -> usize {
        if let Some(known) = self.surfaces.iter().position(|known| *known == surface) {
            return known;
        }
        self.surfaces.push(surface);
        self.surfaces.len() - 1
    }

    /// The data of the page's view; null without a state.
    pub fn json(&self, length: &str) -> Value {
        if self.views.is_empty() {
            return Value::Null;
        }
        let surfaces: Vec<Value> = self.surfaces.par_iter().map(BodySurface::json).collect();
        json!({ "length": length, "surfaces": surfaces, "views": self.views })
    }
}

/// The members of a result.
fn listed(result: &RunRecord) -> Vec<ListedMember<'_>> {
    let mut stems: Vec<&str> = Vec::new();
    let of = |record| {
        let record: &MemberRecord = record;
        let is_lead = !stems.contains(&record.case_stem.as_str());
        stems.push(&record.case_stem);
        ListedMember { record, state: result.member(record), is_lead }
    };
    result.members.iter().flatten().map(of).collect()
}

/// All leads, and of the others those at even distances in the order of their costs.
fn chosen<'a, 'b>(members: &'a [ListedMember<'b>]) -> Vec<&'a ListedMember<'b>> {
    if members.len() <= MOST_MEMBERS {
        return members.iter().collect();
    }
    let cost = |k: usize| members[k].state.and_then(|state| *state.cost.total).unwrap_or(f64::INFINITY);
    let mut order: Vec<usize> = (0..members.len()).collect();
    order.sort_by(|a, b| cost(*a).total_cmp(&cost(*b)));
    let last = members.len() - 1;
    let mut kept: Vec<usize> = (0..MOST_MEMBERS).map(|k| order[k * last / (MOST_MEMBERS - 1)]).collect();
    kept.extend((0..members.len()).filter(|k| members[*k].is_lead));
    kept.sort_unstable();
    kept.dedup();
    kept.into_iter().map(|k| &members[k]).collect()
}

/// Files and labels of the rows of a ramp or path, evenly thinned.
fn rows(
    folder: &ResultFolder,
    member: &ListedMember<'_>,
    name: &str,
    series: fn(&StateRecord) -> Option<&SeriesRecord>,
) -> Vec<(String, String)> {
    let files = folder.series(&format!("{}{name}_", member.record.stem), ".vtu");
    let step = files.len().div_ceil(MOST_ROWS).max(1);
    let series = member.state.and_then(series);
    let of = |(k, file): (usize, String)| {
        let value = series.and_then(|series| Some((series, (*series.points.get(k)?.value)?)));
        let value = value.map_or_else(String::new, |(series, x)| {
            format!(
                ": {} {} {}",
                series.control.as_deref().unwrap_or("load"),
                short(x),
                series.unit.as_deref().unwrap_or_default()
            )
        });
        (file, format!("{name} {k}{}", value.trim_end()))
    };
    files.into_iter().enumerate().map(of).step_by(step).collect()
}

/// Files and labels of the written instants of a motion, evenly thinned, the last among them.
fn instants(folder: &ResultFolder, member: &ListedMember<'_>) -> Result<Vec<(String, String)>, ReportError> {
    let name = format!("{}motion.pvd", member.record.stem);
    let listed = folder.instants(&name)?.into_iter();
    let all: Vec<(String, String)> = listed.map(|(file, t)| (file, format!("t = {} s", short(t)))).collect();
    let step = all.len().div_ceil(MOST_ROWS).max(1);
    let behind = all.len().saturating_sub(1) % step;
    Ok(all.into_iter().skip(behind).step_by(step).collect())
}

/// Arrays of vectors that belong to the material, and turn with it; so do the `direction_` of actuations.
fn material_vectors(result: &RunRecord) -> Vec<String> {
    let mut out: Vec<String> = ["fiber", "B_r"].map(str::to_owned).to_vec();
    let remanences =
        result.controls.iter().flatten().filter(|(_, control)| control.slot.as_deref() == Some("remanence"));
    out.extend(remanences.filter_map(|(_, control)| control.array.clone()));
    out
}

fn case_name(lead: &ListedMember<'_>) -> String {
    let case = lead.record.name.rsplit_once('/').map_or("", |(_, case)| case);
    if case.is_empty() { String::new() } else { format!(": {case}") }
}

fn frame_size(frame: &Value) -> usize {
    let arrays = |group: &str| frame[group].as_object().into_iter().flatten().map(|(_, a)| size(a)).sum::<usize>();
    size(&frame["x"]) + arrays("fields") + arrays("vectors")
}
