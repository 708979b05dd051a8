//! Rigid cylinders and balls on a half-space, beside Hertz (Johnson, Contact Mechanics (1985), sections 3.4, 4.2). `cargo bench --bench hertz` has finer meshes.

use crate::common;

use common::Outcome;
use common::indentation::{BALL, CYLINDER, Indentation, extrapolated};

/// Without a layer the largest pressure of a cylinder by its force, extrapolated over three meshes, to 1 %. With one of a hundredth of the depth the
/// force is the same to 3 %. Half-widths to a cell.
#[test]
fn a_cylinder_is_carried_as_hertz_says() -> Outcome {
    let mut pressures = Vec::new();
    for fine in [4, 8, 16] {
        let of = Indentation { fine, ..CYLINDER };
        let [layered, exact] = of.press()?;
        pressures.push((of.cell(), exact.largest_pressure / of.of_cylinder(exact.force)[1]));
        for found in [&layered, &exact] {
            let [width, _] = of.of_cylinder(found.force);
            assert!((found.radius[0] - width).abs() <= of.cell(), "a/h = {fine}: {found:?} for {width}");
        }
        assert!((layered.force / exact.force - 1.0).abs() < 0.03, "{} {}", layered.force, exact.force);
        assert!(layered.force > 1.005 * exact.force, "the layer is there: {} {}", layered.force, exact.force);
    }
    assert!((extrapolated(&pressures) - 1.0).abs() < 0.01, "{pressures:?}");
    Ok(())
}

/// Force and largest pressure of a ball at its depth, on coarse meshes.
#[test]
fn a_ball_is_carried_as_hertz_says() -> Outcome {
    let (mut forces, mut pressures) = (Vec::new(), Vec::new());
    let [force, pressure] = BALL.of_ball(BALL.depth());
    for fine in [2, 4] {
        // what is left without a layer does not depend on it, and a thick one takes few load steps
        let of = Indentation { fine, thickness: 0.3, ..BALL };
        let [_, exact] = of.press()?;
        forces.push((of.cell(), exact.force / force));
        pressures.push((of.cell(), exact.largest_pressure / pressure));
        assert!((exact.radius[0] - 1.0).abs() <= of.cell(), "a/h = {fine}: {:?}", exact.radius);
    }
    assert!((extrapolated(&forces) - 1.0).abs() < 0.02, "{forces:?}");
    assert!((extrapolated(&pressures) - 1.0).abs() < 0.02, "{pressures:?}");
    Ok(())
}

/// A layer is a cylinder that goes deeper by its gap under Hertz's pressure, weighted (reciprocity) by the pressure of a flat punch:
/// `delta (1 - c sqrt(p0/k))` with `c = B(1/2, 3/4)/pi`. What is missing of delta falls with the stiffness at the slope -1/2.
#[test]
fn a_layer_adds_its_gap_to_the_depth() -> Outcome {
    const THICKNESS: f64 = 0.02;
    let of = |stiffness| Indentation { thickness: THICKNESS, stiffness: Some(stiffness), ..CYLINDER };
    let [_, exact] = of(4.0).press()?;
    let [_, deeper] = Indentation { deep: 1.0 + THICKNESS, ..of(4.0) }.press()?;
    let power = (deeper.force / exact.force).ln() / (1.0 + THICKNESS).ln();
    let mut missing = Vec::new();
    for stiffness in [4.0, 16.0, 64.0] {
        let [layered, _] = of(stiffness).press()?;
        let offset = (layered.force / exact.force).powf(1.0 / power) - 1.0;
        missing.push((f64::ln(stiffness), (1.0 - offset / THICKNESS).ln()));
        let expected = 1.0 - 0.762_760 / stiffness.sqrt();
        assert!((offset / THICKNESS - expected).abs() < 0.01, "k/p0 = {stiffness}: {offset} for {expected}");
    }
    let slope = |a: (f64, f64), b: (f64, f64)| (b.1 - a.1) / (b.0 - a.0);
    assert!((slope(missing[0], missing[2]) + 0.5).abs() < 0.02, "{missing:?}");
    Ok(())
}
