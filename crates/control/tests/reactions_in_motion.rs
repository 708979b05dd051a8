//! Forces of supports as costs: in motions, and their second derivatives of equilibria.

use nastic_control::{
    CostLimit, Interpolation, Knots, MotionMemory, Reaction, Reduced, ReducedWorkspace, Space, Timeline, When,
};
use nastic_energy::{FiberTension, MaxwellBranch, NeoHooke};
use nastic_fem::{Inertia, MovingSupport, Scheme, Solid, State};
use nastic_mesh::{CellKind, box_mesh};
use nastic_opt::{Bounds, Constrained, Objective, Product, Request, Taylor, Verdict};
use nastic_tensor::Vec3;
use std::sync::Arc;

type Done<T = ()> = Result<T, Box<dyn std::error::Error>>;

const END: f64 = 0.2;

/// A soft bar of 0.2 m that is clamped, its end held along it, by a grip or without, with fibres along it.
fn bar(grip: bool, viscous: bool) -> Done<Solid> {
    let solid = Solid::new(box_mesh([0.2, 0.05, 0.05], [3, 1, 1], CellKind::Hex8)?)?
        .material("body", NeoHooke::from_young_poisson(1e5, 0.3)?)?
        .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
        .clamp("x-")?;
    let solid = match grip {
        true => solid.motion(MovingSupport::of("grip", "x+").components(&[0]))?,
        false => solid.displace("x+", [Some(0.0), None, None])?,
    };
    let solid = if viscous { solid.viscosity("body", MaxwellBranch::new(4e4, 0.07)?)? } else { solid };
    Ok(solid.inertia(Inertia::new("body", 1000.0))?.rayleigh_damping(0.5, 1e-3)?)
}

fn knots() -> Done<Knots> {
    Ok(Knots::every(0.1, END, Interpolation::Linear)?)
}

fn in_time(solid: Solid, scheme: Scheme, given: bool) -> Done<Reduced> {
    let timeline = Timeline::uniform(scheme, END, 8)?.segments_of(2);
    let timeline = if given { timeline.from_rest() } else { timeline };
    Ok(Reduced::new(solid).in_time(timeline)?.control_in_time("tension", Space::Cell, knots()?)?)
}

fn size(unit: &str) -> f64 {
    if unit == "Pa" { 8e3 } else { 0.02 }
}

/// A control vector within a set; what moves the grip is 0 at first.
fn wave(problem: &Reduced) -> Done<(Vec<f64>, Product)> {
    let (mut m, mut set) = (Vec::new(), Product::new());
    for block in problem.layout().blocks() {
        let most = size(block.unit);
        m.extend((0..block.len()).map(|i| most * (0.9 * ((i * 37 % 11) as f64 / 11.0) - 0.4)));
        set.push(block.len(), Arc::new(Bounds::new(-1.5 * most, 1.5 * most)?));
    }
    Ok((m, set))
}

fn assert_right(problem: &Reduced, what: &str) -> Done {
    let (m, set) = wave(problem)?;
    let report = Taylor { directions: 2, ..Taylor::default() }.test(problem, &set, &m)?;
    assert_eq!(report.verdict(), Verdict::Right, "{what}: {report}");
    assert!(report.directions.iter().all(|direction| direction.order1 > 1.95), "{what}: {report}");
    Ok(())
}

fn derivative(problem: &Reduced, m: &[f64]) -> Done<Vec<f64>> {
    let mut workspace = ReducedWorkspace::default();
    let mut point = problem.evaluate(m, &Request::default(), &mut workspace)?;
    Ok(Objective::derivative(problem, &mut point, &mut workspace)?)
}

/// The force on the support in the last state, as motions report it.
fn reported(problem: &Reduced, m: &[f64], support: &str) -> Done<f64> {
    let point = problem.at(m)?;
    let (mut before, mut last): (Option<State>, Option<State>) = (None, None);
    problem.for_each_state(&point, &mut |_, state| {
        before = last.replace(state.clone());
        Ok(())
    })?;
    let last = last.ok_or("no state")?;
    let all = problem.solid().reactions(before.as_ref(), &last)?;
    Ok(all.into_iter().find(|(name, _)| name == support).ok_or("no support")?.1[0])
}

#[test]
fn the_force_on_a_clamp_in_motions_and_its_derivative() -> Done {
    let schemes = [
        Scheme::backward_euler(),
        Scheme::bdf2(),
        Scheme::tr_bdf2(),
        Scheme::trapezoidal(),
        Scheme::newmark(0.3025, 0.6)?,
        Scheme::quasi_static(),
    ];
    for scheme in schemes {
        let name = scheme.name();
        for viscous in [false, true] {
            let at_end = in_time(bar(false, viscous)?, scheme.clone(), true)?
                .cost(Reaction::at("x-", [1.0, 0.0, 0.0], 3.0).weight(2.0))?;
            let (m, _) = wave(&at_end)?;
            let force = reported(&at_end, &m, "x-")?;
            assert!(force.abs() > 0.1, "{name}: {force}");
            let (found, expected) = (at_end.at(&m)?.cost(), (force - 3.0).powi(2));
            assert!((found / expected - 1.0).abs() < 1e-10, "{name}: {found} {expected}");
            assert_right(&at_end, &format!("{name}, viscous {viscous}, at the end"))?;
        }
        let over_time = in_time(bar(false, true)?, scheme, false)?
            .cost_when(When::Integral, Reaction::at("x-", [1.0, 0.0, 0.0], 3.0))?;
        assert_right(&over_time, &format!("{name}, from an equilibrium, over the time"))?;
    }
    Ok(())
}

/// Also by what moves the grip, with few states kept, and as a bound.
#[test]
fn the_force_on_a_grip_that_moves_and_its_derivative() -> Done {
    for scheme in [Scheme::backward_euler(), Scheme::quasi_static()] {
        let name = scheme.name();
        let gripped = |memory: MotionMemory| -> Done<Reduced> {
            let timeline = Timeline::uniform(scheme.clone(), END, 8)?.segments_of(2).keep(memory);
            Ok(Reduced::new(bar(true, true)?)
                .in_time(timeline)?
                .control_in_time("tension", Space::Cell, knots()?)?
                .control_along_in_time("grip.translation", Space::Uniform, [1.0, 0.0, 0.0], knots()?)?)
        };
        let reaction = || Reaction::at("x+", [1.0, 0.0, 0.0], 4.0);
        let all = gripped(MotionMemory::All)?.cost_when(When::Integral, reaction())?;
        assert_right(&all, name)?;
        let at_end = gripped(MotionMemory::All)?.cost(reaction().weight(2.0))?;
        let (m, _) = wave(&at_end)?;
        let force = reported(&at_end, &m, "grip")?;
        let (found, expected) = (at_end.at(&m)?.cost(), (force - 4.0).powi(2));
        assert!((found / expected - 1.0).abs() < 1e-10, "{name}: {found} {expected}");
        let few = gripped(MotionMemory::Checkpoints(2))?.cost_when(When::Integral, reaction())?;
        assert_eq!(derivative(&all, &m)?, derivative(&few, &m)?, "{name}");
        // as a bound: the derivative of y c is that of the cost
        let bound = gripped(MotionMemory::All)?.constrain(CostLimit::at_most(reaction().weight(2.0), 1.0))?;
        let point = bound.at(&m)?;
        let values = bound.constraint_values(&point);
        assert!((values[0] - (found - 1.0)).abs() < 1e-9 * found, "{name}: {values:?} {found}");
    }
    Ok(())
}

#[test]
fn what_has_no_reaction_is_refused() -> Done {
    let told = |scheme: Scheme, grip: bool, when: When| -> Done<String> {
        let added = in_time(bar(grip, false)?, scheme, true)?.cost_when(when, Reaction::at("x-", [1.0, 0.0, 0.0], 0.0));
        Ok(added.err().ok_or("it is taken")?.to_string())
    };
    let midpoint = told(Scheme::implicit_midpoint(), false, When::End)?;
    assert!(midpoint.contains("whose steps end at a stage"), "{midpoint}");
    let at_start = told(Scheme::tr_bdf2(), false, When::Integral)?;
    assert!(at_start.contains("t = 0"), "{at_start}");
    let moved = told(Scheme::tr_bdf2(), true, When::End)?;
    assert!(moved.contains("take backward_euler or quasi_static"), "{moved}");
    Ok(())
}

/// Of equilibria, by a tension in cells and by the place of a grip.
#[test]
fn second_derivatives_of_the_force_on_a_support() -> Done {
    let held = Reduced::new(bar(true, false)?)
        .control("tension", Space::Cell)?
        .control_along("grip.translation", Space::Uniform, [1.0, 0.0, 0.0])?
        .cost(Reaction::at("x-", [1.0, 0.0, 0.2], 3.0).weight(2.0))?
        .cost(Reaction::at("x+", [1.0, 0.0, 0.0], 1.0))?;
    let (m, set) = wave(&held)?;
    let report = Taylor { second: true, directions: 2, ..Taylor::default() }.test(&held, &set, &m)?;
    assert_eq!(report.verdict(), Verdict::Right, "{report}");
    assert_eq!(report.second_verdict(), Some(Verdict::Right), "{report}");
    Ok(())
}
