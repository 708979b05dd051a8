//! [`Equations`] of a path: residual and pseudo-arc-length constraint, their Newton iteration, and the path's tangent.

use crate::contributions::controls::Controls;
use crate::contributions::instant::Instant;
use crate::contributions::{Demand, Sums};
use crate::error::{Cause, Inadmissible, StateError};
use crate::model::Model;
use crate::solution::options::{Progress, SolveOptions};
use crate::solution::path::PathPoint;
use crate::solution::state::{SolveReport, State};
use crate::solution::tangent_systems::{TangentSystems, eliminate};
use crate::solution::workspace::Workspace;
use nalgebra::DMatrix;
use nastic_linear::solver::Border;
use nastic_linear::{LinearError, SparseMatrix};
use nastic_numeric::vector::{dot, max_abs, norm};

/// Newton iterations of a corrector.
const ITERATIONS: usize = 10;
/// A corrector whose residual grows by this factor is given up.
const DIVERGED: f64 = 1e3;
/// Below this relative residual an iteration that does not halve it has met the limit of double precision.
const ROUNDING: f64 = 1e-10;
/// A step shorter than this share of the body's size is below what double precision resolves.
const RESOLUTION: f64 = 1e-12;
/// Difference of s for the derivative of the residual.
const DIFFERENCE: f64 = 1e-2;
/// Longest change of the displacement in one step, as a share of the body's diagonal, for a longest step of 1.
const REACH: f64 = 0.1;

/// Why a step was not taken.
#[derive(Debug)]
pub(super) enum Failure {
    Inadmissible(Inadmissible),
    Linear(LinearError),
    /// Newton's method did not converge.
    Slow {
        residual: f64,
        newton: usize,
        s: f64,
    },
    /// It converged to a point that may be on another branch, or behind several events.
    TooLong,
    Cancelled,
}

impl From<Inadmissible> for Failure {
    fn from(at: Inadmissible) -> Self {
        Failure::Inadmissible(at)
    }
}

impl From<LinearError> for Failure {
    fn from(error: LinearError) -> Self {
        Failure::Linear(error)
    }
}

impl Failure {
    /// The error of a path that cannot go on from here.
    pub fn into_error(self, last: &State) -> StateError {
        let (load, last) = (last.load, Box::new(last.clone()));
        match self {
            Failure::Inadmissible(at) => StateError::inadmissible(at, load, 0, last),
            Failure::Linear(error) => error.into(),
            Failure::Slow { residual, newton, s } => StateError::NoConvergence {
                load: s,
                cuts: 0,
                newton,
                residual,
                reached: load,
                cause: Cause::Unknown,
                last,
            },
            Failure::TooLong => {
                let (reached, cause) = (load, Cause::Unknown);
                StateError::NoConvergence { load, cuts: 0, newton: 0, residual: 0.0, reached, cause, last }
            }
            Failure::Cancelled => StateError::Cancelled,
        }
    }
}

/// A direction `(u', s')` of unit length in the path's norm.
#[derive(Clone)]
pub(super) struct Tangent {
    pub u: Vec<f64>,
    pub s: f64,
}

/// A point of the path.
#[derive(Clone)]
pub(super) struct Point {
    pub u: Vec<f64>,
    pub s: f64,
    pub tangent: Tangent,
    pub newton: usize,
    report: SolveReport,
}

/// The system `r(u, s) = 0` with one more equation.
pub(super) struct Equations<'a> {
    model: &'a Model,
    from: &'a State,
    to: (&'a Controls, f64),
    how: &'a SolveOptions<'a>,
    workspace: &'a mut Workspace,
    /// `V_a / V` by unknown; zero on supports, which s determines.
    weights: Vec<f64>,
    /// `1 / U^2`: what brings the displacement's change to the size of that of s.
    scale: f64,
}

impl<'a> Equations<'a> {
    pub fn new(
        model: &'a Model,
        from: &'a State,
        to: (&'a Controls, f64),
        how: &'a SolveOptions<'a>,
        workspace: &'a mut Workspace,
    ) -> Self {
        let mut weights = model.discretization().volumes_by_unknown();
        let volume: f64 = weights.iter().sum::<f64>() / model.discretization().dim() as f64;
        weights.iter_mut().for_each(|w| *w /= volume);
        model.supports.clear(&mut weights);
        Equations { model, from, to, how, workspace, weights, scale: 1.0 }
    }

    /// The start at s = 0, its direction towards larger s; scales the inner product such that u' and s' are of one size
    /// there.
    pub fn start(&mut self) -> Result<Point, Failure> {
        let at_rest = Tangent { u: vec![0.0; self.weights.len()], s: 1.0 };
        let begin = Point {
            u: self.from.u.to_vec(),
            s: 0.0,
            tangent: at_rest.clone(),
            newton: 0,
            report: SolveReport::default(),
        };
        let mut start = self.correct((begin.u.clone(), 0.0), &begin, 0.0)?;
        let response = self.tangent(&start.u, 0.0, &at_rest)?;
        let least = 1e-6 * self.model.discretization().mesh().diagonal();
        self.scale = (self.mean_square(&response.u) / response.s.powi(2)).max(least * least).recip();
        start.tangent = self.normalized(response);
        Ok(start)
    }

    /// The point at a step length along the tangent.
    pub fn step(&mut self, here: &Point, length: f64) -> Result<Point, Failure> {
        let predicted: Vec<f64> = here.u.iter().zip(&here.tangent.u).map(|(u, t)| u + length * t).collect();
        let mut point = self.correct((predicted, here.s + length * here.tangent.s), here, length)?;
        point.tangent = self.tangent(&point.u, point.s, &here.tangent)?;
        Ok(point)
    }

    /// The point at a value of s between those of two.
    pub fn land(&mut self, here: &Point, there: &Point, s: f64) -> Result<Point, Failure> {
        let share = (s - here.s) / (there.s - here.s);
        let guess: Vec<f64> = here.u.iter().zip(&there.u).map(|(a, b)| a + share * (b - a)).collect();
        let fixed = Tangent { u: vec![0.0; guess.len()], s: 1.0 };
        let mut point = self.correct((guess, s), &Point { tangent: fixed, s, ..here.clone() }, 0.0)?;
        point.s = s;
        point.tangent = self.tangent(&point.u, s, &here.tangent)?;
        Ok(point)
    }

    /// How far a step may go: see [`PathOptions::step`](crate::PathOptions).
    pub fn longest(&self, here: &Point, step: f64) -> f64 {
        let reach = REACH * step * self.model.discretization().mesh().diagonal();
        (step / here.tangent.s.abs()).min(reach / self.mean_square(&here.tangent.u).sqrt())
    }

    /// The inner product of two directions.
    pub fn product(&self, a: &Tangent, b: &Tangent) -> f64 {
        dot(&a.u, &self.weighted(&b.u)) + a.s * b.s
    }

    /// A point as it is told.
    pub fn told(&self, point: &Point) -> PathPoint {
        let state = self.state(point);
        let negative = self.model.negative_pivots_by(&state, self.how).ok();
        PathPoint { s: point.s, slope: point.tangent.s, state, negative }
    }

    pub fn state(&self, point: &Point) -> State {
        let (controls, load) = self.prescribed(point.s);
        let report = SolveReport { newton: point.newton, load_steps: 1, ..point.report };
        State::equilibrium(point.u.clone(), controls, load, report)
    }

    /// Newton's method from a guess to the equilibrium in the plane at this distance along the direction of a point.
    fn correct(&mut self, guess: (Vec<f64>, f64), from: &Point, length: f64) -> Result<Point, Failure> {
        let (mut u, mut s) = guess;
        let mut report = SolveReport::default();
        let (mut before, mut least) = (f64::INFINITY, f64::INFINITY);
        let resolution = RESOLUTION * self.model.discretization().mesh().diagonal();
        let mut tiny = false;
        for newton in 0..=ITERATIONS {
            if self.how.cancelled() {
                return Err(Failure::Cancelled);
            }
            self.support(&mut u, s);
            let now = self.evaluate(&u, s, true)?;
            let mut residual = now.force;
            self.model.supports.clear(&mut residual);
            let size = norm(&residual);
            let relative = if size == 0.0 { 0.0 } else { size / norm(&now.force_scale) };
            (report.residual, report.min_j, report.energy) = (relative, now.min_j, now.energy);
            self.tell(s, newton, &report);
            if tiny || relative <= self.how.accuracy || (relative <= ROUNDING && relative > 0.5 * before) {
                return Ok(Point { u, s, tangent: from.tangent.clone(), newton, report });
            }
            if newton == ITERATIONS || relative > DIVERGED * least || !relative.is_finite() {
                return Err(Failure::Slow { residual: relative, newton, s });
            }
            (before, least) = (relative, relative.min(least));
            let distance = self.distance((&u, s), from);
            let force: Vec<f64> = residual.iter().map(|r| -r).collect();
            let (du, ds) = self.solve((&u, s), &from.tangent, (&force, length - distance), &mut report)?;
            let (controls, load) = self.prescribed(s);
            if self.model.max_step(&self.at(&u, &controls, load), &du)? < 1.0 {
                return Err(Failure::Slow { residual: relative, newton, s });
            }
            u.iter_mut().zip(&du).for_each(|(u, d)| *u += d);
            s += ds;
            tiny = max_abs(&du) <= resolution;
        }
        Err(Failure::Slow { residual: report.residual, newton: ITERATIONS, s })
    }

    /// The direction of the path at a point, on the side of another one.
    fn tangent(&mut self, u: &[f64], s: f64, towards: &Tangent) -> Result<Tangent, Failure> {
        let none = vec![0.0; u.len()];
        let (u, s) = self.solve((u, s), towards, (&none, 1.0), &mut SolveReport::default())?;
        Ok(self.normalized(Tangent { u, s }))
    }

    /// `K x + r_s y = f`, `<t_u, x> + t_s y = g`: x with the supports' motion, and y.
    ///
    /// K is singular at limit points, where block elimination would lose all digits. With `k = K_jj > 0` and q = k x_j,
    /// j the component that moves most along the row, the same system is
    ///
    /// ```text
    /// (K + k e_j e_j^T) x + r_s y - e_j q = f,    <t_u, x> + t_s y = g,    k x_j - q = 0
    /// ```
    ///
    /// whose first block, the tangent of the body held at j by a spring, is regular there, and positive definite around
    /// the first limit point.
    fn solve(
        &mut self,
        (u, s): (&[f64], f64),
        row: &Tangent,
        (f, g): (&[f64], f64),
        report: &mut SolveReport,
    ) -> Result<(Vec<f64>, f64), Failure> {
        let (controls, load) = self.prescribed(s);
        let mut matrix = self.model.matrix();
        self.model.add_tangent(&self.at(u, &controls, load), &mut matrix)?;
        let support = self.support_motion(s);
        let mut column = self.residual_by_s(u, s)?;
        let mut pulled = vec![0.0; u.len()];
        matrix.multiply_on(&support, &mut pulled, self.how.parallel);
        column.iter_mut().zip(&pulled).for_each(|(c, p)| *c += p);
        self.model.supports.clear(&mut column);
        eliminate(self.model, &mut matrix);
        // The constraint in the units of the residual, so that both count alike in the residual of the whole system.
        let scale = Some(norm(&column)).filter(|size| *size > 0.0).unwrap_or(1.0);
        let row_u: Vec<f64> = self.weighted(&row.u).iter().map(|r| scale * r).collect();
        let spring = spring(&mut matrix, &row_u);
        let unit = |value: f64| {
            let mut e = vec![0.0; u.len()];
            e[spring.at] = value;
            e
        };
        let border = Border {
            columns: vec![column, unit(-1.0)],
            rows: vec![row_u, unit(spring.stiffness)],
            corner: DMatrix::from_row_slice(2, 2, &[scale * row.s, 0.0, 0.0, -1.0]),
        };
        let solver = self.model.linear_solver(self.how, self.workspace);
        let mut systems = TangentSystems::new(self.model, self.how.parallel, solver);
        let (mut x, y) = systems.solve_bordered(&matrix, u, &border, (f, &[scale * g, 0.0]), report)?;
        let y = y[0];
        x.iter_mut().zip(&support).for_each(|(x, w)| *x += y * w);
        Ok((x, y))
    }

    /// Derivative of the residual by s, the displacement held.
    fn residual_by_s(&self, u: &[f64], s: f64) -> Result<Vec<f64>, Inadmissible> {
        let behind = self.evaluate(u, s + DIFFERENCE, false)?.force;
        let before = self.evaluate(u, s - DIFFERENCE, false)?.force;
        Ok(behind.iter().zip(&before).map(|(b, a)| (b - a) / (2.0 * DIFFERENCE)).collect())
    }

    fn evaluate(&self, u: &[f64], s: f64, energy: bool) -> Result<Sums, Inadmissible> {
        let (controls, load) = self.prescribed(s);
        self.model.evaluate(&self.at(u, &controls, load), Demand { energy, force: true })
    }

    fn at<'u>(&self, u: &'u [f64], controls: &'u Controls, load: f64) -> Instant<'u> {
        Instant { parallel: self.how.parallel, ..Instant::new(u, controls, load) }
    }

    fn prescribed(&self, s: f64) -> (Controls, f64) {
        let load = if s == 1.0 { self.to.1 } else { self.from.load + s * (self.to.1 - self.from.load) };
        (self.from.controls.blend(self.to.0, s), load)
    }

    /// Puts supported components where they belong at s.
    fn support(&self, u: &mut [f64], s: f64) {
        let (controls, load) = self.prescribed(s);
        let values = self.model.prescribed(&controls, load);
        for ((u, &fixed), value) in u.iter_mut().zip(self.model.supports.fixed()).zip(values) {
            if fixed {
                *u = value;
            }
        }
    }

    /// Derivative of the supported components by s.
    fn support_motion(&self, s: f64) -> Vec<f64> {
        let supports = &self.model.supports;
        let change = self.to.1 - self.from.load;
        let fixed = supports.fixed().iter().zip(supports.values());
        let mut out: Vec<f64> = fixed.map(|(&f, v)| if f { change * v } else { 0.0 }).collect();
        let along = self.to.0.minus(&self.from.controls);
        if let Some(driven) = self.model.prescribed_change(&self.prescribed(s).0, &along) {
            out.iter_mut().zip(driven).for_each(|(o, d)| *o += d);
        }
        out
    }

    /// How far the second point is along the direction of the first.
    pub fn along(&self, from: &Point, point: &Point) -> f64 {
        self.distance((&point.u, point.s), from)
    }

    fn distance(&self, (u, s): (&[f64], f64), from: &Point) -> f64 {
        let moved: Vec<f64> = u.iter().zip(&from.u).map(|(u, v)| u - v).collect();
        dot(&self.weighted(&from.tangent.u), &moved) + from.tangent.s * (s - from.s)
    }

    fn weighted(&self, u: &[f64]) -> Vec<f64> {
        u.iter().zip(&self.weights).map(|(u, w)| u * w * self.scale).collect()
    }

    fn mean_square(&self, u: &[f64]) -> f64 {
        u.iter().zip(&self.weights).map(|(u, w)| u * u * w).sum()
    }

    fn normalized(&self, tangent: Tangent) -> Tangent {
        let size = self.product(&tangent, &tangent).sqrt();
        let Tangent { u, s } = tangent;
        Tangent { u: u.into_iter().map(|u| u / size).collect(), s: s / size }
    }

    fn tell(&self, s: f64, newton: usize, report: &SolveReport) {
        if let Some(watch) = self.how.watch {
            watch(&Progress { load: s, newton, residual: report.residual, step: 1.0, energy: report.energy });
        }
    }
}

/// A spring that holds one component.
struct Spring {
    at: usize,
    stiffness: f64,
}

/// Adds to a matrix a spring at the component where a row is largest, as stiff as the matrix is there; none for a row
/// of zeros.
fn spring(matrix: &mut SparseMatrix, row: &[f64]) -> Spring {
    let largest = |at: usize, k: usize| if row[k].abs() > row[at].abs() { k } else { at };
    let at = (0..row.len()).fold(0, largest);
    let stiffness = if row[at] == 0.0 { 0.0 } else { matrix.diagonal()[at].abs() };
    let mut diagonal = vec![0.0; row.len()];
    diagonal[at] = stiffness;
    matrix.add_diagonal(&diagonal);
    Spring { at, stiffness }
}
