//! [`LocalConstraints`]: constraints on the displacement of a few nodes, eliminated there.

use nalgebra::{DMatrix, DVector};
use nastic_linear::{RowsOfNodes, SparseMatrix};

/// Constraints whose derivatives are zero but at the unknowns D of a few nodes.
#[derive(Debug, Clone)]
pub(crate) struct LocalConstraints {
    /// The number of the first one, and how many there are.
    pub first: usize,
    pub count: usize,
    pub nodes: Vec<u32>,
    /// Changes of D that keep them, to first order: a basis, by columns.
    pub free: DMatrix<f64>,
}

/// Of `[K B; B^T 0] [x; p] = [f; g]` the part of some constraints, with B = G at D and zero elsewhere.
///
/// ```text
/// [G, free] = Q R,    Q = [Y Z],    Y spans G,    x_D = Z b + Y a
/// (Y^T G)^T a = g,    K' = Q^T K Q with a known,    (Y^T G) p = Y^T (f - K x)_D
/// ```
///
/// Left are the unknowns b in the place of the first ones of D; a stands in the place of the last, whose rows and columns are those of the identity.
#[derive(Debug, Clone)]
pub(crate) struct Elimination {
    first: usize,
    count: usize,
    dofs: Vec<usize>,
    /// `[Z Y]`
    q: DMatrix<f64>,
    /// `Y^T G`
    gradients: DMatrix<f64>,
    rows: RowsOfNodes,
    dim: usize,
}

/// Known parts of a solution, by elimination.
pub(crate) type Known = Vec<DVector<f64>>;

impl Elimination {
    /// Mixes the unknowns of a matrix at D. Its [rows](Self::keep_rows) come when all are mixed.
    pub fn mixing(of: &LocalConstraints, matrix: &mut SparseMatrix, columns: &[Vec<f64>]) -> Self {
        let dim = matrix.pattern().dim();
        let dofs: Vec<usize> =
            of.nodes.iter().flat_map(|&node| (0..dim).map(move |i| dim * node as usize + i)).collect();
        let (n, count) = (dofs.len(), of.count);
        let g = DMatrix::from_fn(n, count, |i, k| columns[of.first + k][dofs[i]]);
        let mut all = DMatrix::from_fn(n, n, |i, j| if j < count { g[(i, j)] } else { of.free[(i, j - count)] });
        // the largest columns would leave their rounding in what supports hold
        all.column_iter_mut().for_each(|mut column| {
            let size = column.norm();
            column /= if size > 0.0 { size } else { 1.0 };
        });
        let basis = all.qr().q();
        let q = DMatrix::from_fn(n, n, |i, j| basis[(i, (j + count) % n)]);
        let gradients = basis.columns(0, count).transpose() * g;
        matrix.mix(&of.nodes, &q);
        let rows = RowsOfNodes { nodes: Vec::new(), rows: DMatrix::zeros(0, 0), columns: DMatrix::zeros(0, 0) };
        Elimination { first: of.first, count, dofs, q, gradients, rows, dim }
    }

    /// Keeps the rows and columns of D before those of a are eliminated.
    pub fn keep_rows(&mut self, nodes: &[u32], matrix: &SparseMatrix) {
        self.rows = matrix.rows_of(nodes);
    }

    /// Whether it is one of these constraints.
    pub fn has(&self, constraint: usize) -> bool {
        (self.first..self.first + self.count).contains(&constraint)
    }

    /// The unknowns in whose place a stands.
    pub fn known(&self) -> &[usize] {
        &self.dofs[self.dofs.len() - self.count..]
    }

    fn at_nodes(&self, v: &[f64]) -> DVector<f64> {
        DVector::from_iterator(self.dofs.len(), self.dofs.iter().map(|&dof| v[dof]))
    }

    fn put(&self, values: &DVector<f64>, v: &mut [f64]) {
        self.dofs.iter().zip(values.iter()).for_each(|(&dof, value)| v[dof] = *value);
    }

    /// `Q^T v`
    pub fn mix(&self, v: &mut [f64]) {
        self.put(&(self.q.transpose() * self.at_nodes(v)), v);
    }

    /// `Q v`
    pub fn unmix(&self, v: &mut [f64]) {
        self.put(&(&self.q * self.at_nodes(v)), v);
    }

    /// a by the right-hand side of all constraints; `None` where their derivatives depend on each other.
    pub fn solve(&self, g: &[f64]) -> Option<DVector<f64>> {
        let own = DVector::from_column_slice(&g[self.first..self.first + self.count]);
        self.gradients.transpose().lu().solve(&own).filter(|a| a.iter().all(|a| a.is_finite()))
    }

    /// Subtracts `K' a` from a right-hand side.
    pub fn move_known(&self, a: &DVector<f64>, transposed: bool, f: &mut [f64]) {
        let of = if transposed { &self.rows.rows } else { &self.rows.columns };
        let product = of.rows(self.dofs.len() - self.count, self.count).transpose() * a;
        self.each_unknown(|j, dof| f[dof] -= product[j]);
    }

    /// The part of a mixed vector at a times a.
    pub fn along(&self, a: &DVector<f64>, mixed: &[f64]) -> f64 {
        self.known().iter().zip(a.iter()).map(|(&dof, a)| mixed[dof] * a).sum()
    }

    /// The multipliers by what is left of the mixed right-hand side at a.
    pub fn multipliers(&self, x: &[f64], transposed: bool, f: &[f64]) -> Option<DVector<f64>> {
        let of = if transposed { &self.rows.columns } else { &self.rows.rows };
        let mut all = DVector::zeros(of.ncols());
        self.each_unknown(|j, dof| all[j] = x[dof]);
        let product = of.rows(self.dofs.len() - self.count, self.count) * all;
        let left =
            DVector::from_iterator(self.count, self.known().iter().enumerate().map(|(i, &dof)| f[dof] - product[i]));
        self.gradients.clone().lu().solve(&left)
    }

    /// The place of the first of its constraints.
    pub fn first(&self) -> usize {
        self.first
    }

    fn each_unknown(&self, mut call: impl FnMut(usize, usize)) {
        for (k, &node) in self.rows.nodes.iter().enumerate() {
            (0..self.dim).for_each(|c| call(self.dim * k + c, self.dim * node as usize + c));
        }
    }
}
