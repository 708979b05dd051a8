//! GMRES with a preconditioner on the right, for systems that are not symmetric.

use crate::pattern::operator::Preconditioner;
use nastic_numeric::vector::{axpy, dot, norm};

/// Directions kept before the method starts again from what it has.
const RESTART: usize = 60;

/// How an iteration ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GmresReport {
    /// Whether the residual is small enough.
    pub converged: bool,
    /// Applications of the preconditioner.
    pub iterations: usize,
    /// `|b - A x| / |b|`, Euclidean, recomputed at the end.
    pub residual: f64,
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
) -> (Vec<f64>, GmresReport) {
    let scale = norm(b);
    let mut x = vec![0.0; b.len()];
    let mut residual = b.to_vec();
    let (mut size, mut iterations) = (scale, 0);
    while size > tolerance * scale && size.is_finite() && iterations < most {
        let cycle = Cycle::run(apply, preconditioner, &residual, tolerance * scale, RESTART.min(most - iterations));
        iterations += cycle.columns.len();
        let mut step = cycle.combination(b.len());
        preconditioner.apply(&mut step);
        axpy(1.0, &step, &mut x);
        apply(&x, &mut residual);
        residual.iter_mut().zip(b).for_each(|(r, b)| *r = b - *r);
        let before = std::mem::replace(&mut size, norm(&residual));
        // Double precision ends here, or the space no longer grows.
        if size > 0.5 * before && cycle.columns.len() < RESTART {
            break;
        }
    }
    let relative = if size == 0.0 { 0.0 } else { size / scale };
    (x, GmresReport { converged: size <= tolerance * scale, iterations, residual: relative })
}

/// One run of Arnoldi's method with the QR factorisation of its Hessenberg matrix.
struct Cycle {
    basis: Vec<Vec<f64>>,
    /// Columns of the triangular factor.
    columns: Vec<Vec<f64>>,
    rotations: Vec<(f64, f64)>,
    /// The rotated right-hand side.
    rhs: Vec<f64>,
}

impl Cycle {
    fn run(
        apply: &dyn Fn(&[f64], &mut [f64]),
        preconditioner: &dyn Preconditioner,
        residual: &[f64],
        wanted: f64,
        most: usize,
    ) -> Self {
        let size = norm(residual);
        let first = residual.iter().map(|r| r / size).collect();
        let mut cycle = Cycle { basis: vec![first], columns: Vec::new(), rotations: Vec::new(), rhs: vec![size] };
        while cycle.columns.len() < most && cycle.rhs[cycle.columns.len()].abs() > wanted {
            let k = cycle.columns.len();
            let mut direction = cycle.basis[k].clone();
            preconditioner.apply(&mut direction);
            let mut next = vec![0.0; residual.len()];
            apply(&direction, &mut next);
            let mut column = vec![0.0; k + 1];
            // twice: once leaves directions that are not orthogonal to working precision
            for _ in 0..2 {
                for (h, v) in column.iter_mut().zip(&cycle.basis) {
                    let c = dot(&next, v);
                    *h += c;
                    axpy(-c, v, &mut next);
                }
            }
            let length = norm(&next);
            if !length.is_finite() {
                break;
            }
            cycle.close(column, length);
            if length <= f64::EPSILON * size {
                break;
            }
            next.iter_mut().for_each(|v| *v /= length);
            cycle.basis.push(next);
        }
        cycle
    }

    /// Rotates a column of the Hessenberg matrix, whose entry below the diagonal is `length`, into the triangle.
    fn close(&mut self, mut column: Vec<f64>, length: f64) {
        let k = self.columns.len();
        for (i, &(c, s)) in self.rotations.iter().enumerate() {
            (column[i], column[i + 1]) = (c * column[i] + s * column[i + 1], c * column[i + 1] - s * column[i]);
        }
        let radius = column[k].hypot(length);
        let (c, s) = if radius > 0.0 { (column[k] / radius, length / radius) } else { (1.0, 0.0) };
        column[k] = radius;
        let last = self.rhs[k];
        self.rhs[k] = c * last;
        self.rhs.push(-s * last);
        self.rotations.push((c, s));
        self.columns.push(column);
    }

    /// The combination of the basis that minimises the residual.
    fn combination(&self, n: usize) -> Vec<f64> {
        let mut y = self.rhs[..self.columns.len()].to_vec();
        for k in (0..y.len()).rev() {
            if self.columns[k][k] == 0.0 {
                y[k] = 0.0;
                continue;
            }
            y[k] /= self.columns[k][k];
            let (above, own) = y.split_at_mut(k);
            above.iter_mut().zip(&self.columns[k]).for_each(|(y, r)| *y -= r * own[0]);
        }
        let mut out = vec![0.0; n];
        for (c, v) in y.iter().zip(&self.basis) {
            axpy(*c, v, &mut out);
        }
        out
    }
}
