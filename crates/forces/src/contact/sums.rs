//! What a contact carries at an instant.

use super::bound::{BoundContact, FRICTION, STIFFNESS};
use super::exact;
use super::friction::without_lagged;
use super::lagged::LaggedFriction;
use super::point::{Gaps, Placed};
use super::pose::{ByPose, Pose};
use super::samples::Samples;
use super::slip;
use crate::rigid_motion;
use nastic_body::contribution::sensitivities::Sensitivities;
use nastic_body::contribution::touches::{ExactContact, Onsets, RigidPose, Sliding, Touch, TouchParameters, Touches};
use nastic_body::error::Inadmissible;
use nastic_body::instant::Instant;
use nastic_mesh::spatial::Obstacle;
use nastic_tensor::Vec3;

impl Touches for BoundContact {
    fn pose(&self, at: &Instant) -> Option<RigidPose> {
        let [translation, theta] = rigid_motion::vectors(at, at.controls);
        Some(RigidPose::new(self.pose_name(), self.centre.into(), translation.into(), theta.into()))
    }

    fn touch(&self, at: &Instant) -> Option<Touch> {
        let (gaps, lagged) = (Gaps::of_all(self, at).ok()?, LaggedFriction::at(self, at).ok()?);
        let (at_step, at) = (at, &without_lagged(at, self.lagged));
        let (mut force, mut moment, mut area, mut largest) = (Vec3::zeros(), Vec3::zeros(), 0.0, 0.0_f64);
        let (mut normal, mut remaining, mut sticking, mut speed) = (0.0, 0.0, 0.0, 0.0_f64);
        for touch in &gaps.touches {
            let traction = self.traction(touch, &gaps.pose, at);
            let weight = self.samples.weights[touch.sample];
            let p = traction.push.value;
            force -= weight * traction.t;
            moment -= weight * (touch.place - gaps.pose.pivot()).cross(&traction.t);
            area += weight;
            largest = largest.max(p);
            normal += weight * p;
            remaining += weight * p * (touch.distance.value - self.offset(touch.sample));
            if let (Some(e), Some(_)) = (self.slip_speed, &traction.slip) {
                let n = traction.n;
                let slides = (traction.relative - n * n.dot(&traction.relative)).norm();
                speed = speed.max(slides);
                sticking += if slides < e { weight * p } else { 0.0 };
            } else {
                sticking += weight * p;
            }
        }
        let mut borne = normal;
        if let (Some(friction), Some(e)) = (&lagged, self.slip_speed) {
            (borne, sticking) = (0.0, 0.0);
            for rubbed in friction.each(at_step) {
                let (push, slides) = (friction.force(&rubbed), rubbed.slides.norm());
                force -= push;
                moment -= (gaps.all[rubbed.sample].1.0 - gaps.pose.pivot()).cross(&push);
                let carried = self.samples.weights[rubbed.sample] * rubbed.push.value;
                borne += carried;
                speed = speed.max(slides);
                sticking += if slides < e { carried } else { 0.0 };
            }
        }
        let of_all = |share: f64, normal: f64, none: f64| if normal > 0.0 { share / normal } else { none };
        let gap = |&(sample, (x, d)): &Placed| (x, d - self.offset(sample));
        let (deepest, smallest_gap) = gaps.all.iter().map(gap).min_by(|a, b| a.1.total_cmp(&b.1))?;
        let sunk = gaps.all.iter().map(|(_, (_, d))| -d).fold(f64::NEG_INFINITY, f64::max);
        let sliding = |slip_speed| Sliding { sticking: of_all(sticking, borne, 1.0), speed, slip_speed };
        Some(Touch {
            force: force.into(),
            pressing: normal,
            moment: moment.into(),
            area,
            smallest_gap,
            deepest: deepest.into(),
            between: None,
            largest_pressure: largest,
            mean_gap: of_all(remaining, normal, 0.0),
            approach: self.approach(&gaps),
            sunk,
            sliding: self.slip_speed.map(sliding),
        })
    }

    fn between(&self, at: &Instant, touch: &Touch) -> Option<(f64, [f64; 3])> {
        let nearest = (touch.smallest_gap, Vec3::from(touch.deepest));
        let (gap, place) = self.probes.least(self, &Pose::at(at, self.centre), at.u, nearest);
        Some((gap, place.into()))
    }

    fn add_pressing(
        &self,
        at: &Instant,
        by: &dyn Fn(f64) -> [f64; 2],
        by_u: &mut [f64],
        into: &mut Sensitivities,
    ) -> Result<f64, Inadmissible> {
        let at = &Instant { step: None, ..*at };
        let gaps = Gaps::at(self, at)?;
        let (mut sum, mut by_pose, mut by_stiffness) = (0.0, ByPose::default(), 0.0);
        for touch in &gaps.touches {
            let traction = self.traction(touch, &gaps.pose, at);
            let (weight, p) = (self.samples.weights[touch.sample], traction.push);
            let [value, slope] = by(p.value);
            sum += weight * value;
            let by_place = weight * slope * p.change;
            self.spread(touch.sample, &by_place, by_u);
            by_pose.translation -= by_place;
            by_pose.turn -= gaps.pose.arm(&touch.place).cross(&by_place);
            by_stiffness += weight * slope * p.value / at.control(STIFFNESS);
        }
        gaps.pose.add_vjp(at, &by_pose, self.dim, into);
        into.add_control(at, STIFFNESS, by_stiffness);
        Ok(sum)
    }

    fn resists_at(&self, at: &Instant) -> Option<Vec<Vec<(u32, f64)>>> {
        let gaps = Gaps::of_all(self, at).ok()?;
        let of = |touch: &super::point::Touch| self.samples.component(touch.sample, &touch.distance.normal(), self.dim);
        Some(gaps.touches.iter().map(of).collect())
    }

    fn onsets(&self, at: &Instant) -> Option<Onsets> {
        let gaps = Gaps::of_all(self, at).ok()?;
        let mut found = Onsets::default();
        for (sample, (place, d)) in &gaps.all {
            let mut slides = Vec::new();
            if let (Some(e), Some(_), true) = (self.slip_speed, at.step, *d < self.thickness) {
                let n = Vec3::from(self.signed_distance(&gaps.pose, (*sample, place)).normal());
                let own = self.samples.of(*sample, self.dim, |dof| at.velocity(dof));
                let relative = own - gaps.pose.velocity(place);
                slides.push((relative - n * n.dot(&relative)).norm() / e);
            }
            found.add(d / self.thickness, &slides);
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
        let Some(e) = self.slip_speed else { return Ok(None) };
        slip::add(self, (at, e), q as i32, by_u, into).map(Some)
    }

    fn parameters(&self) -> TouchParameters {
        let samples = self.samples.len();
        let area = self.samples.weights.iter().sum::<f64>();
        let share = area / samples as f64;
        let apart = if self.dim == 3 { share.sqrt() } else { share };
        let radius = match self.obstacle {
            Obstacle::Sphere { radius, .. } | Obstacle::Capsule { radius, .. } => radius,
            _ => f64::INFINITY,
        };
        TouchParameters {
            thickness: self.thickness,
            area,
            inset: self.inset,
            stiffness: self.slots[STIFFNESS].rest(),
            friction: self.slip_speed.map(|slip_speed| (self.slots[FRICTION].rest(), slip_speed)),
            lagged: self.lagged,
            samples,
            between_samples: apart * apart / (8.0 * radius),
        }
    }

    fn exact(&self, at: &Instant) -> Option<ExactContact> {
        exact::step(self, at)
    }

    fn nodal_pressures(&self, at: &Instant) -> Vec<(u32, f64)> {
        let of_touch = |gaps: Gaps| -> Vec<(usize, f64)> {
            let pressure = |touch: &_| self.traction(touch, &gaps.pose, at).push.value;
            gaps.touches.iter().map(|touch| (touch.sample, pressure(touch))).collect()
        };
        Samples::nodal_means(&[(&self.samples, Gaps::at(self, at).map(of_touch).unwrap_or_default())])
    }
}

impl BoundContact {
    /// How deep the undeformed body overlaps the obstacle at its pose, among samples that touch.
    fn approach(&self, gaps: &Gaps) -> f64 {
        let depth = |sample| self.offset(sample) - self.distance(&gaps.pose, (sample, &self.reference[sample]));
        gaps.touches.iter().map(|touch| depth(touch.sample)).fold(0.0, f64::max)
    }
}
