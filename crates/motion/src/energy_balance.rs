//! [`EnergyBalance`] and [`EnergyLedger`]: where the energy of a motion comes from and where it goes.

use crate::force_families::{Ended, ForceFamilies, Resultant, growth_work};
use crate::scheme::Scheme;
use nalgebra::Vector3;
use nastic_body::controls::Controls;
use nastic_body::error::{FemError, Inadmissible};
use nastic_body::state::State;
use nastic_equilibrium::model::Model;
use nastic_linear::SparseMatrix;
use nastic_numeric::vector::{axpy, sub};

/// Energies of a state of a motion, and what was done and lost since t = 0 (J; in plane strain J/m):
///
/// ```text
/// kinetic + elastic + contact + viscous_loss + friction_loss
///     = their values at t = 0 + load_work + pressure_work + drive_work + support_work + obstacle_work + scheme + unbalanced
/// ```
///
/// Works and losses of a step are those of the mean of the forces at its two ends over the change of the displacement; the loss by friction that of its
/// forces at the end, which oppose the motion of the step where those before may have opposed another one.
/// `scheme` is what the time scheme adds (above zero) or takes. Of schemes whose ends are equilibria of inertia and forces it is
///
/// ```text
/// dT - (M a_n + M a_{n+1})/2 . du + dE - (f_n + f_{n+1})/2 . du + (r_{n+1} - r_n)/2 . du
/// ```
///
/// with f the forces of what stores the energy E, r those of friction, and `unbalanced`, which the residuals that solves leave make, is zero to their accuracy. Of others
/// `scheme` is the remainder that closes the sum.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct EnergyBalance {
    /// `v . M v / 2`; zero of a motion without inertia.
    pub kinetic: f64,
    /// Stored without controls by laws, viscous branches, springs, foundations.
    pub elastic: f64,
    /// Stored in the layers of contacts.
    pub contact: f64,
    /// What viscous laws and Rayleigh damping have dissipated.
    pub viscous_loss: f64,
    /// What friction has dissipated.
    pub friction_loss: f64,
    /// Work of loads, constant ones and given ones.
    pub load_work: f64,
    /// Work of the fluid in chambers.
    pub pressure_work: f64,
    /// Work of actuations, tendons, and of what else controls drive.
    pub drive_work: f64,
    /// Work of surfaces that are held and moved.
    pub support_work: f64,
    /// Work of obstacles that move.
    pub obstacle_work: f64,
    /// What the time scheme has added.
    pub scheme: f64,
    /// What is left.
    pub unbalanced: f64,
}

impl EnergyBalance {
    /// The names of its entries, in their order.
    pub const NAMES: [&'static str; 12] = [
        "kinetic",
        "elastic",
        "contact",
        "viscous_loss",
        "friction_loss",
        "load_work",
        "pressure_work",
        "drive_work",
        "support_work",
        "obstacle_work",
        "scheme",
        "unbalanced",
    ];

    /// How many of its entries are those of physics, which the share of the scheme is measured against.
    pub const PHYSICAL: usize = 10;

    /// Its entries in the order of [`NAMES`](Self::NAMES).
    #[must_use]
    pub fn entries(&self) -> [f64; 12] {
        [
            self.kinetic,
            self.elastic,
            self.contact,
            self.viscous_loss,
            self.friction_loss,
            self.load_work,
            self.pressure_work,
            self.drive_work,
            self.support_work,
            self.obstacle_work,
            self.scheme,
            self.unbalanced,
        ]
    }

    /// From its entries.
    #[must_use]
    pub fn from_entries(entries: [f64; 12]) -> Self {
        let [
            kinetic,
            elastic,
            contact,
            viscous_loss,
            friction_loss,
            load_work,
            pressure_work,
            drive_work,
            support_work,
            obstacle_work,
            scheme,
            unbalanced,
        ] = entries;
        EnergyBalance {
            kinetic,
            elastic,
            contact,
            viscous_loss,
            friction_loss,
            load_work,
            pressure_work,
            drive_work,
            support_work,
            obstacle_work,
            scheme,
            unbalanced,
        }
    }

    /// Energies that a state has.
    fn held(&self) -> f64 {
        self.kinetic + self.elastic + self.contact
    }

    /// Energies less what was done, with what was lost: constant but for what the scheme adds and what is unbalanced.
    fn accounted(&self) -> f64 {
        self.held() + self.viscous_loss + self.friction_loss
            - (self.load_work + self.pressure_work + self.drive_work + self.support_work + self.obstacle_work)
    }
}

/// Writes down the [`EnergyBalance`] of a motion, state by state.
#[derive(Debug)]
pub struct EnergyLedger {
    /// Nothing of a motion without inertia.
    mass: Option<SparseMatrix>,
    /// Whether the ends of steps are equilibria of inertia and forces.
    ends_balanced: bool,
    balance: EnergyBalance,
    last: Option<Last>,
}

impl EnergyLedger {
    /// Of a motion of a model by a scheme, under the controls of its beginning: a mass that follows a design does not change in time.
    ///
    /// # Errors
    /// A mass that cannot be added up.
    pub fn new(model: &Model, scheme: &Scheme, controls: &Controls) -> Result<Self, FemError> {
        let mass = if scheme.is_quasi_static() { None } else { Some(model.energies().mass_under(controls)?) };
        let ends_balanced = scheme.ends_at_its_last_stage();
        Ok(EnergyLedger { mass, ends_balanced, balance: EnergyBalance::default(), last: None })
    }

    /// Goes on from a state that a step from another one led to, with what was written down there: to the bits of a ledger that had
    /// never stopped.
    ///
    /// # Errors
    /// [`Inadmissible`] where a displacement is.
    pub fn go_on(
        &mut self,
        model: &Model,
        before: Option<&State>,
        state: &State,
        balance: EnergyBalance,
    ) -> Result<(), Inadmissible> {
        let found = ForceFamilies::of(model, self.mass.as_ref(), before, state)?;
        let last = Last { before: before.cloned(), state: state.clone(), found };
        (self.balance, self.last) = (balance, Some(last));
        Ok(())
    }

    /// The balance at the next state.
    ///
    /// # Errors
    /// [`Inadmissible`] where the displacement is.
    pub fn add(&mut self, model: &Model, state: &State) -> Result<EnergyBalance, Inadmissible> {
        let before = self.last.as_ref().map(|last| &last.state);
        let found = ForceFamilies::of(model, self.mass.as_ref(), before, state)?;
        let mut next =
            EnergyBalance { kinetic: found.kinetic, elastic: found.elastic, contact: found.contact, ..self.balance };
        if let Some(Last { before, state: begin, found: last }) = &self.last {
            let from = Ended { before: before.as_ref(), state: begin };
            let grown = growth_work(model, from, Ended { before: Some(begin), state })?;
            self.step(model, &Step { before: begin, last, state, found: &found, grown }, &mut next);
        }
        let before = self.last.take().map(|last| last.state);
        (self.balance, self.last) = (next, Some(Last { before, state: state.clone(), found }));
        Ok(next)
    }

    /// Adds what a step does.
    fn step(&self, model: &Model, step: &Step, next: &mut EnergyBalance) {
        let du = sub(model.nodal(&step.state.u), model.nodal(&step.before.u));
        let space = model.unknowns();
        let work = |of: fn(&ForceFamilies) -> &Vec<f64>| -> f64 {
            let along = |families: &ForceFamilies| space.dot(&of(families)[..du.len()], &du);
            0.5 * (along(step.last) + along(step.found))
        };
        let [pressed, rubbed, rubbed_last] = step.work_of_obstacles();
        let lost = space.dot(&step.found.friction[..du.len()], &du) + rubbed_last;
        next.viscous_loss += step.found.dissipated + work(|f| &f.damping);
        next.friction_loss += lost;
        next.load_work -= work(|f| &f.loads);
        next.pressure_work -= work(|f| &f.pressures);
        next.drive_work += step.grown - work(|f| &f.drives);
        next.obstacle_work += pressed + rubbed;
        let inertia = self.mean_inertia(model, step);
        next.support_work += step.work_of_supports(model, &inertia, &du);
        let gap = next.accounted() - self.balance.accounted();
        let gained = |of: fn(&EnergyBalance) -> f64| of(next) - of(&self.balance);
        let formula = gained(|b| b.kinetic) - space.dot(&inertia[..du.len()], &du)
            + gained(|b| b.elastic)
            + step.found.dissipated
            - step.grown
            - work(|f| &f.stored)
            + gained(|b| b.contact)
            - work(|f| &f.pressing)
            - pressed
            + lost
            - (work(|f| &f.friction) + rubbed);
        let scheme = if self.ends_balanced { formula } else { gap };
        next.scheme += scheme;
        next.unbalanced += gap - scheme;
    }

    /// `(M a_n + M a_{n+1})/2`: where the step begins without an acceleration, that which balances the forces there; where it ends without one, the mean over the
    /// step.
    fn mean_inertia(&self, model: &Model, step: &Step) -> Vec<f64> {
        let len = step.state.u.len();
        let Some(mass) = &self.mass else { return vec![0.0; len] };
        let mean = || {
            let rate = |state: &State| state.velocity.as_ref().map_or(vec![0.0; len], |v| v.to_vec());
            let (dv, mut image) = (sub(&rate(step.state), &rate(step.before)), vec![0.0; len]);
            let dv = model.nodal(&dv);
            mass.multiply(dv, &mut image[..dv.len()]);
            image.iter_mut().for_each(|value| *value /= step.state.time - step.before.time);
            image
        };
        let (true, Some(end)) = (self.ends_balanced, &step.found.inertia) else { return mean() };
        let mut sum = end.clone();
        match &step.last.inertia {
            Some(begin) => axpy(1.0, begin, &mut sum),
            None => {
                let (forces, mean, fixed) = (step.last.total(), mean(), model.supports.fixed());
                for (i, value) in sum.iter_mut().enumerate().take(fixed.len()) {
                    *value = if fixed[i] { 2.0 * mean[i] } else { *value - forces[i] };
                }
            }
        }
        sum.iter_mut().for_each(|value| *value *= 0.5);
        sum
    }
}

/// A state of a motion, the one before it, and what was found there.
#[derive(Debug, Clone)]
struct Last {
    before: Option<State>,
    state: State,
    found: ForceFamilies,
}

/// A step between two states.
struct Step<'a> {
    before: &'a State,
    last: &'a ForceFamilies,
    state: &'a State,
    found: &'a ForceFamilies,
    /// Work of growth.
    grown: f64,
}

impl Step<'_> {
    /// By what presses, by friction, and by friction as at the end of the step.
    fn work_of_obstacles(&self) -> [f64; 3] {
        let (mut pressed, mut rubbed, mut rubbed_last) = (0.0, 0.0, 0.0);
        for (last, here) in self.last.obstacles.iter().zip(&self.found.obstacles) {
            let way = last.pose.way(&here.pose);
            pressed += mean_work(way, &last.pressing, &here.pressing);
            rubbed += mean_work(way, &last.friction, &here.friction);
            rubbed_last += mean_work(way, &here.friction, &here.friction);
        }
        [pressed, rubbed, rubbed_last]
    }

    /// Of reactions where supports hold the body.
    fn work_of_supports(&self, model: &Model, inertia: &[f64], du: &[f64]) -> f64 {
        let fixed = model.supports.fixed();
        if !(0..du.len()).any(|i| fixed[i] && du[i] != 0.0) {
            return 0.0;
        }
        let (last, here) = (self.last.total(), self.found.total());
        let at = |i: usize| (inertia[i] + 0.5 * (last[i] + here[i])) * du[i];
        (0..du.len()).filter(|i| fixed[*i]).map(at).sum()
    }
}

fn mean_work([way, turn]: [Vector3<f64>; 2], last: &Resultant, here: &Resultant) -> f64 {
    0.5 * ((last.force + here.force).dot(&way) + (last.moment + here.moment).dot(&turn))
}
