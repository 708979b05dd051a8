use nastic_tensor::{HyperDual, Mat3, Vec3};

use super::StrainMap;
use super::strain_map::{LEAST_GROWTH, entries, identity, leaving_lengths, strain_map_alone};
use crate::director::Director;
use crate::{EnergyError, EnergyTerm, Field, MaterialPoint, PointBatch, Response, Slot, Slots, Want};

/// Thermal expansion by a given temperature; its conduction is not solved.
///
/// **Map.** `G = (1 + alpha dT) 1`, or `G = 1 + dT (alpha_along a (x) a + alpha_across (1 - a (x) a))` along and across a unit vector a. All laws of
/// its cells see `F G^-1`, see [`StrainMap`].
///
/// **Convexity.** Polyconvex where the laws are: `F -> F G^-1` is linear.
///
/// **Parameters.** alpha, the part by which lengths grow per kelvin (1/K), uniform or a [`Field`], negative of what shrinks in heat. Control `temperature` dT
/// in K: the difference to the temperature at which the body is free of stress.
///
/// **Source.** P. Chadwick, "Thermo-mechanics of rubberlike materials", Phil. Trans. R. Soc. A 276 (1974) 371-403; S. Vujosevic, V. A. Lubarda, "Finite-strain
/// thermoelasticity based on multiplicative decomposition of deformation gradient", Theor. Appl. Mech. 28-29 (2002) 379-399.
#[derive(Clone, Debug)]
pub struct ThermalExpansion {
    across: Field<f64>,
    along: Option<Along>,
}

#[derive(Clone, Debug)]
struct Along {
    alpha: Field<f64>,
    a: Director,
}

impl ThermalExpansion {
    /// Name in case files.
    pub const NAME: &str = "heat";
    const SLOTS: [Slot; 1] = [Slot::scalar("temperature", "K")];

    /// In all directions alike, alpha in 1/K.
    ///
    /// # Errors
    /// [`EnergyError::Parameter`] of a number that is not finite.
    pub fn isotropic(alpha: impl Into<Field<f64>>) -> Result<Self, EnergyError> {
        Ok(ThermalExpansion { across: finite(alpha, "expansion")?, along: None })
    }

    /// Along unit vectors `a` and across them, in 1/K.
    ///
    /// # Errors
    /// As [`isotropic`](Self::isotropic); [`EnergyError::Direction`] with the first vector that is not a unit vector, and where it is.
    pub fn along(
        a: impl Into<Field<Vec3>>,
        along: impl Into<Field<f64>>,
        across: impl Into<Field<f64>>,
    ) -> Result<Self, EnergyError> {
        let own = Along { alpha: finite(along, "expansion_along")?, a: Director::new(a, Self::NAME)? };
        Ok(ThermalExpansion { across: finite(across, "expansion_across")?, along: Some(own) })
    }
}

fn finite(alpha: impl Into<Field<f64>>, name: &'static str) -> Result<Field<f64>, EnergyError> {
    let alpha = alpha.into();
    alpha.require(ThermalExpansion::NAME, name, f64::is_finite, "it must be a finite number")?;
    Ok(alpha)
}

impl StrainMap for ThermalExpansion {
    fn tensor(&self, at: MaterialPoint, slots: &[HyperDual]) -> [[HyperDual; 3]; 3] {
        let difference = slots.first().copied().unwrap_or(HyperDual::constant(0.0));
        let part = |alpha: &Field<f64>| leaving_lengths(difference * HyperDual::constant(alpha.at(at)));
        let across = part(&self.across);
        let Some(own) = &self.along else { return entries(|i, k| identity(i, k) + across * identity(i, k)) };
        let (more, dyad) = (part(&own.alpha) - across, own.a.dyad(at, &[]));
        entries(|i, k| identity(i, k) + across * identity(i, k) + more * dyad[i][k])
    }

    fn limit(&self) -> &'static str {
        "1 + expansion * temperature must stay positive, or nothing is left of a length; a temperature is a difference to that without stress"
    }

    fn direction(&self, at: MaterialPoint) -> Option<Vec3> {
        self.along.as_ref()?.a.fixed(at)
    }

    /// A tenth of every length is left: `-0.9 / alpha` of the largest and of the least alpha.
    fn default_bounds(&self, _: usize) -> [f64; 2] {
        let all = std::iter::once(&self.across).chain(self.along.iter().map(|own| &own.alpha));
        let all = all.flat_map(|alpha| alpha.entries().map(|(_, value)| value));
        let [least, most] = all.fold([0.0_f64; 2], |[least, most], value| [least.min(value), most.max(value)]);
        let bound = |alpha: f64, none: f64| if alpha == 0.0 { none } else { LEAST_GROWTH / alpha };
        [bound(most, f64::NEG_INFINITY), bound(least, f64::INFINITY)]
    }
}

/// It has no energy of its own.
impl EnergyTerm for ThermalExpansion {
    strain_map_alone!();

    fn slots(&self) -> &[Slot] {
        &Self::SLOTS
    }

    fn check(&self, cells: usize, points: usize) -> Result<(), EnergyError> {
        match &self.along {
            None => self.across.check_len(Self::NAME, "expansion", cells, points),
            Some(own) => {
                self.across.check_len(Self::NAME, "expansion_across", cells, points)?;
                own.alpha.check_len(Self::NAME, "expansion_along", cells, points)?;
                own.a.check(cells, points)
            }
        }
    }
}
