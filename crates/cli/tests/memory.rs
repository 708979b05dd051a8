//! Limits of memory: what does not fit is refused or reported, before it is allocated.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::{BAR, CaseDirectory, code, text};

/// A column of 24,843 unknowns under twice its buckling load, straight, solved by multigrid; a factor of its tangent takes 138 MB.
const COLUMN: &str = r#"{ "nastic": 1, "linear_solver": "multigrid",
  "mesh": { "box": { "size": [0.6, 0.2, 0.2], "cells": [48, 12, 12], "element": "hex8" } },
  "materials": [ { "region": "body", "law": "neo_hooke", "young": "100 kPa", "poisson": 0.3 } ],
  "supports": [ { "surface": "x-", "fix": "all" } ],
  "loads": [ { "surface": "x+", "traction": ["-3.5 kPa", 0, 0] } ] }"#;

/// A factor that does not fit is refused before it is allocated, with what it would take.
#[test]
fn too_little_memory_is_three() {
    let place = CaseDirectory::new(BAR);
    let with_limit = |limit: &str| place.program(&["solve", "case.json"]).env("NASTIC_MEMORY", limit).output().unwrap();
    let output = with_limit("1M");
    let message = text(&output.stderr);
    assert_eq!(code(&output), 3, "{message}");
    assert!(
        message.contains("a factor of the tangent takes ") && message.contains(" kB where 0 kB are available"),
        "{message}"
    );
    assert!(
        message.contains("multigrid where the matrix is symmetric (\"linear_solver\": \"multigrid\")")
            && message.contains("NASTIC_MEMORY"),
        "{message}"
    );
    let limited = place.program(&["check", "case.json"]).env("NASTIC_MEMORY", "1M").output().unwrap();
    let message = text(&limited.stdout);
    assert!(message.contains("too little for a factor; \"linear_solver\": \"multigrid\" takes "), "{message}");
    let output = with_limit("64G");
    assert_eq!(code(&output), 0, "{}", text(&output.stderr));
    let output = with_limit("lots");
    assert_eq!(code(&output), 2);
    assert!(text(&output.stderr).contains("NASTIC_MEMORY=\"lots\" is no size of memory"), "{}", text(&output.stderr));
    let message = text(&place.nastic(&["check", "case.json"]).stdout);
    assert!(
        message.contains("solver      direct: a sparse factor")
            && message.contains("memory      a factor has ")
            && message.contains(" MB while it is made on one thread"),
        "{message}"
    );
}

/// Multigrid solves where a factor of the tangent does not fit; that it is indefinite multigrid shows, by how many pivots only a factor.
#[test]
fn a_state_whose_pivots_cannot_be_counted() {
    let place = CaseDirectory::new(COLUMN);
    let solved = |limit: &str| {
        let output =
            place.program(&["solve", "case.json", "--json", "--no-report"]).env("NASTIC_MEMORY", limit).output();
        let output = output.unwrap();
        assert_eq!(code(&output), 0, "{limit}: {}", text(&output.stderr));
        serde_json::from_slice::<serde_json::Value>(&output.stdout).unwrap()
    };
    let codes = |found: &serde_json::Value| {
        let all = found["warnings"].as_array().unwrap().iter();
        all.map(|warning| warning["code"].as_str().unwrap().to_owned()).collect::<Vec<_>>()
    };
    let check = place.program(&["check", "case.json"]).env("NASTIC_MEMORY", "40M").output().unwrap();
    let told = text(&check.stdout);
    assert!(told.contains(", a solve at its peak ") && told.contains("            too little\n"), "{told}");
    let (much, little) = (solved("24G"), solved("130M"));
    assert_eq!((codes(&much), much["inertia"].as_u64()), (vec!["unstable".to_owned()], Some(2)));
    assert_eq!((codes(&little), little["inertia"].as_u64()), (vec!["inertia_not_counted".to_owned()], None));
}

/// The factor of [`COLUMN`], which does not fit in what is left of a limit that a batch system sets.
#[cfg(target_os = "linux")]
fn refused_under(limit: &str) {
    let place = CaseDirectory::new(&COLUMN.replace("multigrid", "direct"));
    let output = place.shell(limit, &["solve", "case.json", "--no-report", "--threads", "1"]).output().unwrap();
    let message = text(&output.stderr);
    assert_eq!(code(&output), 3, "{limit}: {message}");
    assert!(
        message.contains("a factor of the tangent takes ") && message.contains(" are available"),
        "{limit}: {message}"
    );
}

#[cfg(target_os = "linux")]
#[test]
fn limits_of_a_shell_are_kept() {
    refused_under("ulimit -v 240000");
    refused_under("ulimit -d 210000");
}

/// The first dense products have buffers as large as caches, which multigrid's coarsest level needs too: it ends, and does not abort.
#[cfg(target_os = "linux")]
#[test]
fn multigrid_ends_under_limits_of_a_shell() {
    let place = CaseDirectory::new(COLUMN);
    for threads in ["1", "2"] {
        let arguments = ["solve", "case.json", "--no-report", "--threads", threads];
        let ended = place.shell("ulimit -v 400000", &arguments).output().unwrap();
        let message = text(&ended.stderr);
        assert!(matches!(code(&ended), 0 | 3), "{}: {message}", code(&ended));
        assert!(code(&ended) == 0 || !message.contains("\"multigrid\""), "{message}");
    }
}

/// A control group as batch systems and containers make one, of either version. Needs root and the right to make groups; skipped otherwise.
#[cfg(target_os = "linux")]
#[test]
fn limits_of_a_control_group_are_kept() {
    let name = format!("nastic_test_{}", std::process::id());
    let groups = [("/sys/fs/cgroup/memory", "memory.limit_in_bytes"), ("/sys/fs/cgroup", "memory.max")];
    let made = groups.iter().find_map(|(root, limit)| {
        let group = std::path::Path::new(root).join(&name);
        std::fs::create_dir(&group).ok()?;
        // a directory of another file system takes any file and limits nothing
        let is_group = group.join("cgroup.procs").exists();
        if is_group && std::fs::write(group.join(limit), (150 << 20).to_string()).is_ok() {
            return Some(group);
        }
        let _ = std::fs::remove_dir(group);
        None
    });
    let Some(group) = made else {
        eprintln!("skipped: no control group with a limit of memory can be made here");
        return;
    };
    let ended = std::panic::catch_unwind(|| refused_under(&format!("echo $$ > {}/cgroup.procs", group.display())));
    let removed = std::fs::remove_dir(&group);
    // what was found comes first, not a group that stays
    ended.unwrap();
    removed.unwrap();
}
