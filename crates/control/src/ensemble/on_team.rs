//! [`Ensemble`] on a team: members shared out over ranks, and what the first rank is sent of them.

use super::blocks::gather;
use super::point::Held;
use super::ranks::Ranks;
use super::{Ensemble, EnsembleError, EnsemblePoint, EnsembleWorkspace, MemberValues, Parcel};
use crate::error::ControlError;
use crate::evaluated::Evaluated;
use nastic_opt::{Failed, Objective, Request};
use nastic_team::{Team, TeamError};
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

impl Ensemble {
    /// Shares the members out over the ranks of a team, in ranges by number: each rank solves, and keeps the states and factors of, its own. All
    /// ranks have all problems, and must make the same calls in the same order with the same arguments; they get the same costs, derivatives
    /// and failures, the bits of one rank.
    ///
    /// `signal` is the flag of this rank that asks for an end, as in [`EnsembleBuilder::cancelled_by`](super::EnsembleBuilder::cancelled_by);
    /// `agreed` is raised on all ranks behind the same evaluation once one of them has its own raised.
    pub fn share_out(&mut self, team: Arc<dyn Team>, signal: Arc<AtomicBool>, agreed: Arc<AtomicBool>) {
        self.ranks = Ranks::new(team, self.members.len(), Some([signal, agreed]));
    }

    /// Shares the members out anew, in ranges that balance what they have taken, which all ranks have counted alike; whether any moves. Points
    /// from before must be saved and [loaded](Objective::load) then, and workspaces cleared: no bit depends on who has which members.
    pub fn share_anew(&self, work: &[usize]) -> bool {
        work.len() == self.members.len() && self.ranks.share_anew(work)
    }

    /// Why messages pass between the ranks no more, if so: every evaluation fails from then on.
    pub fn broken(&self) -> Option<&TeamError> {
        self.ranks.broken()
    }

    /// Whether this is the rank that speaks, and writes what belongs to no member.
    pub fn leads(&self) -> bool {
        self.ranks.team().leads()
    }

    /// What `of` makes of every member of a point, made where the member is, at all ranks.
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

    /// The point with all members, at the first rank: the others send it theirs, and wait for as long as it works with them. `None` elsewhere.
    ///
    /// # Errors
    /// [`EnsembleError::Team`].
    pub fn whole(&self, point: &EnsemblePoint) -> Result<Option<EnsemblePoint>, EnsembleError> {
        if point.is_whole() {
            return Ok(Some(point.clone()));
        }
        self.ranks.wait();
        let Some(members) = self.first_members(point, self.members.len())? else { return Ok(None) };
        Ok(Some(EnsemblePoint { members, held: Held::All, m: point.m.clone(), costs: point.costs.clone(), ..*point }))
    }

    /// The first members of a point, at the first rank; `None` elsewhere.
    ///
    /// # Errors
    /// [`EnsembleError::Team`].
    pub fn first_members(&self, point: &EnsemblePoint, count: usize) -> Result<Option<Vec<Evaluated>>, EnsembleError> {
        let count = count.min(self.members.len());
        let own: Vec<Evaluated> = point.held().take(count).map(|(_, at)| at.clone()).collect();
        // nothing is sent that is there
        if point.is_whole() || self.ranks.leader_owns(count) {
            return Ok(self.leads().then_some(own));
        }
        let bytes = |index: usize| point.member(index).map(Evaluated::to_bytes).unwrap_or_default();
        let Some(sent) = self.ranks.at_first(count, bytes)? else { return Ok(None) };
        let stage = own.first().map_or(0, |at| at.stage);
        let how = Request { stage, ..Request::default() };
        let first = own.len();
        let load = |(k, bytes): (usize, &Vec<u8>)| self.load_member(first + k, (&point.m, bytes), &how);
        let sent: Vec<Evaluated> = sent.par_iter().enumerate().with_max_len(1).map(load).collect::<Result<_, _>>()?;
        Ok(Some(own.into_iter().chain(sent).collect()))
    }

    fn load_member(
        &self,
        index: usize,
        (m, bytes): (&[f64], &[u8]),
        how: &Request<'_, Evaluated>,
    ) -> Result<Evaluated, EnsembleError> {
        let member = &self.members[index];
        let loaded = member.problem.load(&gather(&self.blocks, member, m), bytes, how);
        loaded.map_err(|failed| EnsembleError::member(&member.name, unloaded(&failed)))
    }

    /// The bytes of all members at the first rank; elsewhere nothing in the place of those of others. So too once messages pass no more: [`broken`](Self::broken).
    pub(super) fn bytes_of(&self, point: &EnsemblePoint) -> Vec<Vec<u8>> {
        let own = || point.held().map(|(index, at)| (index, at.to_bytes()));
        let mut out = vec![vec![]; self.members.len()];
        own().for_each(|(index, bytes)| out[index] = bytes);
        if !point.is_whole() {
            let first = self.ranks.own().len();
            let sent = self.ranks.at_first(self.members.len(), |index| out[index].clone());
            for (k, bytes) in sent.ok().flatten().into_iter().flatten().enumerate() {
                out[first + k] = bytes;
            }
        }
        out
    }

    /// The point of saved members, of which each rank reads its own; those that have moved to it are sent to it.
    pub(super) fn loaded(
        &self,
        m: &[f64],
        mut saved: Vec<Vec<u8>>,
        how: &Request<'_, EnsemblePoint>,
    ) -> Result<EnsemblePoint, EnsembleError> {
        self.ranks.complete(&mut saved)?;
        let how = Request { near: None, accuracy: how.accuracy, stage: how.stage, budget: how.budget };
        let load = |index: usize, member: &super::Member, _: &mut crate::ReducedWorkspace| {
            let loaded = member.problem.load(&gather(&self.blocks, member, m), &saved[index], &how);
            loaded.map_err(|failed| unloaded(&failed))
        };
        let found = self.side_by_side(&mut EnsembleWorkspace::default(), load, |_, at| MemberValues::of(at))?;
        self.joined(m, found)
    }
}

/// A saved member that does not fit.
fn unloaded(failed: &Failed) -> ControlError {
    match failed.downcast_ref::<ControlError>() {
        Some(error) => error.clone(),
        None => ControlError::Cost { what: failed.to_string() },
    }
}
