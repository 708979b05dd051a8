//! [`solve_bordered`]: a few scalar unknowns beside the nodal ones.

use super::{Accuracy, LinearError, LinearSolver, LinearWork, System};
use nalgebra::{DMatrix, DVector};
use nastic_numeric::vector::{axpy, dot, norm};

/// The border of `[A B; C^T D]`: for every scalar unknown a column of B and a row of `C^T`, and the corner D.
#[derive(Clone, Debug)]
pub struct Border {
    /// Columns of B, one per scalar unknown; zero where A is eliminated.
    pub columns: Vec<Vec<f64>>,
    /// Columns of C; zero where A is eliminated. The same as `columns` in a symmetric system.
    pub rows: Vec<Vec<f64>>,
    /// D.
    pub corner: DMatrix<f64>,
}

impl Border {
    fn check(&self, unknowns: usize, scalars: usize) -> Result<(), LinearError> {
        let long = |vectors: &[Vec<f64>]| vectors.len() == scalars && vectors.iter().all(|v| v.len() == unknowns);
        let fits = long(&self.columns) && long(&self.rows) && self.corner.shape() == (scalars, scalars);
        if fits { Ok(()) } else { Err(LinearError::ForeignBorder { unknowns, scalars }) }
    }
}

/// Relative change of x by a correction that rounding alone may cause: in slender bodies residuals stay far above what
/// is wanted, because large terms cancel in A x, and what a correction leaves alone is a solution all the same.
const SETTLED: f64 = 1e-7;
/// Corrections of the solution by its residual: elimination loses digits where A is nearly singular.
const CORRECTIONS: usize = 3;

/// Solves `A x + B y = f`, `C^T x + D y = g` by block elimination,
///
/// ```text
/// Z = A^-1 B,   (D - C^T Z) y = g - C^T A^-1 f,   x = A^-1 f - Z y
/// ```
///
/// corrected by its own residual. With `transposed`, the system is `[A^T C; B^T D^T]`, that of an adjoint. A itself must be
/// regular; it may be close to singular, as near a limit point. Govaerts, "Stable solvers and block elimination for bordered
/// systems", SIAM J. Matrix Anal. 12 (1991).
///
/// # Errors
/// What the solver says of A; [`LinearError::Border`] where the Schur complement is singular; lengths that do not fit; a residual
/// that stays above `accuracy.residual` while corrections still change x by more than 1e-7 of it.
pub fn solve_bordered(
    solver: &mut dyn LinearSolver,
    system: &System,
    border: &Border,
    (f, g): (&[f64], &[f64]),
    transposed: bool,
    accuracy: Accuracy,
    work: &mut LinearWork,
) -> Result<(Vec<f64>, Vec<f64>), LinearError> {
    border.check(f.len(), g.len())?;
    let (columns, rows) = if transposed { (&border.rows, &border.columns) } else { (&border.columns, &border.rows) };
    let corner = if transposed { border.corner.transpose() } else { border.corner.clone() };
    let mut inverse = |b: &[f64]| match transposed {
        true => solver.solve_transposed(system, b, accuracy, work),
        false => solver.solve(system, b, accuracy, work),
    };
    let z = columns.iter().map(|b| inverse(b)).collect::<Result<Vec<_>, _>>()?;
    let scalars = columns.len();
    let schur = DMatrix::from_fn(scalars, scalars, |i, j| corner[(i, j)] - dot(&rows[i], &z[j]));
    let schur = schur.full_piv_lu();
    let (mut x, mut y) = (vec![0.0; f.len()], vec![0.0; scalars]);
    let (mut residual_f, mut residual_g) = (f.to_vec(), g.to_vec());
    let wanted = accuracy.residual * norm(f).hypot(norm(g));
    for _ in 0..=CORRECTIONS {
        let inner = inverse(&residual_f)?;
        let rhs = DVector::from_fn(scalars, |i, _| residual_g[i] - dot(&rows[i], &inner));
        let dy = schur.solve(&rhs).filter(|dy| dy.iter().all(|y| y.is_finite()));
        let dy = dy.ok_or(LinearError::Border { scalars })?;
        let mut dx = inner;
        for (k, z) in z.iter().enumerate() {
            axpy(-dy[k], z, &mut dx);
            y[k] += dy[k];
        }
        let settled = norm(&dx) <= SETTLED * norm(&x);
        axpy(1.0, &dx, &mut x);
        let apply = |v: &[f64], out: &mut [f64]| match transposed {
            true => system.matrix.multiply_transposed(v, out, system.parallel),
            false => system.matrix.multiply_on(v, out, system.parallel),
        };
        apply(&x, &mut residual_f);
        residual_f.iter_mut().zip(f).for_each(|(r, f)| *r = f - *r);
        for (k, b) in columns.iter().enumerate() {
            axpy(-y[k], b, &mut residual_f);
        }
        for i in 0..scalars {
            let corner: f64 = (0..scalars).map(|j| corner[(i, j)] * y[j]).sum();
            residual_g[i] = g[i] - dot(&rows[i], &x) - corner;
        }
        if settled || norm(&residual_f).hypot(norm(&residual_g)) <= wanted {
            return Ok((x, y));
        }
    }
    let residual = norm(&residual_f).hypot(norm(&residual_g)) / norm(f).hypot(norm(g));
    Err(LinearError::Singular { residual, wanted: accuracy.residual })
}
