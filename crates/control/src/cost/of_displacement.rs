//! [`OfDisplacement`]: what reads the displacement of a body that has further fields.

use super::{CostContext, CostPoint, Figure, Partials};
use crate::constraint::ConstraintPoint;
use nastic_fem::{Solid, Space, State};
use nastic_fields::ControlError;
use std::borrow::Cow;
use std::sync::Arc;

/// An evaluated cost or constraint of a body with nodal fields beside the displacement: it knows of vectors of displacements and multipliers, and its partial
/// derivatives by the further fields are zero.
#[derive(Debug)]
pub(crate) struct OfDisplacement<P: ?Sized> {
    point: Arc<P>,
    space: Arc<Space>,
    /// Components of the displacement, which come first in the block of a node.
    dim: usize,
}

/// The context of costs and constraints that are evaluated beside further fields: with the displacement alone, and without the state, whose tangent is that of more.
pub(crate) fn beside_fields<'a>(context: CostContext<'a>, u: &'a [f64]) -> CostContext<'a> {
    let has_state = context.solid.model().unknowns().has_one_nodal_field();
    CostContext { u, state: context.state.filter(|_| has_state), ..context }
}

/// The displacement of a state.
pub(crate) fn displacement<'s>(solid: &Solid, state: &'s State) -> Cow<'s, [f64]> {
    solid.model().displacement(&state.u)
}

/// A point as it stands beside further fields: as it is where there are none.
pub(crate) fn wrapped<P: ?Sized>(solid: &Solid, point: Arc<P>, wrap: impl Fn(OfDisplacement<P>) -> Arc<P>) -> Arc<P> {
    let space = solid.model().unknowns();
    match space.has_one_nodal_field() {
        true => point,
        false => wrap(OfDisplacement { point, space: space.clone(), dim: solid.mesh().dim() }),
    }
}

impl<P: ?Sized> OfDisplacement<P> {
    /// A change as the point knows it.
    fn own(&self, of: &Partials) -> Partials {
        let mut u = self.space.components(&of.u, 0, self.dim);
        u.extend_from_slice(&of.u[self.space.nodal()..]);
        Partials { u, m: of.m.clone() }
    }

    /// What the point adds.
    fn add(
        &self,
        out: &mut Partials,
        call: impl FnOnce(&mut Partials) -> Result<(), ControlError>,
    ) -> Result<(), ControlError> {
        let (nodal, block) = (self.dim * self.space.nodes(), self.space.block());
        let zero = vec![0.0; nodal + self.space.multipliers()];
        let mut own = Partials { u: zero, m: std::mem::take(&mut out.m) };
        let added = call(&mut own);
        out.m = own.m;
        let (nodes, multipliers) = out.u.split_at_mut(self.space.nodal());
        for (node, own) in nodes.chunks_exact_mut(block).zip(own.u.chunks_exact(self.dim)) {
            node.iter_mut().zip(own).for_each(|(sum, value)| *sum += value);
        }
        multipliers.iter_mut().zip(&own.u[nodal..]).for_each(|(sum, value)| *sum += value);
        added
    }
}

impl CostPoint for OfDisplacement<dyn CostPoint> {
    fn value(&self) -> f64 {
        self.point.value()
    }

    fn add_partials(&self, out: &mut Partials) -> Result<(), ControlError> {
        self.add(out, |out| self.point.add_partials(out))
    }

    fn add_second_partials(&self, along: &Partials, out: &mut Partials) -> Result<(), ControlError> {
        let along = self.own(along);
        self.add(out, |out| self.point.add_second_partials(&along, out))
    }

    fn figures(&self) -> Result<Vec<Figure>, ControlError> {
        self.point.figures()
    }
}

impl ConstraintPoint for OfDisplacement<dyn ConstraintPoint> {
    fn values(&self) -> &[f64] {
        self.point.values()
    }

    fn add_partials(&self, y: &[f64], out: &mut Partials) -> Result<(), ControlError> {
        self.add(out, |out| self.point.add_partials(y, out))
    }

    fn change(&self, along: &Partials) -> Result<Vec<f64>, ControlError> {
        self.point.change(&self.own(along))
    }

    fn add_second_partials(&self, y: &[f64], along: &Partials, out: &mut Partials) -> Result<(), ControlError> {
        let along = self.own(along);
        self.add(out, |out| self.point.add_second_partials(y, &along, out))
    }
}
