//! What a log says of solves that take long.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use nastic_report::console::Console;
use std::io::Write;
use std::sync::{Arc, Mutex};
use std::time::Duration;

#[derive(Clone, Default)]
struct Log(Arc<Mutex<Vec<u8>>>);

impl Write for Log {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.lock().unwrap().extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

/// Lines of 120 iterations.
fn lines(console: impl Fn(Log) -> Console) -> Vec<String> {
    let log = Log::default();
    let console = console(log.clone());
    (1..=120).for_each(|n| console.progress(n, format!("iteration {n}")));
    let said = String::from_utf8(log.0.lock().unwrap().clone()).unwrap();
    said.lines().map(|line| line.trim().to_owned()).collect()
}

#[test]
fn a_log_is_neither_silent_nor_full_of_solves() {
    let always = lines(|log| Console::new(log).with_silence(Duration::ZERO));
    assert_eq!(always, ["iteration 50", "iteration 100"]);
    assert!(lines(Console::new).is_empty(), "five seconds have not passed");
}
