//! [`Recorder`]: what is reported of the motions of a `solve` while they run, and the checkpoints they leave.

use crate::console::Console;
use crate::run::error::RunError;
use crate::run::motion::record::Record;
use crate::run::motion::table::Table;
use crate::run::session::CommandContext;
use crate::saved::case_record::CaseRecord;
use crate::saved::motion_checkpoint::{MotionCheckpoint, SavedMotion, unfit};
use nastic_case::lower::{CaseMember, CaseProblem};
use nastic_control::{AdaptiveSteps, ControlError, MotionObserver, Timeline};
use nastic_fem::State;
use nastic_result::files::Directory;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Checkpoints are at least this far apart, and this many times as far as writing one takes. When they are written changes no result.
const APART: Duration = Duration::from_secs(2);
const TIMES: u32 = 20;

/// The motions of all members.
pub(super) struct Recorder<'a> {
    problem: &'a CaseProblem,
    console: &'a Console,
    out: Option<&'a Directory>,
    case: CaseRecord,
    steps: &'a [AdaptiveSteps],
    members: Vec<Mutex<Recorded>>,
    pace: Mutex<Pace>,
}

/// The motion of a member.
struct Recorded {
    record: Record,
    /// From where the motion is to go on.
    from: Option<Vec<u8>>,
    /// The last place from which it can.
    place: Option<ResumePoint>,
    /// What an earlier program found behind the place that this one goes on from, until this one is there.
    ahead: Option<Ahead>,
}

/// A motion as far as it came before.
struct Ahead {
    rows: Vec<Vec<f64>>,
    shown: Vec<State>,
    end: State,
}

/// A place from which a motion can go on.
struct ResumePoint {
    n: usize,
    motion: Vec<u8>,
    /// The state there, and the one before it.
    last: Option<State>,
    before: Option<State>,
    /// States to write that there were.
    shown: usize,
}

struct Pace {
    /// When the last checkpoint was written, and how long that took.
    last: Option<(Instant, Duration)>,
    /// Whether it was said that one could not be.
    failed: bool,
}

/// The observer of one member.
pub(super) struct MemberObserver<'a> {
    all: &'a Recorder<'a>,
    index: usize,
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl<'a> Recorder<'a> {
    /// Of motions at the start controls that begin, or go on from a checkpoint.
    ///
    /// # Errors
    /// A checkpoint that does not fit.
    pub fn new(
        CommandContext { input, destination, console }: CommandContext<'a>,
        steps: &'a [AdaptiveSteps],
        from: Option<MotionCheckpoint>,
    ) -> Result<Self, RunError> {
        let problem = &input.problem;
        let mut saved = from.map(|checkpoint| checkpoint.members.into_iter());
        let mut members = Vec::new();
        for member in problem.members() {
            let record = Record::new(member, member.local(&problem.start));
            let mut recorded = Recorded { record, from: None, place: None, ahead: None };
            if let Some(saved) = &mut saved {
                let unfit = |what: &str| unfit(destination.out.as_ref(), what);
                let saved = saved.next().ok_or_else(|| unfit("another number of members"))?;
                if let Some(saved) = saved {
                    recorded.take(member, saved).map_err(|what| unfit(&what))?;
                }
            }
            members.push(Mutex::new(recorded));
        }
        Ok(Self {
            problem,
            console,
            out: destination.out.as_ref(),
            case: CaseRecord::of(problem, &input.options.set),
            steps,
            members,
            pace: Mutex::new(Pace { last: None, failed: false }),
        })
    }

    pub fn observers(&'a self) -> Vec<MemberObserver<'a>> {
        (0..self.members.len()).map(|index| MemberObserver { all: self, index }).collect()
    }

    /// What was found, also by an earlier program behind the end of this one, with the last state of every motion among those to write.
    pub fn finish(self) -> Vec<Record> {
        let own = |recorded: Mutex<Recorded>| {
            let mut recorded = recorded.into_inner().unwrap_or_else(PoisonError::into_inner);
            recorded.add_ahead();
            let mut record = recorded.record;
            let last = record.last.clone();
            record.shown.extend(last.filter(|last| record.shown.last().is_none_or(|shown| shown.time < last.time)));
            record
        };
        self.members.into_iter().map(own).collect()
    }

    /// By member how many steps come again where the motion goes on from its last place.
    pub fn repeated(&self) -> Vec<usize> {
        self.members.iter().map(|recorded| lock(recorded).repeated()).collect()
    }

    /// Writes a checkpoint of the last places, if any member has one; whether it is there.
    pub fn save(&self) -> bool {
        let Some(out) = self.out else { return false };
        let members: Vec<Option<SavedMotion>> = self.members.iter().map(|recorded| lock(recorded).saved()).collect();
        if members.iter().all(Option::is_none) {
            return false;
        }
        let steps = self.steps.to_vec();
        let checkpoint = MotionCheckpoint { case: self.case.clone(), steps, members };
        let written = checkpoint.write(out);
        if let Err(error) = &written
            && !std::mem::replace(&mut lock(&self.pace).failed, true)
        {
            self.console.say(format!("WARNING     {error}; the motion goes on without this checkpoint"));
        }
        written.is_ok()
    }

    fn save_if_due(&self) {
        let due = |pace: &Pace| pace.last.is_none_or(|(last, took)| last.elapsed() >= APART.max(TIMES * took));
        if !due(&lock(&self.pace)) {
            return;
        }
        let began = Instant::now();
        // without one there is nothing to go on from, and the next place is asked again
        if self.save() || lock(&self.pace).failed {
            lock(&self.pace).last = Some((Instant::now(), began.elapsed()));
        }
    }
}

impl Recorded {
    /// Goes on from what was saved.
    fn take(&mut self, member: CaseMember<'_>, saved: SavedMotion) -> Result<(), String> {
        let SavedMotion { n, motion, mut rows, shown, shown_before, last, before, end } = saved;
        let like = member.solid().rest();
        if [&last, &end].into_iter().chain(&before).chain(&shown).any(|state| !state.fits(&like)) {
            return Err("a state of another body".to_owned());
        }
        let first = shown.first().ok_or("no state of the motion")?;
        let mut table = Table::head(member, first);
        if rows.iter().any(|row| row.len() != table.columns()) {
            return Err("another table of the motion".to_owned());
        }
        if rows.len() > n + 1 {
            self.ahead = Some(Ahead { rows: rows.clone(), shown: shown.clone(), end });
        }
        rows.truncate(n + 1);
        table.rows = rows;
        let shown = shown.into_iter().take(shown_before).collect();
        let (of_place, before_it) = (Some(last.clone()), before.clone());
        self.place =
            Some(ResumePoint { n, motion: motion.clone(), last: of_place, before: before_it, shown: shown_before });
        (self.record.table, self.record.shown) = (Some(table), shown);
        (self.record.last, self.record.before) = (Some(last), before);
        self.from = Some(motion);
        Ok(())
    }

    /// Makes this the last place.
    fn note_place(&mut self, n: usize, motion: Vec<u8>) {
        let Record { last, before, shown, .. } = &self.record;
        self.place = Some(ResumePoint { n, motion, last: last.clone(), before: before.clone(), shown: shown.len() });
    }

    /// The last place, as it is saved, with all that was found behind it.
    fn saved(&self) -> Option<SavedMotion> {
        let (place, table) = (self.place.as_ref()?, self.record.table.as_ref()?);
        let ahead = self.ahead.iter();
        Some(SavedMotion {
            n: place.n,
            motion: place.motion.clone(),
            rows: table
                .rows
                .iter()
                .chain(ahead.flat_map(|ahead| ahead.rows.iter().skip(table.rows.len())))
                .cloned()
                .collect(),
            shown: self.record.shown.iter().chain(self.shown_ahead()).cloned().collect(),
            shown_before: place.shown,
            last: place.last.clone()?,
            before: place.before.clone(),
            end: self.ahead.as_ref().map(|ahead| &ahead.end).or(self.record.last.as_ref())?.clone(),
        })
    }

    /// States to write behind the last that was found now.
    fn shown_ahead(&self) -> impl Iterator<Item = &State> {
        let time = self.record.last.as_ref().map_or(f64::NEG_INFINITY, |last| last.time);
        self.ahead.iter().flat_map(|ahead| &ahead.shown).filter(move |state| state.time > time)
    }

    /// Adds what was found behind the end.
    fn add_ahead(&mut self) {
        let more: Vec<State> = self.shown_ahead().cloned().collect();
        let (Some(ahead), Some(table)) = (self.ahead.take(), &mut self.record.table) else { return };
        self.record.shown.extend(more);
        table.rows.extend(ahead.rows.into_iter().skip(table.rows.len()).collect::<Vec<_>>());
        self.record.last = Some(ahead.end);
    }

    fn repeated(&self) -> usize {
        let rows = self.ahead.as_ref().map_or(0, |ahead| ahead.rows.len()).max(self.record.states());
        self.place.as_ref().map_or(0, |place| rows.saturating_sub(place.n + 1))
    }
}

impl MotionObserver for MemberObserver<'_> {
    fn resume(&self) -> Option<Vec<u8>> {
        lock(&self.all.members[self.index]).from.take()
    }

    fn reached(&self, n: usize, state: &State) -> Result<(), ControlError> {
        {
            let mut recorded = lock(&self.all.members[self.index]);
            recorded.record.add(self.all.problem.member(self.index), n, state)?;
            let states = recorded.record.states();
            recorded.ahead.take_if(|ahead| ahead.rows.len() <= states);
        }
        self.all.save_if_due();
        Ok(())
    }

    fn resumable(&self, n: usize, bytes: &dyn Fn() -> Vec<u8>) {
        if self.all.out.is_none() {
            return;
        }
        // what is reported of the last state depends on the step that leads there, which is therefore made again
        let end = self.all.problem.member(self.index).reduced().timeline().map(Timeline::steps);
        if end != Some(n) {
            lock(&self.all.members[self.index]).note_place(n, bytes());
        }
        self.all.save_if_due();
    }
}
