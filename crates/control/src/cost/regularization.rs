//! Costs of the control itself: [`ControlNorm`] and [`ControlSmoothness`].

use super::{Cost, CostContext, CostForm, CostPoint, Counts, Key, Partials, check_weight};
use nastic_fem::Discretization;
use nastic_fields::{Basis, ControlError, mass_product, stiffness_product};
use std::fmt;
use std::sync::Arc;

/// `j = (weight/2) int |m|^2 dX` over the region the control acts on.
///
/// Derivative: `dj/dm [dm] = weight int m . dm dX`. Units: the weight's times Pa^2 m^3 for a tension.
/// Source: survey, section 4 (the term (M/2) |u|^2); docs/model/costs.md.
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

/// How the norm stands in case files.
pub(super) const NORM: CostForm = CostForm::new("control_norm", "weight/2 int m^2", &[Key::CONTROL], |on| {
    Ok(Box::new(ControlNorm::of(&on.get::<String>("of")?, on.weight)?))
})
.square()
.counts(Counts::OverTime)
.words(|words| format!("weight/2 int {}^2", words.text("of")));

/// How the smoothness stands in case files.
pub(super) const SMOOTHNESS: CostForm = CostForm::new(
    "control_smoothness",
    "weight/2 int |grad m|^2; for cell fields the jumps over faces by the distance of centres.",
    &[Key::CONTROL],
    |on| Ok(Box::new(ControlSmoothness::of(&on.get::<String>("of")?, on.weight)?)),
)
.square()
.counts(Counts::OverTime)
.words(|words| format!("weight/2 int |grad {}|^2", words.text("of")));

impl Cost for ControlNorm {
    fn name(&self) -> &str {
        "control_norm"
    }

    fn spans_ranks(&self) -> bool {
        true
    }

    fn at(&self, at: &CostContext) -> Result<Arc<dyn CostPoint>, ControlError> {
        Ok(Arc::new(Quadratic::new(at, &self.of, self.weight, mass_product)?))
    }
}

/// `j = (weight/2) int |grad m|^2 dX` for a field between nodes or on a grid; for a cell field the sum over inner faces of
/// `area / distance (m_a - m_b)^2` with the distance of the cell centres in place of the integral.
///
/// Derivative: `dj/dm [dm] = weight int grad m : grad dm dX`. Constant fields cost nothing, so for uniform controls (and
/// for regions, which have no neighbours here) the value is zero.
/// Source: survey, section 4; docs/model/costs.md.
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

    fn spans_ranks(&self) -> bool {
        true
    }

    fn at(&self, at: &CostContext) -> Result<Arc<dyn CostPoint>, ControlError> {
        Ok(Arc::new(Quadratic::new(at, &self.of, self.weight, stiffness_product)?))
    }
}

type Product = fn(&Discretization, &Basis, &[f64]) -> Vec<f64>;

/// `(weight/2) m . A m` summed over the components, evaluated: its derivative is `weight A m`, the second one `weight A`. Over ranks A is
/// the sum of those of the ranks, `m . A m = sum_p m . A_p m`.
#[derive(Debug)]
struct Quadratic {
    value: f64,
    operator: Operator,
    /// `weight A m`, as the control vector has it.
    derivative: Vec<f64>,
}

/// `weight A` on the components of a control field.
struct Operator {
    weight: f64,
    product: Product,
    discretization: Arc<Discretization>,
    basis: Arc<Basis>,
    components: usize,
    /// Where the control field begins in the control vector.
    first: usize,
}

impl fmt::Debug for Operator {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "Operator {{ weight: {}, first: {} }}", self.weight, self.first)
    }
}

impl Operator {
    /// `weight A m` of a control field m.
    fn apply(&self, m: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; m.len()];
        for c in 0..self.components {
            let component: Vec<f64> = m.iter().skip(c).step_by(self.components).copied().collect();
            let image = (self.product)(&self.discretization, &self.basis, &component);
            let entries = out.iter_mut().skip(c).step_by(self.components);
            entries.zip(&image).for_each(|(out, a)| *out = self.weight * a);
        }
        out
    }

    /// Adds `weight A m` of the field's part of a control vector to that of another.
    fn add(&self, m: &[f64], out: &mut [f64]) {
        let own = self.first..self.first + self.components * self.basis.len();
        let image = self.apply(&m[own.clone()]);
        out[own].iter_mut().zip(&image).for_each(|(out, a)| *out += a);
    }
}

impl Quadratic {
    fn new(at: &CostContext, of: &str, weight: f64, product: Product) -> Result<Self, ControlError> {
        let block = at.layout.block(of)?;
        let operator = Operator {
            weight,
            product,
            discretization: at.solid.discretization().clone(),
            basis: block.basis.clone(),
            components: block.components,
            first: block.first,
        };
        let m = block.of(at.m);
        let derivative = operator.apply(m);
        let own = 0.5 * m.iter().zip(&derivative).map(|(m, d)| m * d).sum::<f64>();
        let value = at.solid.model().unknowns().total(own);
        Ok(Quadratic { value, operator, derivative })
    }
}

impl CostPoint for Quadratic {
    fn value(&self) -> f64 {
        self.value
    }

    fn add_partials(&self, out: &mut Partials) -> Result<(), ControlError> {
        let entries = out.m[self.operator.first..].iter_mut();
        entries.zip(&self.derivative).for_each(|(o, d)| *o += d);
        Ok(())
    }

    fn add_second_partials(&self, along: &Partials, out: &mut Partials) -> Result<(), ControlError> {
        self.operator.add(&along.m, &mut out.m);
        Ok(())
    }
}
