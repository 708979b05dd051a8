//! The V-cycle.

use super::block_matrix::BlockMatrix;
use super::smoother::Smoother;
use crate::factor::Factor;

/// A level that is smoothed on, and the way to the next one.
#[derive(Debug)]
pub(super) struct Level {
    pub matrix: BlockMatrix<f32>,
    pub smoother: Smoother,
    pub prolongator: BlockMatrix<f32>,
    pub restrictor: BlockMatrix<f32>,
}

/// Vectors of one level: `x` is made from `r`.
#[derive(Debug, Default)]
pub(super) struct Vectors {
    pub x: Vec<f64>,
    pub r: Vec<f64>,
    d: Vec<f64>,
    z: Vec<f64>,
}

impl Vectors {
    pub fn new(unknowns: usize) -> Self {
        let zeros = || vec![0.0; unknowns];
        Vectors { x: zeros(), r: zeros(), d: zeros(), z: zeros() }
    }
}

/// `x = B r` on the first of the levels, which stand above the factorised one. The same polynomial before and after
/// the correction makes B symmetric.
pub(super) fn v_cycle(levels: &[Level], coarsest: &Factor, vectors: &mut [Vectors], parallel: bool) {
    let Some((here, below)) = vectors.split_first_mut() else { return };
    let Vectors { x, r, d, z } = here;
    let Some((level, deeper)) = levels.split_first() else {
        x.copy_from_slice(r);
        coarsest.solve(x, 1);
        return;
    };
    x.fill(0.0);
    level.smoother.apply(&level.matrix, x, r, [d, z], parallel);
    level.matrix.subtract(d, r, parallel);
    let Some(next) = below.first_mut() else { return };
    level.restrictor.multiply(r, &mut next.r, parallel);
    v_cycle(deeper, coarsest, below, parallel);
    let Some(next) = below.first() else { return };
    level.prolongator.multiply(&next.x, z, parallel);
    x.iter_mut().zip(z.iter()).for_each(|(x, z)| *x += z);
    level.matrix.subtract(z, r, parallel);
    level.smoother.apply(&level.matrix, x, r, [d, z], parallel);
}
