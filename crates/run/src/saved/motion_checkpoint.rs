//! [`MotionCheckpoint`]: everything that a `solve` of a motion needs to go on to the bit.

use crate::run::error::RunError;
use crate::saved::case_record::CaseRecord;
use crate::saved::{CheckpointError, read_value, write};
use nastic_control::AdaptiveSteps;
use nastic_fem::State;
use nastic_io::WriteError;
use nastic_opt::Saved;
use nastic_result::files::Directory;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// The file's name: beside that of an optimisation, which it leaves alone.
pub(crate) const NAME: &str = "motion_checkpoint.bin";

/// The content of the file.
#[derive(Serialize, Deserialize)]
pub(crate) struct MotionCheckpoint {
    pub case: CaseRecord,
    /// Time steps that were found for a tolerance, of every member; empty without.
    pub steps: Vec<AdaptiveSteps>,
    /// Nothing of those whose motion had not begun.
    pub members: Vec<Option<SavedMotion>>,
}

/// The motion of a member.
#[derive(Serialize, Deserialize)]
pub(crate) struct SavedMotion {
    /// The number of the state that it goes on from.
    pub n: usize,
    /// What the library wrote there.
    pub motion: Vec<u8>,
    /// The table, of steps too that come again.
    pub rows: Vec<Vec<f64>>,
    /// The states to write, of such steps too.
    pub shown: Vec<State>,
    /// How many of them are no later than the state that it goes on from.
    pub shown_before: usize,
    /// The state that it goes on from.
    pub last: State,
    /// The state before it, if there is one.
    pub before: Option<State>,
    /// The last state of all.
    pub end: State,
}

impl Saved for MotionCheckpoint {
    const KIND: &'static str = "nastic-motions-5";
}

impl MotionCheckpoint {
    /// Of every member the number of the state that it goes on from.
    pub fn places(&self) -> Vec<usize> {
        self.members.iter().map(|member| member.as_ref().map_or(0, |member| member.n)).collect()
    }

    /// Of every member the number of the last state that was reached.
    pub fn reached(&self) -> Vec<usize> {
        self.members.iter().map(|member| member.as_ref().map_or(0, |member| member.rows.len() - 1)).collect()
    }

    /// Writes it to a directory; the earlier one stays until this one is complete.
    pub fn write(&self, out: &Directory) -> Result<(), WriteError> {
        write(out, NAME, &self.to_bytes())
    }

    /// That of a directory.
    pub fn read(directory: &Path) -> Result<Self, CheckpointError> {
        let found: Self = read_value(directory, NAME)?;
        let fits = |member: &SavedMotion| {
            member.n < member.rows.len() && (1..=member.shown.len()).contains(&member.shown_before)
        };
        match found.members.iter().flatten().all(fits) {
            true => Ok(found),
            false => {
                let what = "a motion that goes on behind its end".to_owned();
                Err(CheckpointError::Content { file: directory.join(NAME), what })
            }
        }
    }
}

/// The error of a checkpoint that is whole but not of this case.
pub(crate) fn unfit(out: Option<&Directory>, what: &str) -> RunError {
    let file = out.map(|out| out.file(NAME)).unwrap_or_default();
    CheckpointError::Content { file, what: what.to_owned() }.into()
}
