//! Parts of the starts of an optimisation, one of them killed.

#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::panic)] // a test may

use crate::common;

use common::{BAR, CaseDirectory, assert_same, code, signal, start, text};

const STARTS: [&str; 12] = [
    "optimize",
    "case.json",
    "--out",
    "there",
    "--set",
    "optimizer={\"method\":\"projected_gradient\",\"max_iterations\":14,\"tolerance\":1e-15,\"starts\":3,\"early_stopping\":false}",
    "--set",
    "output/checkpoint=2",
    "--threads",
    "1",
    "--set",
    "mesh/box/cells=[8,2,2]",
];

#[test]
fn a_part_that_is_killed_goes_on_and_is_joined_to_the_bit() {
    let with = |more: &[&'static str]| [&STARTS, more].concat();
    let whole = CaseDirectory::new(BAR);
    assert_eq!(code(&whole.nastic(&with(&[]))), 4);
    let place = CaseDirectory::new(BAR);
    let mut child = start(place.program(&with(&["--part", "1/2"])));
    place.wait_for_lines("there/start_2/history.jsonl", 6, &mut child);
    assert!(signal(&child, "KILL"));
    child.wait_with_output().unwrap();
    assert_eq!(code(&place.nastic(&with(&["--part", "2/2"]))), 0);
    let joined = place.nastic(&with(&["--join"]));
    assert!(
        code(&joined) == 4 && text(&joined.stdout).contains("missing     start 3 of 3"),
        "{}",
        text(&joined.stdout)
    );
    let again = place.nastic(&with(&["--part", "1/2"]));
    let said = text(&again.stdout);
    assert!(code(&again) == 0 && said.contains("; kept") && said.contains("; went on from its checkpoint"), "{said}");
    assert_eq!(code(&place.nastic(&with(&["--join", "--spectrum", "1"]))), 4, "joined, and not converged");
    assert_eq!(code(&place.nastic(&with(&["--join"]))), 4);
    (0..3).for_each(|index| std::fs::remove_dir_all(place.path(&format!("there/start_{index}"))).unwrap());
    assert_same(&place.path("there"), &whole.path("there"), "a part was killed");
    for (more, told) in
        [(&["--part", "1/2", "--spectrum", "1"][..], "cannot be used with"), (&["--part", "3/2"], "K/N")]
    {
        let refused = whole.nastic(&with(more));
        assert!(code(&refused) == 2 && text(&refused.stderr).contains(told), "{}", text(&refused.stderr));
    }
}
