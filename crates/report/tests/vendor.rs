//! The vendored libraries are those of their packages, to the byte.

#![allow(clippy::unwrap_used)] // a test may

use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};

fn vendor(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("vendor").join(name)
}

#[test]
fn vendored_files_have_their_checksums() {
    let sums = std::fs::read_to_string(vendor("SHA256SUMS")).unwrap();
    let mut named = Vec::new();
    for line in sums.lines() {
        let (sum, name) = line.split_once("  ").unwrap();
        let found: String =
            Sha256::digest(std::fs::read(vendor(name)).unwrap()).iter().map(|b| format!("{b:02x}")).collect();
        assert_eq!(found, sum, "{name} is not what npm's package gives: see vendor/make.sh");
        named.push(name.to_owned());
    }
    let own = ["SHA256SUMS", "make.sh", "package.json", "package-lock.json", "three.entry.js"];
    let files = std::fs::read_dir(vendor("")).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut files: Vec<String> = files.filter(|name| !own.contains(&name.as_str())).collect();
    files.sort();
    named.sort();
    assert_eq!(files, named, "every vendored file has a checksum");
}

#[test]
fn notice_names_the_versions_of_the_packages() {
    let package = std::fs::read_to_string(vendor("package.json")).unwrap();
    let notice = std::fs::read_to_string(vendor("../../../NOTICE")).unwrap();
    for (package_name, name) in [("three", "three.js"), ("uplot", "uPlot")] {
        let at = package.split(&format!("\"{package_name}\": \"")).nth(1).unwrap();
        let version = at.split('"').next().unwrap();
        assert!(notice.contains(&format!("{name} {version}")), "NOTICE names {name} {version}");
    }
}

#[test]
fn own_programs_are_small() {
    for entry in std::fs::read_dir(vendor("../assets")).unwrap() {
        let path = entry.unwrap().path();
        let lines = std::fs::read_to_string(&path).unwrap().lines().count();
        assert!(lines <= 250, "{} has {lines} lines", path.display());
    }
}
