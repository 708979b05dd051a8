use nastic_tensor::{HyperDual, Mat3};

use super::StrainMap;
use super::strain_map::{LEAST_GROWTH, entries, identity, strain_map_alone};
use crate::{EnergyError, EnergyTerm, MaterialPoint, PointBatch, Response, Slot, Slots, Want};

/// Growth by a symmetric tensor: six numbers, each of which may be a control.
///
/// **Map.** `G = 1 + g`, g symmetric with the entries `xx, yy, zz, yz, xz, xy` along the axes of the reference body; an entry beside the diagonal
/// stands twice. All laws of its cells see `F G^-1`, see [`StrainMap`].
///
/// **Domain.** G is positive definite: a length is left along every direction, `det G > 0` among it.
///
/// **Convexity.** Polyconvex where the laws are: `F -> F G^-1` is linear.
///
/// **Parameters.** None; controls `xx` to `xy`, pure numbers.
///
/// **Source.** As [`KinematicGrowth`](crate::KinematicGrowth).
#[derive(Clone, Copy, Debug, Default)]
pub struct GrowthTensor;

impl GrowthTensor {
    /// Name in case files.
    pub const NAME: &str = "growth_tensor";
    const SLOTS: [Slot; 6] = [
        Slot::scalar("xx", "1"),
        Slot::scalar("yy", "1"),
        Slot::scalar("zz", "1"),
        Slot::scalar("yz", "1"),
        Slot::scalar("xz", "1"),
        Slot::scalar("xy", "1"),
    ];
    /// The slot of an entry.
    const OF_ENTRY: [[usize; 3]; 3] = [[0, 5, 4], [5, 1, 3], [4, 3, 2]];

    /// Its six entries are its slots.
    pub const fn new() -> Self {
        GrowthTensor
    }
}

impl StrainMap for GrowthTensor {
    fn tensor(&self, _: MaterialPoint, slots: &[HyperDual]) -> [[HyperDual; 3]; 3] {
        let grown = |i: usize, k: usize| {
            let slot = slots.get(Self::OF_ENTRY[i][k]).copied();
            identity(i, k) + slot.unwrap_or(HyperDual::constant(0.0))
        };
        let g = entries(grown);
        // leading minors; the third is det G, which the laws look at
        let minor = g[0][0] * g[1][1] - g[0][1] * g[1][0];
        let leaves = g[0][0].real() > 0.0 && minor.real() > 0.0;
        if leaves { g } else { entries(|_, _| HyperDual::constant(f64::NAN)) }
    }

    fn limit(&self) -> &'static str {
        "1 + growth must be positive definite, or nothing is left of a length: det G > 0, diagonal entries above -1, shear below what they leave"
    }

    fn default_bounds(&self, slot: usize) -> [f64; 2] {
        [if slot < 3 { LEAST_GROWTH } else { f64::NEG_INFINITY }, f64::INFINITY]
    }
}

/// It has no energy of its own.
impl EnergyTerm for GrowthTensor {
    strain_map_alone!();

    fn slots(&self) -> &[Slot] {
        &Self::SLOTS
    }
}
