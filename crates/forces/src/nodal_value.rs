//! [`NodalValue`]: nodes at which a field has one value.

use crate::no_force::NoForce;
use nastic_body::contribution::Contribution;
use nastic_body::contribution::point::{ContributionPoint, Need};
use nastic_body::contribution::prescribes::Prescribes;
use nastic_body::contribution::sensitivities::Sensitivities;
use nastic_body::contribution::tied::Tied;
use nastic_body::controls::Controls;
use nastic_body::error::{FemError, Inadmissible};
use nastic_body::instant::Instant;
use nastic_energy::Slot;
use nastic_linear::Field;
use nastic_mesh::{GroupNames, Mesh};

/// A scalar field phi beside the displacement has one value on a surface or node set: `phi_a = m`, m a control (the voltage of an electrode), or `phi_a = phi_b`, a value
/// that is found such that what flows there adds up to zero (an electrode that floats).
///
/// The derivative of a functional j by m is `sum_a (j_phi + K^T lambda)_a`. A value that is found is the unknown of one of the nodes, which all others follow.
#[derive(Debug, Clone)]
pub struct NodalValue {
    name: String,
    field: Field,
    surface: GroupNames,
    slots: Vec<Slot>,
}

impl NodalValue {
    /// The value of a control; `slot` says what it is called, and its unit.
    pub fn driven(name: &str, field: Field, surface: impl Into<GroupNames>, slot: Slot) -> Self {
        NodalValue { slots: vec![slot], ..Self::floating(name, field, surface) }
    }

    /// One that is found.
    pub fn floating(name: &str, field: Field, surface: impl Into<GroupNames>) -> Self {
        NodalValue { name: name.to_owned(), field, surface: surface.into(), slots: Vec::new() }
    }

    /// The names of where it is.
    pub fn surface(&self) -> &GroupNames {
        &self.surface
    }

    /// The contribution on the nodes of the surface.
    ///
    /// # Errors
    /// No nodes; a field of several components.
    pub fn on(&self, mesh: &Mesh, nodes: Vec<u32>) -> Result<OneValue, FemError> {
        let [first, others @ ..] = &nodes[..] else {
            let what = format!("\"{}\" has no nodes to give a value to", self.name);
            return Err(FemError::Meaningless { what });
        };
        if let Some(beyond) = nodes.iter().find(|node| **node as usize >= mesh.points().len()) {
            let what = format!("\"{}\" gives a value to node {beyond} of {} nodes", self.name, mesh.points().len());
            return Err(FemError::Meaningless { what });
        }
        if self.field.components != 1 {
            let what = format!(
                "\"{}\" gives one value to the field \"{}\", which has {} components",
                self.name, self.field.name, self.field.components
            );
            return Err(FemError::Meaningless { what });
        }
        let follows = others.iter().map(|&node| (node, vec![(*first, 1.0)])).collect();
        let tied = Tied { field: Some(self.field.name.clone()), masters: vec![*first], implied: Vec::new(), follows };
        Ok(OneValue {
            name: self.name.clone(),
            fields: [self.field.clone()],
            slots: self.slots.clone(),
            dim: mesh.dim(),
            tied,
            nodes,
        })
    }
}

/// The contribution of a [`NodalValue`], which has no residual of its own.
#[derive(Debug)]
pub struct OneValue {
    name: String,
    fields: [Field; 1],
    /// One of a control, none of a value that is found.
    slots: Vec<Slot>,
    dim: usize,
    nodes: Vec<u32>,
    tied: Tied,
}

impl OneValue {
    /// Its unknowns in vectors of the displacement and its field.
    fn places(&self) -> impl Iterator<Item = usize> {
        self.nodes.iter().map(|&node| (self.dim + 1) * node as usize + self.dim)
    }
}

impl Prescribes for OneValue {
    fn unknowns(&self) -> Vec<u32> {
        self.places().map(|dof| dof as u32).collect()
    }

    fn prescribe(&self, at: &Instant, u: &mut [f64]) {
        self.places().for_each(|dof| u[dof] = at.control(0));
    }

    fn add_change(&self, at: &Instant, v: &Controls, du: &mut [f64]) {
        self.places().for_each(|dof| du[dof] += at.slot_of(v, 0));
    }

    fn vjp(&self, at: &Instant, force: &[f64], into: &mut Sensitivities) {
        into.add_control(at, 0, self.places().map(|dof| force[dof]).sum());
    }
}

impl Contribution for OneValue {
    fn name(&self) -> &str {
        &self.name
    }

    fn fields(&self) -> &[Field] {
        &self.fields
    }

    fn slots(&self) -> &[Slot] {
        &self.slots
    }

    /// The value.
    fn quantities(&self, at: &Instant) -> Vec<(&'static str, f64)> {
        self.places().take(1).map(|dof| ("value", at.u[dof])).collect()
    }

    fn prescribes(&self) -> Option<&dyn Prescribes> {
        if self.slots.is_empty() { None } else { Some(self) }
    }

    fn tied(&self) -> Option<&Tied> {
        self.slots.is_empty().then_some(&self.tied)
    }

    fn is_stiff(&self) -> bool {
        false
    }

    fn at<'a>(&'a self, _: &Instant, _: Need) -> Result<Box<dyn ContributionPoint + 'a>, Inadmissible> {
        Ok(Box::new(NoForce))
    }
}
