//! Strategies beside Newton's method on the displacement: each is counted where it is tried, and is not where it is switched off.

use crate::common;

use common::Outcome;
use nastic_energy::{FiberTension, NeoHooke, NeoHookeIsochoric};
use nastic_fem::{Formulation, Solid, SolveOptions, State, Strategies, Strategy};
use nastic_mesh::{CellKind, rectangle};
use nastic_tensor::Vec3;

/// A strip that its fibres roll up.
fn strip() -> Outcome<Solid> {
    Ok(Solid::new(rectangle([1.0, 0.01], [40, 1], CellKind::Quad9)?)?
        .material("body", NeoHooke::from_young_poisson(1e5, 0.3)?)?
        .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
        .clamp("x-")?)
}

/// A nearly incompressible bar that its fibres bend.
fn soft() -> Outcome<Solid> {
    Ok(Solid::new(rectangle([1.0, 0.2], [10, 2], CellKind::Quad9)?)?
        .material("body", NeoHookeIsochoric::from_young_poisson(1e5, 0.4999)?)?
        .formulation("body", Formulation::LinearDilatation)?
        .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
        .clamp("x-")?)
}

/// Under tensions from one side to the other.
fn bent(solid: &Solid, [below, above]: [f64; 2], strategies: Strategies) -> Outcome<State> {
    let height = solid.mesh().points().iter().map(|x| x[1]).fold(0.0, f64::max);
    let points = solid.discretization().points().positions(solid.mesh(), None);
    let mut controls = solid.controls();
    let values: Vec<f64> = points.iter().map(|x| below + (above - below) * x[1] / height).collect();
    controls.set(0, 0, &values)?;
    Ok(solid.solve(&controls, &SolveOptions { strategies, ..SolveOptions::default() })?)
}

fn count(state: &State, of: Strategy) -> u32 {
    state.report.strategies.tried().find(|(strategy, _)| *strategy == of).map_or(0, |(_, count)| count)
}

#[test]
fn what_is_switched_off_is_not_tried_and_the_answer_is_the_same() -> Outcome {
    for (solid, tension, of) in
        [(strip()?, [400.0, -400.0], Strategy::CurvedStep), (soft()?, [0.0, -2e4], Strategy::PredictedPressures)]
    {
        let with = bent(&solid, tension, Strategies::ALL)?;
        assert!(count(&with, of) > 0, "{}: {:?}", of.name(), with.report);
        let without = bent(&solid, tension, Strategies::ALL.without(of))?;
        assert_eq!(count(&without, of), 0, "{}", of.name());
        println!("{}: {} Newton iterations, {} without", of.name(), with.report.newton, without.report.newton);
        let apart = common::distance(&with.u, &without.u);
        assert!(apart < 1e-7 * common::largest(&with.u), "{}: {apart:e}", of.name());
    }
    Ok(())
}

#[test]
fn names_are_read_back() {
    for strategy in Strategy::ALL {
        assert_eq!(Strategy::named(strategy.name()), Some(strategy));
        let others = Strategies::ALL.without(strategy);
        assert!(!others.has(strategy) && Strategy::ALL.iter().filter(|other| others.has(**other)).count() == 9);
    }
    assert_eq!(Strategy::named("luck"), None);
}
