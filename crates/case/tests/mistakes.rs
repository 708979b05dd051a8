//! Whole cases that are wrong: every mistake is told once, with its place and what would be right.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use nastic_case::schema::Case;
use nastic_case::syntax::Document;

const COMPLETE: &str = include_str!("cases/complete.json");
const MAGNETS: &str = include_str!("cases/magnets.json");
const SCENARIOS: &str = include_str!("cases/scenarios.json");

/// All problems of `text` after replacing `from` by `to`, which must occur.
fn problems(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "nothing to replace: {from}");
    let broken = text.replacen(from, to, 1);
    let read = Document::parse("case.json", &broken).and_then(|document| Case::read(&document));
    read.map_or_else(|problems| problems.to_string(), |_| String::new())
}

/// Expects one problem, ending so; its place is checked where it matters.
fn one(text: &str, from: &str, to: &str, ending: &str) {
    let found = problems(text, from, to);
    assert_eq!(found.lines().count(), 1, "{from} -> {to}:\n{found}");
    assert!(found.ends_with(ending), "{from} -> {to}:\n{found}\nwanted: {ending}");
}

#[test]
fn unknown_keys_name_the_nearest_and_the_list() {
    one(
        COMPLETE,
        "\"mu3\"",
        "\"mu9\": 1, \"mu3\"",
        "materials/0/mu9: unknown key \"mu9\": did you mean \"mu1\"? (one of: region, law, mu1, mu2, mu3, mu4, fiber)",
    );
    one(
        COMPLETE,
        "\"optimizer\"",
        "\"optimiser\"",
        ": optimiser: unknown key \"optimiser\": did you mean \"optimizer\"? (one of: nastic, title, units, \
         mesh, materials, supports, loads, actuation, controls, costs, constraints, load_cases, scenarios, risk, optimizer, \
         probes, expect, output, $schema)",
    );
    one(
        COMPLETE,
        "\"lower\"",
        "\"lowr\"",
        "did you mean \"lower\"? (one of: of, name, space, start, lower, upper, norm, max_norm, direction)",
    );
    one(
        COMPLETE,
        "\"alpha\": 4,",
        "\"alpha\": 4, \"delta\": 1,",
        "costs/0/stages/1/delta: unknown key \"delta\": did you mean \"beta\"? (one of: alpha, beta, gamma)",
    );
    one(
        COMPLETE,
        "\"quadrature\"",
        "\"Quadrature\"",
        "did you mean \"quadrature\"? (one of: kind, name, target, target_region, region, phi, stages, \
         quadrature, weight)",
    );
}

/// Words of other programs and of soft robotics are answered with what they are called here.
#[test]
fn words_people_try_are_answered_with_what_to_write() {
    let law = "\"law\": \"transverse_mooney_rivlin\"";
    let kind = "\"kind\": \"fiber_tension\"";
    for (from, to, parts) in [
        ("\"nastic\": 1,", "\"nastic\": 1, \"gravity\": 9.81,", ["unknown key \"gravity\"", "\"body_force\": [0, 0,"]),
        ("\"nastic\": 1,", "\"nastic\": 1, \"bc\": [],", ["unknown key \"bc\"", "\"fix\": \"all\""]),
        ("\"nastic\": 1,", "\"nastic\": 1, \"force\": 1,", ["unknown key \"force\"", "\"traction\""]),
        ("\"traction\":", "\"pressure\": 5, \"traction\":", ["loads/0/pressure", "\"kind\": \"cavity\""]),
        (law, "\"c10\": 1, \"law\": \"transverse_mooney_rivlin\"", ["materials/0/c10", "\"neo_hooke\" and"]),
        (law, "\"E\": 1, \"law\": \"transverse_mooney_rivlin\"", ["materials/0/E", "\"young\": \"300 kPa\""]),
        (law, "\"nu\": 1, \"law\": \"transverse_mooney_rivlin\"", ["materials/0/nu", "\"poisson\": 0.45"]),
        (law, "\"youngs_modulus\": 1, \"law\": \"transverse_mooney_rivlin\"", ["youngs_modulus", "\"young\":"]),
        (law, "\"poissons_ratio\": 1, \"law\": \"transverse_mooney_rivlin\"", ["poissons_ratio", "\"poisson\":"]),
        (law, "\"density\": 1, \"law\": \"transverse_mooney_rivlin\"", ["materials/0/density", "\"body_force\""]),
        (law, "\"law\": \"linear_elastic\"", ["unknown law \"linear_elastic\"", "\"neo_hooke\" with"]),
        ("\"fix\":", "\"fixed\": true, \"fix\":", ["supports/0/fixed", "\"fix\": \"all\""]),
        (kind, "\"kind\": \"fibre\"", ["unknown kind \"fibre\"", "\"kind\": \"muscle\""]),
        (kind, "\"kind\": \"air_chamber\"", ["unknown kind \"air_chamber\"", "\"cavity\""]),
        (kind, "\"kind\": \"chamber\"", ["unknown kind \"chamber\"", "\"cavity\""]),
        (kind, "\"kind\": \"tendon\"", ["unknown kind \"tendon\"", "no tendons yet"]),
        (kind, "\"magnetization\": 1, \"kind\": \"fiber_tension\"", ["actuation/0/magnetization", "\"remanence\""]),
        ("\"max_iterations\"", "\"maxiter\"", ["optimizer/maxiter", "\"max_iterations\": 100"]),
    ] {
        let found = problems(COMPLETE, from, to);
        let told = |line: &&str| parts.iter().all(|part| line.contains(part)) && line.contains("(one of: ");
        assert!(found.lines().filter(told).count() == 1, "{from} -> {to}:\n{found}\nwanted: {parts:?}");
    }
}

#[test]
fn problems_carry_path_line_and_column() {
    let found = problems(COMPLETE, "\"100 kPa\"", "\"100 mm\"");
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
         fiber_tension, muscle, turgor, magnet, cavity)",
    );
    one(
        COMPLETE,
        "\"kind\": \"smoothed_hausdorff\", ",
        "",
        ": costs/0: missing key \"kind\" (one of: smoothed_hausdorff, tracking, obstacle, control_norm, control_smoothness, \
         pump_work)",
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
        ": units/field: unknown unit \"Tesla\": did you mean \"T\"? (one of: T, mT, uT)",
    );
    let found = problems("[1]", "1", "2");
    assert_eq!(found, "case.json:1:1: an object { ... } was expected, found a list");
    assert_eq!(problems("{}", "{}", "{ }").lines().count(), 3, "nastic, mesh and materials are required");
}

#[test]
fn contradictions_inside_a_block_are_found() {
    one(
        COMPLETE,
        "\"lower\": \"-400 kPa\"",
        "\"lower\": \"400 kPa\"",
        ": controls/0/lower: crossed bounds: \"lower\" is 400000, above \"upper\" 190000",
    );
    one(
        COMPLETE,
        "\"start\": \"0 Pa\"",
        "\"start\": \"200 kPa\"",
        ": controls/0/start: the start 200000 lies outside the bounds -400000 to 190000",
    );
    one(COMPLETE, "[0.70710678, 0.70710678, 0]", "[1, 1, 0]", "write [0.707106781, 0.707106781, 0.000000000]");
    one(COMPLETE, "[1, 0, 0]", "[0, 0, 0]", ": actuation/0/direction: a direction must have length 1, this has 0");
    one(
        COMPLETE,
        "\"surface\": \"clamp\", \"fix\"",
        "\"fix\"",
        ": supports/0: exactly one of \"surface\", \"region\", \"nodes\" must be given, found 0",
    );
    one(
        COMPLETE,
        "\"fix\": [\"x\", \"y\", \"z\"]",
        "\"fix\": []",
        ": supports/0: this holds nothing: give \"fix\": \"all\", \"fix\": [\"x\", ...] or \"displacement\": { \"x\": ... }",
    );
    one(
        COMPLETE,
        "\"fix\": [\"x\", \"y\", \"z\"]",
        "\"fix\": [\"x\"], \"displacement\": { \"x\": 1 }",
        ": supports/0/fix/0: \"x\" cannot be fixed and displaced",
    );
    one(
        COMPLETE,
        "\"fix\": [\"x\", \"y\", \"z\"]",
        "\"fix\": [\"x\", \"x\"]",
        ": supports/0/fix/1: \"x\" is fixed twice",
    );
    one(
        COMPLETE,
        "\"traction\"",
        "\"body_force\": [1, 2], \"traction\"",
        ": loads/0/body_force: a surface takes \"traction\", not \"body_force\"",
    );
    one(
        COMPLETE,
        "\"absolute\": 0.01",
        "\"absolute\": 0.01, \"value\": 1",
        ": expect/probes/tip/displacement/2/value: this key was given before, in line 22",
    );
    one(
        SCENARIOS,
        "[20, 4, 4]",
        "[20, 4]",
        ": mesh/box/cells: \"hex20\" is a cell in 3 dimensions: 3 entries wanted, found 2",
    );
    one(
        SCENARIOS,
        "[20, 4, 4]",
        "[20000, 4000, 4000]",
        ": mesh/box/cells: this box would have some 7.7e12 unknowns; at most 4e6 are taken: use fewer cells",
    );
    one(SCENARIOS, "\"level\": 0.9", "\"level\": 1.5", ": risk/cvar/level: must lie between 0 and 1, found 1.5");
    one(SCENARIOS, "\"length\": \"0.3 m\", ", "", "modes belong to a field: give its covariance \"length\" too");
    one(
        SCENARIOS,
        "\"upper\": \"11 cm\"",
        "\"upper\": \"1 cm\"",
        "crossed bounds: \"lower\" is 0.09, not below \"upper\" 0.01",
    );
    one(
        SCENARIOS,
        "\"bulk\": \"200 kPa\", ",
        "\"bulk\": \"200 kPa\", \"young\": 1, ",
        ": materials/0: \"mooney_rivlin\" takes {mu1, mu2, mu3} or {shear, bulk, share} or {young, poisson, \
         share} or {c10, c01, d1}, found {shear, bulk, share, young}",
    );
}

#[test]
fn contradictions_between_blocks_are_found() {
    one(
        COMPLETE,
        "\"of\": \"tension\"",
        "\"of\": \"tensoin\"",
        ": controls/0/of: no actuation \"tensoin\": did you mean \"tension\"? (one of: tension)",
    );
    one(
        COMPLETE,
        "\"start\": \"0 Pa\"",
        "\"start\": \"1 mT\"",
        ": controls/0/start: unit of the wrong kind: \"1 mT\" is a magnetic field, a pressure is wanted (Pa, \
         kPa, MPa, GPa, bar, mbar)",
    );
    one(
        COMPLETE,
        "\"lower\": \"-400 kPa\"",
        "\"lower\": \"-400 mm\"",
        ": controls/0/lower: unit of the wrong kind: \"-400 mm\" is a length, a pressure is wanted (Pa, kPa, MPa, GPa, bar, mbar)",
    );
    one(
        COMPLETE,
        "\"probability\": 0.5, \"set\": { \"materials/0/mu1\": \"90",
        "\"probability\": 0.4, \"set\": { \"materials/0/mu1\": \"90",
        ": scenarios: the probabilities add up to 0.9, not to 1",
    );
    one(COMPLETE, "\"probability\": 0.5, ", "", ": scenarios: 1 of 2 scenarios have a probability: give all or none");
    one(
        COMPLETE,
        "materials/0/mu1\": \"90 kPa\"",
        "materials/0/mu1\": \"90 mm\"",
        ": materials/0/mu1: unit of the wrong kind: \"90 mm\" is a length, a pressure is wanted (Pa, kPa, MPa, GPa, bar, mbar)",
    );
    one(
        COMPLETE,
        "materials/0/mu1\": \"90 kPa\"",
        "materials/0/mu\": \"90 kPa\"",
        ": materials/0/mu: unknown key \"mu\": did you mean \"mu1\"? (one of: region, law, mu1, mu2, mu3, mu4, fiber)",
    );
    one(
        COMPLETE,
        "materials/0/mu1\": \"90 kPa\"",
        "mesh\": \"90 kPa\"",
        ": scenarios/0/set/mesh: \"mesh\" cannot vary between scenarios or load cases, only materials, \
         supports, loads, actuation, costs can",
    );
    one(
        COMPLETE,
        "\"risk\": \"mean\"",
        "\"risk\": { \"mean_deviation\": { \"lambda\": -1 } }",
        ": risk/mean_deviation/lambda: must not be negative, found -1",
    );
    one(
        SCENARIOS,
        "\"path\": \"materials/0/shear\", \"gamma\": { \"mean\": \"40 kPa\"",
        "\"path\": \"materials/0/share\", \"gamma\": { \"mean\": \"40 kPa\"",
        "is random twice",
    );
    one(
        SCENARIOS,
        "\"mean\": \"40 kPa\"",
        "\"mean\": \"40 mm\"",
        ": materials/0/shear: unit of the wrong kind: \"40 mm\" is a length, a pressure is wanted (Pa, kPa, MPa, GPa, bar, mbar)",
    );
    one(
        SCENARIOS,
        "\"path\": \"materials/0/bulk\"",
        "\"path\": \"materials/3/bulk\"",
        ": materials/3/bulk: \"materials\" has no entry \"3\": its entries are 0 to 0",
    );

    one(
        MAGNETS,
        "\"of\": \"magnet.remanence\"",
        "\"of\": \"magnet.remanenc\"",
        "no actuation \"magnet.remanenc\": did you mean \"magnet.remanence\"? (one of: magnet.remanence, \
         magnet.field, cells, muscle)",
    );
    one(
        MAGNETS,
        "\"of\": \"muscle\", \"space\"",
        "\"of\": \"cells\", \"name\": \"muscle\", \"space\"",
        "\"muscle\" has no effect: its tension is zero; give \"tension\" a value, or a control { \"of\": \
         \"muscle\", ... }",
    );
    one(
        MAGNETS,
        "\"of\": \"design\"",
        "\"of\": \"desing\"",
        ": costs/0/of: no control \"desing\": did you mean \"design\"? (one of: design, muscle)",
    );
    one(
        MAGNETS,
        "\"norm\": \"100 mT\"",
        "\"norm\": \"100 mT\", \"max_norm\": 1",
        "\"norm\" fixes the length already: give one of them",
    );
    one(
        MAGNETS,
        "\"start\": [1, \"0\", \"0 T\"], ",
        "",
        "missing key \"start\": zero, the default, does not have the \"norm\"",
    );
    one(
        MAGNETS,
        "\"start\": [1, \"0\", \"0 T\"], ",
        "\"start\": [0, 0, \"0 T\"], ",
        "a zero vector cannot be given the \"norm\"",
    );
    one(
        MAGNETS,
        "\"start\": [1, \"0\", \"0 T\"], ",
        "\"start\": \"1 T\", ",
        "\"magnet.remanence\" is a vector: give two or three entries",
    );
    one(
        MAGNETS,
        "\"start\": [1, \"0\", \"0 T\"], ",
        "\"start\": [1, 0, \"1 Pa\"], ",
        "controls/0/start/2: unit of the wrong kind: \"1 Pa\" is a pressure, a magnetic field is wanted (T, mT, uT)",
    );
    one(
        MAGNETS,
        "\"max_norm\": \"20 mT\"",
        "\"upper\": \"20 mT\"",
        "\"magnet.field\" is a vector: give \"norm\" or \"max_norm\"",
    );
    one(MAGNETS, "\"lower\": \"-1 kPa\"", "\"norm\": \"1 mT\"", "\"muscle\" is a scalar: give \"lower\" and \"upper\"");
    one(MAGNETS, "\"lower\": \"-1 kPa\"", "\"direction\": [1, 0]", "\"muscle\" is a scalar, it has no direction");
    one(MAGNETS, "\"start\": \"-1e-3 * X\"", "\"start\": [1, 2]", "\"muscle\" is a scalar: give one value");
    one(MAGNETS, "\"direction\": [0, 1], ", "\"direction\": [0, 2], ", "write [0.000000000, 1.000000000, 0.000000000]");
    one(
        MAGNETS,
        "\"name\": \"down\"",
        "\"name\": \"up\"",
        "load_cases/1/name: \"up\" has a load case already, at load_cases/0",
    );
    one(
        MAGNETS,
        "\"region\": \"core\"",
        "\"region\": \"skin\"",
        "materials/3/region: \"skin\" has a material already, at materials/2",
    );
    one(MAGNETS, "\"name\": \"down\"", "\"name\": \"do/wn\"", "load_cases/1/name: a name must not contain \"/\"");
    one(
        MAGNETS,
        "\"controls\": [ { \"of\": \"magnet.field\"",
        "\"controls\": [ { \"of\": \"muscle\", \"space\": \"cell\" }, { \"of\": \"magnet.field\"",
        "\"muscle\" has a control already, at controls/1",
    );
    one(
        MAGNETS,
        "\"pressure\": \"10 kPa * (X < 5 mm)\"",
        "\"pressure\": 0, \"mu0\": 1",
        "unknown key \"mu0\": did you mean \"name\"? (one of: name, kind, region, pressure)",
    );
}
