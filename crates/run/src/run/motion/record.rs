//! What is reported of the motion of one member.

use crate::run::motion::table;
use crate::run::motion::table::Table;
use nastic_case::lower::CaseMember;
use nastic_control::ControlError;
use nastic_fem::{EnergyBalance, EnergyLedger, State, Touch};
use nastic_report::record::{ByName, Number};
use nastic_result::summary::reactions;

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
    /// The one before it.
    pub before: Option<State>,
    ledger: Option<EnergyLedger>,
}

impl Record {
    /// Of a motion without a state.
    pub fn new(member: CaseMember<'_>, m: Vec<f64>) -> Self {
        let (time, timeline) = (member.case().time.as_ref(), member.reduced().timeline());
        let is_shown = time.zip(timeline).map_or_else(Vec::new, |(time, timeline)| time.shown(timeline.instants()));
        let (shown, touches) = (Vec::new(), Vec::new());
        let (table, reactions, last, before, ledger) = (None, None, None, None, None);
        Self { member: member.index(), m, is_shown, table, shown, touches, reactions, last, before, ledger }
    }

    /// The n-th state was reached.
    pub fn add(&mut self, member: CaseMember<'_>, n: usize, state: &State) -> Result<(), ControlError> {
        let balance = self.balance(member, state)?;
        let table = self.table.get_or_insert_with(|| Table::head(member, state));
        table.add(member, &self.m, self.last.as_ref(), state, balance)?;
        self.touches = table::touches(member, self.last.as_ref(), state);
        self.reactions = Some(reactions(member, self.last.as_ref(), state));
        self.before = self.last.replace(state.clone());
        if self.is_shown.get(n) == Some(&true) {
            self.shown.push(state.clone());
        }
        Ok(())
    }

    /// The balance of energy at the next state; of a motion that goes on from a checkpoint by what was written down there.
    fn balance(&mut self, member: CaseMember<'_>, state: &State) -> Result<Option<EnergyBalance>, ControlError> {
        let (model, Some(timeline)) = (member.solid().model(), member.reduced().timeline()) else { return Ok(None) };
        let ledger = match &mut self.ledger {
            Some(ledger) => ledger,
            none => {
                let mut ledger = EnergyLedger::new(model, timeline.scheme(), &state.controls)?;
                if let (Some(last), Some(balance)) = (&self.last, self.table.as_ref().and_then(Table::last_balance)) {
                    ledger.go_on(model, self.before.as_ref(), last, balance)?;
                }
                none.insert(ledger)
            }
        };
        Ok(Some(ledger.add(model, state)?))
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
