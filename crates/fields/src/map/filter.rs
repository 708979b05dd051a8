//! [`Filter`]: a field smoothed over a length.

use super::{Basis, ControlMap, Space, WholeBody};
use crate::error::ControlError;
use crate::field_operator::{FieldOperator, pieces_of_all};
use nastic_fem::Discretization;
use std::sync::Arc;

/// The Helmholtz filter `s - R^2 laplace s = x` with a natural boundary, `s = (M + R^2 S)^-1 M x` component by component: M the lumped mass of the basis functions,
/// S their stiffness (of fields by cell over faces, as the [H1 product](crate::Metric::H1)).
///
/// It keeps constants and `int x dX`; of fields by cell it keeps their bounds too, while values of fields by node or on a grid may leave those of x by some percent where cells are longer than sqrt 2 times their width (S has positive entries beside its diagonal there); a step becomes `exp(-|X|/R)/2`. A cone of radius r is `R = r / (2 sqrt 3)`.
///
/// **Source.** B. S. Lazarov & O. Sigmund, Int. J. Numer. Meth. Eng. 86 (2011) 765-781, doi 10.1002/nme.3072.
#[derive(Debug, Clone)]
pub struct Filter {
    length: f64,
    components: usize,
    masses: Vec<f64>,
    operator: Arc<FieldOperator>,
}

impl Filter {
    /// For the basis functions of a field with a number of components, over the length R.
    ///
    /// # Errors
    /// A length that is not positive, a field over points of a contribution, ranks that fail.
    pub fn new(disc: &Discretization, basis: &Basis, components: usize, length: f64) -> Result<Self, ControlError> {
        let fail = |what: String| Err(ControlError::Cost { what });
        if !(length.is_finite() && length > 0.0) {
            return fail(format!("the length of a filter is {length}; it is a positive length"));
        }
        if matches!(basis.space(), Space::Uniform | Space::Region | Space::Point) {
            return fail(format!(
                "a filter smooths fields by cell, by node or on a grid, not in the space \"{}\"",
                basis.space().name()
            ));
        }
        if basis.is_of_contribution() {
            return fail("a field over points of its own has no neighbours among them, and no filter".to_owned());
        }
        let mut masses = vec![0.0; basis.len()];
        for (q, w) in basis.weights(disc).iter().enumerate() {
            basis.at_point(q).for_each(|(i, shape)| masses[i] += w * shape);
        }
        let whole = WholeBody::of(disc);
        whole.add_up(&mut masses)?;
        let gathered = pieces_of_all(disc, basis)?;
        let operator = whole.agreed(FieldOperator::new(disc, basis, gathered, &masses, length * length))?;
        Ok(Filter { length, components, masses, operator: Arc::new(operator) })
    }

    /// One operation on every component.
    fn by_component(&self, x: &[f64], each: impl Fn(&mut Vec<f64>)) -> Vec<f64> {
        let mut out = x.to_vec();
        for c in 0..self.components {
            let mut own: Vec<f64> = x.iter().skip(c).step_by(self.components).copied().collect();
            each(&mut own);
            out.iter_mut().skip(c).step_by(self.components).zip(own).for_each(|(out, own)| *out = own);
        }
        out
    }

    fn times_mass(&self, x: &mut [f64]) {
        x.iter_mut().zip(&self.masses).for_each(|(x, mass)| *x *= mass);
    }
}

impl ControlMap for Filter {
    fn describe(&self) -> String {
        format!("(1 - {}^2 laplace)^-1 x", self.length)
    }

    fn values(&self, x: &[f64]) -> Vec<f64> {
        self.by_component(x, |own| {
            self.times_mass(own);
            self.operator.factor.solve(own, 1);
        })
    }

    fn change(&self, _: &[f64], v: &[f64]) -> Vec<f64> {
        self.values(v)
    }

    fn vjp(&self, _: &[f64], g: &[f64]) -> Vec<f64> {
        self.by_component(g, |own| {
            self.operator.factor.solve(own, 1);
            self.times_mass(own);
        })
    }
}
