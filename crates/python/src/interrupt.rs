//! Work without the interpreter lock, which Ctrl-C and exceptions of callbacks end.

use pyo3::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender, channel, sync_channel};
use std::time::Duration;

/// Between two looks at signals.
const POLL: Duration = Duration::from_millis(50);

/// A line about a trial; the sender waits until the callback has returned.
pub(crate) struct TrialLine {
    line: String,
    /// Dropped when the callback has returned.
    _heard: SyncSender<()>,
}

/// Calls the callback for a trial and waits until it has returned.
pub(crate) fn send_line(to: &Sender<TrialLine>, line: String) {
    let (heard, waiting) = sync_channel(0);
    if to.send(TrialLine { line, _heard: heard }).is_ok() {
        // Nothing is ever sent: this returns when the other side is dropped.
        let _ = waiting.recv();
    }
}

/// Does `work` on another thread without the interpreter lock, while the calling one looks at signals and runs `callback` for every line
/// that `work` sends. A signal handler that raises (Ctrl-C) and a callback that does raise `cancel`; when the work has ended for it, their
/// exception is that of this function.
pub(crate) fn interruptible<T: Send>(
    py: Python<'_>,
    cancel: &AtomicBool,
    callback: Option<&Py<PyAny>>,
    work: impl FnOnce(Sender<TrialLine>) -> T + Send,
) -> PyResult<T> {
    cancel.store(false, Ordering::Relaxed);
    let (sender, lines) = channel();
    let (found, raised) = py.detach(|| {
        std::thread::scope(|scope| {
            let worker = scope.spawn(move || work(sender));
            let raised = attend(lines, cancel, callback);
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
fn attend(lines: Receiver<TrialLine>, cancel: &AtomicBool, callback: Option<&Py<PyAny>>) -> Option<PyErr> {
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
            match (&shown, callback) {
                (Some(shown), Some(callback)) => callback.call1(py, (shown.line.as_str(),)).map(|_| ()),
                _ => Ok(()),
            }
        });
        if let Err(error) = heard {
            cancel.store(true, Ordering::Relaxed);
            raised = Some(error);
        }
    }
}
