//! Whole cases that are right: every key arrives, in the case's units.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use nastic_language::schema::{
    Bound, Case, Cost, Element, Fixed, Input, KeyValue, Means, MeshSource, Metric, Parameter, Phi, Risk, Rule,
    Scenarios, Space, Stages, Start, Target, VectorField, vector_at,
};
use nastic_language::syntax::{Diagnostics, Document};

const COMPLETE: &str = include_str!("cases/complete.json");
const MAGNETS: &str = include_str!("cases/magnets.json");
const SCENARIOS: &str = include_str!("cases/scenarios.json");

fn case(text: &str) -> Case {
    Case::read(&Document::parse("case.json", text).unwrap()).unwrap_or_else(|problems| panic!("{problems}"))
}

fn number(input: &Input) -> Option<f64> {
    input.number().and_then(Parameter::constant)
}

fn scalar(parameter: &Parameter) -> Option<f64> {
    parameter.constant()
}

#[test]
fn the_documented_case_is_read_in_full() {
    let case = case(COMPLETE);
    assert_eq!(case.title.as_deref(), Some("Fibre-driven cantilever, Hausdorff target"));
    let MeshSource::File(mesh) = &case.mesh else { panic!("{:?}", case.mesh) };
    assert_eq!((mesh.file.as_str(), mesh.scale), ("../../meshes/cantilever.msh", 1.0));

    let material = &case.materials[0];
    assert_eq!((material.region.to_string().as_str(), material.law.name), ("body", "transverse_mooney_rivlin"));
    let values: Vec<_> = material.parameters.iter().map(|(name, value)| (*name, number(value))).collect();
    let values: Vec<_> = values.into_iter().filter(|(_, value)| value.is_some()).collect();
    assert_eq!(values, [("mu1", Some(1e5)), ("mu2", Some(2e4)), ("mu3", Some(3e5)), ("mu4", Some(1e6))]);
    let [x, y, z] = material.parameters["fiber"].direction().unwrap().constant().unwrap();
    assert!((x - 0.5f64.sqrt()).abs() < 1e-8 && x == y && z == 0.0);

    assert_eq!(case.supports[0].surface, Some("clamp".into()));
    assert_eq!(case.supports[0].fix.held(), [Some(0.0); 3]);
    let traction = case.loads[0].traction.as_ref().unwrap();
    assert_eq!(traction.field().unwrap().constant(), Some([0.0, 0.0, -5.0]));
    let fiber = &case.actuation[0];
    let Means::Law { region, parameters, .. } = &fiber.means else { panic!() };
    assert_eq!((fiber.name.as_str(), fiber.kind(), region.to_string().as_str()), ("tension", "fiber_tension", "body"));
    assert_eq!(parameters["direction"].direction().unwrap().constant(), Some([1.0, 0.0, 0.0]));
    assert!(fiber.fixed.is_empty());

    let control = &case.controls[0];
    assert_eq!((control.of.as_str(), control.name(), &control.space), ("tension", "tension", &Space::Cell));
    assert_eq!(control.lower.as_ref().and_then(Bound::scalar).and_then(scalar), Some(-4e5));
    assert_eq!(control.upper.as_ref().and_then(Bound::scalar).and_then(scalar), Some(1.9e5));
    let Some(Start::Scalar(start)) = &control.start else { panic!() };
    assert_eq!(start.constant(), Some(0.0));

    let Cost::SmoothedHausdorff(cost) = &case.costs[0] else { panic!() };
    let Phi::Exponential(phi) = &cost.phi else { panic!() };
    assert_eq!((phi.length, phi.fraction), (Some(0.1), None));
    let Stages::List(stages) = &cost.stages else { panic!("{:?}", cost.stages) };
    let stages: Vec<_> = stages.iter().map(|s| (s.alpha, s.beta, s.gamma)).collect();
    assert_eq!(stages, [(1.0, 4.0, 4.0), (4.0, 16.0, 8.0)]);
    assert_eq!((cost.quadrature, cost.weight, &cost.target_region), (Some(2), 1.0, &Some("body".into())));

    let Scenarios::List(scenarios) = &case.scenarios else { panic!() };
    assert_eq!(scenarios.iter().map(|s| s.probability).collect::<Vec<_>>(), [Some(0.5), Some(0.5)]);
    assert_eq!(case.risk, Risk::Mean);
    assert_eq!((case.optimizer.method.name(), case.optimizer.max_iterations), ("projected_gradient", 100));
    assert_eq!((case.optimizer.tolerance, &case.optimizer.metric, case.optimizer.starts), (1e-4, &Metric::L2, 1));
    assert_eq!((case.probes[0].name.as_str(), case.probes[0].point.xyz()), ("tip", [1.0, 0.2, 0.2]));
    let expected = &case.expect["probes/tip/displacement/2"];
    assert_eq!(expected.command.as_ref().map(|c| c.name()), Some("optimize"));
    assert!(expected.is_met_by(0.404) && !expected.is_met_by(0.406) && !expected.is_met_by(f64::NAN));
    assert_eq!((case.output.directory.as_deref(), case.output.every), (Some("out/cantilever"), 10));
}

#[test]
fn a_scenario_is_the_case_with_other_values() {
    let document = Document::parse("case.json", COMPLETE).unwrap();
    let case = Case::read(&document).unwrap();
    let Scenarios::List(scenarios) = &case.scenarios else { panic!() };
    let stiff = |i: usize| {
        let variant = Case::read(&document.with(&scenarios[i].set.0).unwrap()).unwrap();
        number(&variant.materials[0].parameters["mu1"])
    };
    assert_eq!((stiff(0), stiff(1)), (Some(9e4), Some(1.1e5)));
}

#[test]
fn magnets_load_cases_and_every_other_key_are_read() {
    let case = case(MAGNETS);
    let MeshSource::File(mesh) = &case.mesh else { panic!() };
    assert_eq!(mesh.scale, 1000.0);
    // Millimetres and newtons: pressures are megapascals.
    assert_eq!(number(&case.materials[0].parameters["shear"]), Some(0.2));
    assert_eq!(case.materials[2].parameters.keys().copied().collect::<Vec<_>>(), ["poisson", "young"]);
    let Some(Parameter::Formula(mu2)) = case.materials[1].parameters["mu2"].number() else { panic!() };
    assert_eq!(mu2.at([500.0, 0.0, 0.0]).unwrap(), 0.05 * 1.5);
    let Some(Parameter::Array(mu4)) = case.materials[1].parameters["mu4"].number() else { panic!() };
    assert_eq!((mu4.file.as_str(), mu4.array.as_str()), ("stiff.vtu", "mu4"));
    assert!(matches!(case.materials[1].parameters["fiber"], Input::Direction(VectorField::Array(_))));
    let moved = case.supports[0].displacement.as_ref().unwrap().entries();
    assert!(moved[0].is_none() && moved[1].is_none());
    assert_eq!(moved[2].unwrap().at([500.0, 0.0, 0.0]).unwrap(), 0.5);
    let traction = case.loads[0].traction.as_ref().and_then(|traction| traction.field());
    let Some(VectorField::Formulas(traction)) = traction else { panic!() };
    assert_eq!(vector_at(traction, [11.0, 0.0, 0.0]).unwrap(), [0.0, -5e-6, 0.0]);
    let weight = case.loads[1].body_force.as_ref().unwrap().field().unwrap().constant().unwrap()[2];
    assert!((weight / -9.81e-6 - 1.0).abs() < 1e-15, "{weight}");

    let magnet = &case.actuation[0];
    let Means::Law { parameters, .. } = &magnet.means else { panic!() };
    assert_eq!(parameters["variant"], Input::Word("isochoric"));
    assert!((number(&parameters["mu0"]).unwrap() / 1.2 - 1.0).abs() < 1e-15);
    let Fixed::Scalar(Parameter::Formula(pressure)) = &case.actuation[1].fixed["pressure"] else { panic!() };
    assert_eq!(pressure.at([4.0, 0.0, 0.0]).unwrap(), 0.01);
    assert_eq!(case.controls[0].length(), Some(0.1));
    assert!(matches!(case.controls[1].upper, Some(Bound::Scalar(Parameter::Array(_)))));
    assert_eq!(case.costs[1].name(), "effort");
    assert_eq!(case.costs[0].name(), "control_smoothness");

    let [up, down] = case.load_cases.as_slice() else { panic!() };
    assert_eq!((up.weight, down.weight), (1.0, 0.5));
    assert_eq!(up.set.0[0].path, "actuation/1/pressure");
    assert_eq!(up.controls[0].longest(), Some(0.02));
    assert_eq!(up.controls[0].start, Some(Start::Random(7)));
    assert_eq!(down.controls[0].direction.as_ref().unwrap().xyz(), [0.0, 1.0, 0.0]);
    let KeyValue::Target(Target::Formulas(target)) = &up.costs[0].term().unwrap().values["target"] else { panic!() };
    assert_eq!(vector_at(target, [1.0, 2.0, 3.0]).unwrap(), [1.0, 102.0, 3.0]);
    let Cost::SmoothedHausdorff(shape) = &down.costs[2] else { panic!() };
    let MeshSource::Box(target) = &shape.target else { panic!() };
    assert_eq!((&target.element, target.cells.as_slice()), (&Element(nastic_mesh::CellKind::Quad9), [4, 1].as_slice()));
    assert_eq!(case.optimizer.metric, Metric::H1(5.0));
}

#[test]
fn random_scenarios_are_read() {
    let case = case(SCENARIOS);
    let Scenarios::Random(random) = &case.scenarios else { panic!() };
    assert_eq!((&random.rule, random.seed, random.random.len()), (&Some(Rule::Gauss(3)), 5, 4));
    assert_eq!(random.random[0].gamma.as_ref().unwrap().mean, 4e4);
    assert!(matches!(&case.risk, Risk::ConditionalValueAtRisk(risk) if risk.level == 0.9));
    assert_eq!(number(&case.materials[0].parameters["share"]), Some(0.5));
    assert_eq!(case.output.every, 10, "blocks left out have their defaults");
}

#[test]
fn short_forms_say_the_same() {
    let whole = r#"{ "nastic": 1, "mesh": "a.msh", "units": { "length": "mm", "force": "N", "time": "s", "field": "T" },
        "materials": [ { "region": "body", "law": "transverse_mooney_rivlin", "mu1": 1, "mu2": 1, "mu3": 1, "mu4": 1, "fiber": [0, 0, -1] } ],
        "supports": [ { "surface": "left", "fix": ["x", "y", "z"] }, { "surface": "right", "fix": ["y"] } ],
        "actuation": [ { "name": "muscle", "kind": "fiber_tension", "region": "body", "direction": [1, 0, 0], "tension": "2 kPa" },
                       { "name": "magnet", "kind": "magnet", "region": "body", "remanence": [1, 0, 0] } ],
        "controls": [ { "of": "magnet.field", "space": "uniform", "direction": [0, -1, 0], "max_norm": 1 } ] }"#;
    let mut short = whole.to_owned();
    for (from, to) in [
        (r#"{ "length": "mm", "force": "N", "time": "s", "field": "T" }"#, r#""mm""#),
        ("[0, 0, -1]", r#""-z""#),
        (r#"["x", "y", "z"]"#, r#""all""#),
        (r#"["y"]"#, r#""y""#),
        (r#""direction": [1, 0, 0]"#, r#""direction": "x""#),
        ("[0, -1, 0]", r#""-y""#),
    ] {
        assert!(short.contains(from), "{from}");
        short = short.replacen(from, to, 1);
    }
    let (whole, short) = (case(whole), case(&short));
    assert_eq!(whole.units, short.units);
    assert_eq!(short.units.label(nastic_language::quantity::Dimension::PRESSURE), "MPa");
    assert_eq!(whole.materials[0].parameters, short.materials[0].parameters);
    let held = |case: &Case| -> Vec<_> { case.supports.iter().map(|support| support.fix.held()).collect() };
    assert_eq!(held(&whole), held(&short));
    assert_eq!(held(&short), [[Some(0.0); 3], [None, Some(0.0), None]]);
    assert_eq!((&whole.actuation, &whole.controls), (&short.actuation, &short.controls));
    let Some(Fixed::Scalar(tension)) = short.actuation[0].fixed.get("tension") else { panic!() };
    assert!((scalar(tension).unwrap() - 2e-3).abs() < 1e-18, "megapascals");
}

#[test]
fn overrides_are_read_like_the_file() {
    let mut document = Document::parse("case.json", COMPLETE).unwrap();
    document.set("materials/0/mu1=80 kPa").unwrap();
    document.set("optimizer/method=lbfgs").unwrap();
    document.set("expect/probes/tip/displacement/2/value=0.4").unwrap();
    let case = Case::read(&document).unwrap();
    assert_eq!(number(&case.materials[0].parameters["mu1"]), Some(8e4));
    assert_eq!(case.optimizer.method.name(), "lbfgs");
    assert_eq!(case.expect["probes/tip/displacement/2"].value, 0.4);
    document.set("materials/0/mu1=80 mm").unwrap();
    document.set("materials/0/colour=red").unwrap();
    let found: Diagnostics = Case::read(&document).unwrap_err();
    let expected = "--set materials/0/mu1=80 mm: materials/0/mu1: unit of the wrong kind: \"80 mm\" is a \
     length, a pressure is wanted (Pa, kPa, MPa, GPa, bar, mbar)";
    assert!(found.to_string().contains(expected), "{found}");
    assert!(found.to_string().contains("--set materials/0/colour=red: materials/0/colour: unknown key"), "{found}");
    assert_eq!(found.list().len(), 2, "{found}");
}

/// A generated file with a mistake in every line ends at once, and says that there are more.
#[test]
fn at_most_a_hundred_problems_are_told() {
    let keys: String = (0..20_000).map(|k| format!("\"key{k}\": {k},\n")).collect();
    let document = Document::parse("case.json", &format!("{{\n{keys}{}", &COMPLETE.trim_start()[1..])).unwrap();
    let found = Case::read(&document).unwrap_err();
    assert!(found.list().len() == Diagnostics::MOST && found.has_more(), "{}", found.list().len());
    assert!(found.list()[99].to_string().starts_with("case.json:101:1: key99: unknown key"), "{}", found.list()[99]);
    assert!(found.to_string().ends_with("\nthere are more problems than these 100"), "{found}");
}

#[test]
fn errors_found_later_point_at_the_same_lines() {
    let document = Document::parse("case.json", COMPLETE).unwrap();
    let case = Case::read(&document).unwrap();
    let problem = document.complain(&case.supports[0].at.key("surface"), "surface \"clamp\" not found; it has: x-, x+");
    assert_eq!(problem.to_string(), "case.json:10:31: supports/0/surface: surface \"clamp\" not found; it has: x-, x+");
}
