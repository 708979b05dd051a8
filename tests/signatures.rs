//! What signatures look like: few parameters are tuples that are taken apart at once, and a model hands out what is asked of it by subject; what a
//! function of a command may change is seen. What is saved is few files, and what a block of a case is.
#![allow(clippy::unwrap_used)] // helpers of a test

use std::fs;
use std::path::{Path, PathBuf};

/// Tuples taken apart in the signatures of all crates, at most.
const TUPLES: usize = 40;
/// Public methods of `Model` over all its `impl`, at most.
const METHODS_OF_MODEL: usize = 44;
/// Files of `run` that are of starts or checkpoints, at most.
const FILES_OF_STARTS: usize = 12;
/// Functions of `run` that may change all of a command, at most: those that begin and end it, and those that find its time steps.
const HEADS_OF_COMMANDS: usize = 21;
/// Crates of the front end.
const FRONT_END: [&str; 5] = ["language", "case", "result", "run", "report"];
/// Files of the front end that name springs, a block like any other, or a kind of actuation, at most.
const FILES_OF_A_BLOCK: usize = 4;

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        match entry.is_dir() {
            true => sources(&entry, found),
            false => found.extend((entry.extension().is_some_and(|end| end == "rs")).then_some(entry)),
        }
    }
}

/// The text of every source file of the crates that are wanted.
fn texts(wanted: impl Fn(&str) -> bool) -> Vec<String> {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("crates");
    let mut files = Vec::new();
    for entry in fs::read_dir(crates).unwrap().map(Result::unwrap) {
        if wanted(&entry.file_name().to_string_lossy()) {
            sources(&entry.path().join("src"), &mut files);
        }
    }
    files.iter().map(|file| fs::read_to_string(file).unwrap()).collect()
}

/// What stands between an opening bracket, the first sign of the text, and the one that closes it.
fn inside(text: &str) -> &str {
    let mut depth = 0_usize;
    for (at, sign) in text.char_indices() {
        match sign {
            '(' | '{' => depth += 1,
            ')' | '}' if depth == 1 => return &text[1..at],
            ')' | '}' => depth -= 1,
            _ => {}
        }
    }
    ""
}

/// The parameters of a signature.
fn parameters(text: &str) -> Vec<&str> {
    let (mut depth, mut from, mut out) = (0_i32, 0, Vec::new());
    for (at, sign) in text.char_indices() {
        match sign {
            '(' | '[' | '<' => depth += 1,
            ')' | ']' => depth -= 1,
            '>' if !text[..at].ends_with('-') => depth -= 1,
            ',' if depth == 0 => {
                out.push(text[from..at].trim());
                from = at + 1;
            }
            _ => {}
        }
    }
    out.push(text[from..].trim());
    out
}

/// The names of the functions with such parameters, each as often as it has one.
fn taken_apart(code: &str) -> Vec<&str> {
    let mut out = Vec::new();
    for (at, _) in code.match_indices("fn ") {
        let rest = &code[at + 3..];
        let name = rest.split(|sign: char| !(sign.is_alphanumeric() || sign == '_')).next().unwrap();
        // behind the generic parameters, which may have brackets of their own
        let generic = rest[name.len()..].starts_with('<');
        let open = if generic { rest.find(">(").map(|at| at + 1) } else { Some(name.len()) };
        let Some(list) = open.map(|open| &rest[open..]).filter(|list| list.starts_with('(') && !name.is_empty()) else {
            continue;
        };
        let tuples = parameters(inside(list)).into_iter().filter(|one| one.trim_start_matches('&').starts_with('('));
        out.extend(tuples.map(|_| name));
    }
    out
}

#[test]
fn few_signatures_take_tuples_apart() {
    assert_eq!(
        taken_apart("fn f<T>((a, b): (T, T), c: &[(u8, u8)]) {}\nfn g(x: (u8, u8), &(y, z): &(u8, u8)) {}"),
        ["f", "g"]
    );
    let texts = texts(|_| true);
    let found: Vec<&str> = texts.iter().flat_map(|code| taken_apart(code)).collect();
    assert!(texts.len() > 500 && found.len() <= TUPLES, "{} tuples: {found:?}", found.len());
}

#[test]
fn a_model_hands_out_what_is_asked_of_it_by_subject() {
    let own = |code: &String| -> usize {
        let blocks = code.match_indices("\nimpl Model {").map(|(at, _)| inside(&code[at + "\nimpl Model ".len()..]));
        blocks.map(|block| block.matches("\n    pub fn ").count()).sum()
    };
    let methods: usize = texts(|name| ["equilibrium", "motion"].contains(&name)).iter().map(own).sum();
    assert!((20..=METHODS_OF_MODEL).contains(&methods), "{methods} public methods of Model");
}

#[test]
fn what_a_function_of_a_command_may_change_is_seen() {
    let mut heads: usize = 0;
    for code in texts(|name| name == "run") {
        heads += code.matches(": &mut Opened<").count();
        assert!(!code.contains(": &mut CommandInput"), "what was asked stands fixed");
    }
    assert!((10..=HEADS_OF_COMMANDS).contains(&heads), "{heads} functions may change all of a command");
}

/// Those below `saved` and `starts`, others that are named after them, and whatever makes bytes of what is saved.
#[test]
fn starts_and_checkpoints_are_few_files() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("crates/run/src");
    let mut files = Vec::new();
    sources(&root, &mut files);
    let named = |file: &Path| {
        let path = file.strip_prefix(&root).unwrap().to_string_lossy().into_owned();
        ["saved", "start", "checkpoint"].iter().any(|word| path.contains(word))
    };
    let makes_bytes = |file: &Path| {
        let code = fs::read_to_string(file).unwrap();
        ["nastic_opt::saved", "nastic_opt::Saved", "nastic_opt::{Saved", "postcard::"]
            .iter()
            .any(|name| code.contains(name))
    };
    let found: Vec<&PathBuf> = files.iter().filter(|file| named(file) || makes_bytes(file)).collect();
    assert!((6..=FILES_OF_STARTS).contains(&found.len()), "{} files: {found:#?}", found.len());
}

/// Springs of viscous branches aside, which are no block, and comments.
#[test]
fn a_block_is_few_files_of_the_front_end() {
    let code_of = |text: &String| {
        let code: String = text.lines().map(|line| line.split("//").next().unwrap()).collect();
        code.replace("SpringMeasure", "").replace("neo-Hookean spring", "").to_lowercase()
    };
    let codes: Vec<String> = texts(|name| FRONT_END.contains(&name)).iter().map(code_of).collect();
    for block in ["spring", "tendon", "cavity"] {
        let found = codes.iter().filter(|code| code.contains(block)).count();
        assert!((2..=FILES_OF_A_BLOCK).contains(&found), "{found} files name a {block}");
    }
}
