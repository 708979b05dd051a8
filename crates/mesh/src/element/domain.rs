//! [`Domain`]: what the cells of a kind are maps of.

/// The reference domain of a kind, in its [dimension](crate::CellKind::dim). What depends on it matches every variant by name, so that the
/// compiler says where another domain has to be thought of.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Domain {
    /// `[-1,1]^d`.
    Box,
    /// The unit simplex: coordinates of at least 0, whose sum is at most 1.
    Simplex,
}
