//! [`Team`]: who evaluates the members of an ensemble, and adds up what they gave.

use rayon::prelude::*;
use std::fmt::Debug;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Evaluates members, in any order and place, and adds up by their order alone: the bits do not depend on who evaluates.
///
/// The one seam of what runs member by member: threads of one process today; ranks own members by number, agree on the first failure,
/// and pass sums on.
pub(super) trait Team: Debug + Send + Sync {
    /// `each` of all members, each with its own workspace; outcomes in the members' order.
    ///
    /// # Errors
    /// The failure that is the first in the members' order, whichever came first in time, with the member's index. Members behind it may or
    /// may not have been evaluated.
    fn map<W: Send, T: Send, E: Send>(
        &self,
        workspaces: &mut [W],
        each: impl Fn(usize, &mut W) -> Result<T, E> + Sync,
    ) -> Result<Vec<T>, (usize, E)>;

    /// The sum of vectors of a length, one after the other in the members' order; `add` adds one, and there may be none of a member.
    fn sum<T>(&self, len: usize, of: &[Option<T>], add: impl Fn(usize, &T, &mut [f64])) -> Vec<f64>;
}

/// Threads of this process.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Threads;

impl Team for Threads {
    fn map<W: Send, T: Send, E: Send>(
        &self,
        workspaces: &mut [W],
        each: impl Fn(usize, &mut W) -> Result<T, E> + Sync,
    ) -> Result<Vec<T>, (usize, E)> {
        let failed = AtomicUsize::new(usize::MAX);
        let run = |(index, workspace): (usize, &mut W)| {
            if index > failed.load(Ordering::Relaxed) {
                return None;
            }
            let outcome = each(index, workspace).map_err(|error| (index, error));
            if outcome.is_err() {
                failed.fetch_min(index, Ordering::Relaxed);
            }
            Some(outcome)
        };
        let outcomes: Vec<Option<_>> = workspaces.par_iter_mut().enumerate().with_max_len(1).map(run).collect();
        // One left out stands behind a failure, at which this stops.
        outcomes.into_iter().flatten().collect()
    }

    fn sum<T>(&self, len: usize, of: &[Option<T>], add: impl Fn(usize, &T, &mut [f64])) -> Vec<f64> {
        let mut out = vec![0.0; len];
        for (index, one) in of.iter().enumerate() {
            if let Some(one) = one {
                add(index, one, &mut out);
            }
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::{Team, Threads};

    #[test]
    fn outcomes_are_in_the_members_order_and_the_first_failure_is_told() {
        let mut workspaces = vec![0; 40];
        let slow = |index: usize| std::thread::sleep(std::time::Duration::from_micros(40 - index as u64));
        let squares = Threads.map(&mut workspaces, |index, own| {
            slow(index);
            *own += 1;
            Ok::<_, ()>(index * index)
        });
        assert_eq!(squares, Ok((0..40).map(|index| index * index).collect()));
        assert_eq!(workspaces, [1; 40]);
        for _ in 0..20 {
            let failed = Threads.map(&mut workspaces, |index, _| {
                slow(index);
                if index % 7 == 5 { Err(index) } else { Ok(()) }
            });
            assert_eq!(failed, Err((5, 5)));
        }
    }

    #[test]
    fn sums_run_in_the_members_order() {
        let of = [Some(1e16), Some(1.0), None, Some(-1e16)];
        let sum = Threads.sum(1, &of, |_, value, out| out[0] += value);
        assert_eq!(sum, [1e16 + 1.0 - 1e16]);
    }
}
