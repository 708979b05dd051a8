//! [`States`]: what a command found, as values.

use nastic_case::lower::{CaseMember, CaseProblem};
use nastic_control::{ControlError, StateFields};
use nastic_ensemble::EnsemblePoint;
use nastic_mesh::Snapshot;
use nastic_picture::{PictureError, Sheet};
use nastic_result::inspection::Inspection;
use nastic_result::picture::Drawing;
use nastic_result::title::title;
use nastic_result::{picture, snapshot};

/// The states that a command found, with the problem they belong to.
#[derive(Debug)]
pub struct States {
    problem: CaseProblem,
    shown: Shown,
}

/// What is shown of the states.
#[derive(Debug)]
pub(crate) struct Shown {
    /// "equilibrium" or "optimum".
    pub what: &'static str,
    /// Line below the title of pictures.
    pub subtitle: String,
    pub point: EnsemblePoint,
    /// Derivative of the cost there.
    pub derivative: Option<Vec<f64>>,
    /// The start of an optimisation.
    pub start: Option<EnsemblePoint>,
    /// What was found in the states.
    pub inspections: Vec<Inspection>,
}

/// Why states cannot be shown.
#[derive(Debug, thiserror::Error)]
pub enum ShowError {
    /// An array does not fit its mesh.
    #[error(transparent)]
    Snapshot(#[from] ControlError),
    /// There is nothing to draw.
    #[error(transparent)]
    Picture(#[from] PictureError),
}

impl States {
    pub(super) fn new(problem: CaseProblem, shown: Shown) -> Self {
        Self { problem, shown }
    }

    /// The problem.
    #[must_use]
    pub fn problem(&self) -> &CaseProblem {
        &self.problem
    }

    /// Control and states of all members.
    #[must_use]
    pub fn point(&self) -> &EnsemblePoint {
        &self.shown.point
    }

    /// The derivative dj/dm_i of the cost there, a dual vector, where the command asked for it.
    #[must_use]
    pub fn derivative(&self) -> Option<&[f64]> {
        self.shown.derivative.as_deref()
    }

    /// The state of a member with all fields of its VTU file.
    ///
    /// # Errors
    /// As [`nastic_control::Reduced::snapshot_of`].
    pub fn snapshot(&self, member: CaseMember<'_>) -> Result<Snapshot, ControlError> {
        let Shown { point, derivative, inspections, .. } = &self.shown;
        let at = &point.members[member.index()];
        let gradient = derivative.as_ref().zip(self.problem.inner_product()).map(|(dual, product)| product.riesz(dual));
        let gradient = gradient.map(|gradient| member.local(&gradient));
        let fields = StateFields { adjoint: at.adjoint(), gradient: gradient.as_deref(), ..StateFields::of(at) };
        snapshot::inspected(member, &fields, inspections.get(member.index()))
    }

    /// `picture.png` of a member, as bytes.
    ///
    /// # Errors
    /// [`ShowError`].
    pub fn picture(&self, member: CaseMember<'_>) -> Result<Vec<u8>, ShowError> {
        let shot = |point: &EnsemblePoint| {
            let at = &point.members[member.index()];
            snapshot::plain(member, &StateFields::of(at))
        };
        let body = shot(&self.shown.point)?;
        let start = self.shown.start.as_ref().map(shot).transpose()?;
        let drawing = Drawing {
            title: title(member),
            subtitle: self.shown.subtitle.clone() + &picture::legend(&body),
            body: (self.shown.what, &body),
            ghosts: start.iter().map(|start| ("start", start)).collect(),
            scenarios: Vec::new(),
            mean: None,
        };
        Ok(Sheet::new(picture::compose(member, &drawing)).png()?)
    }
}
