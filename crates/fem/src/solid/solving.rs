//! What a [`Solid`] answers: states, adjoints, pivots and modes of its [`Model`](nastic_equilibrium::model::Model).

use super::Solid;
use nastic_body::controls::Controls;
use nastic_body::error::StateError;
use nastic_body::state::State;
use nastic_equilibrium::adjoint::Adjoint;
use nastic_equilibrium::linear_systems::workspace::Workspace;
use nastic_equilibrium::search::options::SolveOptions;
use nastic_equilibrium::stability::modes::Modes;

impl Solid {
    /// [`Model::solve`](nastic_equilibrium::model::Model::solve).
    ///
    /// # Errors
    /// As there.
    pub fn solve(&self, controls: &Controls, how: &SolveOptions) -> Result<State, StateError> {
        self.model.solve(controls, how)
    }

    /// [`Model::solve_with`](nastic_equilibrium::model::Model::solve_with).
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

    /// [`Model::adjoint`](nastic_equilibrium::model::Model::adjoint).
    ///
    /// # Errors
    /// As there.
    pub fn adjoint(&self, state: &State, rhs: &[&[f64]], how: &SolveOptions) -> Result<Adjoint, StateError> {
        self.model.adjoint(state, rhs, how)
    }

    /// [`Model::adjoint_with`](nastic_equilibrium::model::Model::adjoint_with).
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

    /// [`Stability::negative_pivots`](nastic_equilibrium::model::views::Stability::negative_pivots).
    ///
    /// # Errors
    /// As there.
    pub fn negative_pivots(&self, state: &State) -> Result<usize, StateError> {
        self.model.stability().negative_pivots(state)
    }

    /// [`Stability::negative_pivots_by`](nastic_equilibrium::model::views::Stability::negative_pivots_by).
    ///
    /// # Errors
    /// As there.
    pub fn negative_pivots_by(&self, state: &State, how: &SolveOptions) -> Result<usize, StateError> {
        self.model.stability().negative_pivots_by(state, how)
    }

    /// [`Stability::modes`](nastic_equilibrium::model::views::Stability::modes).
    ///
    /// # Errors
    /// As there.
    pub fn modes(&self, state: &State, count: usize, how: &SolveOptions) -> Result<Modes, StateError> {
        self.model.stability().modes(state, count, how)
    }

    /// [`Model::rest`](nastic_equilibrium::model::Model::rest), and with the designs of controls [`Model::rest_under`](nastic_equilibrium::model::Model::rest_under).
    pub fn rest(&self) -> State {
        self.model.rest()
    }
}
