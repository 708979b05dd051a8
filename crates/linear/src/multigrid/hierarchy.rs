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
use crate::factor::symbolic::Symbolic;
use crate::factor::symmetric::Factor;
use crate::locks::lock;
use crate::pattern::entries::Pattern;
use crate::pattern::matrix::SparseMatrix;
use crate::pattern::operator::Preconditioner;

/// The data of a body that multigrid needs besides its matrix.
#[derive(Clone, Copy, Debug)]
pub struct Geometry<'a> {
    /// Current positions of the nodes (z = 0 in two dimensions).
    pub points: &'a [[f64; 3]],
    /// By unknown: whether its row and column were eliminated.
    pub fixed: &'a [bool],
    /// The corner nodes of second-order elements.
    pub corners: Option<&'a Corners>,
    /// The matrix by the products of its cells, second-order ones with three unknowns per node: its entries are not read then.
    pub products: Option<&'a Arc<dyn CellProducts>>,
}

/// A symmetric positive definite approximation of the inverse of a positive definite matrix.
///
/// Its bits depend only on its matrices and geometries, not on the number of threads.
#[derive(Debug)]
pub struct Multigrid {
    /// The data that the levels were made for.
    pattern: Arc<Pattern>,
    fixed: Vec<bool>,
    finest: Arc<Couplings>,
    levels: Vec<Level>,
    coarsest: Option<Coarsest>,
    layouts: usize,
    /// A bound of the largest eigenvalue of the matrix, where products replace its entries.
    norm: f64,
    parallel: bool,
    /// Working memory of earlier cycles.
    vectors: Mutex<Vec<Vec<Vectors>>>,
}

/// The last level.
#[derive(Debug)]
struct Coarsest {
    symbolic: Arc<Symbolic>,
    factor: Option<Factor>,
}

/// Entries of the factor of a level over those of the finest matrix, up to which the level is factorised: a cycle then
/// spends no more on it than on smoothing.
const MAX_FACTOR_SHARE: f64 = 0.5;
/// Unknowns of a level that is considered for a factor: ordering a larger one costs more than a level.
const MAX_ANALYSED_UNKNOWNS: usize = 60_000;
/// Nodes of a level over those of the finer one, above which no further level is made.
const MAX_COARSENING_RATIO: f64 = 0.7;

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
            norm: 0.0,
            parallel: false,
            vectors: Mutex::default(),
        }
    }

    /// Becomes the levels of another matrix. Couplings and aggregates are reused where pattern and supports are the same, and
    /// at most a twentieth of the strong couplings of a level has changed; values are computed in place.
    ///
    /// # Errors
    /// As [`new`](Self::new); then it is no preconditioner until it is renewed.
    pub fn renew(&mut self, matrix: &SparseMatrix, geometry: &Geometry, parallel: bool) -> Result<(), FactorError> {
        let (dim, nodes) = (matrix.pattern().dim(), matrix.pattern().nodes());
        check("dofs per node (one to three)", dim.clamp(1, 3), dim)?;
        check("node positions", nodes, geometry.points.len())?;
        check("marks of eliminated unknowns", dim * nodes, geometry.fixed.len())?;
        self.parallel = parallel;
        if let Some(products) = geometry.products {
            return self.renew_by_products(matrix.pattern(), products, geometry);
        }
        check_finite(matrix, parallel)?;
        if self.is_foreign(matrix.pattern(), geometry) || self.finest.codes.is_empty() {
            self.lay_out_for(matrix.pattern(), geometry);
            self.finest = Couplings::finest(matrix.pattern(), geometry.fixed, parallel);
        }
        let modes = match geometry.corners {
            None => modes::rigid_motions(geometry.points, dim, geometry.fixed, parallel),
            Some(corners) => modes_of_corners(corners, dim, geometry, parallel),
        };
        self.renew_from(0, &matrix.values, modes, geometry.corners)
    }

    /// The same with products instead of entries.
    fn renew_by_products(
        &mut self,
        pattern: &Arc<Pattern>,
        products: &Arc<dyn CellProducts>,
        geometry: &Geometry,
    ) -> Result<(), FactorError> {
        check("dofs per node of cells with products", 3, pattern.dim())?;
        let Some(corners) = geometry.corners else { return Ok(check("second-order cells", 1, 0)?) };
        if self.is_foreign(pattern, geometry) || !self.finest.codes.is_empty() {
            self.lay_out_for(pattern, geometry);
            self.finest = Couplings::unknown(3, pattern.nodes());
        }
        if self.levels.is_empty() {
            self.layouts += 1;
            self.levels.push(Level::of_products(products.as_ref(), corners, geometry.fixed, self.parallel));
        }
        let filled = self.levels[0].fill_by_products(products, geometry.fixed, self.parallel);
        let (below, norm) = filled.map_err(|at| self.not_positive(0, at.0))?;
        self.norm = norm;
        self.renew_from(1, &below.values, modes_of_corners(corners, 3, geometry, self.parallel), None)
    }

    /// Whether levels were made for another pattern or other supports.
    fn is_foreign(&self, pattern: &Arc<Pattern>, geometry: &Geometry) -> bool {
        !Arc::ptr_eq(&self.pattern, pattern) || self.fixed != geometry.fixed
    }

    /// Drops all levels.
    fn lay_out_for(&mut self, pattern: &Arc<Pattern>, geometry: &Geometry) {
        (self.pattern, self.fixed) = (pattern.clone(), geometry.fixed.to_vec());
        self.cut(0);
    }

    /// The levels from the l-th on, which has these values and modes; of second-order elements with their corners.
    fn renew_from(
        &mut self,
        first: usize,
        values: &[f64],
        mut modes: Vec<f64>,
        corners: Option<&Corners>,
    ) -> Result<(), FactorError> {
        let parallel = self.parallel;
        let mut inherited: Option<Vec<f64>> = None;
        for l in first.. {
            let values = inherited.as_deref().unwrap_or(values);
            if let Some(level) = self.levels.get_mut(l) {
                level.matrix.fill(values, None, parallel);
                if !level.serves(parallel) {
                    self.cut(l);
                }
            }
            if l == self.levels.len() && self.coarsest.is_none() {
                self.lay_out(values, corners)?;
            }
            let Some(level) = self.levels.get_mut(l) else { break };
            let below = level.fill(values, &modes, parallel).map_err(|at| self.not_positive(l, at.0))?;
            let Inherited { values, modes: of_aggregates } = below;
            modes = of_aggregates.unwrap_or(modes);
            inherited = Some(values);
        }
        self.factorise(inherited.as_deref().unwrap_or(values))
    }

    /// Drops the levels from the l-th on.
    fn cut(&mut self, l: usize) {
        self.levels.truncate(l);
        self.coarsest = None;
        lock(&self.vectors).clear();
    }

    /// Makes the next level for a matrix, or decides that it is the last.
    fn lay_out(&mut self, values: &[f64], corners: Option<&Corners>) -> Result<(), StructureError> {
        let parallel = self.parallel;
        let couplings = self.last_couplings().clone();
        self.layouts += 1;
        let mut matrix = BlockMatrix::new(couplings.clone());
        if let (true, Some(corners)) = (self.levels.is_empty(), corners) {
            matrix.fill(values, None, parallel);
            self.levels.push(Level::of_corners(matrix, corners, &self.fixed, parallel));
            return Ok(());
        }
        if !self.levels.is_empty() && couplings.unknowns() <= MAX_ANALYSED_UNKNOWNS {
            let symbolic = coarsest::analyse(&couplings)?;
            if symbolic.nonzeros() as f64 <= MAX_FACTOR_SHARE * self.finest_numbers() as f64 {
                self.coarsest = Some(Coarsest { symbolic, factor: None });
                return Ok(());
            }
        }
        matrix.fill(values, None, parallel);
        match Level::of_aggregates(matrix, modes::count(self.finest.size), MAX_COARSENING_RATIO, parallel) {
            Some(level) => self.levels.push(level),
            None => self.coarsest = Some(Coarsest { symbolic: coarsest::analyse(&couplings)?, factor: None }),
        }
        Ok(())
    }

    /// Numbers that a product on the finest level reads.
    fn finest_numbers(&self) -> usize {
        match self.levels.first().filter(|_| self.finest.codes.is_empty()) {
            Some(level) => level.matrix.numbers(),
            None => self.finest.codes.len() * self.finest.size.pow(2),
        }
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

    /// The error that names a node of the l-th level.
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

    /// A bound of the largest eigenvalue of the matrix, where products replace its entries.
    pub(crate) fn norm(&self) -> f64 {
        self.norm
    }

    /// How often the couplings and aggregates of a level were made.
    pub fn layouts(&self) -> usize {
        self.layouts
    }
}

impl Multigrid {
    /// The levels below the finest with a finest one by other products of cells than those that they were made of, which need not be held then.
    pub(crate) fn below<'a>(&'a self, products: &Arc<dyn CellProducts>) -> BelowProducts<'a> {
        let mut finest = BlockMatrix::new(self.finest.clone());
        finest.fill(&[], Some(products), self.parallel);
        BelowProducts { levels: self, finest }
    }

    /// Drops the products that the levels were made of, which then serve only [below](Self::below) others.
    pub(crate) fn release_products(&mut self) {
        if let Some(level) = self.levels.first_mut() {
            level.matrix.release_products();
        }
    }

    fn cycle(&self, finest: Option<&BlockMatrix>, vector: &mut [f64]) {
        let Some(factor) = self.coarsest.as_ref().and_then(|coarsest| coarsest.factor.as_ref()) else { return };
        let kept = lock(&self.vectors).pop();
        let mut vectors = kept.unwrap_or_else(|| self.sizes().into_iter().map(Vectors::new).collect());
        vectors[0].r.copy_from_slice(vector);
        v_cycle(&self.levels, finest, factor, &mut vectors, self.parallel);
        vector.copy_from_slice(&vectors[0].x);
        lock(&self.vectors).push(vectors);
    }
}

impl Preconditioner for Multigrid {
    fn apply(&self, vector: &mut [f64]) {
        self.cycle(None, vector);
    }

    fn parallel(&self) -> bool {
        self.parallel
    }
}

/// Levels below a finest one by products of cells.
pub(crate) struct BelowProducts<'a> {
    levels: &'a Multigrid,
    finest: BlockMatrix,
}

impl Preconditioner for BelowProducts<'_> {
    fn apply(&self, vector: &mut [f64]) {
        self.levels.cycle(Some(&self.finest), vector);
    }

    fn parallel(&self) -> bool {
        self.levels.parallel
    }
}

/// The rigid motions of the corners of second-order elements.
fn modes_of_corners(corners: &Corners, dim: usize, geometry: &Geometry, parallel: bool) -> Vec<f64> {
    let points: Vec<_> = corners.nodes().iter().map(|&node| geometry.points[node as usize]).collect();
    modes::rigid_motions(&points, dim, &corners.fixed(dim, geometry.fixed), parallel)
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
