//! The inf-sup condition of every formulation, numerically: whether its pressures are determined by its displacements.
//!
//! With `a(u, v) = int 2 e(u) : e(v) dX` and the projection P of the divergence onto the pressures of a formulation,
//!
//! ```text
//! beta^2 = smallest lambda > 0 of   int P(div u) P(div v) dX = lambda a(u, v) for all v
//! ```
//!
//! on a body held at its whole boundary, where one pressure, the constant, is undetermined. A beta that does not fall with the mesh
//! means stability; further undetermined pressures are spurious.
//!
//! Source: Chapelle, Bathe, "The inf-sup test", Computers & Structures 47 (1993).
//!
//! The table of docs/development/verification.md:
//! `cargo test --release -p nastic-fem --test all inf_sup -- --ignored --nocapture`

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::{Outcome, unit};
use nalgebra::DMatrix;
use nastic_energy::NeoHooke;
use nastic_fem::{Formulation, Solid};
use nastic_linear::SparseMatrix;
use nastic_mesh::CellKind;

/// Eigenvalues below this share of the largest are zero.
const ZERO: f64 = 1e-9;

struct InfSup {
    beta: f64,
    /// Pressures beside the constant that no displacement feels.
    spurious: usize,
}

/// The unit square or cube of `n` grid cells along each side. At rest the tangent of the neo-Hookean law is `mu a + lambda int P(div) P(div)`.
fn inf_sup(kind: CellKind, formulation: Formulation, n: usize) -> Outcome<InfSup> {
    let solid = |lambda: f64, formulation: Formulation| -> Outcome<Solid> {
        Ok(Solid::new(unit(kind, n)?)?
            .material("body", NeoHooke::new(1.0, lambda)?)?
            .formulation("body", formulation)?)
    };
    let tangent = |solid: &Solid| -> Outcome<SparseMatrix> {
        let mut matrix = solid.model().matrix();
        let rest = vec![0.0; solid.discretization().dofs()];
        solid.body().add_tangent(&rest, &solid.controls(), &mut matrix, true)?;
        Ok(matrix)
    };
    let shear = solid(0.0, Formulation::Standard)?;
    let (own, without) = (tangent(&solid(1.0, formulation)?)?, tangent(&solid(0.0, formulation)?)?);
    let norm = tangent(&shear)?;
    let (mesh, dim) = (shear.mesh(), shear.mesh().dim());
    let held = common::boundary_nodes(mesh);
    let free: Vec<usize> = (0..mesh.points().len()).filter(|k| !held.contains(&(*k as u32))).collect();
    let free: Vec<usize> = free.iter().flat_map(|k| (0..dim).map(move |i| dim * k + i)).collect();
    let dense =
        |of: &dyn Fn(usize, usize) -> f64| DMatrix::from_fn(free.len(), free.len(), |i, k| of(free[i], free[k]));
    let factor = dense(&|i, k| norm.get(i, k)).cholesky().ok_or("the norm is not definite")?.l();
    let divergence = dense(&|i, k| own.get(i, k) - without.get(i, k));
    let half = factor.solve_lower_triangular(&divergence).ok_or("singular")?.transpose();
    let both = factor.solve_lower_triangular(&half).ok_or("singular")?;
    let eigenvalues = both.symmetric_eigenvalues();
    let largest = eigenvalues.max();
    let positive: Vec<f64> = eigenvalues.iter().copied().filter(|e| *e > ZERO * largest).collect();
    let modes = if formulation == Formulation::LinearDilatation { dim + 1 } else { 1 };
    let pressures = modes * solid(1.0, formulation)?.body().patches().count();
    let beta = positive.iter().copied().fold(f64::INFINITY, f64::min).sqrt();
    Ok(InfSup { beta, spurious: pressures - 1 - positive.len() })
}

fn members(dim: usize) -> impl Iterator<Item = (CellKind, Formulation)> {
    [Formulation::MeanDilatation, Formulation::LinearDilatation]
        .into_iter()
        .flat_map(|formulation| formulation.kinds().iter().map(move |kind| (*kind, formulation)))
        .filter(move |(kind, _)| kind.dim() == dim)
}

/// Q2/P1 and P2/P0 are stable; Q1/P0 has a checkerboard of pressures, linear pressures of quad8 have two such, and their other ones are less and less
/// determined.
#[test]
fn second_order_pairs_are_stable() -> Outcome {
    for (kind, formulation) in members(2) {
        let (coarse, fine) = (inf_sup(kind, formulation, 4)?, inf_sup(kind, formulation, 8)?);
        let kept = fine.beta / coarse.beta;
        println!("{kind} {formulation}: {:.4} {:.4}, {} {}", coarse.beta, fine.beta, coarse.spurious, fine.spurious);
        let undetermined = match kind {
            CellKind::Quad4 => 1,
            CellKind::Quad8 => 2,
            _ => 0,
        };
        if undetermined > 0 {
            assert_eq!((coarse.spurious, fine.spurious), (undetermined, undetermined), "{kind}");
            assert!(kept < 0.7, "{kept}");
        } else {
            assert_eq!((coarse.spurious, fine.spurious), (0, 0), "{kind} {formulation}");
            assert!(kept > 0.85, "{kind} {formulation}: {kept}");
        }
    }
    Ok(())
}

#[test]
#[ignore = "prints the table, in minutes"]
fn table() -> Outcome {
    for (kind, formulation) in members(2).chain(members(3)) {
        let meshes = match (kind.dim(), kind.order()) {
            (2, 1) => [4, 8, 16],
            (2, _) => [4, 8, 12],
            (_, 1) => [4, 6, 8],
            (_, _) => [2, 3, 4],
        };
        let mut line = format!("{kind} {formulation}:");
        for n in meshes {
            let InfSup { beta, spurious } = inf_sup(kind, formulation, n)?;
            line += &format!(" {beta:.4} on {n} ({spurious} spurious)");
        }
        println!("{line}");
    }
    Ok(())
}
