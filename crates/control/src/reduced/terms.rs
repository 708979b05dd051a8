//! The cost terms of a [`Reduced`] problem: their names, values and figures.

use super::Reduced;
use crate::cost::{CostContext, CostPoint, Figure};
use crate::evaluated::Evaluated;
use nastic_fem::State;
use nastic_fields::ControlError;
use std::borrow::Cow;
use std::sync::Arc;

/// Values of the cost terms, and the evaluated terms.
type Terms = (Vec<f64>, Vec<Arc<dyn CostPoint>>);

impl Reduced {
    /// Values of the terms, and the evaluated terms where points keep them.
    pub(super) fn terms(&self, state: &State, m: &[f64], stage: usize) -> Result<Terms, ControlError> {
        let mut costs = self.costs_at(state, m, stage)?;
        let values = costs.iter().map(|cost| cost.value()).collect();
        if !self.keep_factors {
            costs.clear();
        }
        Ok((values, costs))
    }

    /// Evaluates the terms in a state; of a problem in time with the controls of its instant, whenever they count.
    ///
    /// # Errors
    /// A cost that is not defined there.
    pub fn costs_at(&self, state: &State, m: &[f64], stage: usize) -> Result<Vec<Arc<dyn CostPoint>>, ControlError> {
        let (at, ranks) = (self.near_time(state, (m, stage))?, self.solid.model().ranks());
        self.costs.iter().map(|cost| ranks.all_accept(at.cost(cost.as_ref()))).collect()
    }

    /// The evaluated terms of a point: those it keeps, or evaluated again.
    ///
    /// # Errors
    /// A cost that is not defined there.
    pub fn costs_of<'a>(&self, point: &'a Evaluated) -> Result<Cow<'a, [Arc<dyn CostPoint>]>, ControlError> {
        if point.costs.len() == self.costs.len() {
            return Ok(Cow::Borrowed(&point.costs));
        }
        self.costs_at(point.state(), &point.m, point.stage).map(Cow::Owned)
    }

    /// Whether one rank can find the figures of a point by itself: costs are evaluated by all together.
    pub(super) fn has_figures(&self, point: &Evaluated) -> bool {
        point.costs.len() == self.costs.len() || !self.solid.model().ranks().is_over_ranks()
    }

    pub(super) fn context<'a>(&'a self, state: &'a State, m: &'a [f64], stage: usize) -> CostContext<'a> {
        let u = self.solid.model().nodal(&state.u);
        CostContext { solid: &self.solid, layout: self.layout_at(stage), u, state: Some(state), m, stage, step: None }
    }

    /// Names of the terms; those that occur several times are numbered, `tracking_0`, `tracking_1`.
    pub fn term_names(&self) -> Vec<String> {
        let of_motion = self.motion.iter().flat_map(|motion| motion.costs.iter().map(|cost| cost.name()));
        let all: Vec<&str> = self.costs.iter().map(|cost| cost.name()).chain(of_motion).collect();
        let name = |k: usize| match all.iter().filter(|name| **name == all[k]).count() {
            1 => all[k].to_owned(),
            _ => format!("{}_{}", all[k], (0..k).filter(|&i| all[i] == all[k]).count()),
        };
        (0..all.len()).map(name).collect()
    }

    /// Figures of every cost term beside its value (a true distance, say), more expensive than the values. Of a body over ranks a rank may ask alone, so that
    /// points that hold no evaluated costs have none there.
    ///
    /// # Errors
    /// Where a cost cannot.
    pub fn figures_of(&self, point: &Evaluated) -> Result<Vec<Vec<Figure>>, ControlError> {
        if !self.has_figures(point) {
            return Ok(vec![vec![]; self.costs.len()]);
        }
        self.costs_of(point)?.iter().map(|cost| cost.figures()).collect()
    }
}
