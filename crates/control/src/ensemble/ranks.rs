//! [`Ranks`]: who evaluates which members, on threads of this process and on the ranks of a team.

use super::error::EnsembleError;
use super::parcel::{Parcel, ReportedFailure, unpacked};
use super::saved::MemberBlock;
use crate::error::ControlError;
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

/// The ranks of a team, each with a range of the members. They exchange what all need to go on alike: small
/// reports, the first failure, whether somebody asks for an end; and sums.
#[derive(Debug)]
pub(super) struct Ranks {
    team: Arc<dyn Team>,
    /// Read by every message, written by [`share_anew`](Self::share_anew) between evaluations.
    shares: RwLock<Shares>,
    /// Raised where this rank is to stop.
    signal: Option<Arc<AtomicBool>>,
    /// Raised on all ranks at the same message.
    agreed: Option<Arc<AtomicBool>>,
    longest: Mutex<Duration>,
    broken: OnceLock<TeamError>,
}

impl Ranks {
    pub fn alone(members: usize) -> Self {
        Self::new(Arc::new(Alone), members, None)
    }

    /// On a team; the flags are that of this rank, and one that is raised on all ranks once one of them has its own raised.
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

    /// Ranges that balance what the members have taken, in a unit that all ranks have counted alike, if the largest share is smaller then, with what a
    /// member that moves takes `again`; whether they are taken.
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

    /// Why messages pass no more, if so.
    pub fn broken(&self) -> Option<&TeamError> {
        self.broken.get()
    }

    /// Keeps the first failure of the team.
    pub fn noted<T>(&self, outcome: Result<T, TeamError>) -> Result<T, EnsembleError> {
        outcome.map_err(|error| EnsembleError::Team(self.broken.get_or_init(|| error).clone()))
    }

    /// A trial took so long: ten times the longest one is how long the others are waited for.
    pub fn took(&self, trial: Duration) {
        if !self.is_alone() {
            let mut longest = self.longest.lock().unwrap_or_else(PoisonError::into_inner);
            *longest = trial.max(*longest);
            self.team.wait_at_most((MAX_TRIAL_RATIO * *longest).max(MIN_WAIT));
        }
    }

    /// The first rank works for itself until the next trial: the others wait for it.
    pub fn wait(&self) {
        self.team.wait_at_most(MAX_WAIT_FOR_ONE_RANK);
    }

    /// What every rank sends of its own members, or the first failure of these: of all members, or the first failure of all.
    pub fn share<R: Parcel>(
        &self,
        own: Result<Vec<R>, (usize, ControlError)>,
    ) -> Result<Result<Vec<R>, (usize, ControlError)>, EnsembleError> {
        if self.is_alone() {
            return Ok(own);
        }
        let raised = |flag: &Option<Arc<AtomicBool>>| flag.as_ref().is_some_and(|flag| flag.load(Ordering::Relaxed));
        let told = own.as_ref().map_err(|(index, error)| (*index, ReportedFailure::of(self.team.rank(), error)));
        let all = self.noted(nastic_team::exchange(self.team(), pack(&(raised(&self.signal), told))))?;
        let (mut reports, mut first, mut stops) = (Vec::new(), None, false);
        for (rank, bytes) in all.iter().enumerate() {
            let (stop, told) = self.noted(self.told(rank, bytes))?;
            stops |= stop;
            match told {
                Ok(told) => reports.extend(told),
                // ranks are in the order of their members
                Err((index, failure)) => first = first.or(Some((index, failure.into()))),
            }
        }
        if stops {
            self.signal.iter().chain(&self.agreed).for_each(|flag| flag.store(true, Ordering::Relaxed));
        }
        Ok(match (first, own) {
            // whoever owns it has the error itself
            (Some((index, _)), Err((own, error))) if index == own => Err((own, error)),
            (Some(failed), _) => Err(failed),
            (None, _) => Ok(reports),
        })
    }

    /// What one rank sent: whether it was asked to stop, and its reports or its failure.
    #[allow(clippy::type_complexity)] // a message and its two halves
    fn told<R: Parcel>(
        &self,
        rank: usize,
        bytes: &[u8],
    ) -> Result<(bool, Result<Vec<R>, (usize, ReportedFailure)>), TeamError> {
        let (stop, told): (bool, Result<Vec<R>, _>) = unpacked(rank, bytes)?;
        match told.as_ref().map_or(true, |told| told.len() == self.shares().of(rank).len()) {
            true => Ok((stop, told)),
            false => Err(TeamError::Unexpected { rank, what: "reports of other members" }),
        }
    }

    /// Whether the first rank has the first `count` members itself.
    pub fn leader_owns(&self, count: usize) -> bool {
        self.shares().of(0).len() >= count
    }

    /// The bytes of the first `count` members, but of those of the first rank itself, at the first rank, each made by its owner; `None` elsewhere.
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

    /// Completes saved members: every rank is sent those of its own that it lacks by the first one that has them. What a rank has is a range.
    pub fn complete(&self, saved: &mut [Vec<u8>]) -> Result<(), EnsembleError> {
        if self.is_alone() {
            return Ok(());
        }
        let first = saved.iter().position(|member| !member.is_empty()).unwrap_or(0);
        let count = saved[first..].iter().take_while(|member| !member.is_empty()).count();
        let lacking = self.own().filter(|index| !(first..first + count).contains(index));
        let told: Vec<usize> = [first, count].into_iter().chain(lacking).collect();
        let all = self.noted(nastic_team::exchange(self.team(), pack(&told)))?;
        let read = |(rank, bytes): (usize, &Vec<u8>)| unpacked::<Vec<usize>>(rank, bytes);
        let all = self.noted(all.iter().enumerate().map(read).collect::<Result<Vec<_>, _>>())?;
        let has = |told: &[usize], index: usize| matches!(told, [first, count, ..] if (*first..first + count).contains(&index));
        // in the same order on all ranks
        for (to, told) in all.iter().enumerate() {
            let of = |index: &usize| all.iter().position(|told| has(told, *index));
            for wanted in told.get(2..).unwrap_or_default().chunk_by(|a, b| of(a) == of(b)) {
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

    /// What `of` makes of the members of every block whose first member is this rank's: others send it theirs.
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

    /// The sum over the members of all ranks; `leaf` is asked for this rank's own.
    pub fn sum(&self, len: usize, leaf: impl FnMut(usize) -> Option<Vec<f64>>) -> Result<Vec<f64>, EnsembleError> {
        let shares = self.shares().clone();
        self.noted(nastic_team::sum(self.team(), &shares, len, leaf))
    }
}

/// `each` of all workspaces, on the threads at hand; outcomes in their order.
///
/// # Errors
/// The failure that is the first in their order, whichever came first in time, with its index. Those behind it may or may not have run.
pub(super) fn side_by_side<W: Send, T: Send, E: Send>(
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

#[cfg(test)]
mod tests {
    use super::side_by_side;

    #[test]
    fn outcomes_are_in_the_members_order_and_the_first_failure_is_told() {
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
