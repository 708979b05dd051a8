//! Negative pivots: how many ways a state has to fall.

use crate::common;

use common::block::STRICT;
use common::{Outcome, regular};
use nastic_energy::NeoHooke;
use nastic_fem::{Solid, SolveOptions, State};
use nastic_mesh::CellKind;
use nastic_tensor::Vec3;
use std::f64::consts::PI;

/// `E = 1` without lateral contraction, so that plane strain is no stiffer.
fn law() -> Outcome<NeoHooke> {
    Ok(NeoHooke::new(0.5, 0.0)?)
}

/// Unit cantilever of height h and depth b (plane: none), compressed along its axis by a multiple of Euler's load
/// `pi^2 E h^3 b / (12 (2 L)^2)` about z.
fn column(kind: CellKind, h: f64, b: f64, multiple: f64) -> Outcome<(Solid, State)> {
    let critical = PI.powi(2) * h * h / 48.0;
    let solid = Solid::new(regular(kind, [1.0, h, b], [10, 1, 1])?)?
        .material("body", law()?)?
        .clamp("x-")?
        .traction("x+", Vec3::x() * -multiple * critical)?;
    let state = solid.solve(&solid.controls(), &STRICT)?;
    Ok((solid, state))
}

fn negative_pivots(kind: CellKind, h: f64, b: f64, multiple: f64) -> Outcome<usize> {
    let (solid, state) = column(kind, h, b, multiple)?;
    Ok(solid.negative_pivots(&state)?)
}

#[test]
fn a_plane_column_buckles_one_way() -> Outcome {
    for kind in [CellKind::Quad8, CellKind::Quad9, CellKind::Tri6] {
        assert_eq!(negative_pivots(kind, 0.05, 0.0, 0.97)?, 0, "{kind}, below Euler's load");
        assert_eq!(negative_pivots(kind, 0.05, 0.0, 1.03)?, 1, "{kind}, above Euler's load");
        // the next mode comes at nine times the load
        assert_eq!(negative_pivots(kind, 0.05, 0.0, 7.0)?, 1, "{kind}");
    }
    Ok(())
}

#[test]
fn a_square_column_buckles_two_ways_and_a_flat_one_about_its_weak_axis() -> Outcome {
    for kind in [CellKind::Hex20, CellKind::Hex27] {
        assert_eq!(negative_pivots(kind, 0.05, 0.05, 0.97)?, 0, "{kind}");
        assert_eq!(negative_pivots(kind, 0.05, 0.05, 1.03)?, 2, "{kind}");
        assert_eq!(negative_pivots(kind, 0.05, 0.1, 1.03)?, 1, "{kind}");
    }
    Ok(())
}

/// A column above its load stays straight where nothing disturbs it; disturbed it finds the bent, stable state.
#[test]
fn a_disturbed_column_falls_to_a_stable_state() -> Outcome {
    let (solid, straight) = column(CellKind::Quad9, 0.05, 0.0, 1.2)?;
    assert!(common::largest(&straight.u) < 0.01);
    let disturbed = solid.clone().traction("x+", Vec3::y() * 1e-6)?;
    let bent = disturbed.solve(&disturbed.controls(), &STRICT)?;
    assert_eq!(disturbed.negative_pivots(&bent)?, 0);
    assert!(common::largest(&bent.u) > 0.3, "{}", common::largest(&bent.u));
    // freed of what disturbed it, it stays
    let state = solid.solve(&solid.controls(), &SolveOptions { near: Some(&bent), ..STRICT })?;
    assert_eq!(solid.negative_pivots(&state)?, 0);
    assert!(common::largest(&state.u) > 0.3);
    assert!(state.report.energy < straight.report.energy);
    Ok(())
}
