//! The output directory: one program at a time, and nothing left behind by one that was killed.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::{BAR, CaseDirectory, Heard};
use nastic_language::schema::Command;
use nastic_run::console::Console;
use nastic_run::run::{Exit, Options, RunError, run};
use std::path::PathBuf;
use std::sync::{Arc, Mutex};

/// Starts another command on the same case once something is said, and keeps what became of it.
struct Intruder {
    case: PathBuf,
    options: Options,
    answers: Arc<Mutex<Vec<Result<Exit, RunError>>>>,
    rows: usize,
}

impl std::io::Write for Intruder {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.rows += bytes.iter().filter(|b| **b == b'\n').count();
        let mut answers = self.answers.lock().unwrap();
        if self.rows > 8 && answers.is_empty() {
            for out in [self.options.out.clone(), Some(self.case.with_file_name("elsewhere"))] {
                let options = Options { out, ..self.options.clone() };
                answers.push(run(Command::Solve, &self.case, &options, &Console::silent()).map(|outcome| outcome.exit));
            }
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

#[test]
fn two_programs_in_one_directory_notice_each_other() {
    let place = CaseDirectory::new();
    let (options, answers) = (place.options(&[]), Arc::default());
    let case = place.write("case.json", BAR);
    let intruder = Intruder { case: case.clone(), options: options.clone(), answers: Arc::clone(&answers), rows: 0 };
    run(Command::Optimize, &case, &options, &Console::new(intruder)).unwrap();
    let answers = answers.lock().unwrap();
    assert!(matches!(answers[1], Ok(Exit::Done)), "another directory is free: {:?}", answers[1]);
    let Err(refused) = &answers[0] else { panic!("a second program wrote to the directory of the first") };
    let (message, process) = (refused.to_string(), std::process::id());
    assert!(message.contains("out is in use by another program") && message.contains("--out"), "{message}");
    assert!(message.contains(&format!("(process {process})")), "{message}");
    assert_eq!(refused.exit(), Exit::NotWritten);
    // Once the first has ended, the directory is free again.
    assert_eq!(run(Command::Solve, &case, &options, &Console::silent()).unwrap().exit, Exit::Done);
}

#[test]
fn unfinished_files_of_a_killed_program_are_removed_and_no_others() {
    let place = CaseDirectory::new();
    std::fs::create_dir(place.path("out")).unwrap();
    let (ours, others) = ([".optimum.vtu.123.4.part", ".a.b.1.0.part"], ["x.1.2.part", ".x.part", ".x.1.y.part"]);
    ours.iter().chain(&others).for_each(|name| drop(place.write(&format!("out/{name}"), "half")));
    place.run(Command::Solve, BAR, &[]).unwrap();
    assert!(ours.iter().all(|name| !place.path("out").join(name).exists()));
    assert!(others.iter().all(|name| place.path("out").join(name).exists()));
}

#[test]
fn a_directory_is_told_by_its_plain_path() {
    let place = CaseDirectory::new();
    std::fs::create_dir(place.path("cases")).unwrap();
    let file = place.write("cases/case.json", BAR);
    let heard = Heard::default();
    let set = vec![r#"output/directory="../there""#.to_owned()];
    let options = Options { set, ..Options::default() };
    run(Command::Solve, &file, &options, &Console::new(heard.clone())).unwrap();
    let line = format!("results     {}", place.path("there").display());
    assert!(heard.text().lines().any(|said| said == line), "{}", heard.text());
    assert!(place.path("there/result.json").is_file());
}
