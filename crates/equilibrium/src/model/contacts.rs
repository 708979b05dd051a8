//! What a model touches.

use super::Model;
use crate::model::views::Properties;
use nastic_body::contribution::point::Need;
use nastic_body::contribution::sensitivities::Sensitivities;
use nastic_body::contribution::touches::{Onsets, RigidPose, Touch, TouchParameters, Touches};
use nastic_body::contribution::{Contribution, Demand, Sums};
use nastic_body::controls::Controls;
use nastic_body::discretization::rigid_motions::FreeMotion;
use nastic_body::error::Inadmissible;
use nastic_body::instant::Instant;
use nastic_tensor::Vec3;
use std::collections::{BTreeMap, BTreeSet};
use std::convert::Infallible;
use std::sync::Arc;

/// A sum over the pressures of a contact, with its derivatives.
#[derive(Debug, Clone, PartialEq)]
pub struct Pressing {
    /// The sum.
    pub value: f64,
    /// By the displacement, flat.
    pub by_u: Vec<f64>,
    /// By the controls.
    pub by_controls: Controls,
}

/// A sum over a contact that depends on velocities, with its derivatives.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactSum {
    /// The sum.
    pub value: f64,
    /// By the displacement at fixed velocities, flat.
    pub by_u: Vec<f64>,
    /// By the velocities, and by the controls at both ends of the step.
    pub by_others: Sensitivities,
}

/// What the body of a model touches: [`Model::contacts`].
#[derive(Debug, Clone, Copy)]
pub struct Contacts<'a> {
    model: &'a Model,
}

impl Contacts<'_> {
    /// The pressure of contacts at the nodes (Pa), added up; `None` where no contribution touches anything.
    pub fn nodal_pressures(&self, at: &Instant) -> Option<Vec<f64>> {
        let mut sums: Option<Vec<f64>> = None;
        let nodes = self.model.discretization().mesh().points().len();
        self.model.each_touching(at, |_, touches, at| {
            let sums = sums.get_or_insert_with(|| vec![0.0; nodes]);
            touches.nodal_pressures(at).iter().for_each(|&(node, value)| sums[node as usize] += value);
        });
        sums
    }

    /// Where the obstacles are that the body touches, each once.
    pub fn poses(&self, at: &Instant) -> Vec<RigidPose> {
        let mut all: Vec<RigidPose> = Vec::new();
        self.model.each_touching(at, |_, touches, at| all.extend(touches.pose(at)));
        let mut seen = BTreeSet::new();
        all.retain(|pose| seen.insert(pose.name.clone()));
        all
    }

    /// What every contact carries, with its name; without those that cannot be where they are.
    pub fn touches(&self, at: &Instant) -> Vec<(String, Touch)> {
        let mut all = Vec::new();
        self.model
            .each_touching(at, |name, touches, at| all.extend(touches.told(at).map(|touch| (name.to_owned(), touch))));
        all
    }

    /// `sum_s w_s g(p_s)` over the pressures p of the samples of a contact, and its derivatives; `by` gives g and g'. `None` where no contact has that name. Between surfaces of
    /// bodies the sum of what samples press with says more than how: see [`pressures`](Self::pressures).
    ///
    /// # Errors
    /// [`Inadmissible`] where u is.
    pub fn pressing(
        &self,
        at: &Instant,
        name: &str,
        by: &dyn Fn(f64) -> [f64; 2],
    ) -> Option<Result<Pressing, Inadmissible>> {
        self.summed(at, name, |touches, at, by_u, into| touches.add_pressing(at, by, by_u, into))
    }

    /// The same of the reported pressures, those of [`nodal_pressures`](Self::nodal_pressures): `sum_c A_c g(P_c)` over their places, with half of
    /// the areas where two surfaces touch each other.
    ///
    /// # Errors
    /// [`Inadmissible`] where u is.
    pub fn pressures(
        &self,
        at: &Instant,
        name: &str,
        by: &dyn Fn(f64) -> [f64; 2],
    ) -> Option<Result<Pressing, Inadmissible>> {
        self.summed(at, name, |touches, at, by_u, into| touches.add_pressures(at, by, by_u, into))
    }

    fn summed(
        &self,
        at: &Instant,
        name: &str,
        add: impl Fn(&dyn Touches, &Instant, &mut [f64], &mut Sensitivities) -> Result<f64, Inadmissible>,
    ) -> Option<Result<Pressing, Inadmissible>> {
        let mut found = None;
        self.model.each_touching(at, |own, touches, at| {
            if own == name {
                let (mut by_u, mut into) = (vec![0.0; at.u.len()], Sensitivities::zero(self.model.controls(), at));
                let value = add(touches, at, &mut by_u, &mut into);
                found = Some(value.map(|value| Pressing { value, by_u, by_controls: into.controls }));
            }
        });
        found
    }

    /// `sum_s w_s p_s (|v_t| / e)^2q` over the samples of a contact at the end of a step ([`Instant::in_step`]), v_t the velocity that they slide with, e the slip
    /// speed; `None` where no contact with friction has that name.
    ///
    /// # Errors
    /// [`Inadmissible`] where u is.
    pub fn slipping(&self, at: &Instant, name: &str, q: u32) -> Option<Result<ContactSum, Inadmissible>> {
        let mut found = None;
        self.model.each_touching(at, |own, touches, at| {
            if own == name {
                let (mut by_u, mut into) = (vec![0.0; at.u.len()], Sensitivities::zero(self.model.controls(), at));
                let value = touches.add_slip(at, q, &mut by_u, &mut into).transpose();
                found = value.map(|value| value.map(|value| ContactSum { value, by_u, by_others: into }));
            }
        });
        found
    }

    /// The force of an obstacle on the body along a vector l, friction included: `-sum_a l . r_a` over the nodes a, r the residual of the contact, with its
    /// derivatives, which are `-K^T l` and those of `-l . r` by all else. With friction in a step ([`Instant::in_step`]). `None` where no contact with
    /// an obstacle has that name.
    ///
    /// # Errors
    /// [`Inadmissible`] where u is.
    pub fn resultant(&self, at: &Instant, name: &str, l: [f64; 3]) -> Option<Result<ContactSum, Inadmissible>> {
        let own = self.model.others.iter().zip(self.model.instants(at)).find(|(contribution, at)| {
            let pose =
                |touches: &dyn Touches| self.model.among_fields(contribution.as_ref(), at, |at| touches.pose(at));
            contribution.name() == name && contribution.touches().and_then(pose).is_some()
        });
        own.map(|(contribution, at)| self.pushing(contribution.as_ref(), &at, l))
    }

    fn pushing(&self, contact: &dyn Contribution, at: &Instant, l: [f64; 3]) -> Result<ContactSum, Inadmissible> {
        let (unknowns, dim) = (self.model.unknowns().len(), self.model.discretization().dim());
        let block = self.model.space.nodal() / self.model.discretization().mesh().points().len();
        let mut along = vec![0.0; unknowns];
        let nodes = along[..self.model.space.nodal()].chunks_exact_mut(block);
        nodes.for_each(|node| node.iter_mut().zip(&l[..dim]).for_each(|(entry, l)| *entry = -l));
        let (point, mut sums) = (self.model.point_of(contact, at, Need::Derivatives)?, Sums::zero(unknowns));
        point.add_residual(at, Demand { energy: false, force: true }, &mut sums)?;
        let (mut tangent, mut by_u) = (self.model.tangents().matrix(), vec![0.0; unknowns]);
        point.add_tangent(at, &mut tangent).map_err(|error| error.of(contact.name()))?;
        tangent.multiply_transposed(
            &along[..self.model.space.nodal()],
            &mut by_u[..self.model.space.nodal()],
            at.parallel,
        );
        let mut by_others = Sensitivities::zero(self.model.controls(), at);
        point.vjp(at, &along, &mut by_others)?;
        Ok(ContactSum { value: self.model.unknowns().dot(&along, &sums.force), by_u, by_others })
    }

    /// What the samples of all contacts do, one contact after the other; without those that cannot be where they are.
    pub fn onsets(&self, at: &Instant) -> Onsets {
        let mut all = Onsets::default();
        self.model.each_touching(at, |_, touches, at| {
            if let Some(found) = touches.onsets(at) {
                all.states.extend(found.states);
                all.near += found.near;
            }
        });
        all
    }

    /// What every contact is made of, with its name.
    pub fn parameters(&self) -> Vec<(String, TouchParameters)> {
        let own = |c: &Arc<dyn Contribution>| Some((c.name().to_owned(), c.touches()?.parameters()));
        self.model.others.iter().filter_map(own).collect()
    }
}

impl Model {
    /// What it touches.
    pub fn contacts(&self) -> Contacts<'_> {
        Contacts { model: self }
    }

    /// Free rigid motions at an instant of a body that is held by contact alone, along which it may roll or slide.
    pub(crate) fn free_motion(&self, at: &Instant) -> Option<FreeMotion> {
        if !self.touches_something() || self.ranks().is_over_ranks() || self.checks().is_held_without_contact() {
            return None;
        }
        let mut rows = Vec::new();
        let each = self.each_other(at, |contribution, at| match contribution.touches() {
            Some(touches) => touches.resists_at(at).map(|own| rows.extend(own)).ok_or(()),
            None => {
                rows.extend(contribution.resists().iter().cloned());
                Ok(())
            }
        });
        each.ok()?;
        self.supports.free(self.discretization(), Some(at.u), &rows.iter().collect::<Vec<_>>())
    }

    /// What supports aside may resist to motions in an equilibrium: a surface that may touch to all of its own, if that is the minimum of a potential. What then lies
    /// there may still slide or roll on ([`neutral_motion`](Self::neutral_motion)).
    pub(crate) fn may_resist(&self) -> Vec<Vec<(u32, f64)>> {
        let (dim, settles) =
            (self.discretization().dim(), self.properties().has_potential() && !self.ranks().is_over_ranks());
        let of = |contribution: &Arc<dyn Contribution>| match contribution.touches().filter(|_| settles) {
            Some(_) => contribution.resists().iter().flat_map(|row| along_axes(row, dim)).collect::<Vec<_>>(),
            None => contribution.resists().to_vec(),
        };
        self.others.iter().flat_map(of).collect()
    }

    /// Whether something is there that the body may touch.
    pub(crate) fn touches_something(&self) -> bool {
        self.others.iter().any(|other| other.touches().is_some())
    }

    pub(crate) fn each_touching(&self, at: &Instant, mut call: impl FnMut(&str, &dyn Touches, &Instant)) {
        let Ok(()) = self.each_other(at, |contribution, at| {
            if let Some(touches) = contribution.touches() {
                call(contribution.name(), touches, at);
            }
            Ok::<(), Infallible>(())
        });
    }
}

/// Of a motion of nodes along one direction, `sum_a w_a n . u_a`, those along each axis, `sum_a w_a e_i . u_a`.
fn along_axes(row: &[(u32, f64)], dim: usize) -> Vec<Vec<(u32, f64)>> {
    let mut nodes = BTreeMap::<u32, Vec3>::new();
    for (dof, weight) in row {
        nodes.entry(*dof / dim as u32).or_default()[*dof as usize % dim] += weight;
    }
    let Some(first) = nodes.values().find(|of| of.norm() > 0.0).copied() else { return Vec::new() };
    let weight = |of: &Vec3| of.dot(&first.normalize());
    let along =
        |axis: usize| nodes.iter().map(move |(node, of)| (dim as u32 * node + axis as u32, weight(of))).collect();
    (0..dim).map(along).collect()
}

impl Properties<'_> {
    /// Whether a step may be made as shorter ones: not where something is known at the beginning of the whole step alone, as internal variables, the
    /// normal forces of lagged friction, the accelerations of supports that move.
    pub fn goes_in_parts(&self) -> bool {
        let lagged = self.model.contacts().parameters().iter().any(|(_, touch)| touch.lagged);
        let prescribed = self.model.others.iter().any(|other| other.prescribes().is_some());
        self.model.touches_something() && !self.model.memory().has_history() && !lagged && !prescribed
    }
}
