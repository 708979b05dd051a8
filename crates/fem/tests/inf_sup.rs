//! The inf-sup condition of every formulation, numerically: whether its pressures are determined by its displacements.
//!
//! With `a(u, v) = int 2 e(u) : e(v) dX` and the projection P of the divergence onto the pressures of a formulation,
//!
//! ```text
//! beta^2 = smallest lambda > 0 of   int P(div u) P(div v) dX = lambda a(u, v) for all v
//! ```
//!
//! on a body held at its whole boundary, where one pressure, the constant, is undetermined, or on one face, where none is. A beta that does not fall with
//! the mesh means stability; further undetermined pressures are spurious.
//!
//! With the sum `D = R R^T` of all `int P(div u) P(div v) dX`, by Cholesky's factorisation with pivots, the lambda > 0 are the eigenvalues of
//! `R^T A^-1 R`, A the matrix of a: as many as there are pressures that displacements feel.
//!
//! Sources: Chapelle, Bathe, "The inf-sup test", Computers & Structures 47 (1993); Boffi, Brezzi, Fortin, "Mixed Finite Element Methods and Applications"
//! (2013), sections 3.4.3 and 8.
//!
//! The table of docs/development/verification.md, and that of docs/development/large-bodies.md:
//! `cargo test --release -p nastic-fem --test all inf_sup::table -- --ignored --nocapture`
//! `cargo test --release -p nastic-fem --test all inf_sup::cantilever -- --ignored --nocapture`

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::{Outcome, regular, unit};
use nalgebra::DMatrix;
use nastic_energy::NeoHooke;
use nastic_fem::{Formulation, Solid};
use nastic_linear::{Pivots, SparseMatrix, Symbolic};
use nastic_mesh::{CellKind, Mesh};
use std::sync::Arc;

/// Eigenvalues below this share of the largest are zero, and pivots of D.
const ZERO: f64 = 1e-9;
const NO_PIVOT: f64 = 1e-12;
/// Below this `sqrt(lambda)` a pressure is hardly determined.
const WEAK: f64 = 0.2;

struct InfSup {
    beta: f64,
    /// Pressures that no displacement feels, beside the constant of a body held at its whole boundary.
    spurious: usize,
    /// Of those that displacements feel, the ones with `sqrt(lambda) < 0.2`, and all.
    weak: (usize, usize),
}

/// Where a body is held.
#[derive(Clone, Copy, PartialEq)]
enum Held {
    Boundary,
    /// Where x = 0.
    Face,
}

impl Held {
    /// By unknown.
    fn fixed(self, mesh: &Mesh) -> Vec<bool> {
        let nodes = match self {
            Held::Boundary => common::boundary_nodes(mesh),
            Held::Face => (0..).zip(mesh.points()).filter(|(_, x)| x[0].abs() < 1e-12).map(|(node, _)| node).collect(),
        };
        let mut fixed = vec![false; mesh.dim() * mesh.points().len()];
        nodes.iter().for_each(|node| fixed[mesh.dim() * *node as usize..][..mesh.dim()].fill(true));
        fixed
    }
}

/// At rest the tangent of the neo-Hookean law is `mu a + lambda int P(div) P(div)`.
fn inf_sup(formulation: Formulation, mesh: &Mesh, held: Held) -> Outcome<InfSup> {
    let solid = |lambda: f64, formulation: Formulation| -> Outcome<Solid> {
        Ok(Solid::new(mesh.clone())?.material("body", NeoHooke::new(1.0, lambda)?)?.formulation("body", formulation)?)
    };
    let fixed = held.fixed(mesh);
    let tangent = |solid: &Solid| -> Outcome<SparseMatrix> {
        let mut matrix = solid.model().tangents().matrix();
        let rest = vec![0.0; solid.discretization().dofs()];
        solid.body().add_tangent(&rest, &solid.controls(), &mut matrix, true)?;
        matrix.eliminate(&fixed, 1.0);
        Ok(matrix)
    };
    let (own, without) = (tangent(&solid(1.0, formulation)?)?, tangent(&solid(0.0, formulation)?)?);
    let modes = if formulation == Formulation::LinearDilatation { mesh.dim() + 1 } else { 1 };
    let pressures = modes * solid(1.0, formulation)?.body().patches().count();
    let felt = factor_of_difference(&own, &without, pressures);
    let norm = tangent(&solid(0.0, Formulation::Standard)?)?;
    let factor = Arc::new(Symbolic::new(norm.pattern())).factorize(&norm, Pivots::Positive, true)?;
    let mut solved = felt.clone();
    factor.solve(solved.as_mut_slice(), felt.ncols());
    let eigenvalues = (felt.transpose() * solved).symmetric_eigenvalues();
    let largest = eigenvalues.max();
    let positive: Vec<f64> = eigenvalues.iter().copied().filter(|e| *e > ZERO * largest).collect();
    let beta = positive.iter().copied().fold(f64::INFINITY, f64::min).sqrt();
    let weak = positive.iter().filter(|e| e.sqrt() < WEAK).count();
    let spurious = pressures - usize::from(held == Held::Boundary) - positive.len();
    Ok(InfSup { beta, spurious, weak: (weak, positive.len()) })
}

/// R of `one - other = R R^T`, of a rank of at most so many columns.
fn factor_of_difference(one: &SparseMatrix, other: &SparseMatrix, most: usize) -> DMatrix<f64> {
    let mut left: Vec<f64> = one.diagonal().iter().zip(other.diagonal()).map(|(a, b)| a - b).collect();
    let (n, largest) = (left.len(), left.iter().copied().fold(0.0, f64::max));
    let mut columns: Vec<Vec<f64>> = Vec::new();
    while columns.len() < most {
        let at = (0..n).max_by(|&i, &k| left[i].total_cmp(&left[k])).unwrap();
        if left[at] <= NO_PIVOT * largest {
            break;
        }
        let (mut basis, mut column, mut subtracted) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        basis[at] = 1.0;
        one.multiply(&basis, &mut column);
        other.multiply(&basis, &mut subtracted);
        column.iter_mut().zip(&subtracted).for_each(|(x, y)| *x -= y);
        for before in &columns {
            let share = before[at];
            if share != 0.0 {
                column.iter_mut().zip(before).for_each(|(x, y)| *x -= share * y);
            }
        }
        let pivot = left[at].sqrt();
        column.iter_mut().for_each(|x| *x /= pivot);
        left.iter_mut().zip(&column).for_each(|(left, x)| *left -= x * x);
        left[at] = 0.0;
        columns.push(column);
    }
    DMatrix::from_fn(n, columns.len(), |i, k| columns[k][i])
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
        let on = |n: usize| inf_sup(formulation, &unit(kind, n)?, Held::Boundary);
        let (coarse, fine) = (on(4)?, on(8)?);
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

/// A cube held on one face: of 27-node hexahedra and patches of tetrahedra beta hardly falls, of 8-node ones it does, and of 10-node tetrahedra too.
#[test]
fn pressures_of_cubes_held_on_one_face() -> Outcome {
    let kinds = [
        (CellKind::Hex27, [2, 4], 0.8..1.0),
        (CellKind::Tet4, [6, 8], 0.9..1.1),
        (CellKind::Hex8, [4, 8], 0.2..0.4),
        (CellKind::Tet10, [2, 4], 0.5..0.7),
    ];
    for (kind, meshes, expected) in kinds {
        let formulation = Formulation::nearly_incompressible(kind).ok_or("no formulation")?;
        let [coarse, fine] = meshes.map(|n| inf_sup(formulation, &unit(kind, n)?, Held::Face));
        let (coarse, fine) = (coarse?, fine?);
        let kept = fine.beta / coarse.beta;
        println!("{kind}: {:.4} {:.4}, kept {kept:.3}", coarse.beta, fine.beta);
        assert_eq!((coarse.spurious, fine.spurious), (0, 0), "{kind}");
        assert!(expected.contains(&kept), "{kind}: {kept}");
    }
    Ok(())
}

#[test]
#[ignore = "prints the table"]
fn table() -> Outcome {
    for (kind, formulation) in members(2).chain(members(3)) {
        let meshes = match (kind.dim(), kind.order()) {
            (2, 1) => [4, 8, 16],
            (2, _) => [4, 8, 12],
            (_, 1) => [4, 6, 8],
            (_, _) => [2, 3, 4],
        };
        let on = |n: usize| inf_sup(formulation, &unit(kind, n)?, Held::Boundary);
        println!("{kind} {formulation}:{}", line(meshes.map(|n| (n, on(n))))?);
    }
    Ok(())
}

/// The cube and the cantilever of docs/development/large-bodies.md, held on one face.
#[test]
#[ignore = "prints the table, in minutes"]
fn cantilever() -> Outcome {
    for (kind, formulation) in members(3) {
        let cube = |n: usize| inf_sup(formulation, &unit(kind, n)?, Held::Face);
        let bar = |n: usize| inf_sup(formulation, &regular(kind, [1.0, 0.2, 0.2], [5 * n, n, n])?, Held::Face);
        let first = if kind.order() == 1 { 2 } else { 1 };
        let cubes = [1, 2, 3, 4, 6, 8].into_iter().filter(|n| kind.order() == 1 || *n <= 4);
        println!("{kind} {formulation}, cube:{}", line(cubes.map(|n| (n, cube(n))))?);
        println!("{kind} {formulation}, cantilever:{}", line([1, 2, 4].map(|k| (k * first, bar(k * first))))?);
    }
    Ok(())
}

/// Values by cells along an edge.
fn line(values: impl IntoIterator<Item = (usize, Outcome<InfSup>)>) -> Outcome<String> {
    let of = |(n, found): (usize, Outcome<InfSup>)| {
        let InfSup { beta, spurious, weak: (weak, all) } = found?;
        Ok(format!(" {beta:.4} on {n} ({spurious} spurious, {weak} of {all} below {WEAK})"))
    };
    values.into_iter().map(of).collect()
}
