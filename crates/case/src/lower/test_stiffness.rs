//! How stiff the material of a table of test data is, to see stresses in another unit.

use super::magnitude::likely;
use super::sizes::SOFT;
use nastic_fit::{Mode, Response, Test};
use nastic_language::number::short;

/// Deformations smaller than this say little of a modulus.
const SMALL: f64 = 1e-3;

/// What is doubtful in the stresses of a table, by its file.
pub(super) fn doubtful(test: &Test, file: &str) -> Option<String> {
    let mut moduli: Vec<f64> = test.points.iter().filter_map(|point| shear(test, *point)).collect();
    moduli.sort_by(f64::total_cmp);
    let young = 3.0 * moduli.get(moduli.len() / 2)?;
    (young > 0.0 && !SOFT.contains(&young)).then(|| {
        format!(
            "{file}: the stresses give a Young's modulus of about {} Pa, where silicones, gels and tissue have 1 kPa to 20 MPa{} The unit \
             stands in brackets behind the name of the column",
            short(young),
            likely(young, &SOFT, "Pa")
        )
    })
}

/// The shear modulus of a neo-Hookean body with this response: `P = mu (l - 1/l^2)` in tension, `mu (l - 1/l^5)` in two directions, `mu (l - 1/l^3)`
/// of a wide strip, `tau = mu g`.
fn shear(test: &Test, [x, y]: [f64; 2]) -> Option<f64> {
    let nominal = if test.response == Response::Cauchy { y / x } else { y };
    let (strain, stress) = match test.mode {
        Mode::Uniaxial => (x - x.powi(-2), nominal),
        Mode::Equibiaxial => (x - x.powi(-5), nominal),
        Mode::Planar => (x - x.powi(-3), nominal),
        Mode::SimpleShear => (x, y),
        Mode::Inflation { thickness_to_radius } => (x - x.powi(-5), y * x * x / (2.0 * thickness_to_radius)),
        Mode::Volumetric => return None,
    };
    (strain.abs() > SMALL).then_some(stress / strain).filter(|modulus| modulus.is_finite())
}
