//! A vector problem on a grid of hexahedra, with what solvers take.

use super::{Grid, Random};
use nalgebra::{DMatrix, DVector};
use nastic_linear::solver::{Accuracy, Configuration, System};
use nastic_linear::{Corners, Pattern, Rotations, SparseMatrix, Structure, Symbolic, Symmetry};
use nastic_tensor::Mat3;
use std::sync::Arc;

/// Nearly to rounding.
pub const STRICT: Accuracy = Accuracy { error: 1e-12, residual: 1e-11 };

/// A body at rest.
pub struct AtRest {
    pub points: Vec<[f64; 3]>,
    pub rotations: Arc<Rotations>,
}

impl Configuration for AtRest {
    fn positions(&self) -> &[[f64; 3]] {
        &self.points
    }

    fn rotations(&self) -> &Arc<Rotations> {
        &self.rotations
    }

    fn corners(&self) -> Option<&Corners> {
        None
    }
}

/// A grid with what solvers take.
pub struct Case {
    pub grid: Grid,
    pub pattern: Arc<Pattern>,
    pub symbolic: Arc<Symbolic>,
    pub structure: Arc<Structure>,
    pub fixed: Vec<bool>,
    pub at: AtRest,
}

impl Case {
    pub fn new(cells: [usize; 3]) -> Self {
        let grid = Grid::hexahedra(cells, 1);
        let pattern = grid.pattern(3);
        let structure = Structure::new(pattern.clone());
        let symbolic = structure.symbolic().clone();
        let fixed = vec![false; pattern.dofs()];
        let rotations = Arc::new(Rotations(vec![Mat3::identity(); grid.points.len()]));
        let at = AtRest { points: grid.points.clone(), rotations };
        Case { grid, pattern, symbolic, structure, fixed, at }
    }

    pub fn system<'a>(&'a self, matrix: &'a SparseMatrix) -> System<'a> {
        System {
            matrix,
            products: None,
            fixed: &self.fixed,
            configuration: &self.at,
            transposed: false,
            parallel: false,
        }
    }

    /// A Laplacian with a skew part of a relative size, and its dense twin.
    pub fn general(&self, skew: f64) -> (SparseMatrix, DMatrix<f64>) {
        let mut matrix = SparseMatrix::with_symmetry(self.pattern.clone(), Symmetry::General);
        let n = self.pattern.dofs();
        let mut dense = DMatrix::zeros(n, n);
        let mut random = Random::new(3);
        for nodes in self.grid.cliques() {
            let m = 3 * nodes.len();
            let node = |a: usize, b: usize| if a == b { nodes.len() as f64 - 1.0 } else { -1.0 };
            let entry = |i: usize, j: usize| {
                let own = if i % 3 == j % 3 { node(i / 3, j / 3) } else { 0.0 };
                own + if i == j { 0.3 } else { 0.0 }
            };
            let noise = DMatrix::from_fn(m, m, |_, _| random.next());
            let element = DMatrix::from_fn(m, m, entry) + skew * (&noise - noise.transpose());
            let by_row: Vec<f64> = element.transpose().as_slice().to_vec();
            matrix.add_element(&self.pattern.scatter_map(nodes).unwrap(), &by_row);
            let dof = |i: usize| 3 * nodes[i / 3] as usize + i % 3;
            for (i, j) in (0..m).flat_map(|i| (0..m).map(move |j| (i, j))) {
                dense[(dof(i), dof(j))] += element[(i, j)];
            }
        }
        (matrix, dense)
    }
}

/// By a dense factor.
pub fn solution(dense: &DMatrix<f64>, b: &[f64]) -> Vec<f64> {
    dense.clone().lu().solve(&DVector::from_column_slice(b)).unwrap().as_slice().to_vec()
}
