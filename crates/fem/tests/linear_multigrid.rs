//! Multigrid: as a preconditioner of tangents, and in whole solves beside the factor.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::block::STRICT;
use common::{Outcome, bending, distance, largest, noise, regular};
use nastic_energy::{FiberTension, MooneyRivlin, NeoHooke};
use nastic_fem::{Formulation, Foundation, Inertia, Instant, Solid, SolveOptions, Solver, State};
use nastic_linear::{
    CgEnd, CgReport, FactorError, Geometry, Multigrid, Pivots, Preconditioner, SparseMatrix, conjugate_gradient,
};
use nastic_mesh::CellKind;
use nastic_tensor::Vec3;

const MULTIGRID: SolveOptions = SolveOptions { solver: Some(Solver::MULTIGRID), ..STRICT };

/// The fibre cantilever: `length x 0.2 x 0.2`, clamped at x = 0.
fn cantilever(kind: CellKind, length: f64, cells: [usize; 3], mu3: f64) -> Outcome<Solid> {
    Ok(Solid::new(regular(kind, [length, 0.2, 0.2], cells)?)?
        .material("body", MooneyRivlin::new(1e5, 2e4, mu3)?)?
        .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
        .clamp("x-")?)
}

/// A tangent with its supports eliminated, and where it was taken.
struct System {
    solid: Solid,
    matrix: SparseMatrix,
    points: Vec<[f64; 3]>,
}

impl System {
    fn new(solid: Solid, state: &State) -> Outcome<Self> {
        let mut matrix = solid.model().tangent_structure().matrix();
        solid.body().evaluate_tangent(&state.u, &state.controls, &mut matrix, true)?;
        let diagonal = largest(&matrix.diagonal());
        matrix.eliminate(solid.supports().fixed(), diagonal);
        let dim = solid.mesh().dim();
        let moved = |(x, u): (&[f64; 3], &[f64])| [0, 1, 2].map(|k| x[k] + u.get(k).unwrap_or(&0.0));
        let points = solid.mesh().points().iter().zip(state.u.chunks(dim)).map(moved).collect();
        Ok(System { solid, matrix, points })
    }

    fn at_rest(solid: Solid) -> Outcome<Self> {
        let rest = solid.rest();
        Self::new(solid, &rest)
    }

    fn bent(solid: Solid) -> Outcome<Self> {
        let state = solid.solve(&bending(-1.5e5, &solid), &SolveOptions::default())?;
        Self::new(solid, &state)
    }

    fn multigrid(&self, parallel: bool) -> Result<Multigrid, FactorError> {
        let corners = self.solid.discretization().corners();
        let fixed = self.solid.supports().fixed();
        Multigrid::new(&self.matrix, &Geometry { points: &self.points, fixed, corners, products: None }, parallel)
    }

    fn vector(&self, seed: usize) -> Vec<f64> {
        let mut vector: Vec<f64> = (0..self.matrix.pattern().dofs()).map(|dof| noise(dof + 7919 * seed)).collect();
        self.solid.supports().clear(&mut vector);
        vector
    }

    fn solve(&self, b: &[f64], tolerance: f64) -> Outcome<(Vec<f64>, CgReport)> {
        let mut x = vec![0.0; b.len()];
        let multiply = |v: &[f64], out: &mut [f64]| self.matrix.multiply(v, out);
        let report = conjugate_gradient(&multiply, &self.multigrid(true)?, b, &mut x, tolerance, 600);
        Ok((x, report))
    }

    /// Cycles to a residual of 1e-8.
    fn cycles(&self) -> Outcome<usize> {
        let (_, report) = self.solve(&self.vector(1), 1e-8)?;
        assert!(report.converged(), "{report:?}");
        Ok(report.iterations)
    }
}

/// Meshes of one body, each twice as fine as the one before or nearly so.
fn meshes(kind: CellKind) -> &'static [[usize; 3]] {
    match kind.order() {
        1 => &[[10, 2, 2], [20, 4, 4], [30, 6, 6]],
        _ => &[[5, 1, 1], [10, 2, 2]],
    }
}

#[test]
fn cycles_hardly_grow_with_the_mesh() -> Outcome {
    for kind in [CellKind::Hex8, CellKind::Hex20, CellKind::Hex27, CellKind::Tet10, CellKind::Tet4] {
        for bent in [false, true] {
            let mut cycles = Vec::new();
            for &cells in meshes(kind) {
                let solid = cantilever(kind, 1.0, cells, 1e6)?;
                let system = if bent { System::bent(solid)? } else { System::at_rest(solid)? };
                cycles.push(system.cycles()?);
            }
            println!("{kind}, bent {bent}: {cycles:?}");
            let (first, last) = (cycles[0], cycles[cycles.len() - 1]);
            assert!(last <= 26 && last <= first + 10, "{kind}, bent: {bent}: {cycles:?}");
        }
    }
    Ok(())
}

#[test]
fn slender_and_nearly_incompressible_bodies_cost_more_cycles() -> Outcome {
    // aspect 50 with cubes for cells, and with cells five times as long as wide
    for (cells, most) in [([100, 2, 2], 25), ([50, 5, 5], 60)] {
        let cycles = System::at_rest(cantilever(CellKind::Hex8, 10.0, cells, 1e6)?)?.cycles()?;
        println!("slender {cells:?}: {cycles}");
        assert!(cycles <= most, "{cells:?}: {cycles}");
    }
    // Poisson's ratio 0.494 and 0.4994
    for (mu3, most) in [(1e7, 60), (1e8, 190)] {
        for kind in [CellKind::Hex8, CellKind::Hex27] {
            let cycles = System::at_rest(cantilever(kind, 1.0, meshes(kind)[1], mu3)?)?.cycles()?;
            println!("mu3 {mu3:e} {kind}: {cycles}");
            assert!(cycles <= most, "{kind}, mu3 = {mu3:e}: {cycles}");
        }
    }
    Ok(())
}

#[test]
fn the_solution_is_that_of_the_factor() -> Outcome {
    for kind in [CellKind::Hex8, CellKind::Hex20, CellKind::Tet10, CellKind::Quad9] {
        let system = System::bent(cantilever(kind, 1.0, meshes(kind)[1], 1e6)?)?;
        let b = system.vector(2);
        let (x, report) = system.solve(&b, 1e-13)?;
        assert!(report.converged() || report.end == CgEnd::Stagnated, "{kind}: {report:?}");
        let mut exact = b;
        system
            .solid
            .model()
            .tangent_structure()
            .symbolic()
            .factorize(&system.matrix, Pivots::Positive, false)?
            .solve(&mut exact, 1);
        assert!(distance(&x, &exact) <= 1e-10 * largest(&exact), "{kind}: {:e}", distance(&x, &exact));
    }
    Ok(())
}

#[test]
fn the_preconditioner_is_symmetric_and_positive() -> Outcome {
    for kind in [CellKind::Hex8, CellKind::Hex27, CellKind::Tri6] {
        let system = System::bent(cantilever(kind, 1.0, meshes(kind)[1], 1e6)?)?;
        let multigrid = system.multigrid(false)?;
        assert!(multigrid.sizes().len() > 1, "{kind}: {:?}", multigrid.sizes());
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        for seed in 0..4 {
            let (x, y) = (system.vector(seed), system.vector(seed + 10));
            let (mut bx, mut by) = (x.clone(), y.clone());
            multigrid.apply(&mut bx);
            multigrid.apply(&mut by);
            let size = (dot(&x, &bx) * dot(&y, &by)).sqrt();
            assert!(dot(&x, &bx) > 0.0 && dot(&y, &by) > 0.0, "{kind}");
            assert!((dot(&y, &bx) - dot(&x, &by)).abs() < 1e-10 * size, "{kind}: {:e}", dot(&y, &bx) - dot(&x, &by));
        }
    }
    Ok(())
}

#[test]
fn one_thread_and_two_give_the_same_bits() -> Outcome {
    let system = System::bent(cantilever(CellKind::Hex8, 1.0, [30, 6, 6], 1e6)?)?;
    let apply = |multigrid: Multigrid| {
        let mut x = system.vector(3);
        multigrid.apply(&mut x);
        x
    };
    let alone = apply(system.multigrid(false)?);
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
        let together = pool.install(|| system.multigrid(true).map(apply))?;
        assert!(alone == together, "{threads} threads");
    }
    Ok(())
}

/// More nodes than the Galerkin product takes up at a time.
#[test]
fn a_product_in_slabs_is_the_same_on_all_threads() -> Outcome {
    let system = System::at_rest(cantilever(CellKind::Hex8, 1.0, [60, 12, 12], 1e6)?)?;
    let apply = |parallel: bool| {
        let mut x = system.vector(5);
        system.multigrid(parallel)?.apply(&mut x);
        Ok::<_, FactorError>(x)
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build()?;
    assert!(apply(false)? == pool.install(|| apply(true))?);
    let cycles = system.cycles()?;
    assert!(cycles <= 20, "{cycles} cycles");
    let levels = system.multigrid(true)?;
    let (predicted, found) = (Multigrid::predicted_bytes(system.matrix.pattern()), levels.bytes());
    assert!((predicted as f64 / found as f64 - 1.0).abs() < 0.33, "{predicted} bytes predicted, {found} found");
    Ok(())
}

/// Of another matrix of the same structure values alone are computed, in place, until its strong couplings are others.
#[test]
fn the_structure_of_levels_is_kept() -> Outcome {
    for kind in [CellKind::Hex8, CellKind::Hex27] {
        let solid = cantilever(kind, 1.0, meshes(kind)[1], 1e6)?;
        let (rest, bent) = (System::at_rest(solid.clone())?, System::bent(solid)?);
        let mut levels = rest.multigrid(true)?;
        let layouts = levels.layouts();
        let applied = |levels: &Multigrid| {
            let mut x = rest.vector(6);
            levels.apply(&mut x);
            x
        };
        let new = applied(&levels);
        let renew = |levels: &mut Multigrid, system: &System| {
            let (fixed, corners) = (system.solid.supports().fixed(), system.solid.discretization().corners());
            levels.renew(&system.matrix, &Geometry { points: &system.points, fixed, corners, products: None }, true)
        };
        // there and back: the bits of levels that were made for it alone
        renew(&mut levels, &bent)?;
        assert!(applied(&levels) != new, "{kind}");
        let multiply = |v: &[f64], out: &mut [f64]| bent.matrix.multiply(v, out);
        let b = bent.vector(1);
        let report = conjugate_gradient(&multiply, &levels, &b, &mut vec![0.0; b.len()], 1e-8, 600);
        assert!(report.converged() && report.iterations <= bent.cycles()? + 2, "{kind}: {report:?}");
        renew(&mut levels, &rest)?;
        assert!(applied(&levels) == new, "{kind}");
        assert_eq!(levels.layouts(), layouts, "{kind}");
        // layers that hardly know of each other: a convex sum of the matrix and of one without their couplings
        let mut layered = System { matrix: rest.matrix.clone(), ..System::at_rest(rest.solid.clone())? };
        let pattern = layered.matrix.pattern().clone();
        for [i, j] in pattern.pairs().into_iter().map(|pair| pair.map(|node| node as usize)) {
            if layered.points[i][2] != layered.points[j][2] {
                for (r, c) in (0..9).map(|at| (at / 3, at % 3)) {
                    let at = pattern.value_index(3 * i + r, 3 * j + c).unwrap_or_default();
                    layered.matrix.values[at] *= 1e-4;
                }
            }
        }
        renew(&mut levels, &layered)?;
        // the corners of so few cells of second order are the last level: there are no aggregates
        assert!(levels.layouts() > layouts || levels.sizes().len() == 2 && kind == CellKind::Hex27, "{kind}");
    }
    Ok(())
}

#[test]
fn indefinite_matrices_are_told_of() -> Outcome {
    let mut system = System::at_rest(cantilever(CellKind::Hex8, 1.0, [20, 4, 4], 1e6)?)?;
    let definite = system.matrix.clone();
    let node = system.solid.mesh().points().len() - 1;
    let at = system.matrix.pattern().value_index(3 * node, 3 * node).unwrap_or_default();
    system.matrix.values[at] = -1.0;
    assert!(matches!(system.multigrid(true), Err(FactorError::NotPositive { node: n, .. }) if n == node));
    system.matrix.values[at] = f64::NAN;
    assert!(matches!(system.multigrid(true), Err(FactorError::NotFinite { .. })));
    // a slightly negative bending mode: found on the last level
    let rayleigh = {
        let (x, _) = system_solution(&definite, &system)?;
        let mut kx = vec![0.0; x.len()];
        definite.multiply(&x, &mut kx);
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        dot(&x, &kx) / dot(&x, &x)
    };
    system.matrix = definite;
    system.matrix.add_to_diagonal(-2.0 * rayleigh);
    match system.multigrid(true) {
        Err(FactorError::NotPositive { .. }) => {}
        Err(other) => panic!("{other}"),
        Ok(_) => {
            let (_, report) = system.solve(&system.vector(4), 1e-10)?;
            assert!(matches!(report.end, CgEnd::NegativeCurvature { .. }), "{report:?}");
        }
    }
    let geometry =
        Geometry { points: &system.points[1..], fixed: system.solid.supports().fixed(), corners: None, products: None };
    assert!(matches!(Multigrid::new(&system.matrix, &geometry, true), Err(FactorError::Structure(_))));
    Ok(())
}

/// The displacement under a load across the body: nearly the softest mode.
fn system_solution(matrix: &SparseMatrix, system: &System) -> Outcome<(Vec<f64>, CgReport)> {
    let other = System { solid: system.solid.clone(), matrix: matrix.clone(), points: system.points.clone() };
    let mut b: Vec<f64> = (0..matrix.pattern().dofs()).map(|dof| f64::from(u8::from(dof % 3 == 2))).collect();
    system.solid.supports().clear(&mut b);
    other.solve(&b, 1e-8)
}

#[test]
fn whole_solves_and_adjoints_agree_with_those_of_the_factor() -> Outcome {
    for kind in [CellKind::Hex8, CellKind::Hex27, CellKind::Tet10, CellKind::Quad8] {
        let solid = cantilever(kind, 1.0, meshes(kind)[1], 1e6)?;
        assert_eq!(solid.model().tangent_structure().solver(), Solver::DIRECT);
        let controls = bending(-1.5e5, &solid);
        let direct = solid.solve(&controls, &STRICT)?;
        let multigrid = solid.solve(&controls, &MULTIGRID)?;
        let (work, size) = (multigrid.report, largest(&direct.u));
        assert_eq!((work.solver, work.factorisations), (Solver::MULTIGRID.name(), 0), "{kind}");
        // a step that meets negative curvature counts as neither
        assert!(work.cycles > work.newton && work.hierarchies + work.reused + 1 >= work.newton, "{kind}: {work:?}");
        assert!(distance(&direct.u, &multigrid.u) < 1e-8 * size, "{kind}");
        let rhs: Vec<f64> = direct.u.iter().map(|u| u / size).collect();
        let by_factor = solid.adjoint(&direct, &[&rhs], &STRICT)?.lambda.remove(0);
        let by_multigrid = solid.adjoint(&direct, &[&rhs], &MULTIGRID)?;
        assert_eq!((by_multigrid.report.solver, by_multigrid.report.factorisations), (Solver::MULTIGRID.name(), 0));
        let error = distance(&by_factor, &by_multigrid.lambda[0]) / largest(&by_factor);
        assert!(error < 1e-8, "{kind}: {error:e}");
        assert_eq!(solid.negative_pivots_by(&direct, &MULTIGRID)?, 0);
    }
    Ok(())
}

/// Where multigrid meets an indefinite tangent a factor takes over, if it fits.
#[test]
fn an_unstable_state_falls_back_to_the_factor() -> Outcome {
    let solid = Solid::new(regular(CellKind::Quad9, [1.0, 0.05, 0.0], [10, 1, 1])?)?
        .material("body", NeoHooke::new(0.5, 0.0)?)?
        .clamp("x-")?
        .traction("x+", Vec3::x() * -1e-3)?;
    let state = solid.solve(&solid.controls(), &STRICT)?;
    assert_eq!(solid.negative_pivots_by(&state, &MULTIGRID)?, 1);
    let rhs: Vec<f64> = (0..state.u.len()).map(noise).collect();
    let by_factor = solid.adjoint(&state, &[&rhs], &STRICT)?.lambda.remove(0);
    let by_multigrid = solid.adjoint(&state, &[&rhs], &MULTIGRID)?;
    assert_eq!(by_multigrid.report.solver, Solver::DIRECT.name());
    assert!(distance(&by_factor, &by_multigrid.lambda[0]) < 1e-8 * largest(&by_factor));
    // from rest the way leads over the bifurcation: the factor takes over there too, and the straight state is found
    let solved = solid.solve(&solid.controls(), &MULTIGRID)?;
    assert!(solved.report.residual <= 1e-10, "{:?}", solved.report);
    assert!(distance(&solved.u, &state.u) < 1e-8 * largest(&state.u), "another equilibrium");
    Ok(())
}

/// `K v` by cells against the matrix, on bent cells that are no boxes, a number of them that fills no batch.
#[test]
fn products_of_cells_are_those_of_the_matrix() -> Outcome {
    let system = System::bent(cantilever(CellKind::Hex27, 1.0, [5, 2, 2], 1e6)?)?;
    let state = system.solid.solve(&bending(-1.5e5, &system.solid), &SolveOptions::default())?;
    let instant = Instant::of(&state);
    let products = system.solid.model().tangents().cell_products(&instant)?.ok_or("27-node hexahedra have products")?;
    let v = system.vector(3);
    let mut wanted = vec![0.0; v.len()];
    system.matrix.multiply(&v, &mut wanted);
    let of = |parallel: bool| {
        let mut room = vec![f32::NAN; 7];
        products.of_cells(&v, &mut room, parallel);
        (0..v.len() / 3).flat_map(|node| products.at_node(node, &room)).collect::<Vec<f64>>()
    };
    let found = of(false);
    assert_eq!(found, of(true));
    assert!(distance(&found, &wanted) < 3e-6 * largest(&wanted), "{}", distance(&found, &wanted) / largest(&wanted));
    Ok(())
}

/// Levels on products against levels on entries, at rest and bent.
#[test]
fn multigrid_on_products_takes_the_same_cycles() -> Outcome {
    for bent in [false, true] {
        let solid = cantilever(CellKind::Hex27, 1.0, [10, 2, 2], 1e6)?;
        let state = if bent { solid.solve(&bending(-1.5e5, &solid), &SolveOptions::default())? } else { solid.rest() };
        let system = System::new(solid, &state)?;
        let products = system.solid.model().tangents().cell_products(&Instant::of(&state))?;
        let (corners, fixed) = (system.solid.discretization().corners(), system.solid.supports().fixed());
        let geometry = Geometry { points: &system.points, fixed, corners, products: products.as_ref() };
        let levels = Multigrid::new(&system.matrix, &geometry, true)?;
        assert!(levels.bytes() < system.multigrid(true)?.bytes(), "products are fewer bytes than entries");
        let (b, mut x) = (system.vector(1), vec![0.0; system.matrix.pattern().dofs()]);
        let multiply = |v: &[f64], out: &mut [f64]| system.matrix.multiply(v, out);
        let report = conjugate_gradient(&multiply, &levels, &b, &mut x, 1e-8, 600);
        let by_entries = system.cycles()?;
        assert!(report.converged() && report.iterations.abs_diff(by_entries) <= 1, "{report:?} against {by_entries}");
    }
    Ok(())
}

/// What other cells and other contributions have no products for.
#[test]
fn only_bodies_of_hexahedra_alone_have_products() -> Outcome {
    let has = |solid: &Solid| -> Outcome<bool> {
        Ok(solid.model().tangents().cell_products(&Instant::of(&solid.rest()))?.is_some())
    };
    let hex27 = || cantilever(CellKind::Hex27, 1.0, [2, 1, 1], 1e6);
    assert!(has(&hex27()?)?);
    assert!(has(&hex27()?.inertia(Inertia::new("body", 1e3))?)?, "inertia has no tangent in an equilibrium");
    assert!(!has(&cantilever(CellKind::Hex20, 1.0, [2, 1, 1], 1e6)?)?);
    assert!(!has(&hex27()?.formulation("body", Formulation::LinearDilatation)?)?);
    assert!(!has(&hex27()?.foundation(Foundation::on("x+", 1e3))?)?);
    Ok(())
}

/// A straight column beyond its buckling load: among indefinite tangents a factor takes over, which ends where it would have ended alone.
#[test]
fn a_straight_column_beyond_buckling_ends_where_the_factor_does() -> Outcome {
    let column = Solid::new(regular(CellKind::Hex27, [1.0, 0.1, 0.1], [40, 4, 4])?)?
        .material("body", NeoHooke::from_young_poisson(3e5, 0.3)?)?
        .clamp("x-")?
        .traction("x+", Vec3::x() * -1500.0)?;
    let by_factor = column.solve(&column.controls(), &STRICT)?;
    let state = column.solve(&column.controls(), &MULTIGRID)?;
    let report = state.report;
    assert!(distance(&state.u, &by_factor.u) < 1e-8 * largest(&by_factor.u));
    assert!(report.cycles > 0 && report.factorisations > 0 && report.cycles < 500 && report.newton < 25, "{report:?}");
    Ok(())
}
