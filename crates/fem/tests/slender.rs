//! Slender bodies: few Newton iterations however thin, and the right shape.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

mod common;

use common::Outcome;
use nastic_energy::{FiberTension, NeoHooke};
use nastic_fem::{Solid, SolveOptions};
use nastic_mesh::{CellKind, rectangle};
use nastic_tensor::Vec3;

/// A strip a thousand times as long as thick whose fibres shorten above and lengthen below bends to an arc of a circle: its end
/// lies at L (sin a, 1 - cos a) / a, turned by a.
#[test]
fn a_strip_a_thousand_times_as_long_as_thick_rolls_up() -> Outcome {
    let thickness = 0.001;
    let solid = Solid::new(rectangle([1.0, thickness], [100, 1], CellKind::Quad9)?)?
        .material("body", NeoHooke::from_young_poisson(1e5, 0.3)?)?
        .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
        .clamp("x-")?;
    let points = solid.discretization().points().positions(solid.mesh(), None);
    for (tension, least) in [(50.0, 0.5), (300.0, 3.0)] {
        let values: Vec<f64> = points.iter().map(|x| tension * (1.0 - 2.0 * x[1] / thickness)).collect();
        let mut controls = solid.controls();
        controls.set(0, 0, &values)?;
        let state = solid.solve(&controls, &SolveOptions::default())?;
        assert!(state.report.newton < 100, "{} Newton iterations", state.report.newton);
        assert_eq!(solid.negative_pivots(&state)?, 0);
        let node = |x: f64, y: f64| {
            let near = |p: &[f64; 3]| (p[0] - x).abs() < 1e-9 && (p[1] - y).abs() < 1e-9;
            let k = solid.mesh().points().iter().position(near).unwrap();
            [x + state.u[2 * k], y + state.u[2 * k + 1]]
        };
        let (low, middle, high) = (node(1.0, 0.0), node(1.0, 0.5 * thickness), node(1.0, thickness));
        // The angle by which the end has turned, within half a turn of that of the chord.
        let chord = (middle[1] - 0.5 * thickness).atan2(middle[0]).rem_euclid(std::f64::consts::TAU);
        let angle = 2.0 * if chord > std::f64::consts::PI { chord - std::f64::consts::TAU } else { chord };
        let normal = [high[0] - low[0], high[1] - low[1]].map(|d| d / thickness);
        assert!(angle.abs() > least, "{angle}");
        assert!(
            (normal[0] + angle.sin()).abs() < 2e-2 && (normal[1] - angle.cos()).abs() < 2e-2,
            "{normal:?}, {angle}"
        );
        let circle = [angle.sin() / angle, (1.0 - angle.cos()) / angle];
        let miss = (middle[0] - circle[0]).hypot(middle[1] - 0.5 * thickness - circle[1]);
        assert!(miss < 2e-3, "{middle:?} for {circle:?}");
    }
    Ok(())
}
