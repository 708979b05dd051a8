//! What a log says of solves that take long.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use nastic_report::console::Console;
use std::io::Write;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

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

/// What is written to a place until there is something wanted, at most for ten seconds.
fn until(log: &Log, wanted: &str) -> String {
    let began = Instant::now();
    loop {
        let text = String::from_utf8(log.0.lock().unwrap().clone()).unwrap();
        if text.contains(wanted) || began.elapsed() > Duration::from_secs(10) {
            assert!(text.contains(wanted), "{wanted}: {text:?}");
            return text;
        }
        std::thread::sleep(Duration::from_millis(20));
    }
}

#[test]
fn a_terminal_shows_what_is_done_where_nothing_is_reported() {
    let log = Log::default();
    let console = Console::silent().with_passing(log.clone()).refreshed();
    console.phase("reading");
    until(&log, "reading, 1.0 s so far");
    console.phase("motion");
    (0..2).for_each(|n| console.step(n, 45, format!("t = {} of 45 s", n + 1)));
    console.pass("solving: Newton iteration 3");
    let text = until(&log, "motion: step 2 of 45, t = 2 of 45 s, ");
    assert!(text.contains("so far, about ") && text.contains(" left; solving: Newton iteration 3"), "{text:?}");
    // runs of a sweep stand before what each of them does
    let runs = console.passing_alone();
    console.run(3, 12, "mu=1");
    runs.phase("reading");
    runs.pass("solving");
    until(&log, "[###.........] run 4 of 12: mu=1; reading, ");
    console.finish();
    let end = log.0.lock().unwrap().len();
    console.pass("late");
    std::thread::sleep(Duration::from_millis(1500));
    let rest = log.0.lock().unwrap()[end..].to_vec();
    assert!(rest.is_empty(), "{:?}", String::from_utf8(rest));
}

#[test]
fn a_log_tells_now_and_then_what_is_done() {
    let log = Log::default();
    let console = Console::silent().with_log(log.clone(), Duration::from_millis(200));
    console.phase("motion");
    console.step(6, 45, "t = 0.07 of 0.45 s");
    console.progress(17, "solving: Newton iteration 17");
    let text = until(&log, "Newton iteration 17\n");
    let line = text.lines().last().unwrap();
    assert!(line.starts_with("nastic: motion: step 7 of 45, t = 0.07 of 0.45 s, "), "{text}");
    assert!(text.lines().count() < 5, "{text}");
    drop(console);
    std::thread::sleep(Duration::from_millis(400));
    let lines = log.0.lock().unwrap().len();
    std::thread::sleep(Duration::from_millis(500));
    assert_eq!(log.0.lock().unwrap().len(), lines, "nobody is there any more");
}
