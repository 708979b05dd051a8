//! Steps in which friction does not act, or not yet: they are found as those without it.

use crate::common;

use common::block::STRICT;
use common::{Outcome, regular};
use nastic_energy::NeoHooke;
use nastic_fem::schemes::SCHEMES;
use nastic_fem::{Contact, Inertia, Solid, State, StepTo, TimeStepping, Trajectory, Workspace};
use nastic_mesh::CellKind;
use nastic_mesh::spatial::Obstacle;
use nastic_tensor::Vec3;

/// A column three times as long as its weight lets it stand, pushed aside a little.
fn column() -> Outcome<Solid> {
    Ok(Solid::new(regular(CellKind::Hex20, [0.1, 0.1, 1.0], [1, 1, 8])?)?
        .material("body", NeoHooke::new(4e5, 1.6e6)?)?
        .inertia(Inertia::new("body", 1000.0))?
        .body_force("body", Vec3::new(50.0, 0.0, -1000.0 * 9.81))?
        .clamp("z-")?)
}

/// In one long step from rest, in which it falls over.
fn fallen(solid: &Solid) -> Outcome<State> {
    let scheme = (SCHEMES.iter().find(|row| row.name == "backward_euler").ok_or("no scheme")?.build)()?;
    let mut motion = Trajectory::from_given(solid.rest());
    let step = [StepTo { dt: 10.0, controls: solid.controls() }];
    solid.model().advance(&mut motion, &scheme, &step, &STRICT, &mut Workspace::default())?;
    Ok(motion.end().clone())
}

/// A wall with friction stands beyond its reach: the tangent is indefinite on the way, and there is no potential, but the body falls as without the wall.
#[test]
fn a_column_falls_over_beside_a_wall_with_friction() -> Outcome {
    let alone = fallen(&column()?)?;
    let wall = Obstacle::half_space([3.0, 0.0, 0.0], [-1.0, 0.0, 0.0]);
    let wall = Contact::of("wall", "x+", wall).thickness(0.01).stiffness(1e5).friction(0.5, 1e-3);
    let beside = fallen(&column()?.contact(wall)?)?;
    let bent = alone.u.iter().fold(0.0_f64, |most, u| most.max(u.abs()));
    let apart = alone.u.iter().zip(beside.u.iter()).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
    assert!(bent > 0.5, "it falls over: {bent}");
    assert!(apart < 1e-6 * bent, "{apart} of {bent}");
    let [alone, beside] = [alone, beside].map(|state| state.report.newton);
    assert!(beside <= 2 * alone, "{beside} iterations beside a wall, {alone} without one");
    Ok(())
}
