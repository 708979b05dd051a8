//! [`TimeStepping`]: what a [`Model`] does in time.

use crate::adaptive::{self, AdaptiveReport, Tolerance};
use crate::instant_adjoint::StatePartials;
use crate::reverse_sweep::{self, Swept};
use crate::scheme::Scheme;
use crate::trajectory::{StepTo, Trajectory};
use crate::vibration_modes::{self, VibrationMode};
use crate::{beginning, step, supported};
use nastic_body::controls::Controls;
use nastic_body::error::{FemError, StateError};
use nastic_body::state::State;
use nastic_equilibrium::linear_systems::workspace::Workspace;
use nastic_equilibrium::model::Model;
use nastic_equilibrium::search::options::SolveOptions;
use std::borrow::Borrow;

/// Steps in time of a [`Model`], their discrete adjoint, small vibrations.
pub trait TimeStepping: Borrow<Model> {
    /// Whether a motion may begin with the velocity of a state: nodes that follow others have that of these, and constraints on a few nodes are kept to
    /// first order, by which the velocity of a rigid body is a translation and a rotation. A state that a motion led to, t > 0, has the velocity that
    /// its scheme gave it, which keeps constraints as far as the scheme is accurate, and of a body at rest is rounding: it is not checked.
    ///
    /// # Errors
    /// [`FemError::Meaningless`]: of which body, and how far off it is.
    fn check_velocity(&self, begin: &State) -> Result<(), FemError> {
        beginning::check_velocity(self.borrow(), begin)
    }

    /// Whether the model goes with steps of a scheme: asked once, before anything is computed.
    ///
    /// # Errors
    /// [`FemError::Unsupported`]: what, with which contribution or law it does not go, and what does instead.
    fn supports_motion(&self, scheme: &Scheme) -> Result<(), FemError> {
        supported::supports_motion(self.borrow(), scheme)
    }

    /// The same of the derivative of a functional of a motion.
    ///
    /// # Errors
    /// As [`supports_motion`](Self::supports_motion); of a scheme without adjoint.
    fn supports_motion_adjoint(&self, scheme: &Scheme) -> Result<(), FemError> {
        supported::supports_motion_adjoint(self.borrow(), scheme)
    }

    /// Goes on from the end of a trajectory by steps of a scheme, at full dead loads. Each stage is an equilibrium of
    /// inertia and forces that minimises an incremental potential, found like a static one from the stage before, or
    /// from where the last acceleration (without inertia the last velocity) leads, where that potential is lower (without a potential, where the
    /// residual is smaller): `near` and `guess` of the options are not used. With friction the velocity at the beginning and the motion of the obstacles are guesses too.
    /// A step of a body in contact that has no solution is made as 2, 4, 8 or 16 steps of the scheme in one ([`Trajectory::scheme`] has the stages of
    /// all), not with internal variables, lagged friction or supports that move. A body may be free. A state that does not carry the
    /// acceleration that a scheme begins with gets it from `M a = -r(u, v, 0)`.
    ///
    /// Surfaces that controls move ([`MovingSupport`](nastic_forces::moving_support::MovingSupport)) are where the controls of an instant hold them, at the end of every step:
    /// `u_D(m_{n+1})`, also where the end is extrapolated. A stage that the end is not extrapolated from has them where its own controls
    /// do. Their velocities and accelerations are those of the formulas of the scheme; those of the first state are what it carries, or
    /// zero.
    ///
    /// Source: docs/model/motion.md.
    ///
    /// # Errors
    /// A step that is not positive; a surface that is not where the controls of the last state hold it; a [`StateError`] at the first step that has no solution, with the steps before it
    /// in the trajectory.
    fn advance(
        &self,
        trajectory: &mut Trajectory,
        scheme: &Scheme,
        steps: &[StepTo],
        how: &SolveOptions,
        workspace: &mut Workspace,
    ) -> Result<(), StateError> {
        step::advance(self.borrow(), trajectory, scheme, steps, how, workspace)
    }

    /// Goes on from the end of a trajectory through given instants, by steps as long as the estimated error of each allows: at every
    /// node at most `tolerance.error`. `controls(t)` are those at an instant; between the ends of a step they are linear. A step
    /// without a solution is tried again shorter. The trajectory is then one like any other: its adjoint takes the lengths as data.
    ///
    /// The error of a step of TR-BDF2 is estimated by `h (-v_n + 2 v* - v)/6`, v* the velocity in its middle (Bank et al., IEEE Trans.
    /// Electron Devices 32, 1985), and goes like h^3; steps change by the factor `0.9 (tolerance/error)^(1/3)`.
    ///
    /// # Errors
    /// A scheme without an estimate, a tolerance that is not positive, instants that do not increase; a [`StateError`] where steps
    /// would have to be shorter than 1e-9 of the whole time, with the steps before in the trajectory.
    fn advance_adaptively(
        &self,
        trajectory: &mut Trajectory,
        scheme: &Scheme,
        goals: (&[f64], Tolerance),
        controls: &dyn Fn(f64) -> Result<Controls, FemError>,
        how: &SolveOptions,
        workspace: &mut Workspace,
    ) -> Result<AdaptiveReport, StateError> {
        adaptive::advance_adaptively(self.borrow(), trajectory, scheme, goals, controls, how, workspace)
    }

    /// The instants that [`advance_adaptively`](Self::advance_adaptively) leads through, and what they took. The trajectory keeps its end
    /// alone: the steps of a long motion, in the memory of two.
    ///
    /// # Errors
    /// As there; the trajectory then ends where the motion failed.
    fn find_steps(
        &self,
        trajectory: &mut Trajectory,
        scheme: &Scheme,
        goals: (&[f64], Tolerance),
        controls: &dyn Fn(f64) -> Result<Controls, FemError>,
        how: &SolveOptions,
        workspace: &mut Workspace,
    ) -> Result<(Vec<f64>, AdaptiveReport), StateError> {
        adaptive::find_steps(self.borrow(), trajectory, scheme, goals, controls, how, workspace)
    }

    /// The estimated error that the last step of a trajectory has added to the displacement, the largest at any free node; none of a scheme
    /// without an estimate, and where no step was made.
    fn last_step_error(&self, trajectory: &Trajectory) -> Option<f64> {
        adaptive::last_step_error(self.borrow(), trajectory)
    }

    /// The `count` modes of the algebraically smallest `w^2` about a state, ascending, and all with a negative one in
    /// any case.
    ///
    /// Neither damping nor, in a state of a motion, its velocity counts; of viscous laws the stiffness that the state
    /// has, relaxed in an equilibrium. Of multiple frequencies every mode is found; which basis of their span is
    /// returned has no meaning. The Galerkin method with the consistent mass gives frequencies from above, with a
    /// relative error of `O(h^(2p))` on cells of order p. A lumped mass adds an error of its own: the first bending
    /// frequency of a free beam of 12 hex20 is 1.3 % too low with it, 0.1 % too high with the consistent one.
    ///
    /// # Errors
    /// [`FemError::Meaningless`] for nodes without mass; otherwise as [`Stability::modes`](nastic_equilibrium::model::views::Stability::modes).
    fn vibration_modes(
        &self,
        state: &State,
        count: usize,
        how: &SolveOptions,
    ) -> Result<Vec<VibrationMode>, StateError> {
        vibration_modes::vibration_modes(self.borrow(), state, count, how)
    }

    /// The derivative of `j(y_0, .., y_N)` by the controls of every instant, given its partial derivatives: every
    /// step is a chain of linear combinations and of solves `r(w, v, a; m) = 0` (see [`Scheme`](crate::scheme::Scheme)),
    /// which the sweep passes backwards. With `v = c_v w + b_v`, `a = c_a w + b_a` and K the tangent of the stage,
    ///
    /// ```text
    /// K^T l = -(dj/dw + c_v dj/dv + c_a dj/da)
    /// dj/db_v = dj/dv + l . dr/dv,    dj/db_a = dj/da + l . dr/da,    dj/dm = l . dr/dm
    /// ```
    ///
    /// one transposed solve per stage; then the combinations transposed. Unknowns D that controls hold have the sensitivity by them `(dj/dw + c_v dj/dv + c_a dj/da + K^T l)_D .
    /// dw_D/dm`. An acceleration `M a = -r(u, v, 0; m)` at
    /// the beginning and an equilibrium there take a solve each. A static problem is a trajectory of one instant, and
    /// this its adjoint. Source: docs/model/motion.md.
    ///
    /// # Errors
    /// A tangent that is singular, partial derivatives of the wrong length, states of another body or with internal
    /// variables of contributions.
    fn reverse_sweep(
        &self,
        trajectory: &Trajectory,
        partials: &[StatePartials],
        how: &SolveOptions,
        workspace: &mut Workspace,
    ) -> Result<Swept, StateError> {
        reverse_sweep::reverse_sweep(self.borrow(), trajectory, partials, how, workspace)
    }
}

impl TimeStepping for Model {}
