//! Plane strain is the slice of a body held flat on both sides: same answers node by node.

use crate::common;

use common::block::STRICT;
use common::{Outcome, regular};
use nastic_energy::{FiberTension, TransverseMooneyRivlin, Turgor};
use nastic_fem::{Solid, State};
use nastic_mesh::CellKind;
use nastic_tensor::Vec3;

const SIZE: [f64; 3] = [1.0, 0.3, 0.25];

/// A cantilever under fibre tension that varies over its height, turgor, a body force and a pull at its tip.
fn cantilever(kind: CellKind) -> Outcome<(Solid, State)> {
    let mesh = regular(kind, SIZE, [4, 2, 1])?;
    let mut solid = Solid::new(mesh)?
        .material("body", TransverseMooneyRivlin::new(1e5, 2e4, 3e5, 1e6, Vec3::new(0.8, 0.6, 0.0))?)?
        .actuate("body", "tension", FiberTension::along(Vec3::new(0.6, 0.8, 0.0))?)?
        .actuate("body", "turgor", Turgor::new())?
        .clamp("x-")?
        .traction("x+", Vec3::new(500.0, -900.0, 0.0))?
        .body_force("body", Vec3::new(0.0, -2e3, 0.0))?;
    if kind.dim() == 3 {
        solid = solid.displace("z-", [None, None, Some(0.0)])?.displace("z+", [None, None, Some(0.0)])?;
    }
    let mut controls = solid.controls();
    let at = solid.discretization().points().positions(solid.mesh(), None);
    controls.set(0, 0, &at.iter().map(|x| -4e5 * x[1] / SIZE[1]).collect::<Vec<_>>())?;
    controls.set(1, 0, &at.iter().map(|x| 1e5 * x[0]).collect::<Vec<_>>())?;
    let state = solid.solve(&controls, &STRICT)?;
    Ok((solid, state))
}

fn assert_same(plane: CellKind, solid: CellKind) -> Outcome {
    let (slice, flat) = cantilever(plane)?;
    let (body, state) = cantilever(solid)?;
    let deflection = common::largest(&flat.u);
    assert!(deflection > 0.1, "{plane}: the cantilever hardly moves, {deflection}");
    for (node, &[x, y, z]) in body.mesh().points().iter().enumerate() {
        let twin = common::node_at(slice.mesh(), [x, y, 0.0]).ok_or("no node below")?;
        let (found, expected) = (&state.u[3 * node..3 * node + 3], &flat.u[2 * twin..2 * twin + 2]);
        let error = (found[0] - expected[0]).abs().max((found[1] - expected[1]).abs()).max(found[2].abs());
        assert!(error < 1e-10, "{solid}: {found:?} at ({x}, {y}, {z}), {expected:?} in {plane}");
    }
    let (found, expected) = (state.report.energy, flat.report.energy * SIZE[2]);
    assert!((found - expected).abs() < 1e-11 * expected.abs(), "{solid}: potential {found}, {plane} has {expected}");
    Ok(())
}

#[test]
fn quad4_is_a_slice_of_hex8() -> Outcome {
    assert_same(CellKind::Quad4, CellKind::Hex8)
}

#[test]
fn quad8_is_a_slice_of_hex20() -> Outcome {
    assert_same(CellKind::Quad8, CellKind::Hex20)
}

#[test]
fn quad9_is_a_slice_of_hex27() -> Outcome {
    assert_same(CellKind::Quad9, CellKind::Hex27)
}
