//! [`Multigrid`]: the levels of a matrix.

use std::sync::Mutex;

use super::aggregation::{ALONE, aggregates};
use super::block_matrix::BlockMatrix;
use super::corners::Corners;
use super::cycle::{Level, Vectors, v_cycle};
use super::smoother::Smoother;
use super::{coarsest, finest, modes, tentative};
use crate::error::{FactorError, StructureError};
use crate::factor::Factor;
use crate::iterative::Preconditioner;
use crate::locks::lock;
use crate::matrix::SparseMatrix;

/// What multigrid must know of a body besides its matrix.
#[derive(Clone, Copy, Debug)]
pub struct Geometry<'a> {
    /// Current positions of the nodes (z = 0 in two dimensions).
    pub points: &'a [[f64; 3]],
    /// By unknown: whether its row and column were eliminated.
    pub fixed: &'a [bool],
    /// The corner nodes of second-order elements.
    pub corners: Option<&'a Corners>,
}

/// A symmetric positive definite approximation of the inverse of a positive definite matrix.
///
/// Its bits depend on the matrix and the geometry alone, not on the number of threads.
#[derive(Debug)]
pub struct Multigrid {
    levels: Vec<Level>,
    coarsest: Factor,
    sizes: Vec<usize>,
    parallel: bool,
    /// Working memory of cycles that are over.
    vectors: Mutex<Vec<Vec<Vectors>>>,
}

/// Degrees of the smoothing polynomials on second-order elements and below.
const SECOND_ORDER_DEGREE: usize = 4;
const DEGREE: usize = 3;
/// `P = (I - DAMPING / bound D^-1 A) T`.
const DAMPING: f64 = 4.0 / 3.0;
/// A level is factorised when its factor has no more entries than this share of the finest matrix: a cycle then spends
/// no more on it than on smoothing.
const COARSEST_SHARE: f64 = 0.5;
/// Larger levels are not even looked at with factorising in mind: ordering them costs more than a level.
const ANALYSED: usize = 60_000;
/// A level with more than this share of the nodes of the one above does not pay.
const COARSENING: f64 = 0.7;

impl Multigrid {
    /// The levels of a matrix whose supports are eliminated, one to three unknowns per node.
    ///
    /// # Errors
    /// [`FactorError::NotPositive`] where the matrix cannot be positive definite (a diagonal block, or the last level, is
    /// not); it may still be indefinite where nothing is reported. [`FactorError::NotFinite`], [`FactorError::Structure`].
    pub fn new(matrix: &SparseMatrix, geometry: &Geometry, parallel: bool) -> Result<Self, FactorError> {
        matrix.check_finite()?;
        let (dim, nodes) = (matrix.pattern().dim(), matrix.pattern().nodes());
        check("dofs per node (one to three)", dim.clamp(1, 3), dim)?;
        check("node positions", nodes, geometry.points.len())?;
        check("marks of eliminated unknowns", dim * nodes, geometry.fixed.len())?;
        let mut building = Building {
            matrix: finest::expand(matrix),
            nodes: (0..nodes as u32).collect(),
            levels: Vec::new(),
            parallel,
        };
        let mut modes = modes::rigid_motions(geometry.points, dim, geometry.fixed);
        let entries = building.matrix.values.len() as f64;
        if let Some(corners) = geometry.corners {
            let of_corners = |values: &[bool]| {
                let of_node = |&node: &u32| values[dim * node as usize..][..dim].iter().copied();
                corners.nodes().iter().flat_map(of_node).collect::<Vec<bool>>()
            };
            let (fixed, points) = (of_corners(geometry.fixed), geometry.points);
            let points: Vec<_> = corners.nodes().iter().map(|&node| points[node as usize]).collect();
            modes = modes::rigid_motions(&points, dim, &fixed);
            let smoother = building.smoother(SECOND_ORDER_DEGREE)?;
            building.descend(smoother, corners.prolongator(dim, geometry.fixed), corners.nodes().to_vec(), &fixed);
        }
        let count = modes::count(dim);
        let symbolic = loop {
            let unknowns = building.matrix.rows() * building.matrix.shape.0;
            if !building.levels.is_empty() && unknowns <= ANALYSED {
                let symbolic = coarsest::analyse(&building.matrix)?;
                if symbolic.nonzeros() as f64 <= COARSEST_SHARE * entries {
                    break symbolic;
                }
            }
            let (of_node, number) = aggregates(&building.matrix);
            if number == 0 || number as f64 > COARSENING * building.matrix.rows() as f64 {
                break coarsest::analyse(&building.matrix)?;
            }
            let shape = (building.matrix.shape.0, count);
            let tentative = tentative::tentative(&of_node, number, &modes, shape);
            let smoother = building.smoother(DEGREE)?;
            let prolongator = building.smoothed(tentative.prolongator, &smoother);
            let nodes = building.representatives(&of_node, number);
            building.descend(smoother, prolongator, nodes, &tentative.idle);
            modes = tentative.modes;
        };
        let coarsest = coarsest::factorise(&building.matrix, &symbolic, parallel).map_err(|e| building.locate(e))?;
        let of_level = |level: &Level| level.matrix.rows() * level.matrix.shape.0;
        let mut sizes: Vec<usize> = building.levels.iter().map(of_level).collect();
        sizes.push(building.matrix.rows() * building.matrix.shape.0);
        Ok(Multigrid { levels: building.levels, coarsest, sizes, parallel, vectors: Mutex::new(Vec::new()) })
    }

    /// Unknowns on each level, from the finest to the one that is factorised.
    pub fn sizes(&self) -> &[usize] {
        &self.sizes
    }
}

impl Preconditioner for Multigrid {
    fn apply(&self, vector: &mut [f64]) {
        let kept = lock(&self.vectors).pop();
        let mut vectors = kept.unwrap_or_else(|| self.sizes.iter().map(|&n| Vectors::new(n)).collect());
        vectors[0].r.copy_from_slice(vector);
        v_cycle(&self.levels, &self.coarsest, &mut vectors, self.parallel);
        vector.copy_from_slice(&vectors[0].x);
        lock(&self.vectors).push(vectors);
    }
}

fn check(what: &'static str, expected: usize, found: usize) -> Result<(), StructureError> {
    if expected == found { Ok(()) } else { Err(StructureError::Length { what, expected, found }) }
}

/// A hierarchy on its way down.
struct Building {
    /// The matrix of the level reached.
    matrix: BlockMatrix<f64>,
    /// A mesh node for every node of it, to name in errors.
    nodes: Vec<u32>,
    levels: Vec<Level>,
    parallel: bool,
}

impl Building {
    fn smoother(&self, degree: usize) -> Result<Smoother, FactorError> {
        Smoother::new(&self.matrix, degree, self.parallel)
            .map_err(|at| FactorError::NotPositive { node: self.nodes[at.0] as usize, component: 0 })
    }

    /// `(I - omega D^-1 A) T`.
    fn smoothed(&self, tentative: BlockMatrix<f64>, smoother: &Smoother) -> BlockMatrix<f64> {
        let omega = DAMPING / smoother.bound;
        let mut product = self.matrix.times(&tentative, self.parallel);
        smoother.scale(&mut product);
        product.values.iter_mut().for_each(|value| *value *= -omega);
        let size = product.shape.0 * product.shape.1;
        for i in 0..product.rows() {
            for k in tentative.row(i) {
                let row = product.row(i);
                if let Ok(at) = product.columns[row.clone()].binary_search(&tentative.columns[k]) {
                    let target = &mut product.values[size * (row.start + at)..][..size];
                    target.iter_mut().zip(tentative.block(k)).for_each(|(value, t)| *value += t);
                }
            }
        }
        product
    }

    /// The first node of each aggregate.
    fn representatives(&self, of_node: &[u32], number: usize) -> Vec<u32> {
        let mut nodes = vec![0; number];
        for (&aggregate, &node) in of_node.iter().zip(&self.nodes).rev().filter(|(aggregate, _)| **aggregate != ALONE) {
            nodes[aggregate as usize] = node;
        }
        nodes
    }

    /// Closes this level and goes on to `P^T A P`.
    fn descend(&mut self, smoother: Smoother, prolongator: BlockMatrix<f64>, nodes: Vec<u32>, idle: &[bool]) {
        let restrictor = prolongator.transposed();
        let moved = self.matrix.times(&prolongator, self.parallel);
        let mut coarse = restrictor.times(&moved, self.parallel);
        drop(moved);
        coarse.symmetrise(idle, mean_diagonal(&self.matrix));
        let matrix = std::mem::replace(&mut self.matrix, coarse).rounded();
        let (prolongator, restrictor) = (prolongator.rounded(), restrictor.rounded());
        self.levels.push(Level { matrix, smoother, prolongator, restrictor });
        self.nodes = nodes;
    }

    fn locate(&self, error: FactorError) -> FactorError {
        match error {
            FactorError::NotPositive { node, .. } => {
                FactorError::NotPositive { node: self.nodes[node] as usize, component: 0 }
            }
            other => other,
        }
    }
}

fn mean_diagonal(matrix: &BlockMatrix<f64>) -> f64 {
    let n = matrix.shape.0;
    let of_block = |block: &[f64]| (0..n).map(|r| block[(n + 1) * r].abs()).sum::<f64>();
    let sum: f64 = (0..matrix.rows()).filter_map(|i| matrix.diagonal_block(i)).map(of_block).sum();
    if sum > 0.0 { sum / (n * matrix.rows()) as f64 } else { 1.0 }
}
