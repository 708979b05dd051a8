//! Elastic foundations: what they hold, the force they carry, uniform states.

use crate::common;

use common::block::STRICT;
use common::{Outcome, regular};
use nastic_energy::NeoHooke;
use nastic_fem::{FemError, Foundation, Instant, Solid, StateError, check_contribution};
use nastic_mesh::CellKind;
use nastic_tensor::Vec3;

const STIFFNESS: f64 = 2e5;

fn block(kind: CellKind) -> Outcome<Solid> {
    Ok(Solid::new(regular(kind, [1.0, 0.5, 0.5], [3, 2, 2])?)?.material("body", NeoHooke::new(4e4, 6e4)?)?)
}

/// A pull t at the other end of a block on rollers: the bed gives way by t / k everywhere, whatever the elements.
#[test]
fn a_uniform_pull_moves_the_surface_by_its_share() -> Outcome {
    let pull = 8e3;
    for kind in common::kinds() {
        let rollers = block(kind)?.displace("y-", [None, Some(0.0), None])?;
        let rollers = if kind.dim() == 3 { rollers.displace("z-", [None, None, Some(0.0)])? } else { rollers };
        let solid = rollers
            .foundation(Foundation::on("x-", STIFFNESS).normal_only())?
            .traction("x+", Vec3::new(pull, 0.0, 0.0))?;
        let state = solid.solve(&solid.controls(), &STRICT)?;
        for &node in &solid.nodes_of("x-")? {
            let u = state.u[kind.dim() * node as usize];
            assert!((u - pull / STIFFNESS).abs() < 1e-9, "{kind}: {u} instead of {}", pull / STIFFNESS);
        }
        let all = solid.model().quantities(&Instant::new(&state.u, &state.controls, 1.0))?;
        let force = all.iter().find(|(_, what, _)| *what == "force_x").ok_or("no force")?.2;
        let area = if kind.dim() == 3 { 0.25 } else { 0.5 };
        assert!((force + pull * area).abs() < 1e-6, "{kind}: {force}");
        (0..2).try_for_each(|seed| check_contribution(solid.model(), "foundation on x-", seed))?;
    }
    Ok(())
}

/// Springs in every direction hold a body that nothing else holds; their force is that of the load.
#[test]
fn a_foundation_alone_holds_a_body() -> Outcome {
    for kind in [CellKind::Hex8, CellKind::Tet10, CellKind::Tri6] {
        let load = Vec3::new(3e2, -4e2, if kind.dim() == 3 { 2e2 } else { 0.0 });
        let solid = block(kind)?.foundation(Foundation::on("x-", STIFFNESS))?.body_force("body", load)?;
        let state = solid.solve(&solid.controls(), &STRICT)?;
        let volume = if kind.dim() == 3 { 0.25 } else { 0.5 };
        let all = solid.model().quantities(&Instant::new(&state.u, &state.controls, 1.0))?;
        for ((_, what, force), load) in all.iter().zip(load.iter()) {
            assert!((force + load * volume).abs() < 1e-7, "{kind}, {what}: {force}");
        }
        assert!(solid.negative_pivots(&state)? == 0, "{kind}");
    }
    Ok(())
}

/// Along the surface a bed of its normal holds nothing.
#[test]
fn what_a_foundation_leaves_free_is_told() -> Outcome {
    for (kind, expected) in [(CellKind::Hex8, 3), (CellKind::Quad4, 1)] {
        let sliding = block(kind)?.foundation(Foundation::on("x-", STIFFNESS).normal_only())?;
        match sliding.solve(&sliding.controls(), &STRICT) {
            Err(StateError::Problem(FemError::RigidMotion { free, .. })) => assert_eq!(free, expected, "{kind}"),
            other => return Err(format!("{kind}: {other:?}").into()),
        }
    }
    let refused = |foundation: Foundation, word: &str| -> Outcome {
        let message = block(CellKind::Hex8)?.foundation(foundation).err().ok_or("not refused")?.to_string();
        assert!(message.contains(word), "{message}");
        Ok(())
    };
    refused(Foundation::on("x-", 0.0), "positive")?;
    refused(Foundation::on("x-", f64::NAN), "positive")?;
    refused(Foundation::on("bed", 1.0), "bed")
}
