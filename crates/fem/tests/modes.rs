//! Smallest eigenvalues and modes of the tangent: against a dense solver, vibrating beams, buckled columns.

use crate::common;

use common::block::STRICT;
use common::{Outcome, kinds, largest, regular, unit};
use nalgebra::{DMatrix, SymmetricEigen};
use nastic_energy::NeoHooke;
use nastic_fem::{Formulation, Instant, Modes, Solid, SolveOptions, Solver, State, StateError};
use nastic_linear::{LinearError, SparseMatrix};
use nastic_mesh::CellKind;
use nastic_numeric::vector::{dot, norm};
use nastic_tensor::Vec3;
use std::f64::consts::PI;
use std::sync::atomic::AtomicBool;

/// A unit cantilever of height h with E = 1 and nu = 0, compressed by a multiple of Euler's load.
fn column(kind: CellKind, h: f64, cells: [usize; 3], multiple: f64) -> Outcome<(Solid, State)> {
    let critical = PI.powi(2) * h * h / 48.0;
    let solid = Solid::new(regular(kind, [1.0, h, h], cells)?)?
        .material("body", NeoHooke::new(0.5, 0.0)?)?
        .clamp("x-")?
        .traction("x+", Vec3::x() * -multiple * critical)?;
    let state = solid.solve(&solid.controls(), &STRICT)?;
    Ok((solid, state))
}

fn tangent(solid: &Solid, state: &State) -> Outcome<SparseMatrix> {
    let mut matrix = solid.model().tangents().matrix();
    solid.model().tangents().add_tangent(&Instant::new(&state.u, &state.controls, state.load), &mut matrix)?;
    Ok(matrix)
}

/// Volume of each unknown's node.
fn masses(solid: &Solid) -> Vec<f64> {
    let disc = solid.discretization();
    disc.nodal_volumes().into_iter().flat_map(|v| vec![v; disc.dim()]).collect()
}

/// Largest `|K phi - lambda M phi| / (|K| |phi|)`, free unknowns alone.
fn residual(solid: &Solid, state: &State, modes: &Modes) -> Outcome<f64> {
    let (mut matrix, mass) = (tangent(solid, state)?, masses(solid));
    matrix.eliminate(solid.supports().fixed(), 1.0);
    let scale = matrix.norm();
    let mut worst: f64 = 0.0;
    for (lambda, shape) in modes.eigenvalues.iter().zip(&modes.shapes) {
        let mut r = vec![0.0; shape.len()];
        matrix.multiply(shape, &mut r);
        r.iter_mut().zip(shape).zip(&mass).for_each(|((r, x), m)| *r -= lambda * m * x);
        worst = worst.max(norm(&r) / (scale * norm(shape)));
    }
    Ok(worst)
}

#[test]
fn volumes_of_nodes_are_positive_and_add_up_to_the_body() -> Outcome {
    for kind in kinds() {
        let solid = Solid::new(unit(kind, 2)?)?;
        let volumes = solid.discretization().nodal_volumes();
        assert!(volumes.iter().all(|&v| v > 0.0), "{kind}");
        assert!((volumes.iter().sum::<f64>() - 1.0).abs() < 1e-12, "{kind}");
    }
    Ok(())
}

#[test]
fn eigenvalues_agree_with_a_dense_solver() -> Outcome {
    for (kind, multiple) in [(CellKind::Quad8, 0.5), (CellKind::Quad9, 12.0), (CellKind::Tet10, 3.0)] {
        let (solid, state) = column(kind, 0.2, [4, 1, 1], multiple)?;
        let modes = solid.modes(&state, 5, &STRICT)?;
        let (matrix, mass) = (tangent(&solid, &state)?, masses(&solid));
        let free: Vec<usize> = (0..mass.len()).filter(|&i| !solid.supports().fixed()[i]).collect();
        let entry = |i: usize, k: usize| matrix.get(free[i], free[k]) / (mass[free[i]] * mass[free[k]]).sqrt();
        let dense = SymmetricEigen::new(DMatrix::from_fn(free.len(), free.len(), entry));
        let mut expected: Vec<f64> = dense.eigenvalues.iter().copied().collect();
        expected.sort_by(f64::total_cmp);
        let size = expected[expected.len() - 1];
        for (lambda, expected) in modes.eigenvalues.iter().zip(&expected) {
            assert!((lambda - expected).abs() < 1e-12 * size, "{kind}: {lambda:e} instead of {expected:e}");
        }
        assert_eq!(modes.negative, expected.iter().filter(|&&lambda| lambda < 0.0).count());
        assert_eq!(modes.eigenvalues.len(), modes.negative.max(5));
        for shape in &modes.shapes {
            assert_eq!(largest(shape), 1.0);
            let first = shape.iter().find(|x| x.abs() > 1.0 - 1e-6);
            assert!(first.is_some_and(|x| *x > 0.0), "{kind}: {first:?}");
            assert!(shape.iter().zip(solid.supports().fixed()).all(|(x, fixed)| !fixed || *x == 0.0));
        }
    }
    Ok(())
}

/// Residuals and M-orthogonality where no dense solver is affordable; the bending modes of a square column come in
/// pairs.
#[test]
fn a_larger_body_has_small_residuals() -> Outcome {
    let (solid, state) = column(CellKind::Hex20, 0.1, [16, 2, 2], 2.0)?;
    let modes = solid.modes(&state, 6, &STRICT)?;
    assert_eq!((modes.negative, modes.eigenvalues.len()), (2, 6));
    assert!((modes.eigenvalues[1] / modes.eigenvalues[0] - 1.0).abs() < 1e-6, "{:?}", modes.eigenvalues);
    assert!(modes.eigenvalues[1] < 0.0 && modes.eigenvalues[2] > 0.0);
    let found = residual(&solid, &state, &modes)?;
    assert!(found < 1e-12, "{found:e}");
    let mass = masses(&solid);
    for (i, a) in modes.shapes.iter().enumerate() {
        let weighted: Vec<f64> = a.iter().zip(&mass).map(|(x, m)| x * m).collect();
        for b in &modes.shapes[..i] {
            assert!(dot(&weighted, b).abs() < 1e-9 * dot(&weighted, a), "mode {i}");
        }
    }
    Ok(())
}

/// Euler-Bernoulli: `lambda = (1.8751 / L)^4 E I / A` of a cantilever at rest, whatever the mesh.
#[test]
fn the_softest_mode_of_a_cantilever_is_its_first_bending_mode() -> Outcome {
    let h: f64 = 0.02;
    let expected = 1.875_104_f64.powi(4) * h * h / 12.0;
    for (kind, cells) in [(CellKind::Quad8, 10), (CellKind::Quad9, 20), (CellKind::Tri6, 20)] {
        let (solid, state) = column(kind, h, [cells, 1, 1], 0.0)?;
        let modes = solid.modes(&state, 2, &STRICT)?;
        let lambda = modes.eigenvalues[0];
        assert!((lambda / expected - 1.0).abs() < 3e-3, "{kind}: {lambda:e} instead of {expected:e}");
        let second = modes.eigenvalues[1] / lambda;
        assert!((second / (4.694_091_f64 / 1.875_104).powi(4) - 1.0).abs() < 0.02, "{kind}: {second}");
    }
    Ok(())
}

#[test]
fn a_strip_pressed_beyond_its_load_falls_sideways() -> Outcome {
    let (solid, state) = column(CellKind::Quad9, 0.05, [10, 1, 1], 1.1)?;
    let modes = solid.modes(&state, 1, &STRICT)?;
    assert_eq!((modes.negative, modes.eigenvalues.len()), (1, 1));
    assert!(modes.eigenvalues[0] < 0.0);
    let sideways: f64 = modes.shapes[0].iter().skip(1).step_by(2).map(|y| y * y).sum();
    assert!(sideways > 0.95 * dot(&modes.shapes[0], &modes.shapes[0]));
    let (solid, state) = column(CellKind::Quad9, 0.05, [10, 1, 1], 0.9)?;
    assert!(solid.modes(&state, 1, &STRICT)?.eigenvalues[0] > 0.0);
    Ok(())
}

#[test]
fn what_cannot_be_asked_is_a_typed_error() -> Outcome {
    let (solid, state) = column(CellKind::Quad8, 0.2, [2, 1, 1], 0.0)?;
    let refused = solid.modes(&state, 0, &SolveOptions::default());
    assert!(matches!(refused, Err(StateError::Linear(LinearError::EigenpairCount { count: 0, .. }))), "{refused:?}");
    let (other, _) = column(CellKind::Quad8, 0.2, [3, 1, 1], 0.0)?;
    assert!(matches!(other.modes(&state, 1, &SolveOptions::default()), Err(StateError::Problem(_))));
    Ok(())
}

/// The same modes without a factor; eigenvalues that are zero but for rounding may have either sign.
fn agree_by_products((solid, state): &(Solid, State), count: usize, name: &str) -> Outcome<Modes> {
    let expected = solid.modes(state, count, &STRICT)?;
    let by_products = SolveOptions { solver: Some(Solver::MULTIGRID), ..STRICT };
    let found = solid.modes(state, count, &by_products)?;
    assert!(expected.counted && !found.counted, "{name}");
    let size = expected.eigenvalues.iter().fold(0.0, |most: f64, lambda| most.max(lambda.abs()));
    let negative = expected.eigenvalues.iter().filter(|lambda| **lambda < -1e-9 * size).count();
    assert_eq!((found.negative, found.eigenvalues.len()), (negative, negative.max(count)), "{name}");
    for (lambda, expected) in found.eigenvalues.iter().zip(&expected.eigenvalues) {
        assert!((lambda - expected).abs() < 1e-10 * size, "{name}: {lambda:e} instead of {expected:e}");
    }
    let residual = residual(solid, state, &found)?;
    assert!(residual < 1e-9, "{name}: {residual:e}");
    let one = SolveOptions { parallel: false, ..by_products };
    assert!(solid.modes(state, count, &one)? == found, "{name}: other bits on one thread");
    Ok(found)
}

#[test]
fn modes_without_a_factor_are_the_same() -> Outcome {
    for kind in [CellKind::Hex8, CellKind::Hex27, CellKind::Tet10] {
        let held = column(kind, 0.2, [8, 2, 2], 0.0)?;
        agree_by_products(&held, 6, &format!("{kind} at rest"))?;
    }
    agree_by_products(&column(CellKind::Quad9, 0.1, [12, 2, 1], 0.5)?, 4, "a strip under load")?;
    Ok(())
}

#[test]
fn all_unstable_modes_are_found_without_a_factor() -> Outcome {
    let pressed = column(CellKind::Hex20, 0.1, [16, 2, 2], 12.0)?;
    let modes = agree_by_products(&pressed, 1, "a column beyond several of its loads")?;
    assert!(modes.negative >= 4, "{:?}", modes.eigenvalues);
    Ok(())
}

#[test]
fn rigid_motions_are_found_without_a_factor() -> Outcome {
    for kind in [CellKind::Hex8, CellKind::Hex27] {
        let mesh = regular(kind, [1.0, 0.3, 0.2], [5, 2, 2])?;
        let free = Solid::new(mesh)?.material("body", NeoHooke::new(0.5, 0.3)?)?;
        let body = (free.clone(), free.rest());
        let found = agree_by_products(&body, 8, &format!("a free body of {kind}"))?;
        assert!(found.eigenvalues[5].abs() < 1e-9 * found.eigenvalues[6], "{:?}", found.eigenvalues);
        let by_products = SolveOptions { solver: Some(Solver::MULTIGRID), ..STRICT };
        let few = body.0.modes(&body.1, 3, &by_products)?;
        assert!(!few.counted && few.eigenvalues.len() >= 3, "fewer modes than rigid motions, {kind}: {few:?}");
        assert!(
            few.eigenvalues.iter().all(|lambda| lambda.abs() < 1e-9 * found.eigenvalues[6]),
            "{:?}",
            few.eigenvalues
        );
    }
    Ok(())
}

#[test]
fn modes_of_a_nearly_incompressible_body_need_no_factor() -> Outcome {
    for kind in [CellKind::Hex8, CellKind::Hex27, CellKind::Tet4] {
        let formulation = Formulation::nearly_incompressible(kind).unwrap_or_default();
        let solid = Solid::new(regular(kind, [1.0, 0.2, 0.2], [6, 2, 2])?)?
            .material("body", NeoHooke::from_young_poisson(1.0, 0.4999)?)?
            .formulation("body", formulation)?
            .clamp("x-")?;
        let rest = solid.rest();
        agree_by_products(&(solid, rest), 5, &format!("{kind}"))?;
    }
    Ok(())
}

#[test]
fn modes_without_a_factor_end_on_demand() -> Outcome {
    let (solid, state) = column(CellKind::Hex8, 0.2, [8, 2, 2], 0.0)?;
    let cancel = AtomicBool::new(true);
    let how = SolveOptions { solver: Some(Solver::MULTIGRID), cancel: Some(&cancel), ..STRICT };
    assert!(matches!(solid.modes(&state, 3, &how), Err(StateError::Cancelled)));
    Ok(())
}

/// Multigrid serves no body whose cells resist changes of volume at every point; a factor does, and says so.
#[test]
fn modes_that_multigrid_does_not_find_take_a_factor() -> Outcome {
    let kind = CellKind::Hex20;
    let solid = Solid::new(regular(kind, [1.0, 0.2, 0.2], [5, 1, 1])?)?
        .material("body", NeoHooke::from_young_poisson(1.0, 0.499_99)?)?
        .clamp("x-")?;
    let rest = solid.rest();
    let by_products = SolveOptions { solver: Some(Solver::MULTIGRID), ..STRICT };
    let (found, expected) = (solid.modes(&rest, 4, &by_products)?, solid.modes(&rest, 4, &STRICT)?);
    assert!(found.counted && found == expected);
    Ok(())
}
