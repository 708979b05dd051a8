//! From saddles down to minima of the potential.

#![allow(clippy::panic)] // tests

use crate::common;

use common::block::STRICT;
use common::{Outcome, largest, regular};
use nastic_energy::{NeoHooke, NeoHookeIsochoric};
use nastic_fem::{Cause, Formulation, Solid, SolveOptions, State, StateError, Workspace};
use nastic_mesh::{CellKind, box_mesh};
use nastic_tensor::Vec3;
use std::f64::consts::PI;

/// A unit cantilever of height h, E = 1 and nu = 0, pressed by a multiple of Euler's load; straight.
fn column(kind: CellKind, h: f64, multiple: f64) -> Outcome<(Solid, State)> {
    let solid = Solid::new(regular(kind, [1.0, h, h], [10, 1, 1])?)?
        .material("body", NeoHooke::new(0.5, 0.0)?)?
        .clamp("x-")?
        .traction("x+", Vec3::x() * -multiple * PI.powi(2) * h * h / 48.0)?;
    let state = solid.solve(&solid.controls(), &STRICT)?;
    Ok((solid, state))
}

/// Once or twice unstable, plane and in space, where it may fall to any side; slender ones too.
#[test]
fn a_straight_column_falls_to_its_bent_state() -> Outcome {
    for (kind, h, multiple) in [
        (CellKind::Quad9, 0.05, 1.2),
        (CellKind::Quad9, 0.01, 1.5),
        (CellKind::Quad8, 0.05, 12.0),
        (CellKind::Hex20, 0.05, 1.2),
    ] {
        let (solid, straight) = column(kind, h, multiple)?;
        assert!(solid.negative_pivots(&straight)? > 0 && largest(&straight.u) < 0.05);
        let found = solid.model().stability().descend(&straight, &STRICT, &mut Workspace::default())?;
        assert!(found.saddles > 0);
        assert_eq!(solid.negative_pivots(&found.state)?, 0, "{kind}, {multiple} times the load");
        assert!(found.state.report.energy < straight.report.energy);
        assert!(found.state.report.newton > 0 && found.state.report.residual < 1e-10);
        // between the first load and the second there is one bent branch and its mirror image
        if kind == CellKind::Quad9 {
            let push = solid.clone().traction("x+", Vec3::y() * 1e-3 * h * h)?;
            let pushed = push.solve(&push.controls(), &STRICT)?;
            let bent = solid.solve(&solid.controls(), &SolveOptions { near: Some(&pushed), ..STRICT })?;
            let (a, b) = (bent.report.energy, found.state.report.energy);
            assert!((a - b).abs() < 1e-9 * a.abs(), "{kind}, {multiple} times the load: {a:e} and {b:e}");
        }
    }
    Ok(())
}

/// 200 x 10 x 4 mm of silicone, mu = 0.3 MPa and kappa = 300 MPa, held at one end and pressed at the other beyond its second critical load: along a
/// straight line its volume would change. The potential is that of the elastica, `P (2 x - L cos a - L)` with
/// `x = L (2 E(k) / K(k) - 1)`, `cos a = 1 - 2 k^2`, `K(k)^2 = P L^2 / EI`, but for ten cells along it.
#[test]
fn a_nearly_incompressible_strip_falls_to_its_bent_state() -> Outcome {
    for (pressure, elastica) in [(500.0, -4.085e-3), (1500.0, -1.721e-2)] {
        let solid = Solid::new(box_mesh([0.2, 0.01, 0.004], [10, 1, 1], CellKind::Hex27)?)?
            .material("body", NeoHookeIsochoric::new(0.3e6, 300e6)?)?
            .formulation("body", Formulation::LinearDilatation)?
            .clamp("x-")?
            .traction("x+", Vec3::x() * -pressure)?;
        let straight = solid.solve(&solid.controls(), &STRICT)?;
        assert!(solid.negative_pivots(&straight)? > 1);
        let found = solid.model().stability().descend(&straight, &STRICT, &mut Workspace::default())?;
        assert_eq!(solid.negative_pivots(&found.state)?, 0, "{pressure} Pa");
        let potential = found.state.report.energy;
        assert!((potential / elastica - 1.0).abs() < 0.04, "{pressure} Pa: {potential:e} J");
    }
    Ok(())
}

#[test]
fn a_stable_state_stays_and_what_cannot_be_is_refused() -> Outcome {
    let (solid, state) = column(CellKind::Quad8, 0.05, 0.5)?;
    let found = solid.model().stability().descend(&state, &STRICT, &mut Workspace::default())?;
    assert_eq!((found.saddles, &found.state.u), (0, &state.u));
    let half = State { load: 0.5, ..state };
    let refused = solid.model().stability().descend(&half, &STRICT, &mut Workspace::default());
    assert!(matches!(refused, Err(StateError::Problem(_))), "{refused:?}");
    Ok(())
}

/// One Newton iteration from each start leads nowhere.
#[test]
fn a_saddle_without_a_way_down_is_named() -> Outcome {
    let (solid, straight) = column(CellKind::Quad9, 0.05, 1.2)?;
    let short = SolveOptions { max_newton: 1, ..STRICT };
    let failed = solid.model().stability().descend(&straight, &short, &mut Workspace::default());
    let Err(error @ StateError::NoConvergence { cause: Cause::Saddle { negative: 1 }, .. }) = &failed else {
        panic!("{:?}", failed.map(|found| found.saddles));
    };
    assert!(
        error.to_string().contains("no stable equilibrium found") && error.to_string().contains("1 negative pivots")
    );
    Ok(())
}
