//! [`Workspace`]: what makes the next solve faster, and decides no result beyond the accuracy asked for.

use nastic_linear::Factor;
use std::fmt;

/// What one solve leaves behind for the next on the same body: a factor of a recent tangent, used as preconditioner
/// while that is cheaper than a new one. Owned by whoever makes the solves, one after the other; results depend on it
/// only within the accuracy asked of them, and the same history gives the same bits.
#[derive(Clone, Default)]
pub struct Workspace {
    pub(crate) factor: Option<Factor>,
}

impl Workspace {
    /// The factor kept for the next solve, if there is one.
    pub fn factor(&self) -> Option<&Factor> {
        self.factor.as_ref()
    }

    /// Memory of that factor, in bytes.
    pub fn factor_bytes(&self) -> usize {
        self.factor.as_ref().map_or(0, Factor::bytes)
    }

    /// One that holds a factor of a tangent near the expected ones.
    pub fn with_factor(factor: Factor) -> Self {
        Workspace { factor: Some(factor) }
    }

    /// Drops everything: the next solve starts as if it were the first.
    pub fn clear(&mut self) {
        *self = Workspace::default();
    }
}

impl fmt::Debug for Workspace {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "Workspace(factor of {} bytes)", self.factor_bytes())
    }
}
