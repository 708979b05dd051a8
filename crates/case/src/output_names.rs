//! Names of the files that a command writes, so that none of them replaces what the case reads or what somebody else put there.

use crate::lower::CaseProblem;
use nastic_language::schema::Command;
use std::path::{Path, PathBuf};

/// Of every command that writes. `#` stands for a number and what may follow it in names of states, `*` for a name; before each may stand
/// those of a load case, scenario or start.
const ALL: &[&str] = &[
    "case.json",
    "result.json",
    "report.html",
    "failure.vtu",
    "start.vtu",
    "start_lines.vtu",
    "start_obstacles.vtu",
    "obstacle_#.vtu",
    "picture.png",
    "picture.svg",
    "figure.png",
    "figure.svg",
    "scenarios.pvd",
];
/// Of motions, of `solve` and `optimize`.
const MOTION: &[&str] = &[
    "motion.csv",
    "motion.pvd",
    "motion.svg",
    "energies.svg",
    "controls.svg",
    "motion_#.vtu",
    "motion_checkpoint.bin",
];
const SOLVE: &[&str] = &[
    "ramp.csv",
    "ramp.svg",
    "ramp_reactions.svg",
    "ramp_energies.svg",
    "ramp_volumes.svg",
    "ramp.pvd",
    "ramp_#.vtu",
    "path.csv",
    "path.svg",
    "path_reactions.svg",
    "path_energies.svg",
    "path_volumes.svg",
    "path.pvd",
    "path_#.vtu",
    "equilibrium_#.vtu",
    "exact_contact.vtu",
];
const OPTIMIZE: &[&str] = &[
    "history.jsonl",
    "history.csv",
    "convergence.svg",
    "controls.json",
    "spectrum.json",
    "spectrum.vtu",
    "checkpoint.bin",
    "checkpoint_a#.bin",
    "checkpoint_b#.bin",
    "optimum.vtu",
    "optimum_lines.vtu",
    "optimum_obstacles.vtu",
    "mean_optimum.vtu",
    "iteration_#.vtu",
    "iterations.pvd",
    "iterates.bin",
    "design_*.stl",
    "design.3mf",
    "design_deformed.3mf",
    "directions_*.csv",
];
/// Of `fit`.
pub const FIT: &[&str] = &["fit.json", "fit.html", "fit.svg", "fit_*.svg", "fit_*.json"];
/// Of `sweep`.
pub const SWEEP: &[&str] = &[
    "sweep.html",
    "sweep.csv",
    "sweep_table.csv",
    "sweep_table.tex",
    "sweep.json",
    "sweep.svg",
    "sweep.pvd",
    "*_sweep.pvd",
];

/// The names that files of a command may have in its directory.
#[derive(Clone, Debug, Default)]
pub struct OutputNames {
    patterns: Vec<&'static str>,
    /// What may stand before them.
    stems: Vec<String>,
    /// Further names.
    others: Vec<String>,
}

impl OutputNames {
    /// Names of these patterns.
    #[must_use]
    pub fn of(patterns: &[&'static str]) -> Self {
        Self { patterns: patterns.to_vec(), stems: vec![String::new()], others: Vec::new() }
    }

    /// Those of a command on a problem, whose targets are written to files of these names.
    #[must_use]
    pub fn of_command(command: &Command, problem: &CaseProblem, targets: Vec<String>) -> Self {
        let own: &[&[&'static str]] = match command {
            Command::Check | Command::Gradcheck | Command::Modes => &[ALL],
            Command::Solve => &[ALL, MOTION, SOLVE],
            Command::Gradient => &[ALL, &["derivative.json"]],
            Command::Optimize => &[ALL, MOTION, OPTIMIZE],
            Command::Identify => &[ALL, OPTIMIZE, &["identified.json"]],
            Command::Gains => &[ALL, &["gains.json", "gains.csv", "gains.h"]],
        };
        let members = problem.members().flat_map(|member| [member.file(""), member.case_file("")]);
        let mut stems: Vec<String> = std::iter::once(String::new()).chain(members).collect();
        stems.sort();
        stems.dedup();
        Self { patterns: own.concat(), stems, others: targets }
    }

    /// Whether a name is one of them.
    #[must_use]
    pub fn has(&self, name: &str) -> bool {
        let tails = self.stems.iter().filter_map(|stem| name.strip_prefix(stem.as_str()));
        let mut tails = tails.flat_map(|tail| [tail, behind_start(tail)]);
        tails.any(|tail| self.patterns.iter().any(|one| matches(tail, one)))
            || self.others.iter().any(|one| name == one)
    }

    /// The first of these inputs that a file of such a name in the directory would replace.
    #[must_use]
    pub fn replaced<'f>(&self, directory: &Path, inputs: impl IntoIterator<Item = &'f Path>) -> Option<PathBuf> {
        let directory = directory.canonicalize().ok()?;
        let of = |file: &Path| {
            let name = file.file_name()?.to_str()?;
            // of a link the place it stands at: that is what a renamed file replaces
            let parent = file.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
            let beside = parent.canonicalize().ok()? == directory;
            (beside && self.has(name)).then(|| file.to_owned())
        };
        inputs.into_iter().find_map(of)
    }
}

/// A name without `start_NUMBER_`, with which files of one of several starts begin.
fn behind_start(name: &str) -> &str {
    let parts = name.strip_prefix("start_").and_then(|rest| rest.split_once('_'));
    parts.filter(|(number, _)| is_number(number)).map_or(name, |(_, tail)| tail)
}

fn is_number(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit())
}

/// Whether a name is that of a pattern.
fn matches(name: &str, pattern: &str) -> bool {
    let between = |sign: char| {
        let (before, after) = pattern.split_once(sign)?;
        name.strip_prefix(before)?.strip_suffix(after)
    };
    if pattern.contains('#') {
        between('#').is_some_and(|text| is_number(text.trim_end_matches("_lines").trim_end_matches("_obstacles")))
    } else if pattern.contains('*') {
        between('*').is_some_and(|text| !text.is_empty())
    } else {
        name == pattern
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_stand_for_numbers_names_and_members() {
        let stems = ["", "heavy_", "scenario_000_"].map(str::to_owned).to_vec();
        let others = vec!["heavy_target_tip.vtu".to_owned()];
        let optimum = OutputNames { patterns: [ALL, MOTION, OPTIMIZE].concat(), stems, others };
        for name in [
            "result.json",
            "heavy_optimum.vtu",
            "scenario_000_optimum.vtu",
            "iteration_0012.vtu",
            "heavy_target_tip.vtu",
            "heavy_start_3_iteration_0001.vtu",
            "start_0_iterates.bin",
            "heavy_start_lines.vtu",
            "motion_0010_obstacles.vtu",
            "checkpoint_a12.bin",
            "heavy_mean_optimum.vtu",
        ] {
            assert!(optimum.has(name), "{name}");
        }
        // what somebody may call their own
        for name in [
            "bar.json",
            "body.vtu",
            "myresult.json",
            "my_result.json",
            "light_optimum.vtu",
            "iteration_.vtu",
            "motion_capture.vtu",
            "target_scan.vtu",
            "start__optimum.vtu",
            "ramp.csv",
            "optimum.vtu.old",
        ] {
            assert!(!optimum.has(name), "{name}");
        }
    }
}
