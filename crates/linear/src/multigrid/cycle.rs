//! The V-cycle.

use super::block_matrix::BlockMatrix;
use super::chunks;
use super::level::Level;
use super::smoother::Working;
use crate::factor::symmetric::Factor;

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

    fn working(&mut self) -> Working<'_> {
        Working { x: &mut self.x, r: &mut self.r, d: &mut self.d, z: &mut self.z }
    }
}

/// `x = B r` on the first of the levels, which stand above the factorised one; with the matrix of that first one where it is not its own. The same
/// polynomial before and after the correction makes B symmetric.
pub(super) fn v_cycle(
    levels: &[Level],
    first: Option<&BlockMatrix>,
    coarsest: &Factor,
    vectors: &mut [Vectors],
    parallel: bool,
) {
    let Some((here, below)) = vectors.split_first_mut() else { return };
    let Some((level, deeper)) = levels.split_first() else {
        here.x.copy_from_slice(&here.r);
        coarsest.solve(&mut here.x, 1);
        return;
    };
    let matrix = first.unwrap_or(&level.matrix);
    level.smoother.apply(matrix, here.working(), true, parallel);
    matrix.subtract(&here.d, &mut here.r, parallel);
    let Some(next) = below.first_mut() else { return };
    level.transfer.restrict(&here.r, &mut next.r, parallel);
    v_cycle(deeper, None, coarsest, below, parallel);
    let Some(next) = below.first() else { return };
    level.transfer.prolong(&next.x, &mut here.z, parallel);
    add(&here.z, &mut here.x, parallel);
    matrix.subtract(&here.z, &mut here.r, parallel);
    level.smoother.apply(matrix, here.working(), false, parallel);
}

/// `y += x`.
fn add(x: &[f64], y: &mut [f64], parallel: bool) {
    let parts = chunks::rows(y, 8).zip(x.chunks(8 * chunks::CHUNK)).collect();
    chunks::each(parts, parallel, |_, (y, x): (&mut [f64], &[f64])| y.iter_mut().zip(x).for_each(|(y, x)| *y += x));
}
