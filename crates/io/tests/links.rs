//! Links that lie in an output directory: what they lead to is never touched.

#![allow(clippy::unwrap_used)] // a test may

use nastic_io::{DirectoryLock, WrittenFiles, append_to, write_atomically};
use std::fs::{hard_link, read, write};
use std::os::unix::fs::symlink;
use std::path::Path;

const OWN: &[u8] = b"somebody's own";

/// A directory for results, and a file outside.
fn place() -> (tempfile::TempDir, tempfile::TempDir) {
    let (out, outside) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    write(outside.path().join("own.txt"), OWN).unwrap();
    (out, outside)
}

/// Calls with every kind of link to a file outside under that name; nothing outside may change.
fn with_links(name: &str, mut call: impl FnMut(&Path)) {
    for planted in 0..3 {
        let (out, outside) = place();
        let (own, none) = (outside.path().join("own.txt"), outside.path().join("none.txt"));
        let link = out.path().join(name);
        match planted {
            0 => symlink(&own, link).unwrap(),
            1 => hard_link(&own, link).unwrap(),
            _ => symlink(&none, link).unwrap(),
        }
        call(out.path());
        assert_eq!(read(own).unwrap(), OWN, "{name}, {planted}");
        assert!(!none.exists(), "{name}, {planted}");
    }
}

#[test]
fn locks_and_lists_do_not_follow_links() {
    with_links(".lock", |out| {
        let error = DirectoryLock::acquire(out).unwrap_err().to_string();
        assert!(error.contains(".lock") && error.contains("it is a link"), "{error}");
    });
    with_links(".written", |out| {
        let list = WrittenFiles::of(out);
        let Ok(list) = list else { return }; // somebody's own text is no list
        let error = list.add("result.json").unwrap_err().to_string();
        assert!(error.contains(".written") && error.contains("it is a link"), "{error}");
        // written anew the link itself is replaced
        list.save().unwrap();
        assert!(!out.join(".written").is_symlink());
    });
    with_links("history.jsonl", |out| {
        let error = append_to(&out.join("history.jsonl")).unwrap_err().to_string();
        assert!(error.contains("it is a link") || error.contains("No such file"), "{error}");
    });
}

#[test]
fn files_that_are_no_locks_and_no_lists_stay() {
    for name in [".lock", ".written"] {
        let (out, _) = place();
        let file = out.path().join(name);
        write(&file, OWN).unwrap();
        let lock = DirectoryLock::acquire(out.path()).map(drop).map_err(|error| error.to_string());
        let list = WrittenFiles::of(out.path()).map(drop).map_err(|error| error.to_string());
        let error = if name == ".lock" { lock } else { list }.unwrap_err();
        assert!(error.contains("give it another name"), "{error}");
        assert_eq!(read(file).unwrap(), OWN);
    }
    // a pipe is not waited for
    let (out, _) = place();
    let made = std::process::Command::new("mkfifo").arg(out.path().join(".lock")).status();
    if made.is_ok_and(|status| status.success()) {
        let error = DirectoryLock::acquire(out.path()).unwrap_err().to_string();
        assert!(error.contains("no plain file"), "{error}");
    }
}

#[test]
fn unfinished_files_and_results_do_not_follow_links() {
    with_links("result.json", |out| {
        let result = out.join("result.json");
        // names of unfinished files can be guessed
        for count in 0..400 {
            let part = out.join(format!(".result.json.{}.{count}.part", std::process::id()));
            symlink(std::fs::read_link(&result).unwrap_or_else(|_| result.clone()), part).unwrap();
        }
        write_atomically(&result, |to| to.write_all(b"new")).unwrap();
        assert!(!result.is_symlink());
        assert_eq!(read(&result).unwrap(), b"new");
    });
}

#[test]
fn the_list_of_files_outlives_a_program_that_is_killed() {
    let (out, _) = place();
    let list = WrittenFiles::of(out.path()).unwrap();
    for name in ["a.vtu", "b.vtu", "c.vtu"] {
        list.add(name).unwrap();
        write(out.path().join(name), name).unwrap();
    }
    std::fs::remove_file(out.path().join("b.vtu")).unwrap();
    list.remove("b.vtu").unwrap();
    // the removed name may be somebody's own now, also a name that was noted and never written
    list.add("d.vtu").unwrap();
    write(out.path().join("b.vtu"), OWN).unwrap();
    let has = |list: &WrittenFiles| ["a.vtu", "b.vtu", "c.vtu", "d.vtu"].map(|name| list.has(name));
    let again = WrittenFiles::of(out.path()).unwrap();
    assert_eq!(has(&again), [true, false, true, false]);
    again.save().unwrap();
    assert_eq!(has(&WrittenFiles::of(out.path()).unwrap()), [true, false, true, false]);
    // a line that a full disk cut off takes none with it
    let file = out.path().join(".written");
    let text = std::fs::read_to_string(&file).unwrap() + "+ e.v";
    write(&file, text).unwrap();
    again.add("e.vtu").unwrap();
    write(out.path().join("e.vtu"), "e").unwrap();
    assert!(WrittenFiles::of(out.path()).unwrap().has("e.vtu"));
}
