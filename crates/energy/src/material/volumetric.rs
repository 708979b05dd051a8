//! The volumetric part of laws that split off the change of volume.

/// `U = kappa/4 (J^2 - 1 - 2 log J)` (Pa) and its first three derivatives: convex, infinite at `J = 0`, bulk modulus `kappa`.
///
/// J. C. Simo & T. J. R. Hughes, *Computational Inelasticity* (1998), section 9.2; `2 / kappa` is the D of Abaqus' Arruda-Boyce and
/// Holzapfel-Gasser-Ogden laws, `1/D ((J^2 - 1)/2 - log J)`.
#[inline]
pub fn volumetric(kappa: f64, j: f64) -> [f64; 4] {
    let half = 0.5 * kappa;
    let inverse = 1.0 / j;
    [
        half * (0.5 * (j * j - 1.0) - j.ln()),
        half * (j - inverse),
        half * (1.0 + inverse * inverse),
        -2.0 * half * inverse * inverse * inverse,
    ]
}
