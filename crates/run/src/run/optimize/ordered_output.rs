//! [`OrderedOutput`]: what several starts say at once, in the order of the starts.

use crate::console::Console;
use crate::run::optimize::starts::journal::SharedJournal;
use nastic_report::OnTrial;
use nastic_report::record::TrialRecord;
use std::io::Write;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Lines of the terminal and of `history.jsonl` from starts that run side by side. The first one that has not ended its round speaks at
/// once, those behind it are kept until it is their turn: the order of lines does not depend on which start is faster.
#[derive(Clone)]
pub(super) struct OrderedOutput {
    state: Arc<Mutex<State>>,
}

struct State {
    console: Console,
    on_trial: OnTrial,
    journal: SharedJournal,
    parts: Vec<Part>,
    /// Number of the part that speaks.
    speaking: usize,
    /// Whether several run at once: a passing line then reports them together.
    several: bool,
}

/// What one start has to say.
struct Part {
    start: usize,
    kept: Vec<Event>,
    iteration: Option<usize>,
    ended: bool,
}

enum Event {
    /// On the terminal.
    Say(String),
    /// A trial's line of `history.jsonl`.
    Trial(Box<TrialRecord>),
    /// Such lines of an earlier program, which were reported there.
    Recorded(Vec<u8>),
}

/// The part of one start.
#[derive(Clone)]
pub(super) struct StartOutput {
    output: OrderedOutput,
    part: usize,
    /// Where its lines for people go.
    pub console: Console,
}

impl OrderedOutput {
    /// For a round of these starts, `at_once` of them at a time.
    pub fn new(
        console: &Console,
        on_trial: &OnTrial,
        journal: &SharedJournal,
        starts: &[usize],
        at_once: usize,
    ) -> Self {
        let part = |start: &usize| Part { start: *start, kept: vec![], iteration: None, ended: false };
        let state = State {
            console: console.clone(),
            on_trial: on_trial.clone(),
            journal: journal.clone(),
            parts: starts.iter().map(part).collect(),
            speaking: 0,
            several: at_once > 1,
        };
        Self { state: Arc::new(Mutex::new(state)) }
    }

    /// The place of one of the starts, by its position among them.
    pub fn part(&self, part: usize) -> StartOutput {
        let writer = LineWriter { output: self.clone(), part, line: vec![] };
        let console = {
            let state = self.lock();
            if state.several { Console::new(writer) } else { state.console.with_lines(writer) }
        };
        StartOutput { output: self.clone(), part, console }
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl StartOutput {
    /// A trial's line of `history.jsonl`, which goes to listeners.
    pub fn add_line(&self, line: TrialRecord) {
        self.output.lock().add(self.part, Event::Trial(Box::new(line)));
    }

    /// Lines of `history.jsonl` that an earlier program made.
    pub fn add_recorded(&self, lines: &[u8]) {
        if lines.is_empty() {
            return;
        }
        self.output.lock().add(self.part, Event::Recorded(lines.to_vec()));
    }

    /// Whether others run at the same time.
    pub fn is_one_of_several(&self) -> bool {
        self.output.lock().several
    }

    /// Shows how far the starts are.
    pub fn show(&self, iteration: usize) {
        let mut state = self.output.lock();
        state.parts[self.part].iteration = Some(iteration);
        state.show();
    }

    /// It has nothing more to say: it is the turn of the next.
    pub fn end(&self) {
        let mut state = self.output.lock();
        state.parts[self.part].ended = true;
        state.hand_on();
    }
}

impl State {
    fn add(&mut self, part: usize, event: Event) {
        if part == self.speaking { self.emit(event) } else { self.parts[part].kept.push(event) }
    }

    /// Lets those speak whose turn has come.
    fn hand_on(&mut self) {
        while self.parts.get(self.speaking).is_some_and(|part| part.ended) {
            self.speaking += 1;
            let kept = self.parts.get_mut(self.speaking).map(|part| std::mem::take(&mut part.kept));
            kept.into_iter().flatten().for_each(|event| self.emit(event));
        }
    }

    fn emit(&self, event: Event) {
        match event {
            Event::Say(line) => self.console.say(line),
            Event::Trial(line) => {
                self.journal.lock().add_line(&line);
                self.on_trial.call_with(&line);
            }
            Event::Recorded(lines) => self.journal.lock().add_lines(&lines),
        }
    }

    /// `starts under way: 1 (iteration 4), 3 (iteration 6)`
    fn show(&self) {
        let of = |part: &Part| Some(format!("{} (iteration {})", part.start + 1, part.iteration?));
        let under_way: Vec<String> = self.parts.iter().filter(|part| !part.ended).filter_map(of).collect();
        self.console.show(format!("starts under way: {}", under_way.join(", ")));
    }
}

/// Hands lines on, whole ones.
struct LineWriter {
    output: OrderedOutput,
    part: usize,
    line: Vec<u8>,
}

impl Write for LineWriter {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        for byte in bytes {
            match byte {
                b'\n' => {
                    let line = String::from_utf8_lossy(&std::mem::take(&mut self.line)).into_owned();
                    self.output.lock().add(self.part, Event::Say(line));
                }
                byte => self.line.push(*byte),
            }
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}
