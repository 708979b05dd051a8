//! Signs of modes, and bases of spaces of equal eigenvalues, that do not depend on the mesh.

use nastic_numeric::Random;
use nastic_numeric::vector::{axpy, dot};

/// Relative difference of eigenvalues that are taken for equal.
const EQUAL: f64 = 1e-6;

/// Turns the vectors of each eigenvalue within their span, so that the first is the only one with a part of a first reference function, positive, and so on: signs and
/// bases are those of the functions and not of the numbering. The functions are `cos(a . x + b)`, x from 0 to 1 along each side of the body, a and b seeded.
pub(super) fn refer(
    values: &[f64],
    vectors: &mut [Vec<f64>],
    masses: &[f64],
    positions: &[[f64; 3]],
    [low, high]: [[f64; 3]; 2],
) {
    let mut first = 0;
    while first < values.len() {
        let equal = |value: &f64| (value - values[first]).abs() <= EQUAL * values[first].abs();
        let count = values[first..].iter().take_while(|value| equal(value)).count().max(1);
        let mut random = Random::new(0);
        let mut turned: Vec<Vec<f64>> = Vec::with_capacity(count);
        let own = &mut vectors[first..first + count];
        for _ in 0..count {
            let a = [0; 3].map(|_| 3.0 * random.unit());
            let b = 3.0 * random.unit();
            let phase = |x: &[f64; 3]| {
                let along = |k: usize| if high[k] > low[k] { a[k] * (x[k] - low[k]) / (high[k] - low[k]) } else { 0.0 };
                b + along(0) + along(1) + along(2)
            };
            let weighted: Vec<f64> = positions.iter().zip(masses).map(|(x, mass)| mass * phase(x).cos()).collect();
            let parts: Vec<f64> = own.iter().map(|phi| dot(phi, &weighted)).collect();
            let mut image = vec![0.0; masses.len()];
            own.iter().zip(&parts).for_each(|(phi, part)| axpy(*part, phi, &mut image));
            for other in &turned {
                let share = image.iter().zip(other).zip(masses).map(|((x, y), mass)| x * y * mass).sum::<f64>();
                axpy(-share, other, &mut image);
            }
            let size = image.iter().zip(masses).map(|(x, mass)| x * x * mass).sum::<f64>().sqrt();
            if size > 0.0 {
                image.iter_mut().for_each(|x| *x /= size);
                turned.push(image);
            }
        }
        if turned.len() == count {
            own.iter_mut().zip(turned).for_each(|(own, turned)| *own = turned);
        }
        first += count;
    }
}
