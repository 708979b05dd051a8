//! The program in a directory of its own.

#![allow(dead_code, clippy::unwrap_used, clippy::panic)] // helpers of several tests

use std::path::PathBuf;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// A bar of four hexahedra with a fibre along it, tracked at its end.
pub const BAR: &str = include_str!("../../../case/tests/cases/bar.json");

/// A directory with a case.
pub struct Place(tempfile::TempDir);

impl Place {
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
