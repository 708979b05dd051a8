//! Rotations by a vector theta: about its direction by its length.

use nastic_tensor::{Mat3, Vec3};

/// `R = 1 + a [theta] + b [theta]^2` (Rodrigues), `a = sin(phi) / phi`, `b = (1 - cos(phi)) / phi^2`, `phi = |theta|`.
pub(super) fn rotation(theta: &Vec3) -> Mat3 {
    let [a, b, _] = coefficients(theta.norm());
    let cross = theta.cross_matrix();
    Mat3::identity() + a * cross + b * cross * cross
}

/// J with `dR = [J dtheta] R`: `J = 1 + b [theta] + c [theta]^2`, `c = (phi - sin(phi)) / phi^3`. Source: Simo & Vu-Quoc, Comput.
/// Methods Appl. Mech. Eng. 58 (1986), for rotations of beams.
pub(super) fn spin(theta: &Vec3) -> Mat3 {
    let [_, b, c] = coefficients(theta.norm());
    let cross = theta.cross_matrix();
    Mat3::identity() + b * cross + c * cross * cross
}

/// `sin(phi) / phi`, `(1 - cos(phi)) / phi^2`, `(phi - sin(phi)) / phi^3`; by their series where the differences would lose digits.
fn coefficients(phi: f64) -> [f64; 3] {
    const SERIES: f64 = 0.5;
    if phi < SERIES {
        // sum_k (-phi^2)^k / (2 k + 1 + m)!, to 1e-17 of the first term
        return [1, 2, 3].map(|first: u32| {
            let (mut term, mut sum) = (1.0 / (1..=first).map(f64::from).product::<f64>(), 0.0);
            for k in 0..8u32 {
                sum += term;
                let next = f64::from(first + 2 * k);
                term *= -phi * phi / ((next + 1.0) * (next + 2.0));
            }
            sum
        });
    }
    [phi.sin() / phi, (1.0 - phi.cos()) / (phi * phi), (phi - phi.sin()) / phi.powi(3)]
}
