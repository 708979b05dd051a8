//! Scenarios, load cases, risk and several starts: whole commands on small bodies.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::{BAR, CaseDirectory, OPTIMUM_POINTS, problems, with};
use nastic_language::schema::Command;
use nastic_run::console::Console;
use nastic_run::run::{Exit, Options};
use serde_json::Value;

/// A magnet whose magnetisation two load cases share, each with its own field and target.
const MAGNET: &str = include_str!("../../language/tests/cases/magnet_pair.json");

const SCENARIOS: &str = r#""scenarios": [
    { "name": "soft", "probability": 0.25, "set": { "materials/0/mu1": "90 kPa" } },
    { "name": "stiff", "probability": 0.75, "set": { "materials/0/mu1": "120 kPa", "costs/0/target/2": "Z + 0.12" } } ],
  "probes""#;

fn number(value: &Value, path: &str) -> f64 {
    let found = nastic_run::result::find(value, path).unwrap_or_else(|| panic!("no {path} in {value:#}"));
    found.as_f64().unwrap_or_else(|| panic!("{path} is {found}"))
}

fn robust() -> String {
    with(BAR, r#""probes""#, SCENARIOS)
}

/// What single cases with the scenarios' values give.
fn singles() -> [Value; 2] {
    let place = CaseDirectory::new();
    let run = |set: &[&str]| place.run(Command::Gradient, BAR, set).unwrap().result;
    [run(&["materials/0/mu1=90 kPa"]), run(&["materials/0/mu1=120 kPa", "costs/0/target/2=Z + 0.12"])]
}

#[test]
fn scenarios_have_the_numbers_of_the_single_cases() {
    let [soft, stiff] = singles();
    let place = CaseDirectory::new();
    let result = place.run(Command::Gradient, &robust(), &[]).unwrap().result;
    assert_eq!(result["gradient_check"]["verdict"], "right", "{}", result["gradient_check"]);
    for key in ["cost/total", "cost/terms/tracking", "min_J", "inertia", "potential", "probes/tip/displacement/2"] {
        assert_eq!(number(&result, &format!("scenarios/soft/{key}")), number(&soft, key), "{key}");
        assert_eq!(number(&result, &format!("scenarios/stiff/{key}")), number(&stiff, key), "{key}");
    }
    let mean = 0.25 * number(&soft, "cost/total") + 0.75 * number(&stiff, "cost/total");
    assert!((number(&result, "cost/total") - mean).abs() <= 1e-14 * mean);
    assert_eq!(number(&result, "risk/value"), number(&result, "cost/total"));
    for c in 0..3 {
        let [a, b] = [&soft, &stiff].map(|single| number(single, &format!("probes/tip/displacement/{c}")));
        let (mean, spread) = (0.25 * a + 0.75 * b, (0.25_f64 * 0.75).sqrt() * (a - b).abs());
        assert!((number(&result, &format!("probes/tip/displacement/{c}")) - mean).abs() <= 1e-14, "{c}");
        let found = number(&result, &format!("probes/tip/deviation/{c}"));
        assert!((found - spread).abs() <= 1e-14 && (c == 1 || found > 1e-6), "{c}: {found}, {spread}");
    }
    for risk in ["mean", "mean_deviation", "cvar", "worst_case"] {
        assert!(number(&result, &format!("risk/measures/{risk}/value")) >= mean * (1.0 - 1e-12), "{risk}");
    }
    assert_eq!(result["scenarios"]["soft"]["set"]["materials/0/mu1"], "90 kPa");
    for file in ["scenario_000_start.vtu", "scenario_001_start.vtu", "target.vtu"] {
        // the targets differ: each scenario has its own
        assert_eq!(place.path("out").join(file).exists(), file != "target.vtu", "{file}");
    }
    let collection = std::fs::read_to_string(place.path("out/scenarios.pvd")).unwrap();
    assert!(collection.contains("scenario_000_start.vtu") && collection.contains("scenario_001_start.vtu"));
}

#[test]
fn the_derivative_is_the_weighted_sum() {
    let place = CaseDirectory::new();
    let read = |set: &[&str], case: &str| -> Vec<f64> {
        place.run(Command::Gradient, case, set).unwrap();
        place.json("derivative.json")["tension"].as_array().unwrap().iter().map(|d| d.as_f64().unwrap()).collect()
    };
    let soft = read(&["materials/0/mu1=90 kPa"], BAR);
    let stiff = read(&["materials/0/mu1=120 kPa", "costs/0/target/2=Z + 0.12"], BAR);
    let both = read(&[], &robust());
    assert_eq!(both.len(), 20);
    for ((both, soft), stiff) in both.iter().zip(&soft).zip(&stiff) {
        let sum = 0.25 * soft + 0.75 * stiff;
        assert!((both - sum).abs() <= 1e-9 * sum.abs(), "{both:e} and {sum:e}");
    }
}

#[test]
fn every_risk_passes_the_taylor_test() {
    let place = CaseDirectory::new();
    for risk in [
        r#""mean""#,
        r#"{ "mean_deviation": { "lambda": 1 } }"#,
        r#"{ "cvar": { "level": 0.5, "smoothing": 0.2 } }"#,
        r#"{ "worst_case": { "smoothing": 0.2 } }"#,
    ] {
        let case = with(&robust(), r#""probes""#, &format!(r#""risk": {risk}, "probes""#));
        let outcome = place.run(Command::Gradcheck, &case, &[]).unwrap();
        assert_eq!(outcome.exit, Exit::Done, "{risk}");
        assert!(number(&outcome.result, "gradcheck/lowest_order") > 1.95, "{risk}");
        assert_eq!(outcome.result["gradcheck"]["tests"][0]["verdict"], "right", "{risk}");
        assert!(number(&outcome.result, "gradcheck/second/lowest_order") > 2.95, "{risk}");
        assert_eq!(outcome.result["gradcheck"]["tests"][0]["second"], "right", "{risk}");
    }
}

#[test]
fn optimize_serves_all_scenarios_and_writes_their_files() {
    let place = CaseDirectory::new();
    let text = place.text(Command::Optimize, &robust(), &[]);
    assert!(text.contains("soft ") && text.contains("probability 0.25"), "{text}");
    let result = place.json("result.json");
    assert!(number(&result, "cost/total") < number(&result, "start/cost/total"));
    for name in ["soft", "stiff"] {
        let own = format!("scenarios/{name}");
        assert!(number(&result, &format!("{own}/newton_iterations")) > 0.0);
        assert_eq!(number(&result, &format!("{own}/inertia")), 0.0);
        number(&result, &format!("start/{own}/cost/terms/tracking"));
        number(&result, &format!("{own}/reactions/x-/0"));
    }
    let total: f64 =
        ["soft", "stiff"].iter().map(|name| number(&result, &format!("scenarios/{name}/newton_iterations"))).sum();
    assert_eq!(number(&result, "newton_iterations"), total);
    for file in [
        "scenario_000_start.vtu",
        "scenario_000_optimum.vtu",
        "scenario_001_optimum.vtu",
        "mean_optimum.vtu",
        "iteration_0004.vtu",
        "scenario_001_target.vtu",
    ] {
        nastic_io::read_snapshot(place.path("out").join(file)).unwrap_or_else(|error| panic!("{file}: {error}"));
    }
    let optimum = nastic_io::read_snapshot(place.path("out/scenario_001_optimum.vtu")).unwrap();
    let points: Vec<&str> = optimum.point_data.iter().map(|a| a.name.as_str()).collect();
    assert_eq!(points, OPTIMUM_POINTS);
    assert!(std::fs::read_to_string(place.path("out/scenarios.pvd")).unwrap().contains("scenario_001_optimum.vtu"));
    let history = std::fs::read_to_string(place.path("out/history.jsonl")).unwrap();
    let last: Value = serde_json::from_str(history.lines().last().unwrap()).unwrap();
    assert_eq!(last["scenarios"].as_array().unwrap().len(), 2);
    // the mean is what was made small
    let (a, b) = (number(&result, "scenarios/soft/cost/total"), number(&result, "scenarios/stiff/cost/total"));
    assert!((number(&result, "cost/total") - 0.25 * a - 0.75 * b).abs() <= 1e-12 * a.max(b));
}

#[test]
fn threads_do_not_change_a_bit_of_an_ensemble() {
    let run = |threads: usize| {
        let place = CaseDirectory::new();
        let options = Options { threads: Some(threads), ..place.options(&["optimizer/max_iterations=2"]) };
        place.run_with(Command::Optimize, &robust(), &Console::silent(), &options).unwrap();
        let mut result = place.json("result.json");
        result
            .as_object_mut()
            .unwrap()
            .retain(|key, _| !["seconds", "threads", "peak_memory", "case"].contains(&key.as_str()));
        (result, std::fs::read(place.path("out/scenario_001_optimum.vtu")).unwrap())
    };
    assert_eq!(run(1), run(2));
}

#[test]
fn bounds_take_the_smallest_over_the_scenarios() {
    let place = CaseDirectory::new();
    let case = with(&robust(), r#", "upper": "100 kPa""#, "");
    let result = place.run(Command::Check, &case, &[]).unwrap().result;
    assert_eq!(number(&result, "controls/tension/upper"), 0.95 * 1.8e5);
    assert_eq!(number(&result, "actuation/0/fiber_limit"), 1.8e5);
    let found = common::warnings(&with(&robust(), r#""upper": "100 kPa""#, r#""upper": "190 kPa""#));
    assert!(found.contains("a tension of 190000 Pa exceeds 180000 Pa"), "{found}");
}

#[test]
fn load_cases_share_the_design_and_have_their_own_field() {
    let place = CaseDirectory::new();
    let text = place.text(Command::Check, MAGNET, &[]);
    assert!(text.contains("design: by cell, 8 unknowns of 3 components") && text.contains("shared by all"), "{text}");
    assert!(text.contains("own controls: up.field") && text.contains("own controls: down.magnet.field"), "{text}");

    let result = place.run(Command::Gradient, MAGNET, &[]).unwrap().result;
    let derivative = place.json("derivative.json");
    let keys: Vec<&String> = derivative.as_object().unwrap().keys().collect();
    assert_eq!(keys, ["design", "up.field", "down.magnet.field"]);
    let lengths: Vec<usize> = derivative.as_object().unwrap().values().map(|d| d.as_array().unwrap().len()).collect();
    assert_eq!(lengths, [24, 3, 3]);
    let (up, down) = (number(&result, "load_cases/up/cost/total"), number(&result, "load_cases/down/cost/total"));
    assert!((number(&result, "cost/total") - 2.0 * up - 0.5 * down).abs() <= 1e-14 * up.max(down));

    assert_eq!(place.run(Command::Gradcheck, MAGNET, &[]).unwrap().exit, Exit::Done);

    let result = place.run(Command::Optimize, MAGNET, &[]).unwrap().result;
    assert!(number(&result, "cost/total") < 0.5 * number(&result, "start/cost/total"), "{:#}", result["cost"]);
    for name in ["up", "down"] {
        let optimum = nastic_io::read_snapshot(place.path("out").join(format!("{name}_optimum.vtu"))).unwrap();
        for v in optimum.cell_array("design").unwrap().values.chunks(3) {
            let norm = v.iter().map(|x| x * x).sum::<f64>().sqrt();
            assert!((norm - 0.1).abs() < 1e-12, "{norm}");
        }
        nastic_io::read_snapshot(place.path("out").join(format!("{name}_target.vtu"))).unwrap();
        assert!(place.path("out").join(format!("{name}_picture.png")).exists());
    }
    let design = |name: &str| {
        let shot = nastic_io::read_snapshot(place.path("out").join(format!("{name}_optimum.vtu"))).unwrap();
        (shot.cell_array("design").unwrap().values.clone(), shot.cell_array("B_a").unwrap().values.clone())
    };
    assert_eq!(design("up").0, design("down").0, "one magnetisation");
    assert_ne!(design("up").1, design("down").1, "two fields");
}

#[test]
fn a_load_case_has_the_numbers_of_the_case_that_has_it_alone() {
    let place = CaseDirectory::new();
    let pushed = r#""load_cases": [ { "name": "pushed", "loads": [ { "surface": "x+", "traction": [0, 0, "-100 Pa"] } ],
        "supports": [ { "surface": "y-", "fix": ["y"] } ], "set": { "materials/0/mu1": "90 kPa" } },
        { "name": "none", "weight": 0 } ], "probes""#;
    let result = place.run(Command::Gradient, &with(BAR, r#""probes""#, pushed), &[]).unwrap().result;
    let alone =
        with(BAR, r#""fix": ["x", "y", "z"] }"#, r#""fix": ["x", "y", "z"] }, { "surface": "y-", "fix": ["y"] }"#);
    let loads = r#""loads": [ { "surface": "x+", "traction": [0, 0, "-100 Pa"] } ], "probes""#;
    let alone = with(&alone, r#""probes""#, loads);
    let alone = place.run(Command::Gradient, &alone, &["materials/0/mu1=90 kPa"]).unwrap().result;
    for key in ["cost/total", "potential", "probes/tip/displacement/2"] {
        assert_eq!(number(&result, &format!("load_cases/pushed/{key}")), number(&alone, key), "{key}");
    }
    assert!(result["load_cases"]["none"].is_null());
    assert!(
        result["warnings"][0]["message"].as_str().unwrap().contains("the load case is left out"),
        "{}",
        result["warnings"]
    );
}

#[test]
fn load_cases_stand_inside_scenarios() {
    let place = CaseDirectory::new();
    let scenarios = r#""scenarios": [ { "set": {} }, { "set": { "materials/0/mu": "250 kPa" } } ],
    "probes": [ { "name": "end", "point": [1.0, 0.25, 0.25] } ], "optimizer""#;
    let case = with(MAGNET, r#""optimizer""#, scenarios);
    let result = place.run(Command::Optimize, &case, &["optimizer/max_iterations=1"]).unwrap().result;
    let sum: f64 = ["0", "1"]
        .iter()
        .map(|s| {
            let own = |case: &str| number(&result, &format!("scenarios/{s}/load_cases/{case}/cost/total"));
            let scenario = number(&result, &format!("scenarios/{s}/cost/total"));
            assert!((scenario - 2.0 * own("up") - 0.5 * own("down")).abs() <= 1e-14 * scenario);
            0.5 * scenario
        })
        .sum();
    assert!((number(&result, "cost/total") - sum).abs() <= 1e-14 * sum);
    for (name, probe) in result["probes"]["down"].as_object().unwrap() {
        let path = format!("load_cases/down/probes/{name}/displacement/2");
        let mean: f64 = ["0", "1"].iter().map(|s| 0.5 * number(&result, &format!("scenarios/{s}/{path}"))).sum();
        assert!((number(probe, "displacement/2") - mean).abs() <= 1e-14 && number(probe, "deviation/2") > 0.0);
    }
    let svg = |name: &str| std::fs::read_to_string(place.path("out").join(name)).unwrap();
    let (together, up) = (svg("picture.svg"), svg("up_picture.svg"));
    assert!(together.contains("up<") && together.contains("down<") && !up.contains("down<"), "load cases side by side");
    assert!(
        up.contains("remanence") && up.contains("mean of the scenarios") && up.matches("1 iteration").count() == 1,
        "what is drawn"
    );
    assert!(up.contains("case: up: mean of the scenarios"), "no scenario is named");
    assert!(result["probes"]["down"].as_object().is_some_and(|probes| !probes.is_empty()));
    for file in [
        "scenario_000_up_optimum.vtu",
        "scenario_001_down_optimum.vtu",
        "up_scenarios.pvd",
        "down_mean_optimum.vtu",
        "up_target.vtu",
    ] {
        assert!(place.path("out").join(file).exists(), "{file}");
    }
}

#[test]
fn the_level_of_cvar_is_told() {
    let place = CaseDirectory::new();
    let case = with(
        BAR,
        r#""probes""#,
        r#""scenarios": [ { "set": {} }, { "set": { "materials/0/mu1": "90 kPa" } } ], "probes""#,
    );
    let set = ["risk={\"cvar\": {\"level\": 0.6}}", "optimizer/max_iterations=1"];
    let said = place.text(Command::Optimize, &case, &set);
    assert!(said.lines().any(|line| line.starts_with("risk ") && line.contains("cvar (level 0.6) ")), "{said}");
    assert_eq!(place.json("result.json")["risk"]["measures"]["cvar"]["level"], 0.6);
    let page = std::fs::read_to_string(place.path("out/report.html")).unwrap();
    assert!(page.contains("cvar (level 0.6)") && page.contains("Cost (cvar (level 0.6) over scenarios)"));
}

/// A rule over moduli, as in the survey.
const RANDOM: &str = r#""scenarios": { "random": [
    { "path": "materials/0/shear", "gamma": { "mean": "240 kPa", "deviation": "24 kPa" } },
    { "path": "materials/0/bulk", "uniform": { "lower": "500 kPa", "upper": "1 MPa" } },
    { "path": "costs/0/target/2", "lognormal": { "mean": "0.2 m", "deviation": "1 cm" } } ], "rule": { "gauss": 2 } },
  "probes""#;

fn random() -> String {
    let case = with(
        BAR,
        r#""mu1": "100 kPa", "mu2": "20 kPa", "mu3": "300 kPa""#,
        r#""shear": "240 kPa", "bulk": "760 kPa", "share": 0.5"#,
    );
    with(&case, r#""probes""#, RANDOM)
}

#[test]
fn rules_make_scenarios_of_random_parameters() {
    let place = CaseDirectory::new();
    let result = place.run(Command::Check, &random(), &[]).unwrap().result;
    let scenarios = result["scenarios"].as_object().unwrap();
    assert_eq!(scenarios.len(), 8);
    let expect = |of: &dyn Fn(f64) -> f64, path: &str| -> f64 {
        scenarios.values().map(|s| s["probability"].as_f64().unwrap() * of(s["set"][path].as_f64().unwrap())).sum()
    };
    // two Gauss points are exact up to the third moment
    let shear = "materials/0/shear";
    assert!((expect(&|x| x, shear) / 2.4e5 - 1.0).abs() < 1e-12);
    assert!((expect(&|x| (x - 2.4e5).powi(2), shear) / 2.4e4f64.powi(2) - 1.0).abs() < 1e-10);
    let bulk = "materials/0/bulk";
    assert!((expect(&|x| x, bulk) / 7.5e5 - 1.0).abs() < 1e-12);
    assert!((expect(&|x| (x - 7.5e5).powi(2), bulk) / (5e5f64.powi(2) / 12.0) - 1.0).abs() < 1e-10);
    // exp of a normal number is no polynomial
    assert!((expect(&|x| x, "costs/0/target/2") / 0.2 - 1.0).abs() < 1e-4);

    for (rule, count) in [
        (r#"{"sparse": 1}"#, 7),
        (r#"{"monte_carlo": 5}"#, 5),
        (r#"{"quasi_monte_carlo": 6}"#, 6),
        (r#"{"lattice": 8}"#, 8),
    ] {
        let set = format!("scenarios/rule={rule}");
        let first = place.run(Command::Check, &random(), &[&set]).unwrap().result;
        assert_eq!(first["scenarios"].as_object().unwrap().len(), count, "{rule}");
        let again = place.run(Command::Check, &random(), &[&set]).unwrap().result;
        assert_eq!(first["scenarios"], again["scenarios"], "the same seed");
        let other = place.run(Command::Check, &random(), &[&set, "scenarios/seed=1"]).unwrap().result;
        assert_eq!(first["scenarios"] == other["scenarios"], rule.contains("sparse"), "another seed: {rule}");
    }
    let found = problems(&with(&random(), r#"{ "gauss": 2 } }"#, r#"{ "sparse": 1 } }, "risk": { "worst_case": {} }"#));
    assert!(found.contains("risk: ") && found.contains("negative weights"), "{found}");
}

#[test]
fn nodes_that_are_no_material_are_named_or_left_out() {
    let wide = with(&random(), r#""lower": "500 kPa""#, r#""lower": "100 kPa""#);
    let found = problems(&wide);

    assert!(found.contains("scenarios/random: node 0 of 8 (probability 1."), "{found}");
    assert!(found.contains("materials/0/shear = 21") && found.contains("materials/0/bulk = 29"), "{found}");
    assert!(found.contains("mu3 = ") && found.contains(r#""inadmissible": "truncate""#), "{found}");
    let place = CaseDirectory::new();
    let cut = with(&wide, r#""rule""#, r#""inadmissible": "truncate", "rule""#);
    let result = place.run(Command::Check, &cut, &[]).unwrap().result;
    let scenarios = result["scenarios"].as_object().unwrap();
    assert!(!scenarios.is_empty() && scenarios.len() < 8);
    let sum: f64 = scenarios.values().map(|s| s["probability"].as_f64().unwrap()).sum();
    assert!((sum - 1.0).abs() < 1e-12);
    assert!(result["notes"][0].as_str().unwrap().contains("are no material and left out"), "{}", result["notes"]);
}

#[test]
fn a_parameter_may_be_a_random_field() {
    let place = CaseDirectory::new();
    let field = r#""scenarios": { "random": [ { "path": "materials/0/mu1",
        "lognormal": { "mean": "100 kPa", "deviation": "20 kPa", "length": "0.5 m", "modes": 2 } } ],
        "rule": { "gauss": 2 } }, "probes""#;
    let case = with(BAR, r#""probes""#, field);
    let result = place.run(Command::Gradient, &case, &[]).unwrap().result;
    assert_eq!(result["scenarios"].as_object().unwrap().len(), 4);
    assert!(result["notes"][0].as_str().unwrap().starts_with("materials/0/mu1: 2 modes hold "), "{}", result["notes"]);
    let costs: Vec<f64> = (0..4).map(|k| number(&result, &format!("scenarios/{k}/cost/total"))).collect();
    assert!(costs.windows(2).all(|pair| pair[0] != pair[1]), "{costs:?}");
    let elsewhere = with(&case, r#""path": "materials/0/mu1""#, r#""path": "costs/0/weight""#);
    let found = problems(&elsewhere);
    assert!(found.contains("a random field is possible for a parameter of a material alone"), "{found}");
}

#[test]
fn mistakes_in_scenarios_and_load_cases_are_told() {
    let found = problems(&with(&robust(), r#""name": "stiff""#, r#""name": "soft""#));
    assert!(found.contains(r#"scenarios/1: "soft" names a scenario already, at scenarios/0"#), "{found}");
    let found = problems(&with(&robust(), "0.75", "0.5"));
    assert!(found.contains("the probabilities add up to 0.75, not to 1"), "{found}");
    let found = problems(&with(&robust(), r#""materials/0/mu1": "90 kPa""#, r#""materials/0/mu7": "90 kPa""#));
    assert!(found.contains("unknown key \"mu7\""), "{found}");
    let found = problems(&with(&robust(), r#""materials/0/mu1": "90 kPa""#, r#""materials/0/mu1": "-90 kPa""#));
    assert!(found.contains("scenario \"soft\": ") || found.contains("greater than 0"), "{found}");
    let twice = with(MAGNET, r#""name": "down""#, r#""name": "up""#);
    assert!(problems(&twice).contains("\"up\" has a load case already"), "{}", problems(&twice));
}

#[test]
fn a_scenario_without_equilibrium_is_named() {
    let place = CaseDirectory::new();
    let set = r#""costs/0/target/2": "Z + 0.12" }"#;
    let torn = with(&robust(), set, r#""supports/1/displacement/x": -1.2 }"#);
    let pushed = r#""fix": ["x", "y", "z"] }, { "surface": "x+", "displacement": { "x": 0 } }"#;
    let torn = with(&torn, r#""fix": ["x", "y", "z"] }"#, pushed);
    for command in [Command::Solve, Command::Optimize] {
        let error = place.run(command, &torn, &[]).unwrap_err();
        assert_eq!(error.exit(), Exit::ForwardFailed);
        let described = error.to_string();
        assert!(
            described.starts_with("member 1 (scenario stiff): ") && described.contains("failure.vtu"),
            "{described}"
        );
    }
}

#[test]
fn several_starts_are_run_and_compared() {
    let place = CaseDirectory::new();
    let set = ["optimizer/starts=3", "optimizer/seed=4", "optimizer/max_iterations=3"];
    let text = place.text(Command::Optimize, MAGNET, &set);
    assert!(text.contains("start 2 of 3: random, seed 4000013"), "{text}");
    assert!(text.contains("(as written)") && text.contains(", the best"), "{text}");
    let result = place.json("result.json");
    let starts = result["starts"].as_array().unwrap();
    assert_eq!(starts.len(), 3);
    let costs: Vec<f64> = starts.iter().map(|start| start["cost"].as_f64().unwrap()).collect();
    let best = number(&result, "best_start") as usize;
    assert!(costs.iter().all(|cost| *cost >= costs[best]));
    assert_eq!(number(&result, "cost/total"), costs[best]);
    assert!(starts[0]["seed"].is_null() && starts[1]["seed"] == 4_000_013 && starts[1]["iterations"] == 3);
    assert_ne!(starts[1]["start_cost"], starts[2]["start_cost"]);
    // Three steps from random directions: three places.
    assert_eq!((number(&result, "minima"), &starts[best]["minimum"]), (3.0, &serde_json::json!(0)));
    assert!(number(&starts[best], "distance") == 0.0 && text.contains("minimum 2, its control "), "{text}");
    for start in starts.iter().filter(|start| start["minimum"] != 0) {
        assert!(number(start, "distance") > 0.05, "{start}");
    }
    assert_eq!(text.matches("gradient    right").count(), 3, "every start has its certificate: {text}");
    for check in [&result["gradient_check"], &starts[1]["gradient_check"], &starts[2]["gradient_check"]] {
        assert!(check["verdict"] == "right" && number(check, "mismatch") < 0.1, "{check}");
    }
    let again = place.run(Command::Optimize, MAGNET, &set).unwrap().result;
    assert_eq!(again["starts"], result["starts"], "the same seeds, the same bits");
    let plain =
        place.run(Command::Optimize, BAR, &["optimizer/starts=2", "optimizer/max_iterations=1"]).unwrap().result;
    assert_eq!(plain["starts"].as_array().unwrap().len(), 2);
    let hint = "vectors of given length often have several minima: --set optimizer/starts=4";
    assert!(place.text(Command::Optimize, MAGNET, &["optimizer/max_iterations=1"]).contains(hint));
    assert!(!place.text(Command::Optimize, BAR, &["optimizer/max_iterations=1"]).contains(hint));
    let unbounded = with(BAR, r#""lower": "-200 kPa", "#, "");
    let found = problems(&with(&unbounded, r#""max_iterations": 4"#, r#""max_iterations": 4, "starts": 2"#));
    assert!(found.contains("random starts (optimizer/starts) are drawn within the bounds: give \"lower\""), "{found}");
}

#[test]
fn an_amplitude_along_a_direction_is_a_scalar() {
    let place = CaseDirectory::new();
    let vector = r#""start": ["1 mT", 0, "20 mT"], "max_norm": "100 mT""#;
    let along = r#""direction": [0.6, 0, 0.8], "start": "20 mT", "lower": 0, "max_norm": "100 mT""#;
    let case = with(MAGNET, vector, along);
    let result = place.run(Command::Gradient, &case, &[]).unwrap().result;
    assert_eq!(number(&result, "controls/up.field/unknowns"), 1.0);
    let slope = place.json("derivative.json")["up.field"][0].as_f64().unwrap();
    let shot = nastic_io::read_snapshot(place.path("out/up_start.vtu")).unwrap();
    for (found, wanted) in shot.cell_array("B_a").unwrap().values[..3].iter().zip([0.012, 0.0, 0.016]) {
        assert!((found - wanted).abs() < 1e-15, "{found} and {wanted}");
    }
    // the same as the whole vector, and its derivative along the direction
    let whole = with(MAGNET, vector, r#""start": ["12 mT", 0, "16 mT"], "max_norm": "100 mT""#);
    let whole = place.run(Command::Gradient, &whole, &[]).unwrap().result;
    assert!((number(&whole, "cost/total") / number(&result, "cost/total") - 1.0).abs() < 1e-12);
    let d: Vec<f64> =
        place.json("derivative.json")["up.field"].as_array().unwrap().iter().map(|d| d.as_f64().unwrap()).collect();
    assert!((slope / (0.6 * d[0] + 0.8 * d[2]) - 1.0).abs() < 1e-9, "{slope:e} and {d:?}");
    assert_eq!(place.run(Command::Gradcheck, &case, &[]).unwrap().exit, Exit::Done);
    let check = place.run(Command::Check, &case, &[]).unwrap().result;
    assert_eq!((number(&check, "controls/up.field/lower"), number(&check, "controls/up.field/upper")), (0.0, 0.1));
    let found = problems(&with(&case, r#""lower": 0"#, r#""lower": "-1 T""#));
    assert!(found.contains("the bounds let the amplitude exceed the \"max_norm\" 0.1"), "{found}");
}
