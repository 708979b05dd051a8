//! Trials whose way leads to a limit point: a thick cylinder under more pressure than it bears.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use nastic_control::{ControlError, ControlLimit, Reduced, ReducedWorkspace, Shown, Space, Target, Tracking};
use nastic_energy::Yeoh;
use nastic_fem::{Cavity, Solid, StateError};
use nastic_mesh::{CellKind, rectangle};
use nastic_opt::{Bounds, Budget, Failed, Lbfgs, Objective, Optimizer, Reason, Request, Trial};
use std::f64::consts::PI;

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

const C: [f64; 3] = [1.0, -0.2, 0.02];
const INNER: f64 = 1.0;
const OUTER: f64 = 1.3;

/// A quarter of a ring in plane strain, its inner side on the left of the rectangle.
fn ring() -> Outcome<Solid> {
    let flat = rectangle([1.0, 1.0], [2, 4], CellKind::Quad8)?;
    let mesh = flat.mapped(|[x, y, _]| {
        let (r, angle) = (INNER + (OUTER - INNER) * x, 0.5 * PI * y);
        // exactly on the axes, where rollers hold
        [if y == 1.0 { 0.0 } else { r * angle.cos() }, if y == 0.0 { 0.0 } else { r * angle.sin() }, 0.0]
    })?;
    Ok(Solid::new(mesh)?
        .material("body", Yeoh::new(C[0], C[1], C[2], 100.0)?)?
        .displace("y-", [None, Some(0.0), None])?
        .displace("y+", [Some(0.0), None, None])?
        .cavity(Cavity::new("air", "x-").symmetry("y-").symmetry("y+"))?)
}

/// The largest pressure of the incompressible cylinder before it stiffens: `p = int 2 W' (l^2 - l^-2) / r dr`, `l = r/R`, at an inner radius a.
fn largest() -> f64 {
    let pressure = |a: f64| {
        const STEPS: usize = 400;
        let h = (OUTER - INNER) / STEPS as f64;
        let at = |k: usize| {
            let big = INNER + (k as f64 + 0.5) * h;
            let square = big * big + a * a - INNER * INNER;
            let (l, x) = (square / (big * big), square / (big * big) + big * big / square - 2.0);
            2.0 * (C[0] + 2.0 * C[1] * x + 3.0 * C[2] * x * x) * (l - 1.0 / l) * big / square * h
        };
        (0..STEPS).map(at).sum::<f64>()
    };
    (0..300).map(|k| pressure(1.0 + 0.003 * f64::from(k))).fold(0.0, f64::max)
}

fn problem() -> Outcome<Reduced> {
    let wide = Target::position(|x| [1.6 * x[0], 1.6 * x[1], 0.0]);
    let shown = Shown { name: "air pressure".to_owned(), unit: "kPa".to_owned() };
    Ok(Reduced::new(ring()?).control("air", Space::Uniform)?.show("air", shown)?.cost(Tracking::surface("x+", wide))?)
}

fn limit(failed: &Failed) -> Option<(ControlLimit, usize)> {
    match failed.downcast_ref::<ControlError>() {
        Some(ControlError::LimitPoint { limit, newton }) => Some((limit.clone(), *newton)),
        _ => None,
    }
}

/// The failure of a trial names the limit point with the control's name, value and unit, at a cost that its budget bounds; a
/// later one that leads beyond it costs less, and one just before it is found.
#[test]
fn a_trial_beyond_a_limit_point_is_cut_and_names_it() -> Outcome {
    let (problem, largest) = (problem()?, largest());
    let near = problem.at(&[0.4 * largest])?;
    let workspace = &mut ReducedWorkspace::default();
    let how = Request { budget: Budget::Times(3.0), ..Request::near(&near) };
    let beyond = problem.evaluate(&[5.0 * largest], &how, workspace).err().ok_or("a state beyond the limit point")?;
    let (at, first) = limit(&beyond).ok_or_else(|| format!("no limit point: {beyond}"))?;
    println!("{beyond}; {first} iterations, radial problem {largest}");
    let value = 0.4 * largest + at.share * 4.6 * largest;
    assert!((value / largest - 1.0).abs() < 0.03, "{value} instead of {largest}");
    assert_eq!((at.at[0].name.as_str(), at.at[0].unit.as_str()), ("air pressure", "kPa"));
    assert!(at.at[0].range.iter().all(|p| (p / value - 1.0).abs() < 1e-12), "{at}");
    assert!(beyond.to_string().starts_with("limit point at air pressure = "), "{beyond}");
    assert_eq!(beyond.limit(), Some(at.share));
    assert_eq!(beyond.work().get("newton"), Some(first as f64));
    // the budget of the solve, and that of the path
    assert!(first <= 25.max(3 * near.work.newton) + 80 + 10, "{first}");

    let again = problem.evaluate(&[2.0 * largest], &how, workspace).err().ok_or("a state beyond the limit point")?;
    let (other, second) = limit(&again).ok_or_else(|| format!("no limit point: {again}"))?;
    assert!(second < first && (other.at[0].range[0] / value - 1.0).abs() < 1e-4, "{again}, {second} iterations");
    let before = problem.evaluate(&[0.4 * largest + 0.95 * (value - 0.4 * largest)], &how, workspace)?;
    assert!(before.work.newton < 15, "{}", before.work.newton);
    // nothing of it hangs on what was met before, but the work
    let alone = problem.at(&before.m)?;
    assert!((before.cost() / alone.cost() - 1.0).abs() < 1e-6, "{} {}", before.cost(), alone.cost());
    Ok(())
}

/// Without a budget nothing is cut: behind the limit point the body has jumped to where it stiffens. A budget ends the same solve.
#[test]
fn budgets_are_kept_and_none_is_taken_unasked() -> Outcome {
    let problem = problem()?;
    let beyond = [5.0 * largest()];
    let jumped = problem.evaluate(&beyond, &Request::default(), &mut ReducedWorkspace::default())?;
    assert!(jumped.work.newton > 12, "{}", jumped.work.newton);
    let how = Request { budget: Budget::Of(12), ..Request::default() };
    let cut =
        problem.evaluate(&beyond, &how, &mut ReducedWorkspace::default()).err().ok_or("a solve beyond its budget")?;
    let Some(ControlError::State(StateError::NoConvergence { budget, newton, .. })) = cut.downcast_ref() else {
        panic!("{cut}")
    };
    assert_eq!((*budget, *newton), (Some(12), 12));
    Ok(())
}

/// The state to which the body jumps behind the limit point is one of another branch, reported with the limit point; one before it is not.
#[test]
fn a_state_on_another_branch_is_told() -> Outcome {
    let (problem, largest) = (problem()?, largest());
    let (near, workspace) = (problem.at(&[0.4 * largest])?, &mut ReducedWorkspace::default());
    let jumped = problem.at(&[2.0 * largest])?;
    let why = problem.jump(&near, &jumped, workspace).ok_or("no jump")?;
    let (at, _) = limit(&why).ok_or_else(|| format!("no limit point: {why}"))?;
    let value = (0.4 + 1.6 * at.share) * largest;
    assert!((value / largest - 1.0).abs() < 0.03, "{value} instead of {largest}");
    assert_eq!(why.limit(), Some(at.share));
    let before = problem.at(&[0.9 * largest])?;
    assert!(problem.jump(&near, &before, workspace).is_none());
    Ok(())
}

/// A target behind the limit point: the run comes up to it in a bounded number of iterations per trial.
#[test]
fn an_optimisation_comes_up_to_the_limit_point() -> Outcome {
    let (problem, largest) = (problem()?, largest());
    let (mut most, mut named) = (0.0_f64, 0);
    let watch = |trial: &Trial<'_, nastic_control::Evaluated>| {
        most = most.max(trial.summary.get("newton").unwrap_or_default());
        named += usize::from(matches!(&trial.reason, Reason::Failed(why) if limit(why).is_some()));
    };
    let mut method = Lbfgs::default();
    method.options.max_iterations = 10;
    let best = method.within(Bounds::new(0.0, 10.0 * largest)?).observe(watch).minimize(&problem, 0.3 * largest)?;
    println!("{} of {largest}, {named} met the limit point, {most} iterations at most: {}", best.m[0], best.stop);
    assert!(named > 0 && best.m[0] > 0.97 * largest && best.m[0] < 1.03 * largest, "{}", best.m[0]);
    assert!(most <= 140.0, "{most}");
    Ok(())
}
