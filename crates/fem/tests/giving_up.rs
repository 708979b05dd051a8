//! Solves that must fail do so soon, and say why.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::Outcome;
use common::shells::shell;
use nastic_energy::NeoHooke;
use nastic_fem::{Cause, Cavity, Controls, Solid, SolveOptions, StateError};
use nastic_mesh::CellKind;

/// An eighth of a thick sphere that is inflated.
fn sphere() -> Outcome<Solid> {
    let planes = ["x-", "y-", "z-"];
    let mut solid = Solid::new(shell(CellKind::Hex20, 1)?)?
        .material("body", NeoHooke::new(1.0, 10.0)?)?
        .cavity(planes.into_iter().fold(Cavity::new("air", "inner"), Cavity::symmetry))?;
    for (k, plane) in planes.into_iter().enumerate() {
        solid = solid.displace(plane, std::array::from_fn(|i| (i == k).then_some(0.0)))?;
    }
    Ok(solid)
}

fn pressure(solid: &Solid, p: f64) -> Outcome<Controls> {
    let mut controls = solid.controls();
    controls.set(0, 0, &[p])?;
    Ok(controls)
}

/// The pressure of an inflated neo-Hookean sphere has a maximum: beyond it there is no equilibrium.
#[test]
fn a_sphere_beyond_its_largest_pressure_ends_at_a_limit_point() -> Outcome {
    let solid = sphere()?;
    let how = SolveOptions::default();
    // The largest pressure, by bisection from states nearby.
    let (mut low, mut high) = (0.0, 4.0);
    let mut near = solid.rest();
    while high - low > 2e-3 {
        let p = 0.5 * (low + high);
        match solid.solve(&pressure(&solid, p)?, &SolveOptions { near: Some(&near), ..how.clone() }) {
            Ok(state) => (low, near) = (p, state),
            Err(_) => high = p,
        }
    }
    for beyond in [1.2, 3.0] {
        let error =
            solid.solve(&pressure(&solid, beyond * high)?, &how).err().ok_or("an equilibrium beyond the limit")?;
        let StateError::NoConvergence { newton, reached, cause, .. } = &error else { panic!("{error}") };
        let Cause::LimitPoint { load } = cause else { panic!("{error}") };
        assert!((load * beyond - 1.0).abs() < 0.05 && *reached * beyond <= 1.0, "{error}");
        assert!(*newton < 700, "{error}");
    }
    Ok(())
}
