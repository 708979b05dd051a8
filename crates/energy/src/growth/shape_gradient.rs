use nastic_tensor::{HyperDual, Mat3};

use super::StrainMap;
use super::strain_map::{entries, identity, strain_map_alone};
use crate::{EnergyError, EnergyTerm, MaterialPoint, PointBatch, Response, ShapeModes, Slot, Slots, Want};

/// The shape of the body itself by the gradient of a displacement field s of the drawn body at every point: the nodes move by s, and `X' = X + s` is what is free of stress.
///
/// **Map.** `G = 1 + grad s`, `G_ij = delta_ij + g_(d i + j)` with d = 2 or 3 rows of the body's dimension; what is said of it is as of [`ShapeModes`], whose span is that of a few fields.
///
/// **Parameters.** Slots g, d^2 at every point, pure numbers: designs, which do not ramp with loads. Whoever sets them takes care that they are the gradient of one field.
///
/// **Domain, convexity, source.** As of [`ShapeModes`].
#[derive(Clone, Debug)]
pub struct ShapeGradient {
    dim: usize,
    least_volume: f64,
}

const SLOT: Slot = Slot::design(ShapeGradient::GROUP, "1", 0.0);
const SLOTS: [Slot; 9] = [SLOT; 9];

impl ShapeGradient {
    /// Name of its slots.
    pub const GROUP: &str = "gradient";

    /// In a body of 2 or 3 dimensions, with a bound of det G from 0 to below 1; [`ShapeModes::LEAST_VOLUME`] where none is given.
    ///
    /// # Errors
    /// [`EnergyError::Parameter`] of another bound, [`EnergyError::ShapeModes`] of another dimension.
    pub fn new(dim: usize, least_volume: Option<f64>) -> Result<Self, EnergyError> {
        if !(2..=3).contains(&dim) {
            return Err(EnergyError::ShapeModes { why: format!("a body of {dim} dimensions has none") });
        }
        let least_volume = least_volume.unwrap_or(ShapeModes::LEAST_VOLUME);
        ShapeModes::check_least_volume(least_volume)?;
        Ok(ShapeGradient { dim, least_volume })
    }
}

impl StrainMap for ShapeGradient {
    fn tensor(&self, _: MaterialPoint, slots: &[HyperDual]) -> [[HyperDual; 3]; 3] {
        entries(|i, j| match i < self.dim && j < self.dim {
            true => identity(i, j) + slots[self.dim * i + j],
            false => identity(i, j),
        })
    }

    fn limit(&self) -> &'static str {
        ShapeModes::LIMIT
    }

    fn owner(&self) -> &'static str {
        ShapeModes::NAME
    }

    fn least_volume(&self) -> f64 {
        self.least_volume
    }

    fn is_shape(&self) -> bool {
        true
    }
}

/// It has no energy of its own.
impl EnergyTerm for ShapeGradient {
    strain_map_alone!();

    fn slots(&self) -> &[Slot] {
        &SLOTS[..self.dim * self.dim]
    }
}
