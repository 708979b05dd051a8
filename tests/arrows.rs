//! The arrows between our crates, read from the manifests: those of the figure in ARCHITECTURE.md and what they imply.

#![allow(clippy::unwrap_used, clippy::panic)] // a test may

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Who may depend on whom; `nastic` is the facade.
const ALLOWED: &[(&str, &[&str])] = &[
    ("numeric", &[]),
    ("team", &[]),
    ("tensor", &[]),
    ("hausdorff", &[]),
    ("energy", &["tensor"]),
    ("fit", &["numeric", "tensor", "energy"]),
    ("mesh", &["numeric"]),
    ("linear", &["numeric", "team", "tensor"]),
    ("io", &["mesh"]),
    ("picture", &["mesh", "io"]),
    ("report", &["mesh", "io", "picture"]),
    ("opt", &["numeric"]),
    ("uncertainty", &["numeric", "energy", "mesh"]),
    ("body", &["numeric", "team", "tensor", "energy", "mesh", "linear"]),
    ("forces", &["numeric", "tensor", "energy", "mesh", "linear", "body"]),
    ("equilibrium", &["numeric", "tensor", "energy", "mesh", "linear", "body", "forces"]),
    ("motion", &["numeric", "tensor", "energy", "mesh", "linear", "body", "forces", "equilibrium"]),
    ("fem", &["team", "tensor", "energy", "mesh", "linear", "body", "forces", "equilibrium", "motion"]),
    ("fields", &["numeric", "tensor", "energy", "mesh", "linear", "fem", "opt"]),
    ("control", &["numeric", "tensor", "energy", "mesh", "linear", "fem", "fields", "opt", "hausdorff"]),
    ("ensemble", &["numeric", "linear", "team", "mesh", "fem", "opt", "uncertainty", "control"]),
    ("language", &["numeric", "energy", "fit", "mesh", "io", "fem", "opt", "control"]),
    (
        "case",
        &[
            "numeric",
            "tensor",
            "energy",
            "fit",
            "mesh",
            "io",
            "fem",
            "opt",
            "uncertainty",
            "control",
            "ensemble",
            "language",
        ],
    ),
    (
        "result",
        &[
            "numeric",
            "energy",
            "mesh",
            "io",
            "picture",
            "report",
            "fem",
            "uncertainty",
            "control",
            "ensemble",
            "language",
            "case",
        ],
    ),
    (
        "run",
        &[
            "numeric",
            "tensor",
            "energy",
            "fit",
            "mesh",
            "io",
            "picture",
            "report",
            "fem",
            "opt",
            "uncertainty",
            "control",
            "ensemble",
            "team",
            "language",
            "case",
            "result",
        ],
    ),
    ("remesh", &["numeric", "mesh", "io", "report", "control", "language", "case", "result", "run"]),
    ("cli", &["language", "run", "remesh", "team", "mesh", "io", "report"]),
    ("python", &["mesh", "io", "report", "opt", "control", "ensemble", "language", "case", "run"]),
    (
        "nastic",
        &[
            "numeric",
            "tensor",
            "hausdorff",
            "energy",
            "fit",
            "mesh",
            "linear",
            "team",
            "io",
            "picture",
            "report",
            "opt",
            "uncertainty",
            "fem",
            "control",
            "ensemble",
            "language",
            "case",
            "run",
        ],
    ),
];

/// Our crates named in the `[dependencies]` of a manifest; development dependencies may point anywhere.
fn arrows_of(manifest: &str) -> BTreeSet<String> {
    let mut section = "";
    let mut found = BTreeSet::new();
    for line in manifest.lines().map(str::trim) {
        if line.starts_with('[') {
            section = line;
        } else if section == "[dependencies]" || section == "[build-dependencies]" {
            let key = line.split(['=', '.', ' ']).next().unwrap_or_default();
            found.extend(key.strip_prefix("nastic-").map(str::to_owned));
        }
    }
    found
}

#[test]
fn crates_depend_only_along_the_arrows() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut manifests: BTreeMap<String, String> = BTreeMap::new();
    manifests.insert("nastic".into(), std::fs::read_to_string(root.join("Cargo.toml")).unwrap());
    for entry in std::fs::read_dir(root.join("crates")).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        manifests.insert(name, std::fs::read_to_string(path.join("Cargo.toml")).unwrap());
    }
    let known: BTreeSet<&str> = ALLOWED.iter().map(|(name, _)| *name).collect();
    assert_eq!(known, manifests.keys().map(String::as_str).collect(), "a crate came or went: mend the table");
    for (name, allowed) in ALLOWED {
        let allowed: BTreeSet<String> = allowed.iter().map(|a| (*a).to_string()).collect();
        let arrows = arrows_of(&manifests[*name]);
        let wrong: Vec<_> = arrows.difference(&allowed).collect();
        assert!(wrong.is_empty(), "nastic-{name} must not depend on {wrong:?}");
    }
}

/// The workspaces of their own that need other libraries: built by nobody who does not ask.
#[test]
fn what_needs_mpi_is_no_member_and_depends_along_the_arrows() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let members = std::fs::read_to_string(root.join("Cargo.toml")).unwrap();
    assert!(members.contains("members = [\"crates/*\"]"));
    for (name, allowed) in [("mpi", &["cli", "language", "team"][..]), ("petsc", &["fem", "linear", "mesh", "team"])] {
        let manifest = std::fs::read_to_string(root.join(name).join("Cargo.toml")).unwrap();
        assert!(manifest.contains("[workspace]\n"), "{name}");
        assert_eq!(arrows_of(&manifest), allowed.iter().map(|a| (*a).to_string()).collect(), "{name}");
    }
}

#[test]
fn the_reader_of_manifests_sees_arrows() {
    let manifest = "[package]\nname = \"x\"\n[dependencies]\nnastic-fem.workspace = true\nfaer = \"1\"\n\
                    nastic-opt = { path = \"..\" }\n[dev-dependencies]\nnastic-case = \"1\"\n";
    assert_eq!(arrows_of(manifest), BTreeSet::from(["fem".to_owned(), "opt".to_owned()]));
}
