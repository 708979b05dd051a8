//! Standard output, of which a failure is not lost: a reader who left (`| head`) does not matter, a full disk does.

use std::io::{ErrorKind, Result, Write, stdout};
use std::sync::OnceLock;

static FAILURE: OnceLock<String> = OnceLock::new();

/// Writes to standard output and remembers the first failure.
pub(crate) struct Output;

/// Why standard output could not be written, if it could not.
pub(crate) fn failure() -> Option<&'static str> {
    FAILURE.get().map(String::as_str)
}

fn remember<T>(written: Result<T>) -> Result<T> {
    if let Err(error) = &written
        && error.kind() != ErrorKind::BrokenPipe
    {
        FAILURE.get_or_init(|| error.to_string());
    }
    written
}

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        remember(stdout().lock().write(bytes))
    }

    fn flush(&mut self) -> Result<()> {
        remember(stdout().lock().flush())
    }
}
