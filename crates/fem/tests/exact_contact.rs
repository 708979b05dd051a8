//! Contact without a layer: closed forms, complementarity, independence of the layer, refusals.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::block::STRICT;
use common::{Outcome, regular};
use nastic_energy::NeoHooke;
use nastic_fem::{Contact, ContactLaw, ExactEquilibrium, Instant, Solid, StateError, Touch, Workspace};
use nastic_mesh::CellKind;
use nastic_mesh::spatial::Obstacle;
use nastic_tensor::Vec3;

const E: f64 = 1e5;

fn law() -> NeoHooke {
    NeoHooke::new(E / 2.6, E * 0.3 / (1.3 * 0.4)).unwrap()
}

/// What the contact carries with its layer and without, its obstacle moved down.
fn exact(solid: &Solid, down: f64) -> Outcome<(Touch, Touch, ExactEquilibrium)> {
    let mut controls = solid.controls();
    controls.values_mut(0)[2] = -down;
    let layered = solid.solve(&controls, &STRICT)?;
    let found = solid.model().stability().exact_contact(&layered, &STRICT, &mut Workspace::default())?;
    let of = |model: &nastic_fem::Model, state| model.contacts().touches(&Instant::of(state)).remove(0).1;
    Ok((of(solid.model(), &layered), of(&found.model, &found.state), found))
}

/// A block falls to its floor: no gap is left, whatever the layer, and the floor carries its weight.
#[test]
fn a_block_stands_on_its_floor() -> Outcome {
    let density = 1e5;
    for (kind, thickness, stiffness) in
        [(CellKind::Hex8, 1e-2, E), (CellKind::Tet10, 1e-3, 10.0 * E), (CellKind::Hex27, 3e-2, 0.5 * E)]
    {
        let floor = Obstacle::half_space([0.0, 0.0, -0.05], [0.0, 0.0, 1.0]);
        let contact = Contact::of("floor", "z-", floor).thickness(thickness).stiffness(stiffness);
        let solid = Solid::new(regular(kind, [1.0; 3], [2, 2, 2])?)?
            .material("body", law())?
            .displace("x-", [Some(0.0), None, None])?
            .displace("y-", [None, Some(0.0), None])?
            .body_force("body", Vec3::new(0.0, 0.0, -0.1 * density))?
            .contact(contact)?;
        let (layered, touch, found) = exact(&solid, 0.0)?;
        assert!((touch.force[2] / (0.1 * density) - 1.0).abs() < 1e-9, "{kind}: {:?}", touch.force);
        assert!(touch.smallest_gap.abs() <= 1e-6 * thickness && touch.mean_gap.abs() <= 1e-6 * thickness, "{touch:?}");
        assert!(layered.mean_gap > 0.1 * thickness, "{layered:?}");
        assert!(found.rounds >= 2 && found.rounds <= 10, "{kind}: {} rounds", found.rounds);
        let lowest = solid.mesh().points().iter().enumerate().filter(|(_, x)| x[2].abs() < 1e-9);
        for (node, _) in lowest {
            assert!((found.state.u[3 * node + 2] + 0.05).abs() <= 1e-6 * thickness, "{kind}: node {node}");
        }
    }
    Ok(())
}

/// The ball above the block, and how deep it goes into it.
const BALL: [f64; 3] = [0.0, 0.0, 1.5];
const DEPTH: f64 = 0.03;

fn indented(thickness: f64, stiffness: f64) -> Outcome<Solid> {
    let ball = Obstacle::sphere(BALL, 0.5);
    let contact = Contact::of("ball", "z+", ball).thickness(thickness).stiffness(stiffness);
    Ok(Solid::new(regular(CellKind::Hex8, [1.0; 3], [8, 8, 8])?)?
        .material("body", law())?
        .displace("x-", [Some(0.0), None, None])?
        .displace("y-", [None, Some(0.0), None])?
        .clamp("z-")?
        .contact(contact)?)
}

/// A ball indents a block: gaps and pressures are complementary, and no trace of the layer is left in the force.
#[test]
fn an_indentation_does_not_depend_on_the_layer() -> Outcome {
    let mut forces = Vec::new();
    for (thickness, stiffness) in [(3e-3, 10.0 * E), (1e-3, 100.0 * E), (3e-4, 100.0 * E)] {
        let (layered, touch, found) = exact(&indented(thickness, stiffness)?, DEPTH)?;
        assert!(touch.smallest_gap > -1e-6 * thickness, "{touch:?}");
        let pressures = found.model.contacts().nodal_pressures(&Instant::of(&found.state)).unwrap();
        let ball = Obstacle::sphere([0.0, 0.0, BALL[2] - DEPTH], 0.5);
        for (node, x) in found.model.discretization().mesh().points().iter().enumerate().filter(|(_, x)| x[2] > 0.999) {
            let place: [f64; 3] = std::array::from_fn(|i| x[i] + found.state.u[3 * node + i]);
            let (gap, p) = (ball.distance(&place), pressures[node]);
            assert!(p >= 0.0 && gap > -1e-5 * thickness && (p == 0.0 || gap < 1e-5 * thickness), "{node}: {gap} {p}");
        }
        forces.push([layered.force[2], touch.force[2]]);
    }
    let [_, exact] = forces[1];
    assert!(forces.iter().all(|[_, force]| (force / exact - 1.0).abs() < 1e-4), "{forces:?}");
    // at a hundredth of the depth the layer changes the force by less than three per cent
    assert!((forces[2][0] / exact - 1.0).abs() < 0.03 && (forces[0][0] / exact - 1.0).abs() > 1e-3, "{forces:?}");
    Ok(())
}

/// Also where the layer let the body in by more than its thickness.
#[test]
fn a_layer_that_is_too_soft_is_led_out_of() -> Outcome {
    let (layered, touch, found) = exact(&indented(2e-3, 0.05 * E)?, DEPTH)?;
    // a pressure beyond 2.25 times the stiffness
    assert!(layered.sunk > 0.5 * 2e-3, "{layered:?}");
    assert!(touch.smallest_gap > -1e-5 * 2e-3, "{touch:?}");
    let (_, other, _) = exact(&indented(1e-3, 100.0 * E)?, DEPTH)?;
    assert!((touch.force[2] / other.force[2] - 1.0).abs() < 1e-4, "{} {}", touch.force[2], other.force[2]);
    assert!(found.state.report.newton < 400, "{:?}", found.state.report);
    Ok(())
}

#[test]
fn what_does_not_go_with_exact_contact_is_refused() -> Outcome {
    let block = || -> Outcome<Solid> {
        Ok(Solid::new(regular(CellKind::Hex8, [1.0; 3], [1, 1, 1])?)?.material("body", law())?.clamp("z-")?)
    };
    let floor = Contact::of("floor", "z+", Obstacle::half_space([0.0, 0.0, 2.0], [0.0, 0.0, -1.0]));
    let between = Contact::between("sides", "x-", "x+");
    for (solid, message) in [
        (block()?, "nothing touches it"),
        (block()?.contact(floor.clone().law(ContactLaw::Log))?, "with the cubic law"),
        (block()?.contact(floor.friction(0.5, 1e-3))?, "friction depends on the path"),
        (block()?.contact(between)?, "for obstacles"),
    ] {
        let refused = solid.model().stability().exact_contact(&solid.rest(), &STRICT, &mut Workspace::default());
        let error = match refused {
            Err(error @ StateError::Problem(_)) => error.to_string(),
            other => panic!("{other:?}"),
        };
        assert!(error.contains(message), "{error}");
    }
    Ok(())
}
