//! [`PathEquations`]: the points of a path and its direction there.

use crate::linear_systems::workspace::Workspace;
use crate::model::Model;
use crate::nonlinear::direction::arc::{ArcStep, PathMetric, Plane};
use crate::nonlinear::equations::{Drive, Equations};
use crate::nonlinear::iterate::Stop;
use crate::nonlinear::iteration::{Iteration, Limits};
use crate::search::options::SolveOptions;
use crate::stability::path::PathPoint;
use nastic_body::controls::Controls;
use nastic_body::state::{SolveReport, State};

/// Newton iterations of a corrector.
pub(crate) const MAX_CORRECTOR_ITERATIONS: usize = 10;
/// Growth of the residual at which a corrector is given up.
const MAX_RESIDUAL_GROWTH: f64 = 1e3;
/// Longest change of the displacement in one step, as a share of the body's diagonal, for a longest step of 1.
const MAX_DISPLACEMENT_RATIO: f64 = 0.1;

/// A point of the path.
#[derive(Clone)]
pub(crate) struct PathIterate {
    /// Displacement, multipliers, and s.
    pub x: Vec<f64>,
    /// The direction of the path, of unit length in its norm.
    pub tangent: Vec<f64>,
    pub report: SolveReport,
}

impl PathIterate {
    pub fn s(&self) -> f64 {
        self.x[self.x.len() - 1]
    }

    /// The direction without that of s.
    pub fn direction(&self) -> Vec<f64> {
        self.tangent[..self.tangent.len() - 1].to_vec()
    }

    /// ds over the length of the path.
    pub fn slope(&self) -> f64 {
        self.tangent[self.tangent.len() - 1]
    }
}

/// `r(u, p, s) = 0` with one more equation.
pub(crate) struct PathEquations<'a> {
    equations: Equations<'a>,
    workspace: &'a mut Workspace,
    /// `V_a / V` by unknown of the displacement, zero of further fields, times `1 / U^2`: what brings the displacement's change to the size of that of s.
    metric: PathMetric,
}

impl<'a> PathEquations<'a> {
    pub fn new(
        model: &'a Model,
        from: &'a State,
        to: (&'a Controls, f64),
        options: &'a SolveOptions<'a>,
        workspace: &'a mut Workspace,
    ) -> Self {
        let mut weights = model.volumes_by_unknown();
        let volume: f64 = weights.iter().sum::<f64>() / model.discretization().dim() as f64;
        weights.iter_mut().for_each(|w| *w /= volume);
        model.supports.clear(&mut weights);
        weights.resize(model.unknowns().len(), 0.0);
        let equations =
            Equations { model, drive: Drive::Path { from, to }, options, anchor: None, flat_contacts: false };
        PathEquations {
            equations,
            workspace,
            metric: PathMetric { weights, scale: 1.0, space: model.unknowns().clone() },
        }
    }

    /// The start at s = 0, its direction towards larger s; scales the inner product such that u' and s' are of one size
    /// there: by U, the root mean square of du/ds.
    pub fn start(&mut self, from: &State) -> Result<PathIterate, Stop> {
        let mut begin: Vec<f64> = from.u.to_vec();
        begin.push(0.0);
        let upwards = unit(begin.len());
        let plane = Plane { origin: &begin, normal: &upwards, distance: 0.0 };
        let mut start = self.correct(begin.clone(), plane)?;
        let response = self.arc_step(Plane { distance: 1.0, ..plane }, |step| step.tangent(&start.x))?;
        let least = 1e-6 * self.equations.diagonal();
        let ds = response[response.len() - 1];
        self.metric.scale = (self.mean_square(&response) / ds.powi(2)).max(least * least).recip();
        start.tangent = self.normalized(response);
        Ok(start)
    }

    /// The point at a step length along the tangent.
    pub fn step(&mut self, here: &PathIterate, length: f64) -> Result<PathIterate, Stop> {
        let predicted = here.x.iter().zip(&here.tangent).map(|(x, t)| x + length * t).collect();
        let plane = Plane { origin: &here.x, normal: &here.tangent, distance: length };
        let point = self.reach(here, predicted, plane)?;
        self.with_tangent(point, here)
    }

    /// The point at a value of s between those of two.
    pub fn land(&mut self, here: &PathIterate, there: &PathIterate, s: f64) -> Result<PathIterate, Stop> {
        let share = (s - here.s()) / (there.s() - here.s());
        let mut guess: Vec<f64> = here.x.iter().zip(&there.x).map(|(a, b)| a + share * (b - a)).collect();
        let (last, upwards) = (guess.len() - 1, unit(guess.len()));
        guess[last] = s;
        let origin = guess.clone();
        let mut point = self.reach(here, guess, Plane { origin: &origin, normal: &upwards, distance: 0.0 })?;
        point.x[last] = s;
        self.with_tangent(point, here)
    }

    /// Newton's method from a guess, which a straight move from a point has to reach.
    fn reach(&mut self, here: &PathIterate, mut guess: Vec<f64>, plane: Plane) -> Result<PathIterate, Stop> {
        self.equations.place(&mut guess);
        if self.equations.admissible_chord(&here.x, &guess)? < 1.0 {
            return Err(Stop::Slow { residual: here.report.residual });
        }
        self.correct(guess, plane)
    }

    /// Newton's method from a guess to the equilibrium in a plane.
    fn correct(&mut self, mut x: Vec<f64>, plane: Plane) -> Result<PathIterate, Stop> {
        let limits = Limits {
            diverged: MAX_RESIDUAL_GROWTH,
            ..Limits::new(MAX_CORRECTOR_ITERATIONS, self.equations.options.accuracy)
        };
        let mut report = SolveReport { load_steps: 1, ..SolveReport::default() };
        let tangent = plane.normal.to_vec();
        let Self { equations, workspace, metric } = self;
        let solver = equations.model.linear_solver(equations.options, workspace);
        let mut direction = ArcStep { equations, metric, plane, solver };
        Iteration::new(equations, limits).run(&mut x, &mut direction, &mut report)?;
        Ok(PathIterate { x, tangent, report })
    }

    /// With the direction of the path, on the side of that of another point.
    fn with_tangent(&mut self, point: PathIterate, towards: &PathIterate) -> Result<PathIterate, Stop> {
        let plane = Plane { origin: &towards.x, normal: &towards.tangent, distance: 1.0 };
        let tangent = self.arc_step(plane, |step| step.tangent(&point.x))?;
        Ok(PathIterate { tangent: self.normalized(tangent), ..point })
    }

    fn arc_step<T>(&mut self, plane: Plane, call: impl FnOnce(&mut ArcStep) -> T) -> T {
        let Self { equations, workspace, metric } = self;
        let solver = equations.model.linear_solver(equations.options, workspace);
        call(&mut ArcStep { equations, metric, plane, solver })
    }

    /// How far a step may go: see [`PathOptions::step`](crate::stability::path::PathOptions).
    pub fn longest(&self, here: &PathIterate, step: f64) -> f64 {
        let reach = MAX_DISPLACEMENT_RATIO * step * self.equations.diagonal();
        (step / here.slope().abs()).min(reach / self.mean_square(&here.tangent).sqrt())
    }

    /// The inner product of two directions.
    pub fn product(&self, a: &[f64], b: &[f64]) -> f64 {
        self.metric.product(a, b)
    }

    /// A point as it is reported.
    pub fn path_point(&self, point: &PathIterate) -> PathPoint {
        let state = self.state(point);
        let negative = self.equations.model.stability().negative_pivots_by(&state, self.equations.options).ok();
        PathPoint { s: point.s(), slope: point.slope(), state, negative }
    }

    pub fn state(&self, point: &PathIterate) -> State {
        let (u, s) = self.equations.split(&point.x);
        let (controls, load) = self.equations.prescribed_at(s);
        State::equilibrium(u.to_vec(), controls, load, point.report)
    }

    /// How far the second point is along the direction of the first.
    pub fn along(&self, from: &PathIterate, point: &PathIterate) -> f64 {
        let moved: Vec<f64> = point.x.iter().zip(&from.x).map(|(x, y)| x - y).collect();
        self.product(&moved, &from.tangent)
    }

    fn mean_square(&self, x: &[f64]) -> f64 {
        x.iter().zip(&self.metric.weights).map(|(u, w)| u * u * w).sum()
    }

    fn normalized(&self, tangent: Vec<f64>) -> Vec<f64> {
        let size = self.product(&tangent, &tangent).sqrt();
        tangent.into_iter().map(|t| t / size).collect()
    }
}

/// The direction of s.
fn unit(len: usize) -> Vec<f64> {
    let mut x = vec![0.0; len];
    x[len - 1] = 1.0;
    x
}
