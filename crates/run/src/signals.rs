//! Signals that ask a program to stop.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

/// What a signal adds to its number to make the exit code of a program that it ended, by convention.
const ENDED_BY_SIGNAL: i32 = 128;

/// A flag that the first Ctrl-C (SIGINT) or SIGTERM raises, calling `asked` with a line for people; the second ends the program.
/// SIGHUP is left as it is, so that `nohup` does what it promises.
///
/// There is one flag for the whole program: later calls give the same, and their `asked` is not called.
pub fn cancelled_by_signals(asked: impl Fn(&str) + Send + 'static) -> Arc<AtomicBool> {
    static FLAG: OnceLock<Arc<AtomicBool>> = OnceLock::new();
    let listening = || {
        let flag = Arc::new(AtomicBool::new(false));
        let raised = flag.clone();
        listen(move |signal| {
            if raised.swap(true, Ordering::Relaxed) {
                std::process::exit(ENDED_BY_SIGNAL + signal);
            }
            asked("stopping after the step at hand; press Ctrl-C again to stop at once");
        });
        flag
    };
    FLAG.get_or_init(listening).clone()
}

/// Calls `heard` with the number of every signal. Without a handler signals end the program, as they did before.
#[cfg(unix)]
fn listen(heard: impl FnMut(i32) + Send + 'static) {
    use signal_hook::consts::{SIGINT, SIGTERM, SIGXFSZ};
    // SIGXFSZ is heard and left alone: a write beyond the limit of file sizes is then an error and not the end.
    if let Ok(mut signals) = signal_hook::iterator::Signals::new([SIGINT, SIGTERM, SIGXFSZ]) {
        std::thread::spawn(move || signals.forever().filter(|signal| *signal != SIGXFSZ).for_each(heard));
    }
}

/// Calls `heard` at every Ctrl-C. Without a handler it ends the program, as it did before.
#[cfg(not(unix))]
fn listen(mut heard: impl FnMut(i32) + Send + 'static) {
    const SIGINT: i32 = 2;
    let _ = ctrlc::set_handler(move || heard(SIGINT));
}
