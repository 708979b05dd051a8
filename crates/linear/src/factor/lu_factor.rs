//! [`LuFactor`]: `P A Q = L U` by faer's sparse LU with partial pivoting.

use super::structure::Structure;
use crate::error::FactorError;
use crate::memory;
use crate::pattern::entries::Pattern;
use crate::pattern::matrix::SparseMatrix;
use crate::pattern::operator::Preconditioner;
use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::lu::partial_pivoting::factor::PartialPivLuParams;
use faer::sparse::linalg::LuError;
use faer::sparse::linalg::lu::{LuRef, LuSymbolicParams, NumericLu, SymbolicLu, factorize_symbolic_lu};
use faer::sparse::{FaerError, SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Spec};
use std::sync::Arc;

/// Memory at the largest over that of both triangles in the elimination order of the structure, as seen on blocks of hexahedra with 7k to
/// 95k unknowns (docs/development/performance.md): columns are ordered anew, and pivots chosen.
const MAX_FILL_RATIO: usize = 4;

/// The entries of both triangles of a pattern by columns, in elimination order, and the order of its columns (COLAMD).
#[derive(Debug)]
pub(crate) struct LuAnalysis {
    structure: Arc<Structure>,
    starts: Vec<usize>,
    rows: Vec<usize>,
    symbolic: SymbolicLu<usize>,
}

impl LuAnalysis {
    /// Of a structure.
    ///
    /// # Errors
    /// [`FactorError::Memory`].
    pub fn new(structure: &Arc<Structure>) -> Result<Self, FactorError> {
        let pattern = structure.pattern();
        let dim = pattern.dim();
        let mut columns: Vec<Vec<usize>> = vec![Vec::new(); pattern.nodes()];
        each_block(pattern, |_, row, column, _| columns[column].push(row));
        let (mut starts, mut rows) = (vec![0], Vec::new());
        for column in &columns {
            for _ in 0..dim {
                rows.extend(column.iter().flat_map(|&node| (0..dim).map(move |r| dim * node + r)));
                starts.push(rows.len());
            }
        }
        let n = pattern.dofs();
        let matrix = SymbolicSparseColMatRef::new_checked(n, n, &starts, None, &rows);
        let symbolic = factorize_symbolic_lu(matrix, LuSymbolicParams::default()).map_err(|_| too_large(structure))?;
        Ok(LuAnalysis { structure: structure.clone(), starts, rows, symbolic })
    }

    /// The values of a matrix in the order of `rows`.
    fn values(&self, matrix: &SparseMatrix) -> Vec<f64> {
        let pattern = self.structure.pattern();
        let dim = pattern.dim();
        let mut next: Vec<usize> = (0..pattern.nodes()).map(|node| self.starts[dim * node]).collect();
        let mut values = vec![0.0; self.rows.len()];
        each_block(pattern, |block, row, column, transposed| {
            let height = self.starts[dim * column + 1] - self.starts[dim * column];
            for (c, r) in (0..dim).flat_map(|c| (0..dim).map(move |r| (c, r))) {
                values[next[column] + height * c + r] = matrix.block_entry(block, r, c, transposed);
            }
            next[column] += dim;
            debug_assert!(row < pattern.nodes());
        });
        values
    }
}

/// Calls with every stored block, and with its mirror image above the diagonal: number of the block, row and column of the node in
/// elimination order, whether it is the mirror image. Rows ascend in every column.
fn each_block(pattern: &Pattern, mut call: impl FnMut(usize, usize, usize, bool)) {
    // The columns left of a column have its blocks above the diagonal.
    for j in 0..pattern.nodes() {
        let (first, rows) = pattern.column(j);
        for (k, &i) in rows.iter().enumerate().filter(|(_, i)| **i as usize > j) {
            call(first + k, j, i as usize, true);
        }
    }
    for j in 0..pattern.nodes() {
        let (first, rows) = pattern.column(j);
        rows.iter().enumerate().for_each(|(k, &i)| call(first + k, i as usize, j, false));
    }
}

/// The factorisation of a matrix.
#[derive(Debug)]
pub(crate) struct LuFactor {
    analysis: Arc<LuAnalysis>,
    numeric: NumericLu<usize, f64>,
}

impl LuFactor {
    /// Factorises, on one thread: the bits would depend on their number.
    ///
    /// # Errors
    /// [`FactorError`]: entries that are not finite, a singular matrix, too little memory.
    pub fn new(analysis: Arc<LuAnalysis>, matrix: &SparseMatrix) -> Result<Self, FactorError> {
        if !Arc::ptr_eq(matrix.pattern(), analysis.structure.pattern()) {
            return Err(FactorError::ForeignPattern);
        }
        if !matrix.beyond().is_empty() {
            return Err(FactorError::Beyond { blocks: matrix.beyond().len() });
        }
        matrix.check_finite()?;
        memory::check_factor("an LU factorisation of the tangent", predicted_bytes(&analysis.structure))?;
        let params = Spec::<PartialPivLuParams, f64>::default();
        let mut memory = buffer(analysis.symbolic.factorize_numeric_lu_scratch::<f64>(Par::Seq, params), &analysis)?;
        let (n, values) = (analysis.structure.pattern().dofs(), analysis.values(matrix));
        let columns = SymbolicSparseColMatRef::new_checked(n, n, &analysis.starts, None, &analysis.rows);
        let mut numeric = NumericLu::new();
        let made = analysis.symbolic.factorize_numeric_lu(
            &mut numeric,
            SparseColMatRef::new(columns, &values),
            Par::Seq,
            MemStack::new(&mut memory),
            params,
        );
        match made.map(|_| ()) {
            Ok(()) => Ok(LuFactor { analysis, numeric }),
            Err(LuError::SymbolicSingular { index }) => {
                let pattern = analysis.structure.pattern();
                let node = pattern.ordering().new_to_old()[index / pattern.dim()] as usize;
                Err(FactorError::Singular { node, component: index % pattern.dim() })
            }
            Err(LuError::Generic(FaerError::OutOfMemory | FaerError::IndexOverflow | _)) => {
                Err(too_large(&analysis.structure))
            }
        }
    }

    /// As a preconditioner of the transposed matrix.
    pub fn transposed(&self) -> Transposed<'_> {
        Transposed(self)
    }

    pub fn least_bytes(&self) -> usize {
        least_bytes(&self.analysis.structure)
    }

    /// Overwrites v with `A^-1 v` or `A^-T v`.
    fn solve(&self, v: &mut [f64], transposed: bool) {
        let pattern = self.analysis.structure.pattern();
        let dim = pattern.dim();
        let order = || pattern.ordering().new_to_old().iter().map(|&node| dim * node as usize);
        let mut x: Vec<f64> = order().flat_map(|first| v[first..first + dim].iter().copied()).collect();
        let symbolic = &self.analysis.symbolic;
        let (n, factor) = (x.len(), LuRef::new_unchecked(symbolic, &self.numeric));
        let Ok(mut memory) = MemBuffer::try_new(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq)) else {
            // Not a number ends the iterations.
            return v.fill(f64::NAN);
        };
        let (rhs, stack) = (MatMut::from_column_major_slice_mut(&mut x, n, 1), MemStack::new(&mut memory));
        match transposed {
            false => factor.solve_in_place_with_conj(Conj::No, rhs, Par::Seq, stack),
            true => factor.solve_transpose_in_place_with_conj(Conj::No, rhs, Par::Seq, stack),
        }
        for (first, x) in order().zip(x.chunks_exact(dim)) {
            v[first..first + dim].copy_from_slice(x);
        }
    }
}

impl Preconditioner for LuFactor {
    fn apply(&self, vector: &mut [f64]) {
        self.solve(vector, false);
    }
}

/// A factorisation of `A^T` by that of A.
pub(crate) struct Transposed<'a>(&'a LuFactor);

impl Preconditioner for Transposed<'_> {
    fn apply(&self, vector: &mut [f64]) {
        self.0.solve(vector, true);
    }
}

/// Both triangles with the fill of the elimination order of the structure: partial pivoting takes at least about that.
fn least_bytes(structure: &Structure) -> usize {
    2 * size_of::<f64>() * structure.factor_size().nonzeros as usize
}

/// What it takes at its largest.
fn predicted_bytes(structure: &Structure) -> usize {
    MAX_FILL_RATIO * least_bytes(structure)
}

fn too_large(structure: &Structure) -> FactorError {
    let needed = predicted_bytes(structure);
    let available = memory::available().ok().flatten().unwrap_or(0);
    FactorError::Memory { what: "an LU factorisation of the tangent", needed, available }
}

fn buffer(size: StackReq, analysis: &LuAnalysis) -> Result<MemBuffer, FactorError> {
    MemBuffer::try_new(size).map_err(|_| too_large(&analysis.structure))
}
