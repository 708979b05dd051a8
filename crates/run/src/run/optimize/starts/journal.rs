//! [`Journal`]: what an optimisation writes while it runs, and what of that could not be written.

use crate::console::Console;
use crate::history::{History, json_line};
use crate::run::error::RunError;
use crate::run::optimize::starts::start_run::{FinishedRun, PointBytes, StartRun};
use crate::run::session::CommandContext;
use crate::saved;
use crate::saved::blocks;
use crate::saved::case_record::CaseRecord;
use crate::saved::checkpoint::{Checkpoint, Place, Position, record_end};
use nastic_ensemble::Ensemble;
use nastic_io::write_atomically;
use nastic_opt::Saved;
use nastic_report::record::TrialRecord;
use nastic_result::files::Directory;
use nastic_team::{Team, broadcast};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// `history.jsonl` and `checkpoint.bin`. An optimisation does not end for a file that cannot be written: that is said at
/// once, and once more by the error at its end.
pub(crate) struct Journal {
    out: Option<Directory>,
    console: Console,
    /// As it is written next.
    checkpoint: Checkpoint,
    history: Option<History>,
    /// What an earlier program left, until a line comes that it has not: the file stays as it is so long.
    earlier: Option<Earlier>,
    /// Whether the lines of a round are written when it has ended: those of other ranks are not known before.
    at_the_end: bool,
    /// Where members are shared out over ranks: these, and where each of them writes its own.
    shared: Option<(Arc<dyn Team>, Option<Directory>)>,
    /// The set of files that has the points of the last checkpoint, and whether there is one.
    set: usize,
    has_blocks: bool,
    /// The last checkpoint that was written.
    written: Option<Place>,
    /// Why the last checkpoint could not be written.
    unsaved: Option<RunError>,
    /// The first other file that could not be written.
    failed: Option<RunError>,
    /// What a start that was stopped has kept of its iterations, until it is known whether that goes further than what is there.
    iterates: Vec<(Directory, String, Vec<u8>)>,
}

/// A journal to which starts that run side by side write.
#[derive(Clone)]
pub(crate) struct SharedJournal(Arc<Mutex<Journal>>);

/// A history that goes further than the checkpoint.
struct Earlier {
    /// Its lines up to the checkpoint, and those that were made again since.
    text: Vec<u8>,
    /// How many more it has.
    ahead: usize,
}

impl SharedJournal {
    pub fn new(journal: Journal) -> Self {
        Self(Arc::new(Mutex::new(journal)))
    }

    pub fn lock(&self) -> MutexGuard<'_, Journal> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Journal {
    /// Writes the checkpoint before the start, in place of that of an earlier optimisation.
    ///
    /// # Errors
    /// It cannot be written: that is reported before hours of work.
    pub fn begin(context: CommandContext<'_>) -> Result<Self, RunError> {
        let journal = Self::of(context, None);
        if let Some(out) = &journal.out {
            match context.input.problem.case.output.checkpoint {
                // What lies there belongs to results that are about to be replaced.
                0 => out.remove(saved::NAME)?,
                _ => saved::write(out, saved::NAME, &journal.checkpoint.to_bytes())?,
            }
            blocks::remove(out);
        }
        Ok(journal)
    }

    /// Goes on from a checkpoint. That of an optimisation that had ended is one of an interrupted optimisation until it ends once more.
    ///
    /// # Errors
    /// That cannot be written.
    pub fn resume(context: CommandContext<'_>, from: &Position) -> Result<Self, RunError> {
        let mut journal = Self::of(context, Some(from.place()));
        if let Some(blocks) = &from.blocks {
            (journal.set, journal.has_blocks) = (blocks.set, true);
        }
        if let Some(out) = &journal.out {
            record_end(out, false)?;
        }
        Ok(journal)
    }

    fn of(context: CommandContext<'_>, written: Option<Place>) -> Self {
        let CommandContext { input, destination, console } = context;
        Self {
            out: destination.out.clone(),
            console: console.clone(),
            checkpoint: Checkpoint {
                case: CaseRecord::of(&input.problem, &input.options.set),
                command: input.command.name().to_owned(),
                position: None,
                ended: false,
            },
            history: None,
            earlier: None,
            at_the_end: input.team_of_starts().is_some(),
            shared: input.team_of_members().map(|team| (team, destination.own_out.clone())),
            set: 1,
            has_blocks: false,
            written,
            unsaved: None,
            failed: None,
            iterates: Vec::new(),
        }
    }

    /// Begins `history.jsonl` with lines of an earlier program, if any, behind which new ones come.
    pub fn open_history(&mut self, text: Vec<u8>) -> Result<(), RunError> {
        if self.written.is_none() {
            return self.create_history(text);
        }
        let there = self.out.as_ref().and_then(|out| std::fs::read(out.file("history.jsonl")).ok());
        let beyond = there.as_ref().and_then(|there| there.strip_prefix(text.as_slice()));
        let Some(beyond) = beyond else { return self.create_history(text) };
        self.earlier = Some(Earlier { ahead: lines_in(beyond), text });
        Ok(())
    }

    /// Whether an earlier program had gone further than this one has come so far.
    pub fn is_behind(&self) -> bool {
        self.earlier.as_ref().is_some_and(|earlier| earlier.ahead > 0)
    }

    fn create_history(&mut self, text: Vec<u8>) -> Result<(), RunError> {
        self.history = match &self.out {
            Some(out) => Some(History::create(&out.own("history.jsonl")?, text)?),
            None => None,
        };
        Ok(())
    }

    /// Adds a line to `history.jsonl`.
    pub fn add_line(&mut self, line: &TrialRecord) {
        self.add_lines(&json_line(line));
    }

    /// Adds lines as they come, unless those of a round are added together.
    pub fn add_lines(&mut self, lines: &[u8]) {
        if !self.at_the_end {
            self.add_recorded(lines);
        }
    }

    /// Adds lines that another rank or an earlier program made.
    pub fn add_recorded(&mut self, lines: &[u8]) {
        if let Some(earlier) = &mut self.earlier
            && let Some(ahead) = earlier.ahead.checked_sub(lines_in(lines))
        {
            earlier.text.extend(lines);
            earlier.ahead = ahead;
            return;
        }
        if let Some(Err(error)) = self.earlier.take().map(|earlier| self.create_history(earlier.text)) {
            self.note(error);
        }
        if let Some(Err(error)) = self.history.as_mut().map(|history| history.add(lines)) {
            // The file is written once more at the end, which then has the last word.
            self.say(&error.into());
        }
    }

    /// A round of starts begins at a position: from here on checkpoints hold these.
    pub fn begin_round(&mut self, position: Position) {
        let history = self.history_text().to_vec();
        self.checkpoint.position = Some(Position { history, ..position });
    }

    fn position(&mut self) -> &mut Position {
        self.checkpoint.position.get_or_insert_default()
    }

    /// A start of the round has ended; `best`: it is the best so far. It goes into the next checkpoint.
    pub fn end_start(&mut self, start: &StartRun, best: Option<(usize, FinishedRun<PointBytes>)>) {
        let position = self.position();
        position.starts[start.index] = start.saved();
        if best.is_some() {
            position.best = best;
        }
    }

    /// Writes a scheduled checkpoint of a start under way.
    pub fn save_start(&mut self, start: StartRun, ensemble: &Ensemble) {
        let index = start.index;
        self.position().starts[index] = start;
        self.save(ensemble);
    }

    /// Writes a scheduled checkpoint; if that fails the last good one stays. Where members are shared out all ranks call it together.
    pub fn save(&mut self, ensemble: &Ensemble) {
        let saved = match self.shared.clone() {
            Some((team, Some(own))) => self.save_in_blocks(ensemble, team.as_ref(), &own),
            _ => self.save_whole(),
        };
        match saved {
            Ok(true) => {
                self.written = self.checkpoint.position.as_ref().map(Position::place);
                self.unsaved = None;
            }
            Ok(false) => {}
            Err(error) => {
                if self.unsaved.is_none() {
                    self.say(&error);
                }
                self.unsaved = Some(error);
            }
        }
    }

    /// All in one file; whether it was written.
    fn save_whole(&mut self) -> Result<bool, RunError> {
        let Some(out) = &self.out else { return Ok(false) };
        saved::write(out, saved::NAME, &self.checkpoint.to_bytes())?;
        if std::mem::take(&mut self.has_blocks) {
            blocks::remove(out);
        }
        Ok(true)
    }

    /// The points by all ranks, what belongs to all by the first one.
    fn save_in_blocks(&mut self, ensemble: &Ensemble, team: &dyn Team, own: &Directory) -> Result<bool, RunError> {
        let set = 1 - self.set;
        let points: Vec<Vec<u8>> = self.position().points().map(std::mem::take).collect();
        let written = blocks::write(ensemble, team, own, &points, set);
        let written = written.map(|blocks| {
            self.position().blocks = Some(blocks);
            let out = self.out.as_ref();
            out.map_or(Ok(()), |out| saved::write(out, saved::NAME, &self.checkpoint.to_bytes()))
        });
        let position = self.position();
        position.blocks = None;
        position.points().zip(points).for_each(|(place, point)| *place = point);
        let written = written?;
        // the next one may replace the files of the set that counts no more
        let counts = broadcast(team, vec![u8::from(written.is_ok())])? == [1];
        written?;
        if counts {
            self.set = set;
        }
        Ok(counts)
    }

    /// Notes another file that could not be written.
    pub fn note(&mut self, error: RunError) {
        if self.failed.is_none() {
            self.say(&error);
            self.failed = Some(error);
        }
    }

    /// Writes the kept iterations of a start that has ended; of one that was stopped when [that is to be](Self::write_iterates).
    pub fn keep_iterates(&mut self, out: &Directory, name: String, bytes: Vec<u8>, stopped: bool) {
        self.iterates.push((out.clone(), name, bytes));
        if !stopped {
            self.write_iterates();
        }
    }

    /// Writes those that wait.
    pub fn write_iterates(&mut self) {
        for (out, name, bytes) in std::mem::take(&mut self.iterates) {
            let written = out.own(&name).and_then(|file| write_atomically(file, |out| out.write_all(&bytes)));
            if let Err(error) = written {
                self.note(error.into());
            }
        }
    }

    /// The last checkpoint that was written.
    pub fn written(&self) -> Option<Place> {
        self.written
    }

    fn history_text(&self) -> &[u8] {
        let earlier = self.earlier.as_ref().map(|earlier| earlier.text.as_slice()).unwrap_or_default();
        self.history.as_ref().map_or(earlier, History::text)
    }

    /// Ends `history.jsonl`. `interrupted`: lines of an earlier program that go further stay.
    ///
    /// # Errors
    /// What could not be written, if anything.
    pub fn finish(&mut self, interrupted: bool) -> Result<(), RunError> {
        if !(interrupted && self.is_behind())
            && let Some(earlier) = self.earlier.take()
        {
            self.create_history(earlier.text)?;
        }
        self.history.take().map_or(Ok(()), History::finish)?;
        self.failed.take().or(self.unsaved.take()).map_or(Ok(()), Err)
    }

    fn say(&self, error: &RunError) {
        let kept = match self.written {
            Some(Place { iteration, .. }) => format!("; the checkpoint of iteration {iteration} is kept"),
            None => String::new(),
        };
        self.console.say(format!("WARNING     {error}; the optimisation goes on and will end with exit code 7{kept}"));
    }
}

fn lines_in(text: &[u8]) -> usize {
    text.iter().filter(|byte| **byte == b'\n').count()
}
