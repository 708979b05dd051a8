use std::sync::Arc;

use nastic_tensor::{HyperDual, Mat3, Scalar, Vec3};

use super::StrainMap;
use super::strain_map::{LEAST_GROWTH, entries, identity, leaving_lengths, strain_map_alone};
use crate::director::{Director, with_direction};
use crate::{EnergyError, EnergyTerm, Field, MaterialPoint, PointBatch, Response, Slot, Slots, Want};

/// A strain along a direction that keeps the volume: liquid crystal elastomers along their director, muscles by active strain along their fibres.
///
/// **Map.** `G = l a (x) a + l^(-1/2) (1 - a (x) a)`, `det G = 1`, with the stretch l along the unit vector a. All laws of its cells see `F G^-1`, see
/// [`StrainMap`].
///
/// **Convexity.** Polyconvex where the laws are: `F -> F G^-1` is linear.
///
/// **Parameters.** a, unit vectors of the reference body, uniform or a [`Field`], or a control, the vector `direction`. Control of an elastomer: `strain`
/// e, a pure number above -1, `l = 1 + e`; it contracts as it loses its order, e < 0. With the ratio r of step lengths over that at rest, `l = r^(1/3)`.
/// Control of a muscle: `shortening` c from 0 to below 1, `l = 1 - c`: the same map, where only shortening has a meaning.
///
/// **Source.** M. Warner, E. M. Terentjev, "Liquid Crystal Elastomers", Oxford 2003; C. Cherubini et al., J. Theor. Biol. 430 (2017) 221-228 and
/// S. Rossi et al., Eur. J. Mech. A 48 (2014) 129-142 on active strain that keeps the volume.
#[derive(Clone, Debug)]
pub struct SpontaneousStrain {
    a: Director,
    is_muscle: bool,
}

impl SpontaneousStrain {
    /// Name in case files of liquid crystal elastomers.
    pub const LCE: &str = "lce";
    /// Of muscles.
    pub const MUSCLE: &str = "active_strain";
    const STRAIN: [Slot; 4] = with_direction(Slot::scalar("strain", "1"));
    const SHORTENING: [Slot; 4] = with_direction(Slot::pulling("shortening", "1"));
    /// Upper bound of a shortening where none is given: a tenth of the length is left.
    const MOST_SHORTENING: f64 = -LEAST_GROWTH;

    /// Of an elastomer with these directors.
    ///
    /// # Errors
    /// [`EnergyError::Direction`] with the first vector that is not a unit vector, and where it is.
    pub fn elastomer(a: impl Into<Field<Vec3>>) -> Result<Self, EnergyError> {
        Ok(SpontaneousStrain { a: Director::new(a, Self::LCE)?, is_muscle: false })
    }

    /// Of a muscle with these fibres.
    ///
    /// # Errors
    /// As [`elastomer`](Self::elastomer).
    pub fn muscle(a: impl Into<Field<Vec3>>) -> Result<Self, EnergyError> {
        Ok(SpontaneousStrain { a: Director::new(a, Self::MUSCLE)?, is_muscle: true })
    }
}

impl StrainMap for SpontaneousStrain {
    fn tensor(&self, at: MaterialPoint, slots: &[HyperDual]) -> [[HyperDual; 3]; 3] {
        let given = slots.first().copied().unwrap_or(HyperDual::constant(0.0));
        let along = HyperDual::constant(1.0) + leaving_lengths(if self.is_muscle { -given } else { given });
        let across = HyperDual::constant(1.0) / along.root(2);
        let dyad = self.a.dyad(at, slots);
        entries(|i, k| across * identity(i, k) + (along - across) * dyad[i][k])
    }

    fn limit(&self) -> &'static str {
        if self.is_muscle {
            "shortening must stay below 1, where nothing is left of a length"
        } else {
            "strain must stay above -1, where nothing is left of a length"
        }
    }

    fn direction(&self, at: MaterialPoint) -> Option<Vec3> {
        self.a.fixed(at)
    }

    fn default_bounds(&self, _: usize) -> [f64; 2] {
        if self.is_muscle { [0.0, Self::MOST_SHORTENING] } else { [LEAST_GROWTH, f64::INFINITY] }
    }
}

/// It has no energy of its own.
impl EnergyTerm for SpontaneousStrain {
    strain_map_alone!();

    fn with_direction_slots(&self) -> Option<Arc<dyn EnergyTerm>> {
        Some(Arc::new(SpontaneousStrain { a: self.a.as_slots(), is_muscle: self.is_muscle }))
    }

    fn slots(&self) -> &[Slot] {
        let all = if self.is_muscle { &Self::SHORTENING } else { &Self::STRAIN };
        if self.a.is_slot { all } else { &all[..1] }
    }

    fn rest(&self, at: MaterialPoint, slot: usize) -> f64 {
        self.a.rest(at, slot)
    }

    fn check(&self, cells: usize, points: usize) -> Result<(), EnergyError> {
        self.a.check(cells, points)
    }
}
