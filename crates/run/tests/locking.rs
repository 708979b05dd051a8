//! Elements that are too stiff: the factor that `check` estimates from cells and moduli against the one that is measured, as the
//! tip displacement of a clamped bar with second-order cells over that with first-order ones.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::CaseDirectory;
use nastic_language::schema::Command;
use serde_json::{Value, json};

/// A bar clamped at x = 0 under a small load across it at its other end, where the tip is probed.
fn bar(element: &str, size: &[f64], cells: &[usize], poisson: f64) -> Value {
    let last = size.len() - 1;
    let mut traction = vec![0.0; size.len()];
    traction[last] = -1e-3 * size[last] * size[last];
    json!({
        "nastic": 1,
        "mesh": { "box": { "size": size, "cells": cells, "element": element } },
        "materials": [ { "region": "body", "law": "neo_hooke", "young": "100 kPa", "poisson": poisson } ],
        "supports": [ { "surface": "x-", "fix": &["x", "y", "z"][..size.len()] } ],
        "loads": [ { "surface": "x+", "traction": traction } ],
        "probes": [ { "name": "tip", "point": size } ],
    })
}

/// How far the tip moves, and what is warned of elements.
fn tip(element: &str, size: &[f64], cells: &[usize], poisson: f64) -> (f64, Option<String>) {
    tip_by("standard", element, size, cells, poisson)
}

/// The same with a formulation.
fn tip_by(formulation: &str, element: &str, size: &[f64], cells: &[usize], poisson: f64) -> (f64, Option<String>) {
    let mut case = bar(element, size, cells, poisson);
    case["materials"][0]["formulation"] = json!(formulation);
    let case = case.to_string();
    let result = CaseDirectory::new().run(Command::Solve, &case, &[]).unwrap_or_else(|error| panic!("{error}")).result;
    let warnings = result["warnings"].as_array().unwrap().iter().filter(|warning| warning["code"] == "locking");
    let locking: Vec<String> = warnings.map(|warning| warning["message"].as_str().unwrap().to_owned()).collect();
    assert!(locking.len() <= 1, "{locking:?}");
    let moved = result["probes"]["tip"]["displacement"][size.len() - 1].as_f64().unwrap();
    (moved, locking.into_iter().next())
}

/// "... cell 3 about 39.6 times (..."
fn estimated(message: &str) -> f64 {
    let (_, rest) = message.split_once(" about ").unwrap_or_else(|| panic!("{message}"));
    rest.split_once(" times").unwrap().0.parse().unwrap()
}

/// Long cells over few layers, in space and in plane strain: the excess of stiffness is estimated within a tenth.
#[test]
fn the_stiffness_in_bending_is_estimated() {
    let space: [(&[f64], &[usize], f64); 5] = [
        (&[1.0, 0.02, 0.01], &[20, 1, 1], 0.3),
        (&[1.0, 0.02, 0.01], &[10, 1, 1], 0.3),
        (&[1.0, 0.05, 0.05], &[10, 1, 2], 0.0),
        (&[1.0, 0.05, 0.05], &[10, 2, 3], 0.38),
        (&[1.0, 0.1, 0.1], &[8, 1, 1], 0.3),
    ];
    let plane: [(&[f64], &[usize], f64); 4] = [
        (&[1.0, 0.01], &[10, 1], 0.3),
        (&[1.0, 0.05], &[10, 2], 0.2),
        (&[1.0, 0.05], &[12, 1], 0.38),
        (&[1.0, 0.1], &[6, 3], 0.3),
    ];
    let cases = space.map(|case| ("hex8", "hex27", case)).into_iter().chain(plane.map(|case| ("quad4", "quad9", case)));
    for (first, second, (size, cells, poisson)) in cases {
        let ((stiff, described), (right, silent)) =
            (tip(first, size, cells, poisson), tip(second, size, cells, poisson));
        assert_eq!(silent, None, "{second}");
        let message =
            described.unwrap_or_else(|| panic!("{first} {cells:?} of {size:?} is {} times too stiff", right / stiff));
        let (estimate, measured) = (estimated(&message), right / stiff);
        println!("{first} {size:?} {cells:?} nu {poisson}: estimated {estimate:.3}, measured {measured:.3}");
        let share = (estimate - 1.0) / (measured - 1.0);
        assert!((1.0 / 1.1..1.1).contains(&share), "{estimate} estimated, {measured} measured: {message}");
    }
}

/// With the mean dilatation few cells over the thickness of a nearly incompressible body are too soft, long ones too stiff.
#[test]
fn the_softness_in_bending_is_estimated() {
    let cases: [(&[f64], &[usize], f64); 7] = [
        (&[1.0, 0.1, 0.1], &[50, 1, 1], 0.499),
        (&[1.0, 0.05, 0.05], &[20, 1, 1], 0.49),
        (&[1.0, 0.05, 0.05], &[10, 2, 2], 0.499),
        (&[1.0, 0.1], &[50, 1], 0.499),
        (&[1.0, 0.05], &[60, 1], 0.3),
        (&[1.0, 0.05], &[10, 2], 0.499),
        (&[1.0, 0.01], &[10, 2], 0.499),
    ];
    for (size, cells, poisson) in cases {
        let (first, second) = if size.len() == 3 { ("hex8", "hex27") } else { ("quad4", "quad9") };
        let (moved, described) = tip_by("mean_dilatation", first, size, cells, poisson);
        let fine: Vec<usize> = cells.iter().map(|n| 2 * n).collect();
        let (right, silent) = tip_by("linear_dilatation", second, size, &fine, poisson);
        assert_eq!(silent, None, "{second}");
        let message = described.unwrap_or_else(|| panic!("{first} {cells:?} of {size:?}: {}", right / moved));
        let stiffness = if message.contains("too soft") { 1.0 / estimated(&message) } else { estimated(&message) };
        println!("{first} {size:?} {cells:?} nu {poisson}: estimated {stiffness:.3}, measured {:.3}", right / moved);
        let share = (stiffness - 1.0) / (right / moved - 1.0);
        assert!((1.0 / 1.2..1.2).contains(&share), "{stiffness} estimated, {} measured: {message}", right / moved);
    }
}

/// Short cells, and bodies that are not slender, are not reported.
#[test]
fn cells_that_bend_well_are_left_alone() {
    let space: [(&[f64], &[usize]); 3] =
        [(&[1.0, 0.1, 0.1], &[20, 2, 2]), (&[1.0, 0.1, 0.1], &[16, 1, 1]), (&[1.0, 0.25, 0.25], &[4, 1, 1])];
    for (size, cells) in space {
        assert_eq!(tip("hex8", size, cells, 0.3).1, None, "{cells:?} of {size:?}");
    }
    assert_eq!(tip("quad4", &[1.0, 0.1], &[20, 2], 0.3).1, None);
    // what is silent is less than 1.32 times too stiff
    let (stiff, right) =
        (tip("hex8", &[1.0, 0.1, 0.1], &[16, 1, 1], 0.3).0, tip("hex27", &[1.0, 0.1, 0.1], &[16, 1, 1], 0.3).0);
    assert!((1.1..1.32).contains(&(right / stiff)), "{}", right / stiff);
}

/// A bar of 100 x 20 x 10 mm at nu = 0.499: with as many boxes simplices of second order lose 1.6 to 1.8 times what hexahedra
/// and quadrilaterals do, against meshes twice as fine.
#[test]
fn second_order_simplices_of_nearly_incompressible_bodies() {
    let share = |element: &str, size: &[f64], cells: &[usize], fine: f64| {
        let (moved, described) = tip(element, size, cells, 0.499);
        println!("{element} {cells:?}: {:.4}", moved / fine);
        (1.0 - moved / fine, described.is_some_and(|message| message.contains("second-order simplices")))
    };
    let (space, plane): (&[f64], &[f64]) = (&[0.1, 0.02, 0.01], &[0.1, 0.01]);
    let fine = tip("hex27", space, &[20, 4, 4], 0.499).0;
    let of = |element| share(element, space, &[10, 2, 2], fine);
    let (tet, serendipity, full) = (of("tet10"), of("hex20"), of("hex27"));
    assert!(tet.0 > 0.05 && tet.0 > 1.6 * full.0 && serendipity.0 < 1.1 * full.0, "{tet:?} {serendipity:?} {full:?}");
    assert_eq!([tet.1, serendipity.1, full.1], [true, false, false]);
    let fine = tip("quad9", plane, &[40, 8], 0.499).0;
    let of = |element| share(element, plane, &[10, 2], fine);
    let (tri, serendipity, full) = (of("tri6"), of("quad8"), of("quad9"));
    assert!(tri.0 > 0.05 && tri.0 > 1.5 * full.0 && serendipity.0 < 1.1 * full.0, "{tri:?} {serendipity:?} {full:?}");
    assert_eq!([tri.1, serendipity.1, full.1], [true, false, false]);
    assert_eq!(tip("tet10", space, &[10, 2, 2], 0.49).1, None);
}

/// A bar of 100 x 20 x 10 mm at nu = 0.4999: hexahedra of second order lose a tenth with two cells across, a third with one.
#[test]
fn second_order_hexahedra_of_almost_incompressible_bodies() {
    let size: &[f64] = &[0.1, 0.02, 0.01];
    let fine = tip_by("linear_dilatation", "hex27", size, &[10, 2, 2], 0.4999).0;
    for (element, cells, least) in [("hex20", [8, 2, 1], 0.08), ("hex27", [3, 1, 1], 0.25)] {
        let (moved, described) = tip(element, size, &cells, 0.4999);
        println!("{element} {cells:?}: {:.4}", moved / fine);
        assert!(1.0 - moved / fine > least, "{element}: {}", moved / fine);
        assert!(described.is_some_and(|message| message.contains("linear_dilatation")), "{element}");
        assert_eq!(tip(element, size, &cells, 0.499).1, None, "{element}");
        assert_eq!(tip_by("linear_dilatation", element, size, &cells, 0.4999).1, None, "{element}");
    }
}
