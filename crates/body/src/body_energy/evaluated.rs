//! [`EvaluatedBody`]: the energy of a body at one displacement.

use crate::body_energy::assembly;
use crate::body_energy::assembly::Terms;
use crate::body_energy::driving::Driving;
use crate::body_energy::product::{self, Along};
use crate::body_energy::{BodyEnergy, control_vjp, max_step, second_vjp};
use crate::contribution::point::{ContributionPoint, Need};
use crate::contribution::sensitivities::{Increment, SecondSensitivities, Sensitivities};
use crate::contribution::{Demand, Sums};
use crate::controls::Controls;
use crate::error::{Inadmissible, SecondDerivativeError};
use crate::instant::Instant;
use crate::kernels::displaced::Displaced;
use nastic_linear::SparseMatrix;
use nastic_tensor::Mat3;
use std::cell::OnceCell;

/// A [`BodyEnergy`] at one displacement: `1 + grad u` at the quadrature points, found with the residual, serves the derivatives.
pub struct EvaluatedBody<'a> {
    body: &'a BodyEnergy,
    keeps: bool,
    gradients: OnceCell<Vec<Mat3>>,
}

impl<'a> EvaluatedBody<'a> {
    /// Of a body, as far as `need` says.
    pub fn new(body: &'a BodyEnergy, need: Need) -> Self {
        EvaluatedBody { body, keeps: need == Need::Derivatives, gradients: OnceCell::new() }
    }

    /// Its displacement u with what is known of it.
    pub fn displaced<'p>(&'p self, u: &'p [f64]) -> Displaced<'p> {
        Displaced { u, known: self.gradients.get().map(Vec::as_slice) }
    }

    fn place<'p>(&'p self, at: &Instant<'p>) -> (Displaced<'p>, Driving<'p>) {
        (self.displaced(at.u), Driving::of(at))
    }
}

impl ContributionPoint for EvaluatedBody<'_> {
    fn add_residual(&self, at: &Instant, demand: Demand, sums: &mut Sums) -> Result<(), Inadmissible> {
        let terms = Terms { energy: demand.energy, force: demand.force, tangent: false };
        let keeps = self.keeps && self.gradients.get().is_none();
        let mut found = keeps.then(|| vec![Mat3::zeros(); self.body.discretization().points().len()]);
        let (to, driving) = self.place(at);
        assembly::add(self.body, to, driving, terms, (sums, None, found.as_deref_mut()), at.parallel)?;
        if let Some(found) = found {
            self.gradients.get_or_init(|| found);
        }
        Ok(())
    }

    fn add_tangent(&self, at: &Instant, tangent: &mut SparseMatrix) -> Result<(), Inadmissible> {
        let terms = Terms { energy: false, force: false, tangent: true };
        let (to, driving) = self.place(at);
        assembly::add(self.body, to, driving, terms, (&mut Sums::zero(0), Some(tangent), None), at.parallel)
    }

    fn add_tangent_product(&self, at: &Instant, v: &[f64], out: &mut [f64]) -> Result<bool, Inadmissible> {
        product::add(self.body, self.place(at), Along::Displacement(v), out, at.parallel).map(|()| true)
    }

    fn max_step(&self, at: &Instant, du: &[f64]) -> Result<f64, Inadmissible> {
        max_step::max_step(self.body, self.place(at).0, du, at.parallel)
    }

    fn vjp(&self, at: &Instant, lambda: &[f64], into: &mut Sensitivities) -> Result<(), Inadmissible> {
        let into = (&mut into.controls, &mut into.before.history);
        control_vjp::add(self.body, self.place(at), lambda, into.0, into.1, at.parallel)
    }

    fn add_control_product(&self, at: &Instant, v: &Controls, out: &mut [f64]) -> Result<(), SecondDerivativeError> {
        Ok(product::add(self.body, self.place(at), Along::Controls(v), out, at.parallel)?)
    }

    fn second_vjp(
        &self,
        at: &Instant,
        lambda: &[f64],
        along: &Increment,
        into: &mut SecondSensitivities,
    ) -> Result<(), SecondDerivativeError> {
        second_vjp::add(self.body, self.place(at), lambda, along, into, at.parallel)
    }
}
