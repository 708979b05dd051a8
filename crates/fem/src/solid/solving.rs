//! What a [`Solid`] answers: states, adjoints, pivots and modes of its [`Model`](crate::Model).

use super::Solid;
use crate::adjoint::Adjoint;
use crate::contributions::Controls;
use crate::error::StateError;
use crate::solution::modes::Modes;
use crate::solution::options::SolveOptions;
use crate::solution::state::State;
use crate::solution::workspace::Workspace;

impl Solid {
    /// [`Model::solve`](crate::Model::solve).
    ///
    /// # Errors
    /// As there.
    pub fn solve(&self, controls: &Controls, how: &SolveOptions) -> Result<State, StateError> {
        self.model.solve(controls, how)
    }

    /// [`Model::solve_with`](crate::Model::solve_with).
    ///
    /// # Errors
    /// As there.
    pub fn solve_with(
        &self,
        controls: &Controls,
        how: &SolveOptions,
        workspace: &mut Workspace,
    ) -> Result<State, StateError> {
        self.model.solve_with(controls, how, workspace)
    }

    /// [`Model::adjoint`](crate::Model::adjoint).
    ///
    /// # Errors
    /// As there.
    pub fn adjoint(&self, state: &State, rhs: &[&[f64]], how: &SolveOptions) -> Result<Adjoint, StateError> {
        self.model.adjoint(state, rhs, how)
    }

    /// [`Model::adjoint_with`](crate::Model::adjoint_with).
    ///
    /// # Errors
    /// As there.
    pub fn adjoint_with(
        &self,
        state: &State,
        rhs: &[&[f64]],
        how: &SolveOptions,
        workspace: &mut Workspace,
    ) -> Result<Adjoint, StateError> {
        self.model.adjoint_with(state, rhs, how, workspace)
    }

    /// [`Model::negative_pivots`](crate::Model::negative_pivots).
    ///
    /// # Errors
    /// As there.
    pub fn negative_pivots(&self, state: &State) -> Result<usize, StateError> {
        self.model.negative_pivots(state)
    }

    /// [`Model::negative_pivots_by`](crate::Model::negative_pivots_by).
    ///
    /// # Errors
    /// As there.
    pub fn negative_pivots_by(&self, state: &State, how: &SolveOptions) -> Result<usize, StateError> {
        self.model.negative_pivots_by(state, how)
    }

    /// [`Model::modes`](crate::Model::modes).
    ///
    /// # Errors
    /// As there.
    pub fn modes(&self, state: &State, count: usize, how: &SolveOptions) -> Result<Modes, StateError> {
        self.model.modes(state, count, how)
    }

    /// [`Model::rest`](crate::Model::rest), and with the designs of controls [`Model::rest_under`](crate::Model::rest_under).
    pub fn rest(&self) -> State {
        self.model.rest()
    }
}
