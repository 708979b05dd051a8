//! How a run begins: at a start, or where a saved one stood.

use super::{Run, RunError};
use crate::admissible::Admissible;
use crate::failed::Failed;
use crate::inner_product::InnerProduct;
use crate::method::Method;
use crate::objective::{Objective, Request};
use crate::optimizer::Optimizer;
use crate::search::{Iterate, Setting};
use crate::start::{EvaluatedStart, Start};
use crate::state::{Counts, Progress, RunState, SavedPoint};
use std::ops::Range;
use std::sync::Arc;

impl<O: Objective> Run<O> {
    /// Begins a run at `start`, which is evaluated unless it is an evaluated point.
    ///
    /// # Errors
    /// A start that is not admissible or cannot be evaluated, or sizes that do not agree.
    pub fn start(
        optimizer: &dyn Optimizer,
        objective: O,
        set: Arc<dyn Admissible>,
        metric: Arc<dyn InnerProduct>,
        start: impl Into<Start<O::Point>>,
    ) -> Result<Self, RunError> {
        Self::begin(optimizer, Setting::new(objective, set, metric, *optimizer.options()), start.into())
    }

    pub(crate) fn begin(
        optimizer: &dyn Optimizer,
        setting: Setting<O>,
        start: Start<O::Point>,
    ) -> Result<Self, RunError> {
        let Range { start: stage, end } = setting.stages;
        let stages = setting.objective.stages();
        if stage >= end || end > stages {
            return Err(RunError::Stages { first: stage, end, stages });
        }
        let mut workspace = O::Workspace::default();
        optimizer.check_set(setting.set.as_ref(), setting.metric.len())?;
        let (name, method) = (optimizer.name(), optimizer.method());
        let (current, derivatives) = first_iterate(&setting, start, method.as_ref(), &mut workspace)?;
        let progress = Progress { stage, counts: Counts { derivatives, ..Counts::default() }, ..Progress::default() };
        let mut run = Self { setting, name, method, workspace, progress, current, best: None, ended: None };
        run.begin_stage(None)?;
        Ok(run)
    }

    /// Takes up a saved run of the same problem, set, inner product and optimiser, with an empty workspace.
    ///
    /// # Errors
    /// A saved run that does not fit, or whose points cannot be had again.
    pub fn load(
        optimizer: &dyn Optimizer,
        objective: O,
        set: Arc<dyn Admissible>,
        metric: Arc<dyn InnerProduct>,
        state: &RunState,
    ) -> Result<Self, RunError> {
        Self::resume(optimizer, Setting::new(objective, set, metric, *optimizer.options()), state)
    }

    pub(crate) fn resume(optimizer: &dyn Optimizer, setting: Setting<O>, state: &RunState) -> Result<Self, RunError> {
        let saved = |why: String| RunError::Saved(Failed::because(why));
        let (name, mut method) = (optimizer.name(), optimizer.method());
        if state.method != name {
            return Err(saved(format!("it is of \"{}\", not of \"{name}\"", state.method)));
        }
        let n = state.current.m.len();
        optimizer.check_set(setting.set.as_ref(), n)?;
        if state.memory.vectors.iter().any(|v| name != "spectral" && v.len() != n) || !method.load(&state.memory) {
            return Err(saved(format!("its memory is not one of \"{name}\" with these options")));
        }
        let stage = state.progress.stage;
        if !setting.stages.contains(&stage) || state.progress.gradients.is_empty() {
            return Err(saved(format!("there is no stage {stage}")));
        }
        let current = revive(&setting, &state.current, stage)?;
        let best = state.best.as_ref().map(|best| revive(&setting, best, stage)).transpose()?;
        let (workspace, progress) = (O::Workspace::default(), state.progress.clone());
        Ok(Self { setting, name, method, workspace, progress, current, best, ended: None })
    }
}

/// The start with its derivative, and how many derivatives that took.
fn first_iterate<O: Objective>(
    setting: &Setting<O>,
    start: Start<O::Point>,
    method: &dyn Method,
    workspace: &mut O::Workspace,
) -> Result<(Iterate<O::Point>, usize), RunError> {
    let begun = match start {
        Start::Uniform(value) => Err(vec![value; setting.metric.len()]),
        Start::Each(m) => Err(m),
        Start::Evaluated(begun) => Ok(restaged(setting, begun)?),
    };
    let EvaluatedStart { m, point, derivative } = match begun {
        Ok(begun) => begun,
        Err(m) => {
            check(setting, &m)?;
            let how = Request {
                near: None,
                accuracy: setting.options.accuracy,
                stage: setting.stages.start,
                ..Request::default()
            };
            let point = setting.objective.evaluate(&m, &how, workspace).map_err(RunError::Start)?;
            EvaluatedStart { m, point, derivative: None }
        }
    };
    check(setting, &m)?;
    let cost = setting.finite_cost(&point).map_err(RunError::Start)?;
    match derivative {
        Some(derivative) => {
            let iterate = setting.iterate_of(m, point, cost, derivative).map_err(|(_, failed)| RunError::Start(failed));
            Ok((iterate?, 0))
        }
        None => {
            let iterate = setting.differentiate(m, point, cost, method, workspace);
            Ok((iterate.map_err(|(_, failed)| RunError::Start(failed))?, 1))
        }
    }
}

/// An evaluated start, valued by the first stage to run; what it says is of stage 0 or of that stage.
fn restaged<O: Objective>(
    setting: &Setting<O>,
    begun: EvaluatedStart<O::Point>,
) -> Result<EvaluatedStart<O::Point>, RunError> {
    match setting.stages.start {
        0 => Ok(begun),
        stage => {
            let point = setting.objective.restage(stage, &begun.point).map_err(RunError::Start)?;
            Ok(EvaluatedStart { m: begun.m, point, derivative: None })
        }
    }
}

/// Whether a control may be evaluated at all.
fn check<O: Objective>(setting: &Setting<O>, m: &[f64]) -> Result<(), RunError> {
    if m.is_empty() {
        return Err(RunError::Empty);
    }
    if m.len() != setting.metric.len() {
        return Err(RunError::Lengths { control: m.len(), metric: setting.metric.len() });
    }
    Ok(setting.set.check(m)?)
}

/// An accepted point from its saved numbers.
fn revive<O: Objective>(setting: &Setting<O>, saved: &SavedPoint, stage: usize) -> Result<Iterate<O::Point>, RunError> {
    check(setting, &saved.m)?;
    let rows = saved.held.rows.iter().chain(Some(&saved.held.cost_derivative).filter(|_| !saved.held.is_empty()));
    let fits =
        saved.held.rows.len() == saved.held.values.len() && saved.held.multipliers.len() == saved.held.values.len();
    if !fits || rows.into_iter().any(|row| row.len() != saved.m.len()) {
        return Err(RunError::Saved(Failed::because("its constraints are of another number or length")));
    }
    if saved.derivative.len() != saved.m.len() {
        return Err(RunError::Saved(Failed::because("its derivative is of another length")));
    }
    let how = Request { near: None, accuracy: setting.options.accuracy, stage, ..Request::default() };
    let point = setting.objective.load(&saved.m, &saved.point, &how).map_err(RunError::Saved)?;
    let SavedPoint { m, derivative: whole_derivative, held, .. } = saved.clone();
    let mut derivative = whole_derivative.clone();
    setting.set.tangent(&m, &mut derivative);
    let (cost, gradient_norm, active) = (saved.cost, saved.gradient_norm, saved.active);
    Ok(Iterate { m, point, cost, derivative, whole_derivative, gradient_norm, active, held })
}
