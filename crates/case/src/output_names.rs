//! Names of the files that a command writes, so that none of them replaces what the case reads.

use nastic_language::schema::Command;
use std::path::{Path, PathBuf};

/// Of every command that writes. `#` stands for a number or a name; before each may stand `MEMBER_`, of a load case, scenario or start.
const ALL: &[&str] = &[
    "case.json",
    "result.json",
    "report.html",
    "failure.vtu",
    "start.vtu",
    "start_lines.vtu",
    "start_obstacles.vtu",
    "target.vtu",
    "target_#.vtu",
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
    "ramp.pvd",
    "ramp_#.vtu",
    "path.csv",
    "path.svg",
    "path.pvd",
    "path_#.vtu",
    "equilibrium_#.vtu",
    "equilibrium_#_lines.vtu",
    "equilibrium_#_obstacles.vtu",
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
    "checkpoint_#.bin",
    "optimum.vtu",
    "optimum_lines.vtu",
    "optimum_obstacles.vtu",
    "mean_optimum.vtu",
    "iteration_#.vtu",
    "iterations.pvd",
    "iterates.bin",
];
/// Of `fit`.
pub const FIT: &[&str] = &["fit.json", "fit.html", "fit.svg", "fit_#.svg"];
/// Of `sweep`.
pub const SWEEP: &[&str] = &["sweep.html", "sweep.csv", "sweep.json", "sweep.svg", "sweep.pvd"];

/// The patterns of the names of what a command writes.
pub fn written_by(command: &Command) -> Vec<&'static str> {
    let own: &[&[&str]] = match command {
        Command::Check | Command::Gradcheck | Command::Modes => &[ALL],
        Command::Solve => &[ALL, MOTION, SOLVE],
        Command::Gradient => &[ALL, &["derivative.json"]],
        Command::Optimize => &[ALL, MOTION, OPTIMIZE],
    };
    own.concat()
}

/// Whether a command writes files of such a name.
pub fn is_written_by(command: &Command, name: &str) -> bool {
    written_by(command).iter().any(|pattern| matches(name, pattern))
}

/// The first name of a list that no pattern has: such a file could replace what the case reads.
pub fn unlisted<'n>(patterns: &[&str], names: &'n [String]) -> Option<&'n String> {
    names.iter().find(|name| !patterns.iter().any(|pattern| matches(name, pattern)))
}

/// The first of these inputs that a file of such a name in the directory would replace.
pub fn replaced<'f>(
    directory: &Path,
    patterns: &[&str],
    inputs: impl IntoIterator<Item = &'f Path>,
) -> Option<PathBuf> {
    let directory = directory.canonicalize().ok()?;
    let of = |file: &Path| {
        let name = file.file_name()?.to_str()?;
        // of a link the place it stands at: that is what a renamed file replaces
        let parent = file.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let beside = parent.canonicalize().ok()? == directory;
        (beside && patterns.iter().any(|pattern| matches(name, pattern))).then(|| file.to_owned())
    };
    inputs.into_iter().find_map(of)
}

/// Whether a name, or what stands behind one of its underscores, is that of a pattern.
fn matches(name: &str, pattern: &str) -> bool {
    let tails = name.match_indices('_').map(|(at, _)| &name[at + 1..]);
    std::iter::once(name).chain(tails).any(|tail| match pattern.split_once('#') {
        None => tail == pattern,
        Some((before, after)) => {
            tail.strip_prefix(before).and_then(|rest| rest.strip_suffix(after)).is_some_and(|number| !number.is_empty())
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_stand_for_numbers_names_and_members() {
        let optimum = written_by(&Command::Optimize);
        let is = |name: &str| optimum.iter().any(|pattern| matches(name, pattern));
        for name in
            ["result.json", "heavy_optimum.vtu", "scenario_000_optimum.vtu", "iteration_0012.vtu", "target_tip.vtu"]
        {
            assert!(is(name), "{name}");
        }
        for name in ["bar.json", "body.vtu", "myresult.json", "iteration_.vtu", "ramp.csv", "optimum.vtu.old"] {
            assert!(!is(name), "{name}");
        }
    }
}
