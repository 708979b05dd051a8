use nastic_tensor::{HyperDual, Mat3, Vec3};

use super::StrainMap;
use crate::{EnergyError, EnergyTerm, Field, MaterialPoint, PointBatch, Response, Slot, Slots, Want};

/// Growth by one number: swelling, heat, shape memory, prestrain.
///
/// **Map.** `G = 1 + g S`: in all directions `S = 1`, along a unit vector `S = a (x) a`, across one `S = 1 - n (x) n`. All laws of its cells see
/// `F G^-1`, see [`StrainMap`]; a body that is free everywhere takes `F = G` without energy where G is compatible.
///
/// **Convexity.** Polyconvex where the laws are: `F -> F G^-1` is linear.
///
/// **Parameters.** a or n, unit vectors of the reference body, uniform or a [`Field`]; control `growth` g, a pure number above -1: 0.1 is a tenth longer.
/// In plane strain growth in all directions acts across the plane too.
///
/// **Source.** E. K. Rodriguez, A. Hoger, A. D. McCulloch, J. Biomech. 27 (1994) 455-467, doi 10.1016/0021-9290(94)90021-3.
#[derive(Clone, Debug)]
pub struct KinematicGrowth(Directions);

#[derive(Clone, Debug)]
enum Directions {
    All,
    Along(Field<Vec3>),
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

    /// In all directions.
    pub const fn isotropic() -> Self {
        KinematicGrowth(Directions::All)
    }

    /// Along unit vectors.
    ///
    /// # Errors
    /// [`EnergyError::Direction`] with the first vector that is not a unit vector, and where it is.
    pub fn along(a: impl Into<Field<Vec3>>) -> Result<Self, EnergyError> {
        Ok(KinematicGrowth(Directions::Along(a.into().unit_directions(Self::ALONG, "direction")?)))
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
    fn tensor(&self, at: MaterialPoint, g: &[HyperDual]) -> [[HyperDual; 3]; 3] {
        let pattern = match &self.0 {
            Directions::All => Mat3::identity(),
            Directions::Along(a) => a.at(at) * a.at(at).transpose(),
            Directions::Across(n) => Mat3::identity() - n.at(at) * n.at(at).transpose(),
        };
        let g = g.first().copied().unwrap_or(HyperDual::constant(0.0));
        // in a plane det G alone does not see that lengths have gone below zero
        let g = if g.real() > -1.0 { g } else { HyperDual::constant(f64::NAN) };
        let entry = |i: usize, k: usize| {
            HyperDual::constant(f64::from(u8::from(i == k))) + g * HyperDual::constant(pattern[(i, k)])
        };
        std::array::from_fn(|i| std::array::from_fn(|k| entry(i, k)))
    }
}

/// It has no energy of its own.
impl EnergyTerm for KinematicGrowth {
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

    fn slots(&self) -> &[Slot] {
        &Self::SLOTS
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

    fn check(&self, cells: usize, points: usize) -> Result<(), EnergyError> {
        match &self.0 {
            Directions::All => Ok(()),
            Directions::Along(a) => a.check_len(Self::ALONG, "direction", cells, points),
            Directions::Across(n) => n.check_len(Self::ACROSS, "normal", cells, points),
        }
    }

    fn strain_map(&self) -> Option<&dyn StrainMap> {
        Some(self)
    }
}
