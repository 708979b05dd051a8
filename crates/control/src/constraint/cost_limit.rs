//! [`CostLimit`]: a bound on any cost.

use super::{Bound, Constraint, ConstraintPoint, IntoConstraint};
use crate::cost::{Cost, CostContext, CostPoint, IntoCost, MotionPartials, Partials};
use crate::time::Timeline;
use nastic_fem::Solid;
use nastic_fields::ControlError;
use nastic_numeric::vector::{axpy, dot};
use nastic_opt::{ConstraintGroup, Sense};
use std::sync::Arc;

/// `c = j(u, m) - bound <= 0` (or `= 0`, or `bound - j <= 0`) for any cost j, in its last continuation stage.
///
/// Scale: `|bound|`, unless it is given ([`scale`](Self::scale)); a bound of zero needs one.
#[derive(Debug)]
pub struct CostLimit<C> {
    cost: C,
    sense: Sense,
    bound: f64,
    /// Of j in c.
    sign: f64,
    scale: Option<f64>,
}

impl<C: IntoCost> CostLimit<C> {
    /// `j <= bound`
    pub fn at_most(cost: C, bound: f64) -> Self {
        CostLimit { cost, sense: Sense::AtMost, bound, sign: 1.0, scale: None }
    }

    /// `j >= bound`
    pub fn at_least(cost: C, bound: f64) -> Self {
        CostLimit { sign: -1.0, ..Self::at_most(cost, bound) }
    }

    /// `j = bound`
    pub fn equal(cost: C, bound: f64) -> Self {
        CostLimit { cost, sense: Sense::Equal, bound, sign: 1.0, scale: None }
    }

    /// What violations are measured in, > 0, in the cost's unit.
    pub fn scale(mut self, scale: f64) -> Self {
        self.scale = Some(scale);
        self
    }
}

impl<C: IntoCost> IntoConstraint for CostLimit<C> {
    fn bind(self, solid: &Solid) -> Result<Box<dyn Constraint>, ControlError> {
        let CostLimit { cost, sense, bound, sign, scale } = self;
        let cost = cost.bind(solid)?;
        let (name, scale) = (cost.name().to_owned(), scale.unwrap_or(bound.abs()));
        if !(bound.is_finite() && scale > 0.0 && scale.is_finite()) {
            let what = format!(
                "the constraint {name} has the bound {bound} and the scale {scale}: a bound is finite, a scale positive; a bound of zero \
                 needs a scale, a value of the functional that counts as large"
            );
            return Err(ControlError::Cost { what });
        }
        Ok(Box::new(BoundLimit { cost, group: ConstraintGroup { name, sense, len: 1, scale }, bound, sign }))
    }
}

#[derive(Debug)]
struct BoundLimit {
    cost: Box<dyn Cost>,
    group: ConstraintGroup,
    bound: f64,
    sign: f64,
}

impl Constraint for BoundLimit {
    fn group(&self) -> ConstraintGroup {
        self.group.clone()
    }

    fn bound(&self) -> Option<Bound> {
        Some(match (self.group.sense, self.sign < 0.0) {
            (Sense::Equal, _) => Bound::Equal(self.bound),
            (Sense::AtMost, true) => Bound::AtLeast(self.bound),
            (Sense::AtMost, false) => Bound::AtMost(self.bound),
        })
    }

    fn check_in_motion(&self, solid: &Solid, timeline: &Timeline, at_start: bool) -> Result<(), ControlError> {
        self.cost.check_in_motion(solid, timeline, at_start)
    }

    fn needs_step(&self) -> bool {
        self.cost.needs_step()
    }

    fn at(&self, at: &CostContext) -> Result<Arc<dyn ConstraintPoint>, ControlError> {
        let cost = self.cost.at(&CostContext { stage: self.cost.stages().saturating_sub(1), ..*at })?;
        Ok(Arc::new(EvaluatedConstraint {
            values: [self.sign * (cost.value() - self.bound)],
            sign: self.sign,
            cost,
            sizes: [at.solid.model().unknowns().len(), at.m.len()],
        }))
    }
}

#[derive(Debug)]
struct EvaluatedConstraint {
    cost: Arc<dyn CostPoint>,
    values: [f64; 1],
    sign: f64,
    /// Lengths of u and m.
    sizes: [usize; 2],
}

impl EvaluatedConstraint {
    fn zero(&self) -> Partials {
        Partials::zero(self.sizes[0], self.sizes[1])
    }
}

fn add(y: f64, from: &Partials, out: &mut Partials) {
    axpy(y, &from.u, &mut out.u);
    axpy(y, &from.m, &mut out.m);
}

impl ConstraintPoint for EvaluatedConstraint {
    fn values(&self) -> &[f64] {
        &self.values
    }

    fn add_partials(&self, y: &[f64], out: &mut Partials) -> Result<(), ControlError> {
        let mut own = self.zero();
        self.cost.add_partials(&mut own)?;
        y.iter().for_each(|y| add(self.sign * y, &own, out));
        Ok(())
    }

    fn add_partials_in_motion(
        &self,
        y: &[f64],
        out: &mut Partials,
        more: &mut MotionPartials,
    ) -> Result<(), ControlError> {
        let (mut own, mut others) = (self.zero(), MotionPartials::default());
        self.cost.add_partials_in_motion(&mut own, &mut others)?;
        for y in y {
            add(self.sign * y, &own, out);
            more.add(self.sign * y, &others);
        }
        Ok(())
    }

    fn change(&self, along: &Partials) -> Result<Vec<f64>, ControlError> {
        let mut own = self.zero();
        self.cost.add_partials(&mut own)?;
        Ok(vec![self.sign * (dot(&own.u, &along.u) + dot(&own.m, &along.m))])
    }

    fn add_second_partials(&self, y: &[f64], along: &Partials, out: &mut Partials) -> Result<(), ControlError> {
        let mut own = self.zero();
        self.cost.add_second_partials(along, &mut own)?;
        y.iter().for_each(|y| add(self.sign * y, &own, out));
        Ok(())
    }
}
