//! How much samples slide, beside the slip speed, with derivatives.

use super::bound::{BoundContact, STIFFNESS};
use super::point::Gaps;
use super::pose::ByPose;
use nastic_body::contribution::sensitivities::Sensitivities;
use nastic_body::error::Inadmissible;
use nastic_body::instant::Instant;
use nastic_tensor::Vec3;

/// `sum_s w_s P_s (|v_t| / e)^2q`, with `v_t = w - n (n . w)`, `w = v_s - v_o`. With `W = dn/dx`, `b = 2 q w_s P (|v_t|/e)^(2q-2) v_t / e^2`, its derivative by `v_t`,
/// `v_t . n = 0` and the arm y:
///
/// ```text
/// by v_s            b
/// by x_s            a + Omega x b,     a = w_s (|v_t|/e)^2q dP/dx - (n . w) W^T b
/// by a turn         -y x a - (n . w) n x b
/// ```
pub(super) fn add(
    of: &BoundContact,
    (at, e): (&Instant, f64),
    q: i32,
    by_u: &mut [f64],
    into: &mut Sensitivities,
) -> Result<f64, Inadmissible> {
    let gaps = Gaps::at(of, at)?;
    let spin = gaps.pose.spin_matrix();
    let (mut sum, mut by) = (0.0, ByPose::default());
    for touch in &gaps.touches {
        let (weight, n) = (of.samples.weights[touch.sample], Vec3::from(touch.distance.normal()));
        let push = of.traction(touch, &gaps.pose, at).push;
        let own = of.samples.of(touch.sample, of.dim, |dof| at.velocity(dof));
        let relative = own - gaps.pose.velocity(&touch.place);
        let along = n.dot(&relative);
        let slides = relative - n * along;
        let square = slides.norm_squared() / (e * e);
        let power = square.powi(q);
        sum += weight * push.value * power;
        let by_square = f64::from(q) * square.powi((q - 1).max(0));
        let b = 2.0 * weight * push.value * by_square / (e * e) * slides;
        let a = weight * power * push.change - along * (touch.distance.normal_change().transpose() * b);
        let (by_place, arm) = (a + spin * b, gaps.pose.arm(&touch.place));
        of.spread(touch.sample, &b, &mut into.velocity);
        of.spread(touch.sample, &by_place, by_u);
        by.velocity -= b;
        by.spin -= arm.cross(&b);
        by.translation -= by_place;
        by.turn -= arm.cross(&a) + along * n.cross(&b);
    }
    gaps.pose.add_vjp(at, &by, of.dim, into);
    into.add_control(at, STIFFNESS, sum / at.control(STIFFNESS));
    Ok(sum)
}
