//! Designs in cases: densities, fillers, mixtures and factors, what stands in front of controls, masses that follow, derivatives, messages for mistakes.

#![allow(clippy::unwrap_used)] // helpers of tests

use crate::common;

use common::{CaseDirectory, problems, with};
use nastic_case::lower::CaseProblem;
use nastic_language::schema::Command;
use nastic_language::syntax::Document;
use nastic_opt::{Objective, Request, Taylor, Verdict};
use serde_json::Value;
use std::fmt::Write;
use std::sync::Arc;

/// A cantilever whose density is unknown, as stiff as half of its material allows.
const CANTILEVER: &str = r#"{ "nastic": 1,
    "mesh": { "box": { "size": [0.1, 0.04], "cells": [10, 4], "element": "quad4" } },
    "regions": [ { "name": "tip", "inside": { "box": { "low": [0.09, 0, -1], "high": [0.1, 0.04, 1] } } } ],
    "materials": [ { "region": "body", "law": "neo_hooke", "young": "1 MPa", "poisson": 0.3,
                     "design": [ { "name": "rho", "kind": "density", "least": 1e-3 } ] } ],
    "supports": [ { "surface": "x-", "fix": "all" } ],
    "loads": [ { "surface": "x+", "traction": [0, "-500 Pa"] } ],
    "controls": [ { "of": "rho", "space": "cell", "start": 0.5, "filter": "10 mm", "symmetry": ["y"], "fixed": { "tip": 1 },
                    "projection": { "sharpness": [1, 4] } } ],
    "costs": [ { "kind": "tracking", "surface": "x+", "target": ["X", "Y"], "weight": 1e6 } ],
    "constraints": [ { "cost": { "kind": "design_volume", "of": "rho" }, "at_most": 0.5 } ],
    "probes": [ { "name": "end", "point": [0.1, 0.02] } ],
    "optimizer": { "method": "lbfgs", "max_iterations": 200, "tolerance": 1e-2 } }"#;

fn run(command: Command, text: &str) -> Value {
    CaseDirectory::new().run(command, text, &[]).unwrap().result
}

fn number(result: &Value, path: &str) -> f64 {
    nastic_run::result::find(result, path).unwrap().as_f64().unwrap()
}

/// A case without some of its blocks.
fn without(text: &str, blocks: &[&str]) -> String {
    let mut case: serde_json::Map<String, Value> = serde_json::from_str(text).unwrap();
    blocks.iter().for_each(|block| drop(case.remove(*block)));
    Value::Object(case).to_string()
}

/// The threshold of a projection distinguishes scenarios of one design: the worst of them is joined with its exact derivative.
#[test]
fn eroded_and_dilated_variants_share_a_design() {
    let varied = |path: &str| {
        let text = CANTILEVER.replace("\"costs\":", &format!("\"risk\": {{ \"worst_case\": {{}} }}, \"scenarios\": [ {{ \"name\": \"drawn\" }}, \
            {{ \"name\": \"eroded\", \"set\": {{ \"{path}\": 0.6 }} }}, {{ \"name\": \"dilated\", \"set\": {{ \"{path}\": 0.4 }} }} ], \"costs\":"));
        without(&text, &["constraints"])
    };
    let text = varied("controls/0/projection/eta");
    let checked = run(Command::Gradcheck, &text);
    assert!(checked["gradcheck"]["verdict"].as_str().is_some_and(|verdict| verdict.starts_with("right")), "{checked}");
    let found = run(Command::Solve, &text);
    let [drawn, eroded, dilated] =
        ["drawn", "eroded", "dilated"].map(|name| number(&found, &format!("scenarios/{name}/cost/total")));
    assert!(dilated < 0.9 * drawn && drawn < 0.9 * eroded, "{dilated} {drawn} {eroded}");
    let refused = problems(&varied("controls/0/filter"));
    assert!(refused.contains("\"controls\" cannot vary between scenarios or load cases"), "{refused}");
}

#[test]
fn a_density_finds_its_place_within_its_volume() {
    let place = CaseDirectory::new();
    let found = place.run(Command::Optimize, CANTILEVER, &[]).unwrap().result;
    let start = run(Command::Solve, CANTILEVER);
    let of = |result: &Value, key: &str| number(result, &format!("controls/rho/{key}"));
    assert!(of(&found, "volume") < 0.505 && of(&found, "volume") > 0.45, "{found}");
    assert!(of(&found, "greyness") < 0.9 * of(&start, "greyness"), "{} {}", found["controls"], start["controls"]);
    assert!(number(&found, "cost/total") < 0.6 * number(&start, "cost/total"), "{found}");
    assert!(of(&found, "min") >= 0.0 && of(&found, "max") <= 1.0, "{found}");
    // both stages were gone through, and the state of the second is that of its own projection
    let history = std::fs::read_to_string(place.path("out/history.jsonl")).unwrap();
    assert!(history.contains("\"stage\":1"), "{history}");
    // the field is drawn: held at the tip, symmetric
    let shown = nastic_io::read_snapshot(place.path("out/optimum.vtu")).unwrap();
    let rho = &shown.cell_data.iter().find(|array| array.name == "rho").unwrap().values;
    assert_eq!(rho.len(), 40);
    for (cell, value) in rho.iter().enumerate() {
        let mirrored = rho[(3 - cell / 10) * 10 + cell % 10];
        assert!((value - mirrored).abs() < 1e-9, "{cell}: {value} {mirrored}");
        assert!(cell % 10 < 9 || *value == 1.0, "{cell}: {value}");
    }
    // what is written is what another run starts from
    let again = with(
        CANTILEVER,
        "\"start\": 0.5",
        &format!("\"start\": {{ \"file\": {:?} }}", place.path("out/controls.json")),
    );
    let solved = run(Command::Solve, &with(&again, "[1, 4]", "4"));
    assert!((of(&solved, "volume") - of(&found, "volume")).abs() < 1e-12, "{solved}");
    let said = CaseDirectory::new().text(Command::Check, CANTILEVER, &[]);
    for words in [
        "design rho: density by simp (p = 3, least 0.001)",
        "polyconvex at every fixed design",
        "1 in tip, symmetric about 1 plane, filtered over 0.01 m, projected about 0.5 with sharpness 1, then 4",
    ] {
        assert!(said.contains(words), "{words}: {said}");
    }
}

/// Half the density of a law that is linear in it is half the modulus, weighs half and moves as half the mass does; a mixture lies between.
#[test]
fn stiffness_weight_and_mass_follow() {
    let base = without(CANTILEVER, &["controls", "constraints", "loads", "regions", "costs", "optimizer"]);
    let heavy = with(
        &base,
        "\"materials\":[{",
        "\"loads\":[{\"gravity\":[0,\"-9.81 m/s^2\"]}],\"materials\":[{\"density\":\"1000 kg/m^3\",",
    );
    let control = r#""controls":[{"of":"rho","space":"cell","start":0.5}],"#;
    let half = with(&heavy, "\"least\":0.001", "\"least\":1e-9,\"power\":1").replacen('{', &format!("{{{control}"), 1);
    let plain = without_design(&heavy).replace("1 MPa", "500 kPa").replace("1000 kg/m^3", "500 kg/m^3");
    let moving = r#""time":{"end":"20 ms","step":"2 ms","start":"rest"},"#;
    for time in ["", moving] {
        let in_time = |case: &str| run(Command::Solve, &case.replacen('{', &format!("{{{time}"), 1));
        let ends = [&half, &plain].map(|case| in_time(case)["probes"]["end"]["displacement"][1].as_f64().unwrap());
        assert!(ends[0] < -1e-6 && (ends[0] / ends[1] - 1.0).abs() < 1e-6, "{time} {ends:?}");
    }
    // stiffness alone
    let still = with(&half, "\"kind\":\"density\"", "\"kind\":\"density\",\"mass\":false");
    let full = plain.replace("500 kg/m^3", "1000 kg/m^3");
    let ends =
        [&still, &full].map(|case| run(Command::Solve, case)["probes"]["end"]["displacement"][1].as_f64().unwrap());
    assert!((ends[0] / ends[1] - 1.0).abs() < 1e-6, "{ends:?}");
    // a mixture of two laws of one kind is that of the mean moduli and of the mean mass
    let other = r#""kind":"mixture","with":{"law":"neo_hooke","young":"3 MPa","poisson":0.3,"density":"2000 kg/m^3"}"#;
    let mixed = with(&half, r#""kind":"density","least":1e-9,"power":1"#, other);
    let mean = plain.replace("500 kPa", "2 MPa").replace("500 kg/m^3", "1500 kg/m^3");
    let ends =
        [&mixed, &mean].map(|case| run(Command::Solve, case)["probes"]["end"]["displacement"][1].as_f64().unwrap());
    assert!((ends[0] / ends[1] - 1.0).abs() < 1e-6, "{ends:?}");
}

fn without_design(text: &str) -> String {
    let mut case: Value = serde_json::from_str(text).unwrap();
    case["materials"][0].as_object_mut().unwrap().remove("design");
    case.to_string()
}

/// Nine squares without the middle one, whose walls are "inner"; the left column is "root", the others are "arm".
fn hollow() -> String {
    let mut out = String::from(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n5\n1 1 \"x-\"\n1 2 \"x+\"\n1 3 \"inner\"\n2 4 \"root\"\n2 5 \"arm\"\n$EndPhysicalNames\n$Nodes\n16\n",
    );
    let node = |i: usize, j: usize| 1 + i + 4 * j;
    for (i, j) in (0..16).map(|k| (k % 4, k / 4)) {
        writeln!(out, "{} {} {} 0", node(i, j), i as f64 / 30.0, j as f64 / 30.0).unwrap();
    }
    let mut elements = Vec::new();
    for (i, j) in (0..9).map(|k| (k % 3, k / 3)).filter(|at| *at != (1, 1)) {
        let corners = [node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)];
        elements.push((3, if i == 0 { 4 } else { 5 }, corners.to_vec()));
    }
    for j in 0..3 {
        elements.push((1, 1, vec![node(0, j), node(0, j + 1)]));
        elements.push((1, 2, vec![node(3, j), node(3, j + 1)]));
    }
    let ring = [(1, 1), (2, 1), (2, 2), (1, 2), (1, 1)];
    elements.extend(ring.windows(2).map(|pair| (1, 3, vec![node(pair[0].0, pair[0].1), node(pair[1].0, pair[1].1)])));
    writeln!(out, "$EndNodes\n$Elements\n{}", elements.len()).unwrap();
    for (k, (kind, tag, nodes)) in elements.iter().enumerate() {
        let nodes: Vec<String> = nodes.iter().map(ToString::to_string).collect();
        writeln!(out, "{} {kind} 2 {tag} {tag} {}", k + 1, nodes.join(" ")).unwrap();
    }
    out + "$EndElements\n"
}

/// A density that a filler, the fibres and the mass share, a mixture, and a tension and a chamber beside; the tension is filtered and projected too.
const ALL: &str = r#"{ "nastic": 1, "mesh": "hollow.msh",
    "materials": [ { "name": "rubber", "region": "arm", "law": "neo_hooke", "young": "300 kPa", "poisson": 0.3, "density": "1000 kg/m^3",
                     "design": [ { "name": "rho", "kind": "density", "interpolation": "ramp", "least": 1e-3 },
                                 { "name": "phi", "kind": "filler", "interpolation": "guth" } ] },
                   { "region": "root", "law": "neo_hooke", "young": "200 kPa", "poisson": 0.3, "density": "900 kg/m^3",
                     "design": [ { "name": "w", "kind": "mixture",
                                   "with": { "law": "neo_hooke", "young": "300 kPa", "poisson": 0.3, "density": "1000 kg/m^3" } } ] } ],
    "supports": [ { "surface": "x-", "fix": "all" } ],
    "loads": [ { "gravity": [0, "-9.81 m/s^2"] } ],
    "actuation": [ { "name": "fibers", "kind": "fiber_tension", "region": "arm", "direction": [1, 0, 0],
                     "design": [ { "name": "rho", "kind": "factor" } ] },
                   { "name": "air", "kind": "cavity", "surface": "inner" } ],
    "controls": [ { "of": "rho", "space": "cell", "start": "0.6 + X / (0.5 m)", "filter": "20 mm", "projection": { "eta": 0.4, "sharpness": SHARPNESS } },
                  { "of": "phi", "space": "node", "start": 0.1, "upper": 0.3, "filter": "15 mm" },
                  { "of": "w", "space": "cell", "start": 0.3 },
                  { "of": "fibers", "space": "node", "start": "-20 kPa", "lower": "-60 kPa", "upper": 0, "filter": "20 mm",
                    "projection": { "sharpness": 2 } },
                  { "of": "air", "space": "uniform", "start": "1 kPa", "lower": 0, "upper": "4 kPa" } ],
    "costs": [ { "kind": "tracking", "surface": "x+", "target": ["0.95 * X", "Y + 10 mm"], "weight": 1e3 },
               { "kind": "design_volume", "of": "rho", "weight": 1e-3 }, { "kind": "greyness", "of": "rho", "weight": 1e-3 },
               { "kind": "displacement", "point": [0.1, 0.05], "direction": [0.6, -0.8], "weight": 0.01 },
               { "kind": "greyness", "of": "w", "weight": 1e-4 } ],
    "optimizer": { "method": "newton_cg" } }"#;

#[test]
fn derivatives_through_filters_and_projections_have_their_orders() {
    let place = CaseDirectory::new();
    place.write("hollow.msh", &hollow());
    for sharpness in ["2", "[1, 2]"] {
        let text = ALL.replace("SHARPNESS", sharpness);
        let name = place.path("case.json").display().to_string();
        let lowered = CaseProblem::lower(Document::parse(&name, &text).unwrap(), Arc::default()).unwrap();
        for stage in 0..lowered.ensemble.stages() {
            let taylor = Taylor { directions: 2, second: true, stage, ..Taylor::default() };
            let report = taylor.test(&lowered.ensemble, &lowered.set, &lowered.start).unwrap();
            assert!(report.passed(), "{report}");
            for direction in &report.directions {
                let second = direction.second.as_ref().unwrap();
                let quadratic = second.verdict == Verdict::Quadratic;
                assert!(direction.order1 > 1.95 && (quadratic || second.order > 2.95), "{direction:?}");
            }
        }
    }
    a_new_stage_has_a_state_of_its_own(&place);
    let moving = with(
        &ALL.replace("SHARPNESS", "2"),
        "\"optimizer\": { \"method\": \"newton_cg\" }",
        "\"time\": { \"end\": \"20 ms\", \"step\": \"5 ms\", \"start\": \"rest\" }, \"optimizer\": { \"method\": \"lbfgs\" }",
    );
    let checked = place.run(Command::Gradcheck, &moving, &[]).unwrap().result;
    assert_eq!(checked["gradcheck"]["passed"], true, "{checked}");
}

/// A design of two stages has in the second one the cost of a design of that sharpness alone.
fn a_new_stage_has_a_state_of_its_own(place: &CaseDirectory) {
    let costs = [("[1, 3]", 1), ("3", 0)].map(|(sharpness, stage)| {
        let text = ALL.replace("SHARPNESS", sharpness);
        let name = place.path("case.json").display().to_string();
        let CaseProblem { ensemble, start, .. } =
            CaseProblem::lower(Document::parse(&name, &text).unwrap(), Arc::default()).unwrap();
        let point = ensemble.evaluate(&start, &Request::default(), &mut Default::default()).unwrap();
        let first = ensemble.value(&point);
        (first, ensemble.value(&ensemble.restage(stage, &point).unwrap()))
    });
    assert!((costs[0].1 / costs[1].1 - 1.0).abs() < 1e-7 && (costs[0].0 / costs[0].1 - 1.0).abs() > 1e-4, "{costs:?}");
}

#[test]
fn mistakes_of_designs_are_told_where_they_stand() {
    let control = r#""fixed": { "tip": 1 },
                    "projection": { "sharpness": [1, 4] }"#;
    for (from, to, told) in [
        ("\"at_most\": 0.5", "\"at_most\": 0.05", "constraints/0/at_most: 0.05 cannot be met"),
        (
            "\"least\": 1e-3 }",
            "\"least\": 1e-3 }, { \"name\": \"rho\", \"kind\": \"filler\" }",
            "stands in front of this law already",
        ),
        ("\"start\": 0.5", "\"start\": 0.5, \"upper\": 1.5", "1.5 lies outside what this design may be, 0 to 1"),
        ("\"start\": 0.5", "\"start\": 1.5", "controls/0/start: the start 1.5"),
        ("\"least\": 1e-3", "\"least\": 1.5", "materials/0/design/0/least"),
        ("\"least\": 1e-3", "\"power\": 1.5", "materials/0/design/0/power"),
        ("\"least\": 1e-3", "\"interpolation\": \"hill\"", "a density is not interpolated by \"hill\""),
        ("\"kind\": \"density\", \"least\": 1e-3", "\"kind\": \"factor\"", "take \"density\""),
        ("\"kind\": \"density\", \"least\": 1e-3", "\"kind\": \"mixture\"", "missing key \"with\""),
        (
            "\"kind\": \"density\", \"least\": 1e-3",
            "\"kind\": \"mixture\", \"with\": \"stiff\"",
            "no material \"stiff\"",
        ),
        (
            "\"kind\": \"density\", \"least\": 1e-3",
            "\"kind\": \"filler\"",
            "1 lies outside what \"rho\" may be, 0 to 0.74",
        ),
        ("\"of\": \"rho\", \"space\"", "\"of\": \"roh\", \"space\"", "did you mean \"rho\"?"),
        ("\"start\": 0.5", "\"start\": 0.5, \"log\": true", "it has no logarithm"),
        (
            "\"symmetry\": [\"y\"]",
            "\"symmetry\": [{ \"point\": [0, 0.013], \"normal\": [0, 1] }]",
            "the mesh is not symmetric",
        ),
        ("\"fixed\": { \"tip\": 1 }", "\"fixed\": { \"tip\": 2 }", "2 lies outside what \"rho\" may be"),
        ("\"fixed\": { \"tip\": 1 }", "\"fixed\": { \"top\": 1 }", "controls/0/fixed/top"),
        ("\"sharpness\": [1, 4]", "\"sharpness\": []", "at least one sharpness is needed"),
        ("\"sharpness\": [1, 4]", "\"eta\": 1.5, \"sharpness\": 1", "the threshold 1.5"),
        ("\"space\": \"cell\"", "\"space\": \"uniform\"", "not in \"uniform\""),
        (
            "{ \"cost\": { \"kind\": \"design_volume\", \"of\": \"rho\" }",
            "{ \"kind\": \"design_volume\", \"of\": \"rho\"",
            "stands under \"cost\"",
        ),
        ("\"poisson\": 0.3,", "\"poisson\": 0.3, \"kelvin_voigt\": { \"shear\": 1 },", "does not follow its designs"),
        (control, "\"projection\": { \"sharpness\": [1, 4] }", ""),
    ] {
        let said = CaseDirectory::new().run(Command::Check, &with(CANTILEVER, from, to), &[]);
        match told {
            "" => drop(said.unwrap()),
            told => {
                let error = said.unwrap_err().to_string();
                assert!(error.contains(told), "{from} -> {to}: {error}");
            }
        }
    }
    let filled = with(CANTILEVER, "\"kind\": \"density\", \"least\": 1e-3", "\"kind\": \"filler\"");
    let told = problems(&with(&filled, control, "\"name\": \"rho\""));
    assert!(told.contains("controls/0: a filler needs an \"upper\" bound, below 0.74"), "{told}");
    let moving = "{ \"time\": { \"end\": \"20 ms\", \"step\": \"10 ms\", \"start\": \"rest\" }, ";
    let heavy = with(CANTILEVER, "\"poisson\": 0.3,", "\"poisson\": 0.3, \"density\": \"1000 kg/m^3\",")
        .replacen('{', moving, 1);
    let told = problems(&heavy);
    assert!(told.contains("has 2 stages, which a motion has not: give one, of a projection one sharpness"), "{told}");
    let lumped = with(&heavy, "\"start\": \"rest\"", "\"start\": \"rest\", \"mass\": \"lumped\"");
    assert!(
        problems(&lumped).contains("a mass that follows a design or a shape is consistent"),
        "{}",
        problems(&lumped)
    );
    let told = problems(&without(CANTILEVER, &["controls", "constraints"]));
    assert!(told.contains("nothing says what \"rho\" is: give a control"), "{told}");
    let fine = CaseDirectory::new().text(
        Command::Check,
        &with(CANTILEVER, "\"filter\": \"10 mm\"", "\"filter\": \"2 mm\""),
        &[],
    );
    assert!(fine.contains("a length of 0.002 m smooths nothing: the unknowns lie 0.01 m apart"), "{fine}");
}

/// Of a law without an energy, of a projection without ends, of what an actuation cannot take.
#[test]
fn mistakes_beside_materials_are_told() {
    let growth = r#"{ "nastic": 1, "mesh": { "box": { "size": [0.1, 0.04], "cells": [4, 2], "element": "quad4" } },
        "materials": [ { "region": "body", "law": "neo_hooke", "young": "1 MPa", "poisson": 0.3 } ],
        "supports": [ { "surface": "x-", "fix": "all" } ],
        "actuation": [ { "name": "swell", "kind": "growth", "region": "body", "growth": 0.1, "design": [ { "name": "rho", "kind": "factor" } ] } ],
        "controls": [ { "of": "rho", "space": "cell" } ], "costs": [ { "kind": "position", "surface": "x+", "target": { "x": 0.12 } } ] }"#;
    let told = problems(growth);
    assert!(
        told.contains("actuation/0/design/0: factor cannot stand around this law: it has no energy of its own"),
        "{told}"
    );
    let fibers = growth
        .replace("\"swell\", \"kind\": \"growth\"", "\"swell\", \"kind\": \"fiber_tension\", \"direction\": [1, 0, 0]")
        .replace(", \"growth\": 0.1", "");
    let alone = fibers.replace(", \"design\": [ { \"name\": \"rho\", \"kind\": \"factor\" } ]", "").replace(
        "\"of\": \"rho\", \"space\": \"cell\"",
        "\"of\": \"swell\", \"space\": \"cell\", \"lower\": \"-1 kPa\", \"projection\": { \"sharpness\": 2 }",
    );
    let told = problems(&alone);
    assert!(told.contains("a projection goes from the lower end of a control to the upper one"), "{told}");
    let mixed = fibers.replace(
        "\"kind\": \"factor\"",
        "\"kind\": \"mixture\", \"with\": { \"law\": \"neo_hooke\", \"young\": 1, \"poisson\": 0.3 }",
    );
    let told = problems(&mixed);
    assert!(told.contains("an actuation takes \"factor\""), "{told}");
}

/// The restorative magnetic beam of the open code MatTO on 12 x 3 cells: its first cost, sum of int t . u in kPa mm^2, as an independent program has reproduced it.
const RESTORATIVE: &str = r#"{ "nastic": 1,
    "mesh": { "box": { "size": [0.1, 0.02], "cells": [12, 3], "element": "quad4" } },
    "regions": [ { "name": "again", "inside": { "box": { "low": [0, 0, -1], "high": [0.1, 0.02, 1] } } } ],
    "materials": [
      { "region": "body", "law": "formula", "energy": "mu / 2 * (I1 - 3 - 2 * log(J))", "parameters": { "mu": "100 kPa" },
        "design": [ { "name": "rho", "kind": "density" }, { "name": "phi", "kind": "filler" } ] },
      { "region": "again", "law": "formula", "energy": "k / 2 * (J - 1)^2", "parameters": { "k": "50 MPa" },
        "design": [ { "name": "rho", "kind": "density" } ] } ],
    "supports": [ { "surface": "x-", "fix": "all" } ],
    "loads": [ { "surface": "x+", "traction": [0, "-500 Pa"] } ],
    "actuation": [ { "name": "magnet", "kind": "magnet", "region": "body", "field": [0, "25 mT"], "mu0": 1.256e-6,
                     "design": [ { "name": "rho", "kind": "factor" }, { "name": "phi", "kind": "factor" } ] } ],
    "controls": [ { "of": "rho", "space": "cell", "start": 0.5, "lower": 0.05, "filter": "1 mm", "projection": { "sharpness": [1, 2, 4] } },
                  { "of": "phi", "space": "cell", "start": 0.1, "upper": 0.3, "filter": "1 mm" },
                  { "of": "magnet.remanence", "space": "cell", "start": ["200 mT", 0], "norm": "200 mT", "filter": "1 mm" } ],
    "load_cases": [
      { "name": "down", "costs": [ { "kind": "displacement", "surface": "x+", "direction": [0, -1], "weight": 1e4 } ] },
      { "name": "up", "set": { "loads/0/traction": [0, "500 Pa"], "actuation/0/field": [0, "-25 mT"] },
        "costs": [ { "kind": "displacement", "surface": "x+", "direction": [0, 1], "weight": 1e4 } ] } ],
    "constraints": [ { "cost": { "kind": "design_volume", "of": "rho" }, "at_most": 0.5 },
                     { "cost": { "kind": "design_volume", "of": "phi" }, "at_most": 0.1 } ],
    "optimizer": { "method": "lbfgs" } }"#;

#[test]
fn the_restorative_beam_has_its_published_first_cost() {
    let found = run(Command::Solve, RESTORATIVE);
    let cost = number(&found, "cost/total");
    assert!((cost / 102.2291613 - 1.0).abs() < 1e-7, "{cost}");
    for (field, volume) in [("rho", 0.5), ("phi", 0.1)] {
        assert!((number(&found, &format!("controls/{field}/volume")) - volume).abs() < 1e-12, "{found}");
    }
    let checked = run(Command::Gradcheck, RESTORATIVE);
    assert_eq!(checked["gradcheck"]["passed"], true, "{checked}");
}
