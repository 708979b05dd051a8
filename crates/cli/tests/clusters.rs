//! The scripts of `docs/clusters.md`, as they stand there.

#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::panic)] // a test may

use crate::common;

use common::{BAR, CaseDirectory, code, text};
use std::path::Path;
use std::process::{Command, Output};

/// The block of the page that has this line among its first, as a file beside the case.
fn script(place: &CaseDirectory, name: &str) {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/clusters.md");
    let page = std::fs::read_to_string(page).unwrap();
    let blocks = page.split("```").skip(1).step_by(2);
    let mut blocks = blocks.filter(|block| block.lines().take(3).any(|line| line == format!("# {name}")));
    let block = blocks.next().unwrap_or_else(|| panic!("no block {name}"));
    std::fs::write(place.path(name), block.split_once('\n').unwrap().1).unwrap();
}

/// A command that finds `nastic`.
fn command(place: &CaseDirectory, program: &str, arguments: &[&str]) -> Command {
    let mut command = Command::new(program);
    let own = Path::new(env!("CARGO_BIN_EXE_nastic")).parent().unwrap().display().to_string();
    let path = std::env::var("PATH").unwrap_or_default();
    command.args(arguments).current_dir(place.path("")).env("PATH", format!("{own}:{path}"));
    command
}

/// A place with `finger.json`, a small case whose optimisations end soon.
fn place() -> CaseDirectory {
    let place = CaseDirectory::new(BAR);
    let case =
        BAR.replace("\"mu1\"", "\"young\"").replace("\"mu2\": \"20 kPa\", \"mu3\": \"300 kPa\"", "\"poisson\": 0.3");
    let case =
        case.replace("\"mooney_rivlin\"", "\"neo_hooke\"").replace("\"max_iterations\": 4", "\"max_iterations\": 3");
    std::fs::write(place.path("finger.json"), case).unwrap();
    place
}

/// One task of an array of so many, as SLURM would start it.
fn task(place: &CaseDirectory, script: &str, id: usize, count: usize) -> Output {
    let mut shell = command(place, "bash", &[script]);
    shell.env("SLURM_ARRAY_TASK_ID", id.to_string()).env("SLURM_ARRAY_TASK_COUNT", count.to_string());
    shell.env("SLURM_CPUS_PER_TASK", "1").output().unwrap()
}

#[test]
fn the_array_script_makes_the_table_of_one_process() {
    let (place, whole) = (place(), place());
    for name in ["sweep.sh", "array.sh"] {
        script(&place, name);
        script(&whole, name);
    }
    let one = command(&whole, "bash", &["sweep.sh"]).output().unwrap();
    assert_eq!(code(&one), 4, "{}{}", text(&one.stdout), text(&one.stderr));
    // One task is lost, and the whole array is sent again.
    for id in [4, 1, 3] {
        let output = task(&place, "array.sh", id, 4);
        assert!(text(&output.stdout).contains("3 runs made;"), "{}{}", text(&output.stdout), text(&output.stderr));
    }
    for id in 1..=4 {
        let kept = if id == 2 { "3 runs made;" } else { "3 runs kept;" };
        let output = task(&place, "array.sh", id, 4);
        assert!(text(&output.stdout).contains(kept), "task {id}: {}", text(&output.stdout));
    }
    let joined = command(&place, "bash", &["sweep.sh", "--join"]).output().unwrap();
    assert_eq!(code(&joined), 4, "every optimisation ended at its limit of iterations");
    for name in ["sweep.json", "sweep.csv"] {
        let file = Path::new("out/stiffness").join(name);
        let file = file.to_str().unwrap();
        assert_eq!(std::fs::read(place.path(file)).unwrap(), std::fs::read(whole.path(file)).unwrap(), "{name}");
    }
    // One task alone is none of the array.
    let alone = task(&place, "array.sh", 3, 1);
    assert!(code(&alone) == 2 && text(&alone.stderr).contains("1 <= K <= N"), "{}", text(&alone.stderr));
}

#[test]
fn the_script_of_starts_makes_the_result_of_one_process() {
    let (place, whole) = (place(), place());
    let run = |place: &CaseDirectory, more: &[&str]| {
        script(place, "starts.sh");
        command(place, "bash", &[&["starts.sh"], more].concat()).output().unwrap()
    };
    let one = run(&whole, &[]);
    assert_eq!(code(&one), 4, "{}{}", text(&one.stdout), text(&one.stderr));
    for part in ["2/4", "4/4", "1/4", "3/4"] {
        let output = run(&place, &["--part", part]);
        assert_eq!(code(&output), 0, "{part}: {}", text(&output.stderr));
    }
    assert!(place.path("out/starts/start_1").exists() && place.path("out/starts/start_5").exists());
    let joined = run(&place, &["--join"]);
    assert_eq!(code(&joined), 4, "{}{}", text(&joined.stdout), text(&joined.stderr));
    (0..8).for_each(|index| std::fs::remove_dir_all(place.path(&format!("out/starts/start_{index}"))).unwrap());
    common::assert_same(&place.path("out/starts"), &whole.path("out/starts"), "parts of starts");
}

/// A program `name` for scripts.
fn stand_in(place: &CaseDirectory, name: &str, script: &str) {
    use std::os::unix::fs::PermissionsExt;
    std::fs::create_dir_all(place.path("bin")).unwrap();
    let file = place.path("bin").join(name);
    std::fs::write(&file, format!("#!/bin/bash\n{script}\n")).unwrap();
    std::fs::set_permissions(file, PermissionsExt::from_mode(0o755)).unwrap();
}

/// `mpirun` and `nastic-mpi` are stand-ins that note what they are given, and run one process.
#[test]
fn the_script_of_ranks_begins_and_goes_on() {
    let (place, whole) = (place(), place());
    for place in [&place, &whole] {
        std::fs::copy(place.path("finger.json"), place.path("robust.json")).unwrap();
    }
    script(&place, "ranks.sh");
    stand_in(&place, "mpirun", r#"echo mpirun "$@" >>told; shift 4; exec "$@""#);
    stand_in(&place, "nastic-mpi", r#"exec nastic "$@""#);
    let own = place.path("bin").display().to_string();
    let send = || {
        let mut shell = command(&place, "bash", &["-c", &format!("PATH={own}:$PATH bash ranks.sh")]);
        shell.env("SLURM_NTASKS", "8").env("SLURM_CPUS_PER_TASK", "2").output().unwrap()
    };
    let one = command(&whole, "nastic", &["optimize", "robust.json", "--out", "out/robust", "--threads", "2"])
        .output()
        .unwrap();
    for sent in [send(), send()] {
        assert_eq!(code(&sent), code(&one), "{}{}", text(&sent.stdout), text(&sent.stderr));
        common::assert_same(&place.path("out/robust"), &whole.path("out/robust"), "the script of ranks");
    }
    let told = std::fs::read_to_string(place.path("told")).unwrap();
    let command = |what: &str| format!("mpirun -n 8 --bind-to none nastic-mpi {what} --threads 2");
    let expected = [command("optimize robust.json --out out/robust"), command("resume out/robust")];
    assert_eq!(told.lines().collect::<Vec<_>>(), expected);
}

#[test]
fn the_snakefile_makes_the_table_of_one_process() {
    if Command::new("snakemake").arg("--version").output().is_err() {
        eprintln!("SKIPPED the_snakefile_makes_the_table_of_one_process: snakemake is not installed");
        return;
    }
    let (place, whole) = (place(), place());
    script(&whole, "sweep.sh");
    assert_eq!(code(&command(&whole, "bash", &["sweep.sh"]).output().unwrap()), 4);
    for name in ["sweep.sh", "Snakefile"] {
        script(&place, name);
    }
    let made = command(&place, "snakemake", &["--cores", "2"]).output().unwrap();
    assert_eq!(code(&made), 0, "{}{}", text(&made.stdout), text(&made.stderr));
    let file = "out/stiffness/sweep.json";
    assert_eq!(std::fs::read(place.path(file)).unwrap(), std::fs::read(whole.path(file)).unwrap());
}
