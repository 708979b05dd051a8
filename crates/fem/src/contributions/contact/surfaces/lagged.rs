//! [`LaggedRubbing`]: friction of surfaces whose normal forces, nearest points and tangent planes are taken elsewhere, so that it has a potential.

use super::bound::{BoundSurfaces, FRICTION, STIFFNESS};
use super::point::SurfacePoint;
use super::rub::Rub;
use super::sample::unit;
use crate::contributions::contact::friction::dissipation;
use crate::contributions::{Demand, Instant, Sums};
use crate::error::Inadmissible;
use nastic_linear::SparseMatrix;
use nastic_tensor::Vec3;

/// `sum_s w_s mu sum_i pi_i p F(|v_t|) / c_v`, with pressures, pieces, normals, nearest points and spins as functions of another displacement: convex
/// in u.
pub(super) struct LaggedRubbing<'a> {
    point: SurfacePoint<'a>,
    at: Vec<f64>,
    slip_speed: f64,
    /// mu k
    strength: f64,
    /// c_v
    velocity: f64,
}

impl<'a> LaggedRubbing<'a> {
    /// `None` where friction is not lagged.
    pub fn at(of: &'a BoundSurfaces, at: &Instant) -> Result<Option<Self>, Inadmissible> {
        let (Some(step), Some(slip_speed)) = (at.step, of.slip_speed) else { return Ok(None) };
        let Some(lag) = &step.lag else { return Ok(None) };
        let point = SurfacePoint::new(of, of.gaps(&lag.u)?);
        let (slip_speed, velocity) = (lag.smoothing * slip_speed, step.velocity.0);
        let strength = at.control(FRICTION) * at.control(STIFFNESS);
        Ok(Some(LaggedRubbing { point, at: lag.u.to_vec(), slip_speed, strength, velocity }))
    }

    fn each(&self, mut call: impl FnMut(&Rub, f64)) {
        self.point.touching().for_each(|sample| call(&Rub::at(sample, &self.at), self.strength * sample.weight()));
    }

    pub fn add_residual(&self, at: &Instant, demand: Demand, sums: &mut Sums) {
        self.each(|rub, strength| {
            let velocities = rub.sample.slots(|dof| at.velocity(dof));
            if demand.energy && self.velocity > 0.0 {
                let of_foot = |foot| dissipation(rub.slides(foot, &velocities).norm(), self.slip_speed) * foot.pressure;
                let energy = strength * rub.feet.iter().map(of_foot).sum::<f64>() / self.velocity;
                sums.energy += energy;
                sums.energy_scale += energy;
            }
            if demand.force {
                let forces = rub.forces(at, self.slip_speed);
                rub.sample.spread(&forces, |dof, value| {
                    sums.force[dof] += strength * value;
                    sums.force_scale[dof] += (strength * value).abs();
                });
            }
        });
    }

    pub fn add_tangent(&self, at: &Instant, tangent: &mut SparseMatrix) {
        self.each(|rub, strength| {
            let (dim, velocities) = (self.point.of.dim, rub.sample.slots(|dof| at.velocity(dof)));
            let slots = velocities.len();
            let scale = self.velocity * strength;
            let column = |component: usize| {
                let found = rub.by_velocity(&velocities, self.slip_speed, &unit(dim, slots, component));
                found.into_iter().map(|force| scale * force).collect()
            };
            let columns: Vec<Vec<Vec3>> = (0..dim * slots).map(column).collect();
            tangent.add_beyond(&rub.sample.nodes(), rub.sample.block(&columns));
        });
    }

    pub fn add_tangent_product(&self, at: &Instant, v: &[f64], out: &mut [f64]) {
        self.each(|rub, strength| {
            let velocities = rub.sample.slots(|dof| at.velocity(dof));
            let found = rub.by_velocity(&velocities, self.slip_speed, &rub.sample.slots(|dof| v[dof]));
            rub.sample.spread(&found, |dof, value| out[dof] += self.velocity * strength * value);
        });
    }
}
