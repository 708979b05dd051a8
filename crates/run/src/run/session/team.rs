//! A command on a team of ranks: what is shared out, and what the first rank is given of it.

use crate::run::error::RunError;
use crate::run::session::destination::Destination;
use crate::run::session::input::CommandInput;
use nastic_case::part::Share;
use nastic_control::ControlError;
use nastic_ensemble::EnsemblePoint;
use nastic_language::schema::Command;
use nastic_team::{Team, exchange};
use std::sync::Arc;

impl CommandInput {
    /// Joins the team of the options, if there is one: several starts are shared out over its ranks, else the members.
    pub fn join_team(&mut self) -> Result<(), RunError> {
        let Some(team) = self.options.team.clone().filter(|team| team.size() > 1) else { return Ok(()) };
        let is_divided = self.options.share != Share::Whole;
        if self.command != Command::Optimize || is_divided {
            let what = if is_divided { "a part, or what --join makes," } else { self.command.name() };
            return Err(RunError::OneRank { what: what.to_owned(), ranks: team.size() });
        }
        self.team = Some(team);
        if self.problem.case.optimizer.starts == 1 {
            // raised on all ranks at once, where that of this rank is looked at by its solves
            self.cancel = Arc::default();
        }
        self.share_members();
        Ok(())
    }

    /// Shares the members of the problem out, unless the starts are.
    pub fn share_members(&mut self) {
        if let (Some(team), false) = (&self.team, self.shares_starts()) {
            self.problem.ensemble.share_out(team.clone(), self.signal.clone(), self.cancel.clone());
        }
    }

    /// The team, where it shares out starts.
    pub fn team_of_starts(&self) -> Option<&dyn Team> {
        self.team.as_deref().filter(|_| self.shares_starts())
    }

    /// The team, where it shares out members.
    pub fn team_of_members(&self) -> Option<Arc<dyn Team>> {
        self.team.clone().filter(|_| !self.shares_starts())
    }

    fn shares_starts(&self) -> bool {
        self.team.is_some() && self.problem.case.optimizer.starts > 1
    }

    /// Which rank has the member of an error, in words; nothing where all members are on one.
    pub fn on_rank(&self, error: &ControlError) -> String {
        let here = || self.team_of_members().map(|team| team.rank());
        let rank = if let ControlError::Remote(failure) = error { Some(failure.rank) } else { here() };
        rank.map_or_else(String::new, |rank| format!(" on rank {rank}"))
    }

    /// Whether this rank speaks, and writes what belongs to all.
    pub fn leads(&self) -> bool {
        self.team.as_ref().is_none_or(|team| team.leads())
    }

    /// Whether this rank runs a start.
    pub fn has_start(&self, index: usize) -> bool {
        self.team_of_starts().is_none_or(|team| index % team.size() == team.rank())
    }

    /// Whether this rank writes what belongs to a start.
    pub fn writes_start(&self, index: usize) -> bool {
        if self.shares_starts() { self.has_start(index) } else { self.leads() }
    }

    /// Waits until all ranks are here: what the first has removed or read belongs to nobody else.
    pub fn meet(&self) -> Result<(), RunError> {
        self.team.as_deref().map_or(Ok(()), |team| Ok(exchange(team, vec![]).map(drop)?))
    }

    /// A point with all members at the first rank, nothing elsewhere.
    pub fn whole(&self, destination: &Destination, point: &EnsemblePoint) -> Result<Option<EnsemblePoint>, RunError> {
        let whole = self.problem.ensemble.whole(point).map_err(|error| destination.forward_failed(self, error))?;
        Ok(whole.filter(|_| self.leads() || self.shares_starts()))
    }
}
