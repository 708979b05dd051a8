//! Uncertain numbers of a body: held at their medians, with derivatives beside those of the controls.

use super::second_order::{Direction, Wanted};
use super::{Lagrangian, Reduced};
use crate::evaluated::Evaluated;
use crate::workspace::ReducedWorkspace;
use nastic_fields::{ControlBlock, ControlError, Layout, Space};
use nastic_opt::Hessian;

/// Numbers x that the control vector does not have: fields of slots on top of which it stands, and their values.
#[derive(Debug, Clone)]
pub(super) struct Uncertain {
    layout: Layout,
    values: Vec<f64>,
}

impl Uncertain {
    pub fn none(layout: &Layout) -> Self {
        Uncertain { layout: Layout::new(layout.fixed().clone()), values: vec![] }
    }
}

impl Reduced {
    /// Makes a number of a law (`MATERIAL.NUMBER`) uncertain: it is held at its medians, one for each unknown of the space, and the cost has
    /// derivatives by it ([`derivative_by_uncertain`](Self::derivative_by_uncertain), [`mixed_second_derivative`](Self::mixed_second_derivative)). The vector x of all
    /// that are made so stands in their order.
    ///
    /// # Errors
    /// Unknown names, a number that is uncertain twice or controlled as well, medians of another number than there are unknowns.
    pub fn uncertain(mut self, of: &str, space: Space, medians: &[f64]) -> Result<Self, ControlError> {
        let mut own = self.uncertain.take().unwrap_or_else(|| Uncertain::none(&self.layout));
        let added = own.layout.control(&self.solid, of, space)?.clone();
        if added.len() != medians.len() {
            return Err(ControlError::Length { found: medians.len(), expected: added.len() });
        }
        for target in &added.targets {
            self.layout.check_free(of, target.actuation, target.slot..target.slot + target.slots, &target.basis)?;
        }
        let at = ControlBlock { first: 0, ..added };
        at.write_values(medians, self.layout.fixed_mut());
        own.values.extend_from_slice(medians);
        self.uncertain = Some(own);
        self.update_layout();
        Ok(self)
    }

    /// Names and lengths of the uncertain numbers, in the order of x.
    pub fn uncertain_numbers(&self) -> Vec<(&str, usize)> {
        let blocks = self.uncertain.iter().flat_map(|own| own.layout.blocks());
        blocks.map(|block| (block.name.as_str(), block.len())).collect()
    }

    /// Whether all costs have derivatives by uncertain numbers.
    ///
    /// # Errors
    /// The first cost that [depends on numbers of materials](crate::Cost::depends_on_materials) beside the displacement.
    pub fn check_uncertain(&self) -> Result<(), ControlError> {
        match self.costs.iter().find(|cost| self.uncertain.is_some() && cost.depends_on_materials()) {
            Some(cost) => Err(ControlError::Cost { what: of_materials(cost.name()) }),
            None => Ok(()),
        }
    }

    /// `djhat/dm` and `djhat/dx`, by one adjoint, which is left in the point: one linear solve.
    ///
    /// # Errors
    /// A singular tangent, a cost that is not defined, one that is [refused](Self::check_uncertain); a motion, a body over ranks.
    pub fn derivative_by_uncertain(
        &self,
        point: &mut Evaluated,
        workspace: &mut ReducedWorkspace,
    ) -> Result<[Vec<f64>; 2], ControlError> {
        self.solid.model().ranks().refuse_ranks("derivatives by uncertain numbers")?;
        self.check_uncertain()?;
        let derivative = self.derivative_of_point(point, Lagrangian { costs: true, y: &[] }, workspace)?;
        let Some(own) = &self.uncertain else { return Ok([derivative, vec![]]) };
        let Some(lambda) = point.adjoint() else { return Ok([derivative, vec![0.0; own.values.len()]]) };
        let by_point = self.by_point(point, &self.partials(point, None)?.u, lambda)?;
        Ok([derivative, own.layout.control_vjp(&own.values, &by_point)])
    }

    /// `d2jhat/dm dx v` along a change v of x, two linear solves: that of [`hessian_vector`](Self::hessian_vector) on the joined vector (m, x) along (0, v), without its part by x.
    ///
    /// # Errors
    /// As there.
    pub fn mixed_second_derivative(
        &self,
        point: &Evaluated,
        v: &[f64],
        workspace: &mut ReducedWorkspace,
    ) -> Result<Vec<f64>, ControlError> {
        let Some(own) = &self.uncertain else { return Ok(vec![0.0; point.m.len()]) };
        let along = own.layout.change(&own.values, v)?;
        self.solid.model().ranks().refuse_ranks("second derivatives")?;
        self.refuse_projection("second derivatives")?;
        self.refuse_motion("second derivatives")?;
        let along = Direction { by_control: vec![0.0; point.m.len()], at_points: along };
        let want = Wanted { of: None, which: Hessian::Exact, first: false };
        Ok(self.second_derivative_along(point, want, &along, workspace)?.product)
    }
}

/// Why a cost has no derivatives by uncertain numbers.
fn of_materials(name: &str) -> String {
    format!(
        "the cost \"{name}\" depends on numbers of materials also beside the displacement, by which it has no derivatives here; make scenarios by a \"rule\" and take \"mean_deviation\""
    )
}
