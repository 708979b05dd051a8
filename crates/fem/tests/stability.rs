//! Negative pivots: how many ways a state has to fall.

mod common;

use common::block::STRICT;
use common::{Outcome, regular};
use nastic_energy::{Magnet, NeoHooke};
use nastic_fem::{Request, Solid, State};
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
    let state = solid.solve(&solid.controls(), &STRICT)?.state;
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
    let bent = disturbed.solve(&disturbed.controls(), &STRICT)?.state;
    assert_eq!(disturbed.negative_pivots(&bent)?, 0);
    assert!(common::largest(&bent.u) > 0.3, "{}", common::largest(&bent.u));
    // freed of what disturbed it, it stays
    let state = solid.solve(&solid.controls(), &Request { near: Some(&bent), ..STRICT })?.state;
    assert_eq!(solid.negative_pivots(&state)?, 0);
    assert!(common::largest(&state.u) > 0.3);
    assert!(state.report.energy < straight.report.energy);
    Ok(())
}

/// A magnetised plane strip of unit length and height h: `B_r` along it, `B_a` at an angle, `mu0 = 1`;
/// `beta = 12 B_r B_a (L/h)^2 / E`. `cells` over the height.
fn strip(h: f64, cells: usize, beta: f64, field: Vec3) -> Outcome<(Solid, State)> {
    let solid = Solid::new(regular(CellKind::Quad9, [1.0, h, 0.0], [(cells as f64 / h) as usize, cells, 1])?)?
        .material("body", law()?)?
        .actuate("body", "magnet", Magnet::with_permeability(1.0)?)?
        .clamp("x-")?;
    let mut controls = solid.controls();
    let strength = beta * h * h / 12.0;
    for slot in controls.values_mut(0).chunks_exact_mut(6) {
        slot[0] = 1.0;
        slot[3..].copy_from_slice((field * strength).as_slice());
    }
    let state = solid.solve(&controls, &STRICT)?.state;
    Ok((solid, state))
}

/// Hard-magnetic cantilever in a field across it: converged values of second-order elements at `h/L` = 0.1 and 0.05,
/// which approach the elastica (0.671059, 0.669964) as `(h/L)^2` (docs/verification.md).
#[test]
fn a_magnetised_strip_bends_like_the_elastica() -> Outcome {
    for (h, x, y) in [(0.1, 0.66879, 0.67687), (0.05, 0.67047, 0.67172)] {
        let (solid, state) = strip(h, 6, 4.0, Vec3::y())?;
        let node = common::node_at(solid.mesh(), [1.0, 0.5 * h, 0.0]).ok_or("no node on the mid-line")?;
        let found = [1.0 + state.u[2 * node], state.u[2 * node + 1]];
        assert!(
            (found[0] - x).abs() < 1e-5 && (found[1] - y).abs() < 1e-5,
            "h/L = {h}: tip of the mid-line at {found:?}"
        );
    }
    Ok(())
}

/// A field against the magnetisation buckles the strip at `beta = (pi/2)^2`, a little earlier for thick ones:
/// 2.46548, 2.46693 at `h/L` = 0.1, 0.05 (docs/verification.md).
#[test]
fn a_field_against_the_magnetisation_buckles_the_strip() -> Outcome {
    for (h, critical) in [(0.1, 2.46548), (0.05, 2.46693)] {
        for (shift, expected) in [(-5e-5, 0), (5e-5, 1)] {
            let (solid, state) = strip(h, 2, critical + shift, -Vec3::x())?;
            assert_eq!(solid.negative_pivots(&state)?, expected, "h/L = {h}, beta = {critical} + {shift:e}");
        }
    }
    Ok(())
}
