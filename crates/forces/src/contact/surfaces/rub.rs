//! [`Rub`]: how a sample with friction slides on the pieces that it is near to.
//!
//! A piece i with the part `pi_i` in the least distance, its nearest point `y_i = sum_a b_a x_a`, the normal n and `r = x_s - y_i` bears
//! `pi_i` of the pressure. It is slid on at
//!
//! ```text
//! w = v_s - sum_a b_a v_a - omega x r,     v_t = (1 - n n^T) w
//! ```
//!
//! omega the [`Spin`] of the sample's own surface, which goes on to `y_i` as a rigid body would: a common rigid motion is no sliding,
//! however thick the layer is. A force F of the residual has the power `F . w`: F at the sample, `-b_a F` at the nodes of the piece, and the couple
//! `-r x F` on the surface around the sample, so that forces and moments cancel.

use super::gap::{Foot, slope};
use super::sample::{Sample, unit};
use super::spin::Spin;
use crate::contact::friction::{Slip, share};
use nastic_body::instant::Instant;
use nastic_body::kernels::hyper_dual::{HyperDual, Scalar};
use nastic_tensor::Vec3;

/// A sample before the pieces near it, at one displacement.
pub(super) struct Rub<'a> {
    pub sample: Sample<'a>,
    pub feet: Vec<RubFoot<'a>>,
    places: Vec<Vec3>,
    spin: Spin,
}

/// A piece that a sample slides on.
pub(super) struct RubFoot<'a> {
    /// What it bears of the pressure, per unit of stiffness.
    pub pressure: f64,
    /// `pi_i`
    pub part: f64,
    normal: Vec3,
    /// r
    arm: Vec3,
    shares: [f64; 3],
    between: &'a [usize],
}

/// Velocities of the slots at an instant, and the spin.
pub(super) struct Motion {
    /// Of a velocity by the displacement.
    by_place: f64,
    slots: Vec<Vec3>,
    /// Of the arms.
    rates: Vec<Vec3>,
    omega: Vec3,
}

impl<'a> Rub<'a> {
    pub fn at(sample: Sample<'a>, u: &[f64]) -> Self {
        let places = sample.places(u);
        let near: Vec<[f64; 3]> = places[..sample.near_slots()].iter().map(|x| (*x).into()).collect();
        let (distance, feet) = sample.gap.near(near[0], &near[1..]);
        let pressure = -slope(sample.of.law, distance - sample.of.apart(), sample.of.thickness);
        let feet = feet.into_iter().map(|foot| {
            let normal = Vec3::from(foot.nearest.normal);
            let (arm, shares) = (foot.nearest.distance * normal, foot.nearest.shares);
            RubFoot { pressure: foot.part * pressure, part: foot.part, normal, arm, shares, between: foot.between }
        });
        let spin = Spin::new(arms(&sample, &places), sample.of.dim);
        Rub { sample, feet: feet.collect(), spin, places }
    }

    /// v_t on a piece, linear in the velocities of the slots.
    pub fn slides(&self, foot: &RubFoot, velocities: &[Vec3]) -> Vec3 {
        let omega = self.spin.of(&arms(&self.sample, velocities));
        let below: Vec3 = foot.between.iter().zip(foot.shares).map(|(&node, share)| share * velocities[node + 1]).sum();
        in_plane(&(velocities[0] - below - omega.cross(&foot.arm)), &foot.normal)
    }

    /// Forces on the slots by a force within the plane of every piece: the transpose of [`Self::slides`].
    pub fn spread(&self, force: impl Fn(&RubFoot) -> Vec3) -> Vec<Vec3> {
        let mut out = vec![Vec3::zeros(); self.places.len()];
        let mut couple = Vec3::zeros();
        for foot in &self.feet {
            let force = in_plane(&force(foot), &foot.normal);
            out[0] += force;
            foot.between.iter().zip(foot.shares).for_each(|(&node, share)| out[node + 1] -= share * force);
            couple -= foot.arm.cross(&force);
        }
        let near = self.sample.near_slots();
        for (k, force) in self.spin.spread(&couple).enumerate() {
            out[near + k] += force;
            out[0] -= force;
        }
        out
    }

    /// Forces on the slots per unit of stiffness, coefficient and area.
    pub fn forces(&self, at: &Instant, slip_speed: f64) -> Vec<Vec3> {
        let velocities = self.sample.slots(|dof| at.velocity(dof));
        self.spread(|foot| foot.pressure * Slip::at(&self.slides(foot, &velocities), slip_speed).share)
    }

    /// The change of the forces along a change of the velocities of the slots, which is symmetric.
    pub fn by_velocity(&self, velocities: &[Vec3], slip_speed: f64, along: &[Vec3]) -> Vec<Vec3> {
        self.spread(|foot| {
            let slope = Slip::at(&self.slides(foot, velocities), slip_speed).slope;
            foot.pressure * slope * self.slides(foot, along)
        })
    }

    /// The derivative of the forces by the velocities of the slots, in columns: symmetric, of no negative work.
    pub fn columns_by_velocity(&self, velocities: &[Vec3], slip_speed: f64) -> Vec<Vec<Vec3>> {
        let (dim, slots) = (self.sample.of.dim, velocities.len());
        let column = |component: usize| self.by_velocity(velocities, slip_speed, &unit(dim, slots, component));
        (0..dim * slots).map(column).collect()
    }

    fn motion(&self, at: &Instant) -> Motion {
        let slots = self.sample.slots(|dof| at.velocity(dof));
        let rates = arms(&self.sample, &slots);
        let omega = self.spin.of(&rates);
        Motion { by_place: at.step.map_or(0.0, |step| step.velocity.0), slots, rates, omega }
    }

    /// With velocities that do not depend on the slots.
    pub fn given_motion(&self, at: &Instant) -> Motion {
        Motion { by_place: 0.0, ..self.motion(at) }
    }

    /// The change of the forces along a change of the slots, with their velocities as in the step.
    pub fn change(&self, at: &Instant, slip_speed: f64, along: &[Vec3]) -> Vec<Vec3> {
        let [found, _] = self.changes(&self.motion(at), slip_speed, [along, along]);
        found
    }

    /// The derivative of the forces by the slots, in columns.
    pub fn columns(&self, at: &Instant, slip_speed: f64) -> Vec<Vec<Vec3>> {
        self.columns_of(&self.motion(at), slip_speed)
    }

    /// The same with velocities that do not depend on the slots.
    pub fn columns_by_place(&self, at: &Instant, slip_speed: f64) -> Vec<Vec<Vec3>> {
        self.columns_of(&self.given_motion(at), slip_speed)
    }

    fn columns_of(&self, motion: &Motion, slip_speed: f64) -> Vec<Vec<Vec3>> {
        let (dim, slots) = (self.sample.of.dim, self.places.len());
        let pair = |first: usize| {
            let [one, two] = [first, first + 1].map(|component| unit(dim, slots, component));
            self.changes(motion, slip_speed, [&one, &two])
        };
        let mut columns: Vec<Vec<Vec3>> = (0..dim * slots).step_by(2).flat_map(pair).collect();
        columns.truncate(dim * slots);
        columns
    }

    /// Places and velocities of the slots of the potential, and omega, along two changes of the slots.
    pub fn duals(
        &self,
        motion: &Motion,
        along: [&[Vec3]; 2],
    ) -> (Vec<[HyperDual; 3]>, Vec<[HyperDual; 3]>, [HyperDual; 3]) {
        let (near, c) = (self.sample.near_slots(), motion.by_place);
        let of_omega = along.map(|along| {
            let of_arms = arms(&self.sample, along);
            let of_rates: Vec<Vec3> = of_arms.iter().map(|da| c * da).collect();
            self.spin.change(&motion.rates, &of_arms, &of_rates)
        });
        let dual = |x: &Vec3, by: f64, [a, b]: [&Vec3; 2]| -> [HyperDual; 3] {
            std::array::from_fn(|i| HyperDual([x[i], by * a[i], by * b[i], 0.0]))
        };
        let of_slots = |x: &[Vec3], by: f64| -> Vec<[HyperDual; 3]> {
            (0..near).map(|slot| dual(&x[slot], by, [&along[0][slot], &along[1][slot]])).collect()
        };
        let omega = dual(&motion.omega, 1.0, [&of_omega[0], &of_omega[1]]);
        (of_slots(&self.places, 1.0), of_slots(&motion.slots, c), omega)
    }

    fn changes(&self, motion: &Motion, slip_speed: f64, along: [&[Vec3]; 2]) -> [Vec<Vec3>; 2] {
        let near = self.sample.near_slots();
        let of_arms = along.map(|along| arms(&self.sample, along));
        let (places, velocities, omega) = self.duals(motion, along);
        let found = near_forces(&self.sample, (&places, &velocities, omega), slip_speed);
        let part = |slot: usize, which: usize| Vec3::from_fn(|i, _| found[slot][i].0[which]);
        [0, 1].map(|which| {
            let mut out: Vec<Vec3> = (0..near).map(|slot| part(slot, which + 1)).collect();
            let (couple, of_couple) = (part(near, 0), part(near, which + 1));
            let ring: Vec<Vec3> = self.spin.spread_change(&couple, &of_couple, &of_arms[which]).collect();
            out[0] -= ring.iter().sum::<Vec3>();
            out.extend(ring);
            out
        })
    }
}

/// From the sample to the corners around it.
fn arms(sample: &Sample, slots: &[Vec3]) -> Vec<Vec3> {
    slots[sample.near_slots()..].iter().map(|corner| corner - slots[0]).collect()
}

fn in_plane(v: &Vec3, n: &Vec3) -> Vec3 {
    v - n * n.dot(v)
}

/// Forces on the slots of the potential and behind them the couple on the surface around the sample, by places, velocities and omega; per unit
/// of stiffness, coefficient and area.
fn near_forces<T: Scalar>(
    sample: &Sample,
    (places, velocities, omega): (&[[T; 3]], &[[T; 3]], [T; 3]),
    slip_speed: f64,
) -> Vec<[T; 3]> {
    let zero = [T::of(0.0); 3];
    let mut out = vec![zero; sample.near_slots() + 1];
    let (distance, feet) = sample.gap.near(places[0], &places[1..]);
    let pressure = T::of(0.0) - slope(sample.of.law, distance - T::of(sample.of.apart()), sample.of.thickness);
    for foot in feet {
        let n = foot.nearest.normal;
        let arm = n.map(|n| foot.nearest.distance * n);
        let shares = || foot.between.iter().zip(foot.nearest.shares);
        let slides = slides_on(&foot, velocities, omega);
        let force = share(slides, slip_speed).map(|f| foot.part * pressure * f);
        out[0] = plus(out[0], force, T::of(1.0));
        shares().for_each(|(&node, share)| out[node + 1] = plus(out[node + 1], force, T::of(0.0) - share));
        let last = sample.near_slots();
        out[last] = plus(out[last], cross(arm, force), T::of(-1.0));
    }
    out
}

/// v_t on a piece.
pub(super) fn slides_on<T: Scalar>(foot: &Foot<'_, T>, velocities: &[[T; 3]], omega: [T; 3]) -> [T; 3] {
    let n = foot.nearest.normal;
    let shares = foot.between.iter().zip(foot.nearest.shares);
    let below = shares.fold([T::of(0.0); 3], |sum, (&node, share)| plus(sum, velocities[node + 1], share));
    let turned = cross(omega, n.map(|n| foot.nearest.distance * n));
    let relative: [T; 3] = std::array::from_fn(|i| velocities[0][i] - below[i] - turned[i]);
    let towards = relative[0] * n[0] + relative[1] * n[1] + relative[2] * n[2];
    plus(relative, n, T::of(0.0) - towards)
}

/// `a + s b`
fn plus<T: Scalar>(a: [T; 3], b: [T; 3], s: T) -> [T; 3] {
    std::array::from_fn(|i| a[i] + s * b[i])
}

fn cross<T: Scalar>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        a[j] * b[k] - a[k] * b[j]
    })
}
