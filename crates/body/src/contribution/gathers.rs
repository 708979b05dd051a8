//! [`Gathers`]: what all others put on some unknowns, as a quantity of a contribution.

use crate::instant::Instant;

/// Unknowns a of a contribution's [fields](super::Contribution::fields), and what it reports of the sum `f = sum_a r_a` of the residuals that all contributions without this give there: of the potential at
/// the nodes of an electrode `f = -Q`.
pub trait Gathers {
    /// In vectors of the displacement and of its fields.
    fn unknowns(&self) -> Vec<usize>;

    /// What follows from their sum.
    fn quantities(&self, at: &Instant, sum: f64) -> Vec<(&'static str, f64)>;
}
