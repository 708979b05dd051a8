//! Several families of fibres on the same cells: the tensions that the laws bear together.

use crate::common;

use common::{Outcome, unit};
use nastic_energy::{EnergyTerm, FiberTension, MooneyRivlin, NeoHooke, Scale, TransverseMooneyRivlin, Weighted};
use nastic_fem::{Cause, ExcessTension, Solid, SolveOptions, StateError};
use nastic_mesh::CellKind;
use nastic_tensor::Vec3;
use std::sync::Arc;

const MU1: f64 = 1e5;
/// 2 mu1.
const LIMIT: f64 = 2e5;

/// A cube with families "a", "b", .. of fibres.
fn cube(law: impl EnergyTerm + 'static, families: &[Vec3]) -> Outcome<Solid> {
    let mut solid = Solid::new(unit(CellKind::Hex8, 2)?)?.material("body", law)?;
    for (name, a) in ["a", "b", "c"].into_iter().zip(families) {
        solid = solid.actuate("body", name, FiberTension::along(*a)?)?;
    }
    Ok(solid.clamp("x-")?)
}

fn in_plane(degrees: f64) -> Vec3 {
    let angle = degrees.to_radians();
    Vec3::new(angle.cos(), angle.sin(), 0.0)
}

/// The joint limit of the first of families on Mooney-Rivlin, and that of it alone.
fn limits(families: &[Vec3]) -> Outcome<[f64; 2]> {
    let solid = cube(MooneyRivlin::new(MU1, 2e4, 5e5)?, families)?;
    let body = solid.body();
    Ok([body.joint_fiber_limit(0).ok_or("no bound")?, body.fiber_limit(0).ok_or("no bound")?])
}

#[test]
fn angle_between_two_families() -> Outcome {
    assert_eq!(limits(&[Vec3::x()])?, [LIMIT, LIMIT]);
    for (degrees, expected) in [(90.0, LIMIT), (0.0, LIMIT / 2.0), (180.0, LIMIT / 2.0), (60.0, LIMIT / 1.5)] {
        let [joint, alone] = limits(&[in_plane(10.0), in_plane(10.0 + degrees)])?;
        assert!((joint / expected - 1.0).abs() < 1e-12, "{degrees} degrees: {joint}, not {expected}");
        assert!((alone / LIMIT - 1.0).abs() < 1e-12, "{degrees} degrees: {alone} alone");
    }
    // three at 60 degrees: sum a (x) a = 3/2 I in the plane
    let [joint, _] = limits(&[in_plane(0.0), in_plane(60.0), in_plane(120.0)])?;
    assert!((joint / (LIMIT / 1.5) - 1.0).abs() < 1e-12, "{joint}");
    Ok(())
}

/// Across the fibres of the law two families at 45 degrees to them bear 2 mu1, though each alone bears more.
#[test]
fn a_law_with_fibers_of_its_own() -> Outcome {
    let law = TransverseMooneyRivlin::new(MU1, 2e4, 3e5, 5e5, Vec3::x())?;
    let body = cube(law, &[in_plane(45.0), in_plane(-45.0)])?;
    let [joint, alone] = [body.body().joint_fiber_limit(1), body.body().fiber_limit(1)].map(Option::unwrap_or_default);
    assert!((joint / LIMIT - 1.0).abs() < 1e-12, "{joint}");
    // 2 mu1 (mu1 + mu3) / (mu1 + mu3 / 2)
    assert!((alone / 3.2e5 - 1.0).abs() < 1e-12, "{alone}");
    Ok(())
}

#[test]
fn only_families_on_the_same_cells_count() -> Outcome {
    let solid = Solid::new(unit(CellKind::Hex8, 2)?)?
        .material("body", NeoHooke::new(MU1, 5e5)?)?
        .actuate("body", "pull", FiberTension::along(Vec3::x())?.muscle())?
        .actuate("body", "swell", nastic_energy::Turgor::new())?
        .actuate("body", "push", FiberTension::along(Vec3::x())?)?
        .actuate("body", "lift", FiberTension::along(Vec3::y())?)?;
    let body = solid.body();
    assert_eq!((body.families_beside(2), body.joint_fiber_limit(2)), (vec!["lift"], Some(MU1)));
    assert_eq!((body.joint_fiber_limit(0), body.joint_fiber_limit(1)), (None, None));
    Ok(())
}

#[test]
fn excess_names_the_families() -> Outcome {
    let solid = cube(NeoHooke::new(MU1, 5e5)?, &[Vec3::x(), in_plane(60.0), Vec3::z()])?;
    let found = |tensions: [f64; 3]| {
        let mut controls = solid.controls();
        (0..3).for_each(|k| controls.values_mut(k).fill(tensions[k]));
        solid.body().excess_tension(&controls)
    };
    // sum of two at 60 degrees: largest eigenvalue 1.5 m
    assert_eq!(found([0.66e5, 0.66e5, 1e5]), None);
    // a contraction of one makes room for another no further than the law's own limit across it
    assert_eq!(found([0.99e5, -5e4, 0.0]), None);
    assert_eq!(found([1e5, 0.0, 1e5]), None);
    let excess = found([0.8e5, 0.8e5, -1e5]).ok_or("borne")?;
    let ExcessTension { actuation, tension, limit, beside } = &excess;
    assert_eq!((actuation.as_str(), *tension, beside.as_slice()), ("a", 0.8e5, [("b".to_owned(), 0.8e5)].as_slice()));
    assert!((limit / (MU1 / 1.5) - 1.0).abs() < 1e-12, "{limit}");
    Ok(())
}

/// Each tension within the limit of the law, both beyond it: the solve says so.
#[test]
fn a_failed_solve_names_both() -> Outcome {
    let solid = cube(NeoHooke::new(MU1, 5e5)?, &[Vec3::x(), Vec3::x()])?;
    let mut controls = solid.controls();
    controls.values_mut(0).fill(0.9e5);
    controls.values_mut(1).fill(0.95e5);
    let error =
        solid.solve(&controls, &SolveOptions::default()).err().ok_or("an unbounded energy found its minimum")?;
    let StateError::NoConvergence { cause: Cause::Convexity(excess), .. } = &error else { panic!("{error}") };
    assert_eq!((excess.actuation.as_str(), excess.beside[0].0.as_str()), ("b", "a"));
    let text = error.to_string();
    assert!(text.contains("\"b\" reaches 9.5000e4, beyond 5.1351e4") && text.contains("\"a\", 9.0000e4"), "{text}");
    Ok(())
}

/// No bound is stated of fibres whose tension a design scales, nor beside these.
#[test]
fn fibers_behind_a_number_have_no_bound() -> Outcome {
    let filled = Weighted::scaled("filler", Arc::new(FiberTension::along(Vec3::x())?), Scale::Guth)?;
    let solid = Solid::new(unit(CellKind::Hex8, 2)?)?
        .material("body", MooneyRivlin::new(MU1, 2e4, 5e5)?)?
        .actuate("body", "plain", FiberTension::along(Vec3::y())?)?
        .actuate("body", "filled", filled)?
        .clamp("x-")?;
    for k in 0..2 {
        assert_eq!((solid.body().fiber_limit(k), solid.body().joint_fiber_limit(k)), (None, None));
    }
    Ok(())
}
