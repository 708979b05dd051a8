//! [`Ramp`]: equilibria one after the other on the straight way between two sets of controls.

use crate::linear_systems::workspace::Workspace;
use crate::model::views::Stability;
use crate::model::{Feature, Model};
use crate::search::options::SolveOptions;
use nastic_body::controls::Controls;
use nastic_body::error::{FemError, StateError};
use nastic_body::state::State;

/// Tolerance of a critical value, as a share of the step between two equilibria.
const BISECTION_TOLERANCE: f64 = 1e-3;

/// Equilibria at controls `(1 - s) from + s to`, s from 0 to 1 in equal steps; designs are those of `to` throughout.
#[derive(Debug, Clone)]
pub struct Ramp {
    /// The equilibria found, in order.
    pub points: Vec<RampPoint>,
    /// Where the number of negative pivots changes between them.
    pub critical: Vec<CriticalPoint>,
    /// Where it stopped before the end, and why.
    pub failure: Option<(f64, StateError)>,
}

/// One equilibrium of a ramp.
#[derive(Debug, Clone)]
pub struct RampPoint {
    /// The place on the ramp.
    pub s: f64,
    /// The equilibrium.
    pub state: State,
    /// Negative pivots of its tangent; `None` where the tangent is singular or not symmetric.
    pub negative: Option<usize>,
}

/// Where the number of negative pivots changes.
#[derive(Debug, Clone)]
pub struct CriticalPoint {
    /// Middle of the interval in which it changes.
    pub s: f64,
    /// Length of that interval: a thousandth of the step, more where a solve within it failed.
    pub width: f64,
    /// Negative pivots before.
    pub before: usize,
    /// Negative pivots behind.
    pub after: usize,
    /// The equilibrium before.
    pub state: State,
}

struct Search<'a, 'w> {
    model: &'a Model,
    from: &'a Controls,
    to: &'a Controls,
    how: &'a SolveOptions<'a>,
    workspace: &'w mut Workspace,
}

impl Search<'_, '_> {
    fn point(&mut self, s: f64, near: Option<&State>) -> Result<RampPoint, StateError> {
        let how = match near {
            Some(near) => SolveOptions { near: Some(near), guess: None, ..self.how.clone() },
            None => self.how.clone(),
        };
        let state = self.model.solve_with(&self.from.blend(self.to, s), &how, self.workspace)?;
        let negative = match self.model.stability().negative_pivots_by(&state, self.how) {
            Err(error) if error.is_final() => return Err(error),
            counted => counted.ok(),
        };
        Ok(RampPoint { s, state, negative })
    }

    /// All changes of the number of negative pivots between two points; errors are a cancelled solve and a lack of memory.
    fn crossings(&mut self, a: &RampPoint, b: &RampPoint) -> Result<Vec<CriticalPoint>, StateError> {
        let mut found = Vec::new();
        let width = BISECTION_TOLERANCE * (b.s - a.s);
        let mut low = a.clone();
        while let (Some(before), Some(last)) = (low.negative, b.negative)
            && before != last
        {
            let mut high = b.clone();
            while high.s - low.s > width {
                match self.point(0.5 * (low.s + high.s), Some(&low.state)) {
                    // From rest, so perhaps of another branch: bisection does not use it.
                    Ok(middle) if middle.state.report.restarts > 0 => break,
                    Ok(middle) if middle.negative == Some(before) => low = middle,
                    Ok(middle) => high = middle,
                    Err(error) if error.is_final() => return Err(error),
                    // The interval stays as wide as it is: its width shows this.
                    Err(_) => break,
                }
            }
            let (s, width, state) = (0.5 * (low.s + high.s), high.s - low.s, low.state.clone());
            // A singular tangent at the upper end: what it leads to shows behind.
            let after = high.negative.unwrap_or(last);
            found.push(CriticalPoint { s, width, before, after, state });
            low = RampPoint { negative: Some(after), ..high };
        }
        Ok(found)
    }
}

impl Stability<'_> {
    /// `count` equilibria from one set of controls to another, the first as [`solve_with`](crate::model::Model::solve_with) finds it
    /// with these options, the others each from the one before. Where the numbers of negative pivots of two neighbours
    /// differ, the values between at which it changes are bisected to a thousandth of the step (less far where a solve
    /// between fails): critical points of the branch that warm starts follow.
    ///
    /// A ramp that meets an equilibrium it cannot find keeps those before. `watch` is called with every point as it is
    /// found.
    ///
    /// # Errors
    /// Fewer than two points; a problem or controls that [`solve_with`](crate::model::Model::solve_with) refuses.
    pub fn ramp(
        &self,
        from: &Controls,
        to: &Controls,
        count: usize,
        how: &SolveOptions,
        workspace: &mut Workspace,
        watch: &mut dyn FnMut(&RampPoint),
    ) -> Result<Ramp, StateError> {
        self.model.checks().check_held()?;
        self.model.properties().supports(Feature::Ramp)?;
        self.model.checks().check_controls(from)?;
        self.model.checks().check_controls(to)?;
        if count < 2 {
            let what = format!("a ramp of {count} equilibria has no two ends; ask for 2 or more");
            return Err(FemError::Meaningless { what }.into());
        }
        let from = &self.model.with_designs(from.clone(), to);
        let mut search = Search { model: self.model, from, to, how, workspace };
        let mut ramp = Ramp { points: Vec::new(), critical: Vec::new(), failure: None };
        for k in 0..count {
            let s = k as f64 / (count - 1) as f64;
            let point = match search.point(s, ramp.points.last().map(|point| &point.state)) {
                Ok(point) => point,
                Err(why) => {
                    ramp.failure = Some((s, why));
                    break;
                }
            };
            watch(&point);
            if let Some(before) = ramp.points.last() {
                match search.crossings(before, &point) {
                    Ok(found) => ramp.critical.extend(found),
                    Err(cancelled) => ramp.failure = Some((s, cancelled)),
                }
            }
            ramp.points.push(point);
            if ramp.failure.is_some() {
                break;
            }
        }
        Ok(ramp)
    }
}
