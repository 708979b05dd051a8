//! From how many operations of a factorisation on multigrid is taken.

/// What solving with one tangent by multigrid costs, setup and cycles, in passes over the entries of the tangent.
const PASSES: f64 = 400.0;
/// Arithmetic operations of a factorisation that take as long as passing one entry (single precision, from memory).
const FLOPS_PER_ENTRY: f64 = 19.0;
/// Expected cost of a factor over that of multigrid from which multigrid is taken: a factor serves several tangents and the
/// adjoint, and handles an indefinite tangent or a nearly incompressible material.
const MIN_SPEEDUP: f64 = 3.0;

/// Operations of a factorisation from which multigrid is taken, for a matrix with this number of entries.
pub(crate) fn multigrid_flops(entries: f64) -> f64 {
    MIN_SPEEDUP * PASSES * FLOPS_PER_ENTRY * entries
}
