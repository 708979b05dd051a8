//! Commands on teams of ranks, which are threads of this process: the files of one rank, to the bit.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;
use crate::starts::{MAGNET, assert_same};

use common::{BAR, CaseDirectory, DRIVEN, with};
use nastic_language::catalogue::Catalogue;
use nastic_language::schema::Command;
use nastic_run::console::Console;
use nastic_run::run::{Exit, Options, Outcome, Part, RunError, Sweep, resume, run, sweep};
use nastic_team::threads::{Faults, run as on_threads};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// The driven bar in three stiffnesses.
fn driven() -> String {
    let scenarios = r#""scenarios": [ { "name": "soft", "probability": 0.25, "set": { "materials/0/young": "0.2 MPa" } },
                 { "name": "usual", "probability": 0.5 },
                 { "name": "stiff", "probability": 0.25, "set": { "materials/0/young": "0.4 MPa" } } ],
  "optimizer": { "max_iterations": 3 },
  "probes""#;
    with(DRIVEN, r#""probes""#, scenarios)
}

/// Five stiffnesses of the bar.
fn scenarios(more: &str) -> String {
    let one = |k: usize| {
        format!(r#"{{ "name": "s{k}", "probability": 0.2, "set": {{ "materials/0/mu1": "{} kPa" }} }}"#, 90 + 7 * k)
    };
    let all: Vec<String> = (0..5).map(one).collect();
    with(BAR, r#""probes""#, &format!(r#""scenarios": [ {} ], {more} "probes""#, all.join(", ")))
}

fn robust() -> String {
    scenarios(
        r#""risk": { "cvar": { "level": 0.6, "smoothing": 0.05 } },
      "constraints": [ { "name": "reach", "cost": { "kind": "position", "surface": "x+", "target": { "z": 0.145 } }, "at_most": 1e-4 } ],"#,
    )
}

fn options(place: &CaseDirectory, set: &[&str]) -> Options {
    Options { threads: Some(1), ..place.options(set) }
}

/// A command on so many ranks; what each had.
fn on_ranks<T: Send>(size: usize, faults: &Faults, options: &Options, each: impl Fn(&Options) -> T + Sync) -> Vec<T> {
    on_threads(size, faults, |rank| {
        each(&Options { team: Some(Arc::new(rank)), cancel: Arc::default(), ..options.clone() })
    })
}

fn optimize(place: &CaseDirectory, case: &str, set: &[&str], size: usize) -> Outcome {
    let file = place.write("case.json", case);
    let optimize = |options: &Options| run(Command::Optimize, &file, options, &Console::silent());
    let mut found = on_ranks(size, &Faults::default(), &options(place, set), optimize);
    found.swap_remove(0).unwrap()
}

/// The files of teams of so many ranks are those of one rank.
fn assert_same_on(case: &str, set: &[&str], sizes: &[usize]) {
    let serial = CaseDirectory::new();
    serial.run_with(Command::Optimize, case, &Console::silent(), &options(&serial, set)).unwrap();
    for size in sizes {
        let place = CaseDirectory::new();
        optimize(&place, case, set, *size);
        assert_same(&place, &serial, &format!("{size} ranks"));
    }
}

#[test]
fn scenarios_with_a_measure_of_risk_and_constraints() {
    assert_same_on(
        &robust(),
        &["optimizer/max_iterations=12", "output/checkpoint=2"],
        &[1, 2, 3, 4, 5, 6, 7, 8, 9, 64],
    );
}

/// A derivative for every scenario's constraint.
#[test]
fn moving_asymptotes() {
    let set = ["optimizer/method=mma", "optimizer/max_iterations=5", "output/checkpoint=2"];
    assert_same_on(&robust(), &set, &[1, 2, 3, 7]);
}

#[test]
fn load_cases() {
    assert_same_on(MAGNET, &["output/every=3"], &[2, 3]);
}

#[test]
fn motions() {
    assert_same_on(&driven(), &["output/checkpoint=1"], &[2, 3]);
}

#[test]
fn several_starts_are_shared_out_with_all_their_members() {
    let set = ["optimizer/starts=7", "optimizer/seed=7", "optimizer/max_iterations=40", "optimizer/tolerance=1e-4"];
    assert_same_on(MAGNET, &set, &[2, 3, 9]);
}

#[test]
fn second_derivatives_and_verification() {
    let set = ["optimizer/method=newton_cg", "optimizer/max_iterations=3", "optimizer/verify=true"];
    assert_same_on(&scenarios(""), &set, &[2, 3]);
}

/// Raises the flag of one rank at a trial.
fn interrupted(place: &CaseDirectory, case: &str, set: &[&str], size: usize, (rank, trial): (usize, usize)) -> Outcome {
    let file = place.write("case.json", case);
    let optimize = |options: &Options| {
        let own = options.team.as_ref().unwrap().rank();
        let (cancel, count) = (options.cancel.clone(), AtomicUsize::new(0));
        let on_trial = nastic_run::run::OnTrial::call(move |_| {
            if own == rank && count.fetch_add(1, Ordering::Relaxed) == trial {
                cancel.store(true, Ordering::Relaxed);
            }
        });
        run(Command::Optimize, &file, &Options { on_trial, ..options.clone() }, &Console::silent())
    };
    let mut found = on_ranks(size, &Faults::default(), &options(place, set), optimize);
    found.swap_remove(0).unwrap()
}

#[test]
fn a_stop_asked_of_one_rank_stops_all_and_any_number_of_ranks_goes_on() {
    let set = ["optimizer/max_iterations=9", "output/checkpoint=2"];
    let serial = CaseDirectory::new();
    serial.run_with(Command::Optimize, &robust(), &Console::silent(), &options(&serial, &set)).unwrap();
    for (size, rank, trial, then) in [(3, 2, 5, 2), (2, 0, 3, 5), (4, 1, 7, 1)] {
        let place = CaseDirectory::new();
        let stopped = interrupted(&place, &robust(), &set, size, (rank, trial));
        assert_eq!(stopped.exit, Exit::NotConverged);
        assert_eq!(place.json("result.json")["interrupted"], true);
        let go_on = |options: &Options| resume(&Catalogue::standard(), &place.path("out"), options, &Console::silent());
        on_ranks(then, &Faults::default(), &Options { threads: Some(1), ..Options::default() }, go_on)
            .swap_remove(0)
            .unwrap();
        assert_same(&place, &serial, &format!("{size} ranks, then {then}"));
    }
}

#[test]
fn after_a_lost_rank_another_number_of_ranks_goes_on() {
    let set = ["optimizer/max_iterations=9", "output/checkpoint=2"];
    let serial = CaseDirectory::new();
    serial.run_with(Command::Optimize, &robust(), &Console::silent(), &options(&serial, &set)).unwrap();
    for message in [3, 40, 90, 121, 150, 177, 200] {
        let place = CaseDirectory::new();
        let file = place.write("case.json", &robust());
        let faults = Faults { lost: Some((2, message)), ..Faults::default() };
        let optimize = |options: &Options| run(Command::Optimize, &file, options, &Console::silent());
        let found = on_ranks(3, &faults, &options(&place, &set), optimize);
        if found.iter().all(Result::is_ok) {
            continue; // it had ended before
        }
        for lost in &found {
            assert_eq!(lost.as_ref().map_err(RunError::exit).unwrap_err(), Exit::Parted, "{message}: {lost:?}");
        }
        let go_on = |options: &Options| resume(&Catalogue::standard(), &place.path("out"), options, &Console::silent());
        on_ranks(2, &Faults::default(), &Options { threads: Some(1), ..Options::default() }, go_on)
            .swap_remove(0)
            .unwrap();
        assert_same(&place, &serial, &format!("lost at message {message}"));
    }
}

/// The second of two sets of files has a place that cannot be written to, for the block of the third rank.
#[test]
fn a_checkpoint_that_one_rank_cannot_write_leaves_the_one_before() {
    let set = ["optimizer/max_iterations=9", "output/checkpoint=2"];
    let serial = CaseDirectory::new();
    serial.run_with(Command::Optimize, &robust(), &Console::silent(), &options(&serial, &set)).unwrap();
    let place = CaseDirectory::new();
    let file = place.write("case.json", &robust());
    let in_the_way = place.path("out").join("checkpoint_b1.bin");
    std::fs::create_dir_all(in_the_way.join("full")).unwrap();
    let optimize = |options: &Options| run(Command::Optimize, &file, options, &Console::silent());
    let found = on_ranks(3, &Faults::default(), &options(&place, &set), optimize);
    let failed = found[0].as_ref().unwrap_err();
    assert_eq!(failed.exit(), Exit::NotWritten, "{failed}");
    assert!(failed.to_string().contains("checkpoint_b1.bin") && failed.to_string().contains("(on rank 2)"), "{failed}");
    std::fs::remove_dir_all(in_the_way).unwrap();
    for then in [1, 4, 2] {
        let go_on = |options: &Options| resume(&Catalogue::standard(), &place.path("out"), options, &Console::silent());
        let found = on_ranks(then, &Faults::default(), &Options { threads: Some(1), ..Options::default() }, go_on);
        let Ok(found) = &found[0] else { panic!("{then} ranks: {:?}", found[0]) };
        assert_eq!(found.result["resumed"]["iteration"].as_u64(), Some(if then == 1 { 0 } else { 8 }));
        // one rank has all in one file
        assert!(!place.path("out").join("checkpoint_a0.bin").exists(), "then {then} ranks");
        assert_same(&place, &serial, &format!("then {then} ranks"));
    }
}

/// A file of another checkpoint, and one that is not there, are named.
#[test]
fn a_block_that_does_not_belong_to_its_checkpoint_is_refused() {
    let place = CaseDirectory::new();
    optimize(&place, &robust(), &["optimizer/max_iterations=9", "output/checkpoint=2"], 2);
    let [a, b] = ["a", "b"].map(|set| place.path("out").join(format!("checkpoint_{set}1.bin")));
    let refused = || {
        let go_on = resume(&Catalogue::standard(), &place.path("out"), &Options::default(), &Console::silent());
        let Err(error) = go_on else { panic!("a checkpoint of pieces that do not fit") };
        assert_eq!(error.exit(), Exit::BadInput);
        error.to_string()
    };
    let kept = std::fs::read(&a).unwrap();
    std::fs::copy(&b, &a).unwrap();
    assert!(refused().contains("checkpoint_a1.bin does not fit: it belongs to another checkpoint"), "{}", refused());
    std::fs::remove_file(&a).unwrap();
    assert!(refused().contains("checkpoint.bin names it, and it is not there"), "{}", refused());
    std::fs::write(&a, kept).unwrap();
    resume(&Catalogue::standard(), &place.path("out"), &Options::default(), &Console::silent()).unwrap();
}

#[test]
fn a_rank_that_does_not_answer_ends_all_with_a_code_of_its_own() {
    let mut ended = 0;
    // one of three messages of a rank in a row is one that it sends
    for message in [60, 61, 62] {
        let place = CaseDirectory::new();
        let file = place.write("case.json", &scenarios(""));
        let patience = Some(Duration::from_secs(2));
        let faults = Faults { dropped: Some((1, message)), patience, ..Faults::default() };
        let optimize = |options: &Options| run(Command::Optimize, &file, options, &Console::silent());
        let found = on_ranks(3, &faults, &options(&place, &["optimizer/max_iterations=30"]), optimize);
        if found.iter().all(Result::is_ok) {
            continue;
        }
        ended += 1;
        for lost in &found {
            assert_eq!(lost.as_ref().map_err(RunError::exit).unwrap_err(), Exit::Parted, "{message}: {lost:?}");
        }
        assert_eq!((place.json("result.json")["exit"].as_u64(), Exit::Parted.code()), (Some(9), 9));
    }
    assert!(ended > 0);
}

#[test]
fn a_member_without_an_equilibrium_on_the_last_rank_is_named_with_it() {
    let loads = r#""loads": [ { "region": "body", "body_force": [0, 0, 0] } ],"#;
    let case = with(&scenarios(loads), r#""118 kPa""#, r#""118 kPa", "loads/0/body_force": [-1e6, 0, 0]"#);
    let set = [r#"optimizer/unstable="refuse""#];
    let place = CaseDirectory::new();
    let file = place.write("case.json", &case);
    let optimize = |options: &Options| run(Command::Optimize, &file, options, &Console::silent());
    let found = on_ranks(3, &Faults::default(), &options(&place, &set), optimize);
    let texts: Vec<String> = found.iter().map(|found| found.as_ref().unwrap_err().to_string()).collect();
    assert!(texts.iter().all(|text| text.starts_with("member 4 (scenario s4) on rank 2: ")), "{texts:?}");
    assert!(found.iter().all(|found| found.as_ref().map_err(RunError::exit).unwrap_err() == Exit::ForwardFailed));
}

#[test]
fn runs_of_a_sweep_are_shared_out() {
    let set = ["materials/0/mu1=90 kPa,100 kPa,110 kPa", "optimizer/max_iterations=2", "title=Bar"];
    let (serial, place) = (CaseDirectory::new(), CaseDirectory::new());
    let asked = Sweep { command: Command::Optimize, warm: false, quantity: None };
    for place in [&serial, &place] {
        place.write("case.json", BAR);
    }
    let of = |place: &CaseDirectory, options: &Options| {
        let file = place.path("case.json");
        sweep(&Catalogue::standard(), &asked, &file, options, &Console::silent()).unwrap()
    };
    of(&serial, &options(&serial, &set));
    on_ranks(2, &Faults::default(), &options(&place, &set), |options| of(&place, options));
    for name in ["sweep.csv", "sweep.json"] {
        let text = |place: &CaseDirectory| std::fs::read_to_string(place.path("out").join(name)).unwrap();
        let own = |place: &CaseDirectory| text(place).replace(&place.directory.path().display().to_string(), "");
        assert_eq!(own(&place), own(&serial));
    }
}

/// However the runs of a rank ended: one exit code is returned, that of the first.
#[test]
fn all_ranks_of_a_sweep_end_with_the_code_of_the_first() {
    let ends = |set: &[&str], strict: bool, before: &dyn Fn(&CaseDirectory)| {
        let (place, asked) = (CaseDirectory::new(), Sweep { command: Command::Optimize, warm: false, quantity: None });
        let file = place.write("case.json", BAR);
        before(&place);
        let options = Options { strict, ..options(&place, set) };
        let run = |options: &Options| sweep(&Catalogue::standard(), &asked, &file, options, &Console::silent());
        let found = on_ranks(3, &Faults::default(), &options, run);
        found.iter().map(|found| found.as_ref().map_or_else(RunError::exit, |outcome| outcome.exit)).collect::<Vec<_>>()
    };
    let nothing = |_: &CaseDirectory| {};
    // one that converges, one that does not, one that is refused
    let values = "optimizer/max_iterations=200,1,-1";
    assert_eq!(ends(&[values], false, &nothing), [Exit::BadInput; 3]);
    assert_eq!(ends(&["optimizer/max_iterations=1,200,300"], true, &nothing), [Exit::NotConverged; 3]);
    assert_eq!(ends(&["nowhere=1,2"], false, &nothing), [Exit::BadInput; 3]);
    // where the table cannot be written
    let in_the_way = |place: &CaseDirectory| std::fs::create_dir_all(place.path("out/sweep.csv")).unwrap();
    assert_eq!(ends(&["optimizer/max_iterations=1,2"], false, &in_the_way), [Exit::NotWritten; 3]);
}

#[test]
fn what_one_rank_does_is_refused_on_several() {
    let place = CaseDirectory::new();
    let file = place.write("case.json", BAR);
    for (command, share) in [(Command::Solve, None), (Command::Optimize, Some("1/2".parse::<Part>().unwrap()))] {
        let share = share.map_or_else(Default::default, nastic_run::run::Share::Part);
        let run = |options: &Options| run(command.clone(), &file, options, &Console::silent());
        let found = on_ranks(2, &Faults::default(), &Options { share, ..options(&place, &[]) }, run);
        assert!(found.iter().all(|found| matches!(found, Err(RunError::OneRank { ranks: 2, .. }))), "{found:?}");
        assert!(!place.path("out").exists());
    }
    let asked = Sweep { command: Command::Optimize, warm: false, quantity: None };
    let set = ["materials/0/mu1=90 kPa,100 kPa"];
    for share in [nastic_run::run::Share::Part("1/2".parse().unwrap()), nastic_run::run::Share::Join] {
        let of = |options: &Options| sweep(&Catalogue::standard(), &asked, &file, options, &Console::silent());
        let found = on_ranks(2, &Faults::default(), &Options { share, ..options(&place, &set) }, of);
        assert!(found.iter().all(|found| matches!(found, Err(RunError::OneRank { ranks: 2, .. }))));
        assert!(!place.path("out").exists());
    }
}

#[test]
fn a_directory_that_the_first_rank_cannot_write_to_ends_all_at_once() {
    let place = CaseDirectory::new();
    let file = place.write("case.json", &scenarios(""));
    place.write("out", "a file in the way");
    let began = Instant::now();
    let optimize = |options: &Options| run(Command::Optimize, &file, options, &Console::silent());
    let found = on_ranks(3, &Faults::default(), &options(&place, &[]), optimize);
    assert!(began.elapsed() < Duration::from_secs(5));
    let exits: Vec<Exit> = found.iter().map(|found| found.as_ref().map_err(RunError::exit).unwrap_err()).collect();
    assert_eq!(exits, [Exit::NotWritten, Exit::Parted, Exit::Parted]);
}
