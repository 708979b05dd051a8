//! Rigid bodies at rest that contact alone holds: on a floor, between pads that close on them; what is free is named.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use crate::rigid_body::parts;
use crate::surface_friction::disc_and_pads;
use common::Outcome;
use common::block::STRICT;
use nastic_energy::NeoHooke;
use nastic_fem::{
    Cause, Contact, FemError, Foundation, Instant, MovingSupport, RigidBody, Solid, SolveOptions, State, StateError,
};
use nastic_mesh::spatial::Obstacle;
use nastic_mesh::{CellKind, box_mesh};
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
    let grip = |solid: Solid| solid.contact(Contact::between("grip", "ball", "inner"));
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
    let all = solid.model().contacts().touches(&Instant::of(state));
    Ok(all.into_iter().find(|(own, _)| own == name).ok_or("no such contact")?.1.force)
}

/// It lies on the floor, and between the pads when these have closed on it: floor and pads carry its weight.
#[test]
fn a_rigid_disc_lies_on_a_floor_and_between_pads() -> Outcome {
    let solid = between_pads(Some(-1e-4))?;
    let volumes = solid.mesh().volumes(solid.mesh().points());
    let area: f64 = solid.mesh().region("hard")?.iter().map(|&cell| volumes[cell as usize]).sum();
    for (by, most) in [(0.0, 120), (0.02, 700)] {
        let state = closed(&solid, by)?;
        // it stands on a corner of its polygon, from which it may roll; that it may slide does not count
        assert_eq!(solid.negative_pivots(&state)?, usize::from(by == 0.0));
        let (up, grip) = (force(&solid, &state, "floor")?[1], force(&solid, &state, "grip")?);
        assert!(((up + grip[1]) / (WEIGHT * area) - 1.0).abs() < 1e-6, "{up} and {grip:?}");
        let pressed = solid
            .model()
            .contacts()
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

/// A rigid block in space of 40 x 30 x 20 mm, turned about an axis and put above the planes (a point and a normal of each).
fn block_above(
    planes: &[[[f64; 3]; 2]],
    (turn, axis): (f64, Vec3),
    above: f64,
    (bed, pull): (f64, Vec3),
) -> Outcome<Solid> {
    let rotation = nalgebra::Rotation3::new(axis.normalize() * turn);
    let middle = Vec3::new(0.02, 0.015, 0.01);
    let lowest = [0, 1, 2, 3, 4, 5, 6, 7].map(|k| {
        let corner =
            Vec3::new(f64::from(k & 1), f64::from(k >> 1 & 1), f64::from(k >> 2)).component_mul(&(2.0 * middle));
        (rotation * (corner - middle)).z
    });
    let up = Vec3::new(0.03, 0.03, above - lowest.into_iter().fold(f64::INFINITY, f64::min));
    let place = |x: [f64; 3]| (up + rotation * (Vec3::from(x) - middle)).into();
    let mesh = box_mesh([0.04, 0.03, 0.02], [4, 3, 2], CellKind::Hex8)?.mapped(place)?;
    let mut solid = Solid::new(mesh)?
        .material("body", NeoHooke::new(4e5, 6e5)?)?
        .body_force("body", pull * WEIGHT)?
        .rigid(&RigidBody::new("block", "body"))?;
    if bed > 0.0 {
        solid = solid.foundation(Foundation::on("skin", bed))?;
    }
    for (k, [point, normal]) in planes.iter().enumerate() {
        solid = solid.contact(Contact::of(&format!("plane {k}"), "skin", Obstacle::half_space(*point, *normal)))?;
    }
    Ok(solid)
}

const FLOOR: [[f64; 3]; 2] = [[0.0; 3], [0.0, 0.0, 1.0]];

/// How far a block reaches above its lowest points.
fn height(solid: &Solid, state: &State) -> f64 {
    let z = solid.mesh().points().iter().zip(state.u.chunks(3)).map(|(x, u)| x[2] + u[2]);
    let (low, high) = z.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), z| (low.min(z), high.max(z)));
    high - low
}

/// From far above, however it is turned, it comes to lie flat on one of its faces, on a bed so weak that it carries nothing.
#[test]
fn a_rigid_block_lies_down() -> Outcome {
    let slanted = Vec3::new(1.0, 0.4, 0.1);
    let cases = [
        (0.0, slanted, [1e-3, 1e2], 0.02, 40),
        (0.0, slanted, [0.1, 1e-2], 0.02, 40),
        (0.4, slanted, [1e-3, 1e2], 0.02, 200),
        (0.4, slanted, [0.1, 1e-2], 0.02, 200),
        (1.2, Vec3::y(), [0.01, 1.0], 0.04, 250),
        (2.0, Vec3::new(1.0, 2.0, 3.0), [0.1, 10.0], 0.03, 1000),
    ];
    for (turn, axis, [above, bed], high, most) in cases {
        let solid = block_above(&[FLOOR], (turn, axis), above, (bed, -Vec3::z()))?;
        let state = solid.solve(&solid.controls(), &STRICT)?;
        let carried = force(&solid, &state, "plane 0")?[2] / (WEIGHT * 0.04 * 0.03 * 0.02);
        assert!(carried < 1.0 && carried > 0.96, "{turn}, {above}, {bed}: {carried}");
        assert!((height(&solid, &state) - high).abs() < 1e-6, "{turn}, {above}, {bed}: {}", height(&solid, &state));
        assert!(state.report.newton <= most && state.report.cuts == 0, "{turn}, {above}, {bed}: {:?}", state.report);
        assert_eq!(solid.negative_pivots(&state)?, 0);
    }
    Ok(())
}

/// Three walls and a pull into their corner: it lies on all three, which carry the pull.
#[test]
fn a_rigid_block_slides_into_a_corner() -> Outcome {
    let corner = [FLOOR, [[0.0; 3], [1.0, 0.0, 0.0]], [[0.0; 3], [0.0, 1.0, 0.0]]];
    let pull = Vec3::new(-0.5, -0.3, -1.0);
    for (turn, above) in [(0.0, 1e-4), (0.0, 0.1), (0.4, 0.01), (0.8, 0.1), (2.0, 1e-4)] {
        let solid = block_above(&corner, (turn, Vec3::new(1.0, 0.4, 0.1)), above, (0.0, pull))?;
        let state = solid.solve(&solid.controls(), &STRICT)?;
        let forces = ["plane 0", "plane 1", "plane 2"].map(|name| force(&solid, &state, name));
        let carried = forces.into_iter().try_fold(Vec3::zeros(), |sum, force| Outcome::Ok(sum + Vec3::from(force?)))?;
        let off = (carried / (WEIGHT * 0.04 * 0.03 * 0.02) + pull).norm();
        assert!(off < 1e-8, "{turn}, {above}: {off}");
        assert!([0.02, 0.03, 0.04].into_iter().any(|high| (height(&solid, &state) - high).abs() < 1e-6));
        assert_eq!(solid.negative_pivots(&state)?, 0);
    }
    Ok(())
}

/// On a floor alone it lies where it fell: it may slide and spin, which is reported and does not count as unstable. What it presses has derivatives that differences confirm; where it lies has none.
#[test]
fn a_rigid_block_on_a_floor_is_neutral() -> Outcome {
    let solid = block_above(&[FLOOR], (0.4, Vec3::new(1.0, 0.4, 0.1)), 0.01, (0.0, -Vec3::z()))?;
    let state = solid.solve(&solid.controls(), &STRICT)?;
    assert!(state.report.residual <= 1e-10, "{:?}", state.report);
    assert!((height(&solid, &state) - 0.02).abs() < 1e-6, "{}", height(&solid, &state));
    assert_eq!(solid.negative_pivots(&state)?, 0);
    let free = solid.model().stability().neutral_motion(&state, &STRICT)?.ok_or("nothing is free")?;
    assert_eq!((free.count, free.what.as_str()), (3, "the rigid body \"block\""));
    let along = |axis: usize| -> Vec<f64> {
        let mut rhs = vec![0.0; state.u.len()];
        let nodes = solid.mesh().points().len();
        rhs[..3 * nodes].iter_mut().skip(axis).step_by(3).for_each(|entry| *entry = 1.0 / nodes as f64);
        rhs
    };
    let error = solid.adjoint(&state, &[&along(0)], &STRICT).err().ok_or("a derivative")?;
    assert!(matches!(error, StateError::Problem(FemError::FreeDerivative { count: 3, .. })), "{error}");
    // the mean height by the height of the floor and by the stiffness of its layer
    let by_height: Vec<f64> = along(2).iter().map(|entry| -entry).collect();
    let lambda = &solid.adjoint(&state, &[&by_height], &STRICT)?.lambda[0];
    let slopes = solid.model().vjp(&Instant::of(&state), lambda)?.controls;
    let mean = |state: &State| state.u.iter().zip(&along(2)).map(|(u, share)| u * share).sum::<f64>();
    for (control, step, tolerance) in [(2, 1e-5, 1e-7), (6, 1e-3 * solid.controls().values(0)[6], 1e-5)] {
        let [up, down] = [1.0, -1.0].map(|side| -> Outcome<f64> {
            let mut controls = solid.controls();
            controls.values_mut(0)[control] += side * step;
            Ok(mean(&solid.solve(&controls, &SolveOptions { near: Some(&state), ..STRICT })?))
        });
        let (slope, difference) = (slopes.values(0)[control], (up? - down?) / (2.0 * step));
        assert!((slope / difference - 1.0).abs() < tolerance, "{control}: {slope} and {difference}");
    }
    assert!((slopes.values(0)[2] - 1.0).abs() < 1e-8);
    Ok(())
}

/// A soft block likewise, hex27 too: it falls, tilts and lies, and its cells bear its weight.
#[test]
fn a_soft_block_lies_down() -> Outcome {
    for (kind, cells) in [(CellKind::Hex8, [4, 3, 2]), (CellKind::Hex27, [2, 2, 1])] {
        let turned = nalgebra::Rotation3::new(Vec3::new(0.3, 0.1, 0.0));
        let place = |x: [f64; 3]| (Vec3::new(0.0, 0.0, 0.05) + turned * Vec3::from(x)).into();
        let solid = Solid::new(box_mesh([0.04, 0.03, 0.02], cells, kind)?.mapped(place)?)?
            .material("body", NeoHooke::new(4e4, 6e4)?)?
            .body_force("body", Vec3::new(0.0, 0.0, -WEIGHT))?
            .contact(Contact::of("plane 0", "skin", Obstacle::half_space(FLOOR[0], FLOOR[1])))?;
        let state = solid.solve(&solid.controls(), &STRICT)?;
        let carried = force(&solid, &state, "plane 0")?[2] / (WEIGHT * 0.04 * 0.03 * 0.02);
        assert!((carried - 1.0).abs() < 1e-8, "{kind}: {carried}");
        assert!((height(&solid, &state) / 0.02 - 1.0).abs() < 0.01, "{kind}: {}", height(&solid, &state));
        assert_eq!((solid.negative_pivots(&state)?, state.report.min_j > 0.9), (0, true));
        assert_eq!(
            solid.model().stability().neutral_motion(&state, &STRICT)?.map(|free| free.count),
            Some(3),
            "{kind}"
        );
        // from where it lies there is nothing to do, and the report says what it is
        let again = solid.solve(&solid.controls(), &SolveOptions { near: Some(&state), ..STRICT })?;
        let off = again.u.iter().zip(state.u.iter()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < 1e-9 && (again.report.min_j / state.report.min_j - 1.0).abs() < 1e-9, "{off}");
        // an accuracy that is not asked for, and a budget that ends it
        let rough = SolveOptions { accuracy: 1e-4, ..STRICT };
        assert!(solid.solve(&solid.controls(), &rough)?.report.residual <= 1e-4);
        let spent = solid.solve(&solid.controls(), &SolveOptions { budget: Some(5), ..STRICT });
        assert!(matches!(spent, Err(StateError::NoConvergence { budget: Some(5), .. })), "{spent:?}");
    }
    Ok(())
}
