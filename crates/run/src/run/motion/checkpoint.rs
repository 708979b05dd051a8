//! [`MotionCheckpoint`]: everything that a `solve` of a motion needs to go on to the bit.

use crate::result::checkpoint_file;
use crate::result::checkpoint_file::CheckpointError;
use crate::result::files::Directory;
use crate::run::case_record::CaseRecord;
use crate::run::error::RunError;
use nastic_control::AdaptiveSteps;
use nastic_fem::AdaptiveReport;
use nastic_io::WriteError;
use nastic_opt::SavedRunError;
use nastic_opt::bytes::{Reader, Writer};
use std::path::Path;

/// The file's name: beside that of an optimisation, which it leaves alone.
pub(in crate::run) const NAME: &str = "motion_checkpoint.bin";

const MAGIC: &str = "nastic-motions-4";

/// The content of the file.
pub(in crate::run) struct MotionCheckpoint {
    pub case: CaseRecord,
    /// Time steps that were found for a tolerance, of every member; empty without.
    pub steps: Vec<AdaptiveSteps>,
    /// Nothing of those whose motion had not begun.
    pub(super) members: Vec<Option<SavedMember>>,
}

/// The motion of a member.
pub(super) struct SavedMember {
    /// The number of the state that it goes on from.
    pub n: usize,
    /// What the library wrote there.
    pub motion: Vec<u8>,
    /// The table, of steps too that come again.
    pub rows: Vec<Vec<f64>>,
    /// The states to write, as bytes, of such steps too.
    pub shown: Vec<Vec<u8>>,
    /// How many of them are no later than the state that it goes on from.
    pub shown_before: usize,
    /// The state that it goes on from.
    pub last: Vec<u8>,
    /// The state before it, if there is one.
    pub before: Option<Vec<u8>>,
    /// The last state of all.
    pub end: Vec<u8>,
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
        checkpoint_file::write(out, NAME, &self.to_bytes())
    }

    /// That of a directory.
    pub fn read(directory: &Path) -> Result<Self, CheckpointError> {
        let content = checkpoint_file::read(directory, NAME)?;
        let unfit =
            |error: SavedRunError| CheckpointError::Content { file: directory.join(NAME), what: error.to_string() };
        Self::from_bytes(&content).map_err(unfit)
    }

    fn to_bytes(&self) -> Vec<u8> {
        let mut out = Writer::new(MAGIC);
        out.bytes(&self.case.to_bytes());
        out.count(self.steps.len());
        for AdaptiveSteps { instants, report: AdaptiveReport { accepted, rejected, failed } } in &self.steps {
            out.floats(instants);
            [accepted, rejected, failed].into_iter().for_each(|n| out.count(*n));
        }
        out.count(self.members.len());
        for member in &self.members {
            out.count(usize::from(member.is_some()));
            let Some(SavedMember { n, motion, rows, shown, shown_before, last, before, end }) = member else {
                continue;
            };
            out.count(*n);
            out.bytes(motion);
            out.count(rows.len());
            rows.iter().for_each(|row| out.floats(row));
            out.count(shown.len());
            shown.iter().for_each(|state| out.bytes(state));
            out.count(*shown_before);
            out.bytes(last);
            out.count(usize::from(before.is_some()));
            before.iter().for_each(|state| out.bytes(state));
            out.bytes(end);
        }
        out.finish()
    }

    fn from_bytes(bytes: &[u8]) -> Result<Self, SavedRunError> {
        let mut input = Reader::new(bytes, MAGIC)?;
        let case = CaseRecord::from_bytes(&input.list()?)?;
        let mut steps = Vec::new();
        for _ in 0..input.count(8)? {
            let instants = input.floats()?;
            let (accepted, rejected, failed) = (input.number()?, input.number()?, input.number()?);
            steps.push(AdaptiveSteps { instants, report: AdaptiveReport { accepted, rejected, failed } });
        }
        let mut members = Vec::new();
        for _ in 0..input.count(8)? {
            if !input.flag()? {
                members.push(None);
                continue;
            }
            let (n, motion) = (input.number()?, input.list()?);
            let rows = (0..input.count(8)?).map(|_| input.floats()).collect::<Result<Vec<_>, _>>()?;
            let shown = (0..input.count(8)?).map(|_| input.list()).collect::<Result<Vec<_>, _>>()?;
            let (shown_before, last) = (input.number()?, input.list()?);
            let before = if input.flag()? { Some(input.list()?) } else { None };
            let end = input.list()?;
            if n >= rows.len() || shown_before > shown.len() || shown_before == 0 {
                return Err(input.damaged("a motion that goes on behind its end"));
            }
            members.push(Some(SavedMember { n, motion, rows, shown, shown_before, last, before, end }));
        }
        input.finish()?;
        Ok(Self { case, steps, members })
    }
}

/// The error of a checkpoint that is whole but not of this case.
pub(super) fn unfit(out: Option<&Directory>, what: &str) -> RunError {
    let file = out.map(|out| out.file(NAME)).unwrap_or_default();
    CheckpointError::Content { file, what: what.to_owned() }.into()
}
