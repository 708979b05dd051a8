//! Obstacles that are inside of the body between the samples of a contact.

#![allow(clippy::unwrap_used)] // helpers of tests

use crate::common;

use common::block::STRICT;
use common::{Outcome, regular};
use nastic_energy::NeoHooke;
use nastic_fem::{Contact, Instant, Solid, Touch};
use nastic_mesh::CellKind;
use nastic_mesh::spatial::Obstacle;

/// A block of 4 x 2 of so many cells along its height, into which an obstacle goes by 0.08 from above.
fn pressed(cells: usize, obstacle: &Obstacle, refine: Option<usize>) -> Outcome<Touch> {
    let contact = Contact::of("punch", "y+", obstacle.clone()).thickness(1e-3).stiffness(1e7);
    let contact = if let Some(refine) = refine { contact.refine(refine) } else { contact };
    let solid = Solid::new(regular(CellKind::Quad4, [4.0, 2.0, 0.0], [2 * cells, cells, 1])?)?
        .material("body", NeoHooke::new(4e4, 6e4)?)?
        .clamp("y-")?
        .contact(contact)?;
    let mut controls = solid.controls();
    controls.values_mut(0)[1] = -0.08;
    let state = solid.solve(&controls, &STRICT)?;
    Ok(solid.model().contacts().touches(&Instant::of(&state)).remove(0).1)
}

/// How deep the obstacle is between samples, as a share of how deep it is pressed.
fn share(touch: &Touch) -> f64 {
    -touch.between.unwrap().0 / touch.approach
}

/// A punch with edges that are sharper than facets. Where nodes alone carry, its edges are deep inside between them and the force is too small; with the
/// samples that are taken by themselves neither is so.
#[test]
fn edges_between_nodes_are_seen() -> Outcome {
    let punch = |half: f64| Obstacle::aligned_box([2.03 - half, 2.001, -1.0], [2.03 + half, 3.0, 1.0]);
    // on 192 cells along the height, whatever the samples
    for (half, force) in [(0.5, 8880.0), (1.0, 13_730.0)] {
        for cells in [4, 8, 12] {
            let at_nodes = pressed(cells, &punch(half), Some(1))?;
            let found = pressed(cells, &punch(half), None)?;
            let [coarse, fine] = [&at_nodes, &found].map(|touch| -touch.force[1] / force - 1.0);
            assert!(share(&at_nodes) > 0.25 && coarse < -0.05, "{half}, {cells}: {}, {coarse}", share(&at_nodes));
            assert!(share(&found) < 0.15 && fine.abs() < 0.09, "{half}, {cells}: {}, {fine}", share(&found));
            // that place is on the surface, within the punch, and no node
            let [x, y, _] = at_nodes.between.unwrap().1;
            assert!((2.03 - half..2.03 + half).contains(&x) && (1.9..2.0).contains(&y), "({x}, {y})");
            assert!((x * cells as f64).fract() > 0.01, "{x}");
        }
    }
    Ok(())
}

/// A ball sinks in between nodes by `h^2 / (8 R)`, beside the depth `a^2 / R` little as soon as cells are small beside the contact.
#[test]
fn a_ball_is_inside_between_coarse_nodes() -> Outcome {
    let ball = Obstacle::sphere([2.03, 6.001, 0.0], 4.0);
    let coarse = share(&pressed(3, &ball, Some(1))?);
    let fine = share(&pressed(12, &ball, Some(1))?);
    assert!(coarse > 0.1 && fine < 0.01, "{coarse}, {fine}");
    Ok(())
}

/// What no sample meets is there all the same.
#[test]
fn an_obstacle_that_no_sample_meets_is_seen() -> Outcome {
    let thin = Obstacle::capsule([2.12, 2.0, 0.0], [2.12, 2.1, 0.0], 0.03);
    let touch = pressed(4, &thin, Some(1))?;
    assert!(touch.area == 0.0 && touch.smallest_gap > 0.0, "{touch:?}");
    let (gap, place) = touch.between.unwrap();
    assert!((gap + 0.025).abs() < 1e-3 && (place[0] - 2.12).abs() < 0.03, "{gap}, {place:?}");
    Ok(())
}
