//! Self-intersection against shapes whose overlap is known.
#![allow(clippy::unwrap_used)]

use nastic_mesh::spatial::{SelfIntersection, Shape};
use nastic_mesh::{CellKind, Mesh, box_mesh, rectangle};
use std::f64::consts::TAU;

const LENGTH: f64 = 10.0;
const ALONG: usize = 40;

/// A bar along x of 40 cells.
fn bar(kind: CellKind) -> Mesh {
    match kind.dim() {
        2 => rectangle([LENGTH, 0.4], [ALONG, 2], kind).unwrap(),
        _ => box_mesh([LENGTH, 0.4, 0.4], [ALONG, 2, 1], kind).unwrap(),
    }
}

/// Bent into an arc of so many turns about z, rising by `pitch` per turn.
fn bent(mesh: &Mesh, turns: f64, pitch: f64) -> Vec<[f64; 3]> {
    let radius = LENGTH / (TAU * turns);
    let place = |x: &[f64; 3]| {
        let angle = x[0] / radius;
        // A spiral, so that no faces of two turns coincide.
        let r = radius - x[1] + 0.2 + 0.05 * angle / TAU;
        [r * angle.sin(), -r * angle.cos(), x[2] + pitch * angle / TAU]
    };
    mesh.points().iter().map(place).collect()
}

fn found(mesh: &Mesh, positions: &[[f64; 3]]) -> SelfIntersection {
    Shape::new(mesh, positions, None).unwrap().self_intersection()
}

const KINDS: [CellKind; 7] = [
    CellKind::Hex8,
    CellKind::Hex20,
    CellKind::Hex27,
    CellKind::Tet4,
    CellKind::Tet10,
    CellKind::Quad9,
    CellKind::Tri6,
];

#[test]
fn an_open_arc_does_not_intersect_itself() {
    for kind in KINDS {
        let mesh = bar(kind);
        for turns in [0.01, 0.5, 0.97] {
            let found = found(&mesh, &bent(&mesh, turns, 0.0));
            assert!(found.is_empty(), "{kind:?}, {turns} turns: {found:?}");
        }
    }
}

/// Of t turns, t - 1 lie in the first ones, and as many of the first in the last.
#[test]
fn an_arc_of_more_than_a_turn_overlaps_by_what_is_more() {
    for kind in KINDS {
        let mesh = bar(kind);
        for turns in [1.13, 1.31] {
            let found = found(&mesh, &bent(&mesh, turns, 0.0));
            let share = found.overlapped.len() as f64 / mesh.cells() as f64;
            let expected = 2.0 * (turns - 1.0) / turns;
            assert!((share - expected).abs() < 0.08, "{kind:?}, {turns} turns: {share} for {expected}");
            assert!(!found.crossed.is_empty() && found.cells().len() < mesh.cells(), "{kind:?}: {found:?}");
            assert!(found.cells().windows(2).all(|pair| pair[0] < pair[1]));
        }
    }
}

/// The end dips into the beginning by a tenth of a cell: no centre lies in another cell, but faces cross.
#[test]
fn a_shallow_overlap_shows_in_crossing_faces() {
    for kind in KINDS {
        let mesh = bar(kind);
        let found = found(&mesh, &bent(&mesh, 1.0 + 0.1 / ALONG as f64, 0.0));
        assert!(found.overlapped.is_empty() && !found.crossed.is_empty(), "{kind:?}: {found:?}");
    }
}

/// A helix whose turns lie above each other, and parts that only touch.
#[test]
fn touching_is_no_intersection() {
    let mesh = bar(CellKind::Hex20);
    assert!(found(&mesh, &bent(&mesh, 1.4, 0.5)).is_empty());
    assert!(!found(&mesh, &bent(&mesh, 1.4, 0.3)).is_empty());
    // One whole turn: the end faces meet.
    let near = bent(&mesh, 1.0, 0.0);
    let found = found(&mesh, &near);
    assert!(found.is_empty(), "{found:?}");
}

#[test]
fn a_region_is_searched_alone_and_named_by_the_numbers_of_the_mesh() {
    let mesh = bar(CellKind::Hex8);
    let positions = bent(&mesh, 1.31, 0.0);
    let whole = Shape::new(&mesh, &positions, None).unwrap().self_intersection();
    let region = Shape::new(&mesh, &positions, Some("body")).unwrap().self_intersection();
    assert_eq!(whole, region);
}
