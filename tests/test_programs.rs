//! Every file of tests stands in the list of its crate's one test program: one that does not would never run.

#![allow(clippy::unwrap_used)] // a test may

use std::fs::{read_dir, read_to_string};
use std::path::{Path, PathBuf};

#[test]
fn no_file_of_tests_is_left_out() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let crates = read_dir(root.join("crates")).unwrap().map(|entry| entry.unwrap().path());
    let mut programs = 0;
    for tests in crates.chain([PathBuf::from(root)]).map(|folder| folder.join("tests")) {
        let Ok(list) = read_to_string(tests.join("all.rs")) else { continue };
        let files = read_dir(&tests).unwrap().map(|entry| entry.unwrap().path());
        for file in files.filter(|file| file.extension().is_some_and(|end| end == "rs") && !file.ends_with("all.rs")) {
            let line = format!("mod {};", file.file_stem().unwrap().to_string_lossy());
            assert!(list.lines().any(|known| known == line), "{} lacks `{line}`", tests.join("all.rs").display());
        }
        programs += 1;
    }
    assert!(programs > 10, "{programs}");
}
