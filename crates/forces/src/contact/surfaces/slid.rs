//! [`Slid`]: how much a sample slides on the pieces near it, beside the slip speed.

use super::gap::slope;
use super::rub::{Motion, Rub, slides_on};
use super::sample::unit;
use nastic_body::instant::Instant;
use nastic_body::kernels::hyper_dual::{HyperDual, Scalar};
use nastic_tensor::Vec3;

/// `sum_i pi_i p (|v_t,i| / e)^2q` per unit of stiffness, and its derivatives by the slots.
pub(super) struct Slid {
    pub value: f64,
    /// At fixed velocities.
    pub by_place: Vec<Vec3>,
    pub by_velocity: Vec<Vec3>,
}

/// Of a sample, by a slip speed e and q.
pub(super) fn slid(rub: &Rub, at: &Instant, (e, q): (f64, i32)) -> Slid {
    let velocities = rub.sample.slots(|dof| at.velocity(dof));
    let by_velocity = rub.spread(|foot| {
        let slides = rub.slides(foot, &velocities);
        let by_square = f64::from(q) * (slides.norm_squared() / (e * e)).powi((q - 1).max(0));
        2.0 * foot.pressure * by_square / (e * e) * slides
    });
    let (dim, slots, motion) = (rub.sample.of.dim, velocities.len(), rub.given_motion(at));
    let (mut value, mut by_place) = (0.0, vec![Vec3::zeros(); slots]);
    for first in (0..dim * slots).step_by(2) {
        let along = [first, first + 1].map(|component| unit(dim, slots, component));
        let HyperDual([found, one, two, _]) = along_pair(rub, &motion, (e, q), [&along[0], &along[1]]);
        value = found;
        by_place[first / dim][first % dim] = one;
        if first + 1 < dim * slots {
            by_place[(first + 1) / dim][(first + 1) % dim] = two;
        }
    }
    Slid { value, by_place, by_velocity }
}

/// The sum, along two changes of the slots.
fn along_pair(rub: &Rub, motion: &Motion, (e, q): (f64, i32), along: [&[Vec3]; 2]) -> HyperDual {
    let (places, velocities, omega) = rub.duals(motion, along);
    let (of, (distance, feet)) = (rub.sample.of, rub.sample.gap.near(places[0], &places[1..]));
    let pressure = HyperDual::of(0.0) - slope(of.law, distance - HyperDual::of(of.apart()), of.thickness);
    feet.iter().fold(HyperDual::of(0.0), |sum, foot| {
        let slides = slides_on(foot, &velocities, omega);
        let square = (slides[0] * slides[0] + slides[1] * slides[1] + slides[2] * slides[2]) / HyperDual::of(e * e);
        sum + foot.part * pressure * (0..q).fold(HyperDual::of(1.0), |power, _| power * square)
    })
}
