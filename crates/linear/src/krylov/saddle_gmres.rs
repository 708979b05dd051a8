//! Nearly incompressible matrices by GMRES, with the pressures as unknowns.

use super::conjugate_gradients::{CgEnd, CgReport, relative};
use super::gmres::{Cycle, CycleRules, FlexibleSystem, Next, flexible_gmres};
use super::volume_modes::VolumeModes;
use crate::pattern::operator::Preconditioner;
use crate::sums::{self, dot};

/// Vectors between restarts.
const RESTART_LENGTH: usize = 30;
/// Curvature of a direction, as a share of the curvature of its newest part, below which it is rounding.
const DEPENDENCE_TOLERANCE: f64 = 1e-10;
/// Iterations where A is not positive definite, so that K may not be either.
const MAX_INDEFINITE_ITERATIONS: usize = 60;
/// Share of the residual left by all directions between two restarts, above which the iteration stagnates.
const STAGNATION_RATIO: f64 = 0.8;
/// Largest ratio of the residual at the next evaluation of the solution to the present one, where the solution is not accurate enough yet.
const TARGET_RATIO: f64 = 0.7;
/// Smallest such ratio.
const MIN_DECREASE: f64 = 1e-3;

/// `K x = f` with `K = A + B^T C^-1 B`: the saddle-point system `A u + B^T p = f`, `B u - C p = 0` by flexible GMRES, whose preconditioner
/// is block triangular, with a preconditioner of A and `1 / c + 1 / g` per pressure, g being the bulk modulus of A: `B A^-1 B^T` is near `1 / g` for any mesh
/// on which displacements control pressures. The residual is that of K, in which an error of the second row is multiplied by the bulk modulus, or that of
/// the saddle-point system, whose second row is then a force, `|b| / (1 / c + 1 / g)` times the difference of the volumes.
///
/// Elman, Silvester, Wathen, *Finite Elements and Fast Iterative Solvers* (2014), chapter 4.
pub(crate) struct SaddleGmres<'a> {
    /// `out = K v`.
    pub apply: &'a dyn Fn(&[f64], &mut [f64]),
    pub modes: &'a VolumeModes,
    /// Of A.
    pub preconditioner: &'a dyn Preconditioner,
    pub counts: Counts,
}

/// The residual of the stopping test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Counts {
    /// Of K, as a share of the right-hand side.
    Matrix,
    /// Of the saddle-point system, as a share of this.
    System(f64),
}

/// Displacements and pressures to begin with, which the solution replaces.
pub(crate) struct Start<'a> {
    pub u: &'a mut [f64],
    pub p: &'a mut [f64],
}

/// Residual and largest number of iterations.
#[derive(Clone, Copy)]
pub(crate) struct Aim {
    pub tolerance: f64,
    pub most: usize,
}

/// The report of an iteration.
pub(crate) struct SaddleReport {
    pub cg: CgReport,
    /// Whether A had positive curvature along all directions, so that K has.
    pub positive: bool,
}

/// Cholesky's factor of `z_i . A z_j`, by rows; rows of dependent directions are zero except for an infinite last entry.
#[derive(Default)]
struct Curvature {
    rows: Vec<Vec<f64>>,
}

/// The state of an iteration.
struct Run<'a> {
    saddle: &'a SaddleGmres<'a>,
    f: &'a [f64],
    /// The norm that residuals are relative to.
    scale: f64,
    tolerance: f64,
    most: usize,
    rows: Rows,
    u: &'a mut [f64],
    p: &'a mut [f64],
    /// Displacements and pressures since the last restart, rounded: flexible GMRES admits any preconditioner.
    directions: Vec<[Vec<f32>; 2]>,
    curvature: Curvature,
    /// A negative curvature of K along the last one.
    negative: Option<f64>,
    /// Whether A had positive curvature along all of them.
    positive: bool,
    /// Residual of the saddle-point system at the last restart.
    left: f64,
    /// Last computed residual of K, and the residual of the saddle-point system at which the next one is computed.
    seen: f64,
    next_look: f64,
}

impl SaddleGmres<'_> {
    /// Memory of the vectors between restarts, for this number of unknowns.
    pub fn bytes(unknowns: usize) -> usize {
        RESTART_LENGTH * (size_of::<f64>() + size_of::<f32>()) * unknowns
    }

    /// From the given displacements and pressures, which may be zero.
    pub fn solve(&self, f: &[f64], start: Start, aim: Aim) -> SaddleReport {
        let scale = match self.counts {
            Counts::Matrix => sums::norm(f, self.preconditioner.parallel()),
            Counts::System(scale) => scale,
        };
        let mut run = Run {
            saddle: self,
            f,
            scale,
            tolerance: aim.tolerance,
            most: aim.most,
            rows: Rows::of(self.modes),
            u: start.u,
            p: start.p,
            directions: Vec::new(),
            curvature: Curvature::default(),
            negative: None,
            positive: true,
            left: f64::INFINITY,
            seen: f64::INFINITY,
            next_look: aim.tolerance,
        };
        let cg = flexible_gmres(&mut run);
        SaddleReport { cg, positive: run.positive }
    }
}

impl FlexibleSystem for Run<'_> {
    fn rules(&self) -> CycleRules {
        let (split, parallel) = (self.f.len(), self.saddle.preconditioner.parallel());
        CycleRules { length: RESTART_LENGTH, passes: 1, parallel, split }
    }

    /// Forces, and differences of volumes scaled to forces.
    fn residual(&mut self) -> Vec<f64> {
        self.directions.clear();
        self.curvature = Curvature::default();
        let SaddleGmres { apply, modes, preconditioner, .. } = self.saddle;
        let parallel = preconditioner.parallel();
        let mut residual = vec![0.0; self.f.len() + modes.len()];
        let (u, p) = residual.split_at_mut(self.f.len());
        if self.u.iter().any(|&u| u != 0.0) || self.p.iter().any(|&p| p != 0.0) {
            apply(self.u, u);
            modes.of(self.u, p, parallel);
            // A u + B^T p = K u + B^T (p - c B u)
            let excess: Vec<f64> =
                p.iter().zip(&*self.p).zip(modes.stiffness()).map(|((bu, p), [c, _])| p - c * bu).collect();
            modes.add(&excess, u, parallel);
            let each = p.iter_mut().zip(&excess).zip(modes.stiffness().iter().zip(&self.rows.scale));
            each.for_each(|((p, excess), ([c, _], scale))| *p = excess * scale / c);
        }
        sums::zipped(u, self.f, parallel, |u, f| *u = f - *u);
        residual
    }

    fn image(&mut self, newest: &[f64]) -> Vec<f64> {
        let SaddleGmres { apply, modes, preconditioner, .. } = self.saddle;
        let (parallel, stiffness) = (preconditioner.parallel(), modes.stiffness());
        let (forces, differences) = newest.split_at(self.f.len());
        let zp: Vec<f64> =
            differences.iter().zip(&self.rows.size).map(|(p, size)| f64::from((-p / size) as f32)).collect();
        let mut zu = forces.to_vec();
        let negative: Vec<f64> = zp.iter().map(|p| -p).collect();
        modes.add(&negative, &mut zu, parallel);
        preconditioner.apply(&mut zu);
        let zu: Vec<f32> = zu.iter().map(|&z| z as f32).collect();
        let wide: Vec<f64> = zu.iter().map(|&z| f64::from(z)).collect();
        let mut image = vec![0.0; newest.len()];
        let (u, p) = image.split_at_mut(self.f.len());
        apply(&wide, u);
        modes.of(&wide, p, parallel);
        let stiff: Vec<f64> = p.iter().zip(stiffness).map(|(bz, [c, _])| -c * bz).collect();
        modes.add(&stiff, u, parallel);
        self.directions.push([zu, zp.iter().map(|&p| p as f32).collect()]);
        self.negative = self.negative_curvature(&wide, u);
        modes.add(&zp, u, parallel);
        for (at, out) in p.iter_mut().enumerate() {
            *out = (*out - zp[at] / stiffness[at][0]) * self.rows.scale[at];
        }
        image
    }

    fn next(&mut self, cycle: &Cycle, iterations: usize) -> Next {
        let end = if cycle.len() == 0 { self.end_at_restart(cycle) } else { self.end_after_step(cycle) };
        if let Some((end, residual)) = end {
            return Next::End(end, residual);
        }
        let spent = iterations == self.most || !self.positive && iterations >= MAX_INDEFINITE_ITERATIONS;
        if cycle.is_over() || !spent {
            return Next::Step;
        }
        let residual = self.look(cycle);
        Next::End(if residual <= self.tolerance { CgEnd::Converged } else { CgEnd::Exhausted }, residual)
    }

    fn take(&mut self, cycle: &Cycle) {
        let parallel = self.saddle.preconditioner.parallel();
        for (factor, [u, p]) in cycle.coefficients().iter().zip(&self.directions) {
            sums::add_single(*factor, u, self.u, parallel);
            sums::add_single(*factor, p, self.p, parallel);
        }
    }
}

impl Run<'_> {
    fn end_at_restart(&mut self, cycle: &Cycle) -> Option<(CgEnd, f64)> {
        let (size, before) = (cycle.size(), std::mem::replace(&mut self.left, cycle.size()));
        if !size.is_finite() {
            return Some((CgEnd::NotFinite, relative(size, self.scale)));
        }
        if size == 0.0 {
            return Some((CgEnd::Converged, 0.0));
        }
        (size > STAGNATION_RATIO * before).then(|| (CgEnd::Stagnated, self.look(cycle)))
    }

    fn end_after_step(&mut self, cycle: &Cycle) -> Option<(CgEnd, f64)> {
        if let Some(curvature) = self.negative {
            return Some((CgEnd::NegativeCurvature { curvature }, f64::INFINITY));
        }
        let left = cycle.left() / self.scale;
        if !left.is_finite() {
            return Some((CgEnd::NotFinite, left));
        }
        if self.saddle.counts != Counts::Matrix {
            return (left <= self.tolerance).then_some((CgEnd::Converged, left));
        }
        if left > self.next_look {
            return None;
        }
        let before = self.seen;
        self.seen = self.look(cycle);
        if self.seen <= self.tolerance {
            return Some((CgEnd::Converged, self.seen));
        }
        if self.seen > 0.5 * before && left <= f64::EPSILON * MIN_DECREASE.recip() {
            return Some((CgEnd::Stagnated, self.seen));
        }
        self.next_look = left * (TARGET_RATIO * self.tolerance / self.seen).clamp(MIN_DECREASE, TARGET_RATIO);
        None
    }

    /// Tests for negative curvature of A among the directions and, if there is any, of K.
    fn negative_curvature(&mut self, z: &[f64], az: &[f64]) -> Option<f64> {
        let SaddleGmres { modes, preconditioner, .. } = self.saddle;
        let parallel = preconditioner.parallel();
        let (own, earlier) = (dot(z, az, parallel), self.directions.len() - 1);
        let products = self.directions[..earlier].iter().map(|[u, _]| sums::dot_single(u, az, parallel)).collect();
        let (pivot, along) = self.curvature.push(products, own);
        if pivot > -DEPENDENCE_TOLERANCE * own.abs() {
            return None;
        }
        self.positive = false;
        let mut direction = z.to_vec();
        for ([u, _], factor) in self.directions.iter().zip(&along) {
            sums::add_single(-factor, u, &mut direction, parallel);
        }
        let mut p = vec![0.0; modes.len()];
        modes.of(&direction, &mut p, parallel);
        let stiff: f64 = p.iter().zip(modes.stiffness()).map(|(p, [c, _])| c * p * p).sum();
        let of_k = pivot + stiff;
        (of_k <= 0.0).then(|| of_k / dot(&direction, &direction, parallel))
    }

    /// The residual of the stopping test for the present combination of the directions.
    fn look(&self, cycle: &Cycle) -> f64 {
        if self.saddle.counts != Counts::Matrix {
            return cycle.left() / self.scale;
        }
        let parallel = self.saddle.preconditioner.parallel();
        let (mut u, mut r) = (self.u.to_vec(), vec![0.0; self.f.len()]);
        for (factor, [z, _]) in cycle.coefficients().iter().zip(&self.directions) {
            sums::add_single(*factor, z, &mut u, parallel);
        }
        (self.saddle.apply)(&u, &mut r);
        sums::zipped(&mut r, self.f, parallel, |r, f| *r = f - *r);
        relative(sums::norm(&r, parallel), self.scale)
    }
}

/// Norm of the residual of the saddle-point system of no displacement and these pressures.
pub(crate) fn residual_of_pressures(modes: &VolumeModes, f: &[f64], p: &[f64], parallel: bool) -> f64 {
    let mut u = f.to_vec();
    let negative: Vec<f64> = p.iter().map(|p| -p).collect();
    modes.add(&negative, &mut u, parallel);
    let rows = Rows::of(modes);
    let scaled =
        p.iter().zip(modes.stiffness()).zip(&rows.scale).map(|((p, [c, _]), scale)| p * scale / c).collect::<Vec<_>>();
    (dot(&u, &u, parallel) + dot(&scaled, &scaled, parallel)).sqrt()
}

/// By row of the second block.
struct Rows {
    /// `|b|`, 1 where that is zero.
    size: Vec<f64>,
    /// `|b| / (1 / c + 1 / g)`, which scales the difference of a volume to a force.
    scale: Vec<f64>,
}

impl Rows {
    fn of(modes: &VolumeModes) -> Self {
        let size: Vec<f64> = modes.norms().map(|norm| if norm > 0.0 { norm } else { 1.0 }).collect();
        let scale = size.iter().zip(modes.stiffness()).map(|(size, &[c, g])| size / (1.0 / c + 1.0 / g)).collect();
        Rows { size, scale }
    }
}

impl Curvature {
    /// The curvature along a new direction less its parts along the earlier ones, and the factors of these.
    fn push(&mut self, products: Vec<f64>, own: f64) -> (f64, Vec<f64>) {
        let mut row: Vec<f64> = products;
        for i in 0..row.len() {
            let known: f64 = (0..i).map(|k| self.rows[i][k] * row[k]).sum();
            row[i] = (row[i] - known) / self.rows[i][i];
        }
        let pivot = own - row.iter().map(|r| r * r).sum::<f64>();
        let mut along = row.clone();
        for i in (0..along.len()).rev() {
            let known: f64 = (i + 1..along.len()).map(|k| self.rows[k][i] * along[k]).sum();
            along[i] = (along[i] - known) / self.rows[i][i];
        }
        match pivot > DEPENDENCE_TOLERANCE * own.abs() {
            true => row.push(pivot.sqrt()),
            false => {
                row.fill(0.0);
                row.push(f64::INFINITY);
            }
        }
        self.rows.push(row);
        (pivot, along)
    }
}
