//! What cannot be meshed, or not without Gmsh.

#![allow(clippy::unwrap_used)] // helpers of tests

use crate::common::{BAR, Place, with};
use nastic_language::schema::Command;
use nastic_run::run::Exit;

fn refused(place: &Place) -> String {
    let mut request = place.request();
    request.gmsh = "no_such_gmsh".into();
    let error = place.refused(&request);
    assert_eq!(error.exit(), Exit::BadInput, "{error}");
    error.to_string()
}

#[test]
fn a_missing_gmsh_says_how_to_get_it() {
    let place = Place::of(Command::Optimize, BAR);
    let said = refused(&place);
    assert!(said.contains("no_such_gmsh was not found") && said.contains("pip install gmsh"), "{said}");
    // what it was to be given is there for another program
    let geometry = std::fs::read_to_string(place.path("new/outline.geo")).unwrap();
    assert!(
        geometry.contains("Physical Curve(\"x-\")") && geometry.contains("Physical Surface(\"body\")"),
        "{geometry}"
    );
}

#[cfg(unix)]
#[test]
fn the_last_words_of_a_gmsh_that_fails() {
    use std::os::unix::fs::PermissionsExt;
    let place = Place::of(Command::Optimize, BAR);
    let program = place.path("gmsh_that_fails");
    // it ends well, and leaves a file
    let script = "#!/bin/sh\necho 'Info : reading'\necho 'Error : no facet left' >&2\ntouch mesh.part.msh\n";
    std::fs::write(&program, script).unwrap();
    std::fs::set_permissions(&program, std::fs::Permissions::from_mode(0o755)).unwrap();
    let mut request = place.request();
    request.gmsh = program;
    let said = place.refused(&request).to_string();
    assert!(said.contains("Error : no facet left") && said.contains("outline.geo") && !said.contains("Info"), "{said}");
    assert!(!place.path("new/case.json").exists());
}

#[test]
fn directories_without_an_optimum_of_a_design() {
    let place = Place::of(Command::Solve, BAR);
    assert!(refused(&place).contains("it has the result of \"solve\""), "{}", refused(&place));
    let mut request = place.request();
    request.directory = place.path("nowhere");
    let said = place.refused(&request).to_string();
    assert!(said.contains("nowhere: it has no result.json"), "{said}");
    let fibres = with(
        BAR,
        "\"loads\"",
        r#""actuation": [ { "name": "pull", "kind": "fiber_tension", "region": "body", "direction": [1, 0, 0] } ], "loads""#,
    );
    let fibres = with(
        &fibres,
        r#""of": "rho", "space": "cell", "start": "1 - Y/8""#,
        r#""of": "pull", "space": "cell", "upper": 0"#,
    );
    let design =
        ",\n                     \"design\": [ { \"name\": \"rho\", \"kind\": \"density\", \"least\": 0.01 } ]";
    let fibres = with(&fibres, design, "");
    let fibres = with(&fibres, r#", { "kind": "greyness", "of": "rho" }"#, "");
    let said = refused(&Place::of(Command::Optimize, &fibres));
    assert!(said.contains("nothing is cut"), "{said}");
}

#[test]
fn a_size_is_a_positive_length() {
    let place = Place::of(Command::Optimize, BAR);
    for size in [-1.0, 0.0, f64::NAN] {
        let mut request = place.request();
        request.size = Some(size);
        let said = place.refused(&request).to_string();
        assert!(said.contains("a positive length is needed"), "{said}");
    }
}

#[test]
fn a_support_that_was_cut_away_and_a_control_of_the_shape() {
    let gone = with(BAR, "\"1 - Y/8\"", "\"min(1, max(0, X/20 - 0.2))\"");
    let said = refused(&Place::of(Command::Optimize, &gone));
    assert!(said.contains("supports/0/surface") && said.contains("\"x-\"") && said.contains("fixed"), "{said}");
    let shape = with(
        BAR,
        "\"loads\"",
        r#""actuation": [ { "name": "height", "kind": "shape", "region": "body", "modes": { "up": [0, "Y/8"] } } ], "loads""#,
    );
    let shape = with(
        &shape,
        "\"controls\": [ ",
        r#""controls": [ { "of": "height.up", "space": "uniform", "lower": -1, "upper": 1 }, "#,
    );
    let said = refused(&Place::of(Command::Optimize, &shape));
    assert!(said.contains("controls/0") && said.contains("moves the drawn body"), "{said}");
}

#[test]
fn scenarios_that_change_what_is_replaced() {
    let set = r#""scenarios": [ { "name": "thin", "set": { "controls/0/projection/eta": 0.4 } } ], "optimizer""#;
    let start = "\"start\": \"1 - Y/8\"";
    let projected = format!("{start}, \"projection\": {{ \"eta\": 0.5, \"sharpness\": 2 }}");
    let said = refused(&Place::of(Command::Optimize, &with(&with(BAR, "\"optimizer\"", set), start, &projected)));
    assert!(said.contains("scenarios/0/set/controls/0/projection/eta"), "{said}");
}
