//! Costs of the control itself: [`ControlNorm`] and [`ControlSmoothness`].

use super::{Cost, CostContext, CostPoint, Partials, check_weight};
use crate::error::ControlError;
use crate::inner_product::{mass_product, stiffness_product};
use std::sync::Arc;

/// `j = (weight/2) int |m|^2 dX` over the region the control acts on.
///
/// Derivative: `dj/dm [dm] = weight int m . dm dX`. Units: the weight's times Pa^2 m^3 for a tension.
/// Source: survey, section 4 (the term (M/2) |u|^2); docs/model.md section 5.
#[derive(Debug, Clone)]
pub struct ControlNorm {
    of: String,
    weight: f64,
}

impl ControlNorm {
    /// Of the named control.
    ///
    /// # Errors
    /// A weight that is not positive.
    pub fn of(control: &str, weight: f64) -> Result<Self, ControlError> {
        Ok(ControlNorm { of: control.to_owned(), weight: check_weight("control_norm", weight)? })
    }
}

impl Cost for ControlNorm {
    fn name(&self) -> &str {
        "control_norm"
    }

    fn at(&self, at: &CostContext) -> Result<Arc<dyn CostPoint>, ControlError> {
        Ok(Arc::new(Quadratic::new(at, &self.of, self.weight, mass_product)?))
    }
}

/// `j = (weight/2) int |grad m|^2 dX` for a nodal field; for a cell field the sum over inner faces of
/// `area / distance (m_a - m_b)^2` with the distance of the cell centres in place of the integral.
///
/// Derivative: `dj/dm [dm] = weight int grad m : grad dm dX`. Constant fields cost nothing, so for uniform controls (and
/// for regions, which have no neighbours here) the value is zero.
/// Source: survey, section 4; docs/model.md section 5.
#[derive(Debug, Clone)]
pub struct ControlSmoothness {
    of: String,
    weight: f64,
}

impl ControlSmoothness {
    /// Of the named control.
    ///
    /// # Errors
    /// A weight that is not positive.
    pub fn of(control: &str, weight: f64) -> Result<Self, ControlError> {
        Ok(ControlSmoothness { of: control.to_owned(), weight: check_weight("control_smoothness", weight)? })
    }
}

impl Cost for ControlSmoothness {
    fn name(&self) -> &str {
        "control_smoothness"
    }

    fn at(&self, at: &CostContext) -> Result<Arc<dyn CostPoint>, ControlError> {
        Ok(Arc::new(Quadratic::new(at, &self.of, self.weight, stiffness_product)?))
    }
}

type Product = fn(&nastic_fem::Discretization, &crate::map::ControlMap, &[f64]) -> Vec<f64>;

/// `(weight/2) m . A m` summed over the components, evaluated: its derivative is `weight A m`.
#[derive(Debug)]
struct Quadratic {
    value: f64,
    /// Where the control field begins in the control vector.
    first: usize,
    /// `weight A m`, as the control vector has it.
    derivative: Vec<f64>,
}

impl Quadratic {
    fn new(at: &CostContext, of: &str, weight: f64, product: Product) -> Result<Self, ControlError> {
        let block = at.layout.block(of)?;
        let m = block.of(at.m);
        let (mut value, mut derivative) = (0.0, vec![0.0; m.len()]);
        for c in 0..block.components {
            let component: Vec<f64> = m.iter().skip(c).step_by(block.components).copied().collect();
            let image = product(at.solid.discretization(), &block.map, &component);
            value += 0.5 * weight * component.iter().zip(&image).map(|(m, a)| m * a).sum::<f64>();
            let entries = derivative.iter_mut().skip(c).step_by(block.components);
            entries.zip(&image).for_each(|(d, a)| *d = weight * a);
        }
        Ok(Quadratic { value, first: block.first, derivative })
    }
}

impl CostPoint for Quadratic {
    fn value(&self) -> f64 {
        self.value
    }

    fn add_partials(&self, out: &mut Partials) -> Result<(), ControlError> {
        let entries = out.m[self.first..].iter_mut();
        entries.zip(&self.derivative).for_each(|(o, d)| *o += d);
        Ok(())
    }
}
