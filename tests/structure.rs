//! How large crates are, and how the files of each depend on each other: circles of files are small.

#![allow(clippy::unwrap_used, clippy::panic)] // a test may

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Most lines of a crate.
const LINES: usize = 15_000;

/// Most files in one circle of a crate.
const CIRCLE: usize = 9;

/// Most methods of the trait `LinearSolver`.
const SOLVER_METHODS: usize = 10;

/// Files directly in `crates/linear/src`.
const LINEAR_ROOT: usize = 10;

/// A Rust file by what concerns arrows.
#[derive(Default)]
struct File {
    /// Its code without comments, its tests and what it passes on.
    code: String,
    /// What it passes on by `pub use`, path by path as written.
    passed_on: Vec<Vec<String>>,
}

/// Files by module path (`["solver", "direct"]`; the root of a crate is empty).
type Files = BTreeMap<Vec<String>, File>;

impl File {
    fn read(text: &str) -> Self {
        let lines: Vec<&str> = text.lines().map(|line| line.split("//").next().unwrap_or_default()).collect();
        let code = lines.join("\n");
        let code = code.split("#[cfg(test)]\nmod ").next().unwrap_or_default();
        let mut file = Self::default();
        for statement in code.split_inclusive(';') {
            let begin = ["pub use ", "pub(crate) use ", "pub(super) use "].iter().find_map(|start| {
                let at = statement.find(start)?;
                Some((at, at + start.len()))
            });
            if let Some((at, tree)) = begin {
                file.code.push_str(&statement[..at]);
                paths_of(statement[tree..].trim_end_matches(';'), &[], &mut file.passed_on);
            } else {
                file.code.push_str(statement);
            }
        }
        file
    }
}

/// The Rust files below a folder.
fn read_files(folder: &Path, path: &[String], found: &mut Files) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let file = entry.unwrap().path();
        let stem = file.file_stem().unwrap().to_string_lossy().into_owned();
        let mut inner = path.to_vec();
        if file.is_dir() {
            inner.push(stem);
            read_files(&file, &inner, found);
        } else if file.extension().is_some_and(|e| e == "rs") {
            if stem != "mod" && !(path.is_empty() && stem == "lib") {
                inner.push(stem);
            }
            found.insert(inner, File::read(&std::fs::read_to_string(&file).unwrap()));
        }
    }
}

/// The paths a tree of a `use` stands for: `a::{b, c::{d}}` is `a::b` and `a::c::d`.
fn paths_of(tree: &str, before: &[String], found: &mut Vec<Vec<String>>) {
    let tree = tree.trim();
    if let Some(open) = tree.find('{') {
        let mut path = before.to_vec();
        path.extend(tree[..open].split("::").map(str::trim).filter(|part| !part.is_empty()).map(str::to_owned));
        let inner = &tree[open + 1..tree.rfind('}').unwrap_or(tree.len())];
        let (mut depth, mut start) = (0_usize, 0);
        for (at, letter) in inner.char_indices() {
            match letter {
                '{' => depth += 1,
                '}' => depth -= 1,
                ',' if depth == 0 => {
                    paths_of(&inner[start..at], &path, found);
                    start = at + 1;
                }
                _ => {}
            }
        }
        paths_of(&inner[start..], &path, found);
    } else if !tree.is_empty() {
        let mut path = before.to_vec();
        let name = tree.split(" as ").next().unwrap_or_default();
        path.extend(name.split("::").map(|part| part.trim().to_owned()));
        found.push(path);
    }
}

/// The paths in a file's code from one of the given first parts, those of `use` taken apart.
fn paths_in(code: &str, first: &[&str]) -> Vec<Vec<String>> {
    let mut found = Vec::new();
    for part in first {
        let start = format!("{part}::");
        for (begin, _) in code.match_indices(&start) {
            if code[..begin].ends_with(|letter: char| letter.is_alphanumeric() || matches!(letter, '_' | '$' | ':')) {
                continue;
            }
            let mut depth = 0_usize;
            let end = code[begin..].find(|letter: char| {
                match letter {
                    '{' => depth += 1,
                    '}' if depth > 0 => depth -= 1,
                    _ => {}
                }
                depth == 0 && !(letter.is_alphanumeric() || matches!(letter, '_' | ':' | '}'))
            });
            paths_of(&code[begin..end.map_or(code.len(), |length| begin + length)], &[], &mut found);
        }
    }
    found
}

/// The file a path written in a file leads to, through what others pass on.
fn target(own: &[String], path: &[String], files: &Files) -> Vec<String> {
    let ups = path.iter().take_while(|part| *part == "super").count();
    let (mut full, rest) = match path[0].as_str() {
        "crate" => (Vec::new(), &path[1..]),
        "super" => (own[..own.len().saturating_sub(ups)].to_vec(), &path[ups..]),
        _ => (own.to_vec(), path),
    };
    for (at, part) in rest.iter().enumerate() {
        full.push(part.clone());
        if files.contains_key(&full) {
            continue;
        }
        full.pop();
        let passed_on = files.get(&full).map_or(&[][..], |file| &file.passed_on);
        return match passed_on.iter().find(|path| path.last() == Some(part) && path[..] != rest[at..]) {
            Some(path) => target(&full, path, files),
            None => full,
        };
    }
    full
}

/// Which files each file uses; passing on is no use.
fn arrows(files: &Files) -> BTreeMap<&[String], BTreeSet<&[String]>> {
    let mut all = BTreeMap::new();
    for (own, file) in files {
        let children = files.keys().filter(|path| path.len() == own.len() + 1 && path.starts_with(own));
        let first: Vec<&str> = children.filter_map(|path| path.last()).map(String::as_str).collect();
        let mut to = BTreeSet::new();
        for path in paths_in(&file.code, &[&first[..], &["crate", "super"]].concat()) {
            if let Some((key, _)) = files.get_key_value(&target(own, &path, files)) {
                to.insert(key.as_slice());
            }
        }
        to.remove(own.as_slice());
        all.insert(own.as_slice(), to);
    }
    all
}

/// The files reached from one along arrows.
fn reached<'a>(from: &'a [String], arrows: &BTreeMap<&'a [String], BTreeSet<&'a [String]>>) -> BTreeSet<&'a [String]> {
    let mut seen = BTreeSet::new();
    let mut open = vec![from];
    while let Some(file) = open.pop() {
        for next in &arrows[file] {
            if seen.insert(*next) {
                open.push(next);
            }
        }
    }
    seen
}

/// The largest set of files of which each reaches each.
fn largest_circle(files: &Files) -> Vec<String> {
    let arrows = arrows(files);
    let reach: BTreeMap<_, _> = arrows.keys().map(|file| (*file, reached(file, &arrows))).collect();
    let circle = |file: &[String]| -> Vec<String> {
        let mutual = reach[file].iter().filter(|other| reach[**other].contains(file));
        mutual.map(|other| other.join("::")).collect()
    };
    reach.keys().map(|file| circle(file)).max_by_key(Vec::len).unwrap_or_default()
}

/// The lines of all Rust files below a folder.
fn lines(folder: &Path) -> usize {
    let of = |path: std::path::PathBuf| match path.is_dir() {
        true => lines(&path),
        false if path.extension().is_some_and(|e| e == "rs") => std::fs::read_to_string(&path).unwrap().lines().count(),
        false => 0,
    };
    std::fs::read_dir(folder).unwrap().map(|entry| of(entry.unwrap().path())).sum()
}

#[test]
fn crates_are_no_larger_than_a_reader_can_hold() {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("crates");
    let sized = std::fs::read_dir(crates).unwrap().map(|entry| {
        let path = entry.unwrap().path();
        (lines(&path.join("src")), path)
    });
    let (most, largest) = sized.max().unwrap();
    assert!((LINES / 2..=LINES).contains(&most), "{most} lines in {}: split it", largest.display());
}

#[test]
fn circles_of_files_are_small() {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("crates");
    let mut wrong = Vec::new();
    for entry in std::fs::read_dir(crates).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let mut files = Files::new();
        read_files(&path.join("src"), &[], &mut files);
        let circle = largest_circle(&files);
        if circle.len() > CIRCLE {
            wrong.push(format!("{name}: {} files in a circle: {}", circle.len(), circle.join(" ")));
        }
    }
    assert!(wrong.is_empty(), "cut an arrow:\n{}", wrong.join("\n"));
}

/// The houses of `linear`, each using only those before it and what stands in the root.
#[test]
fn the_houses_of_linear_stand_in_order() {
    const HOUSES: &[&str] = &["memory", "pattern", "factor", "krylov", "multigrid", "space", "solver", "eigenpairs"];
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("crates/linear/src");
    let in_root = std::fs::read_dir(&root).unwrap().filter(|entry| entry.as_ref().unwrap().path().is_file()).count();
    assert!(in_root <= LINEAR_ROOT, "{in_root} files stand in the root of linear");
    let mut files = Files::new();
    read_files(&root, &[], &mut files);
    let place = |file: &[String]| file.first().and_then(|house| HOUSES.iter().position(|known| known == house));
    for (from, to) in arrows(&files) {
        for there in to {
            if let (Some(of_user), Some(of_used)) = (place(from), place(there)) {
                assert!(of_used <= of_user, "{} must not use {}", from.join("::"), there.join("::"));
            }
        }
    }
}

/// One Arnoldi process, a narrow trait.
#[test]
fn linear_has_one_gmres_and_a_narrow_solver() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("crates/linear/src");
    let mut files = Files::new();
    read_files(&root, &[], &mut files);
    let with = |name: &str| -> Vec<String> {
        let found = files.iter().filter(|(_, file)| file.code.contains(name));
        found.map(|(path, _)| path.join("::")).collect()
    };
    assert_eq!(with("rotations: Vec<[f64; 2]>"), ["krylov::gmres"], "rotations of a Hessenberg matrix");
    let (_, rest) = files[&["solver".to_owned()][..]].code.split_once("pub trait LinearSolver").unwrap();
    let methods = rest.split("\n}").next().unwrap().matches("\n    fn ").count();
    assert!((1..=SOLVER_METHODS).contains(&methods), "{methods} methods of LinearSolver");
}

#[test]
fn the_reader_of_paths_sees_arrows_and_circles() {
    let code = "use crate::a::{b, c::{D, e}};\nlet x = super::f::g(1); my_crate::h;";
    let joined: Vec<String> = paths_in(code, &["crate", "super"]).iter().map(|path| path.join("::")).collect();
    assert_eq!(joined, ["crate::a::b", "crate::a::c::D", "crate::a::c::e", "super::f::g"]);
    let file = |path: &str, code: &str| {
        (path.split("::").filter(|part| !part.is_empty()).map(str::to_owned).collect(), File::read(code))
    };
    let files = Files::from([
        file("", "pub use a::A;"),
        file("a", "use crate::b::C;"),
        file("b", "mod c;\npub use c::C; // super::e"),
        file("b::c", "use crate::A; use super::d;"),
        file("b::d", "#[cfg(test)]\nmod tests { use super::super::c::C; }"),
    ]);
    assert_eq!(largest_circle(&files), ["a", "b::c"]);
}
