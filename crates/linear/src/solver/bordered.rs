//! [`BlockElimination`], [`solve_bordered`]: a few scalar unknowns beside the nodal ones.

use super::{Accuracy, LinearError, LinearSolver, LinearWork, Solution, System};
use crate::space::Space;
use nalgebra::{DMatrix, DVector, Dyn, FullPivLU};
use nastic_numeric::vector::axpy;

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

/// The solution of a bordered system.
#[derive(Clone, Debug, PartialEq)]
pub struct BorderedSolution {
    /// The nodal unknowns.
    pub x: Vec<f64>,
    /// The scalar ones.
    pub y: Vec<f64>,
    /// Negative eigenvalues of A, where what solved with it shows them.
    pub negative: Option<usize>,
}

impl Border {
    /// Columns beside the matrix of a system, and rows below it.
    fn of(&self, system: &System) -> (&[Vec<f64>], &[Vec<f64>]) {
        if system.transposed { (&self.rows, &self.columns) } else { (&self.columns, &self.rows) }
    }

    fn check(&self, unknowns: usize, scalars: usize) -> Result<(), LinearError> {
        let long = |vectors: &[Vec<f64>]| vectors.len() == scalars && vectors.iter().all(|v| v.len() == unknowns);
        let fits = long(&self.columns) && long(&self.rows) && self.corner.shape() == (scalars, scalars);
        if fits { Ok(()) } else { Err(LinearError::ForeignBorder { unknowns, scalars }) }
    }
}

/// Relative change of x by a correction that is rounding alone: in slender bodies residuals stay far above the one asked for,
/// because large terms cancel in A x, and an x that a correction does not change is a solution.
const ROUNDING_CHANGE: f64 = 1e-7;
/// Corrections of the solution by its residual: elimination loses digits where A is nearly singular.
const MAX_CORRECTIONS: usize = 3;

/// Share of the largest eigenvalue of a Schur complement below which the sign of another is uncertain.
const MIN_CERTAIN_SHARE: f64 = 1e-12;

/// Solves `A x + B y = f`, `C^T x + D y = g` by block elimination,
///
/// ```text
/// Z = A^-1 B,   S = D - C^T Z,   S y = g - C^T A^-1 f,   x = A^-1 f - Z y
/// ```
///
/// corrected by its own residual. Of a [transposed](System::transposed) system it is `[A^T C; B^T D^T]`, that of an adjoint. A itself must be
/// regular; it may be close to singular, as near a limit point. Govaerts, "Stable solvers and block elimination for bordered
/// systems", SIAM J. Matrix Anal. 12 (1991).
#[derive(Clone, Debug)]
pub struct BlockElimination<'b> {
    border: &'b Border,
    accuracy: Accuracy,
    /// Z, column by column.
    z: Vec<Vec<f64>>,
    schur: DMatrix<f64>,
    factor: FullPivLU<f64, Dyn, Dyn>,
}

impl<'b> BlockElimination<'b> {
    /// Solves for Z to an accuracy that holds for solutions as well.
    ///
    /// # Errors
    /// What the solver says of A; lengths that do not fit.
    pub fn new(
        solver: &mut dyn LinearSolver,
        system: &System,
        border: &'b Border,
        accuracy: Accuracy,
        work: &mut LinearWork,
    ) -> Result<Self, LinearError> {
        border.check(system.fixed.len(), border.corner.nrows())?;
        let (columns, rows) = border.of(system);
        let corner = if system.transposed { border.corner.transpose() } else { border.corner.clone() };
        let inverse = |b: &Vec<f64>| solver.solve(system, b, accuracy, work).map(|solution| solution.x);
        let z = columns.iter().map(inverse).collect::<Result<Vec<_>, _>>()?;
        let scalars = columns.len();
        let schur = DMatrix::from_fn(scalars, scalars, |i, j| corner[(i, j)] - system.space().dot(&rows[i], &z[j]));
        let factor = schur.clone().full_piv_lu();
        Ok(BlockElimination { border, accuracy, z, schur, factor })
    }

    /// Negative eigenvalues of S in a symmetric system, which with those of A are those of the whole system (Haynsworth's
    /// inertia additivity); `None` where rounding decides the sign of one.
    pub fn negative(&self) -> Option<usize> {
        let n = self.schur.nrows();
        if n == 0 {
            return Some(0);
        }
        // Congruence with a diagonal matrix keeps the signs, and takes the units of the scalar unknowns away.
        let size = |i: usize| self.schur.row(i).iter().fold(0.0, |most: f64, s| most.max(s.abs())).sqrt();
        let scaled = DMatrix::from_fn(n, n, |i, j| {
            0.5 * (self.schur[(i, j)] + self.schur[(j, i)]) / (size(i) * size(j)).max(f64::MIN_POSITIVE)
        });
        if scaled.iter().any(|entry| !entry.is_finite()) {
            return None;
        }
        let values = scaled.symmetric_eigenvalues();
        let largest = values.amax();
        let certain = values.iter().all(|value| value.abs() > MIN_CERTAIN_SHARE * largest);
        certain.then(|| values.iter().filter(|value| **value < 0.0).count())
    }

    /// The solution for a right-hand side.
    ///
    /// # Errors
    /// What the solver says of A; [`LinearError::Border`] where S is singular; lengths that do not fit; a residual that stays
    /// above `accuracy.residual` while corrections still change x by more than 1e-7 of it.
    pub fn solve(
        &self,
        solver: &mut dyn LinearSolver,
        system: &System,
        f: &[f64],
        g: &[f64],
        work: &mut LinearWork,
    ) -> Result<BorderedSolution, LinearError> {
        let Self { border, accuracy, .. } = *self;
        border.check(f.len(), g.len())?;
        let space = system.space();
        let (columns, rows) = border.of(system);
        let scalars = columns.len();
        let corner = |i: usize, j: usize| if system.transposed { border.corner[(j, i)] } else { border.corner[(i, j)] };
        let (mut x, mut y) = (vec![0.0; f.len()], vec![0.0; scalars]);
        let (mut residual_f, mut residual_g) = (f.to_vec(), g.to_vec());
        let wanted = accuracy.residual * space.norm(f).hypot(Space::LOCAL.norm(g));
        for _ in 0..=MAX_CORRECTIONS {
            let Solution { x: inner, negative } = solver.solve(system, &residual_f, accuracy, work)?;
            let rhs = DVector::from_fn(scalars, |i, _| residual_g[i] - space.dot(&rows[i], &inner));
            // LU of nothing panics
            let dy = if scalars == 0 { Some(rhs) } else { self.factor.solve(&rhs) };
            let dy = dy.filter(|dy| dy.iter().all(|y| y.is_finite()));
            let dy = dy.ok_or(LinearError::Border { scalars })?;
            let mut dx = inner;
            for (k, z) in self.z.iter().enumerate() {
                axpy(-dy[k], z, &mut dx);
                y[k] += dy[k];
            }
            let settled = space.norm(&dx) <= ROUNDING_CHANGE * space.norm(&x);
            axpy(1.0, &dx, &mut x);
            system.multiply(&x, &mut residual_f);
            residual_f.iter_mut().zip(f).for_each(|(r, f)| *r = f - *r);
            for (k, b) in columns.iter().enumerate() {
                axpy(-y[k], b, &mut residual_f);
            }
            for i in 0..scalars {
                let corner: f64 = (0..scalars).map(|j| corner(i, j) * y[j]).sum();
                residual_g[i] = g[i] - space.dot(&rows[i], &x) - corner;
            }
            if settled || space.norm(&residual_f).hypot(Space::LOCAL.norm(&residual_g)) <= wanted {
                return Ok(BorderedSolution { x, y, negative });
            }
        }
        let residual =
            space.norm(&residual_f).hypot(Space::LOCAL.norm(&residual_g)) / space.norm(f).hypot(Space::LOCAL.norm(g));
        Err(LinearError::Singular { residual, wanted: accuracy.residual })
    }
}

/// The solution of one system by [`BlockElimination`].
///
/// # Errors
/// As there.
pub fn solve_bordered(
    solver: &mut dyn LinearSolver,
    system: &System,
    border: &Border,
    rhs: (&[f64], &[f64]),
    accuracy: Accuracy,
    work: &mut LinearWork,
) -> Result<BorderedSolution, LinearError> {
    border.check(rhs.0.len(), rhs.1.len())?;
    BlockElimination::new(solver, system, border, accuracy, work)?.solve(solver, system, rhs.0, rhs.1, work)
}
