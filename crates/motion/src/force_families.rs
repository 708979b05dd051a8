//! [`ForceFamilies`]: energies and forces of a state, by what the energy balance counts them as.

use nastic_body::contribution::energy_role::EnergyRole;
use nastic_body::contribution::point::Need;
use nastic_body::contribution::touches::RigidPose;
use nastic_body::contribution::{Contribution, Demand, Sums};
use nastic_body::controls::Controls;
use nastic_body::error::Inadmissible;
use nastic_body::instant::{Instant, TimeStep};
use nastic_body::state::State;
use nastic_equilibrium::model::Model;
use nastic_linear::SparseMatrix;
use nastic_numeric::vector::{axpy, sub};
use nastic_tensor::Vec3;

const BOTH: Demand = Demand { energy: true, force: true };

/// Residual forces of a state in the step that led there, flat, by family, and the energies of the state.
#[derive(Debug, Clone)]
pub(crate) struct ForceFamilies {
    /// `v . M v / 2`
    pub kinetic: f64,
    /// Stored without loads by laws, branches and what else has a potential.
    pub elastic: f64,
    /// Of the layers of contacts.
    pub contact: f64,
    /// What viscous laws dissipated in the step that led there: twice h times the dissipation potential, which is quadratic in the rates.
    pub dissipated: f64,
    /// Of what stores energy; viscous stresses of laws are in it.
    pub stored: Vec<f64>,
    pub loads: Vec<f64>,
    pub pressures: Vec<f64>,
    pub drives: Vec<f64>,
    /// Of dashpots beside the laws.
    pub damping: Vec<f64>,
    /// Of contacts, without friction.
    pub pressing: Vec<f64>,
    pub friction: Vec<f64>,
    /// M a, where the state carries an acceleration.
    pub inertia: Option<Vec<f64>>,
    /// What every contact with an obstacle exerts on the body.
    pub obstacles: Vec<ObstacleForces>,
}

/// A state and the state before it, none where a motion begins.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ended<'a> {
    pub before: Option<&'a State>,
    pub state: &'a State,
}

impl Ended<'_> {
    /// The step that led there; its inertia is the mass matrix's.
    fn step(&self) -> TimeStep {
        let mut step = TimeStep::between(self.before.unwrap_or(self.state), self.state);
        step.acceleration = (0.0, vec![0.0; self.state.u.len()]);
        if self.before.is_none() {
            // nothing has moved yet: after a long time
            (step.dt, step.elapsed) = (f64::INFINITY, f64::INFINITY);
        }
        step
    }
}

/// The work of a growth that changes by `dg` in a step, by the trapezoidal rule: `(w_n + w_{n+1})/2` with `w = dE/dg dg` of the energy E that laws have in the step
/// that led to a state, as the difference over `g - dg/2` and `g + dg/2`, in which viscous parts are exact.
pub(crate) fn growth_work(model: &Model, from: Ended, to: Ended) -> Result<f64, Inadmissible> {
    let [begin, end] = [from.state, to.state].map(|state| model.unactuated(&state.controls));
    if !model.body.grows() || begin == end {
        return Ok(0.0);
    }
    let mut sum = 0.0;
    for (ended, own) in [(from, &begin), (to, &end)] {
        let step = ended.step();
        let at = Instant { parallel: true, load: 1.0, ..Instant::of(ended.state) }.in_step(&step);
        let at = Instant { u: model.nodal(at.u), space: model.unknowns(), ..at };
        for side in [1.0, -1.0] {
            let mut moved = own.clone();
            for k in 0..moved.len() {
                let change = end.values(k).iter().zip(begin.values(k));
                moved
                    .values_mut(k)
                    .iter_mut()
                    .zip(change)
                    .for_each(|(g, (end, begin))| *g += 0.5 * side * (end - begin));
            }
            sum += 0.5 * side * residual(&model.body, &at.under(&moved))?.energy;
        }
    }
    Ok(sum)
}

/// Forces of an obstacle on the body, and their moments about the place of its centre.
#[derive(Debug, Clone)]
pub(crate) struct ObstacleForces {
    pub pose: RigidPose,
    pub pressing: Resultant,
    pub friction: Resultant,
}

#[derive(Debug, Clone, Copy)]
pub(crate) struct Resultant {
    pub force: Vec3,
    pub moment: Vec3,
}

impl ForceFamilies {
    /// Of a state and the state before it; none where the motion begins. `mass` is nothing of a motion without inertia.
    ///
    /// # Errors
    /// [`Inadmissible`] where the displacement is.
    pub fn of(
        model: &Model,
        mass: Option<&SparseMatrix>,
        before: Option<&State>,
        state: &State,
    ) -> Result<Self, Inadmissible> {
        let step = Ended { before, state }.step();
        // motions are under full loads, also where the state that they begin at was found without
        let at = Instant { parallel: true, load: 1.0, ..Instant::of(state) }.in_step(&step);
        let passive = model.unactuated(&state.controls);
        let mut found = Self::without_forces(model, mass, state);
        found.add_body(model, state, &at, &passive)?;
        let nodal = Instant { u: model.nodal(at.u), space: model.unknowns(), ..at };
        axpy(1.0, &residual(&model.dead_load, &nodal)?.force, &mut found.loads);
        model.each_other(&at, |contribution, at| found.add(model, contribution, at, &passive))?;
        Ok(found)
    }

    fn without_forces(model: &Model, mass: Option<&SparseMatrix>, state: &State) -> Self {
        let none = || vec![0.0; state.u.len()];
        let product = |values: &[f64]| {
            mass.map(|mass| {
                let (nodal, mut image) = (model.nodal(values), none());
                mass.multiply(nodal, &mut image[..nodal.len()]);
                image
            })
        };
        let momentum = state.velocity.as_ref().and_then(|v| Some((v, product(v)?)));
        ForceFamilies {
            kinetic: momentum
                .map_or(0.0, |(v, momentum)| 0.5 * model.unknowns().dot(model.nodal(v), model.nodal(&momentum))),
            elastic: 0.0,
            contact: 0.0,
            dissipated: 0.0,
            stored: none(),
            loads: none(),
            pressures: none(),
            drives: none(),
            damping: none(),
            pressing: none(),
            friction: none(),
            inertia: state.acceleration.as_ref().and_then(|a| product(a)),
            obstacles: Vec::new(),
        }
    }

    /// Laws and actuations. With internal variables the energy of a step is the stored one at its end plus h times the dissipation potential.
    fn add_body(&mut self, model: &Model, state: &State, at: &Instant, passive: &Controls) -> Result<(), Inadmissible> {
        let at = Instant { u: model.nodal(at.u), space: model.unknowns(), ..*at };
        let own = residual(&model.body, &at.under(passive))?;
        axpy(1.0, &own.force, &mut self.stored);
        self.elastic += match model.memory().has_history() {
            false => own.energy,
            true => {
                let ended = model.memory().history_of_step(&model.memory().next_history(state, true)?, 0.0);
                let ended = Instant { step: None, remembered: &ended, ..at.under(passive) };
                let stored = residual(&model.body, &ended)?.energy;
                self.dissipated += 2.0 * (own.energy - stored);
                stored
            }
        };
        if *passive != *at.controls {
            axpy(1.0, &residual(&model.body, &at)?.force, &mut self.drives);
            axpy(-1.0, &own.force, &mut self.drives);
        }
        Ok(())
    }

    fn add(
        &mut self,
        model: &Model,
        contribution: &dyn Contribution,
        at: &Instant,
        passive: &Controls,
    ) -> Result<(), Inadmissible> {
        if contribution.touches().is_some() {
            return self.add_contact(model, contribution, at);
        }
        let family = match contribution.energy_role() {
            EnergyRole::Load => &mut self.loads,
            EnergyRole::Pressure => &mut self.pressures,
            EnergyRole::Drive => &mut self.drives,
            EnergyRole::Stored => return self.add_stored(contribution, at, passive),
        };
        axpy(1.0, &residual(contribution, at)?.force, family);
        Ok(())
    }

    fn add_stored(
        &mut self,
        contribution: &dyn Contribution,
        at: &Instant,
        passive: &Controls,
    ) -> Result<(), Inadmissible> {
        let at_rest = at.under(passive);
        let (still, own) =
            (residual(contribution, &Instant { step: None, ..at_rest })?, residual(contribution, &at_rest)?.force);
        self.elastic += still.energy;
        axpy(1.0, &still.force, &mut self.stored);
        axpy(1.0, &sub(&own, &still.force), &mut self.damping);
        if !contribution.slots().is_empty() && *passive != *at.controls {
            axpy(1.0, &sub(&residual(contribution, at)?.force, &own), &mut self.drives);
        }
        Ok(())
    }

    /// Friction acts in a step alone.
    fn add_contact(
        &mut self,
        model: &Model,
        contribution: &dyn Contribution,
        at: &Instant,
    ) -> Result<(), Inadmissible> {
        let still = residual(contribution, &Instant { step: None, ..*at })?;
        let friction = match contribution.path_dependence() {
            None => None,
            Some(_) => Some(sub(&residual(contribution, at)?.force, &still.force)),
        };
        if let Some(pose) = contribution.touches().and_then(|touches| touches.pose(at)) {
            let pivot = pose.pivot();
            let of = |force: &[f64]| Resultant::of(model, at.u, force, pivot);
            let (pressing, friction) = (of(&still.force), friction.as_deref().map_or(Resultant::NONE, of));
            self.obstacles.push(ObstacleForces { pose, pressing, friction });
        }
        self.contact += still.energy;
        axpy(1.0, &still.force, &mut self.pressing);
        friction.iter().for_each(|friction| axpy(1.0, friction, &mut self.friction));
        Ok(())
    }

    /// Of all families.
    pub fn total(&self) -> Vec<f64> {
        let mut sum = self.stored.clone();
        let others = [&self.loads, &self.pressures, &self.drives, &self.damping, &self.pressing, &self.friction];
        others.into_iter().for_each(|force| axpy(1.0, force, &mut sum));
        sum
    }
}

impl Resultant {
    const NONE: Resultant = Resultant { force: Vec3::new(0.0, 0.0, 0.0), moment: Vec3::new(0.0, 0.0, 0.0) };

    /// Of the forces on the body against residual forces on its nodes, about a point.
    fn of(model: &Model, u: &[f64], residual: &[f64], pivot: Vec3) -> Self {
        let (dim, mut sum) = (model.discretization().dim(), Self::NONE);
        for (a, x) in model.discretization().mesh().points().iter().enumerate() {
            let at = |values: &[f64]| Vec3::from_fn(|k, _| if k < dim { values[dim * a + k] } else { 0.0 });
            let force = -at(residual);
            if force != Vec3::zeros() {
                sum.force += force;
                sum.moment += (Vec3::from(*x) + at(u) - pivot).cross(&force);
            }
        }
        sum
    }
}

/// Energy and force of a contribution.
fn residual(contribution: &dyn Contribution, at: &Instant) -> Result<Sums, Inadmissible> {
    let mut sums = Sums::zero(at.u.len());
    contribution.at(at, Need::Residual)?.add_residual(at, BOTH, &mut sums)?;
    Ok(sums)
}
