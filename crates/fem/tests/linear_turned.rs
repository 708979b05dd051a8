//! A factor at rest serves in the bent body when it is turned along.

use nastic_energy::{FiberTension, MooneyRivlin};
use nastic_fem::{Controls, Solid, SolveOptions, Workspace};
use nastic_linear::{CorotatedPreconditioner, Pivots, Rotations, SparseMatrix, conjugate_gradient};
use nastic_mesh::{CellKind, box_mesh};
use nastic_tensor::{Mat3, Vec3};
use std::sync::Arc;

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

fn cantilever() -> Outcome<(Solid, Controls)> {
    let solid = Solid::new(box_mesh([1.0, 0.2, 0.2], [10, 2, 2], CellKind::Hex8)?)?
        .material("body", MooneyRivlin::new(1e5, 2e4, 1e6)?)?
        .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
        .clamp("x-")?;
    let mut controls = solid.controls();
    let at = solid.discretization().points().positions(solid.mesh(), None);
    controls.set(0, 0, &at.iter().map(|x| -1.5e5 * x[2] / 0.2).collect::<Vec<_>>())?;
    Ok((solid, controls))
}

fn tangent(solid: &Solid, u: &[f64], controls: &Controls) -> Outcome<SparseMatrix> {
    let mut matrix = solid.model().tangent_structure().matrix();
    solid.body().evaluate_tangent(u, controls, &mut matrix, false)?;
    let largest = matrix.diagonal().into_iter().fold(0.0, f64::max);
    matrix.eliminate(solid.supports().fixed(), largest);
    Ok(matrix)
}

/// A body turned as a whole by 2 rad has the turned tangent: one application of the turned factor solves with it, though no
/// node is supported.
#[test]
fn a_rigid_turn_needs_one_iteration() -> Outcome {
    let (solid, _) = cantilever()?;
    let (rest, mesh) = (vec![0.0; solid.discretization().dofs()], solid.mesh());
    let (s, c) = 2.0f64.sin_cos();
    let turn = Mat3::new(c, 0.0, s, 0.0, 1.0, 0.0, -s, 0.0, c);
    let moved = |x: &[f64; 3]| (turn - Mat3::identity()) * Vec3::from(*x);
    let u: Vec<f64> = mesh.points().iter().flat_map(|x| <[f64; 3]>::from(moved(x))).collect();
    let ground = |matrix: &mut SparseMatrix| {
        for dof in 0..matrix.pattern().dofs() {
            let at = matrix.pattern().value_index(dof, dof).unwrap_or(0);
            matrix.values[at] += 10.0;
        }
    };
    let mut at_rest = solid.model().tangent_structure().matrix();
    solid.body().evaluate_tangent(&rest, &solid.controls(), &mut at_rest, false)?;
    let mut turned = solid.model().tangent_structure().matrix();
    solid.body().evaluate_tangent(&u, &solid.controls(), &mut turned, false)?;
    ground(&mut at_rest);
    ground(&mut turned);

    let nodes = mesh.points().len();
    let mut factor = solid.model().tangent_structure().symbolic().factorize(&at_rest, Pivots::Positive, false)?;
    factor.set_rotations(Arc::new(Rotations(vec![Mat3::identity(); nodes])));
    let free = vec![false; rest.len()];
    let preconditioner = CorotatedPreconditioner::new(&factor, &Rotations(vec![turn; nodes]), &free);
    let b: Vec<f64> = (0..rest.len()).map(|i| (i as f64).sin()).collect();
    let apply = |v: &[f64], out: &mut [f64]| turned.multiply(v, out);
    let mut x = vec![0.0; b.len()];
    let found = conjugate_gradient(&apply, &preconditioner, &b, &mut x, 1e-9, 3);
    assert!(found.converged() && found.iterations == 1, "{found:?}");
    let mut x = vec![0.0; b.len()];
    assert!(!conjugate_gradient(&apply, &factor, &b, &mut x, 1e-9, 3).converged());
    Ok(())
}

/// With a factor from rest the adjoint at the bent state is found as exactly as with its own.
#[test]
fn a_factor_from_rest_serves_the_adjoint_of_the_bent_state() -> Outcome {
    let (solid, controls) = cantilever()?;
    let state = solid.solve(&controls, &SolveOptions::default())?;
    let at_rest = tangent(&solid, &vec![0.0; state.u.len()], &solid.controls())?;
    let mut factor = solid.model().tangent_structure().symbolic().factorize(&at_rest, Pivots::Positive, false)?;
    factor.set_rotations(Arc::new(Rotations(vec![Mat3::identity(); solid.mesh().points().len()])));
    let wish: Vec<f64> = (0..state.u.len()).map(|i| (0.3 * i as f64).cos()).collect();
    let mut from_rest = Workspace::with_factor(factor);
    let kept = solid.adjoint_with(&state, &[&wish], &SolveOptions::default(), &mut from_rest)?;
    let own = solid.adjoint(&state, &[&wish], &SolveOptions::default())?;
    let largest = own.lambda[0].iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    let difference = kept.lambda[0].iter().zip(&own.lambda[0]).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
    assert!(difference <= 1e-8 * largest, "{difference:e} of {largest:e}");
    Ok(())
}
