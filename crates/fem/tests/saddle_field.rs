//! A field in which the potential has a maximum: an electric potential in a soft dielectric.

use crate::common;

use common::Outcome;
use common::block::STRICT;
use common::dielectric::{Dielectric, between_plates, block, on_rollers};
use nastic_energy::{NeoHooke, Slot};
use nastic_fem::{
    Cause, Connection, EventKind, Field, Inertia, NodalValue, PathOptions, RigidBody, Solid, State, StateError, Tendon,
    TimeStepping, Workspace, check_contribution,
};
use nastic_mesh::CellKind;

const PERMITTIVITY: f64 = 0.7;

fn dielectric(solid: Solid) -> Outcome<Solid> {
    let field = Dielectric::on(solid.discretization(), PERMITTIVITY);
    Ok(solid.contribution(field)?)
}

/// Two plates pull each other through the body with `eps E^2 / 2`; the equilibrium is stable though the tangent is not definite.
#[test]
fn a_capacitor_is_squeezed_as_its_closed_form_says() -> Outcome {
    let (voltage, thickness) = (0.1, 0.25);
    let solid = dielectric(on_rollers(block(CellKind::Hex8, [1.0, 0.8, thickness], [2, 2, 3])?)?)?;
    check_contribution(solid.model(), "dielectric", 3)?;
    let solid = solid.hold("phi", 0, "z-", 0.0)?.hold("phi", 0, "z+", voltage)?;
    let state = solid.solve(&solid.controls(), &STRICT)?;
    assert_eq!((state.report.shifted, state.report.solver), (0, "direct"));
    let u = solid.model().displacement(&state.u);
    let top = common::node_at(solid.mesh(), [0.0, 0.0, thickness]).ok_or("no node")?;
    let along = 1.0 + u[3 * top + 2] / thickness;
    let [across, expected] = between_plates(PERMITTIVITY, along, thickness);
    assert!(across > 1.01 && along < 0.98 && (expected - voltage).abs() < 1e-10, "{across} {along} {expected}");
    for (x, u) in solid.mesh().points().iter().zip(u.chunks_exact(3)) {
        let expected = [(across - 1.0) * x[0], (across - 1.0) * x[1], (along - 1.0) * x[2]];
        assert!((0..3).all(|i| (u[i] - expected[i]).abs() < 1e-10), "{u:?} {expected:?}");
    }
    let stability = solid.model().stability();
    assert_eq!(stability.negative_pivots(&state)?, 0);
    Ok(())
}

/// A bar that buckles is unstable in as many directions with the field as without it.
#[test]
fn what_buckles_is_counted_beside_the_field() -> Outcome {
    let bar = |shortened: f64| -> Outcome<Solid> {
        let bar = block(CellKind::Hex20, [1.0, 0.1, 0.12], [8, 1, 1])?.clamp("x-")?;
        Ok(bar.displace("x+", [Some(-shortened), Some(0.0), Some(0.0)])?)
    };
    for (shortened, expected) in [(0.02, 0), (0.042, 1), (0.06, 2)] {
        let alone = bar(shortened)?;
        let charged = dielectric(bar(shortened)?)?.hold("phi", 0, "z-", 0.0)?.hold("phi", 0, "z+", 1e-3)?;
        for solid in [alone, charged] {
            let state = solid.solve(&solid.controls(), &STRICT)?;
            assert_eq!(solid.model().stability().negative_pivots(&state)?, expected, "{shortened}");
        }
    }
    Ok(())
}

const VOLTAGE: Slot = Slot::scalar("voltage", "V");

fn phi() -> Field {
    Field::saddle("phi", 1)
}

fn solve(solid: &Solid, voltages: &[(&str, f64)]) -> Outcome<State> {
    let mut controls = solid.controls();
    for (name, voltage) in voltages {
        let block = solid.model().controllable().iter().position(|c| c.name == *name).ok_or("no such control")?;
        controls.values_mut(block)[0] = *voltage;
    }
    Ok(solid.solve(&controls, &STRICT)?)
}

/// An electrode that floats has the value at which no charge is on it: the body is as with that value given.
#[test]
fn an_electrode_floats_where_it_has_no_charge() -> Outcome {
    let body = block(CellKind::Hex8, [1.0, 0.6, 0.3], [4, 2, 2])?.clamp("z-")?;
    let (mesh, dielectric) = (body.mesh().clone(), dielectric(body)?.hold("phi", 0, "z-", 0.0)?);
    let on_top = |which: &dyn Fn(f64) -> bool| -> Vec<u32> {
        let at = |x: &[f64; 3]| x[2] > 0.29 && which(x[0]);
        (0..mesh.points().len() as u32).filter(|node| at(&mesh.points()[*node as usize])).collect()
    };
    let (left, right) = (on_top(&|x| x < 0.3), on_top(&|x| x > 0.7));
    let driven = NodalValue::driven("drive", phi(), "z+", VOLTAGE).on(&mesh, left.clone())?;
    let driven = dielectric.contribution(driven)?;
    let floating = NodalValue::floating("plate", phi(), "z+").on(&mesh, right.clone())?;
    let floating = driven.clone().contribution(floating)?;
    for name in ["drive", "plate", "dielectric"] {
        check_contribution(floating.model(), name, 5)?;
    }
    let state = solve(&floating, &[("drive", 0.15)])?;
    let field = floating.model().field("phi", &state.u)?;
    let value = field[right[0] as usize];
    assert!(value > 1e-3 && value < 0.1 && right.iter().all(|&node| field[node as usize] == value), "{value}");
    let held = driven.contribution(NodalValue::driven("plate", phi(), "z+", VOLTAGE).on(&mesh, right.clone())?)?;
    let given = solve(&held, &[("drive", 0.15), ("plate", value)])?;
    let apart = common::distance(&given.u, &state.u);
    assert!(apart < 1e-12, "{apart:e}");
    assert_eq!(floating.model().stability().negative_pivots(&state)?, 0);
    assert_eq!(held.model().stability().negative_pivots(&given)?, 0);
    let both = floating.clone().hold("phi", 0, "z+", 0.0).err().ok_or("it holds")?.to_string();
    assert!(both.contains("\"drive\"") && both.contains("\"z+\""), "{both}");
    let twice = NodalValue::floating("other", phi(), "z+").on(&mesh, right)?;
    let twice = floating.contribution(twice).err().ok_or("it floats twice")?.to_string();
    assert!(twice.contains("\"plate\"") && twice.contains("\"other\""), "{twice}");
    Ok(())
}

/// A rigid part, whose displacement follows that of four nodes, has a potential of its own at every node: that of a part which is very stiff.
#[test]
fn a_rigid_part_has_a_potential() -> Outcome {
    let size = [1.0, 0.4, 0.4];
    let mesh = common::regular(CellKind::Hex8, size, [5, 2, 2])?;
    let of = |part: std::ops::Range<f64>| -> Vec<u32> {
        (0..mesh.cells() as u32).filter(|cell| part.contains(&mesh.cell_centre(*cell as usize)[0])).collect()
    };
    let mesh = mesh.clone().with_region("soft", of(0.0..0.55)).with_region("hard", of(0.55..1.0));
    let law = |scale: f64| NeoHooke::new(scale, 4.0 * scale);
    let body = |stiff: f64| -> Outcome<Solid> {
        let body = Solid::new(mesh.clone())?.material("soft", law(1.0)?)?.material("hard", law(stiff)?)?.clamp("x-")?;
        Ok(body)
    };
    let charged = |body: Solid| -> Outcome<Solid> {
        let charged = dielectric(body)?.hold("phi", 0, "x-", 0.0)?;
        Ok(charged.nodal_value(NodalValue::driven("drive", phi(), "x+", VOLTAGE))?)
    };
    let rigid = body(1.0)?.rigid(&RigidBody::new("plug", "hard"))?;
    let (rigid, stiff) = (charged(rigid)?, charged(body(1e6)?)?);
    let states = [solve(&rigid, &[("drive", 0.3)])?, solve(&stiff, &[("drive", 0.3)])?];
    let nodal = stiff.model().unknowns().nodal();
    let apart = common::distance(&states[0].u[..nodal], &states[1].u);
    let moved = common::largest(&rigid.model().displacement(&states[0].u));
    println!("{apart:.2e} of {moved:.2e}");
    assert!(moved > 1e-3 && apart < 1e-5 * moved, "{apart:e}");
    assert_eq!(rigid.model().stability().negative_pivots(&states[0])?, 0);
    Ok(())
}

/// A voltage is ramped up to where plates pull each other through the body, and followed beyond.
#[test]
fn plates_pull_in_at_a_limit_point() -> Outcome {
    // in one cell the plates give every value of the potential
    (1..3).try_for_each(pull_in)
}

fn pull_in(cells: usize) -> Outcome {
    let thickness = 0.25;
    let solid = dielectric(on_rollers(block(CellKind::Hex8, [1.0, 0.8, thickness], [1, 1, cells])?)?)?;
    let solid = solid.hold("phi", 0, "z-", 0.0)?.nodal_value(NodalValue::driven("drive", phi(), "z+", VOLTAGE))?;
    let stability = solid.model().stability();
    let at = |voltage: f64| {
        let mut controls = solid.controls();
        controls.values_mut(0)[0] = voltage;
        controls
    };
    let mut workspace = Workspace::default();
    let ramp = stability.ramp(&at(0.0), &at(0.14), 5, &STRICT, &mut workspace, &mut |_| ())?;
    assert!(ramp.failure.is_none() && ramp.critical.is_empty());
    let top = common::node_at(solid.mesh(), [0.0, 0.0, thickness]).ok_or("no node")?;
    let voltage = |along: f64| between_plates(PERMITTIVITY, along, thickness)[1];
    let along = |state: &State| 1.0 + state.u[4 * top + 2] / thickness;
    for (k, point) in ramp.points.iter().enumerate() {
        let expected = voltage(along(&point.state));
        assert!((0.035 * k as f64 - expected).abs() < 1e-7 && point.negative == Some(0), "{k}: {expected}");
    }
    let beyond = stability.ramp(&at(0.0), &at(0.4), 5, &STRICT, &mut workspace, &mut |_| ())?;
    let Some((_, StateError::NoConvergence { cause, .. })) = beyond.failure else {
        return Err("there is no equilibrium".into());
    };
    assert!(matches!(cause, Cause::LimitPoint { .. }), "{cause:?}");
    let options = PathOptions { points: 40, range: [-0.1, 1.0], ..PathOptions::default() };
    let start = solid.solve(&at(0.05), &STRICT)?;
    let connected = stability.connection(&start, &ramp.points[4].state, &STRICT)?;
    assert_eq!(connected, Connection::Connected);
    let path = stability.path(&start, (&at(0.4), 1.0), &options, &STRICT, &mut workspace, &mut |_| ())?;
    let limit = path.events.iter().find(|event| event.kind == EventKind::LimitPoint).ok_or("no limit point")?;
    let most = (3000..10000).map(|k| voltage(1e-4 * f64::from(k))).fold(0.0, f64::max);
    let found = 0.05 + 0.35 * limit.s;
    assert!((found - most).abs() < 1e-6 * most, "{found} {most}");
    for point in &path.points {
        let expected = voltage(along(&point.state));
        assert!((0.05 + 0.35 * point.s - expected).abs() < 1e-8, "{} {expected}", point.s);
        assert_eq!(point.negative, Some(usize::from(point.slope < 0.0)), "{} {}", point.s, point.slope);
    }
    assert!(path.points.iter().filter(|point| point.slope < 0.0).count() > 2);
    Ok(())
}

/// A cable that cannot stretch keeps the body from growing across the field: its multiplier counts beside the potential.
#[test]
fn a_constraint_stands_beside_the_field() -> Outcome {
    let body = block(CellKind::Hex8, [1.0, 0.3, 0.2], [4, 2, 2])?.clamp("x-")?;
    let body = dielectric(body)?.hold("phi", 0, "z-", 0.0)?;
    let body = body.nodal_value(NodalValue::driven("drive", phi(), "z+", VOLTAGE))?;
    let cable = Tendon::through("cable", [[0.1, 0.15, 0.1], [0.9, 0.15, 0.1]]).inextensible();
    let (free, tied) = (body.clone(), body.tendon(cable)?);
    let [free_state, state] = [&free, &tied].map(|solid| solve(solid, &[("drive", 0.1)]));
    let (free_state, state) = (free_state?, state?);
    let end = common::node_at(free.mesh(), [1.0, 0.15, 0.1]).ok_or("no node")?;
    let (grown, kept) = (free_state.u[4 * end], state.u[4 * end]);
    assert!(grown > 0.02 && kept < 0.5 * grown && state.u[tied.model().unknowns().nodal()] > 0.0, "{grown} {kept}");
    assert_eq!(tied.model().stability().negative_pivots(&state)?, 0);
    Ok(())
}

/// Nodes whose value something else gives are refused, whichever comes first.
#[test]
fn a_value_is_given_once() -> Outcome {
    let solid = || dielectric(on_rollers(block(CellKind::Hex8, [1.0, 1.0, 1.0], [1, 1, 1])?)?);
    let voltage = || NodalValue::driven("electrode", phi(), "z+", VOLTAGE);
    let behind = solid()?.hold("phi", 0, "x-", 0.25)?.nodal_value(voltage()).map(drop).unwrap_err().to_string();
    assert!(behind.contains("electrode") && behind.contains("holds already"), "{behind}");
    let before = solid()?.nodal_value(voltage())?.hold("phi", 0, "x-", 0.25).map(drop).unwrap_err().to_string();
    assert!(before.contains("electrode") && before.contains("already"), "{before}");
    Ok(())
}

/// What is asked for beside a field and does not go with it is told, and what a potential without a ground lacks.
#[test]
fn modes_of_vibration_and_a_missing_ground_are_told() -> Outcome {
    let body = || dielectric(on_rollers(block(CellKind::Hex8, [1.0, 1.0, 1.0], [1, 1, 1])?)?);
    let heavy = body()?.hold("phi", 0, "z-", 0.0)?.inertia(Inertia::new("body", 1.0))?;
    let modes = heavy.model().vibration_modes(&heavy.rest(), 1, &STRICT).map(drop).unwrap_err().to_string();
    assert!(modes.contains("vibration modes") && modes.contains("phi"), "{modes}");
    let free = body()?.traction("z+", [0.0, 0.0, 0.1].into())?;
    let told = free.solve(&free.controls(), &STRICT).map(drop).unwrap_err().to_string();
    assert!(told.contains("(a ground)"), "{told}");
    Ok(())
}
