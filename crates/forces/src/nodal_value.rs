//! [`NodalValue`]: nodes at which a field has one value.

use crate::no_force::NoForce;
use nastic_body::contribution::gathers::Gathers;
use nastic_body::contribution::point::{ContributionPoint, Need};
use nastic_body::contribution::prescribes::Prescribes;
use nastic_body::contribution::sensitivities::{Increment, SecondSensitivities, Sensitivities};
use nastic_body::contribution::tied::Tied;
use nastic_body::contribution::{Contribution, Demand, Sums};
use nastic_body::controls::Controls;
use nastic_body::error::{FemError, Inadmissible, SecondDerivativeError};
use nastic_body::instant::Instant;
use nastic_energy::Slot;
use nastic_linear::{Field, SparseMatrix};
use nastic_mesh::{GroupNames, Mesh};

/// A scalar field phi beside the displacement has one value on a surface or node set: `phi_a = m`, m a control (the voltage of an electrode), or `phi_a = phi_b`, a value
/// that is found such that what flows there adds up to zero (an electrode that floats), or to a control Q (its charge): the potential energy gets `Q phi_a`.
///
/// The derivative of a functional j by m is `sum_a (j_phi + K^T lambda)_a`, that by Q is `lambda_a`. A value that is found is the unknown of one of the nodes, which all others follow.
#[derive(Debug, Clone)]
pub struct NodalValue {
    name: String,
    field: Field,
    surface: GroupNames,
    slots: Vec<Slot>,
    flow: bool,
    unit: f64,
}

impl NodalValue {
    /// The value of a control; `slot` says what it is called, and its unit.
    pub fn driven(name: &str, field: Field, surface: impl Into<GroupNames>, slot: Slot) -> Self {
        NodalValue { slots: vec![slot], ..Self::floating(name, field, surface) }
    }

    /// One that is found such that `-sum_a dP/dphi_a` without what it adds itself, the charge on an electrode, is a control.
    pub fn charged(name: &str, field: Field, surface: impl Into<GroupNames>, slot: Slot) -> Self {
        NodalValue { slots: vec![slot], flow: true, ..Self::floating(name, field, surface) }
    }

    /// One that is found.
    pub fn floating(name: &str, field: Field, surface: impl Into<GroupNames>) -> Self {
        NodalValue { name: name.to_owned(), field, surface: surface.into(), slots: Vec::new(), flow: false, unit: 1.0 }
    }

    /// Of a field whose unknowns are values over this unit.
    #[must_use]
    pub fn in_units_of(self, unit: f64) -> Self {
        NodalValue { unit, ..self }
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
            flow: self.flow,
            unit: self.unit,
            dim: mesh.dim(),
            tied,
            nodes,
        })
    }
}

/// The contribution of a [`NodalValue`], whose residual is `dP/dphi_a = Q` at one node where a charge is given, and zero elsewhere.
#[derive(Debug)]
pub struct OneValue {
    name: String,
    fields: [Field; 1],
    /// One of a control, none of a value that is found without charge.
    slots: Vec<Slot>,
    /// Whether the control is the charge.
    flow: bool,
    /// What unknowns are multiplied by.
    unit: f64,
    dim: usize,
    nodes: Vec<u32>,
    tied: Tied,
}

impl OneValue {
    /// Its unknowns in vectors of the displacement and its field.
    fn places(&self) -> impl Iterator<Item = usize> {
        self.nodes.iter().map(|&node| (self.dim + 1) * node as usize + self.dim)
    }

    /// That of the node which all others follow.
    fn first(&self) -> usize {
        (self.dim + 1) * self.tied.masters[0] as usize + self.dim
    }

    fn is_given(&self) -> bool {
        !self.slots.is_empty() && !self.flow
    }
}

impl Prescribes for OneValue {
    fn unknowns(&self) -> Vec<u32> {
        self.places().map(|dof| dof as u32).collect()
    }

    fn prescribe(&self, at: &Instant, u: &mut [f64]) {
        self.places().for_each(|dof| u[dof] = at.control(0) / self.unit);
    }

    fn add_change(&self, at: &Instant, v: &Controls, du: &mut [f64]) {
        self.places().for_each(|dof| du[dof] += at.slot_of(v, 0) / self.unit);
    }

    fn vjp(&self, at: &Instant, force: &[f64], into: &mut Sensitivities) {
        into.add_control(at, 0, self.places().map(|dof| force[dof]).sum::<f64>() / self.unit);
    }
}

impl Gathers for OneValue {
    fn unknowns(&self) -> Vec<usize> {
        self.places().collect()
    }

    /// Voltage U, charge Q, and Q/U, no number where U is zero: the capacitance where all other electrodes are grounded.
    fn quantities(&self, at: &Instant, sum: f64) -> Vec<(&'static str, f64)> {
        let (voltage, charge) = (self.unit * at.u[self.first()], -sum / self.unit);
        let capacitance = if voltage == 0.0 { f64::NAN } else { charge / voltage };
        vec![("voltage", voltage), ("charge", charge), ("capacitance", capacitance)]
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

    fn field_unit(&self) -> f64 {
        self.unit
    }

    fn field_nodes(&self) -> Option<Vec<u32>> {
        Some(self.nodes.clone())
    }

    fn gathers(&self) -> Option<&dyn Gathers> {
        Some(self)
    }

    fn prescribes(&self) -> Option<&dyn Prescribes> {
        if self.is_given() { Some(self) } else { None }
    }

    fn tied(&self) -> Option<&Tied> {
        (!self.is_given()).then_some(&self.tied)
    }

    fn is_stiff(&self) -> bool {
        false
    }

    fn at<'a>(&'a self, _: &Instant, _: Need) -> Result<Box<dyn ContributionPoint + 'a>, Inadmissible> {
        if self.flow { Ok(Box::new(self)) } else { Ok(Box::new(NoForce)) }
    }
}

/// Where a charge is given.
impl ContributionPoint for OneValue {
    fn add_residual(&self, at: &Instant, demand: Demand, sums: &mut Sums) -> Result<(), Inadmissible> {
        let (charge, first) = (self.unit * at.control(0), self.first());
        if demand.energy {
            sums.energy += charge * at.u[first];
            sums.energy_scale += (charge * at.u[first]).abs();
        }
        if demand.force {
            sums.force[first] += charge;
            sums.force_scale[first] += charge.abs();
        }
        Ok(())
    }

    fn add_tangent(&self, _: &Instant, _: &mut SparseMatrix) -> Result<(), Inadmissible> {
        Ok(())
    }

    fn add_tangent_product(&self, _: &Instant, _: &[f64], _: &mut [f64]) -> Result<bool, Inadmissible> {
        Ok(true)
    }

    fn vjp(&self, at: &Instant, lambda: &[f64], into: &mut Sensitivities) -> Result<(), Inadmissible> {
        into.add_control(at, 0, self.unit * lambda[self.first()]);
        Ok(())
    }

    fn add_control_product(&self, at: &Instant, v: &Controls, out: &mut [f64]) -> Result<(), SecondDerivativeError> {
        out[self.first()] += self.unit * at.slot_of(v, 0);
        Ok(())
    }

    fn second_vjp(
        &self,
        _: &Instant,
        _: &[f64],
        _: &Increment,
        _: &mut SecondSensitivities,
    ) -> Result<(), SecondDerivativeError> {
        Ok(())
    }
}
