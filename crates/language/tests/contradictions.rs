//! Cases that contradict themselves: every contradiction is reported once, with its place and what would be right.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::{COMPLETE, one};

const MAGNETS: &str = include_str!("cases/magnets.json");
const SCENARIOS: &str = include_str!("cases/scenarios.json");

#[test]
fn a_smoothed_distance_has_no_name_of_a_distance_in_results() {
    one(
        COMPLETE,
        "\"kind\": \"smoothed_hausdorff\", ",
        "\"kind\": \"smoothed_hausdorff\", \"name\": \"true\", ",
        ": costs/0/name: \"true\" is the name of a distance in results; take another one",
    );
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
        ": supports/0: this holds nothing: give \"fix\": \"all\", \"fix\": [\"x\", ...], \"displacement\": { \"x\": ... } or a \"foundation\"",
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
    one(SCENARIOS, "\"length\": \"0.3 m\", ", "", "modes belong to a field: give its correlation \"length\" too");
    one(SCENARIOS, "\"modes\": 5", "\"modes\": 5.5", "or a share of the variance below 1, as 0.9; found 5.5");
    one(
        SCENARIOS,
        "\"length\": \"0.3 m\", \"modes\": 5",
        "\"kernel\": \"matern\"",
        "a kernel belongs to a field: give its correlation \"length\" too",
    );
    one(
        SCENARIOS,
        "{ \"cvar\": { \"level\": 0.9, \"smoothing\": 0.01 } }",
        "{ \"first_order\": { \"deviations\": 2 } }",
        ": scenarios/rule: the risk \"first_order\" makes no scenarios: leave \"rule\" out, or take another risk",
    );
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
        ": controls/0/of: no actuation \"tensoin\": did you mean \"tension\"? (one of: tension, tension.direction)",
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
        ": materials/0/mu: unknown key \"mu\": did you mean \"mu1\"? (one of: name, region, law, formulation, rigid, density, maxwell, kelvin_voigt, design, mu1, mu2, mu3, mu4, fiber)",
    );
    one(
        COMPLETE,
        "materials/0/mu1\": \"90 kPa\"",
        "mesh\": \"90 kPa\"",
        ": scenarios/0/set/mesh: \"mesh\" cannot vary between scenarios or load cases, only materials, \
         supports, springs, media, obstacles, contact, loads, actuation, electrodes, costs can, and \"controls/K/projection/eta\" between scenarios",
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
         magnet.field, cells, muscle, muscle.direction)",
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
        "\"magnet.field\" is a vector: give two or three entries, or \"norm\" or \"max_norm\"",
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
        "unknown key \"mu0\" (one of: name, kind, region, design, pressure)",
    );
}

/// What drives an actuation may be just what could not be read.
#[test]
fn a_mistake_in_an_actuation_is_told_once() {
    let idle =
        MAGNETS.replacen("\"of\": \"muscle\", \"space\"", "\"of\": \"cells\", \"name\": \"muscle\", \"space\"", 1);
    let region = "\"region\": \"tip\", \"direction\"";
    for (given, wanted) in [
        ("\"tension\": \"1 mm\"", "a pressure is wanted (Pa, kPa, MPa, GPa, bar, mbar)"),
        (
            "\"tensoin\": \"1 kPa\"",
            "did you mean \"tension\"? (one of: name, kind, direction, region, design, tension)",
        ),
    ] {
        one(&idle, region, &format!("{given}, {region}"), wanted);
    }
}

/// Beside an obstacle and between surfaces alike.
#[test]
fn friction_that_does_not_act_is_found() {
    let friction = "with friction an equilibrium depends on the way to it, and the case is static: give \"time\": { \"end\": \"1 s\", \"step\": \
                    \"10 ms\", \"start\": \"rest\", \"scheme\": \"quasi_static\" } with loads that grow, or leave this out";
    let speed = "the slip speed of a contact without friction: give \"friction\", or leave this out";
    let lagged = "lagged friction of a contact without friction: give \"friction\", or leave this out";
    let floor = "\"obstacles\": [ { \"name\": \"floor\", \"shape\": { \"half_space\": { \"point\": [0, 0, -9], \"normal\": [0, 0, 1] } } } ], ";
    for (before, touched) in [(floor, "\"obstacle\": \"floor\""), ("", "\"with\": \"clamp\"")] {
        for (key, value, message) in
            [("friction", "0.3", friction), ("slip_speed", "\"1 mm/s\"", speed), ("lagged", "true", lagged)]
        {
            let contact = format!("\"contact\": [ {{ \"surface\": \"tip\", {touched}, \"{key}\": {value} }} ], ");
            let to = format!("{before}{contact}\"loads\":");
            one(COMPLETE, "\"loads\":", &to, &format!(": contact/0/{key}: {message}"));
        }
        let contact = format!("\"contact\": [ {{ \"surface\": \"tip\", {touched}, \"friction\": -0.3 }} ], ");
        let to = format!("{before}{contact}\"loads\":");
        one(COMPLETE, "\"loads\":", &to, ": contact/0/friction: must not be negative, found -0.3");
    }
}

#[test]
fn a_square_is_not_bounded_by_zero() {
    let bounded = |bound: &str| {
        let tracking = r#""kind": "tracking", "surface": "tip", "target": ["X", "Y", "Z"]"#;
        format!("\"constraints\": [ {{ \"cost\": {{ {tracking} }}, \"{bound}\": 0, \"scale\": 1 }} ], \"costs\": [")
    };
    let message = ": constraints/0: \"tracking\" is a square: where it is zero its derivative is zero too, and no multiplier can \
                   hold it there; bound it by the square of what is near enough: \"at_most\"";
    one(COMPLETE, "\"costs\":     [", &bounded("equal"), message);
    let message = ": constraints/0: \"tracking\" is a square, which is never below zero: leave this bound out";
    one(COMPLETE, "\"costs\":     [", &bounded("at_least"), message);
}

#[test]
fn a_name_fits_into_names_of_files() {
    let name = "x".repeat(101);
    let message = ": probes/0/name: a name of 101 bytes; names of files bear it: at most 100";
    one(COMPLETE, "\"probes\":    [ { \"name\": \"tip\"", &format!("\"probes\": [ {{ \"name\": \"{name}\""), message);
}

#[test]
fn starts_are_counted_before_they_are_made() {
    one(
        COMPLETE,
        "\"optimizer\": {",
        "\"optimizer\": { \"starts\": 1000000000,",
        ": optimizer/starts: 1000000000 starts; at most 10000",
    );
}
