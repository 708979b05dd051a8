//! Bodies of 27-node hexahedra by the products of their cells: whole solves, and the parts that multigrid is made of.

use crate::common;

use common::block::STRICT;
use common::{Outcome, distance, largest, noise, regular};
use nastic_energy::{FiberTension, MooneyRivlin, NeoHooke};
use nastic_fem::{
    Controls, Formulation, Foundation, Instant, SecondOrder, Solid, SolveOptions, Solver, State, Workspace,
};
use nastic_linear::{CellProducts, Geometry, Multigrid, Preconditioner, SparseMatrix};
use nastic_mesh::CellKind;
use nastic_numeric::vector::dot;
use nastic_tensor::Vec3;
use std::sync::Arc;

const MULTIGRID: SolveOptions = SolveOptions { solver: Some(Solver::MULTIGRID), ..STRICT };

fn cantilever(kind: CellKind) -> Outcome<Solid> {
    Ok(Solid::new(regular(kind, [1.0, 0.2, 0.2], [10, 2, 2])?)?
        .material("body", MooneyRivlin::new(1e5, 2e4, 1e6)?)?
        .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
        .clamp("x-")?)
}

/// Tension that grows across the section and bends the body.
fn bending(solid: &Solid) -> Controls {
    let mut controls = solid.controls();
    let at = solid.discretization().points().positions(solid.mesh(), None);
    controls.values_mut(0).iter_mut().zip(&at).for_each(|(m, x)| *m = -1.5e5 * x[2] / 0.2);
    controls
}

/// The matrix at a state, supports not eliminated.
fn matrix_at(solid: &Solid, state: &State) -> Outcome<SparseMatrix> {
    let mut matrix = solid.model().tangent_structure().matrix();
    solid.body().evaluate_tangent(&state.u, &state.controls, &mut matrix, true)?;
    Ok(matrix)
}

fn products_at(solid: &Solid, state: &State) -> Outcome<Arc<dyn CellProducts>> {
    Ok(solid.model().tangents().cell_products(&Instant::of(state))?.ok_or("27-node hexahedra have products")?)
}

#[test]
fn solves_and_derivatives_without_a_matrix_are_those_of_the_factor() -> Outcome {
    let solid = cantilever(CellKind::Hex27)?;
    let controls = bending(&solid);
    let direct = solid.solve(&controls, &STRICT)?;
    let (mut workspace, size) = (Workspace::default(), largest(&direct.u));
    let multigrid = solid.solve_with(&controls, &MULTIGRID, &mut workspace)?;
    let work = multigrid.report;
    assert_eq!((work.solver, work.factorisations), (Solver::MULTIGRID.name(), 0));
    assert_eq!(work.unassembled, work.newton, "{work:?}");
    assert!(distance(&direct.u, &multigrid.u) < 1e-9 * size, "{:e}", distance(&direct.u, &multigrid.u) / size);

    let rhs: Vec<f64> = direct.u.iter().map(|u| u / size).collect();
    let by_factor = solid.adjoint(&direct, &[&rhs], &STRICT)?.lambda.remove(0);
    let by_products = solid.adjoint_with(&direct, &[&rhs], &MULTIGRID, &mut workspace)?;
    assert_eq!((by_products.report.unassembled, by_products.report.factorisations), (1, 0));
    let error = distance(&by_factor, &by_products.lambda[0]) / largest(&by_factor);
    assert!(error < 1e-9, "{error:e}");
    assert_eq!(solid.negative_pivots_by(&direct, &MULTIGRID)?, 0);

    let mut along = solid.model().zero_controls();
    along.values_mut(0).iter_mut().enumerate().for_each(|(k, v)| *v = 1e4 * noise(k));
    let change = |how: &SolveOptions, workspace: &mut Workspace| {
        Ok::<_, Box<dyn std::error::Error>>(
            SecondOrder::new(solid.model(), &direct, how, workspace)?.state_change(&along)?,
        )
    };
    let expected = change(&STRICT, &mut Workspace::default())?;
    // the second time the tangent is kept
    for _ in 0..2 {
        let found = change(&MULTIGRID, &mut workspace)?;
        assert!(distance(&expected, &found) < 1e-9 * largest(&expected));
    }
    // what was kept of products is of no use to a factor
    assert!(distance(&expected, &change(&STRICT, &mut workspace)?) < 1e-9 * largest(&expected));
    Ok(())
}

#[test]
fn the_bits_are_those_of_one_thread() -> Outcome {
    let solid = cantilever(CellKind::Hex27)?;
    let controls = bending(&solid);
    let solve = |threads: usize, parallel: bool| -> Outcome<(Vec<f64>, Vec<f64>)> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
        let how = SolveOptions { parallel, ..MULTIGRID };
        pool.install(|| {
            let mut workspace = Workspace::default();
            let state = solid.solve_with(&controls, &how, &mut workspace).map_err(|error| error.to_string())?;
            let adjoint = solid.adjoint_with(&state, &[&state.u], &how, &mut workspace);
            Ok((state.u.to_vec(), adjoint.map_err(|error| error.to_string())?.lambda.remove(0)))
        })
        .map_err(|error: String| error.into())
    };
    let one = solve(1, false)?;
    assert!(one == solve(2, true)? && one == solve(1, true)?);
    Ok(())
}

/// Levels of products and of entries take turns in one workspace.
#[test]
fn a_workspace_serves_bodies_with_products_and_without() -> Outcome {
    let solid = cantilever(CellKind::Hex27)?;
    let (controls, founded) = (bending(&solid), solid.clone().foundation(Foundation::on("x+", 1e3))?);
    let mut workspace = Workspace::default();
    for (solid, unassembled) in [(&solid, true), (&founded, false), (&solid, true)] {
        let (found, expected) =
            (solid.solve_with(&controls, &MULTIGRID, &mut workspace)?, solid.solve(&controls, &STRICT)?);
        assert_eq!(found.report.unassembled > 0, unassembled);
        assert!(distance(&found.u, &expected.u) < 1e-9 * largest(&expected.u));
    }
    Ok(())
}

/// What no products are there for is assembled, and the report says so.
#[test]
fn what_has_no_products_is_assembled() -> Outcome {
    let hex27 = || cantilever(CellKind::Hex27);
    for (solid, why) in [
        (hex27()?.foundation(Foundation::on("x+", 1e3))?, "a foundation"),
        (hex27()?.formulation("body", Formulation::LinearDilatation)?, "another formulation"),
        (cantilever(CellKind::Hex20)?, "other cells"),
    ] {
        let work = solid.solve(&bending(&solid), &MULTIGRID)?.report;
        assert!(work.solver == Solver::MULTIGRID.name() && work.cycles > 0 && work.unassembled == 0, "{why}: {work:?}");
    }
    let solid = hex27()?;
    assert_eq!(solid.solve(&bending(&solid), &STRICT)?.report.unassembled, 0, "a factor is made of entries");
    Ok(())
}

/// Supports that move, and that hold edges and faces in part.
#[test]
fn supports_of_every_kind_take_part() -> Outcome {
    let mesh = regular(CellKind::Hex27, [1.0, 0.2, 0.2], [6, 2, 2])?;
    let on = |which: fn(&[f64; 3]) -> bool| -> Vec<u32> {
        let held = mesh.points().iter().enumerate().filter(|(_, x)| which(x));
        held.map(|(node, _)| node as u32).collect()
    };
    // up to the middle of a cell, and a node in the middle of an edge
    let (part, single) =
        (on(|x| x[2] == 0.0 && x[0] < 0.26), on(|x| x[0] == 1.0 && x[1] == 0.0 && (x[2] - 0.05).abs() < 1e-9));
    assert_eq!(single.len(), 1);
    let solid = Solid::new(mesh)?
        .material("body", NeoHooke::new(1.0, 0.3)?)?
        .displace_nodes("part", &part, |_, _| [Some(0.0); 3])?
        .displace_nodes("single", &single, |_, _| [None, Some(0.02), Some(0.1)])?;
    let controls = solid.controls();
    let (direct, multigrid) = (solid.solve(&controls, &STRICT)?, solid.solve(&controls, &MULTIGRID)?);
    assert!(multigrid.report.unassembled > 0 && multigrid.report.factorisations == 0, "{:?}", multigrid.report);
    assert!(distance(&direct.u, &multigrid.u) < 1e-9 * largest(&direct.u));
    Ok(())
}

/// An indefinite tangent needs a factor, and that a matrix.
#[test]
fn an_unstable_state_is_assembled() -> Outcome {
    let solid = Solid::new(regular(CellKind::Hex27, [1.0, 0.05, 0.1], [8, 1, 1])?)?
        .material("body", NeoHooke::new(0.5, 0.0)?)?
        .displace("x-", [Some(0.0), None, None])?
        .displace("y-", [None, None, Some(0.0)])?
        .clamp("x-")?
        .traction("x+", Vec3::x() * -1e-3)?;
    let state = solid.solve(&solid.controls(), &STRICT)?;
    let expected = solid.negative_pivots_by(&state, &STRICT)?;
    assert!(expected > 0, "{expected}");
    assert_eq!(solid.negative_pivots_by(&state, &MULTIGRID)?, expected);
    let rhs: Vec<f64> = (0..state.u.len()).map(noise).collect();
    let by_factor = solid.adjoint(&state, &[&rhs], &STRICT)?.lambda.remove(0);
    let by_multigrid = solid.adjoint(&state, &[&rhs], &MULTIGRID)?;
    assert_eq!((by_multigrid.report.solver, by_multigrid.report.unassembled), (Solver::DIRECT.name(), 0));
    assert!(distance(&by_factor, &by_multigrid.lambda[0]) < 1e-8 * largest(&by_factor));
    // the way from rest meets indefinite tangents
    let solved = solid.solve(&solid.controls(), &MULTIGRID)?;
    assert!(solved.report.residual <= 1e-10, "{:?}", solved.report);
    Ok(())
}

/// Products, blocks on the diagonal and the same of a shifted matrix, against the entries.
#[test]
fn products_are_those_of_the_entries() -> Outcome {
    let solid = cantilever(CellKind::Hex27)?;
    let state = solid.solve(&bending(&solid), &SolveOptions::default())?;
    let (whole, products) = (matrix_at(&solid, &state)?, products_at(&solid, &state)?);
    let fixed = solid.supports().fixed();
    let v: Vec<f64> = (0..state.u.len()).map(noise).collect();
    let (mut wanted, mut found) = (vec![0.0; v.len()], vec![0.0; v.len()]);
    whole.multiply(&v, &mut wanted);
    products.multiply_whole(&v, &mut found, true);
    assert!(distance(&found, &wanted) < 1e-7 * largest(&wanted), "{:e}", distance(&found, &wanted) / largest(&wanted));

    let mut matrix = whole.clone();
    matrix.eliminate(fixed, 1.0);
    let shift = 0.1 * largest(&matrix.diagonal());
    for (shift, products) in [(0.0, products.clone()), (shift, products.shifted(shift))] {
        let entry = |r: usize, c: usize| matrix.get(r, c) + if r == c && !fixed[r] { shift } else { 0.0 };
        let shifted = |v: &[f64], out: &mut [f64]| {
            matrix.multiply(v, out);
            (0..v.len()).filter(|&at| !fixed[at]).for_each(|at| out[at] += shift * v[at]);
        };
        shifted(&v, &mut wanted);
        products.multiply(&v, &mut found, true);
        assert!(distance(&found, &wanted) < 1e-7 * largest(&wanted));
        let blocks = products.diagonal_blocks(true);
        assert_eq!(blocks, products.diagonal_blocks(false));
        let scale = largest(&matrix.diagonal());
        for (node, block) in blocks.iter().enumerate() {
            for (r, c) in (0..9).map(|at| (at / 3, at % 3)) {
                let error = block[r][c] - entry(3 * node + r, 3 * node + c);
                assert!(error.abs() < 3e-6 * scale, "node {node}: {error:e} of {scale:e}");
            }
        }
    }
    Ok(())
}

/// `c . P^T A P c` by the matrices of corners, for first-order fields that vanish next to supports.
#[test]
fn matrices_of_corners_are_the_galerkin_product() -> Outcome {
    let solid = cantilever(CellKind::Hex27)?;
    let state = solid.solve(&bending(&solid), &SolveOptions::default())?;
    let corners = solid.discretization().corners().ok_or("second-order cells have corners")?;
    let fixed = corners.fixed(3, solid.supports().fixed());
    let own = products_at(&solid, &state)?;
    let at_corners: Vec<f64> = (0..fixed.len()).map(|at| if fixed[at] { 0.0 } else { noise(at) }).collect();
    let mut v = vec![0.0; state.u.len()];
    for i in 0..3 {
        let component: Vec<f64> = at_corners.iter().skip(i).step_by(3).copied().collect();
        v.iter_mut().skip(i).step_by(3).zip(corners.interpolated(&component)).for_each(|(v, x)| *v = x);
    }
    for products in [own.clone(), own.shifted(1e3)] {
        let mut image = vec![0.0; v.len()];
        products.multiply(&v, &mut image, false);
        let mut matrices = vec![[[[0.0; 3]; 3]; 36]; products.corners().len()];
        products.corner_matrices(0, &mut matrices);
        let mut sum = 0.0;
        for (nodes, matrix) in products.corners().iter().zip(&matrices) {
            let of = |a: usize| &v[3 * nodes[a] as usize..][..3];
            let pairs = (0..8).flat_map(|a| (0..=a).map(move |b| (a, b)));
            for ((a, b), block) in pairs.zip(matrix) {
                let factor = if a == b { 1.0 } else { 2.0 };
                sum += factor * (0..3).map(|r| of(a)[r] * dot(&block[r], of(b))).sum::<f64>();
            }
        }
        let wanted = dot(&v, &image);
        assert!((sum / wanted - 1.0).abs() < 1e-12, "{sum} {wanted}");
        // from anywhere
        let mut some = vec![[[[0.0; 3]; 3]; 36]; 5];
        products.corner_matrices(14, &mut some);
        assert!(some == matrices[14..19]);
    }
    Ok(())
}

#[test]
fn the_memory_of_levels_on_products_is_predicted() -> Outcome {
    let solid = Solid::new(regular(CellKind::Hex27, [1.0, 0.3, 0.3], [30, 9, 9])?)?
        .material("body", NeoHooke::new(1.0, 0.3)?)?
        .clamp("x-")?;
    let (points, fixed, corners) = (solid.mesh().points(), solid.supports().fixed(), solid.discretization().corners());
    let products = products_at(&solid, &solid.rest())?;
    let geometry = Geometry { points, fixed, corners, products: Some(&products) };
    let empty = SparseMatrix::without_values(solid.model().tangent_structure().pattern().clone());
    let levels = Multigrid::new(&empty, &geometry, true)?;
    assert!(levels.sizes().len() > 2, "the corners are not factorised: {:?}", levels.sizes());
    let mut x: Vec<f64> = (0..fixed.len()).map(noise).collect();
    levels.apply(&mut x);
    assert!(x.iter().all(|x| x.is_finite()));
    let (predicted, found) = (solid.model().tangents().multigrid_bytes(), levels.bytes());
    assert!((predicted as f64 / found as f64 - 1.0).abs() < 0.33, "{predicted} bytes predicted, {found} found");
    assert!(predicted < solid.model().tangent_structure().multigrid_bytes() / 4);
    Ok(())
}
