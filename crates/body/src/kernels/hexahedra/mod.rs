//! The matrices of 27-node hexahedra from stored moduli, sixteen cells at a time.
//!
//! Nodes and quadrature points stand on grids of 3 x 3 x 3, the first direction running fastest. The change of stress follows from stored moduli,
//! 45 numbers per point whatever the law: `K_iajb = sum_q d_K N_a A_iKjM(q) d_M N_b`, derivatives by the coordinates of the reference cell.

mod corners;
mod diagonal;
mod lanes;
mod laplace;
mod product;

pub(crate) use corners::{CORNERS, CornerBatch, PAIRS};
pub(crate) use diagonal::{DiagonalBatch, ENTRIES};
pub use laplace::{LaplaceBatch, METRIC};
pub(crate) use product::{Batch, ROWS};

use lanes::Lanes;
use std::array::from_fn;

/// Cells computed together.
pub const CELLS: usize = 16;
/// Nodes of a cell, and points.
pub const NODES: usize = 27;
/// Moduli of a point: the upper triangle of a symmetric matrix of 9 rows.
pub(crate) const MODULI: usize = 45;

/// Shapes and their derivatives in one direction, `[point][node]`, and the first-order shapes of its two ends.
#[derive(Debug, Clone, Copy)]
pub struct Line {
    /// Of second order, `[point][node]`.
    pub shapes: [[f64; 3]; 3],
    /// Their derivatives.
    pub derivatives: [[f64; 3]; 3],
    /// Of first order, `[point][end]`.
    pub ends: [[f64; 2]; 3],
    /// Their derivatives, by end.
    pub end_derivatives: [f64; 2],
}

type Grid<L> = [<L as Lanes>::Numbers; NODES];
type Square<L> = [[<L as Lanes>::Numbers; 3]; 3];

/// A matrix in all lanes, and transposed.
#[inline(always)]
fn splat<L: Lanes>(lanes: L, m: &[[f64; 3]; 3]) -> Square<L> {
    from_fn(|r| from_fn(|c| lanes.splat(m[r][c])))
}

#[inline(always)]
fn splat_transposed<L: Lanes>(lanes: L, m: &[[f64; 3]; 3]) -> Square<L> {
    from_fn(|r| from_fn(|c| lanes.splat(m[c][r])))
}

/// Adds `sum_n m[q][n] x[n]` along the direction in which neighbours are `STRIDE` apart.
#[inline(always)]
fn contract<L: Lanes, const STRIDE: usize>(lanes: L, m: &Square<L>, x: &Grid<L>, out: &mut Grid<L>) {
    for k in 0..NODES / 3 {
        let first = k % STRIDE + 3 * STRIDE * (k / STRIDE);
        let line: [L::Numbers; 3] = from_fn(|n| x[first + STRIDE * n]);
        for (q, row) in m.iter().enumerate() {
            let at = &mut out[first + STRIDE * q];
            for n in 0..3 {
                *at = lanes.mul_add(row[n], line[n], *at);
            }
        }
    }
}
