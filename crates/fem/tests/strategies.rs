//! Strategies beside Newton's method on the displacement: each is counted where it is tried, and is not where it is switched off.

use crate::common;

use crate::surface_friction::{gripper, scheme};
use common::Outcome;
use common::block::STRICT;
use nastic_energy::{FiberTension, NeoHooke, NeoHookeIsochoric};
use nastic_fem::{
    Controls, Formulation, Solid, SolveOptions, State, StepTo, Strategies, Strategy, TimeStepping, Trajectory,
    Workspace,
};
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

/// The disc between pads that close on it within a step, and lift it in the next ones.
#[test]
fn steps_in_time_leave_out_the_curvature_of_contacts_where_they_touch_hard() -> Outcome {
    let solid = gripper(0.8)?;
    let at = |inwards: f64, up: f64| -> Controls {
        let mut controls = solid.controls();
        for (block, side) in [(0, 1.0), (1, -1.0)] {
            let values = controls.values_mut(block);
            (values[0], values[1]) = (side * inwards, up);
        }
        controls
    };
    let steps = [at(0.02, 0.0), at(0.02, 5e-3), at(0.02, 1e-2)].map(|controls| StepTo { dt: 0.1, controls });
    let scheme = scheme("quasi_dynamic");
    let ends = [Strategies::ALL, Strategies::ALL.without(Strategy::FlatContacts)].map(|strategies| {
        let mut run = Trajectory::from_given(solid.rest());
        let how = SolveOptions { strategies, ..STRICT };
        solid.model().advance(&mut run, &scheme, &steps, &how, &mut Workspace::default()).map(|()| run)
    });
    let [with, without] = ends;
    let (with, without) = (with?, without?);
    let all = |run: &Trajectory| run.states().iter().map(|state| count(state, Strategy::FlatContacts)).sum::<u32>();
    // with supports that move a share of their way: 180 otherwise, and 640 without the strategy
    let newton = |run: &Trajectory| run.states().iter().map(|state| state.report.newton).sum::<usize>();
    assert!(newton(&with) < 100 && newton(&without) > 200, "{} and {}", newton(&with), newton(&without));
    assert!(all(&with) > 0, "{:?}", with.end().report);
    assert_eq!(all(&without), 0);
    let apart = common::distance(&with.end().u, &without.end().u);
    assert!(apart < 1e-6 * common::largest(&with.end().u), "{apart:e}");
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
