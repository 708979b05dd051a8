//! Sums and exchanges on 1 to 64 threads, and what faults do.

use nastic_team::threads::{Faults, Traffic, run};
use nastic_team::{Alone, Shares, Team, TeamError, ThreadRank, exchange, messages_of_sum, sum, sum_alone};
use std::time::{Duration, Instant};

const LEN: usize = 7;

/// Vectors of very different sizes, so that another order of additions has other bits; every fifth member has none.
fn leaf(member: usize) -> Option<Vec<f64>> {
    let value = |i: usize| (((member * 37 + i * 11) % 101) as f64 - 50.3) * 10f64.powi((member % 13) as i32 - 6);
    (member % 5 != 3).then(|| (0..LEN).map(value).collect())
}

fn bits(v: &[f64]) -> Vec<u64> {
    v.iter().map(|x| x.to_bits()).collect()
}

#[test]
fn sums_have_the_same_bits_for_any_ranks_and_take_the_messages_of_the_formula() {
    for members in [1, 2, 3, 5, 8, 13, 100] {
        let serial = sum_alone(members, LEN, leaf);
        for size in (1..10).chain([64]) {
            let uneven: Vec<usize> = (0..members).map(|k| 1 + k * k % 23).collect();
            for shares in [Shares::even(members, size), Shares::balanced(&uneven, size)] {
                let sums = run(size, &Faults::default(), |rank| {
                    let found = sum(&rank, &shares, LEN, leaf);
                    // all have been sent once all have ended
                    exchange(&rank, vec![]).map(|_| (found, rank.traffic()))
                });
                let mut messages = 0;
                for found in sums {
                    let (found, Traffic { messages: all, .. }) = found.unwrap();
                    assert_eq!(bits(&found.unwrap()), bits(&serial), "{members} members, {size} ranks");
                    messages = messages.max(all);
                }
                let rounds = size.next_power_of_two().trailing_zeros() as usize;
                assert_eq!(messages, messages_of_sum(&shares) + size * rounds, "{members} members, {size} ranks");
            }
        }
    }
}

#[test]
fn the_tree_joins_halves_and_leaves_out_members_without_a_vector() {
    let value = |member: usize| [1.0, 1e16, -1e16, 3.0][member];
    assert_eq!(sum_alone(4, 1, |member| Some(vec![value(member)])), [(1.0 + 1e16) + (-1e16 + 3.0)]);
    assert_eq!(sum_alone(4, 1, |member| (member != 1).then(|| vec![value(member)])), [1.0 + (-1e16 + 3.0)]);
    assert_eq!(sum_alone(3, 2, |_| None), [0.0, 0.0]);
    assert_eq!(bits(&sum_alone(1, 1, |_| Some(vec![-0.0]))), [(-0.0f64).to_bits()]);
}

#[test]
fn everyone_hears_what_everyone_says_in_the_order_of_ranks() {
    for size in (1..20).chain([31, 64, 100]) {
        let heard = run(size, &Faults::default(), |rank| exchange(&rank, vec![7; rank.rank()]));
        let expected: Vec<Vec<u8>> = (0..size).map(|rank| vec![7; rank]).collect();
        assert!(heard.into_iter().all(|all| all.as_ref() == Ok(&expected)), "{size} ranks");
    }
    assert_eq!(exchange(&Alone, vec![1]), Ok(vec![vec![1]]));
}

/// A team on which a message leaves once it is received, as long ones of MPI do.
#[derive(Debug)]
struct Rendezvous(ThreadRank);

impl Team for Rendezvous {
    fn rank(&self) -> usize {
        self.0.rank()
    }

    fn size(&self) -> usize {
        self.0.size()
    }

    fn send(&self, to: usize, message: Vec<u8>) -> Result<(), TeamError> {
        self.0.send(to, message)?;
        self.0.receive(to).map(drop)
    }

    fn receive(&self, from: usize) -> Result<Vec<u8>, TeamError> {
        let message = self.0.receive(from)?;
        self.0.send(from, vec![])?;
        Ok(message)
    }

    fn wait_at_most(&self, limit: Duration) {
        self.0.wait_at_most(limit);
    }
}

#[test]
fn no_message_has_to_leave_before_it_is_received() {
    let faults = Faults { patience: Some(Duration::from_secs(5)), ..Faults::default() };
    for size in (2..20).chain([31, 64]) {
        let heard = run(size, &faults, |rank| {
            let rank = Rendezvous(rank);
            exchange(&rank, vec![7; rank.rank()])
                .and_then(|all| sum(&rank, &Shares::even(100, size), LEN, leaf).map(|_| all))
        });
        let expected: Vec<Vec<u8>> = (0..size).map(|rank| vec![7; rank]).collect();
        assert!(heard.into_iter().all(|all| all.as_ref() == Ok(&expected)), "{size} ranks");
    }
}

/// Ten rounds of an exchange and a sum.
fn rounds(faults: &Faults, size: usize) -> Vec<Result<Vec<f64>, TeamError>> {
    run(size, faults, |rank| {
        let shares = Shares::even(20, size);
        (0..10).try_fold(vec![], |_, _| exchange(&rank, vec![1]).and_then(|_| sum(&rank, &shares, LEN, leaf)))
    })
}

#[test]
fn a_lost_rank_ends_all_at_once() {
    for message in 0..20 {
        let began = Instant::now();
        let ended = rounds(&Faults { lost: Some((5, message)), ..Faults::default() }, 7);
        assert!(began.elapsed() < Duration::from_secs(5));
        assert!(ended.iter().all(|end| matches!(end, Err(TeamError::Lost { .. }))), "{message}: {ended:?}");
        assert_eq!(ended[5], Err(TeamError::Lost { rank: 5 }));
    }
}

#[test]
fn a_message_that_never_comes_is_missed_by_time_or_by_the_next_one() {
    let patience = Some(Duration::from_millis(50));
    for message in 0..20 {
        let ended = rounds(&Faults { dropped: Some((5, message)), patience, ..Faults::default() }, 7);
        // receiving takes numbers too
        let is_sent = ended.iter().any(Result::is_err);
        assert!(!is_sent || ended.iter().all(Result::is_err), "{message}: {ended:?}");
        // rank 5 of 7 receives first
        assert!(message != 1 || is_sent);
        let why =
            |end: &Result<_, TeamError>| matches!(end, Err(TeamError::Silent { .. } | TeamError::Unexpected { .. }));
        assert!(!is_sent || ended.iter().any(why), "{message}: {ended:?}");
    }
}

#[test]
fn a_slow_rank_changes_nothing_but_time() {
    let slow = rounds(&Faults { slow: Some((3, Duration::from_millis(3))), ..Faults::default() }, 7);
    let serial = sum_alone(20, LEN, leaf);
    assert!(slow.into_iter().all(|sum| sum.as_deref().map(bits) == Ok(bits(&serial))));
}
