//! Whole cases that are wrong: every mistake is reported once, with its place and what would be right.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::{COMPLETE, one, problems_with};
use nastic_language::schema::Case;
use nastic_language::syntax::Document;

#[test]
fn unknown_keys_name_the_nearest_and_the_list() {
    one(
        COMPLETE,
        "\"mu3\"",
        "\"mu9\": 1, \"mu3\"",
        "materials/0/mu9: unknown key \"mu9\": did you mean \"mu1\"? (one of: name, region, law, formulation, rigid, density, maxwell, kelvin_voigt, design, mu1, mu2, mu3, mu4, fiber)",
    );
    one(
        COMPLETE,
        "\"optimizer\"",
        "\"optimiser\"",
        ": optimiser: unknown key \"optimiser\": did you mean \"optimizer\"? (one of: nastic, title, units, \
         mesh, surfaces, regions, materials, supports, springs, media, obstacles, contact, loads, actuation, electrodes, controls, costs, constraints, load_cases, scenarios, risk, time, optimizer, \
         gains, linear_solver, probes, expect, output, $schema)",
    );
    one(
        COMPLETE,
        "\"lower\"",
        "\"lowr\"",
        "did you mean \"lower\"? (one of: of, name, space, log, start, lower, upper, prior, norm, max_norm, direction, filter, projection, cut, least_bar, least_gap, symmetry, fixed, in_time, rate)",
    );
    one(
        COMPLETE,
        "\"alpha\": 4,",
        "\"alpha\": 4, \"delta\": 1,",
        "costs/0/stages/1/delta: unknown key \"delta\" (one of: alpha, beta, gamma)",
    );
    one(
        COMPLETE,
        "\"quadrature\"",
        "\"Quadrature\"",
        "did you mean \"quadrature\"? (one of: kind, name, target, target_region, region, phi, stages, \
         quadrature, weight, when)",
    );
}

#[test]
fn boxes_are_told_apart() {
    let mesh = "\"../../meshes/cantilever.msh\",";
    let pad = "{ \"name\": \"pad\", \"size\": [1, 1], \"cells\": [2, 2], \"element\": \"quad4\" }";
    let with = |other: &str| problems_with(COMPLETE, mesh, &format!("{{ \"boxes\": [ {pad}, {other} ] }},"));
    let found = with(pad);
    assert!(found.contains("mesh/boxes/1/name: two boxes are named \"pad\""), "{found}");
    let cube = "{ \"name\": \"cube\", \"corner\": [0, 2, 0], \"size\": [1, 1, 1], \"cells\": [1, 1, 1], \"element\": \"hex8\" }";
    let found = with(cube);
    assert!(found.contains("mesh/boxes/1/element: boxes and rectangles do not go together"), "{found}");
    let found = with(&cube.replace("[0, 2, 0]", "[0, 2]"));
    assert!(found.contains("mesh/boxes/1/corner: 3 entries wanted"), "{found}");
    let none = problems_with(COMPLETE, mesh, "{ \"boxes\": [] },");
    assert!(none.contains("mesh/boxes: no box: give one at least"), "{none}");
}

/// A suggestion that shares little with what was written would send the reader the wrong way.
#[test]
fn what_is_like_no_known_name_is_answered_with_the_list() {
    let unknown = problems_with(COMPLETE, "\"100 kPa\"", "\"100 us\"");
    assert!(unknown.contains("found \"us\"; the units are m, mm, um,"), "{unknown}");
    for (from, to, wanted) in [
        ("\"length\": \"m\"", "\"length\": \"us\"", "unknown unit \"us\" (one of: m, mm, um, cm, km)"),
        ("\"transverse_mooney_rivlin\"", "\"hgo\"", "unknown law \"hgo\": did you mean \"holzapfel_gasser_ogden\"?"),
        ("\"transverse_mooney_rivlin\"", "\"holzapfel\"", "did you mean \"holzapfel_gasser_ogden\"?"),
        ("\"of\": \"tension\"", "\"of\": \"heat\"", "no actuation \"heat\" (one of: tension, tension.direction)"),
    ] {
        let found = problems_with(COMPLETE, from, to);
        assert!(found.contains(wanted), "{from} -> {to}:\n{found}");
    }
}

/// Words of other programs and of soft robotics are answered with what they are called here.
#[test]
fn words_people_try_are_answered_with_what_to_write() {
    let law = "\"law\": \"transverse_mooney_rivlin\"";
    let kind = "\"kind\": \"fiber_tension\"";
    for (from, to, parts) in [
        ("\"nastic\": 1,", "\"nastic\": 1, \"gravity\": 9.81,", ["unknown key \"gravity\"", "\"gravity\": [0, 0,"]),
        ("\"nastic\": 1,", "\"nastic\": 1, \"bc\": [],", ["unknown key \"bc\"", "\"fix\": \"all\""]),
        ("\"nastic\": 1,", "\"nastic\": 1, \"force\": 1,", ["unknown key \"force\"", "\"traction\""]),
        ("\"traction\":", "\"pressure\": 5, \"traction\":", ["loads/0/pressure", "\"kind\": \"cavity\""]),
        (law, "\"c10\": 1, \"law\": \"transverse_mooney_rivlin\"", ["materials/0/c10", "\"neo_hooke\" and"]),
        (law, "\"E\": 1, \"law\": \"transverse_mooney_rivlin\"", ["materials/0/E", "\"young\": \"300 kPa\""]),
        (law, "\"nu\": 1, \"law\": \"transverse_mooney_rivlin\"", ["materials/0/nu", "\"poisson\": 0.45"]),
        (law, "\"youngs_modulus\": 1, \"law\": \"transverse_mooney_rivlin\"", ["youngs_modulus", "\"young\":"]),
        (law, "\"poissons_ratio\": 1, \"law\": \"transverse_mooney_rivlin\"", ["poissons_ratio", "\"poisson\":"]),
        (law, "\"rho\": 1, \"law\": \"transverse_mooney_rivlin\"", ["materials/0/rho", "\"density\": \"1000 kg/m^3\""]),
        (law, "\"law\": \"linear_elastic\"", ["unknown law \"linear_elastic\"", "\"neo_hooke\" with"]),
        ("\"fix\":", "\"fixed\": true, \"fix\":", ["supports/0/fixed", "\"fix\": \"all\""]),
        (kind, "\"kind\": \"fibre\"", ["unknown kind \"fibre\"", "\"kind\": \"muscle\""]),
        (kind, "\"kind\": \"air_chamber\"", ["unknown kind \"air_chamber\"", "\"cavity\""]),
        (kind, "\"kind\": \"chamber\"", ["unknown kind \"chamber\"", "\"cavity\""]),
        (kind, "\"kind\": \"cable\"", ["unknown kind \"cable\"", "\"kind\": \"tendon\""]),
        (kind, "\"magnetization\": 1, \"kind\": \"fiber_tension\"", ["actuation/0/magnetization", "\"remanence\""]),
        ("\"max_iterations\"", "\"maxiter\"", ["optimizer/maxiter", "\"max_iterations\": 100"]),
    ] {
        let found = problems_with(COMPLETE, from, to);
        let message = |line: &&str| parts.iter().all(|part| line.contains(part)) && line.contains("(one of: ");
        assert!(found.lines().filter(message).count() == 1, "{from} -> {to}:\n{found}\nwanted: {parts:?}");
    }
}

#[test]
fn problems_carry_path_line_and_column() {
    let found = problems_with(COMPLETE, "\"100 kPa\"", "\"100 mm\"");
    let place = "case.json:9:27: materials/0/mu1: ";
    assert_eq!(
        found,
        format!(
            "{place}unit of the wrong kind: \"100 mm\" is a length, a pressure is wanted (Pa, kPa, MPa, GPa, bar, mbar)"
        )
    );
}

#[test]
fn all_problems_are_reported_at_once() {
    let text = COMPLETE
        .replace("\"nastic\": 1", "\"nastic\": 2")
        .replace("\"100 kPa\"", "\"100 mm\"")
        .replace("\"clamp\"", "5")
        .replace("\"of\": \"tension\"", "\"of\": \"tensoin\"")
        .replace("\"lower\": \"-400 kPa\"", "\"lower\": \"400 kPa\"")
        .replace("\"weight\": 1.0", "\"weight\": -1, \"weigth\": 2")
        .replace(
            "\"probability\": 0.5, \"set\": { \"materials/0/mu1\": \"110",
            "\"probability\": 0.6, \"set\": { \"materials/7/mu1\": \"110",
        )
        .replace("\"max_iterations\": 100", "\"max_iterations\": 10.5, \"tolerance\": 1")
        .replace("\"risk\": \"mean\"", "\"risk\": \"maen\"")
        .replace("[1.0, 0.2, 0.2] }", "[1.0] }");
    let Err(problems) = Case::read(&Document::parse("case.json", &text).unwrap()) else { panic!("accepted") };
    let paths: Vec<&str> = problems.list().iter().map(|problem| problem.path.as_str()).collect();
    let expected = [
        "nastic",
        "materials/0/mu1",
        "supports/0/surface",
        "controls/0/of",
        "controls/0/lower",
        "costs/0/weight",
        "costs/0/weigth",
        "scenarios",
        "materials/7/mu1",
        "risk",
        "optimizer/max_iterations",
        "optimizer/tolerance",
        "probes/0/point",
    ];
    assert_eq!(paths, expected, "{problems}");
    assert!(problems.list().iter().all(|problem| problem.line > 0 && problem.column > 0));
    let mut lines: Vec<_> = problems.list().iter().map(|problem| problem.line).collect();
    lines.sort_unstable();
    assert_eq!(lines, problems.list().iter().map(|problem| problem.line).collect::<Vec<_>>(), "in the order of lines");
}

#[test]
fn wrong_types_and_missing_keys_are_clear() {
    one(
        COMPLETE,
        "\"mu1\": \"100 kPa\"",
        "\"mu1\": true",
        "materials/0/mu1: a number, or a text with a unit or formula, was expected, found true or false",
    );
    one(
        COMPLETE,
        "\"region\": \"body\", \"law\"",
        "\"law\"",
        ": materials/0: missing key \"region\": Region of the mesh",
    );
    one(
        COMPLETE,
        "\"mu4\": \"1 MPa\", ",
        "",
        ": materials/0: missing key \"mu4\": \"transverse_mooney_rivlin\" takes {mu1, mu2, mu3, mu4, fiber}",
    );
    one(
        COMPLETE,
        "\"space\": \"cell\"",
        "\"space\": \"cels\"",
        ": controls/0/space: unknown name \"cels\": did you mean \"cell\"? (one of: uniform, region, cell, node, grid)",
    );
    one(COMPLETE, "\"space\": \"cell\", ", "", ": controls/0: missing key \"space\": Where its values live");
    one(
        COMPLETE,
        "\"fiber_tension\"",
        "\"fibre_tension\"",
        ": actuation/0/kind: unknown kind \"fibre_tension\": did you mean \"fiber_tension\"? (one of: \
         fiber_tension, muscle, turgor, magnet, dielectric, growth, stretch_along, area_growth, heat, lce, \
         active_strain, growth_tensor, shape, free_shape, cavity, tendon, motion, dielectric_body)",
    );
    one(
        COMPLETE,
        "\"kind\": \"smoothed_hausdorff\", ",
        "",
        ": costs/0: missing key \"kind\" (one of: smoothed_hausdorff, tracking, position, markers, displacement, orientation, curvature, \
         mean_radius, volume, largest_stretch, compliance, reaction, contact_force, contact_pressure, contact_slip, obstacle, control_norm, control_smoothness, \
         control_rate, \
         kinetic_energy, actuation_work, design_volume, greyness, shape_shrinkage, pump_work)",
    );
    one(
        COMPLETE,
        "\"mesh\": \"../../meshes/cantilever.msh\"",
        "\"mesh\": 5",
        ": mesh: the name of a mesh file or an object { ... } was expected, found a number",
    );
    one(COMPLETE, "\"mesh\": \"../../meshes/cantilever.msh\"", "\"mesh\": \"\"", ": mesh: this text must not be empty");
    one(
        COMPLETE,
        "\"every\": 10",
        "\"every\": -1",
        ": output/every: a whole number of at least 0 was expected, found -1",
    );
    one(
        COMPLETE,
        "\"quadrature\": 2",
        "\"quadrature\": \"2\"",
        ": costs/0/quadrature: a whole number was expected, found a text",
    );
    one(COMPLETE, "[1, 0, 0]", "[1]", ": actuation/0/direction: two or three entries were expected, found 1");
    one(
        COMPLETE,
        "\"length\": \"0.1 m\" }",
        "\"length\": \"X\" }",
        ": costs/0/phi/exponential/length: \"X\" depends on X, Y or Z, but one number is wanted",
    );
    one(
        COMPLETE,
        "\"exponential\": { \"length\": \"0.1 m\" }",
        "\"exponential\": { \"length\": \"-0.1 m\" }",
        ": costs/0/phi/exponential/length: must be positive, found -0.1",
    );
    one(
        COMPLETE,
        "{ \"exponential\": { \"length\": \"0.1 m\" } }",
        "\"exponential\"",
        ": costs/0/phi: \"exponential\" needs its values: { \"exponential\": ... }",
    );
    one(
        COMPLETE,
        "{ \"exponential\": { \"length\": \"0.1 m\" } }",
        "5",
        ": costs/0/phi: { \"exponential\": ... } or { \"inverse\": ... } or { \"smooth_inverse\": ... } was \
         expected, found a number",
    );
    one(
        COMPLETE,
        "\"supports\":  [ { \"surface\": \"clamp\", \"fix\": [\"x\", \"y\", \"z\"] } ]",
        "\"supports\": 5",
        ": supports: a list [ ... ] was expected, found a number",
    );
    one(COMPLETE, "1e-4", "1e999", ": optimizer/tolerance: 1e999 is beyond the range of numbers");
    one(
        COMPLETE,
        "\"100 kPa\"",
        "\"1e5 +\"",
        ": materials/0/mu1: a number, a name or \"(\" was expected, found the end at column 6 of \"1e5 +\"",
    );
    one(
        COMPLETE,
        "\"field\": \"T\"",
        "\"field\": \"Pa\"",
        ": units/field: unit of the wrong kind: \"Pa\" is a pressure, a magnetic field is wanted (T, mT, uT)",
    );
    one(
        COMPLETE,
        "\"field\": \"T\"",
        "\"field\": \"Tesla\"",
        ": units/field: unknown unit \"Tesla\" (one of: T, mT, uT)",
    );
    let found = problems_with("[1]", "1", "2");
    assert_eq!(found, "case.json:1:1: an object { ... } was expected, found a list");
    assert_eq!(problems_with("{}", "{}", "{ }").lines().count(), 3, "nastic, mesh and materials are required");
}
