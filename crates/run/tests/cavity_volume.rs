//! Cavities of a prescribed volume in case files.

#![allow(clippy::unwrap_used, clippy::panic)] // a test may

use crate::common;

use common::{CaseDirectory, problems};
use nastic_language::schema::Command;
use nastic_run::console::Console;
use nastic_run::run::{Analysis, Exit, Options};

/// The finger of the shipped cases, with what its chamber is driven by and the controls.
fn case(drive: &str, controls: &str) -> String {
    let mesh = concat!(env!("CARGO_MANIFEST_DIR"), "/../../meshes/finger.msh");
    format!(
        r#"{{ "nastic": 1, "title": "finger", "mesh": "{mesh}",
        "materials": [ {{ "region": "body", "law": "neo_hooke", "young": "0.6 MPa", "poisson": 0.4 }} ],
        "supports": [ {{ "surface": "clamp", "fix": ["x", "y", "z"] }}, {{ "surface": "middle", "fix": ["y"] }} ],
        "actuation": [ {{ "name": "air", "kind": "cavity", "surface": "chamber", "symmetry": "middle"{drive} }} ],
        "controls": [ {controls} ],
        "costs": [ {{ "kind": "tracking", "surface": "tip", "target": ["X", "Y", "Z - 0.01"] }}, {{ "kind": "pump_work" }} ] }}"#
    )
}

const BY_VOLUME: &str =
    r#"{ "of": "air.volume", "space": "uniform", "start": "100 mm^3", "lower": "0 mm^3", "upper": "500 mm^3" }"#;

/// Pressure, volume and volume at rest.
fn air(result: &serde_json::Value) -> [f64; 3] {
    ["pressure", "volume", "reference_volume"].map(|key| result["contributions"]["air"][key].as_f64().unwrap())
}

#[test]
fn an_added_volume_is_a_control_or_a_fixed_value() {
    let place = CaseDirectory::new();
    let outcome = place.run(Command::Solve, &case("", BY_VOLUME), &[]).unwrap();
    let [pressure, volume, reference] = air(&outcome.result);
    assert!((volume / (reference + 1e-7) - 1.0).abs() < 1e-10 && pressure > 1e3, "{pressure}, {volume}");
    assert_eq!(outcome.result["inertia"], 0);
    let work = outcome.result["cost"]["terms"]["pump_work"].as_f64().unwrap();
    assert!((work / (0.5 * pressure * 1e-7) - 1.0).abs() < 0.1, "the work {work} is about p dV / 2");
    // fixed to the same, or to the pressure found
    for drive in [r#", "volume": "100 mm^3""#.to_owned(), format!(r#", "pressure": {pressure:?}"#)] {
        let same = place.run(Command::Solve, &case(&drive, ""), &[]).unwrap();
        let found = air(&same.result);
        assert!((found[0] / pressure - 1.0).abs() < 1e-7 && (found[1] / volume - 1.0).abs() < 1e-9, "{found:?}");
    }
    // A chamber that is sealed and full of liquid keeps its volume.
    let load = r#""loads": [ { "surface": "tip", "traction": ["0 Pa", "0 Pa", "-300 Pa"] } ], "costs""#;
    let sealed = case(r#", "volume": "0 mm^3""#, "").replace("\"costs\"", load);
    let [pressure, volume, reference] = air(&place.run(Command::Solve, &sealed, &[]).unwrap().result);
    assert!((volume / reference - 1.0).abs() < 1e-10 && pressure != 0.0, "{pressure}, {volume}");
}

#[test]
fn its_gradient_is_right() {
    let outcome = CaseDirectory::new().run(Command::Gradcheck, &case("", BY_VOLUME), &[]).unwrap();
    assert_eq!(outcome.exit, Exit::Done, "{}", outcome.result);
}

/// Along the volume: the pressure-volume curve as a table.
#[test]
fn a_ramp_of_the_volume_is_the_curve_of_its_pressure() {
    let place = CaseDirectory::new();
    let analysis = Analysis::Ramp("air.volume=0 mm^3:300 mm^3:3".to_owned());
    let options = Options { analysis, ..place.options(&[]) };
    let outcome = place.run_with(Command::Solve, &case("", BY_VOLUME), &Console::silent(), &options).unwrap();
    assert_eq!(outcome.exit, Exit::Done, "{}", outcome.result);
    let table = std::fs::read_to_string(place.path("out").join("ramp.csv")).unwrap();
    let (head, rows) = table.split_once('\n').unwrap();
    let names: Vec<&str> = head.split(',').collect();
    assert_eq!(names[..4], ["air.volume", "air.pressure", "contributions.air.volume", "air.reference_volume"]);
    let pressures: Vec<f64> = rows.lines().map(|row| row.split(',').nth(1).unwrap().parse().unwrap()).collect();
    assert!(pressures.len() == 3 && pressures.windows(2).all(|pair| pair[0] < pair[1]), "{pressures:?}");
}

#[test]
fn mistakes_are_told() {
    let message = |drive: &str, controls: &str, wanted: &str| {
        let found = problems(&case(drive, controls));
        assert!(found.contains(wanted), "{found}");
    };
    message(
        r#", "pressure": "1 kPa""#,
        BY_VOLUME,
        "\"air\" is driven by its pressure and by its volume: keep one of them",
    );
    message("", "", "\"air\" has no effect: its pressure is zero");
    message(r#", "volume": "1 kPa""#, "", "actuation/0/volume");
    message(r#", "volume": "1 mm^2""#, "", "actuation/0/volume");
    message("", &BY_VOLUME.replace("500 mm^3", "500 mm"), "controls/0/upper");
    message("", &BY_VOLUME.replace("air.volume", "air.volumes"), "did you mean \"air.volume\"");
    let outcome = CaseDirectory::new().run(Command::Solve, &case(r#", "volume": "-1400 mm^3""#, ""), &[]);
    let error = format!("{:?}", outcome.map(|outcome| outcome.result.to_string()));
    assert!(error.contains("leaves none of its reference volume"), "{error}");
}

/// A quarter of a tube, by the cell around its chamber.
fn tube() -> String {
    let cells = 8;
    let mut text = "*NODE\n".to_owned();
    for k in 0..=cells {
        let (y, x) = (std::f64::consts::FRAC_PI_2 * f64::from(k) / f64::from(cells)).sin_cos();
        for (layer, radius) in [(1, 1.0), (2, 1.3)] {
            text += &format!("{},{:.9},{:.9}\n", 2 * k + layer, radius * x, radius * y);
        }
    }
    text += "*ELEMENT, TYPE=CPE4, ELSET=body\n";
    (0..cells).for_each(|k| text += &format!("{},{},{},{},{}\n", k + 1, 2 * k + 1, 2 * k + 2, 2 * k + 4, 2 * k + 3));
    text + "*SURFACE, NAME=inner\nbody, S4\n*SURFACE, NAME=low\n1, S1\n*SURFACE, NAME=left\n8, S3\n"
}

/// A chamber that is pumped to many times its volume is warned about.
#[test]
fn chambers_that_have_ballooned_are_told() {
    let case = |volume: &str| {
        format!(
            r#"{{ "nastic": 1, "mesh": "tube.inp",
            "materials": [ {{ "region": "body", "law": "neo_hooke", "young": "0.1 MPa", "poisson": 0.3 }} ],
            "supports": [ {{ "surface": "low", "fix": ["y"] }}, {{ "surface": "left", "fix": ["x"] }} ],
            "actuation": [ {{ "name": "air", "kind": "cavity", "surface": "inner", "symmetry": ["low", "left"], "volume": {volume} }} ] }}"#
        )
    };
    for (volume, told) in [("4.0", false), ("9.0", true)] {
        let place = CaseDirectory::new();
        std::fs::create_dir_all(place.path("cases")).unwrap();
        for at in ["tube.inp", "cases/tube.inp"] {
            std::fs::write(place.path(at), tube()).unwrap();
        }
        let result = place.run(Command::Solve, &case(volume), &[]).unwrap().result;
        let found = common::messages(&result, "extreme_deformation");
        assert_eq!(
            found.iter().any(|what| what.contains("chamber \"air\" has 13 times its volume at rest")),
            told,
            "{found:?}"
        );
    }
}
