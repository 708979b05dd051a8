//! [`LaggedRubbing`]: friction of surfaces whose normal forces, nearest points and tangent planes are taken elsewhere, so that it has a potential.

use super::bound::{BoundSurfaces, FRICTION, STIFFNESS};
use super::point::SurfacePoint;
use super::rub::Rub;
use crate::contact::friction::{Elsewhere, dissipation};
use nastic_body::contribution::sensitivities::Sensitivities;
use nastic_body::contribution::{Demand, Sums};
use nastic_body::error::Inadmissible;
use nastic_body::instant::Instant;
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
        let Some(lag) = Elsewhere::of(at, of.lagged) else { return Ok(None) };
        let point = SurfacePoint::new(of, of.gaps(lag.u)?);
        let (slip_speed, velocity) = (lag.smoothing * slip_speed, step.velocity.0);
        let strength = at.control(FRICTION) * at.control(STIFFNESS);
        Ok(Some(LaggedRubbing { point, at: lag.u.to_vec(), slip_speed, strength, velocity }))
    }

    /// Calls with every sample that touches there, and mu k times its area.
    pub fn each(&self, mut call: impl FnMut(&Rub, f64)) {
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
            let velocities = rub.sample.slots(|dof| at.velocity(dof));
            let columns = rub.columns_by_velocity(&velocities, self.slip_speed);
            let block = rub.sample.block(&columns).into_iter().map(|entry| self.velocity * strength * entry);
            tangent.add_beyond(&rub.sample.nodes(), block.collect());
        });
    }

    pub fn add_tangent_product(&self, at: &Instant, v: &[f64], out: &mut [f64]) {
        self.each(|rub, strength| {
            let velocities = rub.sample.slots(|dof| at.velocity(dof));
            let found = rub.by_velocity(&velocities, self.slip_speed, &rub.sample.slots(|dof| v[dof]));
            rub.sample.spread(&found, |dof, value| out[dof] += self.velocity * strength * value);
        });
    }

    /// Adds `lambda . dr/dp`: by velocities, coefficient and stiffness, and by the displacement where the step begins.
    pub fn vjp(&self, at: &Instant, lambda: &[f64], into: &mut Sensitivities) {
        let (mu, k, mut work) = (at.control(FRICTION), at.control(STIFFNESS), 0.0);
        self.each(|rub, strength| {
            let sample = &rub.sample;
            let [velocities, own] = [sample.slots(|dof| at.velocity(dof)), sample.slots(|dof| lambda[dof])];
            let on_own = |forces: &[Vec3]| forces.iter().zip(&own).map(|(force, own)| force.dot(own)).sum::<f64>();
            work += sample.weight() * on_own(&rub.forces(at, self.slip_speed));
            let by_velocity = rub.by_velocity(&velocities, self.slip_speed, &own);
            sample.spread(&by_velocity, |dof, value| into.velocity[dof] += strength * value);
            let columns = rub.columns_by_place(at, self.slip_speed);
            let mut by_place = vec![Vec3::zeros(); own.len()];
            let dim = self.point.of.dim;
            columns.iter().enumerate().for_each(|(k, column)| by_place[k / dim][k % dim] = on_own(column));
            sample.spread(&by_place, |dof, value| into.before.u[dof] += strength * value);
        });
        into.add_control(at, FRICTION, k * work);
        into.add_control(at, STIFFNESS, mu * work);
    }
}
