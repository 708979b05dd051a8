//! [`LaggedFriction`]: friction whose pressures, normals and places are taken elsewhere, so that it has a potential.

use super::bound::BoundContact;
use super::friction::{Coulomb, Elsewhere};
use super::point::{Acting, add_element, add_force};
use super::pose::{self, ByPose, Pose};
use super::rubbing::Rubbing;
use super::slots::{dot, scaled};
use super::stencil::{Counterpart, Stencil};
use nastic_body::contribution::sensitivities::Sensitivities;
use nastic_body::contribution::{Demand, Sums};
use nastic_body::error::Inadmissible;
use nastic_body::instant::Instant;
use nastic_linear::SparseMatrix;
use nastic_tensor::Vec3;

/// `sum_s w_s mu sum_i P_i F(|v_t,i|) / c_v`, with pressures, stiffness, feet and the map from velocities to `v_t` of another displacement and pose, velocities of
/// the instant: its derivative is the force of friction, and it is convex in u.
pub(super) struct LaggedFriction<'a, W: Counterpart> {
    of: &'a BoundContact<W>,
    state: W::State,
    u: &'a [f64],
    pose: Option<Pose>,
    acting: Acting<'a>,
    coulomb: Coulomb,
}

impl<'a, W: Counterpart> LaggedFriction<'a, W> {
    /// `None` where friction is not lagged.
    pub fn at(of: &'a BoundContact<W>, at: &Instant<'a>) -> Result<Option<Self>, Inadmissible> {
        let (Some(coulomb), Some(lag)) = (of.layer.coulomb(at), Elsewhere::of(at, of.layer.lagged)) else {
            return Ok(None);
        };
        let there = Instant { u: lag.u, controls: lag.controls, step: None, ..*at };
        let coulomb = Coulomb { slip_speed: lag.smoothing * coulomb.slip_speed, ..coulomb };
        let acting = Acting::with(of, at, there.control(of.layer.stiffness), Some(coulomb));
        let (state, pose) = (W::state(of, &there, false)?, of.layer.pose(&there));
        Ok(Some(LaggedFriction { of, state, u: lag.u, pose, acting, coulomb }))
    }

    /// Calls with the stencils in the layer there.
    pub fn each(&self, mut call: impl FnMut(&Rubbing<W::Stencil<'_>>)) {
        for stencil in W::stencils(self.of, &self.state, self.u) {
            if let Some(friction) = &self.acting.on(self.of, &stencil).friction {
                call(friction);
            }
        }
    }

    /// mu times the weight.
    pub fn strength(&self, friction: &Rubbing<W::Stencil<'_>>) -> f64 {
        friction.stencil.weight() * self.coulomb.coefficient
    }

    pub fn add_residual(&self, demand: Demand, sums: &mut Sums) {
        self.each(|friction| {
            let strength = self.strength(friction);
            if demand.energy && self.coulomb.rate > 0.0 {
                let energy = friction.dissipation(strength) / self.coulomb.rate;
                sums.energy += energy;
                sums.energy_scale += energy;
            }
            if demand.force {
                add_force(friction.stencil, &friction.forces(strength), sums);
            }
        });
    }

    pub fn add_tangent(&self, tangent: &mut SparseMatrix) -> Result<(), Inadmissible> {
        let mut added = Ok(());
        self.each(|friction| {
            if added.is_ok() {
                let element = friction.stencil.tangent_by_velocity(friction, self.strength(friction));
                added = add_element::<W>(&friction.stencil.nodes(), element, tangent);
            }
        });
        added
    }

    pub fn add_tangent_product(&self, v: &[f64], out: &mut [f64]) {
        self.each(|friction| {
            let stencil = friction.stencil;
            let along = stencil.slots(|dof| v[dof], &[Vec3::zeros(); 2]);
            let change = friction.by_velocity(&along, self.coulomb.rate * self.strength(friction));
            stencil.spread(&change, |dof, value| out[dof] += value);
        });
    }

    /// Adds `lambda . dr/dp`: by velocities, coefficient and the motion of a pose (`by`), and by displacement, pose and stiffness elsewhere, which
    /// are those that the step begins with.
    pub fn vjp(&self, lambda: &[f64], by: &mut ByPose, into: &mut Sensitivities) {
        let (mu, at, layer) = (self.coulomb.coefficient, &self.acting.at, &self.of.layer);
        let (mut there, mut work) = ([Vec3::zeros(); 2], 0.0);
        self.each(|friction| {
            let stencil = friction.stencil;
            let own = scaled(stencil.slots(|dof| lambda[dof], &[Vec3::zeros(); 2]), stencil.weight());
            work += dot(&own, &friction.forces(1.0));
            let by_velocity = friction.by_velocity(&own, mu);
            stencil.spread(&by_velocity, |dof, value| into.velocity[dof] += value);
            pose::add(&mut by.velocity, W::Stencil::of_pose(&by_velocity), 1.0);
            let by_place = scaled(friction.by_place(&own), mu);
            stencil.spread(&by_place, |dof, value| into.before.u[dof] += value);
            pose::add(&mut there, W::Stencil::of_pose(&by_place), 1.0);
        });
        if let Some(pose) = &self.pose {
            pose.add_vjp_before(at, &there, layer.dim, into);
        }
        into.before.add_control(at, layer.stiffness, mu * work / self.acting.stiffness);
        into.add_control(at, layer.friction(), work);
    }
}
