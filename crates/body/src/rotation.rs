//! Rotations by a vector theta: about its direction by its length.

use nastic_tensor::{Mat3, Vec3};

/// `R = 1 + a [theta] + b [theta]^2` (Rodrigues), `a = sin(phi) / phi`, `b = (1 - cos(phi)) / phi^2`, `phi = |theta|`.
pub fn rotation(theta: &Vec3) -> Mat3 {
    let [a, b, _] = coefficients(theta.norm());
    let cross = theta.cross_matrix();
    Mat3::identity() + a * cross + b * cross * cross
}

/// J with `dR = [J dtheta] R`: `J = 1 + b [theta] + c [theta]^2`, `c = (phi - sin(phi)) / phi^3`. Source: Simo & Vu-Quoc, Comput.
/// Methods Appl. Mech. Eng. 58 (1986), for rotations of beams.
pub fn spin(theta: &Vec3) -> Mat3 {
    let [_, b, c] = coefficients(theta.norm());
    let cross = theta.cross_matrix();
    Mat3::identity() + b * cross + c * cross * cross
}

/// The change of `J(theta)^T m` along a change of theta.
pub fn spin_transposed_change(theta: &Vec3, along: &Vec3, m: &Vec3) -> Vec3 {
    let phi = theta.norm();
    let ([_, b, c], [db, dc]) = (coefficients(phi), slopes(phi));
    let (t, a) = (theta.cross_matrix(), along.cross_matrix());
    let towards = theta.dot(along);
    let change = b * a + db * towards * t + c * (a * t + t * a) + dc * towards * (t * t);
    change.transpose() * m
}

/// The vector of a rotation by less than half a turn: the inverse of [`rotation`].
pub fn vector(r: &Mat3) -> Vec3 {
    let sine = Vec3::new(r[(2, 1)] - r[(1, 2)], r[(0, 2)] - r[(2, 0)], r[(1, 0)] - r[(0, 1)]) / 2.0;
    let phi = sine.norm().atan2((r.trace() - 1.0) / 2.0);
    sine / coefficients(phi)[0]
}

/// The inverse of [`spin`]: `J^-1 = 1 - [theta]/2 + d [theta]^2`, `d = (1 - phi cos(phi/2) / (2 sin(phi/2))) / phi^2`.
pub fn spin_inverse(theta: &Vec3) -> Mat3 {
    let phi = theta.norm();
    let [a, b, _] = coefficients(phi);
    // (1 - a/(2 b)) / phi^2; near zero by its series
    let d = if phi < 0.02 {
        let square = phi * phi;
        1.0 / 12.0 + square / 720.0 + square * square / 30_240.0
    } else {
        (1.0 - a / (2.0 * b)) / (phi * phi)
    };
    let cross = theta.cross_matrix();
    Mat3::identity() - 0.5 * cross + d * cross * cross
}

/// `b'/phi` and `c'/phi` of `b = (1 - cos(phi)) / phi^2`, `c = (phi - sin(phi)) / phi^3`.
fn slopes(phi: f64) -> [f64; 2] {
    const SERIES: f64 = 0.5;
    if phi < SERIES {
        // sum_(k >= 1) (-1)^k 2 k phi^(2 k - 2) / (2 k + m)!
        return [2u32, 3].map(|m| {
            let (mut factorial, mut power, mut sum) = ((1..=m).map(f64::from).product::<f64>(), -1.0, 0.0);
            for k in 1..9u32 {
                let n = f64::from(2 * k + m);
                factorial *= n * (n - 1.0);
                sum += power * f64::from(2 * k) / factorial;
                power *= -phi * phi;
            }
            sum
        });
    }
    let (sine, versine) = (phi.sin(), 1.0 - phi.cos());
    [(phi * sine - 2.0 * versine) / phi.powi(4), (phi * versine - 3.0 * (phi - sine)) / phi.powi(5)]
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Both sides of the change from a series to the closed form.
    #[test]
    fn inverses_and_changes_agree_with_differences() {
        for size in [1e-9, 0.01, 0.019, 0.021, 0.3, 0.49, 0.51, 1.7, 3.0] {
            let theta = size * Vec3::new(0.36, -0.48, 0.8);
            let (along, m) = (Vec3::new(0.3, 0.7, -0.2), Vec3::new(-0.4, 1.1, 0.6));
            assert!((vector(&rotation(&theta)) - theta).norm() < 1e-14 * size.max(1.0), "{size}");
            assert!((spin_inverse(&theta) * spin(&theta) - Mat3::identity()).norm() < 1e-12, "{size}");
            let h = 1e-3;
            let at = |s: f64| spin(&(theta + s * h * along)).transpose() * m;
            let expected = (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / (12.0 * h);
            let found = spin_transposed_change(&theta, &along, &m);
            assert!((found - expected).norm() < 1e-11, "{size}: {found} {expected}");
        }
    }
}
