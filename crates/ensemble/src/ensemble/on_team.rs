//! [`Ensemble`] on a team: members distributed over ranks, and gathered at the first rank.

use super::Ensemble;
use crate::blocks::gather;
use crate::error::EnsembleError;
use crate::member::Member;
use crate::parcel::{MemberValues, Parcel};
use crate::point::{EnsemblePoint, EnsembleWorkspace, Held};
use crate::ranks::Ranks;
use crate::saved::{MemberBlock, blocks};
use nastic_control::{ControlError, Evaluated, ReducedWorkspace};
use nastic_opt::{Failed, Objective, Request};
use nastic_team::{Team, TeamError};
use rayon::prelude::*;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, PoisonError};

impl Ensemble {
    /// Distributes the members over the ranks of a team, in ranges by number: each rank solves its members and holds their states and factors. All
    /// ranks have all problems, and must make the same calls in the same order with the same arguments; they return the same costs, derivatives
    /// and failures, with the bits of one rank.
    ///
    /// `signal` is the flag by which this rank is asked to stop, as in [`EnsembleBuilder::cancelled_by`](super::EnsembleBuilder::cancelled_by);
    /// `agreed` is set on all ranks after the same evaluation once `signal` is set on one of them.
    pub fn share_out(&mut self, team: Arc<dyn Team>, signal: Arc<AtomicBool>, agreed: Arc<AtomicBool>) {
        self.ranks = Ranks::new(team, self.members.len(), Some([signal, agreed]));
    }

    /// Distributes the members anew by their work, which all ranks have counted in the same way, if the largest share becomes smaller; whether any
    /// member moves. Earlier points must then be saved and [loaded](Objective::load), and workspaces cleared: no bit depends on the distribution
    /// of the members.
    ///
    /// A load solves motions again. Of the points `kept`, which will be loaded, this rank holds the motions that stay with it until
    /// [`forget`](Self::forget) is called; for those that move, their work for this number of `solves` is added.
    pub fn share_anew(&self, work: &[usize], kept: &[&EnsemblePoint], solves: usize) -> bool {
        if work.len() != self.members.len() {
            return false;
        }
        let is_motion = |index: usize| self.members[index].problem.timeline().is_some();
        let again = |index: usize| if is_motion(index) { kept.len() * work[index] / solves.max(1) } else { 0 };
        if !self.ranks.share_anew(work, again) {
            return false;
        }
        let own = self.ranks.own();
        let all = kept.iter().flat_map(|point| point.held());
        let stays = all.filter(|(index, _)| own.contains(index) && is_motion(*index));
        let stays = stays.map(|(index, at)| (index, self.members[index].problem.save(at), at.clone())).collect();
        *self.kept.lock().unwrap_or_else(PoisonError::into_inner) = stays;
        true
    }

    /// Drops the motions that are held for loads.
    pub fn forget(&self) {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner).clear();
    }

    /// Takes a motion that is held.
    fn kept(&self, index: usize, bytes: &[u8]) -> Option<Evaluated> {
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        let place = kept.iter().position(|(own, saved, _)| *own == index && saved == bytes)?;
        Some(kept.swap_remove(place).2)
    }

    /// The error that broke the communication between the ranks, if any: every evaluation fails from then on.
    pub fn broken(&self) -> Option<&TeamError> {
        self.ranks.broken()
    }

    /// Whether this is the rank that reports, and writes the files that belong to no member.
    pub fn leads(&self) -> bool {
        self.ranks.team().leads()
    }

    /// The results of `of` for every member of a point, computed on the rank of the member, on all ranks.
    ///
    /// # Errors
    /// [`EnsembleError::Team`].
    pub fn gathered<R: Parcel + Send>(
        &self,
        point: &EnsemblePoint,
        of: impl Fn(usize, &Evaluated) -> R + Sync,
    ) -> Result<Vec<R>, EnsembleError> {
        let held: Vec<_> = point.held().collect();
        let own = held.par_iter().with_max_len(1).map(|(index, at)| of(*index, at)).collect();
        if point.is_whole() {
            return Ok(own);
        }
        let all = self.ranks.share(Ok(own))?;
        all.map_err(|(index, error)| EnsembleError::member(&self.members[index].name, error))
    }

    /// At the first rank the point with all members: the others send theirs, and wait while the first rank works with them. `None` elsewhere.
    ///
    /// # Errors
    /// [`EnsembleError::Team`].
    pub fn whole(&self, point: &EnsemblePoint) -> Result<Option<EnsemblePoint>, EnsembleError> {
        if point.is_whole() {
            return Ok(Some(point.clone()));
        }
        self.ranks.wait();
        let Some(members) = self.first_members(point, self.members.len())? else { return Ok(None) };
        Ok(Some(EnsemblePoint {
            members,
            held: Held::All,
            m: point.m.clone(),
            costs: point.costs.clone(),
            first_order: point.first_order.clone(),
            ..*point
        }))
    }

    /// The first members of a point, at the first rank; `None` elsewhere.
    ///
    /// # Errors
    /// [`EnsembleError::Team`].
    pub fn first_members(&self, point: &EnsemblePoint, count: usize) -> Result<Option<Vec<Evaluated>>, EnsembleError> {
        let count = count.min(self.members.len());
        let own: Vec<Evaluated> = point.held().take(count).map(|(_, at)| at.clone()).collect();
        // without messages where the first rank has them
        if point.is_whole() || self.ranks.leader_owns(count) {
            return Ok(self.leads().then_some(own));
        }
        let save = |index: usize, at: &Evaluated| self.members[index].problem.save(at);
        let bytes = |index: usize| point.member(index).map(|at| save(index, at)).unwrap_or_default();
        let Some(sent) = self.ranks.at_first(count, bytes)? else { return Ok(None) };
        let stage = own.first().map_or(0, |at| at.stage);
        let how = Request { stage, ..Request::default() };
        let first = own.len();
        let load = |(k, bytes): (usize, &Vec<u8>)| self.load_member(first + k, &point.m, bytes, &how);
        let sent: Vec<Evaluated> = sent.par_iter().enumerate().with_max_len(1).map(load).collect::<Result<_, _>>()?;
        Ok(Some(own.into_iter().chain(sent).collect()))
    }

    fn load_member(
        &self,
        index: usize,
        m: &[f64],
        bytes: &[u8],
        how: &Request<'_, Evaluated>,
    ) -> Result<Evaluated, EnsembleError> {
        let member = &self.members[index];
        let loaded = member.problem.load(&gather(&self.blocks, member, m), bytes, how);
        loaded.map_err(|failed| EnsembleError::member(&member.name, unloaded(&failed)))
    }

    /// Whether the members are distributed over ranks.
    pub fn is_shared_out(&self) -> bool {
        !self.ranks.is_alone()
    }

    /// The results of `of` for every member, [block by block](crate::blocks_of_members): a whole block on the rank of its first member. `of`
    /// is called for the members of this rank.
    ///
    /// # Errors
    /// [`EnsembleError::Team`].
    pub fn blocks_of(&self, of: impl Fn(usize) -> Vec<u8>) -> Result<Vec<MemberBlock>, EnsembleError> {
        self.ranks.blocks(blocks(self.members.len()), of)
    }

    /// The point of saved members, of which each rank reads its own, and receives the missing ones.
    pub(super) fn loaded(
        &self,
        m: &[f64],
        mut saved: Vec<Vec<u8>>,
        how: &Request<'_, EnsemblePoint>,
    ) -> Result<EnsemblePoint, EnsembleError> {
        self.ranks.complete(&mut saved)?;
        let how = Request { near: None, accuracy: how.accuracy, stage: how.stage, budget: how.budget };
        let load = |index: usize, member: &Member, _: &mut ReducedWorkspace| {
            if let Some(at) = self.kept(index, &saved[index]) {
                return Ok(at);
            }
            let loaded = member.problem.load(&gather(&self.blocks, member, m), &saved[index], &how);
            loaded.map_err(|failed| unloaded(&failed))
        };
        let found = self.side_by_side(&mut EnsembleWorkspace::default(), load, |_, at| MemberValues::of(at))?;
        self.joined(m, found.0, found.1)
    }
}

/// A saved member that does not fit.
fn unloaded(failed: &Failed) -> ControlError {
    match failed.downcast_ref::<ControlError>() {
        Some(error) => error.clone(),
        None => ControlError::Cost { what: failed.to_string() },
    }
}
