//! [`Body`]: what a problem of optimal control asks of the body that it controls.

use nastic_body::controls::Controls;
use nastic_body::error::StateError;
use nastic_body::state::State;
use nastic_equilibrium::linear_systems::workspace::Workspace;
use nastic_equilibrium::model::Model;
use nastic_equilibrium::search::options::SolveOptions;
use nastic_motion::TimeStepping;
use nastic_motion::instant_adjoint::StatePartials;
use nastic_motion::reverse_sweep::Swept;
use nastic_motion::trajectory::Trajectory;
use std::fmt::Debug;

/// A body under controls m, of which states are found in the space of displacements that it allows:
///
/// ```text
/// u(m) = U(q(m)),   R(q, m) = (dU/dq)^T r(U(q), m) = 0,
/// ```
///
/// r the residual of a [`Model`]. The model itself has U(q) = q on its free unknowns; a projection on modes V has `U(q) = u_0 + V q`. States hold the
/// displacement u, not q: costs, constraints and results are those of the model. Motions, second derivatives and paths of equilibria are the model's alone.
pub trait Body: Debug + Send + Sync {
    /// What it is called in messages.
    fn name(&self) -> &str;

    /// The equilibrium under controls.
    ///
    /// # Errors
    /// No equilibrium; controls of the wrong length.
    fn solve(&self, controls: &Controls, how: &SolveOptions, workspace: &mut Workspace) -> Result<State, StateError>;

    /// The adjoint of a functional with these partial derivatives by the states, and its derivative by the controls through them: of one equilibrium
    ///
    /// ```text
    /// (dU^T K dU) mu = -dU^T dj/du,   lambda = dU mu,   r_m^T lambda.
    /// ```
    ///
    /// # Errors
    /// A tangent that is singular, partial derivatives of the wrong length.
    fn adjoint(
        &self,
        trajectory: &Trajectory,
        partials: &[StatePartials],
        how: &SolveOptions,
        workspace: &mut Workspace,
    ) -> Result<Swept, StateError>;

    /// Negative eigenvalues of the tangent in an equilibrium.
    ///
    /// # Errors
    /// A tangent that is singular.
    fn negative_pivots(&self, state: &State, how: &SolveOptions) -> Result<usize, StateError>;
}

impl Body for Model {
    fn name(&self) -> &str {
        "finite elements"
    }

    fn solve(&self, controls: &Controls, how: &SolveOptions, workspace: &mut Workspace) -> Result<State, StateError> {
        self.solve_with(controls, how, workspace)
    }

    fn adjoint(
        &self,
        trajectory: &Trajectory,
        partials: &[StatePartials],
        how: &SolveOptions,
        workspace: &mut Workspace,
    ) -> Result<Swept, StateError> {
        self.reverse_sweep(trajectory, partials, how, workspace)
    }

    fn negative_pivots(&self, state: &State, how: &SolveOptions) -> Result<usize, StateError> {
        self.stability().negative_pivots_by(state, how)
    }
}
