//! [`ModelPoint`]: a model at one displacement.

use super::Model;
use super::inequalities::has_inequalities;
use crate::linear_systems::saddle_point::BorderedTangent;
use nastic_body::body_energy::driving::Driving;
use nastic_body::body_energy::evaluated::EvaluatedBody;
use nastic_body::contribution::point::{ContributionPoint, Need};
use nastic_body::contribution::sensitivities::{Increment, SecondSensitivities, Sensitivities};
use nastic_body::contribution::{Contribution, Demand, Sums};
use nastic_body::controls::Controls;
use nastic_body::error::{Inadmissible, SecondDerivativeError};
use nastic_body::instant::Instant;
use nastic_body::kernels::displaced::Displaced;
use nastic_linear::{CellProducts, SparseMatrix};
use nastic_numeric::vector::sub;
use std::sync::Arc;

/// All contributions of a [`Model`] at one displacement: `sum_c r_c` and its derivatives, for which kinematics are found once.
///
/// Every method is given the instant, whose u has the displacement that the point was made for; see [`ContributionPoint`].
pub struct ModelPoint<'m> {
    model: &'m Model,
    body: EvaluatedBody<'m>,
    others: Vec<Box<dyn ContributionPoint + 'm>>,
}

impl Model {
    /// What it is at the displacement of an instant.
    ///
    /// # Errors
    /// [`Inadmissible`] where u is.
    pub fn at(&self, at: &Instant, need: Need) -> Result<ModelPoint<'_>, Inadmissible> {
        let others = self.others.iter().zip(self.instants(at)).map(|(c, at)| self.point_of(c.as_ref(), &at, need));
        Ok(ModelPoint {
            model: self,
            body: EvaluatedBody::new(&self.body, need),
            others: others.collect::<Result<_, _>>()?,
        })
    }
}

impl ModelPoint<'_> {
    /// Its displacement with what is known of it.
    pub(crate) fn displaced<'p>(&'p self, u: &'p [f64]) -> Displaced<'p> {
        self.body.displaced(u)
    }

    /// Energy alone, or energy and residual force.
    ///
    /// # Errors
    /// [`Inadmissible`] where u is.
    pub fn evaluate(&self, at: &Instant, demand: Demand) -> Result<Sums, Inadmissible> {
        let mut sums = Sums::zero(if demand.force { self.model.unknowns().len() } else { 0 });
        let found = self.each(at, |_, point, at| point.add_residual(at, demand, &mut sums));
        self.model.agreed(found)?;
        self.model.sum_over_ranks(&mut sums);
        Ok(sums)
    }

    /// The sums of the contributions that have no potential.
    pub(crate) fn evaluate_without_potential(&self, at: &Instant) -> Result<Sums, Inadmissible> {
        self.sums_of(at, Demand { energy: true, force: true }, |contribution| !contribution.has_potential())
    }

    /// Energies of the contributions with friction alone.
    pub(crate) fn evaluate_friction(&self, at: &Instant) -> Result<Sums, Inadmissible> {
        self.sums_of(at, Demand { energy: true, force: false }, |contribution| contribution.path_dependence().is_some())
    }

    /// Residuals of the contributions with inequalities alone.
    pub(crate) fn inequality_residuals(&self, at: &Instant) -> Result<Sums, Inadmissible> {
        self.sums_of(at, Demand { energy: false, force: true }, has_inequalities)
    }

    /// Of some of the contributions beside the body.
    fn sums_of(
        &self,
        at: &Instant,
        demand: Demand,
        which: impl Fn(&dyn Contribution) -> bool,
    ) -> Result<Sums, Inadmissible> {
        let mut sums = Sums::zero(self.model.unknowns().len());
        self.each_other(at, |contribution, point, at| match which(contribution) {
            true => point.add_residual(at, demand, &mut sums),
            false => Ok(()),
        })?;
        Ok(sums)
    }

    /// Adds the tangent, supports not eliminated.
    ///
    /// # Errors
    /// [`Inadmissible`] where u is.
    pub fn add_tangent(&self, at: &Instant, tangent: &mut SparseMatrix) -> Result<(), Inadmissible> {
        let add = |contribution: &dyn Contribution, point: &dyn ContributionPoint, at: &Instant| {
            point.add_tangent(at, tangent).map_err(|e| e.of(contribution.name()))
        };
        self.model.agreed(self.each(at, add))
    }

    /// The tangent by the products of its cells, see [`Tangents::cell_products`](crate::model::views::Tangents::cell_products).
    ///
    /// # Errors
    /// [`Inadmissible`] where u is.
    pub fn cell_products(&self, at: &Instant) -> Result<Option<Arc<dyn CellProducts>>, Inadmissible> {
        let Model { body, supports, .. } = self.model;
        if at.step.is_some() || !self.model.tangents().has_cell_products() {
            return Ok(None);
        }
        let place = (self.displaced(self.model.nodal(at.u)), Driving::of(at));
        let products = body.cell_products(place.0, place.1, supports.fixed(), at.parallel)?;
        Ok(products.map(|products| products as Arc<dyn CellProducts>))
    }

    /// The tangent with the border of the constraints, supports not eliminated.
    pub(crate) fn bordered_tangent(&self, at: &Instant) -> Result<BorderedTangent, Inadmissible> {
        let mut tangent = BorderedTangent::zero(self.model);
        self.each(at, |contribution, point, at| {
            tangent.add(contribution, point, at).map_err(|e| e.of(contribution.name()))
        })?;
        Ok(tangent)
    }

    /// `out = K v` without a matrix; false where a contribution needs one.
    ///
    /// # Errors
    /// [`Inadmissible`] where u is.
    pub fn tangent_product(&self, at: &Instant, v: &[f64], out: &mut [f64]) -> Result<bool, Inadmissible> {
        out.fill(0.0);
        let mut complete = true;
        self.each(at, |_, point, at| {
            complete &= point.add_tangent_product(at, v, out)?;
            Ok::<(), Inadmissible>(())
        })?;
        Ok(complete)
    }

    /// The longest share of the straight move to another displacement that every contribution bears; see [`Moves::admissible_move`](crate::model::views::Moves::admissible_move).
    ///
    /// # Errors
    /// [`Inadmissible`] where the move begins outside of the admissible set.
    pub fn admissible_move(&self, from: &Instant, to: &[f64]) -> Result<f64, Inadmissible> {
        let (du, mut least) = (sub(to, from.u), 1.0_f64);
        let found = self.each(from, |_, point, at| {
            least = least.min(point.max_step(at, &du)?);
            Ok::<(), Inadmissible>(())
        });
        self.model.agreed(found)?;
        Ok(self.model.unknowns().least(least))
    }

    /// The same of the contributions beside the body.
    pub(crate) fn admissible_move_of_others(&self, from: &Instant, to: &[f64]) -> Result<f64, Inadmissible> {
        let (du, mut least) = (sub(to, from.u), 1.0_f64);
        let found = self.each_other(from, |_, point, at| {
            least = least.min(point.max_step(at, &du)?);
            Ok::<(), Inadmissible>(())
        });
        self.model.agreed(found)?;
        Ok(self.model.unknowns().least(least))
    }

    /// `lambda . dr/dp` by controls, velocity and acceleration.
    ///
    /// # Errors
    /// [`Inadmissible`] where u is.
    pub fn vjp(&self, at: &Instant, lambda: &[f64]) -> Result<Sensitivities, Inadmissible> {
        let mut sums = Sensitivities::zero(self.model.controls(), at);
        let found = self.each(at, |_, point, at| point.vjp(at, lambda, &mut sums));
        self.model.agreed(found)?;
        Ok(sums)
    }

    /// `dr/dm v`: the change of the residual along a change of the controls.
    ///
    /// # Errors
    /// [`SecondDerivativeError`]: J <= 0, or a contribution that does not give it.
    pub fn control_product(&self, at: &Instant, v: &Controls) -> Result<Vec<f64>, SecondDerivativeError> {
        let mut out = vec![0.0; self.model.unknowns().len()];
        self.each(at, |contribution, point, at| {
            point
                .add_control_product(at, v, &mut out)
                .or_else(|error| error.of(contribution.name(), !contribution.slots().is_empty()))
        })?;
        Ok(out)
    }

    /// The change of `K^T lambda` and of `lambda . dr/dm` along a change of displacement and controls.
    ///
    /// # Errors
    /// [`SecondDerivativeError`]: J <= 0, or a term that does not give it.
    pub fn second_vjp(
        &self,
        at: &Instant,
        lambda: &[f64],
        along: &Increment,
    ) -> Result<SecondSensitivities, SecondDerivativeError> {
        let mut sums = SecondSensitivities::zero(self.model.controls(), self.model.unknowns().len());
        self.each(at, |contribution, point, at| {
            point
                .second_vjp(at, lambda, along, &mut sums)
                .or_else(|error| error.of(contribution.name(), !contribution.slots().is_empty()))
        })?;
        Ok(sums)
    }

    /// Calls with every contribution, in a fixed order, and where it is evaluated.
    fn each<E>(
        &self,
        at: &Instant,
        mut call: impl FnMut(&dyn Contribution, &dyn ContributionPoint, &Instant) -> Result<(), E>,
    ) -> Result<(), E> {
        // These know of no multipliers.
        let nodal = Instant { u: self.model.nodal(at.u), space: self.model.unknowns(), ..*at };
        let Model { body, dead_load, .. } = self.model;
        self.model.wrapped(body, &self.body, |point| call(body, point, &nodal))?;
        self.model.wrapped(dead_load, dead_load, |point| call(dead_load, point, &nodal))?;
        self.each_other(at, call)
    }

    fn each_other<E>(
        &self,
        at: &Instant,
        mut call: impl FnMut(&dyn Contribution, &dyn ContributionPoint, &Instant) -> Result<(), E>,
    ) -> Result<(), E> {
        let others = self.model.others.iter().zip(&self.others);
        for ((contribution, point), at) in others.zip(self.model.instants(at)) {
            call(contribution.as_ref(), point.as_ref(), &at)?;
        }
        Ok(())
    }
}
