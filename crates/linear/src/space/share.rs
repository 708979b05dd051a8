//! [`Share`]: what one rank has of the unknowns of a body, and sums over all ranks.

use nastic_team::{Shares, Team, TeamError, exchange, sum};
use std::collections::BTreeSet;
use std::sync::{Arc, Mutex, PoisonError};

/// The nodes that one of several ranks has of a body, in two kinds: vectors are *whole* on a rank where they have the values of the whole body
/// at all its nodes (displacements, forces in balance), and *shares* where the sum over the ranks that have a node is its value (forces and products with
/// the tangent, each by the rank's own cells). Sums over unknowns are those of whole vectors:
///
/// ```text
/// a . b = sum_p sum_(i owned by p) a_i b_i
/// ```
///
/// All ranks call the same methods in the same order. What they are given back has the same bits on all of them: partial sums are added in
/// the order of the ranks. With another number of ranks the last bits differ. Where messages fail, sums are not numbers from there on, which ends
/// whatever iterates, and [`failure`](Self::failure) says why.
#[derive(Debug)]
pub struct Share {
    team: Arc<dyn Team>,
    owned: usize,
    sharers: Vec<(usize, Vec<u32>)>,
    /// The nodes of any of them, each once.
    shared: Vec<u32>,
    failed: Mutex<Option<TeamError>>,
}

/// Two of them are the same where they are one.
impl PartialEq for Share {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self, other)
    }
}

impl Eq for Share {}

/// Numbers up to which a sum over ranks sends all of them to all ranks.
const MAX_SUMMED_VALUES: usize = 64;

impl Share {
    /// The share of a rank that owns its first `owned` nodes; `sharers` are the ranks that have nodes of it, ascending, with these nodes in an order that both
    /// sides have.
    pub fn new(team: Arc<dyn Team>, owned: usize, sharers: Vec<(usize, Vec<u32>)>) -> Arc<Self> {
        let shared: BTreeSet<u32> = sharers.iter().flat_map(|(_, nodes)| nodes).copied().collect();
        Arc::new(Share { team, owned, sharers, shared: shared.into_iter().collect(), failed: Mutex::new(None) })
    }

    /// How many nodes belong to it: the first ones.
    pub fn owned(&self) -> usize {
        self.owned
    }

    /// The ranks that have nodes of it, with these.
    pub fn sharers(&self) -> &[(usize, Vec<u32>)] {
        &self.sharers
    }

    /// The ranks.
    pub fn team(&self) -> &Arc<dyn Team> {
        &self.team
    }

    /// Why sums are no numbers any more.
    pub fn failure(&self) -> Option<TeamError> {
        self.failed.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    fn note<T>(&self, found: Result<T, TeamError>) -> Option<T> {
        found
            .map_err(|error| self.failed.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error).clone())
            .ok()
    }

    /// Numbers of all ranks, joined one after the other by `join(sum, next)`.
    fn joined(&self, values: &mut [f64], join: impl Fn(f64, f64) -> f64) {
        let bytes = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        let all = if self.failure().is_some() { None } else { self.note(exchange(&*self.team, bytes)) };
        let length = 8 * values.len();
        let Some(all) = all.filter(|all| all.iter().all(|one| one.len() == length)) else {
            let error = TeamError::Unexpected { rank: 0, what: "sums of other lengths" };
            self.note(Err::<(), _>(error));
            values.fill(f64::NAN);
            return;
        };
        for (k, value) in values.iter_mut().enumerate() {
            let of = |one: &Vec<u8>| numbers(&one[8 * k..]).next().unwrap_or(f64::NAN);
            *value = all.iter().map(of).reduce(&join).unwrap_or(f64::NAN);
        }
    }

    /// Each number becomes its sum over all ranks. A few are sent to all; many are added along a tree of the ranks, so that none holds those of all.
    pub fn sum(&self, values: &mut [f64]) {
        if values.len() <= MAX_SUMMED_VALUES {
            return self.joined(values, |sum, next| sum + next);
        }
        let ranks = self.team.size();
        let own = |_| Some(values.to_vec());
        let summed = match self.failure() {
            None => self.note(sum(&*self.team, &Shares::even(ranks, ranks), values.len(), own)),
            Some(_) => None,
        };
        match summed {
            Some(summed) => values.copy_from_slice(&summed),
            None => values.fill(f64::NAN),
        }
    }

    /// The numbers of every rank, as many as each has, in the order of the ranks.
    ///
    /// # Errors
    /// Messages fail.
    pub fn gather(&self, own: &[f64]) -> Result<Vec<Vec<f64>>, TeamError> {
        if let Some(failure) = self.failure() {
            return Err(failure);
        }
        let bytes = own.iter().flat_map(|value| value.to_le_bytes()).collect();
        let all = exchange(&*self.team, bytes);
        let all = all.inspect_err(|error| {
            self.note(Err::<(), _>(error.clone()));
        })?;
        Ok(all.iter().map(|one| numbers(one).collect()).collect())
    }

    /// Each number becomes the least one of all ranks; NaN where one is.
    pub fn least(&self, values: &mut [f64]) {
        self.joined(values, |least, next| if next < least || next.is_nan() { next } else { least });
    }

    /// Whether it is so on any rank; so too where messages fail.
    pub fn any(&self, here: bool) -> bool {
        let mut least = [if here { 0.0 } else { 1.0 }];
        self.least(&mut least);
        least[0] != 1.0
    }

    /// A share, `block * node + component`, becomes whole: at every node that several ranks have the sum of their values, added in the order of
    /// the ranks.
    pub fn add_up(&self, block: usize, vector: &mut [f64]) {
        let own: Vec<Vec<f64>> = self.sharers.iter().map(|(_, nodes)| gathered(block, nodes, vector)).collect();
        let Some(theirs) = self.swapped(&own) else {
            vector.fill(f64::NAN);
            return;
        };
        let own = gathered(block, &self.shared, vector);
        self.shared.iter().for_each(|&node| entries(block, node, vector).fill(0.0));
        // own values are added in their turn: every rank adds the same numbers of a node in the same order
        let turn = self.sharers.partition_point(|(other, _)| *other < self.team.rank());
        let mut all: Vec<(&[u32], &[f64])> =
            self.sharers.iter().zip(&theirs).map(|((_, nodes), values)| (&nodes[..], &values[..])).collect();
        all.insert(turn, (&self.shared, &own));
        for (nodes, values) in all {
            for (&node, values) in nodes.iter().zip(values.chunks_exact(block)) {
                entries(block, node, vector).iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
            }
        }
    }

    /// The values of all sharers in exchange for own ones. Of two ranks the lower one sends first, and everyone goes through the others in order: somebody
    /// can always go on.
    fn swapped(&self, own: &[Vec<f64>]) -> Option<Vec<Vec<f64>>> {
        if self.failure().is_some() {
            return None;
        }
        let swap = |other: usize, own: &[f64]| {
            let message: Vec<u8> = own.iter().flat_map(|value| value.to_le_bytes()).collect();
            let (length, first) = (message.len(), self.team.rank() < other);
            let received = if first {
                self.team.send(other, message)?;
                self.team.receive(other)?
            } else {
                let received = self.team.receive(other)?;
                self.team.send(other, message)?;
                received
            };
            match received.len() == length {
                true => Ok(numbers(&received).collect()),
                false => Err(TeamError::Unexpected { rank: other, what: "values of other nodes" }),
            }
        };
        let all = self.sharers.iter().zip(own).map(|((other, _), own)| swap(*other, own));
        self.note(all.collect())
    }
}

fn numbers(bytes: &[u8]) -> impl Iterator<Item = f64> {
    bytes.as_chunks::<8>().0.iter().map(|bytes| f64::from_le_bytes(*bytes))
}

fn gathered(block: usize, nodes: &[u32], vector: &[f64]) -> Vec<f64> {
    nodes.iter().flat_map(|&node| &vector[block * node as usize..block * (node as usize + 1)]).copied().collect()
}

fn entries(block: usize, node: u32, vector: &mut [f64]) -> &mut [f64] {
    &mut vector[block * node as usize..block * (node as usize + 1)]
}

#[cfg(test)]
mod tests {
    use super::Share;
    use nastic_team::threads::{self, Faults};
    use std::sync::Arc;

    /// Three ranks: node 9 is in all of them, node 7 in the first and the last.
    fn share(rank: threads::ThreadRank) -> Arc<Share> {
        let (own, rank) = (nastic_team::Team::rank(&rank), Arc::new(rank));
        let nodes = [
            (3, vec![(1, vec![1]), (2, vec![0, 1])]),
            (1, vec![(0, vec![1]), (2, vec![1])]),
            (0, vec![(0, vec![0, 1]), (1, vec![1])]),
        ];
        let (owned, sharers) = nodes[own].clone();
        Share::new(rank, owned, sharers)
    }

    #[test]
    fn shares_add_up_to_the_same_bits_on_all_ranks() {
        let sums = threads::run(3, &Faults::default(), |rank| {
            let own = nastic_team::Team::rank(&rank) as f64;
            let mut vector = [0.1 + own, 1.0, 0.7 * own, 0.3, 5.0, own];
            let share = share(rank);
            share.add_up(2, &mut vector);
            assert_eq!(share.failure(), None);
            vector
        });
        let at_nine = |vector: [f64; 6]| [vector[2], vector[3]];
        assert_eq!(at_nine(sums[0]), [0.0 + 0.7 + 1.4, 0.3 + 0.3 + 0.3]);
        assert!(sums.iter().all(|sum| at_nine(*sum) == at_nine(sums[0])), "{sums:?}");
        assert_eq!([sums[0][0], sums[2][0]], [0.1 + 2.1; 2], "node 7 of the first and the last");
        assert_eq!(sums[1], [1.1, 1.0, 0.0 + 0.7 + 1.4, 0.3 + 0.3 + 0.3, 5.0, 1.0], "what nobody shares stays");
    }

    #[test]
    fn numbers_are_summed_and_compared_over_all_ranks() {
        let found = threads::run(3, &Faults::default(), |rank| {
            let own = nastic_team::Team::rank(&rank) as f64;
            let share = share(rank);
            let (mut sum, mut least) = ([own + 1.0, 0.1], [2.0 - own]);
            share.sum(&mut sum);
            share.least(&mut least);
            (sum, least, share.any(own == 1.0), share.any(false))
        });
        assert!(found.iter().all(|found| *found == ([6.0, 0.1 + 0.1 + 0.1], [0.0], true, false)), "{found:?}");
    }

    #[test]
    fn many_numbers_are_summed_to_the_same_bits_and_gathered_in_the_order_of_the_ranks() {
        let found = threads::run(3, &Faults::default(), |rank| {
            let own = nastic_team::Team::rank(&rank);
            let share = share(rank);
            let mut many: Vec<f64> = (0..100).map(|k| 0.1 * (k + own) as f64).collect();
            share.sum(&mut many);
            (many, share.gather(&vec![own as f64; own]))
        });
        assert!((found[0].0[7] - 0.1 * (7.0 + 8.0 + 9.0)).abs() < 1e-12, "{:?}", found[0].0);
        let all = Ok(vec![vec![], vec![1.0], vec![2.0, 2.0]]);
        assert!(found.iter().all(|(many, gathered)| *many == found[0].0 && *gathered == all), "{found:?}");
    }

    #[test]
    fn a_rank_that_is_lost_makes_sums_no_numbers_and_is_named() {
        let faults = Faults { lost: Some((1, 4)), ..Faults::default() };
        let found = threads::run(3, &faults, |rank| {
            let share = share(rank);
            for _ in 0..10 {
                share.sum(&mut [1.0]);
            }
            let (mut sum, mut vector) = ([1.0], [1.0; 6]);
            share.sum(&mut sum);
            share.add_up(2, &mut vector);
            (sum[0].is_nan() && vector[0].is_nan() && share.any(false), share.failure().is_some())
        });
        assert_eq!(found, [(true, true); 3]);
    }
}
