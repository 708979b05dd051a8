//! Contact with meshed obstacles whose distance is on a grid.

#![allow(clippy::unwrap_used)] // helpers of tests

use crate::common;

use common::block::STRICT;
use common::{Outcome, regular};
use nastic_energy::NeoHooke;
use nastic_fem::{
    Contact, Inertia, Instant, Scheme, Solid, State, StepTo, TimeStep, TimeStepping, Touch, Trajectory, Workspace,
};
use nastic_mesh::spatial::Obstacle;
use nastic_mesh::{CellKind, Mesh, box_mesh};
use nastic_tensor::Vec3;

/// A part of a spherical shell below the origin, of inner radius 0.5 and a wall of 0.12.
fn bowl() -> Outcome<Mesh> {
    let place = |x: [f64; 3]| {
        let d = Vec3::new(1.8 * (x[0] - 0.5), 1.8 * (x[1] - 0.5), -1.0).normalize();
        (d * (0.5 + 0.12 * (1.0 - x[2]))).into()
    };
    Ok(box_mesh([1.0; 3], [10, 10, 1], CellKind::Hex8)?.mapped(place)?)
}

fn touch(solid: &Solid, state: &State) -> Touch {
    solid.model().contacts().touches(&Instant::of(state)).into_iter().next().unwrap().1
}

/// With friction, at the end of a motion.
fn last_touch(solid: &Solid, states: &[State]) -> Touch {
    let [before, end] = states.last_chunk().unwrap();
    let step = TimeStep::between(before, end);
    solid.model().contacts().touches(&Instant::of(end).in_step(&step)).into_iter().next().unwrap().1
}

fn positions(solid: &Solid, state: &State) -> Vec<[f64; 3]> {
    let u = state.u.chunks_exact(3);
    solid.mesh().points().iter().zip(u).map(|(x, u)| std::array::from_fn(|i| x[i] + u[i])).collect()
}

fn moved(solid: &Solid, velocity: Vec3, (dt, steps): (f64, usize)) -> Outcome<Vec<State>> {
    let mut begin = solid.rest();
    begin.velocity = Some((0..begin.u.len()).map(|dof| velocity[dof % 3]).collect::<Vec<f64>>().into());
    let mut trajectory = Trajectory::from_given(begin);
    let to = vec![StepTo { dt, controls: solid.controls() }; steps];
    let scheme = Scheme::backward_euler();
    solid.model().advance(&mut trajectory, &scheme, &to, &STRICT, &mut Workspace::default())?;
    Ok(trajectory.states().to_vec())
}

/// A soft block dropped into a bowl comes to rest on its inside: the bowl carries its weight, and no node is deeper inside of the mesh than
/// the contact and the grid say.
#[test]
fn a_soft_block_rests_in_a_bowl() -> Outcome {
    let (density, side, height) = (1000.0, 0.36, 0.18);
    let place = |x: [f64; 3]| [x[0] - 0.5 * side + 0.03, x[1] - 0.5 * side - 0.02, x[2] - 0.4];
    let mesh = regular(CellKind::Hex8, [side, side, height], [3, 3, 2])?.mapped(place)?;
    let bowl = bowl()?;
    let (grid, exact) = (Obstacle::on_grid(&bowl, 0.04, 0.0)?, Obstacle::solid(&bowl)?);
    let Obstacle::Grid(distance) = &grid else { return Err("no grid".into()) };
    let solid = Solid::new(mesh)?
        .material("body", NeoHooke::from_young_poisson(2e4, 0.3)?)?
        .body_force("body", Vec3::new(0.0, 0.0, -9.81 * density))?
        .inertia(Inertia::new("body", density))?
        .rayleigh_damping(2.0, 0.02)?
        .contact(Contact::of("bowl", "skin", grid.clone()).thickness(4e-3).friction(0.5, 1e-2))?;
    let states = moved(&solid, Vec3::zeros(), (0.02, 150))?;
    let end = states.last().unwrap();
    let (touch, weight) = (last_touch(&solid, &states), 9.81 * density * side * side * height);
    assert!((touch.force[2] / weight - 1.0).abs() < 1e-3, "{touch:?} for {weight}");
    assert!(touch.force[0].hypot(touch.force[1]) < 1e-3 * weight, "{touch:?}");
    assert!(touch.smallest_gap > 0.0 && touch.smallest_gap < 4e-3, "{touch:?}");
    let deepest = positions(&solid, end).iter().map(|x| exact.distance(x)).fold(f64::INFINITY, f64::min);
    assert!(deepest > touch.smallest_gap - distance.error(), "{deepest}, {touch:?}, {}", distance.error());
    Ok(())
}

/// A block thrown at a plate from a mesh, which the step without it would cross, stays on its side; so it does from beyond the grid.
#[test]
fn a_fast_body_crosses_no_thin_plate_on_a_grid() -> Outcome {
    for height in [0.0, 3.0] {
        let place = |x: [f64; 3]| [x[0] - 1.0, x[1] - 1.0, x[2] - 0.5 - height];
        let plate = box_mesh([3.0, 3.0, 0.2], [1; 3], CellKind::Hex8)?.mapped(place)?;
        let plate = Obstacle::on_grid(&plate, 0.08, 0.0)?;
        let solid = Solid::new(regular(CellKind::Hex8, [1.0, 1.0, 0.5], [2, 2, 1])?)?
            .material("body", NeoHooke::new(4e5, 6e5)?)?
            .inertia(Inertia::new("body", 1000.0))?
            .contact(Contact::of("plate", "z-", plate).thickness(0.02).refine(1))?;
        let states = moved(&solid, Vec3::new(0.0, 0.0, -10.0), (0.1 * (1.0 + height), 1))?;
        let end = states.last().unwrap();
        let lowest = positions(&solid, end).iter().map(|x| x[2]).fold(f64::INFINITY, f64::min);
        assert!(lowest > -0.32 - height, "{lowest}");
        assert!(touch(&solid, end).force[2] > 0.0, "from {height}");
    }
    Ok(())
}

/// What presses is `P = p |grad d|`: force, pressures and areas agree where the gradient is no unit vector.
#[test]
fn pressures_are_those_of_the_forces() -> Outcome {
    let place = |x: [f64; 3]| [x[0] - 0.5, x[1] - 0.5, x[2] - 1.05];
    let edge = box_mesh([1.0; 3], [1; 3], CellKind::Hex8)?.mapped(place)?;
    let edge = Obstacle::on_grid(&edge, 0.5, 0.5)?;
    let solid = Solid::new(regular(CellKind::Hex8, [0.2, 0.2, 0.2], [1; 3])?)?
        .material("body", NeoHooke::new(1e4, 1e4)?)?
        .contact(Contact::of("edge", "z-", edge.clone()).thickness(0.4).stiffness(100.0).refine(1))?;
    let (touch, steepness) = (touch(&solid, &solid.rest()), edge.at(&[0.0; 3]).steepness());
    assert!((steepness - 1.0).abs() > 0.01, "{steepness}");
    let pushes = |x: &[f64; 3]| {
        let found = edge.at(x);
        let p = 100.0 * (1.0 - found.value / 0.4).powi(2);
        Vec3::from(found.gradient) * p * 0.01
    };
    let corners: Vec<[f64; 3]> = solid.mesh().points().iter().filter(|x| x[2] == 0.0).copied().collect();
    let (force, pressing) = corners.iter().map(pushes).fold((Vec3::zeros(), 0.0), |(f, p), t| (f + t, p + t.norm()));
    assert!((Vec3::from(touch.force) - force).norm() < 1e-12 * force.norm(), "{touch:?} {force:?}");
    assert!((touch.pressing / pressing - 1.0).abs() < 1e-12, "{touch:?} {pressing}");
    Ok(())
}

#[test]
fn a_layer_thicker_than_the_margin_is_refused() -> Outcome {
    let cube = box_mesh([1.0; 3], [1; 3], CellKind::Hex8)?.mapped(|x| [x[0], x[1], x[2] - 1.1])?;
    let contact = |margin: f64| -> Outcome<Contact> {
        Ok(Contact::of("cube", "z-", Obstacle::on_grid(&cube, 0.1, margin)?).thickness(0.6))
    };
    let bar = || -> Outcome<Solid> {
        Ok(Solid::new(regular(CellKind::Hex8, [1.0; 3], [1; 3])?)?.material("body", NeoHooke::new(1e4, 1e4)?)?)
    };
    let refused = bar()?.contact(contact(0.0)?).err().ok_or("it was taken")?.to_string();
    assert!(refused.contains("contact \"cube\"") && refused.contains("thicker than the margin"), "{refused}");
    assert!(bar()?.contact(contact(0.8)?).is_ok());
    Ok(())
}
