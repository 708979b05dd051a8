//! Mutated files: readers of meshes and of cases must answer every one with a value or an error, soon, and never panic.
//!
//! Seeded and counted, so that a failure can be repeated: `NASTIC_MUTATIONS=1000000 cargo test --release --test mutation` runs so
//! many per target, from the seed `NASTIC_SEED` (default 1). A mutant that fails is written to `target/tmp`.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use nastic::case::lower::CaseProblem;
use nastic::case::syntax::Document;
use nastic::mesh::{CellKind, Snapshot, box_mesh, rectangle};
use nastic::numeric::Random;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Mutants per target unless the environment says otherwise; scripts/mutations.sh runs others, seed after seed.
const FEW: u64 = 20_000;
/// No answer may take longer; a typical one takes less than a thousandth.
const LONGEST: Duration = Duration::from_secs(10);

fn setting(name: &str, default: u64) -> u64 {
    std::env::var(name).map_or(default, |text| text.parse().unwrap())
}

/// Runs mutants of the files through a reader.
fn run(target: &str, corpus: &[Vec<u8>], share: u64, read: impl Fn(&[u8])) {
    let (count, seed) = (setting("NASTIC_MUTATIONS", FEW) / share, setting("NASTIC_SEED", 1));
    assert!(!corpus.is_empty(), "no files for {target}");
    for index in 0..count {
        let mut random = Random::new(seed.wrapping_mul(1_000_003).wrapping_add(index));
        let mut bytes = corpus[below(&mut random, corpus.len())].clone();
        for _ in 0..1 + below(&mut random, 6) {
            mutate(&mut bytes, corpus, &mut random);
        }
        let began = Instant::now();
        let done = catch_unwind(AssertUnwindSafe(|| read(&bytes)));
        if done.is_err() || began.elapsed() > LONGEST {
            let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("mutant_{target}_{seed}_{index}"));
            std::fs::write(&file, &bytes).unwrap();
            panic!("{target}: mutant {index} of seed {seed} after {:?}: {}", began.elapsed(), file.display());
        }
    }
}

fn below(random: &mut Random, bound: usize) -> usize {
    ((0.5 * (1.0 + random.symmetric()) * bound as f64) as usize).min(bound.saturating_sub(1))
}

/// What files get wrong: counts and tags that are negative, huge or no numbers.
const ODD: [&str; 14] = [
    "-1",
    "0",
    "1e308",
    "-1e-308",
    "nan",
    "inf",
    "4294967296",
    "9223372036854775807",
    "18446744073709551616",
    "1.5",
    "\"",
    "{",
    "]",
    "\0",
];

fn mutate(bytes: &mut Vec<u8>, corpus: &[Vec<u8>], random: &mut Random) {
    let (from, other) = (below(random, bytes.len().max(1)), below(random, bytes.len().max(1)));
    let range = from.min(other)..from.max(other).min(from.min(other) + 64);
    match below(random, 7) {
        0 => bytes.get_mut(from).into_iter().for_each(|byte| *byte ^= 1 << below(random, 8)),
        1 => drop(bytes.drain(range)),
        2 => {
            let copy = bytes[range.clone()].to_vec();
            bytes.splice(range.end..range.end, copy);
        }
        3 => {
            let odd = ODD[below(random, ODD.len())];
            bytes.splice(from..from, odd.bytes());
        }
        // A number in the place of another.
        4 | 5 => {
            let digit = |byte: &u8| byte.is_ascii_digit();
            if let Some(start) = bytes[from..].iter().position(digit).map(|at| from + at) {
                let length = bytes[start..].iter().take_while(|byte| digit(byte)).count();
                bytes.splice(start..start + length, ODD[below(random, ODD.len())].bytes());
            }
        }
        _ => {
            let donor = &corpus[below(random, corpus.len())];
            let at = below(random, donor.len());
            bytes.splice(range, donor[at..(at + 48).min(donor.len())].iter().copied());
        }
    }
}

fn files(directory: &str, ending: &str, largest: u64) -> Vec<Vec<u8>> {
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join(directory);
    let mut paths: Vec<_> = std::fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    let fits = |path: &Path| path.to_string_lossy().ends_with(ending) && path.metadata().unwrap().len() < largest;
    paths.iter().filter(|path| fits(path)).map(|path| std::fs::read(path).unwrap()).collect()
}

#[test]
fn gmsh_files() {
    let corpus = files("crates/io/tests/data", ".msh", 40_000);
    run("gmsh", &corpus, 1, |bytes| drop(nastic::io::parse_gmsh("mutant.msh", bytes, 1.0)));
}

/// A triangle in text.
const TEXT_VTU: &str = r#"<?xml version="1.0"?>
<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian"><UnstructuredGrid>
<Piece NumberOfPoints="3" NumberOfCells="1">
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">0 0 0 1 0 0 0 1 0</DataArray></Points>
<Cells><DataArray type="Int64" Name="connectivity" format="ascii">0 1 2</DataArray>
<DataArray type="Int64" Name="offsets" format="ascii">3</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">5</DataArray></Cells>
<CellData><DataArray type="Int32" Name="region" format="ascii">1</DataArray></CellData>
</Piece></UnstructuredGrid></VTKFile>"#;

#[test]
fn vtu_files() {
    let place = tempfile::tempdir().unwrap();
    let written = |(k, kind): (usize, CellKind)| {
        let mesh = Arc::new(
            if kind.dim() == 2 { rectangle([1.0; 2], [2, 1], kind) } else { box_mesh([1.0; 3], [2, 1, 1], kind) }
                .unwrap(),
        );
        let (points, cells) = (mesh.points().len(), mesh.cells());
        let shot = Snapshot::new(mesh).with_points("displacement", 3, vec![0.25; 3 * points]).unwrap();
        let path = place.path().join(format!("{k}.vtu"));
        nastic::io::write_vtu(&path, &shot.with_cells("J", 1, vec![1.0; cells]).unwrap()).unwrap();
        std::fs::read(path).unwrap()
    };
    let kinds = [CellKind::Hex8, CellKind::Tet10, CellKind::Quad9, CellKind::Tri3];
    let mut corpus: Vec<Vec<u8>> = kinds.into_iter().enumerate().map(written).collect();
    corpus.push(TEXT_VTU.as_bytes().to_vec());
    run("vtu", &corpus, 1, |bytes| drop(nastic::io::parse_vtu("mutant.vtu", bytes, 1.0)));
}

/// Cases are lowered to the problem they describe, which reads meshes and samples formulas; that takes longer.
#[test]
fn case_files() {
    let mut corpus = files("crates/language/tests/cases", ".json", 40_000);
    for case in &mut corpus {
        // 3^8 scenarios, each with its body, are right but take half a minute.
        *case = String::from_utf8(case.clone()).unwrap().replace(r#""gauss": 3"#, r#""gauss": 1"#).into_bytes();
    }
    let place = Path::new(env!("CARGO_MANIFEST_DIR")).join("crates/language/tests/cases/mutant.json");
    run("case", &corpus, 10, |bytes| {
        let Ok(text) = std::str::from_utf8(bytes) else { return };
        let document = Document::parse(&place.display().to_string(), text);
        drop(document.and_then(|document| CaseProblem::lower(document, Arc::default())));
    });
}
