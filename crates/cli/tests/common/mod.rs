//! The program in a directory of its own.

#![allow(dead_code, clippy::unwrap_used, clippy::panic)] // helpers of several tests

pub mod browser;

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// A bar of four hexahedra with a fibre along it, tracked at its end.
pub const BAR: &str = include_str!("../../../language/tests/cases/bar.json");

/// A directory with a case.
pub struct CaseDirectory(tempfile::TempDir);

impl CaseDirectory {
    pub fn new(case: &str) -> Self {
        let place = Self(tempfile::tempdir().unwrap());
        std::fs::write(place.path("case.json"), case).unwrap();
        place
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn nastic(&self, arguments: &[&str]) -> Output {
        self.program(arguments).output().unwrap()
    }

    /// The program, to be started here.
    pub fn program(&self, arguments: &[&str]) -> Command {
        self.command(env!("CARGO_BIN_EXE_nastic"), arguments)
    }

    /// The program behind some commands of a shell.
    pub fn shell(&self, before: &str, arguments: &[&str]) -> Command {
        let script = format!("{before}; exec \"$0\" \"$@\"");
        let mut all = vec!["-c", &script, env!("CARGO_BIN_EXE_nastic")];
        all.extend(arguments);
        self.command("sh", &all)
    }

    fn command(&self, program: &str, arguments: &[&str]) -> Command {
        let mut command = Command::new(program);
        command.args(arguments).current_dir(self.0.path()).stdin(Stdio::null());
        command
    }

    /// Waits until a file has some lines; the process that writes them must be running.
    pub fn wait_for_lines(&self, name: &str, lines: usize, child: &mut Child) {
        let began = Instant::now();
        let found = || std::fs::read_to_string(self.path(name)).map_or(0, |text| text.lines().count());
        while found() < lines {
            assert!(began.elapsed() < Duration::from_secs(120), "{name} has {} lines", found());
            if let Some(status) = child.try_wait().unwrap() {
                assert!(found() >= lines, "{status}: {name} has {} lines", found());
            }
            std::thread::sleep(Duration::from_millis(2));
        }
    }
}

/// Starts a command whose output is collected.
pub fn start(mut command: Command) -> Child {
    command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

/// Sends a signal by its name; false if there is no such process any more.
pub fn signal(child: &Child, name: &str) -> bool {
    let kill = Command::new("kill").args(["-s", name, &child.id().to_string()]).stderr(Stdio::null()).status();
    kill.unwrap().success()
}

pub fn code(output: &Output) -> i32 {
    output.status.code().unwrap_or_else(|| panic!("{}", output.status))
}

pub fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// A file and what it holds.
pub type NamedBytes = (String, Vec<u8>);

/// What an optimisation leaves in a directory, but for times and the entry that says that it was resumed:
/// `result.json`, `history.jsonl`, other files.
pub fn content(directory: &Path) -> (String, Vec<serde_json::Value>, Vec<NamedBytes>) {
    let read = |name: &str| {
        let text = std::fs::read_to_string(directory.join(name));
        text.unwrap_or_else(|error| panic!("{}/{name}: {error}", directory.display()))
    };
    let without = |text: &str, keys: &[&str]| {
        let mut value: serde_json::Value = serde_json::from_str(text).unwrap_or_else(|error| panic!("{error}: {text}"));
        value.as_object_mut().unwrap().retain(|key, _| !keys.contains(&key.as_str()));
        value
    };
    let result = format!("{:#}", without(&read("result.json"), &["seconds", "peak_memory", "resumed"]));
    let history = read("history.jsonl").lines().map(|line| without(line, &["seconds"])).collect();
    let names = std::fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().file_name());
    let mut names: Vec<String> = names.map(|name| name.to_string_lossy().into_owned()).collect();
    names.retain(|name| {
        let set_aside = ["result.json", "history.jsonl", "checkpoint.bin", "report.html", ".lock", ".written"];
        !set_aside.contains(&name.as_str())
    });
    names.sort();
    let files = names.into_iter().map(|name| (name.clone(), std::fs::read(directory.join(name)).unwrap()));
    (result, history, files.collect())
}

/// Fails unless two directories hold the same.
pub fn assert_same(a: &Path, b: &Path, what: &str) {
    let ((result, history, files), (result_2, history_2, files_2)) = (content(a), content(b));
    assert_eq!(result, result_2, "{what}");
    assert_eq!(history, history_2, "{what}");
    let names = |files: &[NamedBytes]| files.iter().map(|file| file.0.clone()).collect::<Vec<_>>();
    assert_eq!(names(&files), names(&files_2), "{what}");
    for (file, file_2) in files.iter().zip(&files_2) {
        assert!(file == file_2, "{what}: {} differs", file.0);
    }
}

/// Random numbers in [0, 1) from a seed (splitmix64).
pub struct Random(pub u64);

impl Random {
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
}
