//! [`Solver`]: what solves tangent systems, and how that is chosen.

use crate::pattern::Pattern;
use crate::symbolic::Symbolic;
use std::fmt;

/// What solves the linear systems of a nonlinear solve.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Solver {
    /// A sparse factor of the tangent, kept as preconditioner while it serves.
    #[default]
    Direct,
    /// Conjugate gradients with [`Multigrid`](crate::Multigrid): memory and time grow with the unknowns alone.
    Multigrid,
    /// GMRES with a factor of the symmetric part, for matrices that are not symmetric.
    General,
}

/// What solving with one tangent by multigrid costs, setup and cycles, in passes over the entries of the tangent.
const PASSES: f64 = 400.0;
/// Arithmetic operations of a factorisation that take as long as passing one entry (single precision, from memory).
const FLOPS_PER_ENTRY: f64 = 19.0;
/// A factor serves several tangents and the adjoint, and does not mind an indefinite tangent or a nearly incompressible
/// material: multigrid is taken where it is expected to be cheaper by this much.
const MARGIN: f64 = 3.0;
/// Largest factor that is made unasked: 8 GiB. Its workspace comes on top.
const FACTOR_BYTES: usize = 8 << 30;

impl Solver {
    /// The solver for a body that asks for none, from counts alone: the factor while it has at most 8 GiB, and at most
    /// three times the cost that multigrid is expected to have.
    ///
    /// The costs compared are the operations of one factorisation, and 400 passes over both triangles of the tangent at
    /// 19 operations per entry. docs/development/performance.md has the measurements behind these numbers.
    pub fn cheaper(pattern: &Pattern, symbolic: &Symbolic) -> Self {
        let entries = 2.0 * pattern.values() as f64;
        let multigrid = PASSES * FLOPS_PER_ENTRY * entries;
        if fits(symbolic) && symbolic.flops() <= MARGIN * multigrid { Solver::Direct } else { Solver::Multigrid }
    }
}

/// Whether a factor may be made unasked.
pub(crate) fn fits(symbolic: &Symbolic) -> bool {
    symbolic.factor_bytes() <= FACTOR_BYTES
}

impl fmt::Display for Solver {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Solver::Direct => "direct",
            Solver::Multigrid => "multigrid",
            Solver::General => "general",
        })
    }
}
