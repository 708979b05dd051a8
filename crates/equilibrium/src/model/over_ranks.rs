//! A [`Model`] over ranks: what they agree on, and what is refused there.

use super::Model;
use crate::model::views::OverRanks;
use nastic_body::contribution::Sums;
use nastic_body::discretization::parted::{all_accept, not_over_ranks, unless_elsewhere};
use nastic_body::error::{FemError, Inadmissible};
use nastic_linear::{Share, SolverFactory};

impl Model {
    /// Refuses solvers that know the matrix of one rank alone; without one, the solver that suits a body on one rank.
    pub(crate) fn check_spans_ranks(&self, wanted: Option<&dyn SolverFactory>) -> Result<(), FemError> {
        let wanted = wanted.unwrap_or_else(|| self.solver());
        if !self.ranks().is_over_ranks() || wanted.spans_ranks() {
            return Ok(());
        }
        let why = "it knows the tangent of one rank alone: take a solver that spans ranks (nastic-petsc), by Solid::solver or SolveOptions::solver";
        Err(not_over_ranks(&format!("solver \"{}\"", wanted.name()), why))
    }

    /// What was found, or that another rank has found its part inadmissible.
    pub(crate) fn agreed<T>(&self, found: Result<T, Inadmissible>) -> Result<T, Inadmissible> {
        unless_elsewhere(self.share(), found, |_| Inadmissible::Elsewhere)
    }

    fn share(&self) -> Option<&Share> {
        self.unknowns().share().map(AsRef::as_ref)
    }

    /// Energies and residuals by the cells of every rank become those of the whole.
    pub(crate) fn sum_over_ranks(&self, sums: &mut Sums) {
        let Some(share) = self.unknowns().share() else { return };
        let mut energies = [sums.energy, sums.energy_scale];
        share.sum(&mut energies);
        [sums.energy, sums.energy_scale] = energies;
        sums.min_j = self.unknowns().least(sums.min_j);
        if !sums.force.is_empty() {
            self.unknowns().add_up(&mut sums.force);
            self.unknowns().add_up(&mut sums.force_scale);
        }
    }
}

impl OverRanks<'_> {
    /// Whether it is the part of one rank among several.
    pub fn is_over_ranks(&self) -> bool {
        self.model.unknowns().share().is_some()
    }

    /// Refuses what knows of bodies alone that one rank has; of these nothing happens.
    ///
    /// # Errors
    /// [`FemError::Unsupported`] of a body over ranks, with what it is.
    pub fn refuse_ranks(&self, what: &str) -> Result<(), FemError> {
        match self.is_over_ranks() {
            false => Ok(()),
            true => Err(not_over_ranks(what, "it would have to know other parts of the body: solve it on one rank")),
        }
    }

    /// What a rank has checked by itself, or that another one refuses its part: before messages that would wait for that one.
    ///
    /// # Errors
    /// As [`all_accept`].
    pub fn all_accept<T, E: From<FemError>>(&self, found: Result<T, E>) -> Result<T, E> {
        all_accept(self.model.share(), found)
    }

    /// The result of a solve, unless messages between the ranks have failed.
    ///
    /// # Errors
    /// What was found; [`FemError::Team`] where messages have failed.
    pub fn unless_parted<T, E: From<FemError>>(&self, found: Result<T, E>) -> Result<T, E> {
        match self.model.unknowns().share().and_then(|share| share.failure()) {
            None => found,
            Some(failure) => Err(FemError::from(failure).into()),
        }
    }
}
