//! Work without the interpreter lock, which Ctrl-C and exceptions of callbacks end.

use pyo3::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender, channel, sync_channel};
use std::time::Duration;

/// Between two looks at signals.
const POLL: Duration = Duration::from_millis(50);

/// A line for a callback.
pub(crate) struct TrialLine {
    line: String,
    /// Dropped when the callback has returned, which the sender waits for; none of a line about how far a command is.
    heard: Option<SyncSender<()>>,
}

/// What is called with lines.
#[derive(Clone, Copy, Default)]
pub(crate) struct Callbacks<'a> {
    /// With those whose sender waits.
    pub trial: Option<&'a Py<PyAny>>,
    /// With those about how far a command is.
    pub progress: Option<&'a Py<PyAny>>,
}

/// Calls the callback for a trial and waits until it has returned.
pub(crate) fn send_line(to: &Sender<TrialLine>, line: String) {
    let (heard, waiting) = sync_channel(0);
    if to.send(TrialLine { line, heard: Some(heard) }).is_ok() {
        // Nothing is ever sent: this returns when the other side is dropped.
        let _ = waiting.recv();
    }
}

/// Reports how far a command is, and goes on.
pub(crate) fn tell(to: &Sender<TrialLine>, line: String) {
    // whoever has left hears nothing
    let _ = to.send(TrialLine { line, heard: None });
}

/// Does `work` on another thread without the interpreter lock, while the calling one looks at signals and runs callbacks for the lines
/// that `work` sends. A signal handler that raises (Ctrl-C) and a callback that does raise `cancel`; when the work has ended for it, their
/// exception is that of this function.
pub(crate) fn interruptible<T: Send>(
    py: Python<'_>,
    cancel: &AtomicBool,
    callbacks: Callbacks<'_>,
    work: impl FnOnce(Sender<TrialLine>) -> T + Send,
) -> PyResult<T> {
    cancel.store(false, Ordering::Relaxed);
    let (sender, lines) = channel();
    let (found, raised) = py.detach(|| {
        std::thread::scope(|scope| {
            let worker = scope.spawn(move || work(sender));
            let raised = attend(lines, cancel, callbacks);
            (worker.join(), raised)
        })
    });
    match (found, raised) {
        (Err(panic), _) => std::panic::resume_unwind(panic),
        (Ok(_), Some(error)) => Err(error),
        (Ok(found), None) => Ok(found),
    }
}

/// Until the work has ended; the exception that ended it, if one did.
fn attend(lines: Receiver<TrialLine>, cancel: &AtomicBool, callbacks: Callbacks<'_>) -> Option<PyErr> {
    let mut raised = None;
    loop {
        let shown = match lines.recv_timeout(POLL) {
            Ok(shown) => Some(shown),
            Err(RecvTimeoutError::Timeout) => None,
            Err(RecvTimeoutError::Disconnected) => return raised,
        };
        if raised.is_some() {
            continue;
        }
        let heard = Python::attach(|py| {
            py.check_signals()?;
            let Some(shown) = &shown else { return Ok(()) };
            let callback = if shown.heard.is_some() { callbacks.trial } else { callbacks.progress };
            callback.map_or(Ok(()), |callback| callback.call1(py, (shown.line.as_str(),)).map(|_| ()))
        });
        if let Err(error) = heard {
            cancel.store(true, Ordering::Relaxed);
            raised = Some(error);
        }
    }
}
