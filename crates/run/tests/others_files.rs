//! Files in an output directory that nastic did not write: they stay, whatever the command and whatever their names.

#![allow(clippy::unwrap_used, clippy::panic)] // a test may

use crate::common;

use common::{BAR, CaseDirectory, with};
use nastic_language::catalogue::Catalogue;
use nastic_language::schema::Command;
use nastic_run::console::Console;
use nastic_run::run::{Exit, FigureRequest, Options, RunError, Sweep, figure, fit, keep_results, report, run, sweep};
use std::fs::{read, read_dir, remove_file, write};
use std::path::{Path, PathBuf};

const OWN: &[u8] = b"somebody's own";
const SHORT: [&str; 1] = ["optimizer/max_iterations=2"];
const COMMANDS: [Command; 6] =
    [Command::Check, Command::Gradcheck, Command::Solve, Command::Modes, Command::Gradient, Command::Optimize];

/// All files of a directory, hidden ones included.
fn files(directory: &Path) -> Vec<PathBuf> {
    let mut found: Vec<PathBuf> = read_dir(directory).unwrap().map(|entry| entry.unwrap().path()).collect();
    found.sort();
    found
}

/// [`BAR`] as a body with a density, so that it has modes.
fn bar() -> String {
    with(BAR, r#""law": "mooney_rivlin""#, r#""density": "1000 kg/m^3", "law": "mooney_rivlin""#)
}

/// Whether a command refuses the files of a directory and leaves all as it is.
fn refused<T>(found: Result<T, RunError>, own: &Path) {
    let Err(error) = found else { panic!("{} was replaced", own.display()) };
    let text = error.to_string();
    assert!(matches!(error, RunError::ReplacesOthers { .. }) && error.exit() == Exit::BadInput, "{text}");
    assert!(text.contains(&format!("{}, which nastic did not write: move it", own.display())), "{text}");
    assert_eq!(read(own).unwrap(), OWN);
}

#[test]
fn no_command_on_a_case_replaces_what_nastic_did_not_write() {
    for command in COMMANDS {
        let whole = CaseDirectory::new();
        let options = Options { figure: true, ..whole.options(&SHORT) };
        whole.run_with(command.clone(), &bar(), &Console::silent(), &options).unwrap();
        let mut names = whole.files();
        // not of every run
        names.extend(["case.json", "report.html", "picture.png", "failure.vtu", "start_lines.vtu"].map(str::to_owned));
        if command == Command::Solve {
            names.extend(["motion.csv", "ramp_0003.vtu", "motion_checkpoint.bin"].map(str::to_owned));
        }
        let place = CaseDirectory::new();
        std::fs::create_dir(place.path("out")).unwrap();
        for name in names {
            let own = place.path("out").join(&name);
            write(&own, OWN).unwrap();
            refused(place.run_with(command.clone(), &bar(), &Console::silent(), &options_in(&place)), &own);
            assert_eq!(files(&place.path("out")), std::slice::from_ref(&own), "{}", command.name());
            remove_file(own).unwrap();
        }
        // other names are nobody's business
        for name in ["motion_capture.vtu", "my_result.json", "target_scan.vtu", "notes.html", "iteration_0001.txt"] {
            write(place.path("out").join(name), OWN).unwrap();
        }
        for _ in 0..2 {
            place.run_with(command.clone(), &bar(), &Console::silent(), &options_in(&place)).unwrap();
        }
        for name in ["motion_capture.vtu", "my_result.json", "target_scan.vtu", "notes.html", "iteration_0001.txt"] {
            assert_eq!(read(place.path("out").join(name)).unwrap(), OWN, "{name}");
        }
    }
}

fn options_in(place: &CaseDirectory) -> Options {
    Options { figure: true, ..place.options(&SHORT) }
}

/// Every command may follow every other in one directory, also one that was killed before it wrote its result.
#[test]
fn what_nastic_wrote_is_replaced() {
    let place = CaseDirectory::new();
    let run = |command: &Command| place.run(command.clone(), &bar(), &SHORT).map(|outcome| outcome.exit);
    for command in COMMANDS.iter().chain(&COMMANDS) {
        run(command).unwrap();
        let result = place.path("out/result.json");
        if *command != Command::Check {
            remove_file(&result).unwrap();
        }
        run(command).unwrap();
    }
    // a file that somebody put in the place of one that nastic removed
    run(&Command::Gradient).unwrap();
    assert!(!place.path("out/report.html").exists(), "{:?}", place.files());
    write(place.path("out/report.html"), OWN).unwrap();
    refused(run(&Command::Solve), &place.path("out/report.html"));
}

#[test]
fn sweeps_fits_pages_and_figures_replace_nothing_of_others() {
    let place = CaseDirectory::new();
    place.run(Command::Solve, &bar(), &[]).unwrap();
    let out = place.path("out");
    let request = FigureRequest::default();
    for _ in 0..2 {
        report(&out, None).unwrap();
        figure(&out, &request, None).unwrap();
    }
    let alone = CaseDirectory::new();
    let options = Options { no_report: true, ..place.options(&[]) };
    alone
        .run_with(Command::Solve, &bar(), &Console::silent(), &Options { out: Some(alone.path("out")), ..options })
        .unwrap();
    let there = alone.path("out");
    for name in ["report.html", "figure.png"] {
        let own = there.join(name);
        write(&own, OWN).unwrap();
        refused(if name == "report.html" { report(&there, None) } else { figure(&there, &request, None) }, &own);
    }
    // who names a file means it, unless that is one of the results
    assert_eq!(report(&there, Some(&there.join("report.html"))).unwrap(), there.join("report.html"));
    for name in ["result.json", "start.vtu", "picture.png"] {
        let error = keep_results(&there, &there.join(name)).unwrap_err();
        assert!(matches!(error, RunError::ReplacesInput { .. }), "{error}");
        keep_results(&there, &alone.path(name)).unwrap();
    }
    let page = read(there.join("result.json")).unwrap();
    assert!(report(&there, Some(&there.join("result.json"))).is_err());
    assert_eq!(read(there.join("result.json")).unwrap(), page);

    let swept = place.path("swept");
    let case = place.write("case.json", &bar());
    let how = Sweep { command: Command::Solve, warm: false, quantity: None };
    let sweep_there = || {
        let options = Options { out: Some(swept.clone()), ..place.options(&["materials/0/mu1=90 kPa,110 kPa"]) };
        sweep(&Catalogue::standard(), &how, &case, &options, &Console::silent())
    };
    std::fs::create_dir(&swept).unwrap();
    for name in ["sweep.csv", "sweep.html", "sweep.json", "sweep.svg", "sweep.pvd"] {
        write(swept.join(name), OWN).unwrap();
        refused(sweep_there(), &swept.join(name));
        remove_file(swept.join(name)).unwrap();
    }
    let run = swept.join("mu1=90_kPa");
    std::fs::create_dir(&run).unwrap();
    write(run.join("picture.png"), OWN).unwrap();
    // of a run its row says so
    let outcome = sweep_there().unwrap();
    assert_eq!((outcome.exit, &outcome.result["runs"][0]["exit"]), (Exit::BadInput, &2.into()));
    assert_eq!(read(run.join("picture.png")).unwrap(), OWN);
    remove_file(run.join("picture.png")).unwrap();
    assert_eq!(sweep_there().unwrap().exit, Exit::Done);
    assert_eq!(sweep_there().unwrap().exit, Exit::Done);

    let data = place.write("data.csv", "stretch,nominal_stress [kPa]\n1.1,110\n1.3,290\n1.6,480\n2.0,700\n");
    let data_file = place.write(
        "data.json",
        r#"{ "nastic_fit": 1, "tests": [ { "kind": "uniaxial", "file": "data.csv" } ], "laws": ["neo_hooke_isochoric"],
             "bulk": "1 GPa" }"#,
    );
    assert!(data.is_file());
    let fitted = place.path("fitted");
    std::fs::create_dir(&fitted).unwrap();
    let fit_there = || fit(&data_file, Some(fitted.clone()), &Console::silent());
    for name in ["fit.json", "fit.html", "fit.svg", "fit_volumetric.svg"] {
        write(fitted.join(name), OWN).unwrap();
        refused(fit_there(), &fitted.join(name));
        remove_file(fitted.join(name)).unwrap();
    }
    fit_there().unwrap();
    fit_there().unwrap();
}

/// A mesh, a target or a field that is read may be of an earlier run, but not of the one that is replaced: the same command would
/// find something else there.
#[test]
fn what_a_run_reads_of_an_earlier_one_is_not_replaced_by_its_own() {
    let place = CaseDirectory::new();
    place.run(Command::Solve, &bar(), &[]).unwrap();
    let start = read(place.path("out/start.vtu")).unwrap();
    let obstacle = with(
        &bar(),
        r#""probes""#,
        r#""obstacles": [ { "name": "old", "shape": { "mesh": "out/start.vtu" } } ], "probes""#,
    );
    let target =
        with(&bar(), r#"["X - 0.1", "Y", "Z + 0.1"]"#, r#"{ "file": "out/start.vtu", "array": "displacement" }"#);
    for case in [obstacle, target] {
        for command in [Command::Solve, Command::Optimize] {
            let error = place.run(command, &case, &[]).unwrap_err();
            assert!(matches!(error, RunError::ReplacesInput { .. }), "{error}");
            assert!(error.to_string().contains("out/start.vtu, which is read"), "{error}");
            assert_eq!(read(place.path("out/start.vtu")).unwrap(), start);
        }
    }
}

#[cfg(unix)]
mod links {
    use super::*;
    use std::io::Write;
    use std::os::unix::fs::symlink;
    use std::sync::{Arc, Mutex};

    fn outside() -> tempfile::TempDir {
        let outside = tempfile::tempdir().unwrap();
        write(outside.path().join("own"), OWN).unwrap();
        outside
    }

    fn is_untouched(outside: &tempfile::TempDir) {
        assert_eq!(files(outside.path()), [outside.path().join("own")]);
        assert_eq!(read(outside.path().join("own")).unwrap(), OWN);
    }

    #[test]
    fn links_at_names_of_outputs_are_refused_or_replaced() {
        let (place, outside) = (CaseDirectory::new(), outside());
        let run = || place.run_with(Command::Optimize, &bar(), &Console::silent(), &options_in(&place));
        run().unwrap();
        let names = place.files();
        assert!(names.len() > 15, "{names:?}");
        // those of files that nastic wrote: the links go, not what they lead to
        for name in &names {
            remove_file(place.path("out").join(name)).unwrap();
            let to = if name.len() % 2 == 0 { "own" } else { "none" };
            symlink(outside.path().join(to), place.path("out").join(name)).unwrap();
        }
        let found = run();
        // a checkpoint that leads to no checkpoint is damaged
        let error = found.unwrap_err();
        assert!(matches!(error, RunError::UnreadableCheckpoint(_)), "{error}");
        remove_file(place.path("out/checkpoint.bin")).unwrap();
        run().unwrap();
        is_untouched(&outside);
        assert!(names.iter().all(|name| !place.path("out").join(name).is_symlink()));
        // others
        for name in &names {
            let other = CaseDirectory::new();
            std::fs::create_dir(other.path("out")).unwrap();
            symlink(outside.path().join("none"), other.path("out").join(name)).unwrap();
            let error = other.run(Command::Optimize, &bar(), &SHORT).unwrap_err();
            assert!(matches!(error, RunError::ReplacesOthers { .. }), "{error}");
        }
        is_untouched(&outside);
    }

    /// Puts links where files are, or are to be, whenever something is said.
    struct Planter {
        out: PathBuf,
        to: PathBuf,
        names: Arc<Mutex<Vec<String>>>,
        rows: usize,
    }

    impl Write for Planter {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            self.rows += bytes.iter().filter(|b| **b == b'\n').count();
            let names = self.names.lock().unwrap();
            for (k, name) in names.iter().enumerate().filter(|_| self.out.is_dir()) {
                let file = self.out.join(name);
                if (k + self.rows).is_multiple_of(3) && name != "checkpoint.bin" {
                    let _ = remove_file(&file);
                    let _ = symlink(&self.to, file);
                }
            }
            Ok(bytes.len())
        }

        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn links_that_appear_while_a_command_runs_are_not_followed() {
        let (whole, outside) = (CaseDirectory::new(), outside());
        whole.run_with(Command::Optimize, &bar(), &Console::silent(), &options_in(&whole)).unwrap();
        let mut names = whole.files();
        names.extend([".written".to_owned(), ".lock".to_owned()]);
        for _ in 0..3 {
            let place = CaseDirectory::new();
            let (out, to) = (place.path("out"), outside.path().join("own"));
            let planter = Planter { out, to, names: Arc::new(Mutex::new(names.clone())), rows: 0 };
            // what a link is in the way of may fail, but nowhere else is written
            let file = place.write("case.json", &bar());
            let _ = run(Command::Optimize, &file, &options_in(&place), &Console::new(planter));
            is_untouched(&outside);
        }
    }
}
