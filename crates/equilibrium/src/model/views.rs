//! What is asked of a [`Model`], by subject: each a value that [`Model`] hands out.

use super::Model;

/// What is asked of the stability of a model: pivots, modes, paths, other equilibria: [`Model::stability`].
#[derive(Debug, Clone, Copy)]
pub struct Stability<'a> {
    pub(crate) model: &'a Model,
}

/// The internal variables of a model: those of a step, how they go on, and the transpose: [`Model::memory`].
#[derive(Debug, Clone, Copy)]
pub struct InternalVariables<'a> {
    pub(crate) model: &'a Model,
}

/// The unknowns of a model that contributions hold at values of their controls: [`Model::prescribed_unknowns`].
#[derive(Debug, Clone, Copy)]
pub struct PrescribedUnknowns<'a> {
    pub(crate) model: &'a Model,
}

/// The tangents of a model, assembled or by products: [`Model::tangents`].
#[derive(Debug, Clone, Copy)]
pub struct Tangents<'a> {
    pub(crate) model: &'a Model,
}

/// A model over ranks: [`Model::ranks`].
#[derive(Debug, Clone, Copy)]
pub struct OverRanks<'a> {
    pub(crate) model: &'a Model,
}

/// Which moves every contribution of a model bears, and where one leads: [`Model::moves`].
#[derive(Debug, Clone, Copy)]
pub struct Moves<'a> {
    pub(crate) model: &'a Model,
}

/// Whether a model, a state, controls are complete for what is asked: [`Model::checks`].
#[derive(Debug, Clone, Copy)]
pub struct Checks<'a> {
    pub(crate) model: &'a Model,
}

/// What holds of all contributions of a model: [`Model::properties`].
#[derive(Debug, Clone, Copy)]
pub struct Properties<'a> {
    pub(crate) model: &'a Model,
}

/// Mass, energies and damping of a model: [`Model::energies`].
#[derive(Debug, Clone, Copy)]
pub struct Energies<'a> {
    pub(crate) model: &'a Model,
}

impl Model {
    /// What is asked of the stability of a model: pivots, modes, paths, other equilibria.
    pub fn stability(&self) -> Stability<'_> {
        Stability { model: self }
    }

    /// The internal variables of a model: those of a step, how they go on, and the transpose.
    pub fn memory(&self) -> InternalVariables<'_> {
        InternalVariables { model: self }
    }

    /// The unknowns of a model that contributions hold at values of their controls.
    pub fn prescribed_unknowns(&self) -> PrescribedUnknowns<'_> {
        PrescribedUnknowns { model: self }
    }

    /// The tangents of a model, assembled or by products.
    pub fn tangents(&self) -> Tangents<'_> {
        Tangents { model: self }
    }

    /// A model over ranks.
    pub fn ranks(&self) -> OverRanks<'_> {
        OverRanks { model: self }
    }

    /// Which moves every contribution of a model bears, and where one leads.
    pub fn moves(&self) -> Moves<'_> {
        Moves { model: self }
    }

    /// Whether a model, a state, controls are complete for what is asked.
    pub fn checks(&self) -> Checks<'_> {
        Checks { model: self }
    }

    /// What holds of all contributions of a model.
    pub fn properties(&self) -> Properties<'_> {
        Properties { model: self }
    }

    /// Mass, energies and damping of a model.
    pub fn energies(&self) -> Energies<'_> {
        Energies { model: self }
    }
}
