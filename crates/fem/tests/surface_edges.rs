//! Edges of bodies between the samples of their surfaces: none goes through another one.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::block::STRICT;
use common::{Outcome, cut, noise, regular};
use nastic_energy::NeoHooke;
use nastic_fem::{Contact, Inadmissible, Instant, Solid, State, StateError};
use nastic_mesh::CellKind;
use nastic_mesh::spatial::Shape;
use nastic_tensor::Vec3;

/// Distance of the beams at rest, their width and length.
const GAP: f64 = 0.1;
const WIDTH: f64 = 0.3;
const LENGTH: f64 = 1.2;

/// Two beams of a cell each, one along x, above it one along y: all nodes of either are far from the other one.
fn beams(refine: usize) -> Outcome<Solid> {
    let full = regular(CellKind::Hex8, [1.0, 1.0, 3.0], [1, 1, 3])?;
    let place = |x: Vec3| match x.z < 1.5 {
        true => Vec3::new(LENGTH * (x.x - 0.5), WIDTH * (x.y - 0.5), WIDTH * x.z),
        false => Vec3::new(WIDTH * (x.x - 0.5), LENGTH * (x.y - 0.5), WIDTH * (x.z - 1.0) + GAP),
    };
    let mesh = cut(
        &full,
        |x| (x.z - 1.5).abs() > 0.5,
        place,
        &[
            ("lower", &|x| x.z < 1.1),
            ("upper", &|x| x.z > 1.9),
            ("bottom", &|x| x.z < 1e-9),
            ("top", &|x| x.z > 3.0 - 1e-9),
        ],
    )?;
    let contact = Contact::between("beams", "lower", "upper").refine(refine);
    let law = NeoHooke::new(4e4, 6e4)?;
    Ok(Solid::new(mesh)?.material("body", law)?.clamp("bottom")?.contact(contact)?)
}

fn crosses(solid: &Solid, u: &[f64]) -> Outcome<bool> {
    let place = |(node, x): (usize, &[f64; 3])| std::array::from_fn(|i| x[i] + u[3 * node + i]);
    let positions: Vec<[f64; 3]> = solid.mesh().points().iter().enumerate().map(place).collect();
    Ok(!Shape::new(solid.mesh(), &positions, None)?.self_intersection().is_empty())
}

/// However the upper beam moves and turns, it stays on its side of the lower one, though samples lie at the ends alone.
#[test]
fn beams_do_not_go_through_each_other() -> Outcome {
    let solid = beams(1)?;
    let (controls, rest) = (solid.controls(), solid.rest().u);
    let (mut shortened, mut would_cross) = (0, 0);
    for trial in 0..60 {
        let draw = |i: usize| noise(1000 * trial + i);
        let (by, turn) = (Vec3::new(draw(0), draw(1), -draw(2).abs()), Vec3::new(draw(3), draw(4), draw(5)));
        let to = common::nodal(solid.mesh(), |x| match x.z > WIDTH + 0.5 * GAP {
            true => by + turn.cross(&(x - Vec3::new(0.0, 0.0, WIDTH + GAP))),
            false => Vec3::zeros(),
        });
        let share = solid.model().moves().admissible_move(&Instant::new(&rest, &controls, 1.0), &to)?;
        let moved: Vec<f64> = to.iter().map(|to| share * to).collect();
        assert!(!crosses(&solid, &moved)?, "trial {trial}: {share}");
        shortened += usize::from(share < 1.0);
        would_cross += usize::from(crosses(&solid, &to)?);
    }
    assert!(shortened >= would_cross && would_cross > 10, "{shortened}, {would_cross}");
    Ok(())
}

/// Beams that are pressed together where no sample pushes end with a typed error that says where; with more samples they carry.
#[test]
fn where_edges_would_meet_a_solve_says_so() -> Outcome {
    let press = |refine: usize| -> Outcome<Result<(Solid, State), StateError>> {
        let solid = beams(refine)?.displace("top", [Some(0.0), Some(0.0), Some(-1.2 * GAP)])?;
        Ok(solid.solve(&solid.controls(), &STRICT).map(|state| (solid, state)))
    };
    let refused = press(1)?.err().ok_or("the beams went through each other")?;
    let text = refused.to_string();
    assert!(text.contains("edges of the surfaces of \"beams\"") && text.contains("refine"), "{text}");
    let Some(Inadmissible::EdgesMeet { place, distance, .. }) = at(&refused) else { panic!("{refused:?}") };
    assert!(place[0].abs() < WIDTH && place[1].abs() < WIDTH && *distance < 0.1 * GAP, "{place:?}, {distance}");
    let (solid, state) = press(8)?.map_err(|error| error.to_string())?;
    assert!(!crosses(&solid, &state.u)?);
    let touch = solid.model().contacts().touches(&Instant::of(&state)).remove(0).1;
    // on the lower one, which the upper one presses down
    assert!(touch.force[2] < -10.0 && touch.smallest_gap > 0.0, "{touch:?}");
    Ok(())
}

fn at(error: &StateError) -> Option<&Inadmissible> {
    match error {
        StateError::Inadmissible { at, .. } | StateError::Start { at } => Some(at),
        _ => None,
    }
}
