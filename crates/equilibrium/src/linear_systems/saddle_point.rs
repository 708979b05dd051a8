//! [`SaddlePoint`]: the linear systems of a model with constraints.

use crate::linear_systems::local_constraints::{Elimination, Known, LocalConstraints};
use crate::linear_systems::tangent_systems::{Counted, TangentSystems, eliminate};
use crate::model::Model;
use nalgebra::DMatrix;
use nastic_body::contribution::Contribution;
use nastic_body::contribution::point::ContributionPoint;
use nastic_body::discretization::supports::Supports;
use nastic_body::error::Inadmissible;
use nastic_body::instant::Instant;
use nastic_body::state::SolveReport;
use nastic_linear::solver::{Accuracy, Border, BorderedSolution, Inertia};
use nastic_linear::{LinearError, Space, SparseMatrix};
use nastic_numeric::vector::axpy;
use std::collections::BTreeSet;
use std::sync::Arc;

/// The second derivatives `[K B; B^T 0]` of a potential under constraints: K by the displacement, `B = -dg/du`.
#[derive(Debug, Clone)]
pub struct BorderedTangent {
    pub matrix: SparseMatrix,
    /// Columns of B.
    pub columns: Vec<Vec<f64>>,
    /// Constraints that are eliminated where they are.
    local: Vec<LocalConstraints>,
    space: Arc<Space>,
}

impl BorderedTangent {
    pub fn zero(model: &Model) -> Self {
        let dofs = model.unknowns().nodal();
        let columns = vec![vec![0.0; dofs]; model.unknowns().multipliers()];
        BorderedTangent {
            matrix: model.tangents().matrix(),
            columns,
            local: Vec::new(),
            space: model.unknowns().clone(),
        }
    }

    /// Makes it zero.
    pub fn clear(&mut self) {
        self.matrix.clear();
        self.columns.iter_mut().for_each(|column| column.fill(0.0));
        self.local.clear();
    }

    /// Adds that of a contribution.
    pub fn add(
        &mut self,
        contribution: &dyn Contribution,
        point: &dyn ContributionPoint,
        at: &Instant,
    ) -> Result<(), Inadmissible> {
        point.add_tangent(at, &mut self.matrix)?;
        let Some(constraints) = contribution.constrains() else { return Ok(()) };
        let dofs = self.columns.first().map_or(0, Vec::len);
        let first = at.place(0).saturating_sub(dofs);
        let count = constraints.count();
        let fits = |(nodes, free): &(Vec<u32>, DMatrix<f64>)| {
            let unknowns = self.matrix.pattern().dim() * nodes.len();
            free.nrows() == unknowns && free.ncols() + count == unknowns
        };
        let alone = !constraints.are_inequalities() && contribution.slots().is_empty();
        if let Some((nodes, free)) = constraints.local(at).filter(|local| alone && fits(local)) {
            self.local.push(LocalConstraints { first, count, nodes, free });
        }
        let own = first..first + count;
        point.add_border(at, self.columns.get_mut(own).unwrap_or_default())
    }

    /// Its product with a vector of all unknowns.
    pub fn multiply(&self, v: &[f64], parallel: bool) -> Vec<f64> {
        self.product(v, false, parallel)
    }

    /// The product of its transpose.
    pub fn multiply_transposed(&self, v: &[f64], parallel: bool) -> Vec<f64> {
        self.product(v, true, parallel)
    }

    fn product(&self, v: &[f64], transposed: bool, parallel: bool) -> Vec<f64> {
        let dofs = v.len() - self.columns.len();
        let (nodal, multipliers) = v.split_at(dofs);
        let mut out = vec![0.0; dofs];
        match transposed {
            true => self.matrix.multiply_transposed(nodal, &mut out, parallel),
            false => self.matrix.multiply_on(nodal, &mut out, parallel),
        }
        for (column, p) in self.columns.iter().zip(multipliers) {
            out.iter_mut().zip(column).for_each(|(out, b)| *out += p * b);
        }
        out.extend(self.columns.iter().map(|column| self.space.dot(column, nodal)));
        out
    }
}

/// The system `[K B; B^T 0] [x; p] = [f; g]` with the supports and [local](LocalConstraints) constraints eliminated, ready for block elimination; a constraint that does not act
/// has no part in it, its multiplier is 0.
///
/// K is singular where the multiplier has an extremum along a path of equilibria (the pressure of a balloon), though the
/// whole is regular. So for every constraint a spring holds the component j that its column has most of: with `k = K_jj > 0` and
/// `q = x_j` the same system is
///
/// ```text
/// (K + k e_j e_j^T) x + B p - k e_j q = f,    B^T x = g,    -k x_j + k q = 0
/// ```
///
/// whose first block is regular there, whichever of them act. The spring adds one positive eigenvalue to the inertia. Of a system that is not symmetric (with friction)
/// K is solved by iteration, and what is stiff beside the rest of a soft body would cost most of its digits: there the springs come where it does not go without. Columns are scaled to
/// the size of those of K, so that constraints count like forces in the residual of the whole.
#[derive(Debug, Clone)]
pub(crate) struct SaddlePoint {
    space: Arc<Space>,
    supports: Arc<Supports>,
    /// K, with mixed unknowns where constraints are eliminated.
    pub(super) matrix: SparseMatrix,
    local: Vec<Elimination>,
    /// Columns of B, scaled.
    columns: Vec<Vec<f64>>,
    /// The same by the mixed unknowns.
    mixed: Vec<Vec<f64>>,
    /// By unknown, whether the potential has a maximum by it: no spring and no shift there.
    maxima: Vec<bool>,
    /// Of every spring the component j and the stiffness k.
    springs: Vec<(usize, f64)>,
    /// Whether they are there.
    held: bool,
    /// Factor of every column.
    scales: Vec<f64>,
    acting: Vec<bool>,
    /// Whether constraints yield a little, `B^T x - c p = g`.
    softened: bool,
    /// Whether the systems are those of the transposed matrix.
    transposed: bool,
}

/// One unknown t and one equation beside the others: `K x + B p + c_u t = f`, `B^T x + c_p t = g`, `row . x + corner t = h`.
#[derive(Debug)]
pub(crate) struct Extension {
    /// `(c_u, c_p)`, zero on supports.
    pub column: Vec<f64>,
    /// By the displacement.
    pub row: Vec<f64>,
    pub corner: f64,
}

/// The compliance c of constraints that yield, of scaled columns over the mean diagonal of K.
const COMPLIANCE: f64 = 1e-6;

/// A right-hand side where local constraints are eliminated.
struct Reduced {
    /// By the mixed unknowns, less what is known of the solution, and as it was given.
    f: Vec<f64>,
    given: Vec<f64>,
    /// Of the constraints of the border.
    g: Vec<f64>,
    known: Known,
}

/// Eliminates local constraints from a matrix whose supports are eliminated.
fn eliminate_locally(given: &[LocalConstraints], columns: &[Vec<f64>], matrix: &mut SparseMatrix) -> Vec<Elimination> {
    let mut all: Vec<Elimination> = given.iter().map(|own| Elimination::mixing(own, matrix, columns)).collect();
    all.iter_mut().zip(given).for_each(|(own, given)| own.keep_rows(&given.nodes, matrix));
    if all.is_empty() {
        return all;
    }
    let diagonal = matrix.diagonal();
    let mut known = vec![false; diagonal.len()];
    all.iter().flat_map(Elimination::known).for_each(|&dof| known[dof] = true);
    matrix.eliminate(&known, diagonal.iter().fold(0.0, |most: f64, d| most.max(d.abs())));
    all
}

impl SaddlePoint {
    /// With all constraints.
    pub fn new(model: &Model, tangent: BorderedTangent) -> Self {
        let BorderedTangent { mut matrix, mut columns, local: given, space } = tangent;
        columns.iter_mut().for_each(|column| model.supports.restrict(column));
        eliminate(model, &mut matrix);
        let local = eliminate_locally(&given, &columns, &mut matrix);
        let diagonal = matrix.diagonal();
        let size = diagonal.iter().map(|d| d.abs()).sum::<f64>() / diagonal.len().max(1) as f64;
        let is_local = |k: usize| local.iter().any(|own| own.has(k));
        let scale = |(k, column): (usize, &Vec<f64>)| {
            let scale = if is_local(k) { 1.0 } else { size / space.norm(column) };
            if scale.is_finite() { scale } else { 1.0 }
        };
        let scales: Vec<f64> = columns.iter().enumerate().map(scale).collect();
        for (column, scale) in columns.iter_mut().zip(&scales) {
            column.iter_mut().for_each(|b| *b *= scale);
        }
        let mut mixed = columns.clone();
        mixed.iter_mut().for_each(|column| local.iter().for_each(|own| own.mix(column)));
        let known: BTreeSet<usize> = local.iter().flat_map(Elimination::known).copied().collect();
        let (mut springs, maxima) = (Vec::new(), model.maxima());
        let is_maximum = |j: usize| maxima.get(j).is_some_and(|is| *is);
        for column in (0..columns.len()).filter(|&k| !is_local(k)).map(|k| &mixed[k]) {
            let free = (0..column.len()).filter(|&j| !known.contains(&j) && !is_maximum(j));
            let larger = |at: usize, j: usize| if column[j].abs() > column[at].abs() { j } else { at };
            let at = free.reduce(larger).unwrap_or(0);
            springs.push((at, diagonal[at].abs()));
        }
        let acting = vec![true; scales.len()];
        let supports = model.supports.clone();
        let general = !matrix.is_symmetric();
        let mut system = SaddlePoint {
            space,
            supports,
            matrix,
            local,
            columns,
            mixed,
            maxima,
            springs,
            held: false,
            scales,
            acting,
            softened: false,
            transposed: false,
        };
        if !general {
            system.hold();
        }
        system
    }

    /// Puts the springs there.
    fn hold(&mut self) {
        if self.held {
            return;
        }
        let mut added = vec![0.0; self.supports.fixed().len()];
        self.springs.iter().for_each(|(at, stiffness)| added[*at] += stiffness);
        self.matrix.add_diagonal(&added);
        self.held = true;
    }

    /// The springs that are there.
    fn springs(&self) -> &[(usize, f64)] {
        if self.held { &self.springs } else { &[] }
    }

    /// Sets which constraints act, by constraint, and whether they yield a little: then those that depend on each other have multipliers,
    /// too.
    pub fn set_acting(&mut self, acting: &[bool], softened: bool) {
        self.acting.copy_from_slice(acting);
        self.softened = softened;
    }

    /// From here on systems are those of `[K^T B; B^T 0]`.
    pub fn transpose(&mut self) {
        self.transposed = true;
    }

    /// `B_k . v` of a constraint.
    pub fn slope(&self, constraint: usize, v: &[f64]) -> f64 {
        self.space.dot(&self.columns[constraint], v) / self.scales[constraint]
    }

    /// Adds a multiple of a column `B_k`.
    pub fn add_column(&self, constraint: usize, factor: f64, out: &mut [f64]) {
        axpy(factor / self.scales[constraint], &self.columns[constraint], out);
    }

    /// Indices of the constraints that act and are not local.
    fn members(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.acting.len()).filter(|&k| self.acting[k] && !self.local.iter().any(|own| own.has(k)))
    }

    /// A vector by the mixed unknowns, without those that are known.
    fn unknown(&self, mut mixed: Vec<f64>) -> Vec<f64> {
        self.local.iter().flat_map(Elimination::known).for_each(|&dof| mixed[dof] = 0.0);
        mixed
    }

    fn border(&self) -> Border {
        let mut columns: Vec<Vec<f64>> = self.members().map(|k| self.unknown(self.mixed[k].clone())).collect();
        let (acting, unknowns) = (columns.len(), self.matrix.diagonal().len());
        let scalars = acting + self.springs().len();
        let mut corner = DMatrix::zeros(scalars, scalars);
        if self.softened {
            // a column is as long as the mean diagonal of K is large
            columns.iter().enumerate().for_each(|(k, column)| corner[(k, k)] = -COMPLIANCE * self.space.norm(column));
        }
        for (k, &(at, stiffness)) in self.springs().iter().enumerate() {
            let mut row = vec![0.0; unknowns];
            row[at] = -stiffness;
            columns.push(row);
            corner[(acting + k, acting + k)] = stiffness;
        }
        Border { rows: columns.clone(), columns, corner }
    }

    /// Adds `shift` times the mean diagonal of K to its diagonal, of what local constraints determine not.
    pub fn shift(&mut self, shift: f64) {
        let diagonal = self.matrix.diagonal();
        let mean = diagonal.iter().map(|d| d.abs()).sum::<f64>() / diagonal.len().max(1) as f64;
        let of = |dof: usize| if self.maxima.get(dof).is_some_and(|is| *is) { 0.0 } else { shift * mean };
        self.matrix.add_diagonal(&(0..diagonal.len()).map(of).collect::<Vec<f64>>());
    }

    /// Factorises K for solutions with several sets of acting constraints.
    pub fn prepare(
        &self,
        systems: &mut TangentSystems,
        u: &[f64],
        report: &mut SolveReport,
    ) -> Result<(), LinearError> {
        systems.prepare(&self.matrix, u, report)
    }

    /// The solutions for right-hand sides over all unknowns, zero on supports and for multipliers of constraints that do not act, once it is
    /// [prepared](Self::prepare), and the number of negative eigenvalues beyond one for each constraint that acts, according to the factor at hand
    /// it: 0 where K is positive definite on the null space of `B^T`.
    pub fn solve(
        &self,
        systems: &mut TangentSystems,
        u: &[f64],
        rhs: &[&[f64]],
        accuracy: Accuracy,
        report: &mut SolveReport,
    ) -> Result<Counted<Vec<f64>>, LinearError> {
        match self.solve_as_it_is(systems, u, rhs, accuracy, report) {
            Err(error) if !self.held && !self.springs.is_empty() && !error.is_lack_of_memory() => {
                let mut held = self.clone();
                held.hold();
                held.prepare(systems, u, report)?;
                held.solve_as_it_is(systems, u, rhs, accuracy, report)
            }
            solved => solved,
        }
    }

    /// A solution where all constraints are local, by what solves for the unknowns that these leave free.
    pub(super) fn without_border(
        &self,
        rhs: &[f64],
        solve: impl FnOnce(&[f64]) -> Result<Vec<f64>, LinearError>,
    ) -> Result<Vec<f64>, LinearError> {
        if self.members().next().is_some() {
            return Err(LinearError::Border { scalars: self.scales.len() });
        }
        let reduced = self.reduced(rhs)?;
        let x = solve(&self.unknown(reduced.f.clone()))?;
        let mut p = vec![0.0; self.scales.len()];
        let mut x = self.whole(x, &[], reduced, &mut p)?;
        x.extend(p);
        Ok(x)
    }

    fn solve_as_it_is(
        &self,
        systems: &mut TangentSystems,
        u: &[f64],
        rhs: &[&[f64]],
        accuracy: Accuracy,
        report: &mut SolveReport,
    ) -> Result<Counted<Vec<f64>>, LinearError> {
        let reduced: Vec<Reduced> = rhs.iter().map(|b| self.reduced(b)).collect::<Result<_, _>>()?;
        let springs = || vec![0.0; self.springs().len()];
        let of = |r: &Reduced| (self.unknown(r.f.clone()), r.g.iter().copied().chain(springs()).collect());
        let rhs: Vec<(Vec<f64>, Vec<f64>)> = reduced.iter().map(of).collect();
        let Counted { solved, negative } =
            systems.eliminate_border((&self.matrix, self.transposed), u, &self.border(), &rhs, accuracy, report)?;
        let whole = |(BorderedSolution { x, y, .. }, reduced): (BorderedSolution, Reduced)| {
            let mut p = vec![0.0; self.scales.len()];
            self.members().zip(&y).for_each(|(k, y)| p[k] = y * self.scales[k]);
            let mut x = self.whole(x, &y, reduced, &mut p)?;
            x.extend(p);
            Ok(x)
        };
        let beyond = |negative: usize| negative.saturating_sub(self.members().count());
        let solved = solved.into_iter().zip(reduced).map(whole).collect::<Result<_, LinearError>>()?;
        Ok(Counted { solved, negative: negative.map(beyond) })
    }

    /// A right-hand side over all unknowns by the mixed ones, and what of them is known.
    fn reduced(&self, b: &[f64]) -> Result<Reduced, LinearError> {
        let (f, g) = b.split_at(b.len() - self.scales.len());
        let dependent = || LinearError::Border { scalars: self.scales.len() };
        let known: Known = self.local.iter().map(|own| own.solve(g).ok_or_else(dependent)).collect::<Result<_, _>>()?;
        let (mut f, locals) = (f.to_vec(), || self.local.iter().zip(&known));
        self.local.iter().for_each(|own| own.mix(&mut f));
        let given = f.clone();
        locals().for_each(|(own, a)| own.move_known(a, self.transposed, &mut f));
        let left = |k: usize| {
            let along: f64 = locals().map(|(own, a)| own.along(a, &self.mixed[k])).sum();
            g[k] * self.scales[k] - along
        };
        let g = self.members().map(left).collect();
        Ok(Reduced { f, g, given, known })
    }

    /// The whole solution by the mixed unknowns and the multipliers y of the border, and the multipliers of local constraints.
    fn whole(&self, mut x: Vec<f64>, y: &[f64], of: Reduced, p: &mut [f64]) -> Result<Vec<f64>, LinearError> {
        if self.local.is_empty() {
            return Ok(x);
        }
        let mut left = of.given;
        self.members().zip(y).for_each(|(k, y)| axpy(-y, &self.mixed[k], &mut left));
        for (own, a) in self.local.iter().zip(&of.known) {
            own.known().iter().zip(a.iter()).for_each(|(&dof, a)| x[dof] = *a);
        }
        for own in &self.local {
            let found = own.multipliers(&x, self.transposed, &left);
            let found = found.ok_or(LinearError::Border { scalars: self.scales.len() })?;
            p[own.first()..][..found.len()].copy_from_slice(found.as_slice());
        }
        self.local.iter().for_each(|own| own.unmix(&mut x));
        self.supports.extend(&mut x);
        Ok(x)
    }

    /// The solution `(x, p)` and t with an [`Extension`], for f and g in one vector, multipliers, and h; those of constraints that do not act
    /// become zero.
    ///
    /// K is singular at limit points, where block elimination would lose all digits. With `k = K_jj > 0` and q = k x_j,
    /// j the component that moves most along the row, the same system is
    ///
    /// ```text
    /// (K + k e_j e_j^T) x + c t - e_j q = f,    row . x + corner t = h,    k x_j - q = 0
    /// ```
    ///
    /// whose first block, the tangent of the body held at j by a spring, is regular there, and positive definite around
    /// the first limit point.
    pub fn solve_extended(
        &mut self,
        systems: &mut TangentSystems,
        u: &[f64],
        Extension { column, row, corner }: Extension,
        (fg, multipliers, h): (&[f64], &[f64], f64),
        report: &mut SolveReport,
    ) -> Result<(Vec<f64>, f64), LinearError> {
        self.hold();
        let scalars = self.scales.len();
        let (mut fg, dofs) = (fg.to_vec(), fg.len() - scalars);
        (0..scalars).filter(|&k| !self.acting[k]).for_each(|k| self.add_column(k, multipliers[k], &mut fg[..dofs]));
        let mut reduced = self.reduced(&fg)?;
        let (mut column, mut row) = (column, row);
        self.local.iter().for_each(|own| [&mut column[..], &mut row[..]].into_iter().for_each(|v| own.mix(v)));
        let h = h - self.local.iter().zip(&reduced.known).map(|(own, a)| own.along(a, &row)).sum::<f64>();
        let row = self.unknown(row);
        let f = self.unknown(reduced.f.clone());
        let largest = |at: usize, k: usize| if row[k].abs() > row[at].abs() { k } else { at };
        let at = (0..row.len()).fold(0, largest);
        let stiffness = if row[at] == 0.0 { 0.0 } else { self.matrix.diagonal()[at].abs() };
        let mut diagonal = vec![0.0; row.len()];
        diagonal[at] = stiffness;
        self.matrix.add_diagonal(&diagonal);
        let unit = |value: f64| {
            let mut e = vec![0.0; row.len()];
            e[at] = value;
            e
        };
        let (column, of_multipliers) = column.split_at(f.len());
        let mut border = self.border();
        let own = border.corner.nrows();
        border.columns.extend([self.unknown(column.to_vec()), unit(-1.0)]);
        border.rows.extend([row.clone(), unit(stiffness)]);
        border.corner = border.corner.resize(own + 2, own + 2, 0.0);
        (border.corner[(own, own)], border.corner[(own + 1, own + 1)]) = (corner, -1.0);
        self.members().enumerate().for_each(|(i, k)| border.corner[(i, own)] = of_multipliers[k] * self.scales[k]);
        let mut rhs = reduced.g.clone();
        rhs.resize(own, 0.0);
        rhs.extend([h, 0.0]);
        let (x, y) = systems.solve_bordered(&self.matrix, u, &border, (&f, &rhs), report)?;
        let mut p: Vec<f64> = multipliers.iter().map(|p| -p).collect();
        self.members().zip(&y).for_each(|(k, y)| p[k] = y * self.scales[k]);
        axpy(-y[own], column, &mut reduced.given);
        let mut x = self.whole(x, &y, reduced, &mut p)?;
        x.extend(p);
        Ok((x, y[own]))
    }

    /// Negative eigenvalues beyond one for each constraint that acts, K counted as the solver does it: the directions within the
    /// constraints in which the potential falls.
    pub fn inertia(
        &self,
        systems: &mut TangentSystems,
        u: &[f64],
        report: &mut SolveReport,
    ) -> Result<Inertia, LinearError> {
        let Inertia { negative, by_factor } = systems.bordered_inertia(&self.matrix, u, &self.border(), report)?;
        Ok(Inertia { negative: negative.saturating_sub(self.members().count()), by_factor })
    }
}
