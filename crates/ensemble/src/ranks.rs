//! [`Ranks`]: which threads of this process, and which ranks of a team, evaluate which members.

use crate::error::EnsembleError;
use crate::parcel::{Parcel, ReportedFailure, unpacked};
use crate::saved::MemberBlock;
use nastic_control::ControlError;
use nastic_opt::saved::pack;
use nastic_team::{Alone, Shares, Team, TeamError};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError, RwLock, RwLockReadGuard};
use std::time::Duration;

/// Time without progress over that of the longest trial, after which a run is stopped.
const MAX_TRIAL_RATIO: u32 = 10;
/// Least time without progress after which a run is stopped.
const MIN_WAIT: Duration = Duration::from_secs(60);
/// Time that the other ranks wait while one rank works alone: without limit.
const MAX_WAIT_FOR_ONE_RANK: Duration = Duration::from_secs(1 << 32);

/// The ranks of a team, each with a range of the members. They exchange small reports, the first failure, requests to
/// stop, and sums, so that all continue in the same way.
#[derive(Debug)]
pub(crate) struct Ranks {
    team: Arc<dyn Team>,
    /// Read for every message, written by [`share_anew`](Self::share_anew) between evaluations.
    shares: RwLock<Shares>,
    /// Set where this rank is asked to stop.
    signal: Option<Arc<AtomicBool>>,
    /// Set on all ranks at the same message.
    agreed: Option<Arc<AtomicBool>>,
    longest: Mutex<Duration>,
    broken: OnceLock<TeamError>,
}

impl Ranks {
    pub fn alone(members: usize) -> Self {
        Self::new(Arc::new(Alone), members, None)
    }

    /// On a team. The first flag is that of this rank, the second is set on all ranks once one of them has the first one set.
    pub fn new(team: Arc<dyn Team>, members: usize, flags: Option<[Arc<AtomicBool>; 2]>) -> Self {
        let shares = RwLock::new(Shares::even(members, team.size()));
        let [signal, agreed] = flags.map_or([None, None], |flags| flags.map(Some));
        Self { team, shares, signal, agreed, longest: Mutex::default(), broken: OnceLock::new() }
    }

    pub fn is_alone(&self) -> bool {
        self.team.size() == 1
    }

    pub fn team(&self) -> &dyn Team {
        self.team.as_ref()
    }

    /// The members of this rank.
    pub fn own(&self) -> Range<usize> {
        self.shares().of(self.team.rank())
    }

    fn shares(&self) -> RwLockReadGuard<'_, Shares> {
        self.shares.read().unwrap_or_else(PoisonError::into_inner)
    }

    /// Distributes the members anew by their work, in a unit that all ranks count in the same way, if the largest share becomes smaller, the work `again`
    /// of members that move included; whether it did.
    pub fn share_anew(&self, work: &[usize], again: impl Fn(usize) -> usize) -> bool {
        let (now, balanced) = (self.shares().clone(), Shares::balanced(work, self.team.size()));
        let ranks = 0..self.team.size();
        let most = ranks.clone().map(|rank| work[now.of(rank)].iter().sum::<usize>()).max();
        let cost = |rank: usize, index: usize| work[index] + if now.owner(index) == rank { 0 } else { again(index) };
        let share = |rank: usize| balanced.of(rank).map(|index| cost(rank, index)).sum::<usize>();
        let changes = ranks.map(share).max() < most;
        if changes {
            *self.shares.write().unwrap_or_else(PoisonError::into_inner) = balanced;
        }
        changes
    }

    /// The error that broke the communication, if any.
    pub fn broken(&self) -> Option<&TeamError> {
        self.broken.get()
    }

    /// Stores the first failure of the team.
    pub fn noted<T>(&self, outcome: Result<T, TeamError>) -> Result<T, EnsembleError> {
        outcome.map_err(|error| EnsembleError::Team(self.broken.get_or_init(|| error).clone()))
    }

    /// Records the time of a trial: other ranks are waited for ten times as long as the longest one took.
    pub fn took(&self, trial: Duration) {
        if !self.is_alone() {
            let mut longest = self.longest.lock().unwrap_or_else(PoisonError::into_inner);
            *longest = trial.max(*longest);
            self.team.wait_at_most((MAX_TRIAL_RATIO * *longest).max(MIN_WAIT));
        }
    }

    /// The first rank works alone until the next trial, and the others wait for it.
    pub fn wait(&self) {
        self.team.wait_at_most(MAX_WAIT_FOR_ONE_RANK);
    }

    /// Exchanges the reports of each rank's members, or their first failure: the reports of all members, or the first failure of all.
    pub fn share<R: Parcel>(
        &self,
        own: Result<Vec<R>, (usize, ControlError)>,
    ) -> Result<Result<Vec<R>, (usize, ControlError)>, EnsembleError> {
        if self.is_alone() {
            return Ok(own);
        }
        let raised = |flag: &Option<Arc<AtomicBool>>| flag.as_ref().is_some_and(|flag| flag.load(Ordering::Relaxed));
        let reported = own.as_ref().map_err(|(index, error)| (*index, ReportedFailure::of(self.team.rank(), error)));
        let all = self.noted(nastic_team::exchange(self.team(), pack(&(raised(&self.signal), reported))))?;
        let (mut reports, mut first, mut stops) = (Vec::new(), None, false);
        for (rank, bytes) in all.iter().enumerate() {
            let (stop, reported) = self.noted(self.reported(rank, bytes))?;
            stops |= stop;
            match reported {
                Ok(reported) => reports.extend(reported),
                // ranks are in the order of their members
                Err((index, failure)) => first = first.or(Some((index, failure.into()))),
            }
        }
        if stops {
            self.signal.iter().chain(&self.agreed).for_each(|flag| flag.store(true, Ordering::Relaxed));
        }
        Ok(match (first, own) {
            // the rank of the failed member returns the original error
            (Some((index, _)), Err((own, error))) if index == own => Err((own, error)),
            (Some(failed), _) => Err(failed),
            (None, _) => Ok(reports),
        })
    }

    /// The message of one rank: whether it was asked to stop, and its reports or its failure.
    #[allow(clippy::type_complexity)] // a message and its two halves
    fn reported<R: Parcel>(
        &self,
        rank: usize,
        bytes: &[u8],
    ) -> Result<(bool, Result<Vec<R>, (usize, ReportedFailure)>), TeamError> {
        let (stop, reported): (bool, Result<Vec<R>, _>) = unpacked(rank, bytes)?;
        match reported.as_ref().map_or(true, |reported| reported.len() == self.shares().of(rank).len()) {
            true => Ok((stop, reported)),
            false => Err(TeamError::Unexpected { rank, what: "reports of other members" }),
        }
    }

    /// Whether the first `count` members are on the first rank.
    pub fn leader_owns(&self, count: usize) -> bool {
        self.shares().of(0).len() >= count
    }

    /// At the first rank the bytes of those of the first `count` members that other ranks own, each made by its owner; `None` elsewhere.
    pub fn at_first(
        &self,
        count: usize,
        bytes: impl Fn(usize) -> Vec<u8>,
    ) -> Result<Option<Vec<Vec<u8>>>, EnsembleError> {
        let own: Vec<Vec<u8>> = self.own().filter(|index| *index < count && !self.team.leads()).map(bytes).collect();
        let Some(all) = self.noted(nastic_team::gather(self.team(), pack(&own)))? else { return Ok(None) };
        let mut out = Vec::new();
        for (rank, bytes) in all.iter().enumerate() {
            out.extend(self.noted(unpacked::<Vec<Vec<u8>>>(rank, bytes))?);
        }
        Ok(Some(out))
    }

    /// Completes saved members: every rank receives the missing ones of its members from the first rank that has them. Each rank has a range of them.
    pub fn complete(&self, saved: &mut [Vec<u8>]) -> Result<(), EnsembleError> {
        if self.is_alone() {
            return Ok(());
        }
        let first = saved.iter().position(|member| !member.is_empty()).unwrap_or(0);
        let count = saved[first..].iter().take_while(|member| !member.is_empty()).count();
        let lacking = self.own().filter(|index| !(first..first + count).contains(index));
        let reported: Vec<usize> = [first, count].into_iter().chain(lacking).collect();
        let all = self.noted(nastic_team::exchange(self.team(), pack(&reported)))?;
        let read = |(rank, bytes): (usize, &Vec<u8>)| unpacked::<Vec<usize>>(rank, bytes);
        let all = self.noted(all.iter().enumerate().map(read).collect::<Result<Vec<_>, _>>())?;
        let has = |reported: &[usize], index: usize| matches!(reported, [first, count, ..] if (*first..first + count).contains(&index));
        // in the same order on all ranks
        for (to, reported) in all.iter().enumerate() {
            let of = |index: &usize| all.iter().position(|reported| has(reported, *index));
            for wanted in reported.get(2..).unwrap_or_default().chunk_by(|a, b| of(a) == of(b)) {
                let nobody = TeamError::Unexpected { rank: to, what: "it wants a state that no rank has" };
                let from = self.noted(of(&wanted[0]).ok_or(nobody))?;
                if from == self.team.rank() {
                    let sent: Vec<Vec<u8>> = wanted.iter().map(|index| saved[*index].clone()).collect();
                    self.noted(self.team.send(to, pack(&sent)))?;
                } else if to == self.team.rank() {
                    let bytes = self.noted(self.team.receive(from))?;
                    let came = self.noted(unpacked::<Vec<Vec<u8>>>(from, &bytes))?;
                    wanted.iter().zip(came).for_each(|(index, bytes)| saved[*index] = bytes);
                }
            }
        }
        Ok(())
    }

    /// The results of `of` for all members of every block whose first member is on this rank: other ranks send theirs.
    pub fn blocks(
        &self,
        blocks: impl Iterator<Item = Range<usize>>,
        of: impl Fn(usize) -> Vec<u8>,
    ) -> Result<Vec<MemberBlock>, EnsembleError> {
        let (shares, here, own) = (self.shares().clone(), self.team.rank(), self.own());
        let mut found = Vec::new();
        // in the same order on all ranks
        for (number, block) in blocks.enumerate() {
            let (owner, last) = (shares.owner(block.start), shares.owner(block.end - 1));
            let part = own.start.max(block.start)..own.end.min(block.end);
            let mut members: Vec<Vec<u8>> = part.map(&of).collect();
            if here == owner {
                for rank in owner + 1..=last {
                    let bytes = self.noted(self.team.receive(rank))?;
                    members.extend(self.noted(unpacked::<Vec<Vec<u8>>>(rank, &bytes))?);
                }
                found.push(MemberBlock { number, members });
            } else if (owner..=last).contains(&here) {
                self.noted(self.team.send(owner, pack(&members)))?;
            }
        }
        Ok(found)
    }

    /// The sum over the members of all ranks; `leaf` gives those of this rank.
    pub fn sum(&self, len: usize, leaf: impl FnMut(usize) -> Option<Vec<f64>>) -> Result<Vec<f64>, EnsembleError> {
        let shares = self.shares().clone();
        self.noted(nastic_team::sum(self.team(), &shares, len, leaf))
    }
}

/// Calls `each` with all workspaces on the available threads; outcomes in the order of the workspaces.
///
/// # Errors
/// The first failure in this order, not in time, with its index. Calls behind it may or may not have been made.
pub(crate) fn side_by_side<W: Send, T: Send, E: Send>(
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
    // One left out is behind a failure, at which this stops.
    outcomes.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::side_by_side;

    #[test]
    fn outcomes_are_in_the_members_order_and_the_first_failure_is_returned() {
        let mut workspaces = vec![0; 40];
        let slow = |index: usize| std::thread::sleep(std::time::Duration::from_micros(40 - index as u64));
        let squares = side_by_side(&mut workspaces, |index, own| {
            slow(index);
            *own += 1;
            Ok::<_, ()>(index * index)
        });
        assert_eq!(squares, Ok((0..40).map(|index| index * index).collect()));
        assert_eq!(workspaces, [1; 40]);
        for _ in 0..20 {
            let failed = side_by_side(&mut workspaces, |index, _| {
                slow(index);
                if index % 7 == 5 { Err(index) } else { Ok(()) }
            });
            assert_eq!(failed, Err((5, 5)));
        }
    }
}
