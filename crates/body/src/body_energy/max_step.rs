//! The longest step along which no point of a body is inverted.

use crate::body_energy::BodyEnergy;
use crate::error::Inadmissible;
use crate::kernels::cell_scratch::Scratch;
use crate::kernels::displaced::Displaced;
use crate::kernels::patch::Patch;
use nastic_tensor::{Kinematics, Mat3};

/// Patches of one task.
const CHUNK: usize = 128;

/// The longest step `s <= 1` along which no point loses more than nine tenths of its volume on the way:
/// `det(F + t G) >= det F / 10` for all `t` in `[0, s]`, with `G = grad du`.
///
/// The end of the step alone does not decide: a section reflected in two directions has J > 0 again.
///
/// The same holds of the determinant that laws see where their formulation projects it.
pub(crate) fn max_step(body: &BodyEnergy, from: Displaced, du: &[f64], parallel: bool) -> Result<f64, Inadmissible> {
    let mut least: f64 = 1.0;
    for (cells, patches) in body.groups() {
        let chunk = |patches: &[Patch]| -> Result<f64, Inadmissible> {
            let (mut scratch, mut least) = (Scratch::new(cells), 1.0_f64);
            for &patch in patches {
                let formulation = body.arithmetic_of(cells.first(patch));
                formulation.kinematics(body.discretization(), cells, patch, from, &mut scratch)?;
                scratch.change_by(cells, patch, du);
                let along = formulation.own(&scratch).iter().zip(&scratch.change);
                let volumes: Vec<[f64; 4]> = along.map(|(at, g)| volume_along(at, g)).collect();
                let projected = projected(&volumes, |values| formulation.projected(&scratch, values));
                least = volumes.iter().chain(&projected).fold(least, |least, volume| least.min(step_of(*volume)));
            }
            Ok(least)
        };
        let patches: Vec<Patch> = patches.iter().collect();
        for step in cells.map(&patches, CHUNK, parallel, chunk) {
            least = least.min(step?);
        }
    }
    Ok(least)
}

/// The condition of `max_step` at one point.
pub fn volume_step(at: &Kinematics, g: &Mat3) -> f64 {
    step_of(volume_along(at, g))
}

/// The coefficients of the cubic `det(F + t G)`.
fn volume_along(at: &Kinematics, g: &Mat3) -> [f64; 4] {
    [at.j(), at.h().dot(g), at.f().dot(&nastic_tensor::cofactor(g)), g.determinant()]
}

/// The coefficients of projected cubics; none where nothing is projected.
fn projected(volumes: &[[f64; 4]], project: impl Fn(&[f64]) -> Option<Vec<f64>>) -> Vec<[f64; 4]> {
    let coefficient = |k: usize| project(&volumes.iter().map(|volume| volume[k]).collect::<Vec<_>>());
    let [Some(a), Some(b), Some(c), Some(d)] = std::array::from_fn(coefficient) else { return Vec::new() };
    (0..volumes.len()).map(|q| [a[q], b[q], c[q], d[q]]).collect()
}

/// The longest `s <= 1` on which a cubic keeps a tenth of its value at zero, to a factor of two: the Bernstein coefficients of the
/// difference on `[0, s]` are positive.
fn step_of([volume, linear, quadratic, cubic]: [f64; 4]) -> f64 {
    let constant = 0.9 * volume;
    let mut s = 1.0;
    for _ in 0..50 {
        let (b, c, d) = (linear * s, quadratic * s * s, cubic * s * s * s);
        let bernstein = [constant + b / 3.0, constant + 2.0 * b / 3.0 + c / 3.0, constant + b + c + d];
        if bernstein.iter().all(|&coefficient| coefficient > 0.0) {
            break;
        }
        s *= 0.5;
    }
    s
}
