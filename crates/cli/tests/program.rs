//! The program as a user types it: exit codes, streams, options.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::{BAR, CaseDirectory, code, text};

#[test]
fn done_is_zero_and_results_lie_beside_the_case() {
    let place = CaseDirectory::new(BAR);
    for command in ["check", "solve", "gradient", "gradcheck"] {
        let output = place.nastic(&[command, "case.json"]);
        assert_eq!(code(&output), 0, "{command}: {}", text(&output.stderr));
        assert!(!output.stdout.is_empty() && output.stderr.is_empty(), "{command}: {}", text(&output.stderr));
    }
    assert!(place.path("out/case/result.json").exists());
    assert!(place.path("out/case/derivative.json").exists());
}

#[test]
fn bad_input_is_two_and_tells_every_problem() {
    let place = CaseDirectory::new(&BAR.replace("\"x-\"", "\"left\"").replace("[1.0, 0.25, 0.25] }", "[9.0, 0, 0] }"));
    let output = place.nastic(&["optimize", "case.json"]);
    assert_eq!(code(&output), 2);
    let message = text(&output.stderr);
    assert!(message.contains("nastic: case.json:7:") && message.contains("supports/0/surface"), "{message}");
    assert!(message.contains("probes/0/point") && message.contains("2 problems"), "{message}");
    assert!(!place.path("out").exists(), "nothing is written for a case that is wrong");
    let output = place.nastic(&["solve", "nowhere.json"]);
    assert_eq!(code(&output), 2);
    assert!(text(&output.stderr).contains("nowhere.json: cannot be read"), "{}", text(&output.stderr));
}

#[test]
fn modes_are_asked_for_by_their_number() {
    let place = CaseDirectory::new(&BAR.replace("\"law\":", "\"density\": \"1100 kg/m^3\", \"law\":"));
    let output = place.nastic(&["modes", "case.json", "--count", "2", "--undeformed"]);
    assert_eq!(code(&output), 0, "{}", text(&output.stderr));
    let message = text(&output.stdout);
    assert!(message.contains("about the undeformed body") && message.matches(" Hz ").count() == 2, "{message}");
    assert!(place.path("out/case/start.vtu").exists());
    let output = place.nastic(&["modes", "case.json", "--json"]);
    let answer: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(answer["modes"]["frequencies"].as_array().unwrap().len(), 6, "{answer}");
    let output = CaseDirectory::new(BAR).nastic(&["modes", "case.json"]);
    assert_eq!(code(&output), 2);
    assert!(text(&output.stderr).contains("give every material a \"density\""), "{}", text(&output.stderr));
}

#[test]
fn a_failed_solve_is_three() {
    let place = CaseDirectory::new(BAR);
    let output = place.nastic(&["solve", "case.json", "--set", "supports/0/displacement={\"x\": 0}"]);
    assert_eq!(code(&output), 2, "fixed and displaced");
    let crushed = BAR.replace(
        r#""fix": ["x", "y", "z"] }"#,
        r#""fix": ["x", "y", "z"] }, { "surface": "x+", "displacement": { "x": -1.2 } }"#,
    );
    let place = CaseDirectory::new(&crushed);
    let output = place.nastic(&["solve", "case.json", "--json"]);
    assert_eq!(code(&output), 3);
    let answer: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(answer["exit"], 3);
    assert!(answer["last_good_state"].as_str().unwrap().ends_with("failure.vtu"), "{answer}");
}

#[test]
fn stopping_early_is_four_and_missing_an_expectation_six() {
    let place = CaseDirectory::new(BAR);
    let output = place.nastic(&["optimize", "case.json", "--out", "there"]);
    assert_eq!(code(&output), 4, "{}", text(&output.stderr));
    let message = text(&output.stdout);
    assert!(message.contains("trial  iter") && message.contains("to go on"), "{message}");
    assert!(place.path("there/optimum.vtu").exists());
    let expect = r#"expect={"min_J": {"value": 3, "absolute": 0.1}}"#;
    let output = place.nastic(&["solve", "case.json", "--quiet", "--set", expect]);
    assert_eq!(code(&output), 6);
    assert!(output.stdout.is_empty());
    assert!(text(&output.stderr).contains("expectation missed: min_J is 0.9"), "{}", text(&output.stderr));
}

/// What a case expects holds as it is written: where --set changed it, how to leave that aside is said behind the last value missed.
#[test]
fn a_changed_case_that_misses_its_values_says_how_to_leave_them_aside() {
    let expect = r#""expect": { "cost/total": { "value": 3, "absolute": 0.1 }, "min_J": { "value": 3, "absolute": 0.1 } },
  "output""#;
    let place = CaseDirectory::new(&BAR.replace("\"output\"", expect));
    let solved = |more: &[&str]| place.nastic(&[&["solve", "case.json"], more].concat());
    let advice = "            the case was changed by --set; --set 'expect={}' leaves its values aside";
    let as_written = solved(&[]);
    let said = text(&as_written.stdout);
    assert!(code(&as_written) == 6 && said.contains("MISSED      min_J") && !said.contains("--set"), "{said}");
    let finer = ["--set", "mesh/box/cells=[5,1,1]"];
    let changed = solved(&finer);
    let said = text(&changed.stdout);
    let lines: Vec<&str> = said.lines().skip_while(|line| !line.starts_with("MISSED")).take(3).collect();
    assert!(code(&changed) == 6 && lines[1].starts_with("MISSED") && lines[2] == advice, "{said}");
    let aside = solved(&[&finer[..], &["--set", "expect={}"]].concat());
    assert_eq!((code(&aside), text(&aside.stdout).contains("MISSED")), (0, false), "{}", text(&aside.stdout));
    // Who overrides the values means them.
    let meant = solved(&["--set", "expect/min_J/value=4"]);
    assert!(code(&meant) == 6 && !text(&meant.stdout).contains("changed by --set"), "{}", text(&meant.stdout));
}

#[test]
fn a_place_that_cannot_be_written_to_is_seven() {
    let place = CaseDirectory::new(BAR);
    std::fs::write(place.path("there"), "in the way").unwrap();
    let output = place.nastic(&["solve", "case.json", "--out", "there/deeper"]);
    assert_eq!(code(&output), 7, "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("cannot write there/deeper"), "{}", text(&output.stderr));
}

#[test]
fn json_is_the_result_and_nothing_else() {
    let place = CaseDirectory::new(BAR);
    let output = place.nastic(&["solve", "case.json", "--json", "--threads", "1"]);
    let answer: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let file = std::fs::read(place.path("out/case/result.json")).unwrap();
    assert_eq!(answer, serde_json::from_slice::<serde_json::Value>(&file).unwrap());
    let output = place.nastic(&["check", "case.json", "--json", "--set", "materials/0/mu1=-1"]);
    let answer: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(answer["problems"][0]["path"], "materials/0/mu1");
    assert_eq!(code(&output), 2);
}

#[test]
fn overrides_take_the_place_of_values() {
    let place = CaseDirectory::new(BAR);
    let output = place.nastic(&["check", "case.json", "--set", "materials/0/mu1=90 kPa", "--set", "probes/0/name=top"]);
    assert_eq!(code(&output), 0);
    assert!(text(&output.stdout).contains("mu1 90000 Pa"), "{}", text(&output.stdout));
    let output = place.nastic(&["check", "case.json", "--set", "material/0/mu1=90 kPa"]);
    assert_eq!(code(&output), 2);
    assert!(text(&output.stderr).contains("did you mean \"materials\"?"), "{}", text(&output.stderr));
}

#[test]
fn the_schema_is_json_and_help_names_every_command() {
    let place = CaseDirectory::new(BAR);
    let schema: serde_json::Value = serde_json::from_slice(&place.nastic(&["schema"]).stdout).unwrap();
    assert_eq!(schema["title"], "nastic case");
    let help = text(&place.nastic(&["--help"]).stdout);
    for word in ["check", "solve", "gradient", "gradcheck", "optimize", "schema", "Exit codes: 0 done, 2 bad input"] {
        assert!(help.contains(word), "{word}\n{help}");
    }
    let output = place.nastic(&["optimise", "case.json"]);
    assert_eq!(code(&output), 2, "clap refuses with the same code");
}

#[test]
fn analyses_of_solve_go_one_at_a_time_and_a_failed_ramp_is_three() {
    let place = CaseDirectory::new(BAR);
    let both = place.nastic(&["solve", "case.json", "--modes", "2", "--path"]);
    assert_eq!(code(&both), 2);
    assert!(text(&both.stderr).contains("cannot be used with"), "{}", text(&both.stderr));
    for (options, key) in [
        (vec!["--modes", "2"], "modes"),
        (vec!["--ramp", "tension=0 Pa:20 kPa:3"], "ramp"),
        (vec!["--path"], "path"),
        (vec!["--equilibria", "1"], "equilibria"),
        (vec!["--minimum"], "inertia"),
    ] {
        let output = place.nastic(&[vec!["solve", "case.json", "--json"], options].concat());
        assert_eq!(code(&output), 0, "{key}: {}", text(&output.stderr));
        let result: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert!(!result[key].is_null(), "{key}: {result:#}");
    }
    let failed = place.nastic(&["solve", "case.json", "--quiet", "--ramp", "tension=0:50 MPa:3"]);
    assert_eq!(code(&failed), 3);
    assert!(failed.stdout.is_empty() && text(&failed.stderr).contains("the ramp stops at"), "{}", text(&failed.stderr));
}

#[test]
fn a_sweep_ends_as_its_worst_run_and_prints_its_table() {
    let place = CaseDirectory::new(BAR);
    let sweep = ["sweep", "case.json", "--command", "solve", "--json", "--out", "there"];
    let output = place.nastic(&[&sweep[..], &["--set", "materials/0/mu1=90 kPa,110 kPa"]].concat());
    assert_eq!(code(&output), 0, "{}", text(&output.stderr));
    let answer: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(answer["runs"][1]["run"], "mu1=110_kPa");
    let output = place.nastic(&[&sweep[..], &["--set", "materials/0/mu1=-1 kPa,110 kPa"]].concat());
    assert_eq!(code(&output), 2, "a shear modulus below zero is a row");
    let answer: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&answer["runs"][0]["exit"], &answer["runs"][1]["exit"]), (&2.into(), &0.into()));
    let output = place.nastic(&["sweep", "case.json", "--set", "materials/0/mu1=1 kPa"]);
    assert_eq!(code(&output), 2);
    assert!(text(&output.stderr).contains("no option has several values"), "{}", text(&output.stderr));
}

/// The spectrum is asked for with the optimisation, or of one that has ended.
#[test]
fn the_spectrum_at_the_optimum() {
    let place = CaseDirectory::new(BAR);
    let found = |arguments: &[&str]| {
        let output = place.nastic(arguments);
        assert_eq!(code(&output), 4, "{}", text(&output.stderr));
        serde_json::from_slice::<serde_json::Value>(&output.stdout).unwrap()["spectrum"].clone()
    };
    let first = found(&["optimize", "case.json", "--spectrum", "3", "--cost-rise", "1e-5", "--json", "--threads", "1"]);
    assert_eq!((first["eigenvalues"].as_array().unwrap().len(), &first["cost_rise"]), (3, &1e-5.into()), "{first}");
    let again = found(&["resume", "out/case", "--spectrum", "3", "--cost-rise", "1e-5", "--json", "--threads", "3"]);
    assert_eq!(first, again);
    for (arguments, message) in [
        (&["optimize", "case.json", "--cost-rise", "1"][..], "--spectrum"),
        (&["optimize", "case.json", "--spectrum", "0"], "0 is not in 1..=500"),
        (&["optimize", "case.json", "--spectrum", "2", "--cost-rise=-1"], "the rise of the cost is -1e0"),
    ] {
        let output = place.nastic(arguments);
        assert_eq!(code(&output), 2, "{arguments:?}");
        assert!(text(&output.stderr).contains(message), "{arguments:?}: {}", text(&output.stderr));
    }
}

/// Control characters of a title are shown; a standard output that is full is no success.
#[cfg(target_os = "linux")]
#[test]
fn standard_output_is_looked_after() {
    let place = CaseDirectory::new(&BAR.replace("\"Bar\"", "\"Bar\\u001b]0;x\\u0007\""));
    let output = place.nastic(&["check", "case.json"]);
    assert!(text(&output.stdout).contains("Bar\\u{1b}]0;x\\u{7}"), "{}", text(&output.stdout));
    for arguments in [&["check", "case.json"] as &[&str], &["check", "case.json", "--json"], &["schema"]] {
        let full = std::fs::File::options().write(true).open("/dev/full").unwrap();
        let output = place.program(arguments).stdout(full).output().unwrap();
        assert_eq!(code(&output), 7, "{arguments:?}");
        assert!(text(&output.stderr).contains("standard output could not be written"), "{}", text(&output.stderr));
    }
}

/// Too many cells for what `ulimit -v` leaves, here 1.5 GB: said before any are made.
#[cfg(target_os = "linux")]
#[test]
fn a_mesh_too_large_is_refused_before_it_is_made() {
    let large = BAR.replace("[4, 1, 1]", "[100, 100, 100]");
    let place = CaseDirectory::new(&large);
    let output = place.shell("ulimit -v 1500000", &["check", "case.json"]).output().unwrap();
    assert_eq!(code(&output), 2, "{}", text(&output.stderr));
    let message = text(&output.stderr);
    assert!(message.contains("mesh/box/cells: a mesh of some ") && message.contains("GB at least"), "{message}");
}
