//! Costs and laws that a program adds to the catalogue.

#![allow(clippy::unwrap_used, clippy::panic)] // a test may

use nastic_control::{ControlError, Cost, CostContext, CostForm, CostInputs, CostPoint, Key, KeyKind, Partials};
use nastic_language::catalogue::Catalogue;
use nastic_language::schema::{Command, json_schema};
use nastic_run::console::Console;
use nastic_run::run::{Exit, Options, Outcome, RunError, SpectrumRefusal, SpectrumRequest, run_with};
use std::sync::Arc;

const BAR: &str = include_str!("../../language/tests/cases/bar.json");

/// weight/2 (u_z - height)^2 at every node of a surface.
#[derive(Debug)]
struct Lift {
    nodes: Vec<u32>,
    height: f64,
    weight: f64,
    /// Factor of the derivative: any but 1 is an error.
    slope: f64,
}

#[derive(Debug)]
struct LiftPoint {
    /// Unknown and how far it is from the height.
    gaps: Vec<(usize, f64)>,
    weight: f64,
    slope: f64,
}

impl Cost for Lift {
    fn name(&self) -> &str {
        "lift"
    }

    fn at(&self, at: &CostContext) -> Result<Arc<dyn CostPoint>, ControlError> {
        let gap = |node: &u32| (*node as usize * 3 + 2, at.u[*node as usize * 3 + 2] - self.height);
        let gaps = self.nodes.iter().map(gap).collect();
        Ok(Arc::new(LiftPoint { gaps, weight: self.weight, slope: self.slope }))
    }
}

impl CostPoint for LiftPoint {
    fn value(&self) -> f64 {
        self.weight * self.gaps.iter().map(|(_, gap)| 0.5 * gap * gap).sum::<f64>()
    }

    fn add_partials(&self, out: &mut Partials) -> Result<(), ControlError> {
        self.gaps.iter().for_each(|(dof, gap)| out.u[*dof] += self.slope * self.weight * gap);
        Ok(())
    }
}

const ABOUT: &str = "weight/2 (u_z - height)^2 at the nodes of a surface";
const KEYS: &[Key] = &[Key::SURFACE, Key::new("height", "How high.", KeyKind::Number { unit: "m", default: None })];

static LIFT: CostForm = CostForm::new("lift", ABOUT, KEYS, |on| Ok(Box::new(lift(on, 1.0)?)));

/// The same with a derivative that is wrong.
static WRONG: CostForm = CostForm::new("wrong_lift", ABOUT, KEYS, |on| Ok(Box::new(lift(on, 1.5)?)));

fn lift(on: &CostInputs, slope: f64) -> Result<Lift, ControlError> {
    let mesh = on.solid.mesh();
    let nodes = mesh.nodes_of_facets(&mesh.facets_of(&on.get("surface")?)?);
    Ok(Lift { nodes, height: on.get("height")?, weight: on.weight, slope })
}

fn run(cost: &str, command: Command) -> Result<Outcome, RunError> {
    run_set(cost, command, &[])
}

fn run_set(cost: &str, command: Command, more: &[&str]) -> Result<Outcome, RunError> {
    run_asked(cost, command, more, None)
}

fn run_asked(
    cost: &str,
    command: Command,
    more: &[&str],
    spectrum: Option<SpectrumRequest>,
) -> Result<Outcome, RunError> {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("case.json");
    std::fs::write(&path, BAR).unwrap();
    let set = [format!("costs={cost}")].into_iter().chain(more.iter().map(|set| (*set).to_owned())).collect();
    let options = Options { out: Some(directory.path().join("out")), set, spectrum, ..Options::default() };
    let catalogue = Catalogue::standard().with_cost(&LIFT).with_cost(&WRONG);
    run_with(&catalogue, command, &path, &options, &Console::silent())
}

#[test]
fn a_cost_of_ones_own_is_evaluated_and_its_derivative_is_right() {
    let cost = r#"[{ "kind": "lift", "surface": "x+", "height": "20 mm", "weight": 2 }]"#;
    let result = run(cost, Command::Gradient).unwrap().result;
    assert_eq!(result["gradient_check"]["verdict"], "right", "{result}");
    let once = r#"[{ "kind": "lift", "surface": "x+", "height": 0.02, "name": "up" }]"#;
    let single = run(once, Command::Gradient).unwrap().result;
    let (double, single) = (&result["cost"]["terms"]["lift"], &single["cost"]["terms"]["up"]);
    assert!((double.as_f64().unwrap() / single.as_f64().unwrap() - 2.0).abs() < 1e-12, "{double} {single}");
}

/// What has no second derivatives is still tested to first order, and says what it lacks; a term that has them is judged.
#[test]
fn gradcheck_of_a_cost_without_second_derivatives_says_so() {
    let lift = r#"{ "kind": "lift", "surface": "x+", "height": "20 mm" }"#;
    let gradcheck = |costs: &str| {
        let outcome = run(costs, Command::Gradcheck).unwrap();
        assert_eq!(outcome.exit, Exit::Done, "{}", outcome.result);
        outcome.result["gradcheck"].clone()
    };
    let alone = gradcheck(&format!("[{lift}]"));
    let said = alone["second"]["verdict"].as_str().unwrap();
    assert!(
        said.starts_with("not tested: ") && said.contains("in the library: `CostPoint::add_second_partials`"),
        "{said}"
    );
    assert_eq!(
        (&alone["tests"][0]["verdict"], &alone["tests"][0]["second"]),
        (&"right".into(), &serde_json::Value::Null)
    );
    let norm = r#"{ "kind": "control_norm", "of": "tension", "weight": 1e-12 }"#;
    let both = gradcheck(&format!("[{lift}, {norm}]"));
    let said = both["second"]["verdict"].as_str().unwrap();
    assert!(said.starts_with("right: every order is 3; not of every term: "), "{said}");
}

/// The spectrum is refused before the run, by the name of what has no second derivatives; without it the cost is optimised.
#[test]
fn no_spectrum_of_a_cost_without_second_derivatives() {
    let lift = r#"[{ "kind": "lift", "surface": "x+", "height": "20 mm" }]"#;
    let optimize = |spectrum| run_asked(lift, Command::Optimize, &["optimizer/max_iterations=1"], spectrum);
    let error = optimize(Some(SpectrumRequest::leading(2))).unwrap_err();
    assert!(
        matches!(error, RunError::Spectrum(SpectrumRefusal::SecondDerivatives(_))) && error.exit() == Exit::BadInput
    );
    let said = error.to_string();
    assert!(said.contains("\"lift\" gives no second derivatives"), "{said}");
    assert_eq!(optimize(None).unwrap().exit, Exit::NotConverged);
}

/// An optimisation that does not begin shows what is doubtful of its start all the same, once.
#[test]
fn a_wrong_derivative_does_not_hide_the_warnings_of_the_start() {
    let cost = r#"[{ "kind": "wrong_lift", "surface": "x+", "height": "20 mm" }]"#;
    let pushed = [r#"loads=[{ "surface": "x+", "traction": ["-30 kPa", 0, 0] }]"#, "controls/0/start=0"];
    let outcome = run_set(cost, Command::Optimize, &pushed).unwrap();
    assert_eq!(outcome.exit, Exit::GradientWrong);
    let warnings = outcome.result["warnings"].as_array().unwrap();
    let unstable: Vec<_> = warnings.iter().filter(|warning| warning["code"] == "unstable").collect();
    assert_eq!(unstable.len(), 1, "{warnings:?}");
    assert_eq!(unstable[0]["place"], "start");
}

#[test]
fn its_keys_are_known_to_reader_and_schema() {
    let complaint = |cost: &str| run(cost, Command::Check).unwrap_err().to_string();
    let said = complaint(r#"[{ "kind": "lift", "surface": "x+", "heigth": "20 mm" }]"#);
    assert!(said.contains("did you mean \"height\"?"), "{said}");
    let said = complaint(r#"[{ "kind": "lift", "surface": "x+", "height": "20 kPa" }]"#);
    assert!(said.contains("is a pressure, a length is wanted"), "{said}");
    let said = complaint(r#"[{ "kind": "lift", "surface": "tip", "height": "20 mm" }]"#);
    assert!(said.contains("\"tip\" not found") && said.contains("costs/0"), "{said}");
    let said = complaint(r#"[{ "kind": "lift", "surface": "x+", "height": "0.1 * X" }]"#);
    assert!(said.contains("depends on X, Y or Z, but one number is wanted"), "{said}");
    let said = complaint(r#"[{ "kind": "lft" }]"#);
    assert!(said.contains("did you mean \"lift\"?"), "{said}");
    assert!(json_schema(&Catalogue::standard().with_cost(&LIFT)).to_string().contains("\"lift\""));
    assert!(!json_schema(&Catalogue::standard()).to_string().contains("\"lift\""));
}
