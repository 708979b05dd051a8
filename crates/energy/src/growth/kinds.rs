use std::sync::Arc;

use nastic_tensor::{HyperDual, Mat3, Vec3};

use super::StrainMap;
use super::strain_map::{LEAST_GROWTH, entries, identity, leaving_lengths, strain_map_alone};
use crate::director::{Director, with_direction};
use crate::{EnergyError, EnergyTerm, Field, MaterialPoint, PointBatch, Response, Slot, Slots, Want};

/// Growth by one number: swelling, shape memory, prestrain.
///
/// **Map.** `G = 1 + g S`: in all directions `S = 1`, along a unit vector `S = a (x) a`, across one `S = 1 - n (x) n`. All laws of its cells see
/// `F G^-1`, see [`StrainMap`]; a body that is free everywhere takes `F = G` without energy where G is compatible.
///
/// **Convexity.** Polyconvex where the laws are: `F -> F G^-1` is linear.
///
/// **Parameters.** a or n, unit vectors of the reference body, uniform or a [`Field`]; control `growth` g, a pure number above -1: 0.1 is a tenth longer.
/// a may be a control too, the vector `direction`. In plane strain growth in all directions acts across the plane too.
///
/// **Source.** E. K. Rodriguez, A. Hoger, A. D. McCulloch, J. Biomech. 27 (1994) 455-467, doi 10.1016/0021-9290(94)90021-3.
#[derive(Clone, Debug)]
pub struct KinematicGrowth(Directions);

#[derive(Clone, Debug)]
enum Directions {
    All,
    Along(Director),
    Across(Field<Vec3>),
}

impl KinematicGrowth {
    /// Name in case files of growth in all directions.
    pub const NAME: &str = "growth";
    /// The same along a direction.
    pub const ALONG: &str = "stretch_along";
    /// The same in the plane across a direction.
    pub const ACROSS: &str = "area_growth";
    const SLOTS: [Slot; 1] = [Slot::scalar("growth", "1")];
    const SLOTS_WITH_DIRECTION: [Slot; 4] = with_direction(Self::SLOTS[0]);

    /// In all directions.
    pub const fn isotropic() -> Self {
        KinematicGrowth(Directions::All)
    }

    /// Along unit vectors.
    ///
    /// # Errors
    /// [`EnergyError::Direction`] with the first vector that is not a unit vector, and where it is.
    pub fn along(a: impl Into<Field<Vec3>>) -> Result<Self, EnergyError> {
        Ok(KinematicGrowth(Directions::Along(Director::new(a, Self::ALONG)?)))
    }

    /// In the planes across unit vectors.
    ///
    /// # Errors
    /// As [`along`](Self::along).
    pub fn across(n: impl Into<Field<Vec3>>) -> Result<Self, EnergyError> {
        Ok(KinematicGrowth(Directions::Across(n.into().unit_directions(Self::ACROSS, "normal")?)))
    }
}

impl StrainMap for KinematicGrowth {
    fn tensor(&self, at: MaterialPoint, slots: &[HyperDual]) -> [[HyperDual; 3]; 3] {
        let constant = |m: Mat3| entries(|i, k| HyperDual::constant(m[(i, k)]));
        let pattern = match &self.0 {
            Directions::All => constant(Mat3::identity()),
            Directions::Along(a) => a.dyad(at, slots),
            Directions::Across(n) => constant(Mat3::identity() - n.at(at) * n.at(at).transpose()),
        };
        let g = leaving_lengths(slots.first().copied().unwrap_or(HyperDual::constant(0.0)));
        entries(|i, k| identity(i, k) + g * pattern[i][k])
    }

    fn limit(&self) -> &'static str {
        "growth must stay above -1, where nothing is left of a length"
    }

    fn direction(&self, at: MaterialPoint) -> Option<Vec3> {
        match &self.0 {
            Directions::All => None,
            Directions::Along(a) => a.fixed(at),
            Directions::Across(n) => Some(n.at(at)),
        }
    }

    fn default_bounds(&self, _: usize) -> [f64; 2] {
        [LEAST_GROWTH, f64::INFINITY]
    }
}

/// It has no energy of its own.
impl EnergyTerm for KinematicGrowth {
    strain_map_alone!();

    fn with_direction_slots(&self) -> Option<Arc<dyn EnergyTerm>> {
        let Directions::Along(a) = &self.0 else { return None };
        Some(Arc::new(KinematicGrowth(Directions::Along(a.as_slots()))))
    }

    fn slots(&self) -> &[Slot] {
        match &self.0 {
            Directions::Along(a) if a.is_slot => &Self::SLOTS_WITH_DIRECTION,
            _ => &Self::SLOTS,
        }
    }

    fn rest(&self, at: MaterialPoint, slot: usize) -> f64 {
        if let Directions::Along(a) = &self.0 { a.rest(at, slot) } else { 0.0 }
    }

    fn check(&self, cells: usize, points: usize) -> Result<(), EnergyError> {
        match &self.0 {
            Directions::All => Ok(()),
            Directions::Along(a) => a.check(cells, points),
            Directions::Across(n) => n.check_len(Self::ACROSS, "normal", cells, points),
        }
    }
}
