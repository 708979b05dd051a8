//! Motions of rigid surfaces: against prescribed displacements, rigid turns, reactions, paths, and what is refused.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::block::STRICT;
use common::{Outcome, largest, regular};
use nastic_energy::NeoHooke;
use nastic_fem::{Instant, MovingSupport, PathOptions, Solid, SolveOptions, State, Workspace};
use nastic_mesh::CellKind;
use nastic_tensor::Vec3;
use std::f64::consts::PI;

fn bar(kind: CellKind) -> Outcome<Solid> {
    Ok(Solid::new(regular(kind, [2.0, 0.5, 0.5], [4, 2, 2])?)?.material("body", NeoHooke::new(4e4, 6e4)?)?)
}

fn solve(solid: &Solid, values: [f64; 6]) -> Outcome<State> {
    let mut controls = solid.controls();
    controls.values_mut(0).copy_from_slice(&values);
    Ok(solid.solve(&controls, &STRICT)?)
}

fn difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0f64, |most, (a, b)| most.max((a - b).abs()))
}

/// A pure translation is a prescribed displacement; the reactions are reported under the motion's name.
#[test]
fn a_translation_is_a_prescribed_displacement() -> Outcome {
    for kind in [CellKind::Hex8, CellKind::Tet10, CellKind::Quad9] {
        let z = if kind.dim() == 3 { 0.1 } else { 0.0 };
        let moved =
            solve(&bar(kind)?.clamp("x-")?.motion(MovingSupport::of("grip", "x+"))?, [-0.2, 0.3, z, 0.0, 0.0, 0.0])?;
        let displaced = bar(kind)?.clamp("x-")?.displace("x+", [Some(-0.2), Some(0.3), Some(z)])?;
        let held = displaced.solve(&displaced.controls(), &STRICT)?;
        assert!(difference(&moved.u, &held.u) < 1e-9, "{kind}: {:e}", difference(&moved.u, &held.u));
    }
    let solid = bar(CellKind::Hex8)?.clamp("x-")?.motion(MovingSupport::of("grip", "x+"))?;
    assert!(
        solid.supports().reactions(&vec![1.0; solid.discretization().dofs()]).iter().any(|(name, _)| name == "grip")
    );
    Ok(())
}

/// A free block that is held at one end alone turns with it: no energy, the exact rotation, for angles far from small.
#[test]
fn a_free_block_turns_without_energy() -> Outcome {
    for (kind, rotation) in [
        (CellKind::Hex8, [0.0, 0.0, 0.5 * PI]),
        (CellKind::Hex8, [0.7, -0.9, 0.4]),
        (CellKind::Tet10, [1e-7, 0.0, 2e-7]),
        (CellKind::Quad4, [0.0, 0.0, 2.5]),
    ] {
        let plane = kind.dim() == 2;
        let centre = if plane { [0.3, -0.2, 0.0] } else { [0.3, -0.2, 0.1] };
        let solid = bar(kind)?.motion(MovingSupport::of("grip", "x-").about(centre))?;
        let shift = Vec3::new(0.4, 0.1, if plane { 0.0 } else { -0.3 });
        let state = solve(&solid, [shift.x, shift.y, shift.z, rotation[0], rotation[1], rotation[2]])?;
        // the rotation by another formula
        let r = nalgebra::Rotation3::from_scaled_axis(Vec3::from(rotation));
        let turned =
            |x: &[f64; 3]| shift + r * (Vec3::from(*x) - Vec3::from(centre)) + Vec3::from(centre) - Vec3::from(*x);
        let dim = kind.dim();
        let expected: Vec<f64> =
            solid.mesh().points().iter().flat_map(|x| turned(x).as_slice()[..dim].to_vec()).collect();
        assert!(difference(&state.u, &expected) < 1e-9, "{kind}: {:e}", difference(&state.u, &expected));
        assert!(state.report.energy.abs() < 1e-9, "{kind}: energy {:e}", state.report.energy);
    }
    Ok(())
}

/// The path by arc length to a turned grip ends in the state that the solve finds; so does the ramp.
#[test]
fn paths_and_ramps_go_along_a_rotation() -> Outcome {
    let solid = bar(CellKind::Hex8)?.clamp("x-")?.motion(MovingSupport::of("grip", "x+"))?;
    let values = [-0.1, 0.0, 0.05, 0.3, 0.6, -0.2];
    let direct = solve(&solid, values)?;
    let mut controls = solid.controls();
    controls.values_mut(0).copy_from_slice(&values);
    let mut workspace = Workspace::default();
    let path = solid.model().stability().path(
        &solid.rest(),
        (&controls, 1.0),
        &PathOptions::default(),
        &SolveOptions::default(),
        &mut workspace,
        &mut |_| {},
    )?;
    let end = path.points.last().ok_or("no points")?;
    assert!(difference(&end.state.u, &direct.u) < 1e-6, "{:e}", difference(&end.state.u, &direct.u));
    let ramp = solid.model().stability().ramp(&solid.controls(), &controls, 3, &STRICT, &mut workspace, &mut |_| {})?;
    let last = ramp.points.last().ok_or("no points")?;
    assert!(ramp.failure.is_none() && difference(&last.state.u, &direct.u) < 1e-8);
    Ok(())
}

#[test]
fn what_cannot_move_is_refused() -> Outcome {
    let message = |solid: Result<Solid, nastic_fem::FemError>, words: [&str; 2]| {
        let message = solid.err().map(|error| error.to_string()).unwrap_or_default();
        assert!(words.iter().all(|word| message.contains(word)), "{message}");
    };
    let grip = || MovingSupport::of("grip", "x+");
    message(bar(CellKind::Hex8)?.clamp("x+")?.motion(grip()), ["grip", "x+"]);
    message(bar(CellKind::Hex8)?.motion(grip())?.clamp("x+"), ["grip", "x+"]);
    message(bar(CellKind::Hex8)?.motion(grip())?.motion(MovingSupport::of("other", "y-")), ["grip", "other"]);
    message(bar(CellKind::Hex8)?.motion(MovingSupport::of("grip", "x*")), ["x*", "not found"]);
    message(bar(CellKind::Hex8)?.clamp("x-")?.motion(MovingSupport::of("x-", "x+")), ["x-", "rename the motion"]);
    message(bar(CellKind::Hex8)?.motion(grip().about([f64::NAN, 0.0, 0.0])), ["grip", "finite"]);
    let plane = bar(CellKind::Quad4)?.clamp("x-")?.motion(grip())?;
    let why = solve(&plane, [0.0, 0.0, 0.0, 0.1, 0.0, 0.0]).err().ok_or("a turn out of the plane")?.to_string();
    assert!(why.contains("grip") && why.contains("plane"), "{why}");
    let at_rest = solve(&plane, [0.0; 6])?;
    assert_eq!(largest(&at_rest.u), 0.0);
    let quantities = plane.model().quantities(&Instant::new(&at_rest.u, &at_rest.controls, 1.0))?;
    assert!(quantities.is_empty());
    Ok(())
}
