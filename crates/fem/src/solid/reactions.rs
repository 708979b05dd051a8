//! The forces of supports, of equilibria and in motions.

use super::Solid;
use nastic_body::contribution::Demand;
use nastic_body::error::Inadmissible;
use nastic_body::instant::{Instant, TimeStep};
use nastic_body::state::State;

impl Solid {
    /// The forces that every support, those that move too, exerts on the body: the sum over what it holds, D, of
    ///
    /// ```text
    /// (M a + C v + r(u; z_n, m))_D
    /// ```
    ///
    /// in the step that led to a state from `before`, with its internal variables z_n; of an equilibrium, and where a motion begins (`before` is none), of
    /// `M a + C v + r(u)` with relaxed internal variables. Velocities and accelerations are those of the state (none of a state that carries
    /// none, as in `implicit_midpoint`); where controls move the body the accelerations are the means over the step, `(v - v_n)/h`, of first order in every
    /// scheme (those of a stage are of none in some). A consistent mass counts the
    /// inertia of the cells beside D.
    ///
    /// Units: N; in plane strain N/m.
    ///
    /// # Errors
    /// [`Inadmissible`] where u is.
    pub fn reactions(&self, before: Option<&State>, state: &State) -> Result<Vec<(String, [f64; 3])>, Inadmissible> {
        let demand = Demand { energy: false, force: true };
        let at = Instant::of(state);
        if before.is_none() && state.velocity.is_none() {
            return Ok(self.supports().reactions(&self.model().evaluate(&at, demand)?.force));
        }
        let from = before.unwrap_or(state);
        let mut step = TimeStep::between(from, state);
        match before {
            // nothing has moved yet: after a long time
            None => (step.dt, step.elapsed) = (f64::INFINITY, f64::INFINITY),
            Some(before) => step.acceleration.1 = self.accelerations(before, state, step.acceleration.1, step.dt),
        }
        let force = self.model().evaluate(&at.in_step(&step), demand)?.force;
        Ok(self.supports().reactions(&force))
    }

    /// Accelerations: where controls move the body the mean over the step, zero throughout where a state has none.
    fn accelerations(&self, before: &State, state: &State, own: Vec<f64>, dt: f64) -> Vec<f64> {
        let supports = self.supports();
        let is_moved = (0..supports.fixed().len()).any(|dof| supports.fixed()[dof] && !supports.holds_still(dof));
        let (Some(after), true) = (&state.velocity, state.acceleration.is_some() && is_moved) else { return own };
        let earlier = |dof: usize| before.velocity.as_ref().map_or(0.0, |v| v[dof]);
        after.iter().enumerate().map(|(dof, v)| (v - earlier(dof)) / dt).collect()
    }

    /// The forces that the supports exert on the body, node by node (zero in components that no support holds), in three components: their
    /// sums over the nodes of a support are [`Supports::reactions`](nastic_body::discretization::supports::Supports::reactions).
    ///
    /// # Errors
    /// [`Inadmissible`] where u is.
    pub fn nodal_reactions(&self, state: &State) -> Result<Vec<f64>, Inadmissible> {
        let at = Instant::of(state);
        let mut force = self.model().evaluate(&at, Demand { energy: false, force: true })?.force;
        let supports = self.supports();
        supports.ties().restrict(supports.block, &mut force);
        let (dim, fixed) = (self.mesh().dim(), self.supports().fixed());
        let held = |dof: usize| if fixed[dof] { force[dof] } else { 0.0 };
        let node = |a: usize| (0..3).map(move |c| if c < dim { held(a * supports.block + c) } else { 0.0 });
        Ok((0..self.mesh().points().len()).flat_map(node).collect())
    }
}
