//! Documents: places, repeated keys, overrides, paths, broken text.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use nastic_language::syntax::{At, Diagnostics, Document, Node, Value};

fn document(text: &str) -> Document {
    Document::parse("case.json", text).unwrap()
}

fn errors(text: &str) -> String {
    Document::parse("case.json", text).map(|_| ()).unwrap_err().to_string()
}

fn number(document: &Document, path: &str) -> f64 {
    match document.root().find(path) {
        Some(Node { value: Value::Number(value), .. }) => *value,
        other => panic!("{path}: {other:?}"),
    }
}

fn refused(document: &mut Document, option: &str) -> String {
    let error: Diagnostics = document.set(option).unwrap_err();
    error.to_string()
}

const CASE: &str =
    "// a comment\n{\n  \"a\": { \"b\": [10, 20, { \"c\": 3 }] }, /* and another */\n  \"e/f\": { \"g/h\": 5 },\n}\n";

#[test]
fn every_value_knows_its_line_and_column() {
    let document = document(CASE);
    for (path, line, column) in [("a", 3, 8), ("a/b/1", 3, 20), ("a/b/2/c", 3, 31), ("e/f/g/h", 4, 19), ("", 2, 1)] {
        let problem = document.complain(&path.split('/').fold(At::root(), |at, key| at.key(key)), "no");
        assert_eq!((problem.line, problem.column), (line, column), "{path}");
    }
    let problem = document.complain(&At::root().key("a").key("b").index(1), "is wrong");
    assert_eq!(problem.to_string(), "case.json:3:20: a/b/1: is wrong");
    let absent = document.complain(&At::root().key("a").key("missing").key("deeper"), "is wrong");
    assert_eq!(absent.to_string(), "case.json:3:8: a/missing/deeper: is wrong");
}

#[test]
fn columns_count_characters_and_lines_may_end_in_any_way() {
    let document = document("\u{feff}{ \"é\": \"🦀\", \"x\": 1,\r\n \"y\": 2 }");
    assert_eq!(document.complain(&At::root().key("x"), "").column, 18);
    assert_eq!(document.complain(&At::root().key("y"), "").line, 2);
}

/// One line of many characters of one to four bytes: the column of every value is the number of characters before it.
#[test]
fn columns_of_a_long_line_are_right() {
    let text = format!(
        "\n{{ \"a\": [{}1] }}",
        (0..3000).map(|k| format!("\"{}\", ", ["x", "é", "€", "🦀"][k % 4])).collect::<String>()
    );
    let document = document(&text);
    for k in [0, 1, 63, 64, 1000, 2999, 3000] {
        let problem = document.complain(&At::root().key("a").index(k), "no");
        assert_eq!((problem.line, problem.column), (2, 9 + 5 * k), "{k}");
    }
}

#[test]
fn broken_text_says_where_it_breaks() {
    for (text, part) in [
        ("", "case.json:1:1: the file is empty"),
        ("// nothing\n", "the file is empty"),
        ("{ \"a\": 1", "case.json:1:1: no valid JSON: unterminated object"),
        ("{\n \"a\": [1, 2 }", "case.json:2:"),
        ("{ \"a\": 1 \"b\": 2 }", "expected comma"),
        ("{ a: 1 }", "case.json:1:3: no valid JSON"),
        ("{ 'a': 1 }", "single-quoted"),
        ("{ \"a\": 0x10 }", "hexadecimal"),
        ("{ \"a\": NaN }", "unexpected word"),
        ("{ \"a\": +1 }", "unary plus"),
        ("{} {}", "more than one JSON value"),
        ("{ \"a\": \"open }", "no valid JSON"),
        ("/* open", "unterminated comment"),
        ("{ \"a\": tru }", "no valid JSON"),
    ] {
        let message = errors(text);
        assert!(message.contains(part), "{text}: {message}");
    }
    let deep = format!("{}1{}", "[".repeat(100_000), "]".repeat(100_000));
    assert!(errors(&deep).contains("nesting depth"));
}

#[test]
fn a_missing_file_is_named() {
    let error = Document::open(std::path::Path::new("no/such/case.json")).unwrap_err();
    assert!(error.to_string().starts_with("no/such/case.json: cannot be read: "), "{error}");
}

#[test]
fn overrides_reach_every_value() {
    let mut document = document(CASE);
    document.set("a/b/1=21.5").unwrap();
    assert_eq!(number(&document, "a/b/1"), 21.5);
    document.set("a/b/2/c = 4").unwrap();
    assert_eq!(number(&document, "a/b/2/c"), 4.0);
    document.set("e/f/g/h=6").unwrap();
    assert_eq!(number(&document, "e/f/g/h"), 6.0);
    document.set("a/new=90 kPa").unwrap();
    assert_eq!(document.root().find("a/new").unwrap().value, Value::Text("90 kPa".to_string()));
    document.set("a/b=[1, {\"x\": 2}]").unwrap();
    assert_eq!(number(&document, "a/b/1/x"), 2.0);
    document.set("optimizer/max_iterations=3").unwrap();
    assert_eq!(number(&document, "optimizer/max_iterations"), 3.0);
    document.set("a/text=X == 2").unwrap();
    assert_eq!(document.root().find("a/text").unwrap().value, Value::Text("X == 2".to_string()));
    let problem = document.complain(&At::root().key("a").key("b").index(0), "is wrong");
    assert_eq!(problem.to_string(), "--set a/b=[1, {\"x\": 2}]: a/b/0: is wrong");
}

#[test]
fn overrides_of_nothing_name_the_nearest() {
    let mut document = document("{ \"materials\": [{ \"mu1\": 1 }], \"title\": \"t\", \"loads\": [] }");
    for (option, message) in [
        (
            "material/0/mu1=2",
            "--set material/0/mu1=2: material/0/mu1: the case has no \"material\": did you mean \"materials\"? \
             (one of: materials, title, loads)",
        ),
        (
            "materials/1/mu1=2",
            "--set materials/1/mu1=2: materials/1/mu1: \"materials\" has no entry \"1\": its entries are 0 to 0",
        ),
        (
            "materials/0/mu/x=2",
            "--set materials/0/mu/x=2: materials/0/mu/x: \"materials/0\" has no \"mu\": did you mean \"mu1\"? \
             (one of: mu1)",
        ),
        ("title/x=2", "--set title/x=2: title/x: \"title\" is a text, it has no \"x\""),
        ("loads/0=2", "--set loads/0=2: loads/0: \"loads\" is an empty list, it has no \"0\""),
        ("materials/0/mu1", "--set materials/0/mu1: path=value was expected, as in materials/0/mu1=90 kPa"),
        ("=2", "--set =2: path=value was expected, as in materials/0/mu1=90 kPa"),
    ] {
        assert_eq!(refused(&mut document, option), message);
    }
    assert_eq!(number(&document, "materials/0/mu1"), 1.0, "a refused override changes nothing");
}

#[test]
fn equal_cases_have_equal_canonical_text() {
    let spaced = document("{ \"a\": 1.0, /* x */ \"b\": [1e0, \"t\",], }");
    let dense = document("{\"a\":1,\"b\":[1,\"t\"]}");
    assert_eq!(spaced.canonical(), dense.canonical());
    let mut changed = dense.clone();
    changed.set("a=2").unwrap();
    assert_ne!(changed.canonical(), dense.canonical());
}

#[test]
fn files_count_from_the_case() {
    let document = Document::parse("examples/cases/a.json", "{}").unwrap();
    assert_eq!(document.resolve("../x.msh"), std::path::Path::new("examples/cases/../x.msh"));
    assert_eq!(document.resolve("/x.msh"), std::path::Path::new("/x.msh"));
    assert_eq!(Document::parse("a.json", "{}").unwrap().resolve("x.msh"), std::path::Path::new("x.msh"));
}
