//! [`gmres`], and [`flexible_gmres`] for systems whose preconditioner changes.

use super::conjugate_gradients::{CgEnd, CgReport, relative};
use crate::pattern::operator::Preconditioner;
use crate::sums;

/// Directions of [`gmres`] between restarts.
const RESTART_LENGTH: usize = 60;

/// What differs between the systems that are solved by [`flexible_gmres`].
#[derive(Clone, Copy)]
pub(super) struct CycleRules {
    /// Directions between restarts.
    pub length: usize,
    /// How often a new vector is made orthogonal to the others: once leaves some that are not orthogonal to working precision.
    pub passes: usize,
    /// Whether sums use all threads; the bits are the same.
    pub parallel: bool,
    /// Where the vectors are cut into two blocks that are summed one after the other.
    pub split: usize,
}

/// A system whose residual is minimised over the images of directions, `x = sum_k y_k z_k`.
pub(super) trait FlexibleSystem {
    fn rules(&self) -> CycleRules;

    /// `b - A x`, as it is; what is known of the directions before a restart is dropped.
    fn residual(&mut self) -> Vec<f64>;

    /// `A z` for the next direction, `z = M^-1 v` with the newest vector of the basis.
    fn image(&mut self, newest: &[f64]) -> Vec<f64>;

    /// What to do: before the first step of a cycle, and after every step.
    fn next(&mut self, cycle: &Cycle, iterations: usize) -> Next;

    /// Adds to x what the directions of a cycle make.
    fn take(&mut self, cycle: &Cycle);
}

/// What a [`FlexibleSystem`] has next.
pub(super) enum Next {
    /// One more direction.
    Step,
    /// From the residual as it is.
    Restart,
    /// The end, with its relative residual.
    End(CgEnd, f64),
}

/// Minimises the residual over Krylov spaces, cycle by cycle, until the system ends it. Directions may come of a preconditioner that changes:
/// Saad, "A flexible inner-outer preconditioned GMRES algorithm", SIAM J. Sci. Comput. 14 (1993).
pub(super) fn flexible_gmres(system: &mut impl FlexibleSystem) -> CgReport {
    let (rules, mut iterations) = (system.rules(), 0);
    loop {
        let mut cycle = Cycle::begin(system.residual(), rules);
        let next = loop {
            match system.next(&cycle, iterations) {
                Next::Step if cycle.is_over() => break Next::Restart,
                Next::Step => {}
                other => break other,
            }
            iterations += 1;
            let image = system.image(cycle.newest());
            cycle.push(image);
        };
        if !matches!(next, Next::End(CgEnd::NotFinite, _)) {
            system.take(&cycle);
        }
        if let Next::End(end, residual) = next {
            return CgReport { end, iterations, residual };
        }
    }
}

/// Arnoldi's method between two restarts, with the QR factorisation of its Hessenberg matrix by rotations.
pub(super) struct Cycle {
    rules: CycleRules,
    /// Norm of the residual it began with.
    size: f64,
    basis: Vec<Vec<f64>>,
    /// Columns of the triangular factor.
    columns: Vec<Vec<f64>>,
    rotations: Vec<[f64; 2]>,
    /// The rotated right-hand side.
    rhs: Vec<f64>,
    /// Whether the space no longer grows.
    exhausted: bool,
}

impl Cycle {
    fn begin(residual: Vec<f64>, rules: CycleRules) -> Self {
        let size = dot(&residual, &residual, rules).sqrt();
        let (basis, rhs) = (vec![unit(residual, size)], vec![size]);
        Cycle { rules, size, basis, columns: Vec::new(), rotations: Vec::new(), rhs, exhausted: false }
    }

    /// Norm of the residual that the cycle began with.
    pub fn size(&self) -> f64 {
        self.size
    }

    /// Number of directions.
    pub fn len(&self) -> usize {
        self.columns.len()
    }

    /// What is left of the residual, as the rotations carry it.
    pub fn left(&self) -> f64 {
        self.rhs.last().map_or(0.0, |last| last.abs())
    }

    /// Whether there is no room for more.
    pub fn is_over(&self) -> bool {
        self.exhausted || self.len() == self.rules.length
    }

    /// The vectors whose directions there are, the first first.
    pub fn basis(&self) -> &[Vec<f64>] {
        &self.basis[..self.len()]
    }

    fn newest(&self) -> &[f64] {
        self.basis.last().map_or(&[], Vec::as_slice)
    }

    /// Makes the image of the newest direction the next vector of the basis, and its column a part of the triangle.
    fn push(&mut self, mut image: Vec<f64>) {
        let (mut column, rules) = (vec![0.0; self.basis.len()], self.rules);
        for _ in 0..rules.passes {
            for (h, v) in column.iter_mut().zip(&self.basis) {
                let share = dot(v, &image, rules);
                *h += share;
                sums::zipped(&mut image, v, rules.parallel, |w, v| *w -= share * v);
            }
        }
        let length = dot(&image, &image, rules).sqrt();
        let whole = column.iter().fold(length, |norm, h| norm.hypot(*h));
        for (k, &[c, s]) in self.rotations.iter().enumerate() {
            (column[k], column[k + 1]) = (c * column[k] + s * column[k + 1], c * column[k + 1] - s * column[k]);
        }
        let last = column.len() - 1;
        let radius = column[last].hypot(length);
        let [c, s] = if radius > 0.0 { [column[last] / radius, length / radius] } else { [1.0, 0.0] };
        column[last] = radius;
        let rhs = self.rhs[last];
        self.rhs[last] = c * rhs;
        self.rhs.push(-s * rhs);
        self.rotations.push([c, s]);
        self.columns.push(column);
        self.exhausted = length <= f64::EPSILON * whole;
        self.basis.push(unit(image, length));
    }

    /// The factors of the directions that leave the least residual.
    pub fn coefficients(&self) -> Vec<f64> {
        let mut y = self.rhs[..self.len()].to_vec();
        for i in (0..y.len()).rev() {
            let known: f64 = (i + 1..y.len()).map(|j| self.columns[j][i] * y[j]).sum();
            y[i] = if self.columns[i][i] == 0.0 { 0.0 } else { (y[i] - known) / self.columns[i][i] };
        }
        y
    }
}

fn dot(a: &[f64], b: &[f64], rules: CycleRules) -> f64 {
    let (first, second) = (..rules.split, rules.split..);
    sums::dot(&a[first], &b[first], rules.parallel) + sums::dot(&a[second.clone()], &b[second], rules.parallel)
}

fn unit(mut v: Vec<f64>, length: f64) -> Vec<f64> {
    let scale = if length > 0.0 { 1.0 / length } else { 0.0 };
    v.iter_mut().for_each(|x| *x *= scale);
    v
}

/// Solves `A x = b` from `x = 0` until `|b - A x| <= tolerance |b|`, in at most `most` iterations.
///
/// Minimises `|b - A M^-1 y|` over Krylov spaces of `A M^-1` (M the preconditioner, on the right: residuals are those of
/// the system itself), `x = M^-1 y`; starts again after 60 directions. Where A has a symmetric positive definite part that is
/// M, the eigenvalues of `A M^-1` are `1 + i s`: convergence is fast while the skew part is small beside it.
/// Saad, Schultz, SIAM J. Sci. Stat. Comput. 7 (1986).
pub fn gmres(
    apply: &dyn Fn(&[f64], &mut [f64]),
    preconditioner: &dyn Preconditioner,
    b: &[f64],
    tolerance: f64,
    most: usize,
) -> (Vec<f64>, CgReport) {
    let (x, scale) = (vec![0.0; b.len()], sums::norm(b, false));
    let mut system = Preconditioned { apply, preconditioner, b, x, scale, tolerance, most, before: None };
    let report = flexible_gmres(&mut system);
    (system.x, report)
}

/// `A x = b` with a preconditioner that is the same for all directions, so that these need not be kept.
struct Preconditioned<'a> {
    apply: &'a dyn Fn(&[f64], &mut [f64]),
    preconditioner: &'a dyn Preconditioner,
    b: &'a [f64],
    x: Vec<f64>,
    /// `|b|`.
    scale: f64,
    tolerance: f64,
    most: usize,
    /// Norm of the residual before the last cycle, of one that ended early.
    before: Option<f64>,
}

impl FlexibleSystem for Preconditioned<'_> {
    fn rules(&self) -> CycleRules {
        CycleRules { length: RESTART_LENGTH, passes: 2, parallel: false, split: self.b.len() }
    }

    fn residual(&mut self) -> Vec<f64> {
        let mut residual = vec![0.0; self.b.len()];
        if self.x.iter().any(|&x| x != 0.0) {
            (self.apply)(&self.x, &mut residual);
        }
        residual.iter_mut().zip(self.b).for_each(|(r, b)| *r = b - *r);
        residual
    }

    fn image(&mut self, newest: &[f64]) -> Vec<f64> {
        let (mut direction, mut image) = (newest.to_vec(), vec![0.0; newest.len()]);
        self.preconditioner.apply(&mut direction);
        (self.apply)(&direction, &mut image);
        image
    }

    fn next(&mut self, cycle: &Cycle, iterations: usize) -> Next {
        let (left, wanted) = (cycle.left(), self.tolerance * self.scale);
        if cycle.len() > 0 && !left.is_finite() {
            return Next::End(CgEnd::NotFinite, relative(cycle.size(), self.scale));
        }
        if cycle.len() > 0 {
            // a restart shows what the residual is
            let is_over = left <= wanted || iterations == self.most;
            return if is_over { Next::Restart } else { Next::Step };
        }
        let end = match self.before {
            _ if left <= wanted => CgEnd::Converged,
            _ if !left.is_finite() => CgEnd::NotFinite,
            // double precision ends here, or the space no longer grows
            Some(before) if left > 0.5 * before => CgEnd::Stagnated,
            _ if iterations == self.most => CgEnd::Exhausted,
            _ => return Next::Step,
        };
        Next::End(end, relative(left, self.scale))
    }

    fn take(&mut self, cycle: &Cycle) {
        self.before = (cycle.len() < RESTART_LENGTH).then_some(cycle.size());
        let mut step = vec![0.0; self.b.len()];
        for (factor, v) in cycle.coefficients().iter().zip(cycle.basis()) {
            sums::zipped(&mut step, v, false, |x, v| *x += factor * v);
        }
        self.preconditioner.apply(&mut step);
        sums::zipped(&mut self.x, &step, false, |x, z| *x += z);
    }
}
