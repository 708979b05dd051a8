//! [`Multigrid`]: the levels of a matrix.

use std::sync::{Arc, Mutex};

use super::block_matrix::BlockMatrix;
use super::cell_products::CellProducts;
use super::corners::Corners;
use super::couplings::{Couplings, Symmetric};
use super::cycle::{Vectors, v_cycle};
use super::level::{Inherited, Level};
use super::{chunks, coarsest, modes};
use crate::error::{FactorError, StructureError};
use crate::factor::Factor;
use crate::iterative::Preconditioner;
use crate::locks::lock;
use crate::matrix::SparseMatrix;
use crate::pattern::Pattern;
use crate::symbolic::Symbolic;

/// What multigrid must know of a body besides its matrix.
#[derive(Clone, Copy, Debug)]
pub struct Geometry<'a> {
    /// Current positions of the nodes (z = 0 in two dimensions).
    pub points: &'a [[f64; 3]],
    /// By unknown: whether its row and column were eliminated.
    pub fixed: &'a [bool],
    /// The corner nodes of second-order elements.
    pub corners: Option<&'a Corners>,
    /// The matrix by the products of its cells: what is smoothed with on second-order elements, in the place of its entries.
    pub products: Option<&'a Arc<dyn CellProducts>>,
}

impl Geometry<'_> {
    /// Whether products of cells serve on the finest level: with so many unknowns per node.
    fn has_products(&self, unknowns: usize) -> bool {
        unknowns == 3 && self.corners.is_some()
    }
}

/// A symmetric positive definite approximation of the inverse of a positive definite matrix.
///
/// Its bits depend on the matrices and geometries it was made of alone, not on the number of threads.
#[derive(Debug)]
pub struct Multigrid {
    /// What the levels were laid out for.
    pattern: Arc<Pattern>,
    fixed: Vec<bool>,
    finest: Arc<Couplings>,
    levels: Vec<Level>,
    coarsest: Option<Coarsest>,
    layouts: usize,
    parallel: bool,
    /// Working memory of cycles that are over.
    vectors: Mutex<Vec<Vec<Vectors>>>,
}

/// The last level.
#[derive(Debug)]
struct Coarsest {
    symbolic: Arc<Symbolic>,
    factor: Option<Factor>,
}

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
        let mut levels = Self::empty(matrix.pattern());
        levels.renew(matrix, geometry, parallel)?;
        Ok(levels)
    }

    /// No levels yet, for matrices of a pattern.
    pub(crate) fn empty(pattern: &Arc<Pattern>) -> Self {
        let none = Couplings { size: 0, rows: Default::default(), codes: Vec::new(), stored: Vec::new() };
        Multigrid {
            pattern: pattern.clone(),
            fixed: Vec::new(),
            finest: Arc::new(none),
            levels: Vec::new(),
            coarsest: None,
            layouts: 0,
            parallel: false,
            vectors: Mutex::default(),
        }
    }

    /// Becomes the levels of another matrix. Couplings and aggregates are kept where pattern and supports are the same, and
    /// the strong couplings of a level are so but for a twentieth; values are computed in place.
    ///
    /// # Errors
    /// As [`new`](Self::new); of no use as a preconditioner then, until it is renewed.
    pub fn renew(&mut self, matrix: &SparseMatrix, geometry: &Geometry, parallel: bool) -> Result<(), FactorError> {
        check_finite(matrix, parallel)?;
        let (dim, nodes) = (matrix.pattern().dim(), matrix.pattern().nodes());
        check("dofs per node (one to three)", dim.clamp(1, 3), dim)?;
        check("node positions", nodes, geometry.points.len())?;
        check("marks of eliminated unknowns", dim * nodes, geometry.fixed.len())?;
        self.parallel = parallel;
        if !Arc::ptr_eq(&self.pattern, matrix.pattern()) || self.fixed != geometry.fixed {
            self.pattern = matrix.pattern().clone();
            self.fixed = geometry.fixed.to_vec();
            self.finest = Couplings::finest(matrix.pattern(), geometry.fixed, parallel);
            self.cut(0);
        }
        let mut modes = match geometry.corners {
            None => modes::rigid_motions(geometry.points, dim, geometry.fixed, parallel),
            Some(corners) => {
                let points: Vec<_> = corners.nodes().iter().map(|&node| geometry.points[node as usize]).collect();
                modes::rigid_motions(&points, dim, &corners.fixed(dim, geometry.fixed), parallel)
            }
        };
        let mut inherited: Option<Vec<f64>> = None;
        for l in 0.. {
            let values = inherited.as_deref().unwrap_or(&matrix.values);
            if let Some(level) = self.levels.get_mut(l) {
                level.matrix.fill(values, geometry.products.filter(|_| l == 0 && geometry.has_products(dim)), parallel);
                if !level.serves(parallel) {
                    self.cut(l);
                }
            }
            if l == self.levels.len() && self.coarsest.is_none() {
                self.lay_out(values, geometry)?;
            }
            let Some(level) = self.levels.get_mut(l) else { break };
            let below = level.fill(values, &modes, parallel).map_err(|at| self.not_positive(l, at.0))?;
            let Inherited { values, modes: of_aggregates } = below;
            modes = of_aggregates.unwrap_or(modes);
            inherited = Some(values);
        }
        self.factorise(inherited.as_deref().unwrap_or(&matrix.values))
    }

    /// Drops the levels from the l-th on.
    fn cut(&mut self, l: usize) {
        self.levels.truncate(l);
        self.coarsest = None;
        lock(&self.vectors).clear();
    }

    /// Lays out the next level for a matrix, or decides that it is the last.
    fn lay_out(&mut self, values: &[f64], geometry: &Geometry) -> Result<(), StructureError> {
        let parallel = self.parallel;
        let couplings = self.last_couplings().clone();
        self.layouts += 1;
        let filled = |products| {
            let mut matrix = BlockMatrix::new(couplings.clone());
            matrix.fill(values, products, parallel);
            matrix
        };
        if let (true, Some(corners)) = (self.levels.is_empty(), geometry.corners) {
            self.levels.push(Level::of_corners(
                filled(geometry.products.filter(|_| geometry.has_products(couplings.size))),
                corners,
                geometry.fixed,
                parallel,
            ));
            return Ok(());
        }
        if !self.levels.is_empty() && couplings.unknowns() <= ANALYSED {
            let symbolic = coarsest::analyse(&couplings)?;
            let entries = self.finest.codes.len() * self.finest.size.pow(2);
            if symbolic.nonzeros() as f64 <= COARSEST_SHARE * entries as f64 {
                self.coarsest = Some(Coarsest { symbolic, factor: None });
                return Ok(());
            }
        }
        match Level::of_aggregates(filled(None), (modes::count(self.finest.size), COARSENING), parallel) {
            Some(level) => self.levels.push(level),
            None => self.coarsest = Some(Coarsest { symbolic: coarsest::analyse(&couplings)?, factor: None }),
        }
        Ok(())
    }

    fn last_couplings(&self) -> &Arc<Couplings> {
        self.levels.last().map_or(&self.finest, |level| &level.below)
    }

    fn factorise(&mut self, values: &[f64]) -> Result<(), FactorError> {
        let couplings = self.last_couplings().clone();
        let matrix = Symmetric { couplings: &couplings, values };
        let Some(coarsest) = &mut self.coarsest else { return Ok(()) };
        coarsest.factor = None;
        match coarsest::factorise(&matrix, &coarsest.symbolic, self.parallel) {
            Ok(factor) => coarsest.factor = Some(factor),
            Err(FactorError::NotPositive { node, .. }) => return Err(self.not_positive(self.levels.len(), node)),
            Err(other) => return Err(other),
        }
        Ok(())
    }

    /// The error of a node of the l-th level.
    fn not_positive(&self, l: usize, node: usize) -> FactorError {
        let node = self.levels[..l].iter().rev().fold(node, |node, level| level.node_above(node));
        FactorError::NotPositive { node, component: 0 }
    }

    /// Unknowns on each level, from the finest to the one that is factorised.
    pub fn sizes(&self) -> Vec<usize> {
        let of_levels = self.levels.iter().map(|level| level.matrix.couplings.unknowns());
        of_levels.chain([self.last_couplings().unknowns()]).collect()
    }

    /// Memory of the levels, with the vectors of a cycle, in bytes.
    pub fn bytes(&self) -> usize {
        let levels: usize = self.levels.iter().map(Level::bytes).sum();
        let coarsest = self.coarsest.as_ref().and_then(|coarsest| coarsest.factor.as_ref());
        let vectors = self.sizes().iter().map(|unknowns| 4 * size_of::<f64>() * unknowns).sum::<usize>();
        levels + self.last_couplings().bytes() + coarsest.map_or(0, Factor::bytes) + vectors
    }

    /// How often a level was laid out: its couplings and aggregates made.
    pub fn layouts(&self) -> usize {
        self.layouts
    }
}

impl Preconditioner for Multigrid {
    fn apply(&self, vector: &mut [f64]) {
        let Some(factor) = self.coarsest.as_ref().and_then(|coarsest| coarsest.factor.as_ref()) else { return };
        let kept = lock(&self.vectors).pop();
        let mut vectors = kept.unwrap_or_else(|| self.sizes().into_iter().map(Vectors::new).collect());
        vectors[0].r.copy_from_slice(vector);
        v_cycle(&self.levels, factor, &mut vectors, self.parallel);
        vector.copy_from_slice(&vectors[0].x);
        lock(&self.vectors).push(vectors);
    }

    fn parallel(&self) -> bool {
        self.parallel
    }
}

/// Refuses NaN and infinities.
fn check_finite(matrix: &SparseMatrix, parallel: bool) -> Result<(), FactorError> {
    let finite = chunks::map(matrix.values.len().div_ceil(64), parallel, |range| {
        let last = (64 * range.end).min(matrix.values.len());
        matrix.values[64 * range.start..last].iter().sum::<f64>().is_finite()
    });
    if finite.contains(&false) || !matrix.is_symmetric() { matrix.check_finite() } else { Ok(()) }
}

fn check(what: &'static str, expected: usize, found: usize) -> Result<(), StructureError> {
    if expected == found { Ok(()) } else { Err(StructureError::Length { what, expected, found }) }
}
