//! What keeps contact from being missed: samples everywhere, moves that cross nothing, steps with friction that are hard to find.

#![allow(clippy::unwrap_used)] // helpers of tests

use crate::common;

use common::block::STRICT;
use common::{Outcome, kinds, regular};
use nastic_energy::NeoHooke;
use nastic_fem::schemes::SCHEMES;
use nastic_fem::{
    Contact, Inertia, Instant, Scheme, Solid, SolveOptions, State, StepTo, TimeStepping, Trajectory, Workspace,
};
use nastic_mesh::CellKind;
use nastic_mesh::spatial::Obstacle;
use nastic_tensor::Vec3;

fn scheme(name: &str) -> Scheme {
    (SCHEMES.iter().find(|row| row.name == name).unwrap().build)().unwrap()
}

fn quantity(solid: &Solid, state: &State, name: &str) -> f64 {
    let all = solid.model().quantities(&Instant::of(state)).unwrap();
    all.into_iter().find(|(_, own, _)| *own == name).unwrap().2
}

fn moving(solid: &Solid, velocity: Vec3) -> State {
    let mut begin = solid.rest();
    let dim = solid.mesh().dim();
    begin.velocity = Some((0..begin.u.len()).map(|dof| velocity[dof % dim]).collect::<Vec<f64>>().into());
    begin
}

fn newton(trajectory: &Trajectory) -> usize {
    trajectory.states().iter().skip(1).map(|state| state.report.newton).sum()
}

/// A tilted floor that only one corner of a block reaches carries it there, on every kind of cell: no corner has the weight zero.
#[test]
fn every_corner_touches() -> Outcome {
    for kind in kinds() {
        let up = kind.dim() - 1;
        let depth = if up == 2 { 1.0 } else { 0.0 };
        let mut normal = [0.3, 0.2, 0.0];
        normal[up] = 1.0;
        let mut point = [0.0; 3];
        point[up] = -0.01;
        let solid = Solid::new(regular(kind, [1.0, 1.0, depth], [1, 1, 1])?)?
            .material("body", NeoHooke::new(1e4, 1e4)?)?
            .contact(Contact::of("floor", ["y-", "z-"][up - 1], Obstacle::half_space(point, normal)).thickness(0.02))?;
        let force = quantity(&solid, &solid.rest(), ["force_y", "force_z"][up - 1]);
        assert!(force > 1e-3, "{kind}: {force}");
    }
    Ok(())
}

/// An obstacle that is smaller than the facets is found between the nodes, unless fewer samples are asked for.
#[test]
fn a_small_obstacle_is_found_between_the_nodes() -> Outcome {
    let ball = || Contact::of("ball", "z-", Obstacle::sphere([0.5, 0.5, -0.2], 0.3)).thickness(0.01);
    let body = || -> Outcome<Solid> {
        Ok(Solid::new(regular(CellKind::Hex8, [1.0; 3], [1; 3])?)?
            .material("body", NeoHooke::new(1e4, 1e4)?)?
            .clamp("z+")?)
    };
    let found = body()?.contact(ball())?;
    let refused = found.solve(&found.controls(), &STRICT).err().ok_or("it was not found")?.to_string();
    assert!(refused.contains("inside of \"ball\""), "{refused}");
    let missed = body()?.contact(ball().refine(1))?;
    assert!(missed.solve(&missed.controls(), &STRICT).is_ok());
    Ok(())
}

/// A body thrown at a thin plate, which the step without it would cross, stays on its side.
#[test]
fn a_fast_body_crosses_no_thin_plate() -> Outcome {
    let plate = Obstacle::aligned_box([-5.0, -5.0, -0.34], [5.0, 5.0, -0.3]);
    let solid = Solid::new(regular(CellKind::Hex8, [1.0, 1.0, 0.5], [2, 2, 1])?)?
        .material("body", NeoHooke::new(4e5, 6e5)?)?
        .inertia(Inertia::new("body", 1000.0))?
        .contact(Contact::of("plate", "z-", plate).thickness(0.005).refine(1))?;
    let mut trajectory = Trajectory::from_given(moving(&solid, Vec3::new(0.0, 0.0, -10.0)));
    let to = [StepTo { dt: 0.1, controls: solid.controls() }];
    solid.model().advance(&mut trajectory, &scheme("backward_euler"), &to, &STRICT, &mut Workspace::default())?;
    let lowest = solid.mesh().points().iter().zip(trajectory.end().u.chunks_exact(3)).map(|(x, u)| x[2] + u[2]);
    let lowest = lowest.fold(f64::INFINITY, f64::min);
    assert!(lowest > -0.32, "{lowest}");
    assert!(quantity(&solid, trajectory.end(), "force_z") > 0.0);
    Ok(())
}

/// A soft block that falls on a rough floor: its impact is found from the one without friction, a load step for each slip speed.
#[test]
fn a_hard_impact_is_found_by_continuation() -> Outcome {
    let solid = Solid::new(regular(CellKind::Tet4, [0.17, 0.17, 0.057], [6, 6, 2])?)?
        .material("body", NeoHooke::new(357.0, 1429.0)?)?
        .body_force("body", Vec3::new(0.0, 0.0, -9.81 * 800.0))?
        .inertia(Inertia::new("body", 800.0))?
        .rayleigh_damping(0.0, 0.01)?
        .contact(
            Contact::of("floor", "skin", Obstacle::half_space([0.0, 0.0, -0.003], [0.02, 0.01, 1.0]))
                .friction(1.15, 1e-3),
        )?;
    let mut trajectory = Trajectory::from_given(moving(&solid, Vec3::new(0.3, 0.0, -2.1)));
    let steps = vec![StepTo { dt: 0.01, controls: solid.controls() }; 8];
    let how = SolveOptions::default();
    solid.model().advance(&mut trajectory, &scheme("backward_euler"), &steps, &how, &mut Workspace::default())?;
    let load_steps: Vec<usize> = trajectory.states().iter().skip(1).map(|state| state.report.load_steps).collect();
    assert!(load_steps.iter().any(|steps| *steps > 1), "{load_steps:?}");
    assert!(newton(&trajectory) < 330, "{}", newton(&trajectory));
    Ok(())
}

/// A strip that a pad drags along at a constant speed, without inertia: from where the last velocity leads no sample seems to slip.
#[test]
fn a_dragged_strip_coasts() -> Outcome {
    let pad = Obstacle::half_space([0.0, 1.0, 0.0], [0.0, -1.0, 0.0]);
    let floor = Obstacle::half_space([0.0; 3], [0.0, 1.0, 0.0]);
    let solid = Solid::new(regular(CellKind::Quad4, [3.0, 1.0, 0.0], [12, 4, 1])?)?
        .material("body", NeoHooke::new(4e4, 6e4)?)?
        .clamp("y-")?
        .contact(Contact::of("pad", "y+", pad).thickness(0.01).friction(0.9, 1e-4))?
        .contact(Contact::of("floor", "y-", floor).thickness(0.01))?;
    let at = |n: usize| {
        let mut controls = solid.controls();
        let values = controls.values_mut(0);
        (values[0], values[1]) = (0.004 * n.saturating_sub(4) as f64, -0.02 * (n as f64 / 4.0).min(1.0));
        StepTo { dt: 0.01, controls }
    };
    let mut trajectory = Trajectory::from_given(solid.rest());
    let steps: Vec<StepTo> = (1..=24).map(at).collect();
    let how = SolveOptions::default();
    solid.model().advance(&mut trajectory, &scheme("quasi_static"), &steps, &how, &mut Workspace::default())?;
    assert!(newton(&trajectory) < 400, "{}", newton(&trajectory));
    Ok(())
}

/// A plate that is pressed into a block by a quarter of its height in one solve, a hundred times the layer: the block follows it from load step to load
/// step.
#[test]
fn load_steps_follow_a_plate_that_moves_far() -> Outcome {
    let plate = Obstacle::half_space([0.0, 1.05, 0.0], [0.1, -1.0, 0.0]);
    let solid = Solid::new(regular(CellKind::Quad4, [1.0, 1.0, 0.0], [6, 6, 1])?)?
        .material("body", NeoHooke::from_young_poisson(5e4, 0.3)?)?
        .clamp("y-")?
        .contact(Contact::of("plate", "y+", plate))?;
    let mut controls = solid.controls();
    controls.values_mut(0)[1] = -0.3;
    let state = solid.solve(&controls, &SolveOptions::default())?;
    assert!(quantity(&solid, &state, "force_y") < -5e3, "{}", quantity(&solid, &state, "force_y"));
    assert!(state.report.newton < 250, "{} Newton iterations", state.report.newton);
    Ok(())
}
