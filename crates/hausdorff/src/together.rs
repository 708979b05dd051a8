//! [`Together`]: processes that share out the sums over pairs.

use std::fmt::Debug;

/// Several processes that have the same two clouds and form the sums over their pairs together: each those of some of the body's points, which are
/// then added up. All call the same methods of [`Pairs`](super::Pairs) and [`Evaluation`](super::Evaluation) in the same order.
pub trait Together: Debug + Send + Sync {
    /// The number of this process, and how many there are.
    fn place(&self) -> (usize, usize);

    /// Each number becomes its sum over all processes, the same bits on all.
    fn add_up(&self, values: &mut [f64]);
}

/// Whether a process forms the sums of a panel of points.
pub(super) fn is_own(together: Option<&dyn Together>, panel: usize) -> bool {
    together.map(Together::place).is_none_or(|(own, all)| panel % all.max(1) == own)
}
