//! What is said of obstacles and contacts beside their numbers: in `check`, in legends, in lines below pictures.

#![allow(clippy::unwrap_used)] // helpers of tests

use crate::common;

use common::{CaseDirectory, with};
use nastic_language::schema::Command;

/// A block between a ball that comes down on it and a wall that it does not reach.
const BLOCK: &str = r#"{ "nastic": 1, "units": "mm",
  "mesh": { "box": { "size": [20, 20, 10], "cells": [4, 4, 2], "element": "hex8" } },
  "materials": [ { "region": "body", "law": "neo_hooke", "young": "0.1 MPa", "poisson": 0.3, "density": "1000 kg/m^3" } ],
  "supports": [ { "surface": "z-", "fix": "all" } ],
  "obstacles": [ { "name": "ball", "shape": { "sphere": { "center": [10, 10, 25], "radius": 14 } }, "translation": [0, 0, -2] },
                 { "name": "wall", "shape": { "box": { "low": [21, 0, 0], "high": [25, 20, 10] } } } ],
  "contact": [ { "name": "dent", "surface": "z+", "obstacle": "ball" }, { "name": "side", "surface": "x+", "obstacle": "wall" } ] }"#;

#[test]
fn a_given_place_and_what_contact_costs_are_told_by_check() {
    let of = |case: &str| CaseDirectory::new().text(Command::Check, case, &[]);
    let still = of(BLOCK);
    let comes = "ball: a sphere, its translation given: it comes there from its shape's place while loads grow";
    assert!(still.contains(comes), "{still}");
    assert!(still.contains("not estimated with contact") && !still.contains("a trial"), "{still}");
    let inside = of(&with(BLOCK, r#""center": [10, 10, 25]"#, r#""center": [10, 10, 20]"#));
    let begins = "4 mm inside of \"ball\" at (10, 10, 10), from where that is moved to its pose while loads grow";
    assert!(inside.contains("[inside_obstacle]") && inside.contains(begins), "{inside}");
    assert!(!still.contains("[inside_obstacle]"), "{still}");
    let time =
        r#""time": { "end": "0.1 s", "step": "10 ms", "scheme": "backward_euler", "start": "rest" }, "obstacles":"#;
    let moving =
        of(&with(&with(BLOCK, r#""center": [10, 10, 25]"#, r#""center": [10, 10, 20]"#), r#""obstacles":"#, time));
    assert!(moving.contains("ball: a sphere, its translation given\n"), "{moving}");
    assert!(!moving.contains("[inside_obstacle]"), "{moving}");
}

#[test]
fn obstacles_and_states_are_called_what_they_are() {
    let drawn = |case: &str| {
        let place = CaseDirectory::new();
        place.run(Command::Solve, case, &[]).unwrap();
        let read = |name: &str| std::fs::read_to_string(place.path("out").join(name)).unwrap();
        (read("picture.svg"), read("report.html"))
    };
    let (picture, page) = drawn(BLOCK);
    assert!(picture.contains(">obstacles ball, wall<") && !picture.contains(">obstacle<"), "{picture}");
    assert!(page.contains("\"obstacles\":\"obstacles ball, wall\""));
    // no controls, no start controls
    assert!(picture.contains(">equilibrium, min J "), "{picture}");
    let controlled = r#""controls": [ { "of": "ball.translation", "name": "depth", "direction": [0, 0, -1], "space": "uniform", "lower": 0, "upper": 1 } ], "contact":"#;
    let (picture, _) = drawn(&with(BLOCK, r#""contact":"#, controlled));
    assert!(picture.contains(">equilibrium at the start controls, min J "), "{picture}");
    let alone = with(BLOCK, r#", { "name": "side", "surface": "x+", "obstacle": "wall" }"#, "");
    let wall = r#",
                 { "name": "wall", "shape": { "box": { "low": [21, 0, 0], "high": [25, 20, 10] } } }"#;
    let (picture, _) = drawn(&with(&alone, wall, ""));
    assert!(picture.contains(">obstacle<"), "{picture}");
}

/// What can be solved but is hardly meant: reported by `check`, before anything is solved.
#[test]
fn unusual_contacts_are_told() {
    let of = |case: &str| CaseDirectory::new().text(Command::Check, case, &[]);
    assert!(!of(BLOCK).contains("[input]"), "{}", of(BLOCK));
    let twice = r#", { "name": "again", "surface": "z+", "obstacle": "ball" }, { "name": "side""#;
    let twice = of(&with(BLOCK, r#", { "name": "side""#, twice));
    assert!(twice.contains("[input]") && twice.contains("are contacts of the same pair"), "{twice}");
    let overlapping = r#", { "name": "again", "surface": ["z+", "y-"], "obstacle": "ball" }, { "name": "side""#;
    let overlapping = of(&with(BLOCK, r#", { "name": "side""#, overlapping));
    assert!(overlapping.contains("are contacts of the same pair"), "{overlapping}");
    let thick = of(&with(BLOCK, r#""name": "side", "#, r#""name": "side", "thickness": 8, "#));
    assert!(thick.contains("the layer is 8 mm thick and the surface "), "{thick}");
    let round = of(&with(BLOCK, r#""name": "ball", "#, r#""name": "ball", "rounding": 1, "#));
    assert!(round.contains("the shape has no edges"), "{round}");
    let rough =
        r#""time": { "end": "0.1 s", "step": "10 ms", "scheme": "backward_euler", "start": "rest" }, "obstacles":"#;
    let rough = with(BLOCK, r#""obstacles":"#, rough);
    let rough = of(&with(&rough, r#""name": "side", "#, r#""name": "side", "friction": 30, "#));
    assert!(rough.contains("a coefficient of friction of 30: rubber"), "{rough}");
}
