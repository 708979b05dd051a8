//! [`LaggedFriction`]: friction whose normal forces and tangent planes are taken elsewhere, so that it has a potential.

use super::bound::{BoundContact, FRICTION, STIFFNESS};
use super::friction::{Elsewhere, Slip, dissipation};
use super::law::Push;
use super::point::{Gaps, Touch};
use super::pose::{ByPose, Pose};
use crate::guides::add_element;
use nastic_body::contribution::sensitivities::Sensitivities;
use nastic_body::contribution::{Demand, Sums};
use nastic_body::error::Inadmissible;
use nastic_body::instant::Instant;
use nastic_linear::SparseMatrix;
use nastic_tensor::{Mat3, Vec3};

/// `sum_s w_s mu P_l F(|v_t|) / c_v`, with `v_t = (1 - n_l n_l^T)(v_s(u) - v_o(y_l))`, pressures P_l, normals n_l and arms y_l about the obstacle's pivot of
/// another displacement and pose: its derivative is `sum_s w_s mu P_l N^T f(v_t)`, and it is convex in u.
pub(super) struct LaggedFriction<'a> {
    of: &'a BoundContact,
    gaps: Gaps,
    slip_speed: f64,
    mu: f64,
    /// k there.
    stiffness: f64,
    /// P_l of every sample that touches there.
    pushes: Vec<Push>,
    pose: Pose,
    velocity: f64,
}

/// A sample that touches there.
pub(super) struct Rubbed<'t> {
    touch: &'t Touch,
    pub sample: usize,
    /// P_l
    pub push: Push,
    n: Vec3,
    /// y_l
    arm: Vec3,
    /// `v_s - v_o`
    relative: Vec3,
    /// v_t
    pub slides: Vec3,
}

impl<'a> LaggedFriction<'a> {
    /// `None` where friction is not lagged.
    pub fn at(of: &'a BoundContact, at: &Instant) -> Result<Option<Self>, Inadmissible> {
        let (Some(step), Some(slip_speed)) = (at.step, of.slip_speed) else { return Ok(None) };
        let Some(lag) = Elsewhere::of(at, of.lagged) else { return Ok(None) };
        let slip_speed = lag.smoothing * slip_speed;
        let there = Instant { u: lag.u, controls: lag.controls, step: None, ..*at };
        let gaps = Gaps::at(of, &there)?;
        let pushes = gaps.touches.iter().map(|touch| of.traction(touch, &gaps.pose, &there).push).collect();
        let (mu, stiffness) = (at.control(FRICTION), there.control(STIFFNESS));
        let (pose, velocity) = (Pose::at(at, of.centre), step.velocity.0);
        Ok(Some(LaggedFriction { of, gaps, slip_speed, mu, stiffness, pushes, pose, velocity }))
    }

    /// The samples that touch there.
    pub fn each<'s>(&'s self, at: &'s Instant) -> impl Iterator<Item = Rubbed<'s>> {
        self.gaps.touches.iter().zip(&self.pushes).map(|(touch, &push)| {
            let (n, sample) = (Vec3::from(touch.distance.normal()), touch.sample);
            let own = self.of.samples.of(sample, self.of.dim, |dof| at.velocity(dof));
            // the point that the sample was at has moved on with the obstacle
            let arm = self.gaps.pose.arm(&touch.place);
            let relative = own - self.pose.velocity_of(&arm);
            Rubbed { touch, sample, push, n, arm, relative, slides: relative - n * n.dot(&relative) }
        })
    }

    /// Weight times mu P_l.
    fn strength(&self, rubbed: &Rubbed) -> f64 {
        self.of.samples.weights[rubbed.sample] * self.mu * rubbed.push.value
    }

    /// The force of the residual on a sample.
    pub fn force(&self, rubbed: &Rubbed) -> Vec3 {
        self.strength(rubbed) * Slip::at(&rubbed.slides, self.slip_speed).share
    }

    /// The derivative of that by the displacement of the sample.
    fn tangent(&self, rubbed: &Rubbed) -> Mat3 {
        let plane = Mat3::identity() - rubbed.n * rubbed.n.transpose();
        self.velocity * self.strength(rubbed) * plane * Slip::at(&rubbed.slides, self.slip_speed).slope * plane
    }

    pub fn add_residual(&self, at: &Instant, demand: Demand, sums: &mut Sums) {
        for rubbed in self.each(at) {
            if demand.energy && self.velocity > 0.0 {
                let lost = dissipation(rubbed.slides.norm(), self.slip_speed);
                let energy = self.strength(&rubbed) * lost / self.velocity;
                sums.energy += energy;
                sums.energy_scale += energy;
            }
            if demand.force {
                self.of.add_force(rubbed.sample, self.force(&rubbed), sums);
            }
        }
    }

    pub fn add_tangent(&self, at: &Instant, tangent: &mut SparseMatrix) -> Result<(), Inadmissible> {
        for rubbed in self.each(at) {
            let block = self.tangent(&rubbed);
            let parts = self.of.samples.parts(rubbed.sample);
            let nodes: Vec<u32> = parts.iter().map(|(node, _)| *node).collect();
            add_element(&nodes, self.of.dim, tangent, |a, i, b, j| parts[a].1 * parts[b].1 * block[(i, j)])?;
        }
        Ok(())
    }

    pub fn add_tangent_product(&self, at: &Instant, v: &[f64], out: &mut [f64]) {
        for rubbed in self.each(at) {
            let own = self.of.samples.of(rubbed.sample, self.of.dim, |dof| v[dof]);
            self.of.spread(rubbed.sample, &(self.tangent(&rubbed) * own), out);
        }
    }

    /// Adds `lambda . dr/dp`: by velocities and the motion of the obstacle (`by`), and by displacement, pose and stiffness where the step begins.
    ///
    /// With `q = D lambda`, `W = dn/dx`, `b = mu P_l (1 - n n^T) q` and `t = mu P_l f(v_t)` the derivative by the place there is
    ///
    /// ```text
    /// a + Omega x b,    a = mu ((lambda . f) dP_l/dx - P_l W^T ((n . w) q + (n . q) w)),    w = v_s - v_o
    /// ```
    ///
    /// and by a turn of the obstacle there `-y_l x a - mu P_l ((n . w) n x q + (n . q) n x w)`.
    pub fn vjp(&self, at: &Instant, lambda: &[f64], by: &mut ByPose, into: &mut Sensitivities) {
        let spin = self.pose.spin_matrix();
        let (mut there, mut by_friction, mut by_stiffness) = (ByPose::default(), 0.0, 0.0);
        for rubbed in self.each(at) {
            let Rubbed { sample, n, arm, relative: w, push, .. } = rubbed;
            let weighted = self.of.samples.weights[sample] * self.of.samples.of(sample, self.of.dim, |dof| lambda[dof]);
            let slip = Slip::at(&rubbed.slides, self.slip_speed);
            let (q, work) = (slip.slope * weighted, weighted.dot(&slip.share));
            let (along, across) = (n.dot(&w), n.dot(&q));
            let by_velocity = self.mu * push.value * (q - n * across);
            self.of.spread(sample, &by_velocity, &mut into.velocity);
            by.velocity -= by_velocity;
            by.spin -= arm.cross(&by_velocity);
            by_friction += push.value * work;
            by_stiffness += self.mu * push.value * work / self.stiffness;
            let turn = rubbed.touch.distance.normal_change().transpose();
            let a = self.mu * (work * push.change - push.value * turn * (along * q + across * w));
            let by_place = a + spin * by_velocity;
            self.of.spread(sample, &by_place, &mut into.before.u);
            there.translation -= by_place;
            there.turn -= arm.cross(&a) + self.mu * push.value * n.cross(&(along * q + across * w));
        }
        self.gaps.pose.add_vjp_before(at, &there, self.of.dim, into);
        into.before.add_control(at, STIFFNESS, by_stiffness);
        into.add_control(at, FRICTION, by_friction);
    }
}
