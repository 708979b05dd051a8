//! An optimisation of a program's own problem is that of a case file.

#![allow(clippy::unwrap_used, clippy::panic)] // a test may

use nastic_case::lower::AssemblyError;
use nastic_control::{ControlError, Cost, CostContext, CostPoint, Metric, Partials, Reduced, Space, Target, Tracking};
use nastic_energy::{FiberTension, Magnet, NeoHooke};
use nastic_ensemble::{Ensemble, LoadCase};
use nastic_fem::Solid;
use nastic_language::quantity::{Unit, Units};
use nastic_language::schema::Command;
use nastic_language::syntax::Document;
use nastic_mesh::{CellKind, box_mesh};
use nastic_opt::{Ball, Bounds, Lbfgs, Options as Stops, Sphere};
use nastic_run::console::Console;
use nastic_run::record::TrialRecord;
use nastic_run::run::{Exit, OnTrial, Optimum, Options, Outcome, RunError, Study, StudyError, run_document};
use nastic_tensor::Vec3;
use nastic_uncertainty::risk::Mean;
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
    Ok(set_up(Study::new(bar(young)?.cost(tracking(weight))?)?.within("top", Bounds::new(-1e5, 0.0)?)))
}

/// Start, probe and schedule of all studies that are compared.
fn set_up(study: Study) -> Study {
    study.start("top", vec![-1e3]).probe("tip", [1.0, 0.1, 0.1]).checkpoints_every(2).snapshots_every(3).threads(2)
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
    let (flag, described) = (Arc::new(AtomicBool::new(false)), AtomicUsize::new(0));
    let raised = flag.clone();
    let count = move |_: &TrialRecord| {
        if described.fetch_add(1, Ordering::Relaxed) == trials {
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

    // What is more than laws and costs is compared before anything is computed.
    let problem = || -> Result<Reduced> { Ok(bar(3e5)?.cost(tracking(1.0))?) };
    let of =
        |problem: Reduced| -> Result<Study> { Ok(set_up(Study::new(problem)?.within("top", Bounds::new(-1e5, 0.0)?))) };
    let weight = refused(of(problem()?.weigh("top", 2.0)?)?)?;
    assert!(weight.contains("controls/top/weight was 1, is 2"), "{weight}");
    let metric = refused(of(problem()?.metric(Metric::H1 { length: 0.1 }))?)?;
    assert!(metric.contains("controls/top/metric was \"L2\""), "{metric}");
    let supported = passive_bar([4, 1, 2])?.actuate("body", "top", FiberTension::along(Vec3::x())?)?.clamp("x+")?;
    let supports = refused(of(Reduced::new(supported).control("top", Space::Cell)?.cost(tracking(1.0))?)?)?;
    assert!(supports.contains("members/0/supports was"), "{supports}");
    match study(3e5, 1.0)?.directory(&out).resume(&Lbfgs { memory: 3, ..lbfgs() }) {
        Err(StudyError::Changed { what, .. }) => assert!(what[0].contains("memory: 3"), "{what:?}"),
        other => panic!("{other:?}"),
    }
    // No number is not the same number.
    let none = refused(of(bar(3e5)?.cost(Stillness { factor: f64::NAN, name: "tracking" })?)?)?;
    assert!(none.contains("does not fit: the cost is NaN"), "{none}");

    // The command line cannot know the program's code, and says so.
    let catalogue = nastic_language::catalogue::Catalogue::standard();
    let described = nastic_run::run::resume(&catalogue, &out, &Options::default(), &Console::silent()).unwrap_err();
    assert!(described.to_string().contains("Study::resume"), "{described}");

    // Begun anew where that is said.
    let anew = study(3.1e5, 1.0)?.directory(&out).restart(true).optimize(&lbfgs())?;
    assert!(anew.outcome.result["resumed"].is_null());
    Ok(())
}

#[test]
fn resume_begins_anew_where_that_is_said() -> Result {
    let place = tempfile::tempdir()?;
    stopped_after(study(3e5, 1.0)?.directory(place.path()), 5).optimize(&lbfgs())?;
    let anew = study(3.1e5, 1.0)?.directory(place.path()).restart(true).resume(&lbfgs())?;
    assert!(anew.outcome.result["resumed"].is_null());
    assert_eq!(anew.outcome.result["iterations"], ITERATIONS);
    Ok(())
}

#[test]
fn a_checkpoint_that_does_not_serve_is_told_in_words_for_a_program() -> Result {
    let place = tempfile::tempdir()?;
    stopped_after(study(3e5, 1.0)?.directory(place.path()), 5).optimize(&lbfgs())?;
    let file = place.path().join("checkpoint.bin");
    let whole = std::fs::read(&file)?;
    let described = |content: Vec<u8>| -> Result<[String; 2]> {
        std::fs::write(&file, content)?;
        let of =
            |found: std::result::Result<Optimum, StudyError>| found.err().map_or_else(String::new, |e| e.to_string());
        let study = || study(3e5, 1.0).map(|study| study.directory(place.path()));
        Ok([of(study()?.resume(&lbfgs())), of(study()?.optimize(&lbfgs()))])
    };
    for text in described(whole[..whole.len() - 1].to_vec())? {
        assert!(text.contains("is damaged") && text.contains("Study::restart(true)"), "{text}");
        assert!(!text.contains("--restart"), "{text}");
    }
    let [version, _] = described(of_version(whole, "0.0.9"))?;
    assert!(version.contains("was written by version 0.0.9") && version.contains("Study::restart(true)"), "{version}");
    Ok(())
}

/// The bytes of a checkpoint as another version would have written it: the version's text, then the checksum (FNV-1a) of length and content.
fn of_version(mut bytes: Vec<u8>, version: &str) -> Vec<u8> {
    let (own, header) = (env!("CARGO_PKG_VERSION").as_bytes(), "nastic-checkpoint".len() + 24);
    let at = bytes.windows(own.len()).position(|window| window == own).unwrap();
    bytes[at..at + own.len()].copy_from_slice(version.as_bytes());
    let mix = |hash: u64, byte: &u8| (hash ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3);
    let hashed = bytes[header - 16..header - 8].iter().chain(&bytes[header..]);
    let sum = hashed.fold(0xcbf2_9ce4_8422_2325, mix);
    bytes[header - 8..header].copy_from_slice(&sum.to_le_bytes());
    bytes
}

#[test]
fn a_study_without_a_flag_leaves_the_problem_its_own() -> Result {
    let raised = Arc::new(AtomicBool::new(true));
    let of = || -> Result<Study> {
        let problem = bar(3e5)?.cost(tracking(1.0))?.cancelled_by(raised.clone());
        Ok(set_up(Study::new(problem)?.within("top", Bounds::new(-1e5, 0.0)?)))
    };
    assert!(matches!(of()?.optimize(&lbfgs()), Err(StudyError::Run(RunError::Cancelled))));
    let lowered = Arc::new(AtomicBool::new(false));
    assert_eq!(of()?.cancelled_by(lowered).optimize(&lbfgs())?.outcome.exit, Exit::NotConverged);
    Ok(())
}

#[test]
fn a_body_in_millimetres_that_is_taken_for_metres_is_warned_of() -> Result {
    let of = || -> Result<Study> {
        let body = Solid::new(box_mesh([40.0, 8.0, 8.0], [4, 1, 2], CellKind::Hex8)?)?
            .material("body", NeoHooke::from_young_poisson(0.3, 0.3)?)?
            .actuate("body", "top", FiberTension::along(Vec3::x())?)?
            .clamp("x-")?;
        let target = Target::position(|x| [0.95 * x[0], x[1], x[2]]);
        let problem = Reduced::new(body).control("top", Space::Uniform)?.cost(Tracking::surface("x+", target))?;
        Ok(Study::new(problem)?.within("top", Bounds::new(-0.1, 0.0)?).start("top", vec![-1e-3]))
    };
    let warned = |study: Study| -> Result<Vec<String>> {
        let result = study.optimize(&lbfgs())?.outcome.result;
        let all = result["warnings"].as_array().cloned().unwrap_or_default();
        let units = all.iter().filter(|one| one["code"] == "units");
        Ok(units.filter_map(|one| one["message"].as_str().map(str::to_owned)).collect())
    };
    assert_eq!(
        warned(of()?)?,
        ["the body measures 40 x 8 x 8 m: if the program computes in millimetres, say so with Study::units"]
    );
    let unit = |symbol: &str| Unit::named(symbol).ok_or("no such unit");
    let units = Units::new(unit("mm")?, unit("N")?, unit("s")?, unit("T")?).ok_or("one is no unit of this kind")?;
    assert!(warned(of()?.units(units))?.is_empty());
    Ok(())
}

/// `sum_a |u_a|^2`, with a derivative that is `factor` times the right one; NaN where that is.
#[derive(Debug)]
struct Stillness {
    factor: f64,
    name: &'static str,
}

#[derive(Debug)]
struct Moved {
    factor: f64,
    u: Vec<f64>,
}

impl Cost for Stillness {
    fn name(&self) -> &str {
        self.name
    }

    fn at(&self, at: &CostContext) -> std::result::Result<Arc<dyn CostPoint>, ControlError> {
        Ok(Arc::new(Moved { factor: self.factor, u: at.u.to_vec() }))
    }
}

impl CostPoint for Moved {
    fn value(&self) -> f64 {
        let sum: f64 = self.u.iter().map(|u| u * u).sum();
        if self.factor.is_nan() { f64::NAN } else { sum }
    }

    fn add_partials(&self, out: &mut Partials) -> std::result::Result<(), ControlError> {
        out.u.iter_mut().zip(&self.u).for_each(|(d, u)| *d += self.factor * 2.0 * u);
        Ok(())
    }
}

#[test]
fn a_cost_of_ones_own_is_checked_before_anything_is_optimised() -> Result {
    let of = |factor: f64| -> Result<Study> {
        let problem = bar(3e5)?.cost(tracking(1.0))?.cost(Stillness { factor, name: "stillness" })?;
        Ok(Study::new(problem)?.within("top", Bounds::new(-1e5, 0.0)?).start("top", vec![-1e4]))
    };
    let right = of(1.0)?.optimize(&lbfgs())?;
    assert!(right.outcome.result["cost"]["terms"]["stillness"].as_f64() > Some(0.0));
    match of(1.5)?.optimize(&lbfgs()) {
        Err(error @ StudyError::Derivative { mismatch: Some(mismatch) }) => {
            assert!(mismatch > 1e-3, "{mismatch}");
            assert!(error.to_string().contains("test each cost alone with Taylor::test"), "{error}");
        }
        other => panic!("{other:?}"),
    }
    Ok(())
}

#[test]
fn what_does_not_fit_is_told_before_anything_is_solved() -> Result {
    let new = || -> Result<Study> { Ok(Study::new(bar(3e5)?.cost(tracking(1.0))?)?) };
    let described = |study: Study| study.optimize(&lbfgs()).err().map_or_else(String::new, |error| error.to_string());
    let unknown = described(new()?.within("tip", Bounds::new(0.0, 1.0)?));
    assert_eq!(unknown, "there is no control \"tip\"; there are: top");
    let outside =
        described(new()?.within("top", Bounds::new(-1e5, 0.0)?).start("top", vec![0., 0., 1e3, 0., 0., 0., 0., 0.]));
    assert!(outside.starts_with("the start of \"top\" at cell 2 lies outside its set"), "{outside}");
    assert_eq!(described(new()?.start("top", vec![0.0; 3])), "\"top\" has 8 values, its start 3");
    assert_eq!(described(new()?.start_at(vec![0.0; 9])), "the start has 9 values, the control vector 8");
    let probe = described(new()?.probe("tip", [1.0, 0.1, 0.3]));
    assert!(probe.starts_with("probe \"tip\": (1, 0.1, 0.3) is outside the body"), "{probe}");
    let short = described(new()?.within("top", Bounds::new(vec![0.0; 3], vec![1.0; 3])?));
    assert!(short.contains("the bounds are for 3 components, the control has 8"), "{short}");
    Ok(())
}

#[test]
fn a_set_of_vectors_has_the_components_of_the_control() -> Result {
    // Three components would fit the number of values, 6, though not the scalars.
    let body = passive_bar([3, 1, 2])?.actuate("body", "top", FiberTension::along(Vec3::x())?)?;
    let problem = Reduced::new(body).control("top", Space::Cell)?.cost(tracking(1.0))?;
    let described = refused(Study::new(problem)?.within("top", Ball::new(3, 1e5)?))?;
    assert_eq!(
        described,
        "the vectors of the set of \"top\" have 3 components, the values of the control 1: make the set for 1, or give bounds"
    );
    let described = refused(magnet(Space::Cell, None)?.within("magnet.remanence", Sphere::new(2, 0.1)?))?;
    assert!(described.contains("have 2 components, the values of the control 3"), "{described}");
    Ok(())
}

#[test]
fn a_nodal_field_on_a_sphere_has_its_length_between_the_nodes_too() -> Result {
    let start = Sphere::new(3, 0.1)?.random(1, 1);
    let of = |space: Space, length: Option<f64>| -> Result<Study> {
        let study = magnet(space, length)?.within("magnet.remanence", Sphere::new(3, 0.1)?);
        let points = if space == Space::Node { 24 } else { 6 };
        Ok(study.start("magnet.remanence", start.repeat(points)))
    };
    let described = refused(of(Space::Node, None)?)?;
    assert!(described.contains("Reduced::of_length(\"magnet.remanence\", 0.1)"), "{described}");
    of(Space::Node, Some(0.1))?.optimize(&lbfgs())?;
    of(Space::Cell, None)?.optimize(&lbfgs())?;
    Ok(())
}

#[test]
fn random_starts_are_drawn_within_what_is_bounded() -> Result {
    let new = || -> Result<Study> { Ok(Study::new(bar(3e5)?.cost(tracking(1.0))?)?.random_starts(1, 5)) };
    assert_eq!(
        refused(new()?)?,
        "random starts are drawn within the bounds, and \"top\" has no lower bound: give it one with Study::within"
    );
    let above = refused(new()?.within("top", Bounds::new(-1e5, f64::INFINITY)?))?;
    assert!(above.contains("\"top\" has no upper bound"), "{above}");

    // Vectors of one component: as many of them as there are values.
    let found = new()?.within("top", Ball::new(1, 1e3)?).optimize(&lbfgs())?;
    let starts = found.outcome.result["starts"].as_array().map_or(&[][..], Vec::as_slice);
    assert_eq!(starts.len(), 2);
    assert!(starts.iter().all(|start| start["cost"].is_number()), "{starts:?}");
    Ok(())
}

#[test]
fn members_on_different_meshes_or_with_other_load_cases_are_refused_before_anything_is_solved() -> Result {
    let on = |cells: [usize; 3]| -> Result<Reduced> {
        let body = passive_bar(cells)?.actuate("body", "top", FiberTension::along(Vec3::x())?)?;
        Ok(Reduced::new(body).control("top", Space::Uniform)?.cost(tracking(1.0))?)
    };
    let meshes = Ensemble::new(Mean).scenario("coarse", 0.5, on([3, 1, 2])?).scenario("fine", 0.5, on([4, 1, 2])?);
    match Study::of(meshes.build()?).optimize(&lbfgs()) {
        Err(StudyError::Assembly(AssemblyError::Mesh { member, other })) => {
            assert_eq!((&*member, &*other), ("fine", "coarse"))
        }
        other => panic!("{other:?}"),
    }

    let case = |name: &str| -> Result<LoadCase> { Ok(LoadCase::new(name, 1.0, on([3, 1, 2])?)) };
    for (first, second, expected) in [
        (&["push", "lift"][..], &["push"][..], ("soft/lift", "stiff/push")),
        (&["push"][..], &["push", "lift"][..], ("stiff/lift", "soft/push")),
    ] {
        let cases = |names: &[&str]| names.iter().map(|name| case(name)).collect::<Result<Vec<_>>>();
        let ragged =
            Ensemble::new(Mean).scenario_of("soft", 0.5, cases(first)?).scenario_of("stiff", 0.5, cases(second)?);
        match Study::of(ragged.build()?).optimize(&lbfgs()) {
            Err(StudyError::Assembly(AssemblyError::LoadCases { member, other, load_case })) => {
                assert_eq!((&*member, &*other, &*load_case), (expected.0, expected.1, "lift"));
            }
            other => panic!("{other:?}"),
        }
    }
    Ok(())
}

fn refused(study: Study) -> Result<String> {
    match study.optimize(&lbfgs()) {
        Err(error) => Ok(error.to_string()),
        Ok(_) => panic!("it was not refused"),
    }
}

/// A passive bar, clamped.
fn passive_bar(cells: [usize; 3]) -> Result<Solid> {
    let body = Solid::new(box_mesh([1.0, 0.2, 0.2], cells, CellKind::Hex8)?)?;
    Ok(body.material("body", NeoHooke::from_young_poisson(3e5, 0.3)?)?.clamp("x-")?)
}

/// A bar whose remanence is controlled, in a given field.
fn magnet(space: Space, length: Option<f64>) -> Result<Study> {
    let body = passive_bar([3, 1, 2])?.actuate("body", "magnet", Magnet::new())?;
    let points = body.discretization().points().weights().len();
    let problem = Reduced::new(body).fix(0, 5, &vec![0.05; points])?;
    let problem = problem.control("magnet.remanence", space)?.cost(tracking(1.0))?;
    let problem = match length {
        Some(length) => problem.of_length("magnet.remanence", length)?,
        None => problem,
    };
    Ok(Study::new(problem)?)
}
