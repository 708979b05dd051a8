//! What surfaces that touch each other carry at an instant.

use super::bound::{BoundSurfaces, least};
use super::gap::slope;
use super::point::{SHARE, Sample, SurfacePoint};
use crate::contributions::touches::{RigidPose, Touch, TouchParameters, Touches};
use crate::contributions::{Instant, Sensitivities};
use crate::error::Inadmissible;
use crate::kernels::hyper_dual::HyperDual;
use nastic_tensor::Vec3;
use std::collections::BTreeMap;

/// A sample that presses.
struct Pressed {
    gap: f64,
    /// Per unit of stiffness, and its derivative by the gap.
    pressure: [f64; 2],
    /// Derivatives of the gap by the places of the sample and of the nodes of the pieces.
    by: Vec<Vec3>,
}

impl Sample<'_> {
    /// The gap, and what presses there.
    fn pressed(&self, u: &[f64]) -> Pressed {
        let places: Vec<[f64; 3]> = self.places(u).into_iter().map(Into::into).collect();
        let (distance, by) = self.gap.distance(places[0], &places[1..]);
        let gap = distance - self.of.apart();
        let HyperDual([psi, by_gap, ..]) = slope(self.of.law, HyperDual([gap, 1.0, 0.0, 0.0]), self.of.thickness);
        Pressed { gap, pressure: [-psi, -by_gap], by: by.into_iter().map(Vec3::from).collect() }
    }
}

impl Touches for BoundSurfaces {
    fn pose(&self, _: &Instant) -> Option<RigidPose> {
        None
    }

    fn touch(&self, at: &Instant) -> Option<Touch> {
        let (point, k) = (SurfacePoint::new(self, self.gaps(at.u).ok()?), at.control(0));
        let mut touch = Touch::none(self.least_gap(at.u)?);
        let (mut force, mut moment, mut remaining) = (Vec3::zeros(), Vec3::zeros(), 0.0);
        for sample in point.samples() {
            let (weight, place, pressed) = (sample.weight(), sample.places(at.u)[0], sample.pressed(at.u));
            if pressed.gap < touch.smallest_gap {
                (touch.smallest_gap, touch.deepest) = (pressed.gap, place.into());
            }
            if pressed.gap >= self.thickness {
                continue;
            }
            let pressure = k * pressed.pressure[0];
            touch.area += weight;
            touch.pressing += weight * pressure;
            remaining += weight * pressure * pressed.gap;
            touch.largest_pressure = touch.largest_pressure.max(pressure);
            // the force on the first surface; its own samples are before the other one
            if let [first, _] = &self.sides[..] {
                let push = if std::ptr::eq(first, sample.side) { 1.0 } else { -1.0 };
                let own = push * weight * pressure * pressed.by[0];
                force += own;
                moment += place.cross(&own);
            }
        }
        (touch.force, touch.moment) = (force.into(), moment.into());
        touch.mean_gap = if touch.pressing > 0.0 { remaining / touch.pressing } else { 0.0 };
        touch.sunk = -touch.smallest_gap;
        Some(touch)
    }

    fn parameters(&self) -> TouchParameters {
        TouchParameters {
            thickness: self.thickness,
            inset: 0.0,
            stiffness: self.slots[0].rest(),
            friction: None,
            area: SHARE * self.sides.iter().flat_map(|side| &side.samples.weights).sum::<f64>(),
            samples: self.sides.iter().map(|side| side.samples.len()).sum(),
            between_samples: 0.0,
        }
    }

    fn add_pressing(
        &self,
        at: &Instant,
        by: &dyn Fn(f64) -> [f64; 2],
        by_u: &mut [f64],
        into: &mut Sensitivities,
    ) -> Result<f64, Inadmissible> {
        let (point, k) = (SurfacePoint::new(self, self.gaps(at.u)?), at.control(0));
        let (mut sum, mut by_stiffness) = (0.0, 0.0);
        for sample in point.samples() {
            let (weight, pressed) = (sample.weight(), sample.pressed(at.u));
            if pressed.gap >= self.thickness {
                continue;
            }
            let [p, by_gap] = pressed.pressure;
            let [value, slope] = by(k * p);
            sum += weight * value;
            by_stiffness += weight * slope * p;
            let along: Vec<Vec3> = pressed.by.iter().map(|by| weight * slope * k * by_gap * by).collect();
            sample.spread(&along, |dof, value| by_u[dof] += value);
        }
        into.add_control(at, 0, by_stiffness);
        Ok(sum)
    }

    fn nodal_pressures(&self, at: &Instant) -> Vec<(u32, f64)> {
        let mut sums: BTreeMap<u32, [f64; 2]> = BTreeMap::new();
        for side in &self.sides {
            for sample in 0..side.samples.len() {
                for &(node, shape) in side.samples.parts(sample) {
                    sums.entry(node).or_default()[0] += side.samples.weights[sample] * shape;
                }
            }
        }
        let point = self.gaps(at.u).map(|gaps| SurfacePoint::new(self, gaps));
        for sample in point.iter().flat_map(SurfacePoint::samples) {
            let (samples, of) = (&sample.side.samples, sample.gap.sample);
            let pressure = at.control(0) * sample.pressed(at.u).pressure[0];
            for &(node, shape) in samples.parts(of) {
                sums.entry(node).or_default()[1] += samples.weights[of] * shape * pressure;
            }
        }
        sums.into_iter().map(|(node, [area, force])| (node, if area > 0.0 { force / area } else { 0.0 })).collect()
    }
}

impl BoundSurfaces {
    /// The least gap of a sample, however far, and where the sample is.
    fn least_gap(&self, u: &[f64]) -> Option<(f64, [f64; 3])> {
        least(&self.sides, u).map(|(distance, place)| (distance - self.apart(), place.into()))
    }
}
