//! Ramps of controls: warm starts, critical values, what is kept where a ramp fails.

use crate::common;

use common::block::STRICT;
use common::{Outcome, largest, regular};
use nastic_energy::{NeoHooke, Turgor};
use nastic_fem::{Controls, Ramp, Solid, SolveOptions, StateError, Workspace};
use nastic_mesh::CellKind;
use std::f64::consts::PI;

/// A strip of length 1 and height h between two clamps, with turgor, E = 1 and nu = 0.
fn strip(h: f64) -> Outcome<Solid> {
    Ok(Solid::new(regular(CellKind::Quad9, [1.0, h, 0.0], [20, 1, 1])?)?
        .material("body", NeoHooke::new(0.5, 0.0)?)?
        .actuate("body", "turgor", Turgor::new())?
        .clamp("x-")?
        .clamp("x+")?)
}

fn pressure(solid: &Solid, p: f64) -> Outcome<Controls> {
    let mut controls = solid.controls();
    controls.values_mut(0).fill(p);
    Ok(controls)
}

fn ramp(solid: &Solid, from: f64, to: f64, count: usize, how: &SolveOptions) -> Outcome<Ramp> {
    let ends = (&pressure(solid, from)?, &pressure(solid, to)?);
    let mut seen = 0;
    let found =
        solid.model().stability().ramp(ends.0, ends.1, count, how, &mut Workspace::default(), &mut |_| seen += 1)?;
    assert_eq!(seen, found.points.len());
    Ok(found)
}

/// Turgor presses the strip with the stress p against its clamps; Euler's load of a strip clamped at both ends is
/// `4 pi^2 E I / L^2`, so that `p = pi^2 E h^2 / (3 L^2)`, and 2.0457 times that for the next, antisymmetric mode.
#[test]
fn a_swelling_strip_buckles_at_eulers_load() -> Outcome {
    let h = 0.02;
    let euler = PI.powi(2) * h * h / 3.0;
    let solid = strip(h)?;
    let found = ramp(&solid, 0.0, 3.0 * euler, 4, &STRICT)?;
    assert!(found.failure.is_none());
    assert_eq!(found.points.iter().map(|point| point.negative).collect::<Vec<_>>(), [0, 0, 1, 2].map(Some));
    assert!(found.points.iter().all(|point| largest(&point.state.u) < 0.01), "it stays straight");
    assert_eq!(found.critical.len(), 2);
    for (critical, (expected, before)) in found.critical.iter().zip([(1.0, 0), (2.0457, 1)]) {
        assert!(critical.width <= 1e-3 / 3.0);
        assert_eq!((critical.before, critical.after), (before, before + 1));
        assert!((3.0 * critical.s / expected - 1.0).abs() < 0.02, "{} instead of {expected}", 3.0 * critical.s);
        // the interval holds the change
        for (side, count) in [(-0.5, critical.before), (0.5, critical.after)] {
            let at = pressure(&solid, 3.0 * euler * (critical.s + side * critical.width))?;
            let state = solid.solve(&at, &SolveOptions { near: Some(&critical.state), ..STRICT })?;
            assert_eq!(solid.negative_pivots(&state)?, count);
        }
    }
    Ok(())
}

/// Both crossings within one step, going down as well.
#[test]
fn several_crossings_in_one_step_are_told_apart() -> Outcome {
    let solid = strip(0.02)?;
    let p = PI.powi(2) * 0.02_f64.powi(2);
    let up = ramp(&solid, 0.0, p, 2, &STRICT)?;
    let down = ramp(&solid, p, 0.0, 2, &STRICT)?;
    assert_eq!((up.critical.len(), down.critical.len()), (2, 2));
    for (a, b) in up.critical.iter().zip(down.critical.iter().rev()) {
        assert_eq!((a.before, a.after), (b.after, b.before));
        assert!((a.s - (1.0 - b.s)).abs() < 1.1e-3, "{} and {}", a.s, 1.0 - b.s);
    }
    Ok(())
}

/// Warm starts: the points of a ramp are those of separate solves, with less work.
#[test]
fn points_are_the_equilibria_of_their_controls() -> Outcome {
    let solid = strip(0.1)?;
    let found = ramp(&solid, 0.01, 0.03, 5, &STRICT)?;
    for (k, point) in found.points.iter().enumerate() {
        assert_eq!(point.s, k as f64 / 4.0);
        let alone = solid.solve(&pressure(&solid, 0.01 + 0.02 * point.s)?, &STRICT)?;
        assert!(common::distance(&alone.u, &point.state.u) < 1e-9);
    }
    Ok(())
}

/// Pressures far beyond the law's moduli have no equilibrium that few iterations find; the points before stay.
#[test]
fn a_ramp_that_fails_keeps_what_it_has() -> Outcome {
    let solid = strip(0.2)?;
    let brief = SolveOptions { max_newton: 8, ..STRICT };
    let found = ramp(&solid, 0.0, 50.0, 11, &brief)?;
    let (s, why) = found.failure.as_ref().ok_or("it should fail")?;
    assert!(matches!(why, StateError::NoConvergence { .. } | StateError::Inadmissible { .. }), "{why}");
    assert!(!found.points.is_empty() && found.points.len() < 11);
    assert!((s - found.points.len() as f64 / 10.0).abs() < 1e-12);
    assert!(found.points.iter().all(|point| point.state.report.residual < 1e-10));
    let one = solid.model().stability().ramp(
        &solid.controls(),
        &solid.controls(),
        1,
        &STRICT,
        &mut Workspace::default(),
        &mut |_| (),
    );
    assert!(matches!(one, Err(StateError::Problem(_))), "{one:?}");
    Ok(())
}
