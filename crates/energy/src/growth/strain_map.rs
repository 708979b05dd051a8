use nastic_tensor::{HyperDual, Mat3, Vec3};

use super::ShapeMode;
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

    /// What is said of values of the slots that leave nothing of a length or of the volume.
    fn limit(&self) -> &'static str {
        "det G must be positive, or nothing is left of the volume"
    }

    /// A unit vector that is written with it: along which it acts, or the normal of the plane in which it does.
    fn direction(&self, _at: MaterialPoint) -> Option<Vec3> {
        None
    }

    /// Bounds of a slot as a control where nobody gives others, infinite where there are none.
    fn default_bounds(&self, _slot: usize) -> [f64; 2] {
        [f64::NEG_INFINITY, f64::INFINITY]
    }

    /// What messages call it.
    fn owner(&self) -> &'static str {
        "growth"
    }

    /// The share of every volume, det G, that more than is left of.
    fn least_volume(&self) -> f64 {
        0.0
    }

    /// The displacement fields that it is the gradient of, one for each slot, where it changes the shape of the body along some; none of others.
    fn shape(&self) -> &[ShapeMode] {
        &[]
    }

    /// Whether it changes the shape of the body: along fields, or by the gradient of one.
    fn is_shape(&self) -> bool {
        !self.shape().is_empty()
    }

    /// det G at a point.
    fn volume(&self, at: MaterialPoint, g: &[HyperDual]) -> HyperDual {
        Mapped::of(&self.tensor(at, g)).volume
    }

    /// Whether these values of the slots leave a volume.
    fn admits(&self, at: MaterialPoint, g: &[f64]) -> bool {
        let g: Vec<HyperDual> = g.iter().copied().map(HyperDual::constant).collect();
        let volume = self.volume(at, &g).real();
        volume > self.least_volume() && volume.is_finite()
    }
}

/// Lower bound of a growth where none is given: a tenth of every length is left.
pub(super) const LEAST_GROWTH: f64 = -0.9;

/// The entry of the identity.
pub(super) fn identity(i: usize, k: usize) -> HyperDual {
    HyperDual::constant(f64::from(u8::from(i == k)))
}

/// G from its entries.
pub(super) fn entries(entry: impl Fn(usize, usize) -> HyperDual) -> [[HyperDual; 3]; 3] {
    std::array::from_fn(|i| std::array::from_fn(|k| entry(i, k)))
}

/// g where 1 + g is positive: in a plane, and where volume is kept, det G alone does not see that lengths have gone below zero.
pub(super) fn leaving_lengths(g: HyperDual) -> HyperDual {
    if g.real() > -1.0 { g } else { HyperDual::constant(f64::NAN) }
}

/// What a law that has a strain map and no energy answers as an [`EnergyTerm`](crate::EnergyTerm).
macro_rules! strain_map_alone {
    () => {
        fn respond(&self, _: &PointBatch, _: Slots, _: Want, _: &mut Response) {}

        fn second_stress_change(
            &self,
            _: &PointBatch,
            _: Slots,
            _: [&[Mat3]; 2],
            _: &mut [Mat3],
        ) -> Result<(), EnergyError> {
            Ok(())
        }

        fn stress_by_control(&self, _: &PointBatch, _: Slots, out: &mut [Mat3]) {
            out.fill(Mat3::zeros());
        }

        fn control_stress_change(
            &self,
            _: &PointBatch,
            _: Slots,
            _: &[Mat3],
            _: Slots,
            out: &mut [Mat3],
        ) -> Result<(), EnergyError> {
            out.fill(Mat3::zeros());
            Ok(())
        }

        fn strain_map(&self) -> Option<&dyn StrainMap> {
            Some(self)
        }
    };
}
pub(super) use strain_map_alone;

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
