//! [`Reduced`] as an optimiser sees it.

use super::{Lagrangian, Reduced};
use crate::cost::{Figure, FigureKind};
use crate::evaluated::{Evaluated, Expected};
use crate::workspace::ReducedWorkspace;
use nastic_fem::{FemError, SolveReport};
use nastic_fields::ControlError;
use nastic_opt::{
    Constrained, EvaluatedStart, Failed, Hessian, InnerProduct, Objective, Problem, Request, Start, Summary,
};
use std::borrow::Cow;
use std::sync::Arc;

impl Objective for Reduced {
    type Point = Evaluated;
    type Workspace = ReducedWorkspace;

    fn evaluate(
        &self,
        m: &[f64],
        how: &Request<'_, Evaluated>,
        workspace: &mut ReducedWorkspace,
    ) -> Result<Evaluated, Failed> {
        Ok(self.evaluate_typed(m, how, workspace)?)
    }

    fn value(&self, point: &Evaluated) -> f64 {
        point.cost()
    }

    /// Leaves the adjoint state in the point.
    fn derivative(&self, point: &mut Evaluated, workspace: &mut ReducedWorkspace) -> Result<Vec<f64>, Failed> {
        Ok(self.derivative_of_point(point, Lagrangian { costs: true, y: &[] }, workspace)?)
    }

    fn hessian_vector(
        &self,
        point: &Evaluated,
        v: &[f64],
        which: Hessian,
        workspace: &mut ReducedWorkspace,
    ) -> Result<Vec<f64>, Failed> {
        Ok(match which {
            Hessian::Exact => Reduced::hessian_vector(self, point, v, workspace)?,
            Hessian::GaussNewton => self.gauss_newton_vector(point, v, workspace)?,
        })
    }

    /// Of equilibria.
    fn jump(&self, from: &Evaluated, to: &Evaluated, _: &mut ReducedWorkspace) -> Option<Failed> {
        self.other_branch(from, to).map(Failed::from)
    }

    fn stages(&self) -> usize {
        self.costs().iter().map(|cost| cost.stages()).fold(self.layout.stages(), usize::max)
    }

    fn restage(&self, stage: usize, point: &Evaluated) -> Result<Evaluated, Failed> {
        Ok(self.restage_typed(stage, point)?)
    }

    /// `terms/NAME` for every cost term; `newton`, `factorisations`, `back_substitutions` of the state solve and of the
    /// adjoint; `min_J`.
    fn summary(&self, point: &Evaluated) -> Summary {
        let terms = self.term_names().into_iter().zip(&point.terms);
        let mut entries: Vec<(String, f64)> = terms.map(|(name, value)| (format!("terms/{name}"), *value)).collect();
        entries.extend(work_summary(&point.total_work()));
        entries.push(("min_J".into(), point.min_j()));
        Summary(entries)
    }

    /// By their [names in history lines](FigureKind::history_name): the true distance of the first cost that has one, of tracked
    /// points the largest of all costs. Costs whose figures are not defined there have none; see [`figures_of`](Self::figures_of) of a body over ranks.
    fn figures(&self, point: &Evaluated) -> Summary {
        let costs = if self.has_figures(point) { self.costs_of(point).unwrap_or_default() } else { Cow::default() };
        let all: Vec<Figure> = costs.iter().filter_map(|cost| cost.figures().ok()).flatten().collect();
        let mut out = Summary::default();
        for Figure { kind, value, .. } in all {
            let Some(name) = kind.history_name() else { continue };
            match out.0.iter_mut().find(|(known, _)| known == name) {
                Some((_, most)) if kind != FigureKind::TrueDistance => *most = most.max(value),
                Some(_) => {}
                None => out.0.push((name.to_owned(), value)),
            }
        }
        out
    }

    /// With the ranks that have the body.
    fn any(&self, here: bool) -> Result<bool, Failed> {
        let model = self.solid().model();
        let any = model.unknowns().any(here);
        Ok(model.ranks().unless_parted(Ok::<_, ControlError>(any))?)
    }

    fn save(&self, point: &Evaluated) -> Vec<u8> {
        point.to_bytes()
    }

    /// Solves nothing; but a motion runs once more, which gives the same bits.
    fn load(&self, m: &[f64], bytes: &[u8], how: &Request<'_, Evaluated>) -> Result<Evaluated, Failed> {
        let mut point = self.all_find(self.saved(m, bytes, how.stage))?;
        if self.timeline().is_some() {
            let how = Request { near: None, accuracy: point.solved.accuracy, ..*how };
            let again = self.evaluate_typed(m, &how, &mut ReducedWorkspace::default())?;
            point = Evaluated { adjoint: point.adjoint, ..again };
        }
        Ok(point)
    }
}

impl Reduced {
    /// The point that was written, as it is here.
    fn saved(&self, m: &[f64], bytes: &[u8], stage: usize) -> Result<Evaluated, Failed> {
        let controls = self.layout_in_stage(stage).to_points(m)?;
        let (terms, dofs) = (self.term_names().len(), self.solid().model().unknowns().len());
        let constraints = Constrained::constraints(self).iter().map(|group| group.len).sum();
        let expected = Expected { stage, terms, constraints, dofs };
        Evaluated::from_bytes(bytes, m, controls, expected).map_err(Failed::new)
    }

    /// What was found here, or that another rank has found nothing.
    fn all_find<T>(&self, found: Result<T, Failed>) -> Result<T, Failed> {
        let here = found.as_ref().map(drop).map_err(|_| ControlError::from(FemError::Elsewhere));
        let all = self.solid().model().ranks().all_accept(here);
        found.and_then(|found| Ok(all.map(|()| found)?))
    }
}

impl Problem for Reduced {
    fn inner_product(&self) -> Result<Arc<dyn InnerProduct>, Failed> {
        Ok(self.build_inner_product()?)
    }
}

/// Work by the names of history lines: `newton`, `factorisations`, `back_substitutions`.
pub fn work_summary(work: &SolveReport) -> [(String, f64); 3] {
    [
        ("newton".into(), work.newton as f64),
        ("factorisations".into(), work.factorisations as f64),
        ("back_substitutions".into(), work.back_substitutions as f64),
    ]
}

impl From<Evaluated> for Start<Evaluated> {
    fn from(point: Evaluated) -> Self {
        Start::Evaluated(EvaluatedStart { m: point.m.clone(), point, derivative: None })
    }
}

impl From<&Evaluated> for Start<Evaluated> {
    fn from(point: &Evaluated) -> Self {
        point.clone().into()
    }
}
