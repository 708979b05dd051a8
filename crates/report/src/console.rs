//! Terminal output while a command runs.

use crate::pace::Pace;
use crate::standing::Standing;
use crate::status::Status;
use std::fmt;
use std::io::Write;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::time::{Duration, Instant};

/// Where lines for people go; clones speak to the same place. Writing never fails: a reader who left (`| head`) does not
/// stop a computation.
#[derive(Clone)]
pub struct Console {
    lines: Sink,
    /// A terminal on which a passing line may be overwritten.
    passing: Sink,
    /// What is done at the moment.
    status: Arc<Mutex<Status>>,
    /// Whether single solves are not shown: several runs share the place.
    without_solves: Arc<AtomicBool>,
    /// When the last line was said, and how long none has to be until a line about a solve is.
    last_line: Arc<Mutex<Instant>>,
    silence: Duration,
    /// The observer of the progress.
    watcher: Option<Watcher>,
}

/// The observer of the progress, and when it was called last.
#[derive(Clone)]
struct Watcher {
    tell: Arc<dyn Fn(&Standing) + Send + Sync>,
    told: Arc<Mutex<Option<Instant>>>,
}

/// A line whose control characters, of a title say, are shown and not obeyed.
fn printable(line: &impl fmt::Display) -> String {
    let escaped = |c: char| if c.is_control() && c != '\n' { c.escape_unicode().to_string() } else { c.to_string() };
    line.to_string().chars().map(escaped).collect()
}

/// Between lines about a solve where there is no terminal: iterations, and the least time without any line.
const EVERY: usize = 50;
const SILENCE: Duration = Duration::from_secs(5);
/// How long a passing line stands before the times in it are brought up to date; a command that is done sooner shows none that it does not ask for.
const REFRESHED: Duration = Duration::from_secs(1);
/// How often it is looked whether the console is still there.
const LOOKED: Duration = Duration::from_millis(100);
/// Between two looks of a watcher, but for phases, steps and iterations.
const WATCHED: Duration = Duration::from_millis(100);

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
            status: Arc::default(),
            without_solves: Arc::default(),
            last_line: Arc::new(Mutex::new(Instant::now())),
            silence: SILENCE,
            watcher: None,
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

    /// With an observer of the progress: where a phase, a step or an iteration begins, and within a solve ten times a second at most. No
    /// result depends on it.
    #[must_use]
    pub fn watched(mut self, tell: impl Fn(&Standing) + Send + Sync + 'static) -> Self {
        self.watcher = Some(Watcher { tell: Arc::new(tell), told: Arc::default() });
        self
    }

    /// Calls the observer; of frequent events not always.
    fn tell(&self, is_often: bool) {
        let Some(watcher) = &self.watcher else { return };
        {
            let mut told = guard(&watcher.told);
            if is_often && told.is_some_and(|told| told.elapsed() < WATCHED) {
                return;
            }
            *told = Some(Instant::now());
        }
        let standing = guard(&self.status).standing();
        // nothing is held while others work
        (watcher.tell)(&standing);
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
        Self { passing: self.passing.clone(), status: self.status.clone(), ..Self::silent() }
    }

    /// With a passing line that is brought up to date every second, also where nothing is reported for long.
    #[must_use]
    pub fn refreshed(self) -> Self {
        let passing = Arc::downgrade(&self.passing);
        repeat(&self.status, REFRESHED, move |line| {
            passing.upgrade().is_some_and(|passing| write_passing(&passing, line))
        });
        self
    }

    /// With a line in a log every so often that says what is done at the moment, where there is no terminal.
    #[must_use]
    pub fn with_log(self, mut log: impl Write + Send + 'static, every: Duration) -> Self {
        repeat(&self.status, every, move |line| writeln!(log, "nastic: {line}").and_then(|()| log.flush()).is_ok());
        self
    }

    /// Shows nothing that passes any more.
    pub fn finish(&self) {
        guard(&self.status).ended = true;
        self.wipe();
    }

    /// Another phase of a command begins: it is shown when it takes long.
    pub fn phase(&self, what: &str) {
        guard(&self.status).enter(what);
        self.tell(false);
    }

    /// So many runs of a sweep are done, and the next has this name.
    pub fn run(&self, done: usize, of: usize, what: impl fmt::Display) {
        guard(&self.status).run(done, of, printable(&what));
        self.show("");
        self.tell(false);
    }

    /// So many steps of a motion are done, and the next leads to this instant.
    pub fn step(&self, done: usize, of: usize, what: impl fmt::Display) {
        if !self.without_solves.load(Ordering::Relaxed) {
            guard(&self.status).step(done, of, printable(&what));
            self.tell(false);
        }
    }

    /// The next step of a motion leads to this instant, towards this end.
    pub fn instant(&self, time: f64, end: f64) {
        if !self.without_solves.load(Ordering::Relaxed) {
            guard(&self.status).at(time, end);
        }
    }

    /// Whether nobody reads its lines.
    pub fn is_silent(&self) -> bool {
        self.lines.lock().map_or(true, |out| out.is_none())
    }

    /// Writes a line and shows it at once.
    pub fn say(&self, line: impl fmt::Display) {
        // nothing is brought up to date between the line that is taken away and the one that takes its place
        guard(&self.status).speaking += 1;
        self.wipe();
        if let Some(out) = guard(&self.lines).as_mut() {
            let _ = writeln!(out, "{}", printable(&line)).and_then(|()| out.flush());
            *guard(&self.last_line) = Instant::now();
        }
        guard(&self.status).speaking -= 1;
    }

    /// Shows how a solve goes on: on a terminal a line until the next one; elsewhere a line every 50 iterations where none was said for
    /// five seconds, so that a log is neither silent for minutes nor full of solves. `count` is the number of iterations so far.
    pub fn progress(&self, count: usize, line: impl fmt::Display) {
        if self.without_solves.load(Ordering::Relaxed) {
            return;
        }
        if guard(&self.passing).is_some() {
            self.pass(line);
            return;
        }
        let line = line.to_string();
        if count > 0 && count.is_multiple_of(EVERY) && self.has_been_silent() {
            self.say(format!("            {line}"));
        }
        guard(&self.status).line = printable(&line);
        self.tell(true);
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

    /// Shows a line until the next one, behind what is done at the moment.
    pub fn show(&self, line: impl fmt::Display) {
        let shown = {
            let mut status = guard(&self.status);
            status.line = printable(&line);
            if status.ended {
                return;
            }
            status.to_string()
        };
        write_passing(&self.passing, &shown);
        self.tell(true);
    }

    /// Shows how far an optimisation is; `None` when it ended.
    pub fn set_pace(&self, pace: Option<Pace>) {
        guard(&self.status).pace = pace;
        self.tell(false);
    }

    /// Takes a passing line away.
    pub fn clear(&self) {
        guard(&self.status).line.clear();
        self.wipe();
    }

    fn wipe(&self) {
        if let Some(out) = guard(&self.passing).as_mut() {
            let _ = write!(out, "\r\x1b[K").and_then(|()| out.flush());
        }
    }
}

fn guard<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Shows a line in place of the one that passes; whether there is a terminal that takes it.
fn write_passing(passing: &Sink, line: &str) -> bool {
    // Clipped at the right margin: of a line that went on below, only the last part could be taken away.
    let write = |out: &mut Box<dyn Write + Send>| {
        write!(out, "\r\x1b[K\x1b[?7l{line}\x1b[?7h").and_then(|()| out.flush()).is_ok()
    };
    guard(passing).as_mut().is_some_and(write)
}

/// Calls every so often with what is done at the moment, in a thread of its own, until that has ended or `call` says that nobody listens. No result depends
/// on it.
fn repeat(status: &Arc<Mutex<Status>>, every: Duration, mut call: impl FnMut(&str) -> bool + Send + 'static) {
    let status: Weak<Mutex<Status>> = Arc::downgrade(status);
    let mut next = every;
    // a system without another thread shows less
    let _ = std::thread::Builder::new().name("progress".to_owned()).spawn(move || {
        loop {
            std::thread::sleep(LOOKED.min(every));
            let Some(status) = status.upgrade() else { return };
            let status = guard(&status);
            if status.ended {
                return;
            }
            if status.elapsed() >= next && status.speaking == 0 {
                next = status.elapsed() + every;
                // with the status at hand, so that nothing is shown behind its end
                if !call(&status.to_string()) {
                    return;
                }
            }
        }
    });
}
