//! Nearly incompressible chambers inflated by volume against an obstacle with friction: what their steps take, beside those without friction.

#![allow(clippy::unwrap_used)] // helpers of tests

use crate::common;

use common::{Outcome, regular};
use nastic_energy::NeoHookeIsochoric;
use nastic_fem::schemes::SCHEMES;
use nastic_fem::{Cavity, Contact, Formulation, Solid, SolveOptions, StepTo, TimeStepping, Trajectory, Workspace};
use nastic_mesh::CellKind;
use nastic_mesh::spatial::Obstacle;
use std::f64::consts::PI;

const STEPS: usize = 6;

/// Half a ring of radii 1 and 1.3 between clamped ends, below a tilted wall that it meets when it is inflated; bulk over shear 5000.
fn chamber(friction: f64) -> Outcome<Solid> {
    let ring = regular(CellKind::Quad9, [1.0; 3], [2, 16, 1])?.mapped(|[x, y, _]| {
        let (r, angle) = (1.0 + 0.3 * x, PI * y);
        [r * angle.cos(), if y == 0.0 || y == 1.0 { 0.0 } else { r * angle.sin() }, 0.0]
    })?;
    let wall = Obstacle::half_space([0.0, 1.39, 0.0], [0.3, -1.0, 0.0]);
    let contact = Contact::of("wall", "x+", wall).thickness(0.01).stiffness(100.0);
    Ok(Solid::new(ring)?
        .material("body", NeoHookeIsochoric::new(1.0, 5e3)?)?
        .formulation("body", Formulation::LinearDilatation)?
        .clamp("y-")?
        .clamp("y+")?
        .cavity(Cavity::new("air", "x-").lid().by_volume())?
        .contact(if friction > 0.0 { contact.friction(friction, 0.01) } else { contact })?)
}

/// Newton iterations of all steps, steps of load beside the time steps, and the pressure at the end.
fn inflated(solid: &Solid) -> Outcome<(usize, usize, f64)> {
    let to = |n: usize| {
        let mut controls = solid.controls();
        controls.values_mut(0)[0] = 0.3 * n as f64 / STEPS as f64;
        StepTo { dt: 0.1, controls }
    };
    let steps: Vec<StepTo> = (1..=STEPS).map(to).collect();
    let scheme = (SCHEMES.iter().find(|row| row.name == "quasi_static").unwrap().build)()?;
    let mut run = Trajectory::from_given(solid.rest());
    solid.model().advance(&mut run, &scheme, &steps, &SolveOptions::default(), &mut Workspace::default())?;
    let newton = run.states().iter().map(|state| state.report.newton).sum();
    let cuts = run.states().iter().map(|state| state.report.cuts).sum();
    let end = run.end();
    Ok((newton, cuts, end.u[solid.discretization().dofs()]))
}

#[test]
fn a_given_volume_is_found_against_a_wall_with_friction() -> Outcome {
    let ((smooth, _, without), (rough, cuts, with)) = (inflated(&chamber(0.0)?)?, inflated(&chamber(0.5)?)?);
    assert!(cuts == 0 && rough <= 8 * smooth, "{rough} iterations and {cuts} cuts, without friction {smooth}");
    assert!((with / without - 1.0).abs() < 0.3 && with != without, "pressures {with} and {without}");
    Ok(())
}
