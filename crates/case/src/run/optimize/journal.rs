//! [`Journal`]: what an optimisation writes while it runs, and what of that could not be written.

use super::checkpoint::{self, Fixed};
use super::run_trials::RunTrials;
use crate::console::Console;
use crate::history::History;
use crate::result::checkpoint_file;
use crate::result::files::Directory;
use crate::run::case_record::CaseRecord;
use crate::run::error::RunError;
use crate::run::session::Session;
use nastic_opt::AugmentedState;
use serde_json::Value;

/// `history.jsonl` and `checkpoint.bin`. An optimisation does not end for a file that cannot be written: that is said at
/// once, and once more by the error at its end.
pub(super) struct Journal {
    out: Option<Directory>,
    console: Console,
    case: CaseRecord,
    history: Option<History>,
    /// [`Fixed`] of the present start, as bytes.
    fixed: Vec<u8>,
    index: usize,
    /// The last checkpoint that was written.
    written: Option<Written>,
    /// Why the last checkpoint could not be written.
    unsaved: Option<RunError>,
    /// The first other file that could not be written.
    failed: Option<RunError>,
}

/// A checkpoint on disk.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Written {
    /// Number of the start.
    pub start: usize,
    /// Its iteration.
    pub iteration: usize,
}

impl Journal {
    /// Writes the checkpoint before the start, in place of that of an earlier optimisation.
    ///
    /// # Errors
    /// It cannot be written: that is told before hours of work.
    pub fn begin(session: &Session<'_>) -> Result<Self, RunError> {
        let journal = Self::of(session, None);
        if let Some(out) = &journal.out {
            match session.problem.case.output.checkpoint {
                // What lies there belongs to results that are about to be replaced.
                0 => out.remove(checkpoint_file::NAME)?,
                _ => checkpoint_file::write(out, &checkpoint::before_the_start(&journal.case))?,
            }
        }
        Ok(journal)
    }

    /// Goes on from a checkpoint. That of an optimisation that had ended is one of an interrupted optimisation until it ends once more.
    ///
    /// # Errors
    /// That cannot be written.
    pub fn resume(session: &Session<'_>, from: Written) -> Result<Self, RunError> {
        let journal = Self::of(session, Some(from));
        if let Some(out) = &journal.out {
            checkpoint::record_end(out, false)?;
        }
        Ok(journal)
    }

    fn of(session: &Session<'_>, written: Option<Written>) -> Self {
        Self {
            out: session.out.clone(),
            console: session.console.clone(),
            case: CaseRecord::of(&session.problem, &session.settings),
            history: None,
            fixed: vec![],
            index: 0,
            written,
            unsaved: None,
            failed: None,
        }
    }

    /// Begins `history.jsonl` with lines of an earlier program, if any.
    pub fn open_history(&mut self, text: Vec<u8>) -> Result<(), RunError> {
        self.history = match &self.out {
            Some(out) => Some(History::create(&out.file("history.jsonl"), text)?),
            None => None,
        };
        Ok(())
    }

    /// Adds a line to `history.jsonl`.
    pub fn add_line(&mut self, line: &Value) {
        if let Some(Err(error)) = self.history.as_mut().map(|history| history.add(line)) {
            // The file is written once more at the end, which then has the last word.
            self.say(&error.into());
        }
    }

    /// From here on checkpoints are of this start.
    pub fn begin_start(&mut self, fixed: &Fixed) {
        (self.index, self.fixed) = (fixed.index, fixed.to_bytes());
    }

    /// Writes a scheduled checkpoint; if that fails the last good one stays.
    pub fn save(&mut self, run: &AugmentedState, trials: &RunTrials) {
        let Some(out) = &self.out else { return };
        let history = self.history.as_ref().map_or(&[] as &[u8], History::text);
        let content = checkpoint::of_run(&self.case, &self.fixed, history, trials, run);
        match checkpoint_file::write(out, &content) {
            Ok(()) => {
                self.written = Some(Written { start: self.index, iteration: run.run.progress.counts.iterations });
                self.unsaved = None;
            }
            Err(error) => {
                let (error, first) = (RunError::from(error), self.unsaved.is_none());
                if first {
                    self.say(&error);
                }
                self.unsaved = Some(error);
            }
        }
    }

    /// Notes another file that could not be written.
    pub fn note(&mut self, error: RunError) {
        if self.failed.is_none() {
            self.say(&error);
            self.failed = Some(error);
        }
    }

    /// The last checkpoint that was written.
    pub fn written(&self) -> Option<Written> {
        self.written
    }

    /// Ends `history.jsonl`.
    ///
    /// # Errors
    /// What could not be written, if anything.
    pub fn finish(self) -> Result<(), RunError> {
        self.history.map_or(Ok(()), History::finish)?;
        self.failed.or(self.unsaved).map_or(Ok(()), Err)
    }

    fn say(&self, error: &RunError) {
        let kept = match self.written {
            Some(Written { iteration, .. }) => format!("; the checkpoint of iteration {iteration} is kept"),
            None => String::new(),
        };
        self.console.say(format!("WARNING     {error}; the optimisation goes on and will end with exit code 7{kept}"));
    }
}
