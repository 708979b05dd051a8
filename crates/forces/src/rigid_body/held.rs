//! [`Held`]: what supports hold of a rigid body.

use super::Rigid;
use nalgebra::{DMatrix, DVector};
use nastic_body::discretization::supports::Supports;
use nastic_body::error::FemError;
use nastic_tensor::{Mat3, Vec3};

/// Share of a gradient that is orthogonal to the others, below which it depends on them.
const DEPENDENCE_TOLERANCE: f64 = 1e-8;
/// Rotation, rad, after which a motion that the supports admit at rest must still be rigid.
const TEST_ANGLE: f64 = 0.1;
/// Components of F^T F - 1 that count as zero there.
const STRAIN_TOLERANCE: f64 = 1e-9;
/// Sweeps in which singular values are found.
const MAX_SWEEPS: usize = 1000;
/// Iterations of the projection onto the constraints.
const MAX_ITERATIONS: usize = 50;

/// Which unknowns of the corners of the simplex supports hold, corner by corner.
#[derive(Debug, Clone)]
pub(super) struct Held(Vec<bool>);

impl Held {
    /// What supports hold of the corners, and what follows: where they hold component c at corners from which e_c is a combination of ways, `F e_c` has
    /// the component 1 along e_c, of a rotation all, and all corners keep theirs.
    pub fn of(masters: &[u32], corners: &[Vec3], dim: usize, supports: &Supports) -> (Self, Vec<(u32, usize)>) {
        let mut held: Vec<bool> =
            masters.iter().flat_map(|&node| (0..dim).map(move |c| supports.holds(node, c))).collect();
        let mut implied = Vec::new();
        for c in 0..dim {
            let own: Vec<Vec3> = (0..masters.len()).filter(|m| held[dim * m + c]).map(|m| corners[m]).collect();
            let ways = own.iter().skip(1).map(|x| x - own[0]);
            if !spans(ways, Vec3::ith(c, 1.0)) {
                continue;
            }
            for (m, &node) in masters.iter().enumerate().filter(|(m, _)| !held[dim * m + c]).collect::<Vec<_>>() {
                held[dim * m + c] = true;
                implied.push((node, c));
            }
        }
        (Held(held), implied)
    }

    pub fn is_empty(&self) -> bool {
        !self.0.contains(&true)
    }

    /// Of motions, by columns, those that move nothing that is held, behind the unknowns that are held themselves: a basis of the changes that keep the
    /// constraints where rows and columns of what is held are those of the identity.
    pub fn let_go(&self, motions: &DMatrix<f64>) -> DMatrix<f64> {
        if self.is_empty() {
            return motions.clone();
        }
        let free = self.free_motions(motions);
        let held: Vec<usize> = (0..self.0.len()).filter(|&dof| self.0[dof]).collect();
        let entry = |i: usize, j: usize| match j.checked_sub(held.len()) {
            None => f64::from(u8::from(held[j] == i)),
            Some(motion) => free[(i, motion)],
        };
        DMatrix::from_fn(motions.nrows(), held.len() + free.ncols(), entry)
    }

    fn free_motions(&self, motions: &DMatrix<f64>) -> DMatrix<f64> {
        let of_held = |i: usize, j: usize| if self.0[i] { motions[(i, j)] } else { 0.0 };
        let moved = DMatrix::from_fn(motions.nrows(), motions.ncols(), of_held);
        // singular values: eigenvalues of the squares know them to the root of rounding alone
        let found = moved.try_svd(false, true, 5.0 * f64::EPSILON, MAX_SWEEPS);
        let Some((values, ways)) = found.and_then(|svd| Some((svd.singular_values, svd.v_t?))) else {
            return DMatrix::zeros(motions.nrows(), 0);
        };
        let most = values.max();
        let kept: Vec<usize> = (0..motions.ncols()).filter(|&k| values[k] <= DEPENDENCE_TOLERANCE * most).collect();
        let mut free = motions * DMatrix::from_fn(motions.ncols(), kept.len(), |i, j| ways[(kept[j], i)]);
        // rounding moves nothing that is held
        for (dof, _) in self.0.iter().enumerate().filter(|(_, held)| **held) {
            free.row_mut(dof).fill(0.0);
        }
        free
    }
}

/// Whether a unit vector is a combination of others.
fn spans(ways: impl Iterator<Item = Vec3>, unit: Vec3) -> bool {
    let mut basis: Vec<Vec3> = Vec::new();
    for way in ways {
        let rest = basis.iter().fold(way, |rest, b| rest - b * b.dot(&rest));
        if rest.norm() > DEPENDENCE_TOLERANCE * way.norm() {
            basis.push(rest.normalize());
        }
    }
    basis.iter().fold(unit, |rest, b| rest - b * b.dot(&rest)).norm() < DEPENDENCE_TOLERANCE
}

impl Rigid {
    /// Without the constraints that supports fulfil: those whose gradients by what is free depend on the others'.
    pub(super) fn without_fulfilled(mut self) -> Result<Self, FemError> {
        if self.held.is_empty() {
            return Ok(self);
        }
        let (all, free) = (self.components.clone(), self.free_gradients(&Mat3::identity()));
        let mut basis: Vec<DVector<f64>> = Vec::new();
        self.components.clear();
        for (component, gradient) in all.iter().zip(free.column_iter()) {
            let rest = basis.iter().fold(gradient.into_owned(), |rest, b| &rest - b * b.dot(&rest));
            if rest.norm() > DEPENDENCE_TOLERANCE * self.volume * self.steepest() {
                basis.push(rest.normalize());
                self.components.push(*component);
            }
        }
        let left_out = all.len() - self.components.len();
        if left_out > 0 && !self.stays_rigid(&all) {
            let what = format!(
                "the supports of the rigid body \"{}\" hold it against turns that they let begin: two points of a line held along it, or alike; hold fewer of its nodes or \
                 components, or all of them",
                self.name
            );
            return Err(FemError::Meaningless { what });
        }
        Ok(self)
    }

    /// F by the unknowns of the corners.
    fn f_of(&self, q: &DVector<f64>) -> Mat3 {
        let of_corner = |m: usize| Vec3::from_fn(|i, _| if i < self.dim { q[self.dim * m + i] } else { 0.0 });
        self.gradients.iter().enumerate().fold(Mat3::identity(), |f, (m, g)| f + of_corner(m) * g.transpose())
    }

    fn steepest(&self) -> f64 {
        self.gradients.iter().map(|g| g.norm()).fold(0.0, f64::max)
    }

    /// Whether motions that supports let begin go on with all constraints, also those that are left out.
    fn stays_rigid(&self, all: &[(usize, usize)]) -> bool {
        let rest = DVector::zeros(self.dim * self.masters.len());
        let motions = self.held.free_motions(&self.motions(|_| Vec3::zeros()));
        let size = self.gradients.iter().map(|g| 1.0 / g.norm()).fold(0.0, f64::max);
        let together = motions.column_sum();
        let directions = motions.column_iter().map(|column| column.into_owned()).chain([together]);
        directions.filter(|direction| direction.norm() > 0.0).all(|direction| {
            let begun = &rest + direction.normalize() * (TEST_ANGLE * size);
            let Some(moved) = self.onto_constraints(begun) else { return false };
            let f = self.f_of(&moved);
            let strain = f.transpose() * f - Mat3::identity();
            all.iter().all(|at| strain[*at].abs() < STRAIN_TOLERANCE)
        })
    }

    /// The nearest affine motion that keeps the constraints and what is held, by Gauss-Newton steps of least length; unknowns of the corners.
    fn onto_constraints(&self, mut q: DVector<f64>) -> Option<DVector<f64>> {
        for _ in 0..MAX_ITERATIONS {
            let f = self.f_of(&q);
            let rest = Mat3::identity();
            let off = self.pairs(&f, &f).into_iter().zip(self.pairs(&rest, &rest)).map(|(now, rest)| now - rest);
            let off = DVector::from_iterator(self.components.len(), off);
            if off.amax() <= 4.0 * f64::EPSILON * self.volume {
                return Some(q);
            }
            let gradients = self.free_gradients(&f);
            let size = (gradients.transpose() * &gradients).cholesky()?;
            let step = &gradients * size.solve(&off);
            if step.norm() <= f64::EPSILON * q.norm() {
                return Some(q);
            }
            q -= step;
        }
        None
    }

    /// [`restored`](nastic_body::contribution::constrains::Constrains::restored) where supports hold something.
    pub(super) fn restored_beside_supports(&self, u: &[f64]) -> Option<Vec<(usize, f64)>> {
        let now = (0..self.masters.len()).flat_map(|m| (0..self.dim).map(move |i| (m, i)));
        let q = DVector::from_iterator(self.held.0.len(), now.clone().map(|(m, i)| self.of_node(u, m)[i]));
        let onto = self.onto_constraints(q)?;
        Some(now.zip(onto.iter()).map(|((m, i), to)| (self.dim * self.masters[m] as usize + i, *to)).collect())
    }

    /// Gradients of the constraints by what is free of the corners, by columns.
    fn free_gradients(&self, f: &Mat3) -> DMatrix<f64> {
        let mut all = DMatrix::zeros(self.held.0.len(), self.components.len());
        for k in 0..self.components.len() {
            let unit = self.symmetric(|other| f64::from(u8::from(other == k)));
            for (m, gradient) in self.gradients.iter().enumerate() {
                let force = f * (unit * gradient);
                for i in (0..self.dim).filter(|i| !self.held.0[self.dim * m + i]) {
                    all[(self.dim * m + i, k)] = force[i];
                }
            }
        }
        all
    }
}
