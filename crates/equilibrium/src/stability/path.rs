//! [`EquilibriumPath`]: equilibria along a path through limit points.

use crate::linear_systems::workspace::Workspace;
use crate::model::Feature;
use crate::model::views::Stability;
use crate::nonlinear::iterate::Stop;
use crate::search::options::SolveOptions;
use crate::stability::arc_length::{MAX_CORRECTOR_ITERATIONS, PathEquations, PathIterate};
use crate::stability::path_events::{Between, events};
use nastic_body::controls::Controls;
use nastic_body::error::{FemError, StateError};
use nastic_body::state::State;

/// How to follow a path.
#[derive(Debug, Clone, PartialEq)]
pub struct PathOptions {
    /// Longest step: `|ds| <= step`, and a root mean square of the displacement's change of at most `step / 10` of the
    /// body's diagonal.
    pub step: f64,
    /// Most points, the start included.
    pub points: usize,
    /// The path ends where s leaves this interval, which holds 0 inside.
    pub range: [f64; 2],
    /// The path ends behind the first limit point.
    pub to_limit: bool,
}

impl Default for PathOptions {
    fn default() -> Self {
        PathOptions { step: 0.1, points: 300, range: [-1.0, 1.0], to_limit: false }
    }
}

/// Equilibria `(u, s)` at controls `(1 - s) c_0 + s c_1` and load `(1 - s) l_0 + s l_1`, in the order of the path,
/// along which s may rise and fall.
#[derive(Debug, Clone)]
pub struct EquilibriumPath {
    /// The equilibria, the start first.
    pub points: Vec<PathPoint>,
    /// Limit points and bifurcations between them, in order.
    pub events: Vec<PathEvent>,
    /// Why it ends.
    pub end: PathEnd,
}

/// One equilibrium of a path.
#[derive(Debug, Clone)]
pub struct PathPoint {
    /// Factor on the way from one set of controls and loads to the other.
    pub s: f64,
    /// ds over the step length of the path: its sign changes at limit points.
    pub slope: f64,
    /// The equilibrium.
    pub state: State,
    /// Negative pivots of its tangent; `None` where the tangent is singular or not symmetric.
    pub negative: Option<usize>,
}

/// What happens between two points.
#[derive(Debug, Clone)]
pub struct PathEvent {
    /// What it is.
    pub kind: EventKind,
    /// Index of the point before it.
    pub point: usize,
    /// Where it is.
    pub s: f64,
    /// The equilibrium there.
    pub state: State,
    /// How displacement (and multipliers) change along the path there, of any length: at a limit point the direction in which the tangent is singular.
    pub direction: Vec<f64>,
    /// Negative pivots before and behind it, where there are.
    pub before: Option<usize>,
    /// Negative pivots behind it.
    pub after: Option<usize>,
}

/// Kinds of critical points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EventKind {
    /// s has a maximum or minimum along the path: under a rising load the body snaps to another state.
    LimitPoint,
    /// The number of negative pivots changes elsewhere: another branch crosses.
    Bifurcation,
}

/// Why a path ends.
#[derive(Debug, Clone)]
pub enum PathEnd {
    /// s reached the end of its range.
    Left,
    /// It has passed a limit point, and was to go no further.
    LimitPoint,
    /// As many points, or Newton iterations ([`SolveOptions::budget`]; a failed step counts as ten), as allowed.
    Points,
    /// No step, however short, leads on.
    Stuck(StateError),
    /// The caller asked to stop.
    Cancelled,
}

/// Length of the first step, in the norm of the path.
const FIRST_STEP: f64 = 0.05;
/// Shortest step, as a share of the first one.
const MIN_STEP_RATIO: f64 = 1e-6;
/// Least cosine of the angle between the directions at two neighbours.
const MIN_COSINE: f64 = 0.9;
/// Step up to which neighbours are accepted whatever lies between them, as a share of the first step.
const MIN_SEPARABLE_RATIO: f64 = 1e-2;
/// Factor by which a step that ends at a singular matrix is lengthened.
const STEP_EXTENSION: f64 = 1.4;
/// How often such a step is lengthened before it is shortened.
const MAX_EXTENSIONS: i32 = 3;
/// Newton iterations of a step, by which its length is controlled.
const TARGET_ITERATIONS: f64 = 4.0;

impl PathOptions {
    fn check(&self) -> Result<(), FemError> {
        let [low, high] = self.range;
        let fits = self.step > 0.0 && self.step.is_finite() && low < 0.0 && high > 0.0;
        let what = || format!("a path with steps of {} over s from {low} to {high} cannot begin at s = 0", self.step);
        if fits { Ok(()) } else { Err(FemError::Meaningless { what: what() }) }
    }
}

/// A step that was taken.
struct Advance {
    point: PathIterate,
    path_point: PathPoint,
    events: Vec<PathEvent>,
    /// Whether s stands on an end of its range.
    left: bool,
}

/// Of a step to a point that may be on another branch, or behind several events.
pub(crate) fn too_long() -> Stop {
    Stop::Slow { residual: 0.0 }
}

/// One step; a failure where it is too long.
fn advance(
    equations: &mut PathEquations,
    path: &EquilibriumPath,
    here: &PathIterate,
    length: f64,
    [low, high]: [f64; 2],
) -> Result<Advance, Stop> {
    let mut point = equations.step(here, length)?;
    // A point that stands on an end has not left it.
    let crosses = |end: &f64| here.s() != *end && (point.s() - end) * (here.s() - end) <= 0.0;
    let end = [low, high].into_iter().find(crosses);
    if let Some(end) = end {
        point = equations.land(here, &point, end)?;
    }
    let separable = length > MIN_SEPARABLE_RATIO * FIRST_STEP;
    if separable && equations.product(&here.tangent, &point.tangent) < MIN_COSINE {
        return Err(too_long());
    }
    let path_point = equations.path_point(&point);
    // Of a point with a singular tangent nothing is known; what was known before it counts.
    let before = path.points.iter().rev().find_map(|point| point.negative);
    let between = Between { here, there: &point, before, after: path_point.negative, index: path.points.len() - 1 };
    let events = events(equations, &between, separable)?;
    Ok(Advance { left: end.is_some(), point, path_point, events })
}

impl Stability<'_> {
    /// Follows the path of equilibria from a state towards other controls and another load (1: the loads and prescribed
    /// displacements as given), past limit points, where a load or a control cannot rise any further.
    ///
    /// Predictor along the tangent of the path, corrector by Newton's method for `r(u, s) = 0` with the
    /// pseudo-arc-length constraint
    ///
    /// ```text
    /// <u', u - u_0> + s' (s - s_0) = step,    <v, w> = sum_a V_a v_a . w_a / (V U^2)
    /// ```
    ///
    /// (V_a the volumes of the nodes, U the root mean square of du/ds at the start), whose matrix `[K r_s; <u', .> s']`
    /// is regular at limit points; block elimination, K may be indefinite. H. B. Keller, "Numerical solution of
    /// bifurcation and nonlinear eigenvalue problems" (1977). `r_s` is a central difference, exact for controls that
    /// enter linearly or in products of two. The step halves on failure and where the path turns sharply, and grows
    /// with the square root of four over the iterations it took.
    ///
    /// Limit points are located by the sign of s', bifurcations by the number of negative pivots of K. `watch` is
    /// called with every point.
    ///
    /// # Errors
    /// A start that is no equilibrium ([`StateError`]); controls of another body; a step that is not positive, a range
    /// without 0 inside.
    pub fn path(
        &self,
        from: &State,
        to: (&Controls, f64),
        options: &PathOptions,
        how: &SolveOptions,
        workspace: &mut Workspace,
        watch: &mut dyn FnMut(&PathPoint),
    ) -> Result<EquilibriumPath, StateError> {
        self.model.checks().check_held()?;
        self.model.properties().supports(Feature::Path)?;
        self.model.checks().check_state(from)?;
        self.model.checks().check_controls(to.0)?;
        options.check()?;
        self.model.moves().check_start(from, how.parallel)?;
        let mut equations = PathEquations::new(self.model, from, to, how, workspace);
        let start = equations.start(from).map_err(|stop| stop.into_error(0, from))?;
        let mut path =
            EquilibriumPath { points: vec![equations.path_point(&start)], events: Vec::new(), end: PathEnd::Points };
        watch(&path.points[0]);
        let mut here = start;
        let (mut step, mut stretched, mut spent) = (FIRST_STEP, 0, 0);
        while path.points.len() < options.points && !how.is_spent(spent) {
            let length = step.min(STEP_EXTENSION.powi(stretched) * equations.longest(&here, options.step));
            let tried = advance(&mut equations, &path, &here, length, options.range);
            match tried {
                Ok(Advance { point, path_point, events, left }) => {
                    spent += point.report.newton;
                    path.events.extend(events);
                    watch(&path_point);
                    path.points.push(path_point);
                    stretched = 0;
                    step = length * (TARGET_ITERATIONS / point.report.newton.max(1) as f64).sqrt().clamp(0.5, 2.0);
                    here = point;
                    if left {
                        path.end = PathEnd::Left;
                        break;
                    }
                    if options.to_limit && path.events.iter().any(|event| event.kind == EventKind::LimitPoint) {
                        path.end = PathEnd::LimitPoint;
                        break;
                    }
                }
                Err(Stop::Cancelled) => {
                    path.end = PathEnd::Cancelled;
                    break;
                }
                // A bifurcation stands in the way, and may be stepped over.
                Err(Stop::Linear(_)) if stretched < MAX_EXTENSIONS => {
                    stretched += 1;
                    step = STEP_EXTENSION * length;
                }
                Err(why) => {
                    spent += MAX_CORRECTOR_ITERATIONS;
                    step = 0.5 * length;
                    if step < MIN_STEP_RATIO * FIRST_STEP {
                        let last = &path.points[path.points.len() - 1].state;
                        path.end = PathEnd::Stuck(why.into_error(last.report.newton, last));
                        break;
                    }
                }
            }
        }
        Ok(path)
    }
}
