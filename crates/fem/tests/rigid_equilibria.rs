//! Rigid bodies at rest that contact alone holds: on a floor, between pads that close on them; what is free is named.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use crate::rigid_body::parts;
use crate::surface_friction::disc_and_pads;
use common::Outcome;
use common::block::STRICT;
use nastic_energy::NeoHooke;
use nastic_fem::{Cause, Contact, Instant, MovingSupport, RigidBody, Solid, State, StateError, SurfaceContact};
use nastic_mesh::spatial::Obstacle;
use nastic_tensor::Vec3;

/// Weight per volume, N/m^3.
const WEIGHT: f64 = 9810.0;

/// A rigid disc in plane strain above a floor, between two soft pads that are held at their outer sides.
fn between_pads(floor: Option<f64>) -> Outcome<Solid> {
    let solid = Solid::new(parts(&disc_and_pads()?, |x| x.x.abs() < 0.101)?)?
        .material("soft", NeoHooke::new(4e4, 6e4)?)?
        .material("hard", NeoHooke::new(4e5, 6e5)?)?
        .body_force("soft", Vec3::new(0.0, -WEIGHT, 0.0))?
        .body_force("hard", Vec3::new(0.0, -WEIGHT, 0.0))?
        .motion(MovingSupport::of("left pad", "left"))?
        .motion(MovingSupport::of("right pad", "right"))?
        .rigid(&RigidBody::new("ball", "hard"))?;
    let grip = |solid: Solid| solid.surface_contact(SurfaceContact::between("grip", "ball", "inner"));
    match floor {
        Some(height) => {
            let floor = Obstacle::half_space([0.0, height, 0.0], [0.0, 1.0, 0.0]);
            Ok(grip(solid.contact(Contact::of("floor", "ball", floor))?)?)
        }
        None => Ok(grip(solid)?),
    }
}

/// With the pads moved inwards by a length.
fn closed(solid: &Solid, by: f64) -> Result<State, StateError> {
    let mut controls = solid.controls();
    controls.values_mut(0)[0] = by;
    controls.values_mut(1)[0] = -by;
    solid.solve(&controls, &STRICT)
}

fn force(solid: &Solid, state: &State, name: &str) -> Outcome<[f64; 3]> {
    let all = solid.model().touches(&Instant::of(state));
    Ok(all.into_iter().find(|(own, _)| own == name).ok_or("no such contact")?.1.force)
}

/// It lies on the floor, and between the pads when these have closed on it: floor and pads carry its weight.
#[test]
fn a_rigid_disc_lies_on_a_floor_and_between_pads() -> Outcome {
    let solid = between_pads(Some(-1e-4))?;
    let volumes = solid.mesh().volumes(solid.mesh().points());
    let area: f64 = solid.mesh().region("hard")?.iter().map(|&cell| volumes[cell as usize]).sum();
    for (by, most) in [(0.0, 60), (0.02, 700)] {
        let state = closed(&solid, by)?;
        let (up, grip) = (force(&solid, &state, "floor")?[1], force(&solid, &state, "grip")?);
        assert!(((up + grip[1]) / (WEIGHT * area) - 1.0).abs() < 1e-6, "{up} and {grip:?}");
        let pressed = solid
            .model()
            .touches(&Instant::of(&state))
            .into_iter()
            .any(|(name, touch)| name == "grip" && touch.pressing > 1.0);
        assert_eq!(pressed, by > 0.0);
        assert!(state.report.newton <= most, "{:?}", state.report);
    }
    Ok(())
}

/// Nothing is below it: the error names the body and how it is free.
#[test]
fn a_rigid_disc_that_nothing_carries_is_named() -> Outcome {
    let solid = between_pads(None)?;
    let error = closed(&solid, 0.0).err().ok_or("an equilibrium")?;
    let StateError::NoConvergence { cause: Cause::FreeMotion(free), .. } = &error else { panic!("{error}") };
    assert_eq!(free.what, "the rigid body \"ball\"");
    assert!(error.to_string().contains("held by contact alone"), "{error}");
    Ok(())
}
