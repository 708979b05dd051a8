//! Cases that are well formed but do not fit their mesh, their files or themselves: every mistake is reported with its place
//! and what would be right.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::{BAR, CaseDirectory, problems, warnings, with};

/// One problem, ending so.
fn one(from: &str, to: &str, ending: &str) {
    let found = problems(&with(BAR, from, to));
    assert_eq!(found.lines().count(), 1, "{from} -> {to}:\n{found}");
    assert!(found.ends_with(ending), "{from} -> {to}:\n{found}\nwanted: {ending}");
}

/// One warning that contains this.
fn warned(from: &str, to: &str, part: &str) {
    let found = warnings(&with(BAR, from, to));
    assert!(found.lines().count() == 1 && found.contains(part), "{from} -> {to}:\n{found}\nwanted: {part}");
}

const MESH: &str = r#""mesh": { "box": { "size": [1.0, 0.25, 0.25], "cells": [4, 1, 1], "element": "hex8" } }"#;
const TRACKING: &str = r#"{ "kind": "tracking", "surface": "x+", "target": ["X - 0.1", "Y", "Z + 0.1"] }"#;

#[test]
fn the_bar_itself_is_right() {
    assert_eq!(problems(BAR), "");
    assert_eq!(warnings(BAR), "");
}

#[test]
fn a_parameter_that_cannot_be_read_is_told_once() {
    let wrong = "unit of the wrong kind: \"3 kg\" is a mass, a pressure is wanted (Pa, kPa, MPa, GPa, bar, mbar)";
    one(r#""mu1": "100 kPa""#, r#""mu1": "3 kg""#, wrong);
}

#[test]
fn a_missing_file_is_named_with_its_line() {
    let found = problems(&with(BAR, MESH, r#""mesh": "nowhere.msh""#));
    assert!(found.starts_with("case.json:5:") && found.contains(": mesh: cannot read nowhere.msh: "), "{found}");
    let found = problems(&with(BAR, MESH, r#""mesh": "case.txt""#));
    assert!(found.contains("must end in .msh"), "{found}");
}

/// Gmsh's answer to a script whose only physical group is a surface, and to one that groups curves alone.
#[test]
fn a_mesh_without_its_cells_names_the_cause_and_the_cure() {
    let head =
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n$Elements\n";
    let skin = format!("{head}2\n1 2 2 1 1 1 3 2\n2 2 2 1 1 1 2 4\n$EndElements\n");
    let curve = format!("{head}1\n1 1 2 1 1 1 2\n$EndElements\n");
    for mesh in [skin, curve] {
        let place = CaseDirectory::new();
        place.write("body.msh", &mesh);
        let case = with(BAR, MESH, r#""mesh": "body.msh""#);
        let found = place.run(nastic_language::schema::Command::Check, &case, &[]).unwrap_err().to_string();
        for part in [
            "no volume cells",
            "only the elements of physical groups",
            "`Physical Volume(\"body\") = {1};`",
            "Mesh.SaveAll",
        ] {
            assert!(found.contains(part), "{found}");
        }
    }
}

#[test]
fn files_of_other_programs_are_answered_with_how_to_convert_them() {
    for (file, parts) in [
        ("parts/arm.e", ["`pyvista.read(", ".combine(merge_points=True).save("]),
        ("arm.med", ["which keeps the names of groups", "-save -o "]),
        ("arm.bdf", ["`meshio convert", "numbers of groups become the names"]),
        ("arm.XDMF", ["`meshio convert", "physical groups of those names"]),
        ("arm.stl", ["this is a surface", "Physical Volume(\"body\") = {1};"]),
        ("arm.obj", ["Surface Loop(1) = Surface{:};", "want a loop and a volume each"]),
        ("arm.step", ["SetFactory(\"OpenCASCADE\"); Merge \"", "\"scale\": 1e-3 }"]),
        ("arm.geo", ["a script of Gmsh", "`gmsh -3 "]),
        ("arm.txt", ["must end in .msh", "or .vtk"]),
    ] {
        let found = problems(&with(BAR, MESH, &format!(r#""mesh": "{file}""#)));
        assert!(found.contains(": mesh: ") && parts.iter().all(|part| found.contains(part)), "{file}:\n{found}");
    }
}

#[test]
fn a_missing_target_is_told_together_with_a_missing_mesh() {
    let hausdorff = r#"{ "kind": "smoothed_hausdorff", "target": "gone.msh", "phi": { "inverse": { "eps": 0.1 } },
        "stages": [ { "alpha": 1, "beta": 2, "gamma": 2 } ] }"#;
    let found = problems(&with(&with(BAR, MESH, r#""mesh": "nowhere.msh""#), TRACKING, hausdorff));
    assert_eq!(found.lines().count(), 2, "{found}");
    assert!(found.contains("nowhere.msh") && found.contains("costs/0/target: cannot read gone.msh"), "{found}");
}

#[test]
fn several_mistakes_are_told_at_once() {
    let text = with(BAR, r#""surface": "x-""#, r#""surface": "left""#);
    let text = with(&text, r#""region": "body", "law""#, r#""region": "bdy", "law""#);
    let text = with(&text, "[1.0, 0.25, 0.25] }", "[2.0, 0.25, 0.25] }");
    let found = problems(&text);
    let paths: Vec<&str> = found.lines().map(|line| line.split(": ").nth(1).unwrap()).collect();
    assert_eq!(paths, ["materials/0/region", "supports/0/surface", "probes/0/point"], "{found}");
}

/// Unknown keys, units, names that the mesh lacks, values no material can have, files and points: one report.
#[test]
fn mistakes_of_all_layers_are_told_at_once() {
    let material =
        r#"{ "region": "body", "law": "mooney_rivlin", "mu1": "100 kPa", "mu2": "20 kPa", "mu3": "300 kPa" }"#;
    let negative = r#"{ "region": "body", "law": "mooney_rivlin", "mu1": "-100 kPa", "mu2": "20 kPa", "mu3": "300 kPa" },
        { "region": "bdy", "law": "neo_hooke", "mu": "1 m", "lambda": 1 }"#;
    let hausdorff = r#"{ "kind": "smoothed_hausdorff", "target": "gone.msh", "region": "whole", "phi": { "inverse": { "eps": 0.1 } },
        "stages": [ { "alpha": 1, "beta": 2, "gamma": 2 } ] }"#;
    let mut text = BAR.to_owned();
    for (from, to) in [
        (material, negative),
        (r#""surface": "x-""#, r#""surface": ["left", "x-"]"#),
        (TRACKING, &format!("{}, {hausdorff}", TRACKING.replace("x+", "tip"))),
        (r#""method": "lbfgs", "#, r#""method": "lbfgs", "maxiter": 3, "#),
        ("[1.0, 0.25, 0.25] }", "[2.0, 0.25, 0.25] }"),
    ] {
        text = with(&text, from, to);
    }
    let found = problems(&text);
    let paths: Vec<&str> = found.lines().map(|line| line.split(": ").nth(1).unwrap()).collect();
    let expected = [
        "materials/0/mu1",
        "materials/1/region",
        "materials/1/mu",
        "supports/0/surface/0",
        "costs/0/surface",
        "costs/1/target",
        "costs/1/region",
        "optimizer/maxiter",
        "probes/0/point",
    ];
    assert_eq!(paths, expected, "{found}");
    // Without the mistakes of form, the others alone.
    let text = with(&with(&text, r#""maxiter": 3, "#, ""), r#""mu": "1 m""#, r#""mu": 1"#);
    let found = problems(&text);
    let paths: Vec<&str> = found.lines().map(|line| line.split(": ").nth(1).unwrap()).collect();
    for path in [
        "materials/0/mu1",
        "materials/1/region",
        "supports/0/surface/0",
        "costs/0/surface",
        "costs/1/target",
        "probes/0/point",
    ] {
        assert_eq!(paths.iter().filter(|found| **found == path).count(), 1, "{path}:\n{found}");
    }
}

#[test]
fn options_that_fail_are_told_with_the_mistakes_of_the_case() {
    let place = CaseDirectory::new();
    let text = with(BAR, r#""surface": "x-""#, r#""surface": "left""#);
    let set = ["materials/3/mu1=1", "nowhere/at/all=2", "probes/0/point=[2, 0, 0]"];
    let found = place.run(nastic_language::schema::Command::Check, &text, &set).unwrap_err().to_string();
    assert_eq!(found.lines().count(), 4, "{found}");
    for part in ["--set materials/3/mu1=1", "--set nowhere/at/all=2", "supports/0/surface", "--set probes/0/point"] {
        assert!(found.contains(part), "{found}");
    }
}

#[test]
fn a_body_without_support_says_what_moves() {
    let text = with(BAR, r#""supports": [ { "surface": "x-", "fix": ["x", "y", "z"] } ],"#, "");
    let found = problems(&text);
    assert!(found.contains("supports: the supports leave 6 rigid motion(s) of the body free"), "{found}");
    let found = problems(&with(BAR, r#"["x", "y", "z"] }"#, r#"["x", "y"] }"#));
    assert!(found.contains("leave 1 rigid motion(s)") && found.contains("shift along z"), "{found}");
}

#[test]
fn contradicting_supports_name_the_node() {
    let more = r#""supports": [ { "surface": "y-", "displacement": { "x": "1 mm" } }, "#;
    let found = problems(&with(BAR, r#""supports": [ "#, more));
    assert!(found.contains("supports/1") && found.contains("prescribes"), "{found}");
}

#[test]
fn units_of_the_wrong_kind_are_refused() {
    one(
        r#""lower": "-200 kPa""#,
        r#""lower": "-200 mm""#,
        r#"controls/0/lower: unit of the wrong kind: "-200 mm" is a length, a pressure is wanted (Pa, kPa, MPa, GPa, bar, mbar)"#,
    );
}

#[test]
fn bounds_and_starts_must_agree() {
    one(
        r#""lower": "-200 kPa""#,
        r#""lower": "200 kPa""#,
        r#"controls/0/lower: crossed bounds: "lower" is 200000, above "upper" 100000"#,
    );
    let found = problems(&with(BAR, r#""upper": "100 kPa""#, r#""upper": "-300 kPa * X / 1 m""#));
    assert!(found.contains("controls/0/lower: crossed bounds at node "), "{found}");
    let found = problems(&with(BAR, r#""-50 kPa * Z / 0.25 m""#, r#""-500 kPa * Z / 0.25 m""#));
    assert!(found.contains("controls/0/start: the start -500000 at node "), "{found}");
    assert!(found.contains("lies outside what is allowed: [-2e5, 1e5]"), "{found}");
}

#[test]
fn an_upper_bound_defaults_to_the_law_and_is_warned_about_beyond_it() {
    let problem = common::lower(&with(BAR, r#", "upper": "100 kPa""#, "")).unwrap();
    let bounds = problem.controls[0].bounds.as_ref().unwrap();
    // 0.95 of the law's 200 kPa.
    assert_eq!(bounds.at(0), (-2e5, 1.9e5));
    warned(
        r#""upper": "100 kPa""#,
        r#""upper": "250 kPa""#,
        "controls/0/upper: a tension of 250000 Pa exceeds 200000 Pa, up to which the law stays polyconvex",
    );
    warned(r#""lower": "-200 kPa", "#, "", r#"controls/0: no "lower" bound is given"#);
}

#[test]
fn a_probe_outside_tells_how_far() {
    let found = problems(&with(BAR, "[1.0, 0.25, 0.25] }", "[1.5, 0.25, 0.25] }"));
    assert!(found.contains("probes/0/point: (1.5, 0.25, 0.25) is outside the body"), "{found}");
    assert!(found.contains("the nearest point of it is (1, 0.25, 0.25), 5.000e-1 away"), "{found}");
}

#[test]
fn an_empty_target_is_refused() {
    let place = CaseDirectory::new();
    // a mesh with a surface but no volume
    place.write("flat.msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n0\n$EndNodes\n$Elements\n0\n$EndElements\n");
    let hausdorff = r#"{ "kind": "smoothed_hausdorff", "target": "flat.msh", "phi": { "inverse": { "eps": 0.1 } },
        "stages": [ { "alpha": 1, "beta": 2, "gamma": 2 } ] }"#;
    let error = place.run(nastic_language::schema::Command::Check, &with(BAR, TRACKING, hausdorff), &[]).unwrap_err();
    let found = error.to_string();
    assert!(found.contains("costs/0/target: ") && found.contains("no volume cells and no plane cells"), "{found}");
}

#[test]
fn a_truncated_mesh_is_told_with_its_line() {
    let place = CaseDirectory::new();
    place.write("cut.msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n8\n1 0 0 0\n2 1 0 0\n");
    let error =
        place.run(nastic_language::schema::Command::Check, &with(BAR, MESH, r#""mesh": "cut.msh""#), &[]).unwrap_err();
    let found = error.to_string();
    assert!(found.contains("case.json:5:") && found.contains(": mesh: ") && found.contains("in $Nodes"), "{found}");
}

#[test]
fn millimetres_taken_for_metres_are_warned_about() {
    let big = r#""mesh": { "box": { "size": [1000, 250, 250], "cells": [4, 1, 1], "element": "hex8" } }"#;
    let text = with(&with(BAR, MESH, big), r#""point": [1.0, 0.25, 0.25]"#, r#""point": [1000, 250, 250]"#);
    let text = with(&text, r#""-50 kPa * Z / 0.25 m""#, "0");
    let found = warnings(&text);
    assert!(
        found.contains("mesh/box: the body measures 1000 x 250 x 250 m: if box is drawn in millimetres"),
        "{found}"
    );
    let units = r#""units": { "length": "mm", "force": "N" }, "mesh""#;
    assert_eq!(warnings(&with(&text, r#""mesh""#, units)), "", "the same in millimetres");
}

#[test]
fn a_target_of_another_size_is_warned_about() {
    let hausdorff = r#"{ "kind": "smoothed_hausdorff",
        "target": { "box": { "size": [900, 250, 250], "cells": [4, 1, 1], "element": "hex8" } },
        "phi": { "smooth_inverse": { "eps": 0.1 } }, "stages": [ { "alpha": 1, "beta": 2, "gamma": 2 } ] }"#;
    let found = warnings(&with(BAR, TRACKING, hausdorff));
    let part = "costs/0/target: the body measures 1 x 0.25 x 0.25 m, this target 900 x 250 x 250 m";
    assert!(found.contains(part), "{found}");
}

#[test]
fn a_fixed_value_beside_a_control_is_refused() {
    let fixed = r#""direction": [1, 0, 0], "tension": "5 kPa" }"#;
    one(
        r#""direction": [1, 0, 0] }"#,
        fixed,
        "actuation/0/tension: controls/0 controls this: remove the fixed value, or the control",
    );
}
