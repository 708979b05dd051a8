//! First derivatives of the reduced cost.

use super::motion_derivative::Functional;
use super::{Lagrangian, Reduced};
use crate::cost::Partials;
use crate::evaluated::{AdjointState, Evaluated};
use crate::workspace::ReducedWorkspace;
use nastic_fem::{Controls, SolveOptions, StatePartials};
use nastic_fields::ControlError;

impl Reduced {
    /// Partial derivatives of the cost of a static problem (all terms, or one of them); of a body over ranks the share of this one, which all ranks
    /// ask for together.
    ///
    /// # Errors
    /// A cost that is not defined there.
    pub fn partials(&self, point: &Evaluated, term: Option<usize>) -> Result<Partials, ControlError> {
        self.refuse_motion("partial derivatives by one state")?;
        let mut partials = Partials::zero(point.state().u.len(), point.m.len());
        for (k, cost) in self.costs_of(point)?.iter().enumerate() {
            if term.is_none_or(|t| t == k) {
                // the next cost may tell the others something: none goes on alone
                self.solid.model().ranks().all_accept(cost.add_partials(&mut partials))?;
            }
        }
        Ok(partials)
    }

    /// `djhat/dm` of one term.
    ///
    /// # Errors
    /// A tangent that is singular, a cost that is not defined.
    pub fn derivative_of_term(
        &self,
        point: &Evaluated,
        term: usize,
        workspace: &mut ReducedWorkspace,
    ) -> Result<Vec<f64>, ControlError> {
        self.sensitivity(point, Some(term), workspace).map(|(derivative, _)| derivative)
    }

    /// `(du/dm)^T w` of an equilibrium: the derivative by the control of `w . u` at fixed w, one linear solve; a dual vector.
    ///
    /// `w`: one number per displacement component, supported ones included, in the order of nodes; of a body over ranks
    /// the share of this one.
    ///
    /// # Errors
    /// [`ControlError::Length`]; a tangent that is singular; a motion.
    pub fn displacement_vjp(
        &self,
        point: &Evaluated,
        w: &[f64],
        workspace: &mut ReducedWorkspace,
    ) -> Result<Vec<f64>, ControlError> {
        self.refuse_motion("derivatives of displacement fields")?;
        let (found, expected) = (w.len(), point.state().u.len());
        let fits = if found == expected { Ok(()) } else { Err(ControlError::Length { found, expected }) };
        self.solid.model().ranks().all_accept(fits)?;
        let partials = Partials { u: w.to_vec(), m: vec![0.0; point.m.len()] };
        self.sensitivity_of_all(point, Ok(partials), workspace).map(|(derivative, _)| derivative)
    }

    /// `djhat/dm` of all terms, or of one, and the adjoint state; no adjoint where no term depends on the state.
    pub(crate) fn sensitivity(
        &self,
        point: &Evaluated,
        term: Option<usize>,
        workspace: &mut ReducedWorkspace,
    ) -> Result<(Vec<f64>, Option<AdjointState>), ControlError> {
        if let Some(motion) = &self.motion {
            let of = term.map_or(Functional::costs(), Functional::Term);
            let at = (point.m.as_slice(), point.stage);
            return self.derivative_of_motion(motion, at, &mut point.solved.clone(), of, workspace);
        }
        self.sensitivity_of_all(point, self.partials(point, term), workspace)
    }

    /// That of all terms, whose adjoint state is left in the point; a motion that keeps few states has only its beginning left then.
    pub(super) fn derivative_of_point(
        &self,
        point: &mut Evaluated,
        of: Lagrangian<'_>,
        workspace: &mut ReducedWorkspace,
    ) -> Result<Vec<f64>, ControlError> {
        let (derivative, adjoint) = match &self.motion {
            Some(motion) => {
                let at = (point.m.as_slice(), point.stage);
                self.derivative_of_motion(motion, at, &mut point.solved, Functional::Lagrangian(of), workspace)?
            }
            None => self.sensitivity_of_all(point, self.lagrangian_partials(point, of), workspace)?,
        };
        point.adjoint = adjoint.map(|adjoint| AdjointState { multipliers: of.multipliers(), ..adjoint });
        Ok(derivative)
    }

    /// The same of partials that all ranks have found, or none.
    fn sensitivity_of_all(
        &self,
        point: &Evaluated,
        partials: Result<Partials, ControlError>,
        workspace: &mut ReducedWorkspace,
    ) -> Result<(Vec<f64>, Option<AdjointState>), ControlError> {
        let found = partials.and_then(|partials| self.sensitivity_of(point, partials, workspace));
        self.solid.model().ranks().unless_parted(found)
    }

    /// `d/dm` of what has these partials, and its adjoint state.
    pub(super) fn sensitivity_of(
        &self,
        point: &Evaluated,
        mut partials: Partials,
        workspace: &mut ReducedWorkspace,
    ) -> Result<(Vec<f64>, Option<AdjointState>), ControlError> {
        let space = self.solid.model().unknowns();
        space.add_up(&mut partials.u);
        if !space.any(partials.u.iter().any(|&d| d != 0.0)) {
            return Ok((self.whole_derivative(partials.m, &[])?, None));
        }
        let how = SolveOptions { parallel: self.parallel, ..SolveOptions::default() };
        let (trajectory, by_state) = (point.solved.recording.part(), StatePartials::by_displacement(partials.u));
        let swept = self.body().adjoint(trajectory, &[by_state], &how, &mut workspace.solve);
        self.forget(workspace);
        let mut swept = swept?;
        if let Some(body) = &self.projected {
            let is_adjoint = swept.lambda.first().is_some_and(|lambda| lambda.len() == point.state().u.len())
                && swept
                    .controls
                    .first()
                    .is_some_and(|by| by.clone().zeroed() == Controls::clone(&point.state().controls).zeroed());
            if !is_adjoint {
                let what = format!("\"{}\" found no adjoint and derivative of the lengths of the body", body.name());
                return Err(ControlError::Cost { what });
            }
        }
        let through_state = self.layout_in_stage(point.stage).control_vjp(&point.m, &swept.controls[0]);
        let derivative = self.whole_derivative(partials.m, &through_state)?;
        let (lambda, work) = (swept.lambda.swap_remove(0), swept.report);
        Ok((derivative, Some(AdjointState { lambda, work, multipliers: vec![] })))
    }
}
