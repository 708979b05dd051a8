//! `nastic remesh` on the command line; what it does is tested in `nastic-remesh`.

#![allow(clippy::unwrap_used)] // a test may

use crate::common;

use common::{BAR, CaseDirectory, code, text};
use serde_json::Value;

#[test]
fn refusals_have_the_exit_code_of_bad_input() {
    let place = CaseDirectory::new(BAR);
    let output = place.nastic(&["solve", "case.json", "--out", "out", "--quiet"]);
    assert_eq!(code(&output), 0, "{}", text(&output.stderr));
    for (arguments, said) in [
        (["remesh", "nowhere", "--size", "1"], "nowhere: it has no result.json"),
        (["remesh", "out", "--size", "-1"], "a size of cells of -1: a positive length is needed"),
        (["remesh", "out", "--gmsh", "gmsh"], "it has the result of \"solve\""),
    ] {
        let output = place.nastic(&arguments);
        assert_eq!(code(&output), 2, "{arguments:?}");
        assert!(text(&output.stderr).contains(said), "{}", text(&output.stderr));
    }
    let output = place.nastic(&["remesh", "out", "--json"]);
    let record: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(record["command"] == "remesh" && record["exit"] == 2, "{record}");
}
