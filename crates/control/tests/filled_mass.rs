//! A mass that follows a design, beside the stiffness and the weight.

use crate::designs::Outcome;
use nastic_control::{
    Consumer, Interpolation, KineticEnergy, Knots, PowerLaw, Reduced, Space, Target, Timeline, Tracking, When,
};
use nastic_energy::{NeoHooke, Parametrised};
use nastic_fem::{Inertia, Instant, Scheme, Solid, VaryingLoad};
use nastic_mesh::{CellKind, box_mesh};
use nastic_opt::{Bounds, Taylor};
use nastic_tensor::Vec3;

const DENSITY: f64 = 1000.0;
const END: f64 = 0.2;

fn arm(kind: CellKind, inertia: Inertia) -> Outcome<Solid> {
    let body = Solid::new(box_mesh([0.5, 0.05, 0.05], [4, 1, 1], kind)?)?
        .actuate("body", "law", Parametrised::new(NeoHooke::from_young_poisson(1e5, 0.3)?))?
        .clamp("x-")?;
    let force = Vec3::new(0.0, 0.0, -9.81 * DENSITY);
    let weight = VaryingLoad::filled("weight", body.body(), "body", force)?;
    Ok(body.contribution(weight)?.inertia(inertia)?)
}

fn filled() -> Inertia {
    Inertia::new("body", DENSITY).filled()
}

fn swinging(body: Solid, scheme: Scheme, consumers: &[Consumer]) -> Outcome<Reduced> {
    let raised = Target::position(|x| [x[0], x[1], x[2] + 0.05]);
    Ok(Reduced::new(body)
        .in_time(Timeline::uniform(scheme, END, 8)?.from_rest())?
        .design("rho", Space::Cell, consumers)?
        .cost(Tracking::surface("x+", raised))?
        .trajectory_cost(KineticEnergy::new(When::Integral, 3.0)?)?)
}

fn consumers() -> [Consumer; 3] {
    [
        Consumer::of("law.mu").through(PowerLaw { low: 1e3, high: 4e4, exponent: 3.0 }),
        Consumer::of("weight").through(PowerLaw::multiple_of(1.0)),
        Consumer::of("inertia by fill").through(PowerLaw { low: 0.1, high: 1.0, exponent: 2.0 }),
    ]
}

#[test]
fn stiffness_weight_and_mass_follow_one_density_in_motion() -> Outcome {
    for (kind, scheme) in [
        (CellKind::Hex8, Scheme::backward_euler()),
        (CellKind::Hex8, Scheme::trapezoidal()),
        (CellKind::Tet4, Scheme::generalized_alpha(0.5)?),
    ] {
        let name = scheme.name();
        let problem = swinging(arm(kind, filled())?, scheme, &consumers())?;
        let m: Vec<f64> = (0..problem.layout().len()).map(|i| 0.7 + 0.2 * (1.7 * i as f64).sin()).collect();
        let bounds = Bounds::new(vec![0.3; m.len()], vec![1.0; m.len()])?;
        let report = Taylor { directions: 2, ..Taylor::default() }.test(&problem, &bounds, &m)?;
        assert!(report.passed() && report.directions.iter().all(|along| along.order1 > 1.95), "{name}: {report}");
    }
    Ok(())
}

/// At half the fill the body moves as one of half the density does, and weighs half.
#[test]
fn half_the_fill_is_half_the_density() -> Outcome {
    let at = |inertia: Inertia, consumers: &[Consumer]| -> Outcome<Vec<f64>> {
        let body = arm(CellKind::Hex8, inertia)?;
        let problem = swinging(body, Scheme::trapezoidal(), consumers)?;
        let m = vec![0.5; problem.layout().len()];
        let point = problem.at(&m)?;
        let state = point.state();
        let mass = problem.solid().model().quantities(&Instant::of(state))?;
        let mass = mass.iter().find(|(_, name, _)| *name == "mass").map(|(.., mass)| *mass).ok_or("no mass")?;
        assert!((mass - 0.5 * DENSITY * 0.5 * 0.05 * 0.05).abs() < 1e-12, "{mass}");
        Ok(state.u.to_vec())
    };
    let of_weight = [Consumer::of("weight").through(PowerLaw::multiple_of(1.0))];
    let of_both = [of_weight[0].clone(), Consumer::of("inertia by fill").through(PowerLaw::multiple_of(1.0))];
    let (filled, plain) = (at(filled(), &of_both)?, at(Inertia::new("body", 0.5 * DENSITY), &of_weight)?);
    let apart = filled.iter().zip(&plain).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(apart < 1e-9, "{apart:e}");
    Ok(())
}

#[test]
fn a_mass_does_not_change_in_time() -> Outcome {
    let problem = Reduced::new(arm(CellKind::Hex8, filled())?)
        .in_time(Timeline::uniform(Scheme::trapezoidal(), END, 8)?.from_rest())?;
    let knots = Knots::every(0.05, END, Interpolation::Linear)?;
    let refused = problem.control_in_time("inertia by fill", Space::Uniform, knots).map(drop).unwrap_err().to_string();
    assert!(refused.contains("does not change in time"), "{refused}");
    let damped = arm(CellKind::Hex8, filled())?.rayleigh_damping(0.5, 0.0).map(drop).unwrap_err().to_string();
    assert!(damped.contains("follows a design"), "{damped}");
    let problem = || -> Outcome<Reduced> {
        let timeline = Timeline::uniform(Scheme::trapezoidal(), END, 8)?.from_rest();
        Ok(Reduced::new(arm(CellKind::Hex8, filled())?).in_time(timeline)?)
    };
    let place = problem()?.solid().model().controllable().iter().position(|own| own.name == "inertia by fill");
    let place = place.ok_or("no fill")?;
    let refused = problem()?.fix_in_time(place, 0, |t| Ok(vec![1.0 - t; 32])).map(drop).unwrap_err().to_string();
    assert!(refused.contains("does not change in time"), "{refused}");
    Ok(())
}

#[test]
fn masses_that_are_none_are_named() -> Outcome {
    let problem = Reduced::new(arm(CellKind::Hex8, filled())?)
        .in_time(Timeline::uniform(Scheme::trapezoidal(), END, 8)?.from_rest())?
        .control("inertia by fill", Space::Uniform)?;
    let refused = problem.check_own_controls(&[-2.0]).unwrap_err().to_string();
    assert!(refused.contains("a fill of -2"), "{refused}");
    problem.check_own_controls(&[0.0])?;
    let both = arm(CellKind::Hex8, filled().lumped()).map(drop).unwrap_err().to_string();
    assert!(both.contains("lumped"), "{both}");
    let twice = arm(CellKind::Hex8, filled())?.inertia(Inertia::new("body", 1.0)).map(drop).unwrap_err().to_string();
    assert!(twice.contains("an inertia already"), "{twice}");
    Ok(())
}
