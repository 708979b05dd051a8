//! Grids, random matrices and their dense twins.

#![allow(clippy::unwrap_used)] // helpers of tests
#![allow(dead_code)]

pub mod case;

use std::sync::Arc;

use nalgebra::{DMatrix, DVector, SymmetricEigen};
use nastic_linear::{Graph, Ordering, Pattern, SparseMatrix};

/// Nodes and elements of a mesh.
pub struct Grid {
    pub points: Vec<[f64; 3]>,
    pub elements: Vec<Vec<u32>>,
}

impl Grid {
    /// `cells` hexahedra of the given order (8 or 27 nodes for 1 or 2) on a regular grid.
    pub fn hexahedra(cells: [usize; 3], order: usize) -> Self {
        let nodes = cells.map(|n| n * order + 1);
        let id = |at: [usize; 3]| (at[0] + nodes[0] * (at[1] + nodes[1] * at[2])) as u32;
        let points = boxed(nodes).map(|at| at.map(|x| x as f64)).collect();
        let corner = |cell: [usize; 3], local: [usize; 3]| [0, 1, 2].map(|k| order * cell[k] + local[k]);
        let nodes_of = |cell| boxed([order + 1; 3]).map(|local| id(corner(cell, local))).collect();
        Self { points, elements: boxed(cells).map(nodes_of).collect() }
    }

    /// The same nodes as second-order hexahedra, every hexahedron cut into six tetrahedra of ten nodes, nodes jittered.
    pub fn tetrahedra(cells: [usize; 3]) -> Self {
        let hexahedra = Self::hexahedra(cells, 2);
        let mut random = Random::new(7);
        let jitter = |p: [f64; 3]| p.map(|x| x + 0.2 * random.next());
        let mut elements = Vec::new();
        for hexahedron in &hexahedra.elements {
            for path in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
                let mut corners = vec![0usize];
                path.iter().for_each(|&axis| corners.push(corners[corners.len() - 1] + [2, 6, 18][axis]));
                let edges = (0..4).flat_map(|i| (0..=i).map(move |j| (i, j)));
                elements.push(edges.map(|(i, j)| hexahedron[(corners[i] + corners[j]) / 2]).collect());
            }
        }
        Self { points: hexahedra.points.into_iter().map(jitter).collect(), elements }
    }

    pub fn graph(&self) -> Graph {
        Graph::from_cliques(self.points.len(), self.cliques()).unwrap()
    }

    pub fn cliques(&self) -> impl Iterator<Item = &[u32]> {
        self.elements.iter().map(Vec::as_slice)
    }

    pub fn pattern(&self, dim: usize) -> Arc<Pattern> {
        Arc::new(Pattern::of_elements(&self.points, dim, self.cliques()).unwrap())
    }

    /// All the orderings there are, and a poor one.
    pub fn orderings(&self) -> Vec<Ordering> {
        let graph = self.graph();
        let natural: Vec<u32> = (0..self.points.len() as u32).collect();
        vec![
            Ordering::geometric(&graph, &self.points).unwrap(),
            Ordering::multilevel(&graph),
            Ordering::given(&graph, &natural).unwrap(),
        ]
    }

    /// Sum of random element matrices `B B^T - shift I`, and its dense twin.
    pub fn random_matrix(
        &self,
        pattern: &Arc<Pattern>,
        shift: f64,
        random: &mut Random,
    ) -> (SparseMatrix, DMatrix<f64>) {
        let dim = pattern.dim();
        let mut matrix = SparseMatrix::zeros(pattern.clone());
        let mut dense = DMatrix::zeros(pattern.dofs(), pattern.dofs());
        for nodes in &self.elements {
            let n = dim * nodes.len();
            let b = DMatrix::from_fn(n, n, |_, _| random.next());
            let element = &b * b.transpose() - DMatrix::identity(n, n) * shift;
            pattern.scatter(&pattern.scatter_map(nodes).unwrap(), element.as_slice(), &mut matrix.values);
            let dof = |i: usize| dim * nodes[i / dim] as usize + i % dim;
            for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
                dense[(dof(i), dof(j))] += element[(i, j)];
            }
        }
        (matrix, dense)
    }

    /// A vector Laplacian with some coupling of the components, elastic in structure: positive semi-definite with the
    /// constant vectors as its kernel, plus `shift` times the identity.
    pub fn laplacian(&self, pattern: &Arc<Pattern>, shift: f64) -> SparseMatrix {
        let mut matrix = SparseMatrix::zeros(pattern.clone());
        let dim = pattern.dim();
        for nodes in &self.elements {
            let n = nodes.len();
            let component = |r: usize, c: usize| if r == c { 1.0 } else { 0.3 };
            let node = |a: usize, b: usize| if a == b { n as f64 - 1.0 } else { -1.0 };
            let entry = |i: usize, j: usize| node(i / dim, j / dim) * component(i % dim, j % dim);
            let element = DMatrix::from_fn(dim * n, dim * n, entry);
            pattern.scatter(&pattern.scatter_map(nodes).unwrap(), element.as_slice(), &mut matrix.values);
        }
        matrix.add_to_diagonal(shift);
        matrix
    }
}

fn boxed(n: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
    (0..n[2]).flat_map(move |k| (0..n[1]).flat_map(move |j| (0..n[0]).map(move |i| [i, j, k])))
}

/// Number of negative eigenvalues, dense.
pub fn negative_eigenvalues(dense: &DMatrix<f64>) -> usize {
    SymmetricEigen::new(dense.clone()).eigenvalues.iter().filter(|&&value| value < 0.0).count()
}

pub fn relative_difference(a: &[f64], b: &[f64]) -> f64 {
    let (a, b) = (DVector::from_column_slice(a), DVector::from_column_slice(b));
    (a - &b).norm() / b.norm()
}

/// xorshift64: numbers in [-1, 1).
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(0x9E37_79B9_7F4A_7C15 ^ seed)
    }

    pub fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    pub fn vector(&mut self, n: usize) -> Vec<f64> {
        (0..n).map(|_| self.next()).collect()
    }
}
