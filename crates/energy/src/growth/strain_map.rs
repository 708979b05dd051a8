use nastic_tensor::{HyperDual, Mat3};

use crate::MaterialPoint;

/// A map between the gradient of the displacement and the laws of a cell: they see `F G^-1` and answer for a volume that is `det G` times as large,
///
/// ```text
/// W_G(F; m, g) = det G(g) W(F G(g)^-1; m)
/// ```
///
/// with numbers g at every point that are slots as any others. See [`Grown`](crate::Grown) for the derivatives.
pub trait StrainMap: std::fmt::Debug + Send + Sync {
    /// G at a point, by rows, from its slots in numbers that carry their derivatives. Where its determinant is no positive number the laws refuse it.
    fn tensor(&self, at: MaterialPoint, g: &[HyperDual]) -> [[HyperDual; 3]; 3];
}

/// `G^-1` and `T = det G G^-T` of G with their derivatives along two changes of its slots: parts `[value, first, second, both]`.
pub(super) struct Mapped {
    /// det G, likewise.
    pub volume: HyperDual,
    pub inverse: [Mat3; 4],
    pub cofactor: [Mat3; 4],
}

impl Mapped {
    /// Of G.
    pub fn of(g: &[[HyperDual; 3]; 3]) -> Self {
        // the cofactor, entry by entry: cyclic minors carry their sign
        let cofactor = |i: usize, k: usize| {
            let ([a, b], [c, d]) = ([(i + 1) % 3, (i + 2) % 3], [(k + 1) % 3, (k + 2) % 3]);
            g[a][c] * g[b][d] - g[a][d] * g[b][c]
        };
        let cofactors: [[HyperDual; 3]; 3] = std::array::from_fn(|i| std::array::from_fn(|k| cofactor(i, k)));
        let volume = g[0][0] * cofactors[0][0] + g[0][1] * cofactors[0][1] + g[0][2] * cofactors[0][2];
        let parts =
            |of: &dyn Fn(usize, usize) -> HyperDual| std::array::from_fn(|part| Mat3::from_fn(|i, k| of(i, k).0[part]));
        Mapped { volume, inverse: parts(&|i, k| cofactors[k][i] / volume), cofactor: parts(&|i, k| cofactors[i][k]) }
    }
}
