//! The tutorials and the pages on trouble and materials do what they say: their files are written, their commands run, and what they show is compared.
//!
//! The first word behind the fence is the language; what follows says what a block is:
//!
//! | Block | Is |
//! |---|---|
//! | `jsonc my/a.json`, `c my/a.geo`, .. | a file, written as it stands |
//! | `jsonc in my/a.json`, `rust in examples/a.rs` | a part of a file, which must hold it, whatever the indentation |
//! | `sh` | commands, typed in the root of the project |
//! | `sh gmsh`, `sh without gmsh` | run only where Gmsh is there, or is not |
//! | `text` | lines of the output of the commands before, in order; numbers may differ by 2 %, whole ones by 2; `...` is anything |

#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stderr)] // a test may

use std::path::{Path, PathBuf};
use std::process::Command;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap()
}

/// A block between fences.
struct Block {
    language: String,
    about: String,
    text: String,
    line: usize,
}

fn blocks(page: &str) -> Vec<Block> {
    let mut blocks: Vec<Block> = vec![];
    let mut open = false;
    for (k, line) in page.lines().enumerate() {
        match (line.strip_prefix("```"), open) {
            (Some(_), true) => open = false,
            (Some(head), false) => {
                let (language, about) = head.split_once(' ').unwrap_or((head, ""));
                let (language, about) = (language.to_owned(), about.trim().to_owned());
                blocks.push(Block { language, about, text: String::new(), line: k + 1 });
                open = true;
            }
            (None, true) => blocks.last_mut().unwrap().text += &format!("{line}\n"),
            (None, false) => {}
        }
    }
    blocks
}

/// A directory that looks like the root of the project to one who types commands there.
fn place() -> tempfile::TempDir {
    let place = tempfile::tempdir().unwrap();
    for name in ["meshes", "examples", "docs", "crates"] {
        std::os::unix::fs::symlink(root().join(name), place.path().join(name)).unwrap();
    }
    place
}

fn has_gmsh() -> bool {
    Command::new("gmsh").arg("--version").output().is_ok_and(|output| output.status.success())
}

fn run_page(name: &str) {
    let file = root().join("docs/tutorials").join(name);
    let page = std::fs::read_to_string(&file).unwrap();
    let (place, gmsh) = (place(), has_gmsh());
    if !gmsh && page.contains("```sh gmsh") {
        assert!(std::env::var_os("NASTIC_REQUIRE_PYTHON").is_none(), "Gmsh is required here, and is not there");
        eprintln!("SKIPPED: the commands of {name} that need Gmsh, which is not installed");
    }
    let (mut said, mut ran) = (String::new(), 0);
    for block in blocks(&page) {
        let at = format!("{}:{}", file.display(), block.line);
        match (block.language.as_str(), block.about.as_str()) {
            ("sh", "") => said = run(&block, place.path(), &at),
            ("sh", "gmsh") if gmsh => said = run(&block, place.path(), &at),
            ("sh", "without gmsh") if !gmsh => said = run(&block, place.path(), &at),
            ("sh", "gmsh" | "without gmsh") => continue,
            // run by crates/python/tests/test_docs.py
            ("python", "") if name == "8-python.md" => {}
            ("text", "") => compare(&block.text, &said, &at),
            (_, about) if about.starts_with("in ") => part(&block.text, &place.path().join(&about[3..]), &at),
            (_, "") => panic!("{at}: neither a file, nor a part of one, nor commands"),
            (_, file) => write(&place.path().join(file), &block.text),
        }
        ran += 1;
    }
    assert!(ran > 2, "{name} shows nothing");
}

fn write(file: &Path, text: &str) {
    std::fs::create_dir_all(file.parent().unwrap()).unwrap();
    std::fs::write(file, text).unwrap();
}

/// What the commands of a block say.
fn run(block: &Block, place: &Path, at: &str) -> String {
    let program = Path::new(env!("CARGO_BIN_EXE_nastic"));
    let path = format!("{}:{}", program.parent().unwrap().display(), std::env::var("PATH").unwrap());
    let mut command = Command::new("bash");
    command.args(["-e", "-c", &format!("exec 2>&1; {}", block.text)]).env("PATH", path).current_dir(place);
    let output = command.output().unwrap();
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{at}: {}\n{said}", output.status);
    said
}

/// A file holds these lines, one behind the other.
fn part(text: &str, file: &Path, at: &str) {
    let lines = |text: &str| text.lines().map(str::trim).filter(|line| !line.is_empty()).collect::<Vec<_>>().join("\n");
    let whole = std::fs::read_to_string(file).unwrap_or_else(|error| panic!("{at}: {}: {error}", file.display()));
    assert!(lines(&whole).contains(&lines(text)), "{at}: {} does not hold\n{text}", file.display());
}

/// The lines shown are lines of the output, in this order.
fn compare(shown: &str, said: &str, at: &str) {
    let mut rest = said.lines();
    for line in shown.lines().filter(|line| !line.trim().is_empty() && line.trim() != "...") {
        assert!(rest.any(|other| agree(line, other)), "{at}: the output lacks (here)\n{line}\nin\n{said}");
    }
}

fn agree(shown: &str, said: &str) -> bool {
    let mut said = said.split_whitespace();
    for word in shown.split_whitespace() {
        match (word, said.next()) {
            ("...", _) => return true,
            (word, Some(other)) if word == other || close(word, other) => {}
            _ => return false,
        }
    }
    said.next().is_none()
}

/// Two numbers with the same signs and letters about them.
fn close(word: &str, other: &str) -> bool {
    let bare = |word: &str| word.trim_matches(|c: char| "(),;:%".contains(c)).replace(',', "");
    let (Ok(a), Ok(b)) = (bare(word).parse::<f64>(), bare(other).parse::<f64>()) else { return false };
    let whole = a.fract() == 0.0 && b.fract() == 0.0 && !word.contains(['.', 'e']);
    (a - b).abs() <= if whole { (0.02 * a.abs()).max(2.0) } else { 0.02 * a.abs() }
}

#[test]
fn numbers_are_compared() {
    assert!(agree("cost 1.00e+00 -> 2.5, a factor of 110", "cost 1.01e+00 -> 2.5, a factor of 112"));
    assert!(!agree("cost 1.00e+00", "cost 1.05e+00") && !agree("cost 1", "cost 1 x") && !agree("a b", "a"));
    assert!(agree("trial ... ", "trial 3 and more") && !agree("trials 10", "trials 13"));
}

/// Every page has its test.
#[test]
fn no_page_is_left_out() {
    let pages = std::fs::read_dir(root().join("docs/tutorials")).unwrap().map(|entry| entry.unwrap().file_name());
    let mut pages: Vec<String> = pages.map(|name| name.to_string_lossy().into_owned()).collect();
    pages.retain(|name| name != "README.md");
    pages.sort_by_key(|name| name.split('-').next().and_then(|number| number.parse::<usize>().ok()));
    assert_eq!(pages, PAGES);
}

#[test]
fn materials() {
    run_page("../materials.md");
}

#[test]
fn features() {
    run_page("../features.md");
}

#[test]
fn trouble() {
    run_page("../trouble.md");
}

macro_rules! tutorials {
    ($($test:ident: $page:literal),* $(,)?) => {
        const PAGES: &[&str] = &[$($page),*];
        $(#[test] fn $test() { run_page($page); })*
    };
}

tutorials! {
    a_first_finger: "1-first-finger.md",
    targets: "2-targets.md",
    choices: "3-choices.md",
    air_chamber: "4-air-chamber.md",
    magnets: "5-magnets.md",
    uncertainty: "6-uncertainty.md",
    own_law: "7-own-law.md",
    python: "8-python.md",
    grasping: "9-grasping.md",
    tendons: "10-tendons.md",
    figures: "11-figures.md",
    test_data: "12-test-data.md",
}
