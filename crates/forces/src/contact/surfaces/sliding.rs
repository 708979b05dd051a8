//! How a sample with friction slides on the pieces that it is near to.
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

use super::gap::{Foot, Gap};
use super::stencil::{BeforeSurface, dual, unit};
use crate::contact::friction::share;
use crate::contact::law::Pressure;
use crate::contact::rubbing::Rubbing;
use crate::contact::stencil::{Feet, Stencil};
use nastic_tensor::Vec3;
use nastic_tensor::{HyperDual, Scalar};

/// A field of velocities of the slots, and the spin.
struct Motion<'v> {
    /// Of a velocity by the displacement.
    by_place: f64,
    slots: &'v [Vec3],
    /// Of the arms.
    rates: Vec<Vec3>,
    omega: Vec3,
}

/// The same of the slots of the potential, along two changes of the slots.
struct MotionAlong {
    slots: Vec<[HyperDual; 3]>,
    omega: [HyperDual; 3],
}

impl<'v> Motion<'v> {
    fn at(stencil: &BeforeSurface, slots: &'v [Vec3], by_place: f64) -> Self {
        let rates = arms(stencil.near, slots);
        let omega = stencil.spin.of(&rates);
        Motion { by_place, slots, rates, omega }
    }

    fn along(&self, stencil: &BeforeSurface, along: [&[Vec3]; 2]) -> MotionAlong {
        let c = self.by_place;
        let [one, two] = along.map(|along| {
            let of_arms = arms(stencil.near, along);
            let of_rates: Vec<Vec3> = of_arms.iter().map(|da| c * da).collect();
            stencil.spin.change(&self.rates, &of_arms, &of_rates)
        });
        let slot = |k: usize| dual(&self.slots[k], c, along.map(|along| &along[k]));
        MotionAlong {
            slots: (0..stencil.near_slots()).map(slot).collect(),
            omega: dual(&self.omega, 1.0, [&one, &two]),
        }
    }
}

impl Feet for BeforeSurface<'_> {
    type Slots = Vec<Vec3>;

    fn feet(&self) -> usize {
        self.feet.len()
    }

    fn part(&self, foot: usize) -> f64 {
        self.feet[foot].part
    }

    fn slides(&self, foot: usize, velocities: &Vec<Vec3>) -> Vec3 {
        let near: Vec<[f64; 3]> = velocities[..self.near_slots()].iter().map(|v| (*v).into()).collect();
        slides_on(&self.feet[foot], &near, self.spin.of(&arms(self.near, velocities)).into()).into()
    }

    fn spread_sliding(&self, force: impl Fn(usize) -> Vec3) -> Vec<Vec3> {
        let in_plane = |(k, foot): (usize, &Foot<'_, f64>)| {
            let (force, n) = (force(k), Vec3::from(foot.nearest.normal));
            (force - n * n.dot(&force)).into()
        };
        let forces: Vec<[f64; 3]> = self.feet.iter().enumerate().map(in_plane).collect();
        let mut out: Vec<Vec3> = on_near_slots(self, &self.feet, &forces).into_iter().map(Vec3::from).collect();
        let couple = out.pop().unwrap_or_default();
        let ring: Vec<Vec3> = self.spin.spread(&couple).collect();
        out[0] -= ring.iter().sum::<Vec3>();
        out.extend(ring);
        out
    }

    fn by_place(
        &self,
        pressure: &Pressure,
        fields: [&Vec<Vec3>; 2],
        phi: impl Fn([HyperDual; 3], [HyperDual; 3]) -> HyperDual,
    ) -> Vec<Vec3> {
        let motions = fields.map(|field| Motion::at(self, field, 0.0));
        self.gradient_of(self.places.len(), |along| {
            let (pressure, feet) = pressed(self, pressure, &self.along(along));
            let [v, w] = [0, 1].map(|k| motions[k].along(self, along));
            let slides = |foot: &Foot<'_, _>, field: &MotionAlong| slides_on(foot, &field.slots, field.omega);
            let of_foot = |foot: &Foot<'_, _>| foot.part * pressure * phi(slides(foot, &v), slides(foot, &w));
            feet.iter().map(of_foot).fold(HyperDual::of(0.0), |sum, more| sum + more)
        })
    }
}

/// The change of the forces along a change of the slots, with their velocities as in the step; 1 in the place of mu.
pub(super) fn change(friction: &Rubbing<BeforeSurface>, along: &[Vec3]) -> Vec<Vec3> {
    let motion = Motion::at(friction.stencil, &friction.velocities, friction.coulomb.rate);
    let [found, _] = changes(friction, &motion, [along, along]);
    found
}

/// The derivative of the forces by the slots, in columns.
pub(super) fn columns(friction: &Rubbing<BeforeSurface>) -> Vec<Vec<Vec3>> {
    let (dim, slots) = (friction.stencil.of.layer.dim, friction.stencil.places.len());
    let motion = Motion::at(friction.stencil, &friction.velocities, friction.coulomb.rate);
    let pair = |first: usize| {
        let [one, two] = [first, first + 1].map(|component| unit(dim, slots, component));
        changes(friction, &motion, [&one, &two])
    };
    let mut columns: Vec<Vec<Vec3>> = (0..dim * slots).step_by(2).flat_map(pair).collect();
    columns.truncate(dim * slots);
    columns
}

fn changes(friction: &Rubbing<BeforeSurface>, motion: &Motion, along: [&[Vec3]; 2]) -> [Vec<Vec3>; 2] {
    let (stencil, near) = (friction.stencil, friction.stencil.near_slots());
    let (pressure, feet) = pressed(stencil, &friction.pressure, &stencil.along(along));
    let field = motion.along(stencil, along);
    let force = |foot: &Foot<'_, HyperDual>| {
        let slides = slides_on(foot, &field.slots, field.omega);
        share(slides, friction.coulomb.slip_speed).map(|f| foot.part * pressure * f)
    };
    let forces: Vec<_> = feet.iter().map(force).collect();
    let found = on_near_slots(stencil, &feet, &forces);
    let part = |slot: usize, which: usize| Vec3::from_fn(|i, _| found[slot][i].0[which]);
    [0, 1].map(|which| {
        let mut out: Vec<Vec3> = (0..near).map(|slot| part(slot, which + 1)).collect();
        let (couple, of_couple) = (part(near, 0), part(near, which + 1));
        let ring: Vec<Vec3> =
            stencil.spin.spread_change(&couple, &of_couple, &arms(stencil.near, along[which])).collect();
        out[0] -= ring.iter().sum::<Vec3>();
        out.extend(ring);
        out
    })
}

/// The pressure and the feet at places.
fn pressed<'a>(
    stencil: &BeforeSurface<'a>,
    pressure: &Pressure,
    places: &[[HyperDual; 3]],
) -> (HyperDual, Vec<Foot<'a, HyperDual>>) {
    let (distance, feet) = stencil.near.near(places[0], &places[1..]);
    (pressure.along(distance - HyperDual::of(stencil.of.apart() + stencil.gap())), feet)
}

/// Forces on the slots of the potential and behind them the couple on the surface around the sample, by those at the feet.
fn on_near_slots<T: Scalar>(stencil: &BeforeSurface, feet: &[Foot<'_, T>], forces: &[[T; 3]]) -> Vec<[T; 3]> {
    let last = stencil.near_slots();
    let mut out = vec![[T::of(0.0); 3]; last + 1];
    for (foot, &force) in feet.iter().zip(forces) {
        out[0] = plus(out[0], force, T::of(1.0));
        let shares = foot.between.iter().zip(foot.nearest.shares);
        shares.for_each(|(&node, share)| out[node + 1] = plus(out[node + 1], force, T::of(0.0) - share));
        let arm = foot.nearest.normal.map(|n| foot.nearest.distance * n);
        out[last] = plus(out[last], cross(arm, force), T::of(-1.0));
    }
    out
}

/// From the sample to the corners around it.
pub(super) fn arms(near: &Gap, slots: &[Vec3]) -> Vec<Vec3> {
    slots[near.nodes.len() + 1..].iter().map(|corner| corner - slots[0]).collect()
}

/// v_t on a piece.
fn slides_on<T: Scalar>(foot: &Foot<'_, T>, velocities: &[[T; 3]], omega: [T; 3]) -> [T; 3] {
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
