//! Sums over unknowns have one seam, `Space::dot`, `norm` and `max_abs`: to distribute vectors these alone are replaced.

use crate::common;

use common::Outcome;
use std::path::{Path, PathBuf};

fn sources(of: &Path, into: &mut Vec<PathBuf>) -> Outcome {
    for entry in std::fs::read_dir(of)? {
        let path = entry?.path();
        if path.is_dir() {
            sources(&path, into)?;
        } else if path.extension().is_some_and(|ext| ext == "rs") {
            into.push(path);
        }
    }
    Ok(())
}

/// The free functions of `nastic_numeric::vector` that sum, where an import names them or a path calls them.
fn sums(source: &str) -> Vec<&'static str> {
    let uses = source.split("numeric::vector").skip(1);
    let named = |behind: &str| -> String {
        let behind = behind.trim_start_matches("::");
        let end = if behind.starts_with('{') { '}' } else { ';' };
        behind.chars().take_while(|c| *c != end && *c != '(').collect()
    };
    let names: Vec<String> = uses.map(named).collect();
    let is_named = |name: &String, sum: &str| {
        name.is_empty() || name.split(|c: char| !c.is_alphanumeric() && c != '_').any(|word| word == sum)
    };
    ["dot", "norm", "max_abs"].into_iter().filter(|sum| names.iter().any(|name| is_named(name, sum))).collect()
}

#[test]
fn no_solver_sums_over_unknowns_by_itself() -> Outcome {
    assert_eq!(sums("use nastic_numeric::vector::{axpy, dot};"), ["dot"]);
    assert_eq!(sums("use nastic_numeric::vector::norm;"), ["norm"]);
    assert_eq!(sums("nastic_numeric::vector::max_abs(&x)"), ["max_abs"]);
    assert_eq!(sums("use nastic_numeric::vector;").len(), 3, "the module, under whatever name");
    assert!(sums("use nastic_numeric::vector::{axpy, sub};").is_empty());
    let crates = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = Vec::new();
    for folder in ["src", "../body/src", "../forces/src", "../equilibrium/src", "../motion/src", "../linear/src/solver"]
    {
        sources(&crates.join(folder), &mut files)?;
    }
    assert!(files.len() > 100, "{}", files.len());
    for file in files {
        let found = sums(&std::fs::read_to_string(&file)?);
        assert!(
            found.is_empty(),
            "{}: {found:?} of the space is to be asked (Space::dot, norm, max_abs)",
            file.display()
        );
    }
    Ok(())
}
