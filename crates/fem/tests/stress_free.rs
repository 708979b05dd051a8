//! States without stress, in which no force is left that residuals could be measured against.

#![allow(clippy::unwrap_used)] // helpers of tests

use crate::common;
use crate::rigid_body::parts;

use common::{Outcome, regular};
use nastic_energy::NeoHookeIsochoric;
use nastic_fem::{Formulation, MovingSupport, RigidBody, Solid, SolveOptions};
use nastic_mesh::CellKind;

/// Young's modulus 1 at Poisson's ratio nu.
fn law(nu: f64) -> Outcome<NeoHookeIsochoric> {
    Ok(NeoHookeIsochoric::new(0.5 / (1.0 + nu), 1.0 / (3.0 * (1.0 - 2.0 * nu)))?)
}

/// An arm that is shifted by a quarter of its length has no stress, whatever its bulk modulus.
#[test]
fn a_shift_takes_few_iterations() -> Outcome {
    for (kind, size) in [
        (CellKind::Quad9, [20.0, 5.0, 0.0]),
        (CellKind::Hex8, [20.0, 5.0, 5.0]),
        (CellKind::Hex27, [20.0, 5.0, 5.0]),
        (CellKind::Tet10, [20.0, 5.0, 5.0]),
    ] {
        for nu in [0.45, 0.4995, 0.49995] {
            let formulation = Formulation::nearly_incompressible(kind).ok_or("none for this kind")?;
            let solid = Solid::new(regular(kind, size, [4, 1, 1])?)?
                .material("body", law(nu)?)?
                .formulation("body", formulation)?
                .motion(MovingSupport::of("hub", "x-"))?;
            let mut controls = solid.controls();
            controls.values_mut(0)[0] = -5.0;
            let state = solid.solve(&controls, &SolveOptions::default())?;
            let dim = solid.mesh().dim();
            let off = state.u.chunks(dim).map(|u| (u[0] + 5.0).abs() + u[1].abs()).fold(0.0, f64::max);
            println!(
                "{kind} {nu}: {} iterations, residual {:.1e}, off {off:.1e}",
                state.report.newton, state.report.residual
            );
            assert!(
                off < 1e-9 && state.report.newton <= 5,
                "{kind}, {nu}: {} iterations, {off:e}",
                state.report.newton
            );
            assert!(state.report.residual < 1e-6, "{kind}, {nu}: residual {:e}", state.report.residual);
        }
    }
    Ok(())
}

/// Soft material around a rigid plug, in every formulation, without a load: undeformed.
#[test]
fn a_rigid_plug_without_load_stays() -> Outcome {
    let mesh = || parts(&regular(CellKind::Hex8, [4.0, 2.0, 2.0], [4, 2, 2])?, |x| x.x > 2.0);
    for formulation in Formulation::ALL.iter().filter(|one| one.kinds().contains(&CellKind::Hex8)) {
        let solid = Solid::new(mesh()?)?
            .material("soft", law(0.45)?)?
            .material("hard", law(0.3)?)?
            .formulation("soft", *formulation)?
            .clamp("x-")?
            .rigid(&RigidBody::new("plug", "hard"))?;
        let state = solid.solve(&solid.controls(), &SolveOptions::default())?;
        let moved = solid.model().nodal(&state.u).iter().fold(0.0, |most: f64, u| most.max(u.abs()));
        assert!(
            moved < 1e-12 && state.report.newton <= 5,
            "{formulation:?}: {} iterations, {moved:e}",
            state.report.newton
        );
    }
    Ok(())
}
