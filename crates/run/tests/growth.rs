//! Growth in cases: what it takes, what is said of values that leave nothing, where fixed growth is drawn, energies.

#![allow(clippy::unwrap_used)] // helpers of tests

use crate::common;

use common::{CaseDirectory, problems, warnings, with};
use nastic_language::schema::Command;
use nastic_opt::{Objective, Request};
use serde_json::Value;

/// A bar that grows freely, of which an end is tracked.
const BAR: &str = r#"{ "nastic": 1,
    "mesh": { "box": { "size": [0.1, 0.02, 0.02], "cells": [4, 1, 1], "element": "hex8" } },
    "regions": [ { "name": "end", "inside": { "box": { "low": [0.05, 0, 0], "high": [0.1, 0.02, 0.02] } } } ],
    "materials": [ { "region": "body", "law": "neo_hooke", "young": "300 kPa", "poisson": 0.4 } ],
    "supports": [ { "surface": "x-", "fix": "x" }, { "surface": "y-", "fix": "y" }, { "surface": "z-", "fix": "z" } ],
    "actuation": [ { "name": "swell", "kind": "growth", "region": "body" } ],
    "controls": [ { "of": "swell", "space": "uniform", "start": 0.1, "upper": 0.5 } ],
    "costs": [ { "kind": "position", "surface": "x+", "target": { "x": 0.12 } } ],
    "optimizer": { "method": "lbfgs" } }"#;

fn run(command: Command, text: &str) -> Value {
    CaseDirectory::new().run(command, text, &[]).unwrap().result
}

fn number(result: &Value, path: &str) -> f64 {
    nastic_run::result::find(result, path).unwrap().as_f64().unwrap()
}

#[test]
fn a_bar_grows_to_its_target_and_stores_nothing() {
    let found = run(Command::Optimize, BAR);
    assert!((number(&found, "controls/swell/max") - 0.2).abs() < 1e-5, "{found}");
    assert!((number(&found, "controls/swell/lower") + 0.9).abs() < 1e-12, "{found}");
    let fixed = with(BAR, "\"region\": \"body\" } ]", "\"region\": \"body\", \"growth\": 0.1 } ]");
    let (from, to) = (fixed.find("\"controls\"").unwrap(), fixed.find("\"optimizer\"").unwrap());
    let solved = run(Command::Solve, &format!("{}{}", &fixed[..from], &fixed[to..]));
    assert!(number(&solved, "energy/elastic").abs() < 1e-10 && number(&solved, "min_J") > 1.3, "{solved}");
    // a logarithm keeps it positive by itself
    let by_log = run(Command::Optimize, &with(BAR, "\"start\": 0.1", "\"log\": true, \"start\": 0.1"));
    assert!((number(&by_log, "controls/swell/max") - 0.2).abs() < 1e-5, "{by_log}");
    let said = CaseDirectory::new().text(Command::Check, BAR, &[]);
    assert!(said.contains("start 0.1, within [-0.9, 0.5]"), "{said}");
}

#[test]
fn what_leaves_nothing_is_refused_where_it_stands() {
    let must = "growth must stay above -1";
    let lower = problems(&with(BAR, "\"start\": 0.1", "\"lower\": -1.5, \"start\": 0.1"));
    assert!(lower.contains(&format!("controls/0/lower: {must}")), "{lower}");
    let fixed = with(BAR, "\"region\": \"body\" } ]", "\"region\": \"body\", \"growth\": -1.2 } ]");
    let (from, to) = (fixed.find("\"controls\"").unwrap(), fixed.find("\"costs\"").unwrap());
    let fixed = problems(&format!("{}{}", &fixed[..from], &fixed[to..]));
    assert!(fixed.contains(&format!("actuation/0/growth: {must}")), "{fixed}");
    let pumped = with(
        BAR,
        "\"kind\": \"position\", \"surface\": \"x+\", \"target\": { \"x\": 0.12 }",
        "\"kind\": \"pump_work\"",
    );
    let pumped = problems(&pumped);
    assert!(pumped.contains("does not count that of a growth"), "{pumped}");
}

/// In cells outside of its region it is zero, though the field of the case has values everywhere.
#[test]
fn fixed_growth_is_drawn_where_it_acts() {
    let fixed = with(BAR, "\"region\": \"body\" } ]", "\"region\": \"end\", \"growth\": \"0.1 + X / 1 m\" } ]");
    let (from, to) = (fixed.find("\"controls\"").unwrap(), fixed.find("\"optimizer\"").unwrap());
    let place = CaseDirectory::new();
    place.run(Command::Solve, &format!("{}{}", &fixed[..from], &fixed[to..]), &[]).unwrap();
    let shown = nastic_io::read_snapshot(place.path("out/start.vtu")).unwrap();
    let growth = shown.cell_data.iter().find(|array| array.name == "swell").unwrap();
    let inside: Vec<bool> = growth.values.iter().map(|value| *value > 0.1).collect();
    assert_eq!(inside, [false, false, true, true], "{:?}", growth.values);
    assert!(growth.values[..2].iter().all(|value| *value == 0.0), "{:?}", growth.values);
}

/// A bar with this actuation, controls and cost.
fn bar(actuation: &str, controls: &str, cost: &str) -> String {
    let (from, to) = (BAR.find("\"actuation\"").unwrap(), BAR.find("\"optimizer\"").unwrap());
    let blocks = format!(
        r#""actuation": [ {{ "name": "swell", "region": "body", {actuation} }} ], "controls": [ {controls} ], "costs": [ {cost} ], "#
    );
    format!("{}{blocks}{}", &BAR[..from], &BAR[to..])
}

fn towards(x: f64) -> String {
    format!(r#"{{ "kind": "position", "surface": "x+", "target": {{ "x": {x} }} }}"#)
}

/// Each kind reaches the length that its formula gives, and the volume that follows.
#[test]
fn a_free_bar_takes_what_each_kind_says() {
    let heat = r#""kind": "heat", "expansion": "2e-3 / K""#;
    let heated = |more: &str| bar(heat, &format!(r#"{{ "of": "swell", "space": "uniform"{more} }}"#), &towards(0.12));
    let found = run(Command::Optimize, &heated(r#", "start": "10 K", "lower": "-100 K", "upper": "200 K""#));
    assert!((number(&found, "controls/swell/max") - 100.0).abs() < 1e-2, "{found}");
    assert!((number(&found, "min_J") - 1.2f64.powi(3)).abs() < 1e-4, "{found}");
    assert_eq!(nastic_run::result::find(&found, "controls/swell/unit").unwrap(), "K");
    // by a part that shrinks as the other grows
    for (kind, part, volume) in [
        (r#""kind": "heat", "expansion_along": "2e-3 / K", "expansion_across": 0, "direction": "x""#, 100.0, 1.2),
        (r#""kind": "lce", "direction": "x""#, 0.2, 1.0),
    ] {
        let text = bar(kind, r#"{ "of": "swell", "space": "uniform", "lower": -0.3, "upper": 150 }"#, &towards(0.12));
        let found = run(Command::Optimize, &text);
        assert!((number(&found, "controls/swell/max") / part - 1.0).abs() < 1e-4, "{kind}: {found}");
        assert!((number(&found, "min_J") - volume).abs() < 1e-4, "{kind}: {found}");
    }
    let muscle =
        bar(r#""kind": "active_strain", "direction": "x""#, r#"{ "of": "swell", "space": "uniform" }"#, &towards(0.08));
    let found = run(Command::Optimize, &muscle);
    assert!((number(&found, "controls/swell/max") - 0.2).abs() < 1e-5, "{found}");
    let bounds = ["lower", "upper"].map(|key| number(&found, &format!("controls/swell/{key}")));
    assert_eq!(bounds, [0.0, 0.9]);
    // one entry of a tensor is a control, another one is fixed, the others are zero
    let tensor = bar(
        r#""kind": "growth_tensor", "yy": 0.1"#,
        r#"{ "of": "swell.xx", "space": "uniform", "upper": 1 }"#,
        &towards(0.12),
    );
    let found = run(Command::Optimize, &tensor);
    assert!((number(&found, "controls/swell.xx/max") - 0.2).abs() < 1e-4, "{found}");
    assert!((number(&found, "min_J") - 1.2 * 1.1).abs() < 1e-4, "{found}");
}

/// Two layers with moduli of 1 : 10, of which one is heated: Timoshenko's curvature `0.995851 e / h` for m = 1, n = 10, in plane strain by `1 + nu` more; nearly
/// incompressible layers too, without locking.
///
/// Source: S. Timoshenko, "Analysis of bi-metal thermostats", J. Opt. Soc. Am. 11 (1925) 233-255.
#[test]
fn unlike_layers_curve_as_a_bimetal() {
    let case = r#"{ "nastic": 1,
        "mesh": { "box": { "size": [1, 0.025], "cells": [80, 2], "element": "quad9" } },
        "regions": [ { "name": "hot", "inside": { "box": { "low": [0, 0.0125, -1], "high": [1, 0.025, 1] } } },
                     { "name": "cold", "inside": { "box": { "low": [0, 0, -1], "high": [1, 0.0125, 1] } } } ],
        "materials": [ { "region": "hot", "law": "neo_hooke", "young": "1 MPa", "poisson": 0.3 },
                       { "region": "cold", "law": "neo_hooke", "young": "10 MPa", "poisson": 0.3 } ],
        "supports": [ { "surface": "x-", "fix": "all" } ],
        "actuation": [ { "name": "heat", "kind": "heat", "expansion": "1e-5 / K", "region": "hot", "temperature": "100 K" } ],
        "probes": [ { "name": "a", "point": [0.2, 0.0125] }, { "name": "b", "point": [0.5, 0.0125] }, { "name": "c", "point": [0.8, 0.0125] } ] }"#;
    for (nu, formulation) in [(0.3, "standard"), (0.4999, "linear_dilatation")] {
        let number = format!("\"poisson\": {nu}, \"formulation\": \"{formulation}\"");
        let found = run(Command::Solve, &case.replace("\"poisson\": 0.3", &number));
        let [a, b, c] = ["a", "b", "c"].map(|p| number_at(&found, p));
        let (e, h) = (1e-3, 0.025);
        let kappa = 0.995851 * e * (1.0 + nu) / h;
        let curvature = -(a - 2.0 * b + c) / 0.09;
        assert!((curvature / kappa - 1.0).abs() < 0.01, "{nu}: {curvature} for {kappa}");
    }
}

/// The displacement of a probe along y.
fn number_at(result: &Value, probe: &str) -> f64 {
    nastic_run::result::find(result, &format!("probes/{probe}/displacement")).unwrap()[1].as_f64().unwrap()
}

/// What leaves nothing, what is no temperature, a direction that is none: each in one sentence, where it stands.
#[test]
fn mistakes_of_the_kinds_are_told_where_they_stand() {
    let said = |actuation: &str, controls: &str, at: &str, why: &str| {
        let found = problems(&bar(actuation, controls, &towards(0.12)));
        assert!(found.contains(&format!("{at}: {why}")), "{at}: {why}\n{found}");
    };
    let heat = |more: &str| format!(r#""kind": "heat", "expansion": "2e-3 / K"{more}"#);
    let control = |more: &str| format!(r#"{{ "of": "swell", "space": "uniform"{more} }}"#);
    said(
        &heat(""),
        &control(r#", "lower": "-600 K", "upper": "10 K""#),
        "controls/0/lower",
        "1 + expansion * temperature",
    );
    said(&heat(r#", "temperature": "-600 K""#), "", "actuation/0/temperature", "1 + expansion * temperature");
    said(&heat(r#", "temperature": "60 kPa""#), "", "actuation/0/temperature", "");
    for wrong in ["60 kPa", "60 degC", "60 °C"] {
        let found = problems(&bar(&heat(&format!(r#", "temperature": "{wrong}""#)), "", &towards(0.12)));
        assert!(
            found.contains("a temperature difference is wanted") || found.contains("the same number: \"60 K\""),
            "{found}"
        );
    }
    said(r#""kind": "heat", "expansion": "2e-3 K", "temperature": "60 K""#, "", "actuation/0/expansion", "");
    said(r#""kind": "lce", "strain": -0.2"#, "", "actuation/0", "missing key \"direction\"");
    said(r#""kind": "lce", "direction": "x", "strain": -1"#, "", "actuation/0/strain", "strain must stay above -1");
    let muscle = r#""kind": "active_strain", "direction": "x""#;
    said(&format!("{muscle}, \"shortening\": -0.1"), "", "actuation/0/shortening", "a muscle only shortens");
    said(muscle, &control(r#", "upper": 1"#), "controls/0/upper", "shortening must stay below 1");
    said(muscle, &control(r#", "lower": -0.1"#), "controls/0/lower", "a muscle only shortens");
    said(
        r#""kind": "growth_tensor", "xx": 0.2, "xy": 1.2"#,
        "",
        "actuation/0/xx",
        "1 + growth must be positive definite",
    );
    said(r#""kind": "growth_tensor""#, "", "actuation/0", "\"swell\" has no effect: its xx is zero");
    let lce = r#""kind": "lce", "direction": "x""#;
    let direction = |more: &str| format!(r#"{{ "of": "swell.direction", "space": "cell"{more} }}"#);
    said(
        &format!("{lce}, \"strain\": -0.2"),
        &direction(""),
        "controls/0",
        "\"swell.direction\" is a field of unit vectors: give \"norm\": 1",
    );
    said(lce, &direction(r#", "norm": 1"#), "actuation/0", "\"swell\" has no effect: its strain is zero");
    said(
        r#""kind": "growth", "growth": 0.2"#,
        &direction(r#", "norm": 1"#),
        "controls/0/of",
        "no actuation \"swell.direction\"",
    );
    // grown apart over the time: what is said of instants
    let timed = with(
        &bar(lce, "", &towards(0.12)),
        "\"direction\": \"x\"",
        "\"direction\": \"x\", \"strain\": \"-2 * t / 1 s\"",
    );
    let timed = with(
        &timed,
        "\"optimizer\": { \"method\": \"lbfgs\" }",
        "\"time\": { \"end\": \"1 s\", \"step\": \"0.1 s\", \"scheme\": \"quasi_static\" }",
    );
    let found = problems(&timed);
    assert!(found.contains("actuation/0/strain: strain must stay above -1"), "{found}");
}

/// A free gel, swollen in pure solvent at rest (J = 38.956632 over its dry network), dries in vapour by a turgor of `c log h` to the volume at which the chemical
/// potential is that of the vapour; its reference must hold solvent.
#[test]
fn a_gel_dries_to_the_volume_of_its_humidity() {
    let case = r#"{ "nastic": 1,
        "mesh": { "box": { "size": [0.01, 0.01, 0.01], "cells": [1, 1, 1], "element": "hex8" } },
        "materials": [ { "region": "body", "law": "gel", "network": "136 kPa", "mixing": "136 MPa", "chi": 0.1 } ],
        "supports": [ { "surface": "x-", "fix": "x" }, { "surface": "y-", "fix": "y" }, { "surface": "z-", "fix": "z" } ],
        "actuation": [ { "name": "drying", "kind": "turgor", "region": "body", "pressure": "136 MPa * log(0.999)" } ] }"#;
    let found = number(&run(Command::Solve, case), "min_J") * 38.956632;
    let excess =
        |x: f64| (1.0 - 1.0 / x).ln() + 1.0 / x + 0.1 / (x * x) + 1e-3 * (x.powf(-1.0 / 3.0) - 1.0 / x) - 0.999f64.ln();
    assert!(excess(found * (1.0 - 1e-6)) < 0.0 && excess(found * (1.0 + 1e-6)) > 0.0 && found < 20.0, "{found}");
    // one that swells it beyond its reference is another thing
    assert!(!warnings(case).contains("grows too slowly"), "{}", warnings(case));
    assert!(warnings(&with(case, "log(0.999)", "log(1.001)")).contains("grows too slowly"));
    let dry = problems(&with(case, "\"chi\": 0.1", "\"chi\": 0.1, \"swelling\": 1"));
    assert!(dry.contains("gel: swelling = 1e0, but it must be above 1: a dry network"), "{dry}");
}

/// Beside a fibre tension and a chamber: derivatives by every kind, and by the direction of those that have one, are exact to the second order.
#[test]
fn derivatives_beside_a_tension_and_a_chamber_are_exact() {
    let place = CaseDirectory::new();
    place.write("ring.msh", &crate::balloon::ring());
    let case = |growth: &str, controls: &str| {
        format!(
            r#"{{ "nastic": 1, "units": "mm", "mesh": "ring.msh",
            "materials": [ {{ "region": "wall", "law": "neo_hooke", "young": "0.1 MPa", "poisson": 0.4 }} ],
            "supports": [ {{ "surface": "x axis", "fix": ["y"] }}, {{ "surface": "y axis", "fix": ["x"] }} ],
            "actuation": [ {{ "name": "air", "kind": "cavity", "surface": "inner", "symmetry": ["x axis", "y axis"] }},
                           {{ "name": "fibre", "kind": "fiber_tension", "region": "wall", "direction": "x" }},
                           {{ "name": "swell", "region": "wall", {growth} }} ],
            "controls": [ {{ "of": "air", "space": "uniform", "start": "2 kPa", "lower": "0 kPa", "upper": "4 kPa" }},
                          {{ "of": "fibre", "space": "uniform", "start": "-3 kPa", "lower": "-9 kPa", "upper": "0 kPa" }}, {controls} ],
            "costs": [ {{ "kind": "tracking", "surface": "inner", "target": ["1.1 * X", "1.3 * Y"] }} ] }}"#
        )
    };
    let bounded = |of: &str, start: f64, ends: f64| {
        format!(r#"{{ "of": "{of}", "space": "cell", "start": {start}, "lower": -{ends}, "upper": {ends} }}"#)
    };
    let direction = r#"{ "of": "swell.direction", "space": { "grid": [2, 1] }, "norm": 1 }"#;
    let stretched = format!("{}, {direction}", bounded("swell", -0.05, 0.3));
    for (growth, controls) in [
        (r#""kind": "heat", "expansion": "2e-3 / K""#, bounded("swell", 20.0, 100.0)),
        (r#""kind": "lce", "direction": [0.6, 0.8, 0]"#, stretched.clone()),
        (r#""kind": "stretch_along", "direction": [0.6, 0.8, 0]"#, stretched),
        (
            r#""kind": "growth_tensor", "yy": 0.05"#,
            format!("{}, {}", bounded("swell.xx", 0.05, 0.3), bounded("swell.xy", 0.02, 0.2)),
        ),
    ] {
        let found = place.run(Command::Gradcheck, &case(growth, &controls), &[]).unwrap().result;
        assert!(number(&found, "gradcheck/lowest_order") > 1.95, "{growth}: {found}");
        assert!(number(&found, "gradcheck/second/lowest_order") > 2.95, "{growth}: {found}");
        assert_eq!(nastic_run::result::find(&found, "gradcheck/second/passed").unwrap(), true);
    }
}

/// A strip that contracts along its directors lifts its end as they turn: from a uniform field, in vectors of length 1.
#[test]
fn directors_are_controls() {
    let case = r#"{ "nastic": 1,
        "mesh": { "box": { "size": [0.04, 0.004], "cells": [10, 2], "element": "quad9" } },
        "materials": [ { "region": "body", "law": "neo_hooke", "young": "1 MPa", "poisson": 0.45 } ],
        "supports": [ { "surface": "x-", "fix": "all" } ],
        "actuation": [ { "name": "lce", "kind": "lce", "region": "body", "direction": [0.6, 0.8, 0], "strain": -0.1 } ],
        "controls": [ { "of": "lce.direction", "space": { "grid": [1, 1] }, "norm": 1 } ],
        "costs": [ { "kind": "position", "surface": "x+", "target": { "y": 0.01 } } ],
        "optimizer": { "method": "gauss_newton", "max_iterations": 40 } }"#;
    let place = CaseDirectory::new();
    let found = place.run(Command::Optimize, case, &[]).unwrap().result;
    assert!(number(&found, "cost/total") < 1e-3 * number(&found, "start/cost/total"), "{found}");
    let shown = nastic_io::read_snapshot(place.path("out/optimum.vtu")).unwrap();
    let field = shown.point_data.iter().chain(&shown.cell_data).find(|array| array.name == "lce.direction").unwrap();
    // means over cells of vectors of length 1, no longer those of the start
    let lengths = field.values.chunks(3).map(|d| d[0].hypot(d[1]));
    assert!(lengths.clone().all(|length| length > 0.9 && length < 1.0 + 1e-9), "{:?}", field.values);
    let turned = |d: &[f64]| (d[0] * 0.6 + d[1] * 0.8) < 0.999;
    assert!(field.values.chunks(3).any(turned), "{:?}", field.values);
}

/// A tenth of every length is left, by the largest number per kelvin; of what shrinks in heat the bound is above.
#[test]
fn heat_has_bounds_of_its_own() {
    let control = r#"{ "of": "swell", "space": "uniform", "start": "10 K" }"#;
    let bounds = |keys: &str| {
        let text = bar(&format!(r#""kind": "heat", {keys}"#), control, &towards(0.12));
        let problem = common::lower(&text).unwrap();
        let bounds = problem.controls[0].bounds.as_ref().unwrap().at(0);
        (bounds, warnings(&text))
    };
    let ((lower, upper), said) = bounds(r#""expansion": "2e-3 / K""#);
    assert!((lower + 450.0).abs() < 1e-9 && upper == f64::INFINITY, "{lower} {upper}");
    assert!(!said.contains("\"lower\"") && said.contains("no \"upper\" bound"), "{said}");
    let keys = r#""expansion_along": "-1e-3 / K", "expansion_across": "3e-3 / K", "direction": "x""#;
    let ((lower, upper), _) = bounds(keys);
    assert!((lower + 300.0).abs() < 1e-9 && (upper - 900.0).abs() < 1e-9, "{lower} {upper}");
    let ((lower, upper), said) = bounds(r#""expansion": "-2e-3 / K""#);
    assert!(lower == f64::NEG_INFINITY && (upper - 450.0).abs() < 1e-9, "{lower} {upper}");
    assert!(said.contains("values may leave nothing of a length") && !said.contains("theory"), "{said}");
}

/// Fixed entries and directions, as of other actuations.
#[test]
fn fixed_entries_and_directions_are_drawn() {
    let shown = |actuation: &str, controls: &str| {
        let place = CaseDirectory::new();
        place.run(Command::Gradient, &bar(actuation, controls, &towards(0.12)), &[]).unwrap();
        let shot = nastic_io::read_snapshot(place.path("out/start.vtu")).unwrap();
        move |name: &str| {
            shot.cell_data
                .iter()
                .find(|array| array.name == name)
                .map(|array| array.values[..3].iter().map(|x| (1e9 * x).round() / 1e9).collect())
        }
    };
    let xx = r#"{ "of": "swell.xx", "space": "uniform", "start": 0.2, "upper": 1 }"#;
    let tensor = shown(r#""kind": "growth_tensor", "yy": 0.1"#, xx);
    assert_eq!(tensor("swell.yy"), Some(vec![0.1; 3]));
    assert_eq!(tensor("swell.zz"), Some(vec![0.0; 3]));
    assert_eq!(tensor("swell.xx"), Some(vec![0.2; 3]));
    let lce = r#""kind": "lce", "direction": "y""#;
    let along = shown(lce, r#"{ "of": "swell", "space": "uniform", "start": 0.1, "upper": 1 }"#);
    assert_eq!(along("direction_swell"), Some(vec![0.0, 1.0, 0.0]));
    // where the direction is the control, it is drawn under its own name
    let turned = r#"{ "of": "swell.direction", "space": "uniform", "start": [0, 0, 1], "norm": 1 }"#;
    let turned = shown(&format!("{lce}, \"strain\": 0.1"), turned);
    assert_eq!([turned("swell"), turned("direction_swell")], [Some(vec![0.1; 3]), None]);
    assert_eq!(turned("swell.direction"), Some(vec![0.0, 0.0, 1.0]));
    for (kind, direction) in [
        (r#""kind": "area_growth", "normal": "z""#, [0.0, 0.0, 1.0]),
        (r#""kind": "stretch_along", "direction": "z""#, [0.0, 0.0, 1.0]),
        (r#""kind": "heat", "expansion_along": 1e-3, "expansion_across": 0, "direction": "x""#, [1.0, 0.0, 0.0]),
    ] {
        let own = shown(kind, r#"{ "of": "swell", "space": "uniform", "start": 0.1, "upper": 1 }"#);
        assert_eq!(own("direction_swell"), Some(direction.to_vec()), "{kind}");
    }
}

#[test]
fn a_direction_of_another_length_is_told_once() {
    for actuation in [r#""kind": "lce", "direction": [1, 1, 0]"#, r#""kind": "fiber_tension", "direction": [1, 1, 0]"#]
    {
        let text =
            bar(actuation, r#"{ "of": "swell", "space": "uniform", "lower": -0.1, "upper": 0.1 }"#, &towards(0.12));
        let told = problems(&text);
        assert_eq!(told.matches("actuation/0/direction").count(), 1, "{told}");
    }
    // one that varies is looked at where it is evaluated
    let text = bar(
        r#""kind": "lce", "direction": ["1 + X / 1 m", 0, 0]"#,
        r#"{ "of": "swell", "space": "uniform", "upper": 0.1 }"#,
        &towards(0.12),
    );
    let told = problems(&text);
    assert_eq!(told.matches("actuation/0/direction: lce: direction").count(), 1, "{told}");
}

/// A bar that grows in time: its work is that of no cost, and a growth that is followed freely has no energies to compare errors with.
#[test]
fn growth_in_time_has_no_work_to_pay_and_no_doubts_of_energy() {
    let grows = |more: &str| {
        let own = format!(r#""kind": "heat", "expansion": "1e-3 / K"{more}"#);
        with(
            &bar(&own, "", ""),
            "\"optimizer\": { \"method\": \"lbfgs\" }",
            "\"time\": { \"end\": \"1 s\", \"step\": \"0.1 s\", \"scheme\": \"quasi_static\" }",
        )
    };
    let free = grows(r#", "temperature": "60 K * t / (1 s)""#);
    let found = run(Command::Solve, &free.replace("\"controls\": [  ], \"costs\": [  ],", ""));
    let balance = &found["time"]["energy_balance"];
    assert!(balance["added"].as_f64().unwrap() > 0.02 * balance["span"].as_f64().unwrap(), "{balance}");
    assert!(common::messages(&found, "energy").is_empty(), "{found}");
    let control =
        r#""controls": [ { "of": "swell", "space": "uniform", "in_time": { "every": "0.5 s" }, "upper": "60 K" } ]"#;
    let paid = grows("").replace("\"controls\": [  ]", control);
    let told = problems(&paid.replace("\"costs\": [  ]", "\"costs\": [ { \"kind\": \"actuation_work\" } ]"));
    assert!(told.contains("costs/0: it does not count the work of a growth, such as \"swell\""), "{told}");
}

/// What fails beyond a length says so in words.
#[test]
fn what_leaves_nothing_is_no_number() {
    let tensor = bar(
        r#""kind": "growth_tensor""#,
        r#"{ "of": "swell.xy", "space": "uniform", "start": 0.1, "lower": -5, "upper": 0.5 }"#,
        &towards(0.12),
    );
    assert!(problems(&tensor).contains("controls/0/lower: 1 + growth must be positive definite"));
    let open = tensor.replace(r#""lower": -5, "#, "");
    assert!(warnings(&open).contains("values may leave nothing of a length"), "{}", warnings(&open));
    let heated =
        bar(r#""kind": "heat", "expansion": "2e-3 / K""#, r#"{ "of": "swell", "space": "uniform" }"#, &towards(0.12));
    let problem = common::lower(&heated).unwrap();
    let failed =
        problem.ensemble.evaluate(&[-5000.0], &Request::default(), &mut Default::default()).unwrap_err().to_string();
    assert!(failed.contains("-det G has no value there, 1 + expansion") && !failed.contains("NaN"), "{failed}");
}
