//! [`State`]: the state that is shown.

use crate::error::ReportError;
use crate::folder::ResultFolder;
use crate::number::short;
use crate::record::{MemberRecord, StateRecord};
use nastic_mesh::Snapshot;

/// A state, and the member that it is of.
pub(crate) struct State<'a> {
    /// The name of its file without `.vtu`.
    pub name: String,
    pub label: String,
    pub shot: Snapshot,
    pub member: Option<&'a MemberRecord>,
    /// What the result says of the member.
    pub record: Option<&'a StateRecord>,
}

/// What states of equilibria are called whose files end so, the first of a result before the others.
const LABELS: [(&str, &str); 3] = [("optimum", "optimum"), ("failure", "last state"), ("start", "equilibrium")];

impl<'a> State<'a> {
    /// The state of that name; without a name the one that a result is about.
    pub fn find(folder: &'a ResultFolder, name: Option<&str>) -> Result<Self, ReportError> {
        let all = names(folder);
        let name = match name {
            Some(name) => {
                let name = name.strip_suffix(".vtu").unwrap_or(name);
                all.iter().find(|known| *known == name).cloned().ok_or_else(|| ReportError::Unknown {
                    what: "state",
                    name: name.to_owned(),
                    has: all.clone(),
                })?
            }
            None => main(folder, &all)?,
        };
        let members = folder.result.members.iter().flatten();
        let of_it = members.filter(|member| name.starts_with(&member.stem)).max_by_key(|member| member.stem.len());
        let mut shot = folder.snapshot(&format!("{name}.vtu"))?;
        let lines = format!("{name}_lines.vtu");
        if folder.wrote(&lines) {
            shot.lines = folder.lines(&lines)?;
        }
        let label = label(folder, of_it.map_or("", |member| &member.stem), &name)?;
        let record = of_it.and_then(|member| folder.result.member(member));
        Ok(Self { name, label, shot, member: of_it, record })
    }

    /// What the names of the member's files begin with.
    pub fn stem(&self) -> &str {
        self.member.map_or("", |member| &member.stem)
    }
}

/// All states that the run wrote: not targets, obstacles, lines.
pub(super) fn names(folder: &ResultFolder) -> Vec<String> {
    let members = || folder.result.members.iter().flatten();
    let is_shape =
        |file: &str| members().any(|member| member.targets.iter().chain(&member.obstacles).any(|own| own == file));
    let is_state = |name: &&str| !["_obstacles", "_lines"].iter().any(|ending| name.ends_with(ending));
    let files = folder.result.files.iter().flatten().filter(|file| !is_shape(file));
    let listed = files.filter_map(|file| file.strip_suffix(".vtu")).filter(is_state).map(str::to_owned);
    let mut names: Vec<String> = listed.collect();
    // those of `output.every` are named by their collection
    let iterations = members().map(|member| folder.instants(&format!("{}iterations.pvd", member.stem)));
    let kept = iterations.flat_map(|files| files.unwrap_or_default());
    names.extend(kept.filter_map(|(file, _)| file.strip_suffix(".vtu").map(str::to_owned)));
    names
}

/// The first state of a motion, a ramp or a path.
pub(super) fn first_of(folder: &ResultFolder, stem: &str, series: &str) -> Option<String> {
    let name = format!("{stem}{series}_0000");
    folder.wrote(&format!("{name}.vtu")).then_some(name)
}

fn first_instant(folder: &ResultFolder, stem: &str) -> Option<String> {
    first_of(folder, stem, "motion")
}

/// The optimum, else the last instant of a motion, else the last equilibrium of a ramp or a path, else the equilibrium.
fn main(folder: &ResultFolder, all: &[String]) -> Result<String, ReportError> {
    let stem = folder.result.members.iter().flatten().next().map_or("", |member| &member.stem);
    let optimum = format!("{stem}optimum");
    let last = |series: &str| {
        let files = folder.series(&format!("{stem}{series}_"), ".vtu");
        files.last().and_then(|file| file.strip_suffix(".vtu")).map(str::to_owned)
    };
    let of_series = ["motion", "ramp", "path"].into_iter().filter_map(last);
    let others = [format!("{stem}start"), "failure".to_owned()];
    let found = std::iter::once(optimum).chain(of_series).chain(others).find(|name| all.contains(name));
    found.or_else(|| all.first().cloned()).ok_or_else(|| ReportError::Unknown {
        what: "state",
        name: "start".to_owned(),
        has: Vec::new(),
    })
}

/// What a state is called in the legend: of a motion its instant, of a ramp the value of its control.
pub(super) fn label(folder: &ResultFolder, stem: &str, name: &str) -> Result<String, ReportError> {
    let own = name.strip_prefix(stem).unwrap_or(name);
    if own.starts_with("motion_") {
        let instants = folder.instants(&format!("{stem}motion.pvd"))?;
        if let Some((_, t)) = instants.iter().find(|(file, _)| file.strip_suffix(".vtu") == Some(name)) {
            return Ok(format!("t = {} {}", short(*t), folder.result.units.time));
        }
    }
    let members = folder.result.members.iter().flatten();
    let record = members.filter(|member| member.stem == stem).find_map(|member| folder.result.member(member));
    let ramp = record.and_then(|record| record.ramp.as_ref());
    if let (Some(row), Some(ramp)) = (own.strip_prefix("ramp_").and_then(|number| number.parse::<usize>().ok()), ramp)
        && let (Some(control), Some(value)) = (&ramp.control, ramp.points.get(row).and_then(|point| *point.value))
    {
        return Ok(format!("{control} = {} {}", short(value), ramp.unit.as_deref().unwrap_or_default()));
    }
    let has_optimum = folder.wrote(&format!("{stem}optimum.vtu"));
    if first_instant(folder, stem).is_some() {
        // states without a number are ends of motions
        return Ok(match own {
            "optimum" => "end of the motion at the optimum".to_owned(),
            "start" if has_optimum => "end of the motion at the start controls".to_owned(),
            "start" => "end of the motion".to_owned(),
            "failure" => "last state".to_owned(),
            other => other.replace('_', " "),
        });
    }
    Ok(match LABELS.iter().find(|(known, _)| *known == own) {
        Some(("start", _)) if has_optimum => "start".to_owned(),
        Some((_, label)) => (*label).to_owned(),
        None => own.replace('_', " "),
    })
}
