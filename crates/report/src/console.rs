//! Terminal output while a command runs.

use crate::pace::Pace;
use std::fmt;
use std::io::Write;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// Where lines for people go; clones speak to the same place. Writing never fails: a reader who left (`| head`) does not
/// stop a computation.
#[derive(Clone)]
pub struct Console {
    lines: Sink,
    /// A terminal on which a passing line may be overwritten.
    passing: Sink,
    /// How far an optimisation is, before everything that passes.
    pace: Arc<Mutex<Option<Pace>>>,
    /// Whether single solves are not shown: several runs share the place.
    without_solves: Arc<AtomicBool>,
    /// When the last line was said, and how long none has to be until a line about a solve is.
    last_line: Arc<Mutex<Instant>>,
    silence: Duration,
}

/// A line whose control characters, of a title say, are shown and not obeyed.
fn printable(line: &impl fmt::Display) -> String {
    let escaped = |c: char| if c.is_control() && c != '\n' { c.escape_unicode().to_string() } else { c.to_string() };
    line.to_string().chars().map(escaped).collect()
}

/// Between lines about a solve where there is no terminal: iterations, and the least time without any line.
const EVERY: usize = 50;
const SILENCE: Duration = Duration::from_secs(5);

type Sink = Arc<Mutex<Option<Box<dyn Write + Send>>>>;

impl fmt::Debug for Console {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Console")
    }
}

impl Console {
    /// Says nothing.
    #[must_use]
    pub fn silent() -> Self {
        Self {
            lines: Arc::default(),
            passing: Arc::default(),
            pace: Arc::default(),
            without_solves: Arc::default(),
            last_line: Arc::new(Mutex::new(Instant::now())),
            silence: SILENCE,
        }
    }

    /// Says everything to `out`.
    pub fn new(out: impl Write + Send + 'static) -> Self {
        Self { lines: Arc::new(Mutex::new(Some(Box::new(out)))), ..Self::silent() }
    }

    /// With a terminal for what passes: the progress of a solve.
    #[must_use]
    pub fn with_passing(mut self, terminal: impl Write + Send + 'static) -> Self {
        self.passing = Arc::new(Mutex::new(Some(Box::new(terminal))));
        self
    }

    /// With lines about a solve, where there is no terminal, after another time of silence than five seconds.
    #[must_use]
    pub fn with_silence(mut self, silence: Duration) -> Self {
        self.silence = silence;
        self
    }

    /// The same terminal for what passes, and another place for lines.
    #[must_use]
    pub fn with_lines(&self, out: impl Write + Send + 'static) -> Self {
        Self { lines: Arc::new(Mutex::new(Some(Box::new(out)))), ..self.clone() }
    }

    /// The same terminal for what passes, and no lines.
    #[must_use]
    pub fn passing_alone(&self) -> Self {
        Self { passing: self.passing.clone(), ..Self::silent() }
    }

    /// Whether nobody reads its lines.
    pub fn is_silent(&self) -> bool {
        self.lines.lock().map_or(true, |out| out.is_none())
    }

    /// Writes a line and shows it at once.
    pub fn say(&self, line: impl fmt::Display) {
        self.clear();
        let Ok(mut out) = self.lines.lock() else { return };
        if let Some(out) = out.as_mut() {
            let _ = writeln!(out, "{}", printable(&line)).and_then(|()| out.flush());
            if let Ok(mut last) = self.last_line.lock() {
                *last = Instant::now();
            }
        }
    }

    /// Shows how a solve goes on: on a terminal a line until the next one; elsewhere a line every 50 iterations where none was said for
    /// five seconds, so that a log is neither silent for minutes nor full of solves. `count` is the number of iterations so far.
    pub fn progress(&self, count: usize, line: impl fmt::Display) {
        if self.without_solves.load(Ordering::Relaxed) {
            return;
        }
        if self.passing.lock().is_ok_and(|passing| passing.is_some()) {
            self.pass(line);
        } else if count > 0 && count.is_multiple_of(EVERY) && self.has_been_silent() {
            self.say(format!("            {line}"));
        }
    }

    fn has_been_silent(&self) -> bool {
        self.last_line.lock().is_ok_and(|last| last.elapsed() >= self.silence)
    }

    /// Shows a line about a solve until the next one, behind how far an optimisation is.
    pub fn pass(&self, line: impl fmt::Display) {
        if !self.without_solves.load(Ordering::Relaxed) {
            self.show(line);
        }
    }

    /// Leaves single solves out, or shows them again.
    pub fn show_solves(&self, shown: bool) {
        self.without_solves.store(!shown, Ordering::Relaxed);
    }

    /// Shows a line until the next one, behind how far an optimisation is.
    pub fn show(&self, line: impl fmt::Display) {
        let pace = self.pace.lock().ok().and_then(|pace| *pace).map(|pace| format!("{pace}; "));
        let Ok(mut out) = self.passing.lock() else { return };
        if let Some(out) = out.as_mut() {
            // Clipped at the right margin: of a line that went on below, only the last part could be taken away.
            let line = pace.unwrap_or_default() + &printable(&line);
            let _ = write!(out, "\r\x1b[K\x1b[?7l{line}\x1b[?7h").and_then(|()| out.flush());
        }
    }

    /// Shows how far an optimisation is; `None` when it ended.
    pub fn set_pace(&self, pace: Option<Pace>) {
        if let Ok(mut own) = self.pace.lock() {
            *own = pace;
        }
    }

    /// Takes a passing line away.
    pub fn clear(&self) {
        let Ok(mut out) = self.passing.lock() else { return };
        if let Some(out) = out.as_mut() {
            let _ = write!(out, "\r\x1b[K").and_then(|()| out.flush());
        }
    }
}
