//! [`RestrictedPoint`]: a contribution to some of the fields of a model.

use nastic_body::contribution::point::ContributionPoint;
use nastic_body::contribution::sensitivities::{Increment, SecondSensitivities, Sensitivities};
use nastic_body::contribution::{Demand, Sums};
use nastic_body::controls::Controls;
use nastic_body::discretization::supports::Supports;
use nastic_body::error::{Inadmissible, SecondDerivativeError};
use nastic_body::instant::Instant;
use nastic_linear::{Field, Space, SparseMatrix};
use std::ops::Deref;

/// Which components of every node's block belong to some fields. What stands behind the nodal unknowns belongs to all.
#[derive(Debug)]
pub(crate) struct Selection {
    components: Vec<usize>,
    block: usize,
    /// Nodal unknowns of the model.
    nodal: usize,
}

impl Selection {
    /// That of the displacement and further fields, in this order; `None` where these are all there are, in their order.
    pub fn of(space: &Space, further: &[Field]) -> Option<Self> {
        if space.has_one_nodal_field() {
            return None;
        }
        let displacement = space.nodal_fields().next();
        let named = further.iter().filter_map(|field| space.nodal_field(&field.name));
        let of_field = |(first, field): (usize, &Field)| first..first + field.components;
        let components: Vec<usize> = displacement.into_iter().chain(named).flat_map(of_field).collect();
        let block = space.block();
        let all = components.iter().copied().eq(0..block);
        (!all).then(|| Selection { components, block, nodal: space.nodal() })
    }

    /// Its nodal unknowns.
    fn own(&self) -> usize {
        self.nodal / self.block * self.components.len()
    }

    /// Its unknowns on nodes among those of the model.
    pub fn places(&self, own: Vec<u32>) -> Vec<u32> {
        let n = self.components.len();
        let place = |dof: usize| (self.block * (dof / n) + self.components[dof % n]) as u32;
        own.into_iter().map(|dof| place(dof as usize)).collect()
    }

    /// Its entries of a vector of the model.
    pub fn gather(&self, v: &[f64]) -> Vec<f64> {
        let (nodal, rest) = v.split_at(v.len().min(self.nodal));
        let own = nodal.chunks_exact(self.block).flat_map(|node| self.components.iter().map(|&c| node[c]));
        own.chain(rest.iter().copied()).collect()
    }

    /// Adds its entries to a vector of the model.
    pub fn scatter(&self, own: &[f64], into: &mut [f64]) {
        if own.is_empty() {
            return;
        }
        let ((own, rest), (nodal, behind)) = (own.split_at(self.own()), into.split_at_mut(self.nodal));
        for (own, node) in own.chunks_exact(self.components.len()).zip(nodal.chunks_exact_mut(self.block)) {
            own.iter().zip(&self.components).for_each(|(value, &c)| node[c] += value);
        }
        behind.iter_mut().zip(rest).for_each(|(sum, value)| *sum += value);
    }

    /// Calls with the instant of its fields.
    pub fn at<T>(&self, at: &Instant, call: impl FnOnce(&Instant) -> T) -> T {
        let u = self.gather(at.u);
        let scalar = (at.scalar + self.own()).saturating_sub(self.nodal);
        call(&Instant { u: &u, scalar, ..*at })
    }

    /// A vector of its fields, zero, beside one of the model.
    pub fn zero(&self, of: &[f64]) -> Vec<f64> {
        vec![0.0; if of.is_empty() { 0 } else { of.len() - self.nodal + self.own() }]
    }

    /// Calls with a matrix as its fields see it.
    pub fn among<T>(&self, into: &mut SparseMatrix, call: impl FnOnce(&mut SparseMatrix) -> T) -> T {
        into.among(&self.components, call)
    }

    /// The supports of its components.
    pub fn supports(&self, all: &Supports) -> Supports {
        all.restricted(&self.components)
    }
}

/// A contribution to the displacement and its own fields at one displacement, in a model of more: it sees vectors of its fields, and what it
/// adds is added to theirs. Static problems alone: in motion a model with further fields is refused.
pub(crate) struct RestrictedPoint<P> {
    pub point: P,
    pub selection: Selection,
}

impl<P: Deref> RestrictedPoint<P>
where
    P::Target: ContributionPoint,
{
    /// What is added to a vector of its fields.
    fn add<E>(&self, into: &mut [f64], add: impl FnOnce(&mut [f64]) -> Result<(), E>) -> Result<(), E> {
        let mut own = self.selection.zero(into);
        add(&mut own)?;
        self.selection.scatter(&own, into);
        Ok(())
    }
}

impl<P: Deref> ContributionPoint for RestrictedPoint<P>
where
    P::Target: ContributionPoint,
{
    fn add_residual(&self, at: &Instant, demand: Demand, sums: &mut Sums) -> Result<(), Inadmissible> {
        let mut own = Sums::zero(self.selection.zero(&sums.force).len());
        self.selection.at(at, |at| self.point.add_residual(at, demand, &mut own))?;
        sums.energy += own.energy;
        sums.energy_scale += own.energy_scale;
        sums.min_j = sums.min_j.min(own.min_j);
        self.selection.scatter(&own.force, &mut sums.force);
        self.selection.scatter(&own.force_scale, &mut sums.force_scale);
        Ok(())
    }

    fn add_tangent(&self, at: &Instant, tangent: &mut SparseMatrix) -> Result<(), Inadmissible> {
        self.selection.among(tangent, |tangent| self.selection.at(at, |at| self.point.add_tangent(at, tangent)))
    }

    fn add_border(&self, at: &Instant, columns: &mut [Vec<f64>]) -> Result<(), Inadmissible> {
        let mut own: Vec<Vec<f64>> = columns.iter().map(|column| self.selection.zero(column)).collect();
        self.selection.at(at, |at| self.point.add_border(at, &mut own))?;
        columns.iter_mut().zip(&own).for_each(|(column, own)| self.selection.scatter(own, column));
        Ok(())
    }

    fn add_tangent_product(&self, at: &Instant, v: &[f64], out: &mut [f64]) -> Result<bool, Inadmissible> {
        let (v, mut complete) = (self.selection.gather(v), false);
        self.add(out, |own| {
            complete = self.selection.at(at, |at| self.point.add_tangent_product(at, &v, own))?;
            Ok::<(), Inadmissible>(())
        })?;
        Ok(complete)
    }

    fn max_step(&self, at: &Instant, du: &[f64]) -> Result<f64, Inadmissible> {
        let du = self.selection.gather(du);
        self.selection.at(at, |at| self.point.max_step(at, &du))
    }

    fn vjp(&self, at: &Instant, lambda: &[f64], into: &mut Sensitivities) -> Result<(), Inadmissible> {
        let lambda = self.selection.gather(lambda);
        self.selection.at(at, |at| self.point.vjp(at, &lambda, into))
    }

    fn add_control_product(&self, at: &Instant, v: &Controls, out: &mut [f64]) -> Result<(), SecondDerivativeError> {
        self.add(out, |own| self.selection.at(at, |at| self.point.add_control_product(at, v, own)))
    }

    fn second_vjp(
        &self,
        at: &Instant,
        lambda: &[f64],
        along: &Increment,
        into: &mut SecondSensitivities,
    ) -> Result<(), SecondDerivativeError> {
        let (lambda, du) = (self.selection.gather(lambda), self.selection.gather(along.u));
        let along = Increment { u: &du, ..*along };
        let whole = std::mem::take(&mut into.u);
        into.u = self.selection.zero(&whole);
        let found = self.selection.at(at, |at| self.point.second_vjp(at, &lambda, &along, into));
        let own = std::mem::replace(&mut into.u, whole);
        self.selection.scatter(&own, &mut into.u);
        found
    }
}
