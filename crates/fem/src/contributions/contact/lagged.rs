//! [`LaggedFriction`]: friction whose normal forces and tangent planes are taken elsewhere, so that it has a potential.

use super::bound::{BoundContact, FRICTION};
use super::friction::{Slip, dissipation};
use super::point::{Gaps, Touch};
use super::pose::Pose;
use crate::contributions::guides::add_element;
use crate::contributions::{Demand, Instant, Sums};
use crate::error::Inadmissible;
use nastic_linear::SparseMatrix;
use nastic_tensor::{Mat3, Vec3};

/// `sum_s w_s mu p_l F(|v_t|) / c_v`, with `v_t = (1 - n_l n_l^T)(v_s(u) - v_o)`, pressures p_l and normals n_l of another displacement:
/// its derivative is `sum_s w_s mu p_l N^T f(v_t)`, and it is convex in u.
pub(super) struct LaggedFriction<'a> {
    of: &'a BoundContact,
    gaps: Gaps,
    slip_speed: f64,
    /// mu p_l of every sample that touches there.
    strengths: Vec<f64>,
    pose: Pose,
    velocity: f64,
}

impl<'a> LaggedFriction<'a> {
    /// `None` where friction is not lagged.
    pub fn at(of: &'a BoundContact, at: &Instant) -> Result<Option<Self>, Inadmissible> {
        let (Some(step), Some(slip_speed)) = (at.step, of.slip_speed) else { return Ok(None) };
        let Some(lag) = &step.lag else { return Ok(None) };
        let slip_speed = lag.smoothing * slip_speed;
        let there = Instant { u: &lag.u, controls: &lag.controls, step: None, ..*at };
        let gaps = Gaps::at(of, &there)?;
        let strength = |touch: &Touch| at.control(FRICTION) * of.traction(touch, &gaps.pose, &there).pressure.value;
        let strengths = gaps.touches.iter().map(strength).collect();
        let (pose, velocity) = (Pose::at(at, of.centre), step.velocity.0);
        Ok(Some(LaggedFriction { of, gaps, slip_speed, strengths, pose, velocity }))
    }

    /// Calls with every sample that touches there: its weight times mu p_l, the projection on its tangent plane, its slip velocity.
    fn each(
        &self,
        at: &Instant,
        mut call: impl FnMut(usize, f64, Mat3, Vec3) -> Result<(), Inadmissible>,
    ) -> Result<(), Inadmissible> {
        for (touch, strength) in self.gaps.touches.iter().zip(&self.strengths) {
            let n = Vec3::from(touch.distance.normal);
            let own = self.of.samples.of(touch.sample, self.of.dim, |dof| at.velocity(dof));
            let plane = Mat3::identity() - n * n.transpose();
            let slides = plane * (own - self.pose.velocity(&touch.place));
            call(touch.sample, self.of.samples.weights[touch.sample] * strength, plane, slides)?;
        }
        Ok(())
    }

    pub fn add_residual(&self, at: &Instant, demand: Demand, sums: &mut Sums) -> Result<(), Inadmissible> {
        self.each(at, |sample, strength, _, slides| {
            if demand.energy && self.velocity > 0.0 {
                let energy = strength * dissipation(slides.norm(), self.slip_speed) / self.velocity;
                sums.energy += energy;
                sums.energy_scale += energy;
            }
            if demand.force {
                self.of.add_force(sample, strength * Slip::at(&slides, self.slip_speed).share, sums);
            }
            Ok(())
        })
    }

    pub fn add_tangent(&self, at: &Instant, tangent: &mut SparseMatrix) -> Result<(), Inadmissible> {
        self.each(at, |sample, strength, plane, slides| {
            let block = self.velocity * strength * plane * Slip::at(&slides, self.slip_speed).slope * plane;
            let parts = self.of.samples.parts(sample);
            let nodes: Vec<u32> = parts.iter().map(|(node, _)| *node).collect();
            add_element(&nodes, self.of.dim, tangent, |a, i, b, j| parts[a].1 * parts[b].1 * block[(i, j)])?;
            Ok(())
        })
    }

    pub fn add_tangent_product(&self, at: &Instant, v: &[f64], out: &mut [f64]) -> Result<(), Inadmissible> {
        self.each(at, |sample, strength, plane, slides| {
            let own = self.of.samples.of(sample, self.of.dim, |dof| v[dof]);
            let slope = Slip::at(&slides, self.slip_speed).slope;
            self.of.spread(sample, &(self.velocity * strength * (plane * slope * plane * own)), out);
            Ok(())
        })
    }
}
