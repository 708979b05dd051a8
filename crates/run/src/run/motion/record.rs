//! What is reported of the motion of one member.

use crate::result::summary::reactions;
use crate::run::motion::table;
use crate::run::motion::table::Table;
use nastic_case::lower::CaseMember;
use nastic_control::ControlError;
use nastic_fem::{State, Touch};
use nastic_report::record::{ByName, Number};

/// What is reported of the motion of one member: the table of all steps, and the states that are written.
pub(crate) struct Record {
    /// Index of the member.
    pub member: usize,
    /// Its control vector.
    pub m: Vec<f64>,
    is_shown: Vec<bool>,
    pub table: Option<Table>,
    pub shown: Vec<State>,
    /// What every contact carries in the last state.
    pub touches: Vec<(String, Touch)>,
    /// The forces of supports in the last state.
    pub reactions: Option<ByName<Vec<Number>>>,
    /// The last state that was reached: where the next step begins.
    pub last: Option<State>,
}

impl Record {
    /// Of a motion without a state.
    pub fn new(member: CaseMember<'_>, m: Vec<f64>) -> Self {
        let (time, timeline) = (member.case().time.as_ref(), member.reduced().timeline());
        let is_shown = time.zip(timeline).map_or_else(Vec::new, |(time, timeline)| time.shown(timeline.instants()));
        let (shown, touches) = (Vec::new(), Vec::new());
        Self { member: member.index(), m, is_shown, table: None, shown, touches, reactions: None, last: None }
    }

    /// The n-th state was reached.
    pub fn add(&mut self, member: CaseMember<'_>, n: usize, state: &State) -> Result<(), ControlError> {
        let table = self.table.get_or_insert_with(|| Table::head(member, state));
        table.add(member, &self.m, (self.last.as_ref(), state))?;
        self.touches = table::touches(member, self.last.as_ref(), state);
        self.reactions = Some(reactions(member, self.last.as_ref(), state));
        self.last = Some(state.clone());
        if self.is_shown.get(n) == Some(&true) {
            self.shown.push(state.clone());
        }
        Ok(())
    }

    /// The number of the last state, and its instant.
    pub fn reached(&self) -> Option<(usize, f64)> {
        let rows = &self.table.as_ref()?.rows;
        Some((rows.len() - 1, *rows.last()?.first()?))
    }

    /// The states so far.
    pub fn states(&self) -> usize {
        self.table.as_ref().map_or(0, |table| table.rows.len())
    }
}
