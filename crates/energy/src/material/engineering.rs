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

/// Checks the coefficients of `W = C10 (I1' - 3) + C01 (I2' - 3) + (J-1)^2 / D1`, with the invariants of `J^(-1/3) F`: the form in
/// which handbooks, papers and finite-element programs give rubbers (Abaqus Analysis User's Guide, "Hyperelastic behavior of
/// rubberlike materials"; G. A. Holzapfel, *Nonlinear Solid Mechanics* (2000), section 6.5). Its small-strain shear modulus is
/// `2 (C10 + C01)`, its bulk modulus `2 / D1`.
///
/// # Errors
/// Unless `C10 > 0`, `C01 >= 0`, `D1 > 0`.
pub fn check_rubber(
    owner: &'static str,
    c10: &Field<f64>,
    c01: Option<&Field<f64>>,
    d1: &Field<f64>,
) -> Result<(), EnergyError> {
    c10.require_positive(owner, "c10")?;
    if let Some(c01) = c01 {
        c01.require_non_negative(owner, "c01")?;
    }
    d1.require(
        owner,
        "d1",
        |d1| d1 > 0.0,
        "it must be positive: 0 would be incompressible, which this law cannot be; D1 = 0.01 / (C10 + C01) is Poisson's ratio 0.495",
    )
}

/// The bulk modulus `2 / D1`.
///
/// # Errors
/// Unless `D1 > 0`.
pub fn bulk_of_d1(owner: &'static str, d1: &Field<f64>) -> Result<Field<f64>, EnergyError> {
    let requirement = "it must be positive: 0 would be incompressible, which this law cannot be";
    d1.require(owner, "d1", |d1| d1 > 0.0, requirement)?;
    d1.try_map(|_, d1| Ok(2.0 / d1))
}
