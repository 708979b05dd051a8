//! What surfaces that touch each other carry at an instant.

use super::bound::{BoundSurfaces, FRICTION, STIFFNESS, least};
use super::gap::slope;
use super::lagged::LaggedRubbing;
use super::point::SurfacePoint;
use super::pressures::Pressures;
use super::rub::Rub;
use super::sample::{SHARE, Sample};
use super::slid::slid;
use crate::contact::friction::without_lagged;
use nastic_body::contribution::sensitivities::Sensitivities;
use nastic_body::contribution::touches::{Onsets, RigidPose, Sliding, Touch, TouchParameters, Touches};
use nastic_body::error::Inadmissible;
use nastic_body::instant::Instant;
use nastic_body::kernels::hyper_dual::HyperDual;
use nastic_tensor::Vec3;

/// Least part in a sample's pressure of a piece whose sliding is reported.
const PART: f64 = 1e-3;

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
        let (distance, by) = self.gap.distance(places[0], &places[1..self.near_slots()]);
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
        let (point, k) = (SurfacePoint::new(self, self.gaps(at.u).ok()?), at.control(STIFFNESS));
        let lagged = LaggedRubbing::at(self, at).ok()?;
        let (at_step, at) = (at, &without_lagged(at, self.lagged));
        let mut touch = Touch::none(self.least_gap(at.u)?);
        let (mut carried, mut remaining) = (Carried::default(), 0.0);
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
            carried.add(&sample, at, weight * pressure);
        }
        touch.largest_pressure = k * Pressures::at(self, &point, at.u).of_corners.into_iter().fold(0.0, f64::max);
        let mut borne = touch.pressing;
        if let Some(friction) = &lagged {
            borne = 0.0;
            friction.each(|rub, strength| {
                let pressing = k * rub.sample.weight() * rub.feet.iter().map(|foot| foot.pressure).sum::<f64>();
                borne += pressing;
                carried.rub(rub, at_step, (strength, pressing));
            });
        }
        (touch.force, touch.moment) = (carried.force.into(), carried.moment.into());
        touch.mean_gap = if touch.pressing > 0.0 { remaining / touch.pressing } else { 0.0 };
        touch.sunk = -touch.smallest_gap;
        touch.sliding = self.slip_speed.map(|slip_speed| {
            let in_step = borne > 0.0 && at_step.step.is_some();
            let sticking = if in_step { carried.sticking / borne } else { 1.0 };
            Sliding { sticking, speed: carried.speed, slip_speed }
        });
        Some(touch)
    }

    fn parameters(&self) -> TouchParameters {
        TouchParameters {
            thickness: self.thickness,
            inset: 0.0,
            stiffness: self.slots[STIFFNESS].rest(),
            friction: self.slip_speed.map(|slip_speed| (self.slots[FRICTION].rest(), slip_speed)),
            lagged: self.lagged,
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
        let (point, k) = (SurfacePoint::new(self, self.gaps(at.u)?), at.control(STIFFNESS));
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
        into.add_control(at, STIFFNESS, by_stiffness);
        Ok(sum)
    }

    fn add_pressures(
        &self,
        at: &Instant,
        by: &dyn Fn(f64) -> [f64; 2],
        by_u: &mut [f64],
        into: &mut Sensitivities,
    ) -> Result<f64, Inadmissible> {
        let (point, k) = (SurfacePoint::new(self, self.gaps(at.u)?), at.control(STIFFNESS));
        let pressures = Pressures::at(self, &point, at.u);
        let (mut sum, mut by_stiffness, mut by_pressures) = (0.0, 0.0, Vec::new());
        for (unit, area) in pressures.of_corners.iter().zip(&self.recovery.areas) {
            let [value, slope] = if *unit > 0.0 { by(k * unit) } else { [0.0; 2] };
            sum += SHARE * area * value;
            by_stiffness += SHARE * area * slope * unit;
            by_pressures.push(SHARE * area * slope * k);
        }
        pressures.add_derivatives(at.u, &by_pressures, |dof, value| by_u[dof] += value);
        into.add_control(at, STIFFNESS, by_stiffness);
        Ok(sum)
    }

    fn resists_at(&self, at: &Instant) -> Option<Vec<Vec<(u32, f64)>>> {
        let point = SurfacePoint::new(self, self.gaps(at.u).ok()?);
        let of = |sample: Sample| {
            let (pressed, mut terms) = (sample.pressed(at.u), Vec::new());
            sample.spread(&pressed.by, |dof, slope| terms.push((dof as u32, slope)));
            (pressed.gap < self.thickness).then_some(terms)
        };
        Some(point.touching().filter_map(of).collect())
    }

    fn onsets(&self, at: &Instant) -> Option<Onsets> {
        let point = SurfacePoint::new(self, self.gaps(at.u).ok()?);
        let mut found = Onsets::default();
        for side in &self.sides {
            let mut near = point.samples().into_iter().filter(|sample| std::ptr::eq(sample.side, side)).peekable();
            for k in 0..side.samples.len() {
                let Some(sample) = near.next_if(|sample| sample.gap.sample == k) else {
                    found.add(f64::INFINITY, &[]);
                    continue;
                };
                let gap = sample.pressed(at.u).gap / self.thickness;
                let slides = match self.slides_at(at).filter(|_| gap < 1.0) {
                    Some(slip_speed) => {
                        let (rub, velocities) = (Rub::at(sample, at.u), sample.slots(|dof| at.velocity(dof)));
                        let feet = rub.feet.iter().filter(|foot| foot.part > PART);
                        feet.map(|foot| rub.slides(foot, &velocities).norm() / slip_speed).collect()
                    }
                    None => Vec::new(),
                };
                found.add(gap, &slides);
            }
        }
        Some(found)
    }

    fn add_slip(
        &self,
        at: &Instant,
        q: u32,
        by_u: &mut [f64],
        into: &mut Sensitivities,
    ) -> Result<Option<f64>, Inadmissible> {
        let Some(slip_speed) = self.slip_speed else { return Ok(None) };
        let (point, k, mut unit) = (SurfacePoint::new(self, self.gaps(at.u)?), at.control(STIFFNESS), 0.0);
        for sample in point.touching() {
            let (rub, weight) = (Rub::at(sample, at.u), sample.weight());
            let found = slid(&rub, at, (slip_speed, q as i32));
            unit += weight * found.value;
            sample.spread(&found.by_place, |dof, value| by_u[dof] += k * weight * value);
            sample.spread(&found.by_velocity, |dof, value| into.velocity[dof] += k * weight * value);
        }
        into.add_control(at, STIFFNESS, unit);
        Ok(Some(k * unit))
    }

    fn nodal_pressures(&self, at: &Instant) -> Vec<(u32, f64)> {
        let k = at.control(STIFFNESS);
        let pressures = match self.gaps(at.u) {
            Ok(gaps) => Pressures::at(self, &SurfacePoint::new(self, gaps), at.u).of_corners,
            Err(_) => vec![0.0; self.recovery.areas.len()],
        };
        self.recovery.at_nodes(&pressures).into_iter().map(|(node, unit)| (node, k * unit)).collect()
    }
}

/// What the first of two surfaces is pushed with, about the origin, and how samples slide.
#[derive(Default)]
struct Carried {
    force: Vec3,
    moment: Vec3,
    /// Normal force of what slides slower than the slip speed.
    sticking: f64,
    speed: f64,
}

impl Carried {
    /// Of a sample that presses with a force.
    fn add(&mut self, sample: &Sample, at: &Instant, pressing: f64) {
        let (of, k) = (sample.of, at.control(STIFFNESS));
        self.push(sample, at, &sample.force(at.u).1.iter().map(|force| k * force).collect::<Vec<_>>());
        if of.slides_at(at).is_some() {
            let strength = k * at.control(FRICTION) * sample.weight();
            self.rub(&Rub::at(*sample, at.u), at, (strength, pressing));
        }
    }

    /// Of friction of a strength on a sample that presses with a force.
    fn rub(&mut self, rub: &Rub, at: &Instant, (strength, pressing): (f64, f64)) {
        let sample = &rub.sample;
        if let Some(slip_speed) = sample.of.slip_speed {
            let velocities = sample.slots(|dof| at.velocity(dof));
            let forces: Vec<Vec3> = rub.forces(at, slip_speed).iter().map(|force| strength * force).collect();
            self.push(sample, at, &forces);
            let (mut sticking, mut all) = (0.0, 0.0);
            // pieces that have almost no part in the pressure do not count
            for foot in rub.feet.iter().filter(|foot| foot.part > PART) {
                let slides = rub.slides(foot, &velocities).norm();
                self.speed = self.speed.max(slides);
                sticking += if slides < slip_speed { foot.part } else { 0.0 };
                all += foot.part;
            }
            self.sticking += if all > 0.0 { pressing * sticking / all } else { 0.0 };
        }
    }

    /// Of forces on the slots of a sample.
    fn push(&mut self, sample: &Sample, at: &Instant, forces: &[Vec3]) {
        let [first, _] = &sample.of.sides[..] else { return };
        // the nodes of the pieces bear the opposite of what the sample's side does, and the opposite moment
        let on_own = if std::ptr::eq(first, sample.side) { 1.0 } else { -1.0 };
        for (place, force) in sample.places(at.u)[..sample.near_slots()].iter().zip(forces).skip(1) {
            self.force += on_own * force;
            self.moment += place.cross(&(on_own * force));
        }
    }
}

impl BoundSurfaces {
    /// The least gap of a sample, however far, and where the sample is.
    fn least_gap(&self, u: &[f64]) -> Option<(f64, [f64; 3])> {
        least(&self.sides, u).map(|(distance, place)| (distance - self.apart(), place.into()))
    }
}
