//! Constraints of a reduced problem.

use super::Reduced;
use super::motion_derivative::Functional;
use crate::constraint::{BetweenNodes, Constraint, ConstraintPoint, IntoConstraint};
use crate::cost::Partials;
use crate::cost::of_displacement::{beside_fields, displacement};
use crate::evaluated::{AdjointState, Evaluated};
use crate::time::Instants;
use crate::workspace::ReducedWorkspace;
use nastic_fem::State;
use nastic_fields::ControlError;
use nastic_opt::{Constrained, ConstraintGroup, Failed, Hessian};
use std::borrow::Cow;
use std::sync::Arc;

/// What a derivative is of: the sum of the costs (or nothing) and `sum_k y_k c_k`.
#[derive(Clone, Copy, Debug)]
pub struct Lagrangian<'a> {
    /// Whether the costs are in it.
    pub costs: bool,
    /// y, one for each value of the constraints; empty without any.
    pub y: &'a [f64],
}

impl Lagrangian<'_> {
    /// The weights of the constraints; none where all are zero.
    pub(crate) fn multipliers(&self) -> Vec<f64> {
        if self.y.iter().any(|y| *y != 0.0) { self.y.to_vec() } else { vec![] }
    }
}

impl Reduced {
    /// Adds a constraint, which [`nastic_opt::AugmentedLagrangian`] holds; optimisers by themselves know nothing of it. In a
    /// problem in time it holds at the end, one of [`constrain_when`](Self::constrain_when) at other instants.
    ///
    /// # Errors
    /// What the constraint does not find on the body.
    pub fn constrain(mut self, constraint: impl IntoConstraint) -> Result<Self, ControlError> {
        if self.motion.is_some() {
            return self.constrain_when(Instants::End, constraint);
        }
        self.solid.model().ranks().refuse_ranks("a constraint")?;
        self.constraints.push(constraint.bind(&self.solid)?);
        Ok(self)
    }

    /// The bound constraints.
    pub fn constraint_terms(&self) -> &[Box<dyn Constraint>] {
        &self.constraints
    }

    /// The numbers of the states at which a constraint holds: in a problem in time those of its instants, else 0, that of the equilibrium.
    pub fn constraint_states(&self, constraint: usize) -> &[usize] {
        match &self.motion {
            Some(motion) => motion.constrained_at.get(constraint).map_or(&[], Vec::as_slice),
            None => &[0],
        }
    }

    /// What the distances that constraints keep at nodes come to between these in the n-th state, constraint by constraint; none of those
    /// that do not hold there.
    ///
    /// # Errors
    /// Controls of the wrong length.
    pub fn between_nodes(&self, m: &[f64], n: usize, state: &State) -> Result<Vec<Option<BetweenNodes>>, ControlError> {
        let m = self.at_instant(m, state.time)?;
        let u = displacement(&self.solid, state);
        let context = beside_fields(self.context(state, &m, 0), &u);
        let between = |(k, constraint): (usize, &dyn Constraint)| {
            self.constraint_states(k).binary_search(&n).ok().and_then(|_| constraint.between_nodes(&context))
        };
        Ok(self.constraints.iter().map(Box::as_ref).enumerate().map(between).collect())
    }

    /// Evaluates the constraints in a state, with the maps of a stage.
    pub(super) fn constraints_at(
        &self,
        state: &State,
        m: &[f64],
        stage: usize,
    ) -> Result<Vec<Arc<dyn ConstraintPoint>>, ControlError> {
        let at = self.near_time(state, (m, stage))?;
        (0..self.constraints.len()).map(|k| at.constraint(k)).collect()
    }

    /// The evaluated constraints of a point: those it keeps, or evaluated again.
    pub(super) fn constraints_of<'a>(
        &self,
        point: &'a Evaluated,
    ) -> Result<Cow<'a, [Arc<dyn ConstraintPoint>]>, ControlError> {
        if point.constraint_points.len() == self.constraints.len() {
            return Ok(Cow::Borrowed(&point.constraint_points));
        }
        self.constraints_at(point.state(), &point.m, point.stage).map(Cow::Owned)
    }

    /// Each evaluated constraint with its part of weights given for all values.
    pub(super) fn with_weights<'a>(
        constraints: &'a [Arc<dyn ConstraintPoint>],
        weights: &'a [f64],
    ) -> impl Iterator<Item = (&'a Arc<dyn ConstraintPoint>, &'a [f64])> {
        let mut rest = weights;
        constraints.iter().map(move |constraint| {
            let (own, behind) = rest.split_at(constraint.values().len().min(rest.len()));
            rest = behind;
            (constraint, own)
        })
    }

    /// `d/dm` of costs and constraints as `of` weighs them, by one adjoint, with the adjoint state; none where nothing depends on the state.
    ///
    /// # Errors
    /// A tangent that is singular, a cost or constraint that is not defined.
    pub fn lagrangian_sensitivity(
        &self,
        point: &Evaluated,
        of: Lagrangian<'_>,
        workspace: &mut ReducedWorkspace,
    ) -> Result<(Vec<f64>, Option<AdjointState>), ControlError> {
        let (derivative, adjoint) = match &self.motion {
            Some(motion) => {
                let (at, of) = ((point.m.as_slice(), point.stage), Functional::Lagrangian(of));
                self.derivative_of_motion(motion, at, &mut point.solved.clone(), of, workspace)?
            }
            None => self.sensitivity_of(point, self.lagrangian_partials(point, of)?, workspace)?,
        };
        Ok((derivative, adjoint.map(|adjoint| AdjointState { multipliers: of.multipliers(), ..adjoint })))
    }

    /// Partial derivatives of costs and constraints, as `of` weighs them.
    pub(super) fn lagrangian_partials(&self, point: &Evaluated, of: Lagrangian<'_>) -> Result<Partials, ControlError> {
        let mut partials = match of.costs {
            true => self.partials(point, None)?,
            false => Partials::zero(point.state().u.len(), point.m.len()),
        };
        if of.y.iter().any(|y| *y != 0.0) {
            let constraints = self.constraints_of(point)?;
            for (constraint, y) in Self::with_weights(&constraints, of.y) {
                constraint.add_partials(y, &mut partials)?;
            }
        }
        Ok(partials)
    }
}

impl Constrained for Reduced {
    /// In the order they were added; those of one name are numbered, `obstacle_0`, `obstacle_1`. The values of a constraint of
    /// a motion stand instant by instant.
    fn constraints(&self) -> Vec<ConstraintGroup> {
        let mut groups: Vec<ConstraintGroup> = self.constraints.iter().map(|constraint| constraint.group()).collect();
        if let Some(motion) = &self.motion {
            groups.iter_mut().zip(&motion.constrained_at).for_each(|(group, instants)| group.len *= instants.len());
        }
        groups.extend(self.rate_groups());
        let names: Vec<String> = groups.iter().map(|group| group.name.clone()).collect();
        for (k, group) in groups.iter_mut().enumerate() {
            if names.iter().filter(|name| **name == group.name).count() > 1 {
                group.name = format!("{}_{}", names[k], names[..k].iter().filter(|name| **name == names[k]).count());
            }
        }
        groups
    }

    fn constraint_values(&self, point: &Evaluated) -> Vec<f64> {
        point.constraints.clone()
    }

    /// Leaves the adjoint state of the sum in the point.
    fn lagrangian_derivative(
        &self,
        point: &mut Evaluated,
        y: &[f64],
        workspace: &mut ReducedWorkspace,
    ) -> Result<Vec<f64>, Failed> {
        Ok(self.derivative_of_point(point, Lagrangian { costs: true, y }, workspace)?)
    }

    /// The work of their adjoints counts as that of the point's state.
    fn constraint_derivatives(
        &self,
        point: &mut Evaluated,
        workspace: &mut ReducedWorkspace,
    ) -> Result<Vec<Vec<f64>>, Failed> {
        let (mut rows, mut y) = (Vec::new(), vec![0.0; point.constraints.len()]);
        for k in 0..y.len() {
            y[k] = 1.0;
            let of = Lagrangian { costs: false, y: &y };
            let (row, adjoint) = self.lagrangian_sensitivity(point, of, workspace)?;
            adjoint.iter().for_each(|adjoint| point.work.add_work(&adjoint.work));
            rows.push(row);
            y[k] = 0.0;
        }
        Ok(rows)
    }

    fn lagrangian_hessian_vector(
        &self,
        point: &Evaluated,
        [y, w]: [&[f64]; 2],
        along: (&[f64], Hessian),
        workspace: &mut ReducedWorkspace,
    ) -> Result<Vec<f64>, Failed> {
        Ok(self.lagrangian_second_derivative(point, Lagrangian { costs: true, y }, w, along.0, along.1, workspace)?)
    }
}
