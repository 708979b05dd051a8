//! Files with the shapes that costs aim at, and with obstacles.

use crate::error::ResultError;
use crate::files::Directory;
use crate::snapshot;
use nastic_case::lower::{CaseMember, CaseProblem, TargetShape, file_name, obstacle_shape};

/// `target.vtu` of the first target; further ones bear their cost's name, and those that members have alone begin as
/// the members' files do. Obstacles besides.
///
/// # Errors
/// A file that cannot be written, an array that does not fit its mesh.
pub fn write_targets(problem: &CaseProblem, out: &Directory) -> Result<Vec<String>, ResultError> {
    let targets = named_targets(problem);
    for (name, shape) in &targets {
        out.write_vtu(name, &snapshot::target(shape)?)?;
    }
    for (name, shape) in obstacle_shape::files(problem).0 {
        out.write_vtu(&name, &shape)?;
    }
    Ok(target_files(problem))
}

/// The names of the files with targets and obstacles.
pub fn target_files(problem: &CaseProblem) -> Vec<String> {
    let obstacles = obstacle_shape::files(problem).0.into_iter().map(|(name, _)| name);
    named_targets(problem).into_iter().map(|(name, _)| name).chain(obstacles).collect()
}

/// The names of every member's own targets.
pub fn target_names(problem: &CaseProblem) -> Vec<Vec<String>> {
    let named = named_targets_by_member(problem);
    named.into_iter().map(|own| own.into_iter().map(|(name, _)| name).collect()).collect()
}

/// The targets of all members, each once, with the names of their files.
pub fn named_targets(problem: &CaseProblem) -> Vec<(String, &TargetShape)> {
    let mut out: Vec<(String, &TargetShape)> = Vec::new();
    for (name, shape) in named_targets_by_member(problem).into_iter().flatten() {
        if !out.iter().any(|(known, _)| *known == name) {
            out.push((name, shape));
        }
    }
    out
}

pub(crate) fn named_targets_by_member(problem: &CaseProblem) -> Vec<Vec<(String, &TargetShape)>> {
    let mut out = Vec::new();
    for member in problem.members() {
        let mut own = Vec::new();
        let same = |other: &CaseMember<'_>| {
            other.targets().len() == member.targets().len()
                && other.targets().iter().zip(member.targets()).all(|(a, b)| a.is_same(b))
        };
        let mut of_case = problem.members().filter(|other| other.load_case() == member.load_case());
        for (k, shape) in member.targets().iter().enumerate() {
            let name = if k == 0 { "target.vtu".to_owned() } else { format!("target_{}.vtu", file_name(&shape.cost)) };
            let name = match () {
                () if problem.members().all(|other| same(&other)) => name,
                () if of_case.all(|other| same(&other)) => member.case_file(&name),
                () => member.file(&name),
            };
            own.push((name, shape));
        }
        out.push(own);
    }
    out
}
