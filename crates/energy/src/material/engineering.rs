//! Engineering constants, converted and checked once for all laws that take them.

use crate::{EnergyError, Field, combine};

/// Shear and bulk modulus of Young's modulus and Poisson's ratio: `E / (2 (1 + nu))`, `E / (3 (1 - 2 nu))`.
///
/// # Errors
/// Unless `E > 0` and `-1 < nu < 1/2`.
pub fn shear_bulk(
    owner: &'static str,
    young: &Field<f64>,
    poisson: &Field<f64>,
) -> Result<[Field<f64>; 2], EnergyError> {
    young.require_positive(owner, "young")?;
    poisson.require(owner, "poisson", |nu| nu > -1.0 && nu < 0.5, "it must lie between -1 and 1/2, ends excluded")?;
    combine(owner, [("young", young), ("poisson", poisson)], |_, [e, nu]| {
        Ok([e / (2.0 * (1.0 + nu)), e / (3.0 * (1.0 - 2.0 * nu))])
    })
}
