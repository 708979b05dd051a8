//! Internal variables of the body and of all contributions: those of a step, their evolution, and its transpose.

use super::Model;
use crate::model::views::InternalVariables;
use nastic_body::error::Inadmissible;
use nastic_body::history::{BeforeStep, History, Remembers};
use nastic_body::instant::Instant;
use nastic_body::state::State;

impl Model {
    /// All internal variables, zero.
    pub(crate) fn zero_history(&self) -> History {
        let of_others = self.others.iter().map(|c| c.remembers().map_or(0, Remembers::len));
        History::zeros(self.body.memory().chain(of_others.map(|len| (usize::from(len > 0), len))))
    }
}

impl InternalVariables<'_> {
    /// Whether anything has internal variables.
    pub fn has_history(&self) -> bool {
        self.model.body.has_history() || self.model.others.iter().any(|c| c.remembers().is_some())
    }

    /// Number of internal variables.
    pub fn internal_variables(&self) -> usize {
        let history = self.model.zero_history();
        (0..history.len()).map(|k| history.values(k).len()).sum()
    }

    /// The internal variables that the step behind a state begins with.
    pub fn next_history(&self, state: &State, parallel: bool) -> Result<History, Inadmissible> {
        if !self.has_history() {
            return Ok(History::default());
        }
        let mut next = self.model.zero_history();
        let at = Instant { parallel, ..Instant::of(state) };
        let zero = at.history().is_empty().then(|| next.clone());
        let at = Instant { remembered: zero.as_ref().unwrap_or(at.history()), ..at };
        self.model.body.advance(&at, &mut next)?;
        self.model.each_other(&at, |contribution, at| {
            if let Some(memory) = contribution.remembers() {
                memory.advance(at, next.values_mut(at.memory));
            }
            Ok::<(), Inadmissible>(())
        })?;
        Ok(next)
    }

    /// Internal variables at the beginning of a step of this length.
    pub fn history_of_step(&self, history: &History, dt: f64) -> History {
        let mut out = history.clone();
        out.dt = dt;
        self.model.body.set_step(dt, &mut out);
        out
    }

    /// The transpose of [`next_history`](Self::next_history): the derivatives by the state that follow from those by its internal variables.
    pub fn history_vjp(&self, state: &State, by_next: &History) -> Result<BeforeStep, Inadmissible> {
        let zero = self.model.zero_history();
        let mut into =
            BeforeStep { u: vec![0.0; state.u.len()], controls: self.model.zero_controls(), history: zero.clone() };
        let at = Instant::of(state);
        let at = Instant { remembered: if at.history().is_empty() { &zero } else { at.history() }, ..at };
        self.model.body.advance_vjp(&at, by_next, &mut into)?;
        self.model.each_other(&at, |contribution, at| {
            if let Some(memory) = contribution.remembers() {
                memory.advance_vjp(at, by_next.values(at.memory), &mut into);
            }
            Ok::<(), Inadmissible>(())
        })?;
        Ok(into)
    }
}
