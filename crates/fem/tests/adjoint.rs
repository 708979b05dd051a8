//! The adjoint, and the derivative of what a state gives by its controls.

use crate::common;

use common::block::STRICT;
use common::{Outcome, distance, kinds, largest, noise, regular};
use nastic_energy::{FiberTension, MooneyRivlin, NeoHooke, Turgor};
use nastic_fem::{Controls, FemError, Solid, SolveOptions, State, StateError, Workspace};
use nastic_mesh::CellKind;
use nastic_tensor::Vec3;

/// A cantilever with two actuations, a roller that is pushed, and a load.
fn cantilever(kind: CellKind) -> Outcome<Solid> {
    Ok(Solid::new(regular(kind, [1.0, 0.3, 0.3], [4, 2, 2])?)?
        .material("body", MooneyRivlin::new(1.0, 0.2, 5.0)?)?
        .actuate("body", "tension", FiberTension::along(Vec3::new(0.8, 0.6, 0.0))?)?
        .actuate("body", "turgor", Turgor::new())?
        .clamp("x-")?
        .displace("x+", [None, Some(0.1), None])?
        .traction("x+", Vec3::new(0.02, 0.0, 0.0))?)
}

fn controls(solid: &Solid) -> Controls {
    let mut controls = solid.controls();
    let at = solid.discretization().points().positions(solid.mesh(), None);
    for (q, x) in at.iter().enumerate() {
        controls.values_mut(0)[q] = -1.0 + 2.0 * x[1];
        controls.values_mut(1)[q] = 0.5 * x[0];
    }
    controls
}

/// Right-hand sides without a pattern, supports included.
fn rhs(solid: &Solid, n: usize) -> Vec<f64> {
    (0..solid.discretization().dofs()).map(|dof| noise(dof + 7919 * n)).collect()
}

fn solved(solid: &Solid) -> Outcome<State> {
    Ok(solid.solve(&controls(solid), &STRICT)?)
}

/// `K lambda`, by sixth-order differences of the internal force.
fn differences(solid: &Solid, state: &State, lambda: &[f64]) -> Outcome<Vec<f64>> {
    let step = 1e-3 / largest(lambda);
    let mut sum = vec![0.0; lambda.len()];
    for (offset, weight) in [(1.0, 45.0), (2.0, -9.0), (3.0, 1.0)] {
        for sign in [1.0, -1.0] {
            let u: Vec<f64> = state.u.iter().zip(lambda).map(|(u, l)| u + sign * offset * step * l).collect();
            let force = solid.body().evaluate(&u, &state.controls, true, true)?.force;
            sum.iter_mut().zip(&force).for_each(|(s, f)| *s += sign * weight * f / (60.0 * step));
        }
    }
    Ok(sum)
}

#[test]
fn the_adjoint_solves_with_the_derivative_of_the_force() -> Outcome {
    for kind in kinds() {
        let solid = cantilever(kind)?;
        let state = solved(&solid)?;
        let (a, b) = (rhs(&solid, 1), rhs(&solid, 2));
        let adjoint = solid.adjoint(&state, &[&a, &b], &SolveOptions::default())?;
        assert_eq!(adjoint.lambda.len(), 2);
        for (lambda, rhs) in adjoint.lambda.iter().zip([a, b]) {
            let mut error: Vec<f64> =
                differences(&solid, &state, lambda)?.iter().zip(&rhs).map(|(f, b)| f - b).collect();
            solid.supports().clear(&mut error);
            // differences of the force resolve so much of a displacement of 1e-3
            assert!(largest(&error) < 1e-7, "{kind}: K lambda - rhs = {:e}", largest(&error));
            let mut free = lambda.clone();
            solid.supports().clear(&mut free);
            assert_eq!(&free, lambda, "{kind}: the adjoint moves a support");
        }
    }
    Ok(())
}

/// However far away the state its factor was made at: K is taken at the state asked about.
#[test]
fn a_foreign_factor_is_a_tool_and_no_more() -> Outcome {
    let solid = cantilever(CellKind::Hex8)?;
    let (state, rhs) = (solved(&solid)?, rhs(&solid, 3));
    let fresh = solid.adjoint(&state, &[&rhs], &SolveOptions::default())?.lambda.remove(0);
    let mut workspace = Workspace::default();
    solid.solve_with(&solid.controls(), &SolveOptions::default(), &mut workspace)?;
    assert!(workspace.factor_bytes() > 0);
    let other = solid.adjoint_with(&state, &[&rhs], &SolveOptions::default(), &mut workspace)?.lambda.remove(0);
    let error = distance(&fresh, &other) / largest(&fresh);
    assert!(error < 1e-9, "the answer depends on the factor handed in: {error:e}");
    Ok(())
}

/// `d/dm c . u(m)` by the adjoint against differences of solutions.
#[test]
fn the_reduced_derivative_is_that_of_the_solutions() -> Outcome {
    for kind in [CellKind::Quad9, CellKind::Tri6, CellKind::Hex8, CellKind::Tet10] {
        let solid = cantilever(kind)?;
        let state = solved(&solid)?;
        let mut cost = rhs(&solid, 4);
        solid.supports().clear(&mut cost);
        let minus: Vec<f64> = cost.iter().map(|c| -c).collect();
        let lambda = solid.adjoint(&state, &[&minus], &SolveOptions::default())?.lambda.remove(0);
        let derivative = solid.body().control_vjp(&state.u, &state.controls, &lambda, false)?;
        for k in 0..2 {
            let direction: Vec<f64> = (0..derivative.values(k).len()).map(noise).collect();
            let value = |t: f64| -> Outcome<f64> {
                let mut moved = state.controls.as_ref().clone();
                moved.values_mut(k).iter_mut().zip(&direction).for_each(|(m, d)| *m += t * d);
                let u = solid.solve(&moved, &SolveOptions { near: Some(&state), ..STRICT })?.u;
                Ok(u.iter().zip(&cost).map(|(u, c)| u * c).sum())
            };
            const H: f64 = 0.05;
            let difference = |s: f64| -> Outcome<f64> { Ok(value(s * H)? - value(-s * H)?) };
            let expected = (45.0 * difference(1.0)? - 9.0 * difference(2.0)? + difference(3.0)?) / (60.0 * H);
            let found: f64 = derivative.values(k).iter().zip(&direction).map(|(g, d)| g * d).sum();
            let scale: f64 = derivative.values(k).iter().zip(&direction).map(|(g, d)| (g * d).abs()).sum();
            let error = (found - expected).abs() / scale;
            assert!(error < 1e-8, "{kind}, actuation {k}: {found} where differences give {expected} ({error:e})");
        }
    }
    Ok(())
}

/// A column beyond Euler's load, straight still: K is indefinite there, and as good for an adjoint as any.
#[test]
fn an_unstable_state_has_its_adjoint() -> Outcome {
    let solid = Solid::new(regular(CellKind::Quad9, [1.0, 0.05, 0.0], [10, 1, 1])?)?
        .material("body", NeoHooke::new(0.5, 0.0)?)?
        .clamp("x-")?
        .traction("x+", Vec3::x() * -1e-3)?;
    let mut workspace = Workspace::default();
    let state = solid.solve_with(&solid.controls(), &STRICT, &mut workspace)?;
    assert_eq!(solid.negative_pivots(&state)?, 1);
    let rhs = rhs(&solid, 5);
    let adjoint = solid.adjoint_with(&state, &[&rhs], &SolveOptions::default(), &mut workspace)?;
    let mut error = differences(&solid, &state, &adjoint.lambda[0])?;
    error.iter_mut().zip(&rhs).for_each(|(f, b)| *f -= b);
    solid.supports().clear(&mut error);
    assert!(largest(&error) < 1e-6, "K lambda - rhs = {:e}", largest(&error));
    // nor does the indefinite factor harm who is handed it
    let stable = solid.clone().traction("x+", Vec3::x() * 1e-3)?;
    let state = stable.solve_with(&stable.controls(), &STRICT, &mut workspace)?;
    assert_eq!(stable.negative_pivots(&state)?, 0);
    assert!(largest(&state.u) < 1e-12);
    Ok(())
}

#[test]
fn a_right_hand_side_of_the_wrong_length_is_refused() -> Outcome {
    let solid = cantilever(CellKind::Quad4)?;
    let error =
        solid.adjoint(&solid.rest(), &[&[1.0; 29]], &SolveOptions::default()).err().ok_or("29 entries passed")?;
    assert!(matches!(error, StateError::Problem(FemError::Length { found: 29, expected: 30, .. })), "{error}");
    Ok(())
}
