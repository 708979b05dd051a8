//! Derivatives of the displacement fields of all members by the control vector.

use super::Ensemble;
use crate::error::EnsembleError;
use crate::member::Member;
use crate::point::{EnsemblePoint, EnsembleWorkspace};
use nastic_control::ReducedWorkspace;

impl Ensemble {
    /// `sum_k (du_k/dm)^T w_k` over the members k with a vector w_k (none where it is empty), each as
    /// [`Reduced::displacement_vjp`](nastic_control::Reduced::displacement_vjp) has it: one linear solve for each of them.
    ///
    /// # Errors
    /// Those of a member, with its name.
    pub fn displacement_vjp(
        &self,
        point: &EnsemblePoint,
        w: &[Vec<f64>],
        workspace: &mut EnsembleWorkspace,
    ) -> Result<Vec<f64>, EnsembleError> {
        let of = |index: usize, member: &Member, workspace: &mut ReducedWorkspace| match (
            w.get(index).filter(|w| !w.is_empty()),
            point.member(index),
        ) {
            (Some(w), Some(at)) => member.problem.displacement_vjp(at, w, workspace).map(Some),
            _ => Ok(None),
        };
        let (found, _) = self.side_by_side(workspace, of, |_, _| ())?;
        self.sum(found.iter().map(|own| Some((1.0, own.as_deref()?))))
    }
}
