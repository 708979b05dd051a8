//! [`ContactPoint`]: a contact at one displacement.

use super::bound::BoundContact;
use super::friction::{Coulomb, Elsewhere};
use super::lagged::LaggedFriction;
use super::law::Pressure;
use super::pose::{self, ByPose, Pose};
use super::potential::{potential_changes, potential_seconds};
use super::rubbing::Rubbing;
use super::slots::{add_scaled, dot, scaled, zero};
use super::stencil::{Counterpart, Move, Stencil};
use nastic_body::contribution::point::ContributionPoint;
use nastic_body::contribution::sensitivities::{Increment, SecondSensitivities, Sensitivities};
use nastic_body::contribution::{Demand, Sums};
use nastic_body::controls::Controls;
use nastic_body::error::{Inadmissible, SecondDerivativeError};
use nastic_body::instant::Instant;
use nastic_linear::SparseMatrix;
use nastic_tensor::Vec3;
use rayon::prelude::*;
use std::borrow::Cow;

/// Number of stencils from which their tangents are computed by all threads.
const MIN_PARALLEL_STENCILS: usize = 256;

/// A [`BoundContact`] at one displacement.
pub(super) struct ContactPoint<'a, W: Counterpart> {
    of: &'a BoundContact<W>,
    state: W::State,
    pose: Option<Pose>,
}

/// What acts at stencils at an instant.
pub(super) struct Acting<'a> {
    pub at: Instant<'a>,
    /// k
    pub stiffness: f64,
    /// Friction, unless its normal forces are taken elsewhere.
    pub coulomb: Option<Coulomb>,
    /// Velocities of the slots of a pose.
    rates: [Vec3; 2],
}

impl<'a> Acting<'a> {
    pub fn of<W: Counterpart>(of: &BoundContact<W>, at: &Instant<'a>) -> Self {
        let coulomb = of.layer.coulomb(at).filter(|_| Elsewhere::of(at, of.layer.lagged).is_none());
        Self::with(of, at, at.control(of.layer.stiffness), coulomb)
    }

    /// With friction by the normal forces of the instant, also where it is lagged.
    pub fn sliding<W: Counterpart>(of: &BoundContact<W>, at: &Instant<'a>) -> Self {
        Self::with(of, at, at.control(of.layer.stiffness), of.layer.coulomb(at))
    }

    pub fn with<W: Counterpart>(
        of: &BoundContact<W>,
        at: &Instant<'a>,
        stiffness: f64,
        coulomb: Option<Coulomb>,
    ) -> Self {
        let rates = coulomb.and_then(|_| of.layer.pose(at)).map(|pose| pose.rates()).unwrap_or_default();
        Acting { at: *at, stiffness, coulomb, rates }
    }

    /// Calls with the stencils of a state in the layer.
    pub fn each<W: Counterpart>(
        &self,
        of: &BoundContact<W>,
        state: &W::State,
        mut call: impl FnMut(&Pressed<W::Stencil<'_>>),
    ) {
        for stencil in W::stencils(of, state, self.at.u).iter().filter(|stencil| stencil.touches(&of.layer)) {
            call(&self.on(of, stencil));
        }
    }

    /// At a stencil.
    pub fn on<'s, W: Counterpart, S: Stencil>(&self, of: &BoundContact<W>, stencil: &'s S) -> Pressed<'s, S> {
        let pressure = of.layer.pressure(self.stiffness, stencil.gap());
        let friction = self.coulomb.filter(|_| stencil.touches(&of.layer)).map(|coulomb| {
            let velocities = stencil.slots(|dof| self.at.velocity(dof), &self.rates);
            Rubbing { stencil, pressure, velocities, coulomb }
        });
        Pressed { stencil, pressure, friction }
    }
}

/// A stencil with what acts there, per area.
pub(super) struct Pressed<'s, S: Stencil> {
    pub stencil: &'s S,
    pub pressure: Pressure,
    pub friction: Option<Rubbing<'s, S>>,
}

impl<S: Stencil> Pressed<'_, S> {
    /// `P = p m`
    pub fn push(&self) -> f64 {
        self.pressure.value * self.stencil.steepness()
    }

    /// Forces of the residual on the slots, `factor` times.
    pub fn forces(&self, factor: f64) -> S::Slots {
        let mut forces = match &self.friction {
            Some(friction) => friction.forces(friction.coulomb.coefficient),
            None => zero(self.stencil),
        };
        for (force, by) in forces.as_mut().iter_mut().zip(self.stencil.gradient().as_ref()) {
            *force += -self.pressure.value * by;
        }
        scaled(forces, factor)
    }
}

/// Adds forces of the residual.
pub(super) fn add_force<S: Stencil>(stencil: &S, forces: &S::Slots, sums: &mut Sums) {
    stencil.spread(forces, |dof, force| {
        sums.force[dof] += force;
        sums.force_scale[dof] += force.abs();
    });
}

/// Adds an element matrix to a tangent.
pub(super) fn add_element<W: Counterpart>(
    nodes: &[u32],
    element: Vec<f64>,
    tangent: &mut SparseMatrix,
) -> Result<(), Inadmissible> {
    match W::COUPLES_BEYOND_PATTERN {
        true => tangent.add_beyond(nodes, element),
        false => tangent.add_pairs(nodes, &element)?,
    }
    Ok(())
}

impl<'a, W: Counterpart> ContactPoint<'a, W> {
    pub fn new(of: &'a BoundContact<W>, at: &Instant) -> Result<Self, Inadmissible> {
        Ok(ContactPoint { of, state: W::state(of, at, false)?, pose: of.layer.pose(at) })
    }

    /// The state at an instant, at which a pose may be another one.
    fn state(&self, at: &Instant) -> Result<Cow<'_, W::State>, Inadmissible> {
        match Pose::are_alike(&self.pose, &self.of.layer.pose(at)) {
            true => Ok(Cow::Borrowed(&self.state)),
            false => W::state(self.of, at, false).map(Cow::Owned),
        }
    }

    /// Calls with the stencils in the layer.
    fn each(&self, at: &Instant, mut call: impl FnMut(&Pressed<W::Stencil<'_>>, &Acting)) -> Result<(), Inadmissible> {
        let (state, acting) = (self.state(at)?, Acting::of(self.of, at));
        acting.each(self.of, &state, |pressed| call(pressed, &acting));
        Ok(())
    }
}

impl<W: Counterpart> ContributionPoint for ContactPoint<'_, W> {
    fn add_residual(&self, at: &Instant, demand: Demand, sums: &mut Sums) -> Result<(), Inadmissible> {
        if let Some(friction) = LaggedFriction::at(self.of, at)? {
            friction.add_residual(demand, sums);
        }
        self.each(at, |pressed, _| {
            let weight = pressed.stencil.weight();
            if demand.energy {
                let energy = weight * pressed.pressure.energy;
                sums.energy += energy;
                sums.energy_scale += energy.abs();
            }
            if demand.force {
                add_force(pressed.stencil, &pressed.forces(weight), sums);
            }
        })
    }

    fn add_tangent(&self, at: &Instant, tangent: &mut SparseMatrix) -> Result<(), Inadmissible> {
        if let Some(friction) = LaggedFriction::at(self.of, at)? {
            friction.add_tangent(tangent)?;
        }
        let (of, state, acting) = (self.of, self.state(at)?, Acting::of(self.of, at));
        let stencils = W::stencils(of, &state, at.u);
        let of_stencil = |stencil: &W::Stencil<'_>| {
            let Pressed { pressure, friction, .. } = acting.on(of, stencil);
            let value = if at.flat_contacts { 0.0 } else { pressure.value };
            stencil.tangent(&Pressure { value, ..pressure }, friction.as_ref())
        };
        let found: Vec<_> = match at.parallel && stencils.len() > MIN_PARALLEL_STENCILS {
            true => stencils.par_iter().map(of_stencil).collect(),
            false => stencils.iter().map(of_stencil).collect(),
        };
        let general = !tangent.is_symmetric();
        for (stencil, (element, aside)) in stencils.iter().zip(found) {
            let nodes = stencil.nodes();
            add_element::<W>(&nodes, element, tangent)?;
            if let Some(aside) = aside.filter(|_| general) {
                tangent.add_aside(&nodes, aside);
            }
        }
        Ok(())
    }

    fn add_tangent_product(&self, at: &Instant, v: &[f64], out: &mut [f64]) -> Result<bool, Inadmissible> {
        if let Some(friction) = LaggedFriction::at(self.of, at)? {
            friction.add_tangent_product(v, out);
        }
        self.each(at, |Pressed { stencil, pressure, friction }, _| {
            let along = stencil.slots(|dof| v[dof], &[Vec3::zeros(); 2]);
            let change = stencil.change(pressure, friction.as_ref(), &along);
            stencil.spread(&change, |dof, value| out[dof] += value);
        })?;
        Ok(true)
    }

    fn max_step(&self, at: &Instant, du: &[f64]) -> Result<f64, Inadmissible> {
        Ok(W::longest_move(self.of, &*self.state(at)?, at, &Move { way: du, to: None }))
    }

    fn vjp(&self, at: &Instant, lambda: &[f64], into: &mut Sensitivities) -> Result<(), Inadmissible> {
        let (of, mut by) = (self.of, ByPose::default());
        let (mut by_stiffness, mut by_friction) = (0.0, 0.0);
        if let Some(friction) = LaggedFriction::at(of, at)? {
            friction.vjp(lambda, &mut by, into);
        }
        self.each(at, |pressed, acting| {
            let Pressed { stencil, pressure, friction } = pressed;
            let own = scaled(stencil.slots(|dof| lambda[dof], &[Vec3::zeros(); 2]), stencil.weight());
            by_stiffness += dot(&own, &pressed.forces(1.0)) / acting.stiffness;
            if of.layer.moved.is_some() {
                let [change, _] = potential_changes(*stencil, pressure, [&own, &own]);
                pose::add(&mut by.place, W::Stencil::of_pose(&change), 1.0);
            }
            let Some(friction) = friction else { return };
            let mu = friction.coulomb.coefficient;
            by_friction += dot(&own, &friction.forces(1.0));
            let by_velocity = friction.by_velocity(&own, mu);
            stencil.spread(&by_velocity, |dof, value| into.velocity[dof] += value);
            if of.layer.moved.is_some() {
                pose::add(&mut by.velocity, W::Stencil::of_pose(&by_velocity), 1.0);
                pose::add(&mut by.place, W::Stencil::of_pose(&friction.by_place(&own)), mu);
            }
        })?;
        of.layer.add_pose_vjp(at, &by, into);
        into.add_control(at, of.layer.stiffness, by_stiffness);
        if of.layer.slip_speed.is_some() {
            into.add_control(at, of.layer.friction(), by_friction);
        }
        Ok(())
    }

    fn add_control_product(&self, at: &Instant, v: &Controls, out: &mut [f64]) -> Result<(), SecondDerivativeError> {
        self.refuse_friction("add_control_product")?;
        let pose = self.of.layer.pose(at).map(|pose| pose.change(at, v)).unwrap_or_default();
        let stiffer = at.slot_of(v, self.of.layer.stiffness);
        self.each(at, |pressed, acting| {
            let stencil = pressed.stencil;
            let along = stencil.slots(|_| 0.0, &pose);
            let [_, mut change] = potential_changes(stencil, &pressed.pressure, [&zero(stencil), &along]);
            add_scaled(&mut change, &pressed.forces(1.0), stiffer / acting.stiffness);
            stencil.spread(&scaled(change, stencil.weight()), |dof, value| out[dof] += value);
        })?;
        Ok(())
    }

    fn second_vjp(
        &self,
        at: &Instant,
        lambda: &[f64],
        along: &Increment,
        into: &mut SecondSensitivities,
    ) -> Result<(), SecondDerivativeError> {
        self.refuse_friction("second_vjp")?;
        let (layer, pose) = (&self.of.layer, self.of.layer.pose(at));
        let dk = at.slot_of(along.controls, layer.stiffness);
        let moved = pose.as_ref().map(|pose| pose.change(at, along.controls)).unwrap_or_default();
        let (mut by, mut by_change, mut by_stiffness) = ([Vec3::zeros(); 2], [Vec3::zeros(); 2], 0.0);
        self.each(at, |Pressed { stencil, pressure, .. }, acting| {
            let own = scaled(stencil.slots(|dof| lambda[dof], &[Vec3::zeros(); 2]), stencil.weight());
            let change = stencil.slots(|dof| along.u[dof], &moved);
            let ([of_own, of_change], mut mixed) = potential_seconds(*stencil, pressure, [&own, &change]);
            by_stiffness += dot(&own, &of_change) / acting.stiffness;
            add_scaled(&mut mixed, &of_own, dk / acting.stiffness);
            stencil.spread(&mixed, |dof, value| into.u[dof] += value);
            pose::add(&mut by, W::Stencil::of_pose(&of_own), 1.0);
            pose::add(&mut by_change, W::Stencil::of_pose(&mixed), 1.0);
        })?;
        if let Some(pose) = &pose {
            pose.add_second(at, along, layer.dim, [&by, &by_change], into);
        }
        into.add_control(at, layer.stiffness, by_stiffness);
        Ok(())
    }
}

impl<W: Counterpart> ContactPoint<'_, W> {
    fn refuse_friction(&self, method: &'static str) -> Result<(), SecondDerivativeError> {
        match self.of.layer.slip_speed {
            None => Ok(()),
            Some(_) => Err(SecondDerivativeError::Contribution { name: self.of.layer.name.clone(), method }),
        }
    }
}
