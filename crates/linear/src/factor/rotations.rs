//! Factors that turn with the body.

use super::symmetric::Factor;
use crate::pattern::operator::Preconditioner;
use nastic_tensor::Mat3;

/// A rotation at every node: how far the configuration that a matrix belongs to is turned there.
#[derive(Clone, Debug, PartialEq)]
pub struct Rotations(pub Vec<Mat3>);

/// A factor of `A_0`, the tangent of a configuration with rotations `R_0`, as preconditioner of the tangent of another
/// one with rotations R: `M^-1 = Q A_0^-1 Q^T`, Q block diagonal with `R R_0^T` at the nodes.
///
/// The tangent of a body that has turned by Q without further stretch is `Q A_0 Q^T`; where Q varies slowly this still
/// nearly holds. Nodes with a fixed component are not turned, which would mix what is fixed with what is not.
pub struct CorotatedPreconditioner<'a> {
    factor: &'a Factor,
    /// Row by row, of every node; the identity where nothing turns.
    blocks: Vec<[f64; 9]>,
}

impl<'a> CorotatedPreconditioner<'a> {
    /// `fixed` says which dofs are eliminated. A factor without rotations of its own (see [`Factor::set_rotations`]) stays as
    /// it is.
    #[must_use]
    pub fn new(factor: &'a Factor, to: &Rotations, fixed: &[bool]) -> Self {
        let Some(from) = factor.rotations() else { return Self { factor, blocks: Vec::new() } };
        let dim = factor.symbolic().pattern().dim();
        let block = |((to, from), fixed): ((&Mat3, &Mat3), &[bool])| {
            let turn = if fixed.contains(&true) { Mat3::identity() } else { to * from.transpose() };
            std::array::from_fn(|k| turn[(k / 3, k % 3)])
        };
        Self { factor, blocks: to.0.iter().zip(&from.0).zip(fixed.chunks(dim)).map(block).collect() }
    }

    fn turn(&self, vector: &mut [f64], entry: impl Fn(&[f64; 9], usize, usize) -> f64) {
        let dim = self.factor.symbolic().pattern().dim();
        // of what a node has the displacement comes first
        let turned = dim.min(3);
        for (block, values) in self.blocks.iter().zip(vector.chunks_exact_mut(dim)) {
            let mut before = [0.0; 3];
            before[..turned].copy_from_slice(&values[..turned]);
            for (i, value) in values[..turned].iter_mut().enumerate() {
                *value = (0..turned).map(|k| entry(block, i, k) * before[k]).sum();
            }
        }
    }
}

impl Preconditioner for CorotatedPreconditioner<'_> {
    fn apply(&self, vector: &mut [f64]) {
        self.turn(vector, |block, i, k| block[3 * k + i]);
        self.factor.solve(vector, 1);
        self.turn(vector, |block, i, k| block[3 * i + k]);
    }
}
