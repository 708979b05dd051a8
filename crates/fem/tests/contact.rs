//! Contact with obstacles at rest: patch test, closed forms of a pressed block, the layer's offset, balance, starts inside, refusals.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::block::STRICT;
use common::{Outcome, distorted, largest, regular};
use nastic_energy::{NeoHooke, NeoHookeIsochoric};
use nastic_fem::{Cause, Contact, ContactLaw, Instant, Solid, SolveOptions, State, StateError};
use nastic_mesh::spatial::Obstacle;
use nastic_mesh::{CellKind, box_mesh};
use nastic_tensor::Vec3;

/// Young's modulus, Poisson's ratio 0.3.
const E: f64 = 1e5;

fn law() -> NeoHooke {
    NeoHooke::new(E / 2.6, E * 0.3 / (1.3 * 0.4)).unwrap()
}

/// A unit block on rollers, free to widen, below a plate whose contact layer begins at the top: height of the block along the last axis.
fn block(kind: CellKind, contact: impl Fn(Contact) -> Contact) -> Outcome<Solid> {
    let up = kind.dim() - 1;
    let mesh = distorted(regular(kind, [1.0, 1.0, if up == 2 { 1.0 } else { 0.0 }], [2, 2, 2])?, 0.15)?;
    let names = [["x-", "y-", "z-"], ["x+", "y+", "z+"]];
    let mut solid = Solid::new(mesh)?.material("body", law())?;
    for (axis, name) in names[0].iter().enumerate().take(up + 1) {
        let mut values = [None; 3];
        values[axis] = Some(0.0);
        solid = solid.displace(*name, values)?;
    }
    let mut normal = [0.0; 3];
    normal[up] = -1.0;
    let mut point = [0.0; 3];
    point[up] = 1.0 + DELTA;
    let plate = Obstacle::half_space(point, normal);
    Ok(solid.contact(contact(Contact::of("plate", names[1][up], plate).thickness(DELTA)))?)
}

const DELTA: f64 = 0.01;

fn press(solid: &Solid, axis: usize, by: f64) -> Result<State, StateError> {
    let mut controls = solid.controls();
    let block = solid.model().controllable().iter().position(|known| known.name == "plate").unwrap();
    controls.values_mut(block)[axis] = -by;
    solid.solve(&controls, &STRICT)
}

fn quantity(solid: &Solid, state: &State, name: &str) -> f64 {
    let all = solid.model().quantities(&Instant::of(state)).unwrap();
    all.into_iter().find(|(_, own, _)| *own == name).unwrap().2
}

/// A frictionless plate presses a block to 0.9, 0.8, 0.7 of its height: the nominal pressure in closed form, uniform to rounding on every
/// element, distorted ones too (contact patch test), for both laws and with samples between the nodes.
#[test]
fn a_pressed_block_is_uniform_on_every_element() -> Outcome {
    let spatial = [(0.9, 10795.4597, 1.0308316), (0.8, 23561.9882, 1.0630566), (0.7, 39062.2591, 1.0958709)];
    let plane = [(0.9, 11832.0302), (0.8, 25644.8829), (0.7, 41983.3371)];
    for kind in common::kinds() {
        let up = kind.dim() - 1;
        for (refine, contact_law) in [(1, ContactLaw::Cubic), (3, ContactLaw::Cubic), (1, ContactLaw::Log)] {
            let k = if contact_law == ContactLaw::Log { E } else { 100.0 * E };
            let solid = block(kind, |contact| contact.refine(refine).law(contact_law).stiffness(k))?;
            // the others take as long as all of the first together
            for case in if refine == 1 && contact_law == ContactLaw::Cubic { 0..3 } else { 0..1 } {
                let (height, pressure) = if up == 2 { (spatial[case].0, spatial[case].1) } else { plane[case] };
                // the gap that carries the pressure, of a unit area in the reference body
                let gap = gap_of(contact_law, k, pressure);
                let state = press(&solid, up, 1.0 + DELTA - height - gap)?;
                let force = quantity(&solid, &state, if up == 2 { "force_z" } else { "force_y" });
                assert!((force / -pressure - 1.0).abs() < 1e-8, "{kind} {refine} {contact_law:?}: {force} {pressure}");
                let mesh = solid.mesh();
                let affine = |node: usize, i: usize| {
                    let x = mesh.points()[node][i];
                    let corner = common::node_at(mesh, if up == 2 { [1.0; 3] } else { [1.0, 1.0, 0.0] }).unwrap();
                    let widened = if up == 2 { spatial[case].2 } else { 1.0 + state.u[2 * corner] };
                    if i == up { (height - 1.0) * x } else { (widened - 1.0) * x }
                };
                let error: Vec<f64> =
                    (0..state.u.len()).map(|dof| state.u[dof] - affine(dof / kind.dim(), dof % kind.dim())).collect();
                // the stretches of the table have eight digits
                assert!(largest(&error) < 1e-7, "{kind} {refine} {contact_law:?}: {:e}", largest(&error));
                let top = mesh.points().iter().enumerate().filter(|(_, x)| (x[up] - 1.0).abs() < 1e-12);
                let heights: Vec<f64> = top.map(|(node, _)| state.u[kind.dim() * node + up]).collect();
                let spread = heights.iter().fold(0.0f64, |most, h| most.max((h - heights[0]).abs()));
                assert!(spread < 1e-10, "{kind} {refine} {contact_law:?}: {spread:e}");
                let pressures = solid.model().contacts().nodal_pressures(&Instant::of(&state)).unwrap();
                for (x, found) in mesh.points().iter().zip(&pressures) {
                    let expected = if (x[up] - 1.0).abs() < 1e-12 { pressure } else { 0.0 };
                    assert!((found - expected).abs() < 1e-6 * pressure, "{kind} {refine}: {found} at {x:?}");
                }
            }
        }
    }
    Ok(())
}

fn gap_of(law: ContactLaw, k: f64, pressure: f64) -> f64 {
    if law == ContactLaw::Cubic {
        return DELTA * (1.0 - (pressure / k).sqrt());
    }
    let of = |s: f64| k * (2.0 * (s - 1.0) * s.ln() + (s - 1.0) * (s - 1.0) / s);
    let (mut low, mut high) = (1e-6, 1.0);
    for _ in 0..60 {
        let middle: f64 = 0.5 * (low + high);
        if of(middle) > pressure { low = middle } else { high = middle }
    }
    low * DELTA
}

/// `gap = delta (1 - sqrt(p/k))`: what is left of the layer falls with the stiffness to the power -1/2 under one weight.
#[test]
fn the_layer_yields_with_the_root_of_the_stiffness() -> Outcome {
    let sunk = |k: f64| -> Outcome<f64> {
        let mesh = regular(CellKind::Hex8, [1.0, 1.0, 1.0], [1, 1, 1])?;
        let floor = Obstacle::half_space([0.0, 0.0, -DELTA], [0.0, 0.0, 1.0]);
        let solid = Solid::new(mesh)?
            .material("body", law())?
            .displace("x-", [Some(0.0), None, None])?
            .displace("y-", [None, Some(0.0), None])?
            .body_force("body", Vec3::new(0.0, 0.0, -100.0))?
            .contact(Contact::of("floor", "z-", floor).thickness(DELTA).stiffness(k))?;
        let state = solid.solve(&solid.controls(), &STRICT)?;
        let force = quantity(&solid, &state, "force_z");
        assert!((force - 100.0).abs() < 1e-8 * 100.0, "{force}");
        Ok(DELTA - quantity(&solid, &state, "smallest_gap"))
    };
    let slope = (sunk(1e5)? / sunk(1e4)?).log10();
    assert!((slope + 0.5).abs() < 0.01, "{slope}");
    Ok(())
}

/// A cube on rollers that stands above a floor by many layers; pulled down or up by a body force.
fn above_a_floor(force: f64) -> Outcome<Solid> {
    let floor = Obstacle::half_space([0.0, 0.0, -0.4], [0.0, 0.0, 1.0]);
    Ok(Solid::new(regular(CellKind::Hex8, [1.0, 1.0, 1.0], [2, 2, 2])?)?
        .material("body", law())?
        .displace("x-", [Some(0.0), None, None])?
        .displace("y-", [None, Some(0.0), None])?
        .body_force("body", Vec3::new(0.0, 0.0, force))?
        .contact(Contact::of("floor", "z-", floor).thickness(DELTA))?)
}

/// What nothing but a floor holds falls to it and stands there; what is pulled away from it ends with an error that names how it is free.
#[test]
fn a_body_finds_the_floor_that_holds_it() -> Outcome {
    let solid = above_a_floor(-300.0)?;
    let state = solid.solve(&solid.controls(), &STRICT)?;
    let force = quantity(&solid, &state, "force_z");
    assert!((force / 300.0 - 1.0).abs() < 1e-8, "{force}");
    assert!(quantity(&solid, &state, "smallest_gap") > 0.0);
    let away = above_a_floor(300.0)?;
    let error = away.solve(&away.controls(), &STRICT).err().ok_or("an equilibrium")?;
    let StateError::NoConvergence { cause: Cause::FreeMotion(free), .. } = &error else { panic!("{error}") };
    assert_eq!((free.what.as_str(), free.count, free.example.as_str()), ("the body", 1, "shift along z"));
    assert!(error.to_string().contains("held by contact alone"), "{error}");
    Ok(())
}

/// A ball that goes a tenth of its height into a block carries what it touches along: a third of the iterations and less than a tenth of the factorisations of
/// load steps that begin at the state before them (111 and 315).
#[test]
fn what_an_obstacle_touches_goes_with_it() -> Outcome {
    let ball = Obstacle::sphere([1.0, 1.0, 3.0], 2.0);
    let solid = Solid::new(box_mesh([2.0, 2.0, 1.0], [12, 12, 8], CellKind::Hex8)?)?
        .material("body", NeoHookeIsochoric::new(4e4, 2e5)?)?
        .clamp("z-")?
        .contact(Contact::of("plate", "z+", ball))?;
    let state = press(&solid, 2, 0.1)?;
    let work = state.report;
    assert!(work.newton <= 45 && work.factorisations <= 30, "{work:?}");
    // the same in short steps, each from the last
    let mut near = solid.solve(&solid.controls(), &STRICT)?;
    for step in 1..=20 {
        let mut controls = solid.controls();
        controls.values_mut(0)[2] = -0.005 * f64::from(step);
        near = solid.solve(&controls, &SolveOptions { near: Some(&near), ..STRICT })?;
    }
    let [once, slowly] = [&state, &near].map(|state| quantity(&solid, state, "force_z"));
    assert!((once / slowly - 1.0).abs() < 1e-8 && once < -1e4, "{once} {slowly}");
    Ok(())
}
