//! Whether two equilibria lie on one branch: states before and behind a snap-through, straight and buckled ones.

use crate::common;

use common::block::STRICT;
use common::{Outcome, regular};
use nastic_energy::NeoHooke;
use nastic_fem::{Connection, Solid, SolveOptions};
use nastic_mesh::CellKind;
use nastic_tensor::Vec3;
use std::f64::consts::PI;

const E: f64 = 1e6;
const H: f64 = 0.02;

/// A strip between clamps, raised in the middle, under a dead weight.
fn strip(rise: f64, weight: f64) -> Outcome<Solid> {
    let flat = regular(CellKind::Quad8, [1.0, H, 0.0], [16, 1, 1])?;
    let raised = flat.points().iter().map(|x| [x[0], x[1] + rise * (1.0 - (2.0 * PI * x[0]).cos()), 0.0]).collect();
    Ok(Solid::new(flat.with_points(raised)?)?
        .material("body", NeoHooke::new(0.5 * E, 0.0)?)?
        .clamp("x-")?
        .clamp("x+")?
        .body_force("body", Vec3::y() * -weight)?)
}

/// An arch that has snapped is joined to the states before by a path with a limit point, to others behind it by one
/// without.
#[test]
fn a_snapped_arch_is_not_on_the_branch_of_rest() -> Outcome {
    let state = |weight: f64| -> Outcome<_> {
        let solid = strip(H, weight)?;
        Ok(solid.solve(&solid.controls(), &STRICT)?)
    };
    let solid = strip(H, 2000.0)?;
    let model = solid.model();
    let snapped = solid.solve(&solid.controls(), &STRICT)?;
    let Connection::LimitPoint(share) = model.stability().connection(&solid.rest(), &snapped, &STRICT)? else {
        return Err("the arch did not snap".into());
    };
    assert!((0.3..0.9).contains(&share), "{share}");
    // A state just before the limit point, and one at half its load.
    let before = |share: f64| -> Outcome<_> {
        let mut at = state(2000.0 * share)?;
        at.load = share;
        Ok(at)
    };
    let (half, near) = (before(0.5 * share)?, before(0.97 * share)?);
    assert_eq!(model.stability().connection(&half, &near, &STRICT)?, Connection::Connected);
    assert!(matches!(model.stability().connection(&near, &snapped, &STRICT)?, Connection::LimitPoint(_)));
    Ok(())
}

/// The path of a straight strip beyond its buckling load stays straight: it does not lead to the buckled state.
#[test]
fn a_buckled_strip_is_not_on_the_straight_branch() -> Outcome {
    let euler = 4.0 * PI.powi(2) * E * H * H / 12.0;
    let solid = |sideways: f64| -> Outcome<Solid> {
        Ok(Solid::new(regular(CellKind::Quad8, [1.0, H, 0.0], [16, 1, 1])?)?
            .material("body", NeoHooke::new(0.5 * E, 0.0)?)?
            .clamp("x-")?
            .displace("x+", [None, Some(0.0), Some(0.0)])?
            .traction("x+", Vec3::new(-1.5 * euler, 0.0, 0.0))?
            .body_force("body", Vec3::y() * sideways)?)
    };
    let pushed = solid(1.0)?;
    let aside = pushed.solve(&pushed.controls(), &STRICT)?;
    let solid = solid(0.0)?;
    let buckled = solid.solve(&solid.controls(), &SolveOptions { near: Some(&aside), ..STRICT })?;
    let Connection::Elsewhere(apart) = solid.model().stability().connection(&solid.rest(), &buckled, &STRICT)? else {
        return Err("the straight branch led to the buckled state".into());
    };
    assert!(apart > 0.3, "{apart}");
    Ok(())
}
