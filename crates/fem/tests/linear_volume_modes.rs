//! Multigrid for nearly incompressible bodies whose formulation gives every cell few pressures: these become unknowns of their own.
//!
//! `cargo test --release -p nastic-fem --test all linear_volume_modes -- --nocapture` prints cycles.

#![allow(clippy::print_stdout)] // cycles are worth reading

use crate::common;

use common::block::STRICT;
use common::{Outcome, bending, distance, largest, noise, regular};
use nastic_energy::{FiberTension, NeoHooke};
use nastic_fem::{Formulation, Solid, SolveOptions, Solver, State};
use nastic_mesh::CellKind;
use nastic_tensor::Vec3;

const MULTIGRID: SolveOptions = SolveOptions { solver: Some(Solver::MULTIGRID), ..STRICT };
/// Bulk modulus: 10,000 times the shear modulus.
const HARD: f64 = 0.49995;

fn law(poisson: f64) -> Outcome<NeoHooke> {
    Ok(NeoHooke::from_young_poisson(3e5, poisson)?)
}

/// The cantilever of `n` cells over its thickness, with the formulation of its cells for nearly incompressible bodies.
fn cantilever(kind: CellKind, n: usize, poisson: f64) -> Outcome<Solid> {
    let size = if kind.dim() == 3 { [1.0, 0.2, 0.2] } else { [1.0, 0.2, 0.0] };
    Ok(Solid::new(regular(kind, size, [5 * n, n, n])?)?
        .material("body", law(poisson)?)?
        .formulation("body", Formulation::nearly_incompressible(kind).unwrap_or_default())?
        .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
        .clamp("x-")?)
}

/// A load across the body.
fn across(solid: &Solid) -> Vec<f64> {
    let dim = solid.mesh().dim();
    let of_node = |x: &[f64; 3]| (0..dim).map(|k| if k + 1 == dim { x[0] } else { 0.0 }).collect::<Vec<_>>();
    solid.mesh().points().iter().flat_map(of_node).collect()
}

/// The solution with the tangent of a state, and its cycles, where no factor took over.
fn solved(solid: &Solid, state: &State, rhs: &[f64]) -> Outcome<(Vec<f64>, usize)> {
    let mut adjoint = solid.adjoint(state, &[rhs], &MULTIGRID)?;
    let report = adjoint.report;
    assert_eq!((report.solver, report.factorisations), (Solver::MULTIGRID.name(), 0), "{report:?}");
    Ok((adjoint.lambda.remove(0), report.cycles))
}

/// To where double precision ends. Cells that satisfy the inf-sup condition, and the most cycles beside those at a Poisson's ratio of 0.3; hex8, of whose
/// pressures displacements control some little, take more. By the levels of the whole tangent none of them gets there in 600.
#[test]
fn cycles_are_a_small_multiple_of_those_of_compressible_bodies() -> Outcome {
    let kinds = [
        (CellKind::Tet4, [4, 8], 4),
        (CellKind::Hex27, [2, 3], 6),
        (CellKind::Tet10, [2, 3], 5),
        (CellKind::Hex8, [4, 8], 9),
    ];
    for (kind, meshes, most) in kinds {
        for n in meshes {
            let of = |poisson: f64| {
                let solid = cantilever(kind, n, poisson)?;
                Ok::<_, Box<dyn std::error::Error>>(solved(&solid, &solid.rest(), &across(&solid))?.1)
            };
            let [soft, middle, hard] = [of(0.3)?, of(0.4994)?, of(HARD)?];
            println!("{kind}, {n} cells: {soft} cycles, {middle} and {hard} at 0.4994 and 0.49995");
            assert!(middle.max(hard) <= most * soft, "{kind}, {n} cells: {soft}, {middle}, {hard}");
        }
    }
    Ok(())
}

#[test]
fn solutions_and_adjoints_are_those_of_the_factor() -> Outcome {
    for (kind, n) in
        [(CellKind::Hex8, 4), (CellKind::Tet4, 4), (CellKind::Hex27, 2), (CellKind::Tet10, 2), (CellKind::Quad9, 4)]
    {
        let solid = cantilever(kind, n, HARD)?;
        let controls = bending(-5e3, &solid);
        // rounding of so stiff a body leaves no more
        let accuracy = 1e-11;
        let direct = solid.solve(&controls, &SolveOptions { accuracy, ..STRICT })?;
        let multigrid = solid.solve(&controls, &SolveOptions { accuracy, ..MULTIGRID })?;
        let (report, size) = (multigrid.report, largest(&direct.u));
        println!("{kind}: {} and {} iterations, {} cycles", direct.report.newton, report.newton, report.cycles);
        assert_eq!((report.solver, report.factorisations), (Solver::MULTIGRID.name(), 0), "{kind}");
        assert!(
            distance(&direct.u, &multigrid.u) < 1e-8 * size,
            "{kind}: {:e}",
            distance(&direct.u, &multigrid.u) / size
        );
        let rhs: Vec<f64> = direct.u.iter().map(|u| u / size).collect();
        let by_factor = solid.adjoint(&direct, &[&rhs], &STRICT)?.lambda.remove(0);
        let (by_multigrid, _) = solved(&solid, &direct, &rhs)?;
        let error = distance(&by_factor, &by_multigrid) / largest(&by_factor);
        assert!(error < 1e-8, "{kind}: {error:e}");
        assert_eq!(solid.negative_pivots_by(&direct, &MULTIGRID)?, 0, "{kind}");
    }
    Ok(())
}

#[test]
fn one_thread_and_two_give_the_same_bits() -> Outcome {
    for (kind, n) in [(CellKind::Hex8, 8), (CellKind::Tet4, 6)] {
        let solid = cantilever(kind, n, HARD)?;
        let (rest, rhs) = (solid.rest(), across(&solid));
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
            pool.install(|| solved(&solid, &rest, &rhs).map_err(|error| error.to_string())).map_err(Into::into)
        };
        let [one, two]: [Outcome<(Vec<f64>, usize)>; 2] = [on(1), on(2)];
        assert!(one? == two?, "{kind}");
    }
    Ok(())
}

/// A column pressed beyond its buckling load: its straight state is not stable.
#[test]
fn indefinite_tangents_still_end() -> Outcome {
    let solid = Solid::new(regular(CellKind::Quad9, [1.0, 0.05, 0.0], [10, 1, 1])?)?
        .material("body", NeoHooke::from_shear_bulk(0.5, 50.0)?)?
        .formulation("body", Formulation::LinearDilatation)?
        .clamp("x-")?
        .traction("x+", Vec3::x() * -1.3e-3)?;
    let [direct, multigrid] = [Solver::DIRECT, Solver::MULTIGRID];
    let options = |solver| SolveOptions { solver: Some(solver), ..SolveOptions::default() };
    let state = solid.solve(&solid.controls(), &options(direct))?;
    let unstable = solid.negative_pivots_by(&state, &options(direct))?;
    assert!(unstable > 0, "the straight column is stable");
    assert_eq!(solid.negative_pivots_by(&state, &options(multigrid))?, unstable);
    let rhs: Vec<f64> = (0..state.u.len()).map(noise).collect();
    let by_factor = solid.adjoint(&state, &[&rhs], &options(direct))?.lambda.remove(0);
    let by_multigrid = solid.adjoint(&state, &[&rhs], &options(multigrid))?.lambda.remove(0);
    let error = distance(&by_factor, &by_multigrid) / largest(&by_factor);
    assert!(error < 1e-8, "error {error:e}");
    let solved = solid.solve(&solid.controls(), &options(multigrid))?;
    assert!(solved.report.residual <= 1e-10, "{:?}", solved.report);
    Ok(())
}
