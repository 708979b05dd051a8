//! Signals that ask the program to stop.

use std::io::{Write, stderr};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// What a signal adds to its number to make the exit code of a program that it ended, by convention.
const ENDED_BY_SIGNAL: i32 = 128;

/// A flag that the first Ctrl-C (SIGINT) or SIGTERM raises; the second ends the program. SIGHUP is left as it is, so
/// that `nohup` does what it promises.
pub(crate) fn cancelled_by_signals() -> Arc<AtomicBool> {
    let flag = Arc::new(AtomicBool::new(false));
    let raised = flag.clone();
    listen(move |signal| {
        if raised.swap(true, Ordering::Relaxed) {
            std::process::exit(ENDED_BY_SIGNAL + signal);
        }
        let _ =
            writeln!(stderr().lock(), "nastic: stopping after the step at hand; press Ctrl-C again to stop at once");
    });
    flag
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
