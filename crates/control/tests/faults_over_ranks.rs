//! Reduced problems of one body over ranks, which are threads here, where one rank fails, refuses, is cancelled or is lost: all end, none waits.

use crate::ranks::{Outcome, bar, on, on_faulty, part, valued};
use nastic_control::{
    ControlError, Cost, CostContext, CostPoint, Evaluated, MeanPosition, Metric, Partials, Reduced, ReducedWorkspace,
    SmoothedHausdorff, Space, Target, Tracking,
};
use nastic_energy::{FiberTension, NeoHooke};
use nastic_fem::{Solid, State};
use nastic_mesh::{CellKind, Mesh, box_mesh};
use nastic_opt::{Bounds, Failed, Lbfgs, Objective, Optimizer, Problem, Request, Stop, Trial};
use nastic_team::{Team, ThreadRank};
use nastic_tensor::Vec3;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

const ELSEWHERE: &str = "another rank refuses";

fn reduced(solid: Solid) -> Outcome<Reduced> {
    let solid = solid
        .material("body", NeoHooke::new(1e5, 1e6)?)?
        .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
        .clamp("x-")?;
    Ok(Reduced::new(solid).sequential().control("tension", Space::Uniform)?)
}

/// The end of the bar is to be lower in x.
fn shortened(solid: Solid) -> Outcome<Reduced> {
    let shorter = Target::position(|x| [0.95 * x[0], x[1], x[2]]);
    Ok(reduced(solid)?.cost(Tracking::surface("x+", shorter))?)
}

fn short(mesh: &Mesh, rank: &Arc<ThreadRank>) -> Outcome<Reduced> {
    shortened(part(mesh, rank, false)?)
}

/// That one rank says why it fails, the others that another one does.
fn assert_one_knows(found: Vec<Result<(), String>>, rank: usize, why: &str) {
    for (k, found) in found.into_iter().enumerate() {
        let error = found.err().unwrap_or_else(|| format!("nothing on rank {k}"));
        assert!(error.contains(if k == rank { why } else { ELSEWHERE }), "rank {k}: {error}");
    }
}

#[test]
fn a_flag_that_one_rank_raises_cancels_all_at_the_same_trial() -> Outcome {
    let mesh = bar(CellKind::Hex8, 1)?;
    for raised_at in [0, 2] {
        let found = on(3, |rank| {
            let problem = short(&mesh, &rank)?;
            let raises = rank.rank() == 1;
            let flag = Arc::new(AtomicBool::new(raises && raised_at == 0));
            let (to_raise, mut trials) = (flag.clone(), 0);
            let watch = move |_: &Trial<'_, Evaluated>| {
                trials += 1;
                if raises && trials == raised_at {
                    to_raise.store(true, Ordering::Relaxed);
                }
            };
            let mut within = Lbfgs::default().within(Bounds::new(-2e5, 0.0)?).tolerance(1e-12).observe(watch);
            if raises {
                within = within.cancelled_by(flag);
            }
            let best = within.minimize(&problem, &problem.at(&[0.0])?)?;
            Ok((best.stop, best.counts, best.m))
        });
        let (stop, ..) = found[0].clone()?;
        assert_eq!(stop, Stop::Cancelled, "raised at {raised_at}");
        assert!(found.iter().all(|other| *other == found[0]), "raised at {raised_at}: {found:?}");
    }
    Ok(())
}

#[test]
fn a_lost_rank_aborts_the_optimisation_on_all() -> Outcome {
    let mesh = bar(CellKind::Hex8, 1)?;
    let (mut at, mut aborted, mut early) = (1, 0, 0);
    loop {
        let found = on_faulty(2, Some((1, at)), |rank| {
            let problem = short(&mesh, &rank)?;
            let start = problem.at(&[0.0])?;
            Ok(Lbfgs::default().within(Bounds::new(-2e5, 0.0)?).max_iterations(3).minimize(&problem, &start)?.stop)
        });
        let end = |found: &Result<Stop, String>| match found {
            Ok(Stop::Aborted(why)) => format!("aborted: {why}"),
            Ok(stop) => stop.to_string(),
            Err(error) => error.clone(),
        };
        let ends: Vec<String> = found.iter().map(end).collect();
        if found.iter().all(|found| matches!(found, Ok(Stop::MaxIterations { .. } | Stop::Converged { .. }))) {
            break;
        }
        assert!(ends.iter().all(|end| end.contains("has ended before the others")), "lost at message {at}: {ends:?}");
        aborted += usize::from(found.iter().all(|found| matches!(found, Ok(Stop::Aborted(_)))));
        early += usize::from(found.iter().all(Result::is_err));
        at += 1 + at / 7;
    }
    assert!(aborted > 3 && early > 3, "{aborted} in the optimisation, {early} before");
    Ok(())
}

#[test]
fn failures_for_a_lost_rank_are_fatal() -> Outcome {
    let mesh = bar(CellKind::Hex8, 1)?;
    let (mut at, mut of_values, mut of_derivatives) = (20, 0, 0);
    loop {
        let found = on_faulty(2, Some((0, at)), |rank| {
            let (problem, workspace) = (short(&mesh, &rank)?, &mut ReducedWorkspace::default());
            let valued = problem.evaluate(&[-1e4], &Request::default(), workspace);
            Ok(match valued.map(|mut point| problem.derivative(&mut point, workspace).map(drop)) {
                Err(failed) => (1, 0, failed.is_fatal()),
                Ok(Err(failed)) => (0, 1, failed.is_fatal()),
                Ok(Ok(())) => (0, 0, true),
            })
        });
        if found.iter().all(|found| *found == Ok((0, 0, true))) {
            break;
        }
        for (value, derivative, fatal) in found.into_iter().flatten() {
            assert!(fatal, "lost at message {at}");
            of_values += value;
            of_derivatives += derivative;
        }
        at += at / 10;
    }
    assert!(of_values > 3 && of_derivatives > 0, "{of_values} values, {of_derivatives} derivatives");
    Ok(())
}

#[test]
fn all_know_whether_any_rank_says_so() -> Outcome {
    let mesh = bar(CellKind::Hex8, 1)?;
    let found = on(2, |rank| {
        let problem = short(&mesh, &rank)?;
        let [fatal, other] = [rank.rank() == 1, false].map(|fatal| problem.any(fatal));
        Ok((fatal.map_err(|error| error.to_string())?, other.map_err(|error| error.to_string())?))
    });
    assert!(found.iter().all(|found| *found == Ok((true, false))), "{found:?}");
    Ok(())
}

#[test]
fn one_rank_may_ask_for_figures_alone() -> Outcome {
    let mesh = bar(CellKind::Hex8, 1)?;
    let found = on(2, |rank| {
        let problem = short(&mesh, &rank)?.keep_factors(false);
        let point = problem.at(&[-1e4])?;
        let shown = if rank.rank() == 0 {
            problem.figures(&point).0.len() + problem.figures_of(&point)?.into_iter().flatten().count()
        } else {
            0
        };
        let kept = short(&mesh, &rank)?;
        let figures = kept.figures(&kept.at(&[-1e4])?).0.len();
        Ok((shown, figures > 0, problem.at(&[-2e4])?.cost()))
    });
    let (shown, kept, _) = found[0].clone()?;
    assert!(shown == 0 && kept && found[1] == found[0], "{found:?}");
    Ok(())
}

#[test]
fn what_one_rank_cannot_bind_is_refused_by_all() -> Outcome {
    let mesh = bar(CellKind::Hex8, 1)?;
    let refused = |why: &str, add: &(dyn Fn(Reduced, bool) -> Result<Reduced, ControlError> + Sync)| {
        let found = on(3, |rank| Ok(add(reduced(part(&mesh, &rank, false)?)?, rank.rank() == 1).map(drop)?));
        assert_one_knows(found, 1, why);
    };
    let target = |bad: bool| [Some(if bad { f64::NAN } else { 0.9 }), None, None];
    refused("not finite", &|problem, bad| problem.cost(MeanPosition::surface("x+", target(bad))));
    refused("not finite", &|problem, bad| problem.cost(MeanPosition::point([0.9, 0.1, 0.1], target(bad))));
    let name = |bad: bool| if bad { "nowhere" } else { "x+" };
    refused("nowhere", &|problem, bad| problem.cost(MeanPosition::surface(name(bad), target(false))));
    let wanted = Arc::new(box_mesh([1.0, 0.2, 0.2], [2, 1, 1], CellKind::Hex8)?);
    let distance = || SmoothedHausdorff::to(wanted.clone()).quadrature(2);
    let weight = |bad: bool| if bad { -1.0 } else { 1.0 };
    refused("weight -1", &|problem, bad| problem.cost(distance().weight(weight(bad))));
    let region = |bad: bool| if bad { "nowhere" } else { "far" };
    refused("nowhere", &|problem, bad| problem.cost(distance().region(region(bad))));
    let of_target = |bad: bool| if bad { "nowhere" } else { "body" };
    refused("nowhere", &|problem, bad| problem.cost(distance().target_region(of_target(bad))));
    Ok(())
}

/// A cost that is not defined on one rank: nothing there, and zero on the others.
#[derive(Debug, Clone, Copy)]
struct Undefined {
    value: bool,
    partials: bool,
}

impl Cost for Undefined {
    fn name(&self) -> &str {
        "undefined"
    }

    fn spans_ranks(&self) -> bool {
        true
    }

    fn at(&self, _: &CostContext) -> Result<Arc<dyn CostPoint>, ControlError> {
        if self.value { Err(ControlError::Cost { what: "no value".to_owned() }) } else { Ok(Arc::new(*self)) }
    }
}

impl CostPoint for Undefined {
    fn value(&self) -> f64 {
        0.0
    }

    fn add_partials(&self, _: &mut Partials) -> Result<(), ControlError> {
        if self.partials { Err(ControlError::Cost { what: "no partials".to_owned() }) } else { Ok(()) }
    }
}

#[test]
fn a_cost_that_one_rank_cannot_evaluate_or_differentiate_is_undefined_on_all() -> Outcome {
    let mesh = bar(CellKind::Hex8, 1)?;
    let wanted = Arc::new(box_mesh([0.9, 0.2, 0.2], [2, 1, 1], CellKind::Hex8)?);
    for (value, partials, why) in [(true, false, "no value"), (false, true, "no partials")] {
        let found = on(3, |rank| {
            let here = rank.rank() == 2;
            // its partial derivatives are told to all
            let distance = || SmoothedHausdorff::to(wanted.clone()).quadrature(2);
            let undefined = Undefined { value: value && here, partials: partials && here };
            let problem = reduced(part(&mesh, &rank, false)?)?.cost(undefined)?.cost(distance())?;
            let failed = valued(&problem, &[-1e4]).map(drop);
            let good = reduced(part(&mesh, &rank, false)?)?.cost(distance())?;
            valued(&good, &[-1e4])?;
            failed
        });
        assert_one_knows(found, 2, why);
    }
    Ok(())
}

#[test]
fn cells_that_turn_inside_out_on_one_part_are_an_error_of_all() -> Outcome {
    let mesh = box_mesh([1.0, 0.2, 0.2], [6, 1, 1], CellKind::Hex8)?;
    let wanted = Arc::new(box_mesh([0.9, 0.2, 0.2], [2, 1, 1], CellKind::Hex8)?);
    let found = on(3, |rank| {
        let problem = reduced(part(&mesh, &rank, false)?)?.cost(SmoothedHausdorff::to(wanted.clone()).quadrature(2))?;
        let good = problem.at(&[-1e4])?;
        let points = problem.solid().mesh().points();
        let folded = points.iter().flat_map(|x| [if x[0] > 0.99 { -0.5 } else { 0.0 }, 0.0, 0.0]);
        let state = State { u: Arc::new(folded.collect()), ..good.state().clone() };
        let failed = problem.costs_at(&state, &good.m, 0).map(drop);
        problem.costs_at(good.state(), &good.m, 0)?;
        let has_end = points.iter().any(|x| x[0] > 0.99);
        Ok((failed.err().map(|error| matches!(error, ControlError::Inverted(_))), has_end))
    });
    for found in &found {
        let (inverted, has_end) = found.clone()?;
        assert_eq!(inverted, Some(has_end), "{found:?}");
    }
    assert_eq!(found.iter().filter(|found| **found == Ok((Some(true), true))).count(), 1);
    Ok(())
}

#[test]
fn weights_of_displacements_that_do_not_fit_on_one_rank_are_refused_by_all() -> Outcome {
    let mesh = bar(CellKind::Hex8, 1)?;
    let found = on(2, |rank| {
        let problem = short(&mesh, &rank)?;
        let (point, workspace) = (problem.at(&[-1e4])?, &mut ReducedWorkspace::default());
        let mut w = vec![1.0; point.state().u.len()];
        problem.displacement_vjp(&point, &w, workspace)?;
        w.truncate(w.len() - rank.rank());
        Ok(problem.displacement_vjp(&point, &w, workspace).map(drop)?)
    });
    assert_one_knows(found, 1, "entries where");
    Ok(())
}

#[test]
fn an_inner_product_that_one_rank_cannot_build_is_refused_by_all() -> Outcome {
    let mesh = bar(CellKind::Hex8, 1)?;
    for metric in [Metric::L2, Metric::H1 { length: 0.1 }] {
        let found = on(2, |rank| {
            let bad = Metric::H1 { length: -1.0 };
            let own = short(&mesh, &rank)?.metric(if rank.rank() == 1 { bad } else { metric });
            Ok(own.inner_product().map(drop)?)
        });
        assert_one_knows(found, 1, "smoothing length");
    }
    Ok(())
}

#[test]
fn a_saved_point_that_is_damaged_on_one_rank_is_refused_by_all() -> Outcome {
    let mesh = bar(CellKind::Hex8, 1)?;
    let found = on(2, |rank| {
        let (problem, how) = (short(&mesh, &rank)?, Request::default());
        let mut point = problem.at(&[-1e4])?;
        let derivative = problem.derivative(&mut point, &mut ReducedWorkspace::default())?;
        let mut bytes = problem.save(&point);
        let mut loaded = problem.load(&[-1e4], &bytes, &how)?;
        assert_eq!(problem.derivative(&mut loaded, &mut ReducedWorkspace::default())?, derivative);
        bytes.truncate(bytes.len() - 9 * rank.rank());
        let loaded: Result<(), Failed> = problem.load(&[-1e4], &bytes, &how).map(drop);
        Ok(loaded?)
    });
    let told = found[1].clone().err().unwrap_or_default();
    assert!(!told.is_empty() && !told.contains(ELSEWHERE), "{told}");
    assert_one_knows(found, 1, &told);
    Ok(())
}

#[test]
fn costs_that_are_bound_to_another_body_are_refused() -> Outcome {
    let mesh = bar(CellKind::Hex8, 1)?;
    let target = || Target::position(|x| [0.95 * x[0], x[1], x[2]]);
    let distance = SmoothedHausdorff::to(box_mesh([0.9, 0.2, 0.2], [2, 1, 1], CellKind::Hex8)?).quadrature(2);
    let refused = |found: Result<Reduced, ControlError>| matches!(found, Err(ControlError::OtherBody { .. }));
    let check = |own: Solid, other: Solid| -> Outcome {
        let problem = || reduced(own.clone());
        let body = problem()?.solid().clone();
        assert!(refused(problem()?.cost(Tracking::surface("x+", target()).bind_to(&other)?)));
        assert!(refused(problem()?.cost(distance.clone().bind_to(&other)?)));
        let boxed: Box<dyn Cost> = Box::new(Tracking::surface("x+", target()).bind_to(&other)?);
        assert!(refused(problem()?.cost(boxed)));
        let bound = problem()?.cost(Tracking::surface("x+", target()).bind_to(&body)?)?;
        let bound = bound.cost(distance.clone().bind_to(&body)?)?;
        let unbound = problem()?.cost(Tracking::surface("x+", target()))?.cost(distance.clone())?;
        assert_eq!(bound.at(&[-1e4])?.terms, unbound.at(&[-1e4])?.terms);
        Ok(())
    };
    check(Solid::new(mesh.clone())?, Solid::new(mesh.clone())?)?;
    let of_ranks = |rank: Arc<ThreadRank>| check(part(&mesh, &rank, false)?, part(&mesh, &rank, true)?);
    on(2, of_ranks).into_iter().try_for_each(|found| Ok(found?))
}
