//! Terms of the cost under the names that the case gives them.

use nastic_control::{
    Aim, ControlError, Cost, CostContext, CostPoint, CostTarget, Layout, Smoothing, Timeline, TrajectoryContext,
    TrajectoryCost, TrajectoryPartials,
};
use nastic_fem::Solid;
use std::sync::Arc;

/// A term under the name the case gives it.
#[derive(Clone, Debug)]
pub(super) struct Named {
    name: String,
    cost: Arc<dyn Cost>,
}

impl Named {
    pub fn new(name: &str, cost: Box<dyn Cost>) -> Self {
        Self { name: name.to_owned(), cost: cost.into() }
    }
}

impl Cost for Named {
    fn name(&self) -> &str {
        &self.name
    }

    fn at(&self, at: &CostContext) -> Result<Arc<dyn CostPoint>, ControlError> {
        self.cost.at(at)
    }

    fn stages(&self) -> usize {
        self.cost.stages()
    }

    fn numbers(&self) -> Option<usize> {
        self.cost.numbers()
    }

    fn has_position(&self) -> bool {
        self.cost.has_position()
    }

    fn check_in_motion(&self, solid: &Solid, timeline: &Timeline, at_start: bool) -> Result<(), ControlError> {
        self.cost.check_in_motion(solid, timeline, at_start)
    }

    fn needs_step(&self) -> bool {
        self.cost.needs_step()
    }

    fn depends_on_materials(&self) -> bool {
        self.cost.depends_on_materials()
    }

    fn smoothings(&self) -> Vec<Smoothing> {
        self.cost.smoothings()
    }

    fn size(&self) -> Option<String> {
        self.cost.size().map(|size| format!("{} {size}", self.name))
    }

    fn warnings(&self, solid: &Solid) -> Vec<String> {
        self.cost.warnings(solid)
    }

    fn target(&self, solid: &Solid) -> Option<CostTarget> {
        self.cost.target(solid)
    }

    fn aim(&self, solid: &Solid, u: &[f64]) -> Option<Aim> {
        self.cost.aim(solid, u)
    }
}

/// A term of a motion under the name the case gives it.
#[derive(Debug)]
pub(super) struct NamedMotionTerm {
    pub name: String,
    pub cost: Box<dyn TrajectoryCost>,
}

impl TrajectoryCost for NamedMotionTerm {
    fn name(&self) -> &str {
        &self.name
    }

    fn check(&self, layout: &Layout, timeline: &Timeline) -> Result<(), ControlError> {
        self.cost.check(layout, timeline)
    }

    fn needs_states(&self) -> bool {
        self.cost.needs_states()
    }

    fn value(&self, at: &TrajectoryContext) -> Result<f64, ControlError> {
        self.cost.value(at)
    }

    fn add_partials(&self, at: &TrajectoryContext, out: &mut TrajectoryPartials) -> Result<(), ControlError> {
        self.cost.add_partials(at, out)
    }
}
