//! An optimisation of a program's own problem is that of a case file.

#![allow(clippy::unwrap_used, clippy::panic)] // a test may

use nastic_case::console::Console;
use nastic_case::run::{Exit, OnTrial, Optimum, Options, Outcome, Study, StudyError, run_document};
use nastic_case::schema::Command;
use nastic_case::syntax::Document;
use nastic_control::{ControlError, Cost, CostContext, CostPoint, Partials, Reduced, Space, Target, Tracking};
use nastic_energy::{FiberTension, NeoHooke};
use nastic_fem::Solid;
use nastic_mesh::{CellKind, box_mesh};
use nastic_opt::{Ball, Bounds, Lbfgs, Options as Stops};
use nastic_tensor::Vec3;
use serde_json::{Value, json};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

type Result<T = ()> = std::result::Result<T, Box<dyn std::error::Error>>;

const ITERATIONS: usize = 7;

fn lbfgs() -> Lbfgs {
    Lbfgs { options: Stops { max_iterations: ITERATIONS, tolerance: 1e-9, ..Stops::default() }, ..Lbfgs::default() }
}

fn bar(young: f64) -> Result<Reduced> {
    let body = Solid::new(box_mesh([1.0, 0.2, 0.2], [4, 1, 2], CellKind::Hex8)?)?
        .material("body", NeoHooke::from_young_poisson(young, 0.3)?)?
        .actuate("body", "top", FiberTension::along(Vec3::x())?)?
        .clamp("x-")?;
    Ok(Reduced::new(body).control("top", Space::Cell)?)
}

fn tracking(weight: f64) -> Tracking {
    Tracking::surface("x+", Target::position(|x| [0.95 * x[0], x[1], x[2] + 0.05])).weight(weight)
}

fn study(young: f64, weight: f64) -> Result<Study> {
    let study = Study::new(bar(young)?.cost(tracking(weight))?)?.within("top", Bounds::new(-1e5, 0.0)?);
    Ok(study.start("top", vec![-1e3]).probe("tip", [1.0, 0.1, 0.1]).checkpoints_every(2).snapshots_every(3).threads(2))
}

/// The same as [`study`], as a case file says it.
fn case() -> Value {
    json!({
        "nastic": 1,
        "title": "A bar",
        "mesh": { "box": { "size": [1.0, 0.2, 0.2], "cells": [4, 1, 2], "element": "hex8" } },
        "materials": [{ "region": "body", "law": "neo_hooke", "young": 3e5, "poisson": 0.3 }],
        "supports": [{ "surface": "x-", "fix": ["x", "y", "z"] }],
        "actuation": [{ "name": "top", "kind": "fiber_tension", "region": "body", "direction": [1, 0, 0] }],
        "controls": [{ "of": "top", "space": "cell", "start": -1e3, "lower": -1e5, "upper": 0.0 }],
        "costs": [{ "kind": "tracking", "surface": "x+", "target": ["0.95*X", "Y", "Z + 0.05"] }],
        "optimizer": { "method": "lbfgs", "max_iterations": ITERATIONS, "tolerance": 1e-9 },
        "probes": [{ "name": "tip", "point": [1.0, 0.1, 0.1] }],
        "output": { "every": 3, "checkpoint": 2 }
    })
}

/// A result without what a clock, the process, a file name or a directory makes of it.
fn compared(mut result: Value) -> Value {
    let entries = result.as_object_mut().unwrap();
    for key in ["seconds", "peak_memory", "case", "case_hash", "files", "expect", "resumed", "warnings"] {
        entries.remove(key);
    }
    result
}

/// The lines of `history.csv`, which knows no clock.
fn history(directory: &Path) -> String {
    std::fs::read_to_string(directory.join("history.csv")).unwrap()
}

/// Stops the study after so many trials.
fn stopped_after(study: Study, trials: usize) -> Study {
    let (flag, told) = (Arc::new(AtomicBool::new(false)), AtomicUsize::new(0));
    let raised = flag.clone();
    let count = move |_: &Value| {
        if told.fetch_add(1, Ordering::Relaxed) == trials {
            raised.store(true, Ordering::Relaxed);
        }
    };
    study.on_trial(OnTrial::call(count)).cancelled_by(flag)
}

#[test]
fn a_study_leaves_what_the_case_of_the_same_problem_leaves() -> Result {
    let place = tempfile::tempdir()?;
    let (ours, theirs) = (place.path().join("ours"), place.path().join("theirs"));
    let optimum = study(3e5, 1.0)?.title("A bar").directory(&ours).optimize(&lbfgs())?;
    let options = Options { out: Some(theirs.clone()), threads: Some(2), ..Options::default() };
    let document = Document::from_json("bar.json", &case());
    let (outcome, _) = run_document(Command::Optimize, document, &options, &Console::silent())?;

    assert_eq!((optimum.outcome.exit, outcome.exit), (Exit::NotConverged, Exit::NotConverged));
    assert_eq!(compared(optimum.outcome.result.clone()), compared(outcome.result.clone()));
    assert_eq!(history(&ours), history(&theirs));
    for file in ["start.vtu", "optimum.vtu", "target.vtu", "iteration_0003.vtu", "controls.json", "convergence.svg"] {
        assert!(std::fs::read(ours.join(file))? == std::fs::read(theirs.join(file))?, "{file} differs");
    }
    let mut files = names(&theirs)?;
    files.retain(|file| file != "case.json");
    assert_eq!(names(&ours)?, files);
    let page = std::fs::read_to_string(ours.join("report.html"))?;
    assert!(page.contains("<h1>A bar</h1>"));

    // And it has the states at hand.
    let point = optimum.states.point();
    assert_eq!(point.risk, outcome.result["cost"]["total"].as_f64().unwrap());
    assert_eq!(json!(point.m), outcome_controls(&theirs)?["top"]);
    Ok(())
}

fn names(directory: &Path) -> Result<Vec<String>> {
    let entries = std::fs::read_dir(directory)?.map(|entry| Ok(entry?.file_name().to_string_lossy().into_owned()));
    let mut names = entries.collect::<Result<Vec<String>>>()?;
    names.sort();
    Ok(names)
}

fn outcome_controls(directory: &Path) -> Result<Value> {
    Ok(serde_json::from_str(&std::fs::read_to_string(directory.join("controls.json"))?)?)
}

#[test]
fn a_study_that_was_stopped_goes_on_to_the_bit() -> Result {
    let place = tempfile::tempdir()?;
    let (whole, parts) = (place.path().join("whole"), place.path().join("parts"));
    let expected = study(3e5, 1.0)?.directory(&whole).resume(&lbfgs())?;
    let half = stopped_after(study(3e5, 1.0)?.directory(&parts), 5).optimize(&lbfgs())?;
    assert_eq!(half.outcome.exit, Exit::NotConverged);
    assert!(half.outcome.result["iterations"].as_u64() < expected.outcome.result["iterations"].as_u64());

    // Nothing is thrown away unasked.
    match study(3e5, 1.0)?.directory(&parts).optimize(&lbfgs()) {
        Err(StudyError::Interrupted { iteration, .. }) => assert!(iteration > 0),
        other => panic!("{other:?}"),
    }
    let Optimum { outcome: Outcome { result, .. }, states } = study(3e5, 1.0)?.directory(&parts).resume(&lbfgs())?;
    assert!(result["resumed"]["iteration"].as_u64() > Some(0));
    assert_eq!(compared(result), compared(expected.outcome.result));
    assert_eq!(states.point().m, expected.states.point().m);
    assert_eq!(history(&parts), history(&whole));
    Ok(())
}

#[test]
fn another_problem_does_not_go_on() -> Result {
    let place = tempfile::tempdir()?;
    let out = place.path().join("bar");
    stopped_after(study(3e5, 1.0)?.directory(&out), 5).optimize(&lbfgs())?;
    let refused = |study: Study| -> Result<String> {
        match study.directory(&out).resume(&lbfgs()) {
            Err(error) => Ok(error.to_string()),
            Ok(_) => panic!("it went on"),
        }
    };
    let law = refused(study(3.1e5, 1.0)?)?;
    assert!(law.contains("potential") && law.contains("a law or a load of the program has changed"), "{law}");
    let cost = refused(study(3e5, 1.1)?)?;
    assert!(cost.contains("a cost of the program has changed"), "{cost}");
    let start = refused(study(3e5, 1.0)?.start("top", vec![-2e3]))?;
    assert!(start.contains("controls/top/start was"), "{start}");
    let set = refused(study(3e5, 1.0)?.within("top", Bounds::new(-2e5, 0.0)?))?;
    assert!(set.contains("controls/top/set was"), "{set}");

    // The command line cannot know the program's code, and says so.
    let catalogue = nastic_case::catalogue::Catalogue::standard();
    let told = nastic_case::run::resume(&catalogue, &out, &Options::default(), &Console::silent()).unwrap_err();
    assert!(told.to_string().contains("Study::resume"), "{told}");

    // Begun anew where that is said.
    let anew = study(3.1e5, 1.0)?.directory(&out).restart(true).optimize(&lbfgs())?;
    assert!(anew.outcome.result["resumed"].is_null());
    Ok(())
}

/// `sum_a |u_a|^2`, with a derivative that is `factor` times the right one.
#[derive(Debug)]
struct Stillness {
    factor: f64,
}

#[derive(Debug)]
struct Moved {
    factor: f64,
    u: Vec<f64>,
}

impl Cost for Stillness {
    fn name(&self) -> &str {
        "stillness"
    }

    fn at(&self, at: &CostContext) -> std::result::Result<Arc<dyn CostPoint>, ControlError> {
        Ok(Arc::new(Moved { factor: self.factor, u: at.u.to_vec() }))
    }
}

impl CostPoint for Moved {
    fn value(&self) -> f64 {
        self.u.iter().map(|u| u * u).sum()
    }

    fn add_partials(&self, out: &mut Partials) -> std::result::Result<(), ControlError> {
        out.u.iter_mut().zip(&self.u).for_each(|(d, u)| *d += self.factor * 2.0 * u);
        Ok(())
    }
}

#[test]
fn a_cost_of_ones_own_is_checked_before_anything_is_optimised() -> Result {
    let of = |factor: f64| -> Result<Study> {
        let problem = bar(3e5)?.cost(tracking(1.0))?.cost(Stillness { factor })?;
        Ok(Study::new(problem)?.within("top", Bounds::new(-1e5, 0.0)?).start("top", vec![-1e4]))
    };
    let right = of(1.0)?.optimize(&lbfgs())?;
    assert!(right.outcome.result["cost"]["terms"]["stillness"].as_f64() > Some(0.0));
    match of(1.5)?.optimize(&lbfgs()) {
        Err(StudyError::Derivative { mismatch: Some(mismatch) }) => assert!(mismatch > 1e-3, "{mismatch}"),
        other => panic!("{other:?}"),
    }
    Ok(())
}

#[test]
fn what_does_not_fit_is_told_before_anything_is_solved() -> Result {
    let new = || -> Result<Study> { Ok(Study::new(bar(3e5)?.cost(tracking(1.0))?)?) };
    let told = |study: Study| study.optimize(&lbfgs()).err().map_or_else(String::new, |error| error.to_string());
    let unknown = told(new()?.within("tip", Bounds::new(0.0, 1.0)?));
    assert_eq!(unknown, "there is no control \"tip\"; there are: top");
    let outside =
        told(new()?.within("top", Bounds::new(-1e5, 0.0)?).start("top", vec![0., 0., 1e3, 0., 0., 0., 0., 0.]));
    assert!(outside.starts_with("the start of \"top\" at cell 2 lies outside its set"), "{outside}");
    assert_eq!(told(new()?.start("top", vec![0.0; 3])), "\"top\" has 8 values, its start 3");
    assert_eq!(told(new()?.start_at(vec![0.0; 9])), "the start has 9 values, the control vector 8");
    let probe = told(new()?.probe("tip", [1.0, 0.1, 0.3]));
    assert!(probe.starts_with("probe \"tip\": (1, 0.1, 0.3) is outside the body"), "{probe}");
    let short = told(new()?.within("top", Bounds::new(vec![0.0; 3], vec![1.0; 3])?));
    assert!(short.contains("the bounds are for 3 components, the control has 8"), "{short}");
    let ball = told(new()?.within("top", Ball::new(3, 1.0)?));
    assert!(!ball.is_empty());
    Ok(())
}
