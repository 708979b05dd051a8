//! What a contact carries at an instant.

use super::bound::BoundContact;
use super::point::Gaps;
use crate::contributions::Instant;
use nastic_tensor::Vec3;
use std::collections::BTreeMap;

impl BoundContact {
    /// Force on the body (N) and its moment about the obstacle's centre (N m), per unit of thickness in plane strain; the area that it acts on;
    /// the smallest gap; the largest pressure; with friction the share of the normal force whose samples slip below the slip speed, and
    /// the largest slip velocity.
    pub(super) fn sums(&self, at: &Instant) -> Vec<(&'static str, f64)> {
        let Ok(gaps) = Gaps::at(self, at) else { return Vec::new() };
        let (mut force, mut moment, mut area, mut pressure) = (Vec3::zeros(), Vec3::zeros(), 0.0, 0.0_f64);
        let (mut normal, mut sticking, mut slip) = (0.0, 0.0, 0.0_f64);
        for touch in &gaps.touches {
            let traction = self.traction(touch, &gaps.pose, at);
            let weight = self.samples.weights[touch.sample];
            force -= weight * traction.t;
            moment -= weight * (touch.place - gaps.pose.pivot()).cross(&traction.t);
            area += weight;
            pressure = pressure.max(traction.pressure.value);
            normal += weight * traction.pressure.value;
            if let (Some(e), Some(_)) = (self.slip_speed, &traction.slip) {
                let n = traction.n;
                let speed = (traction.relative - n * n.dot(&traction.relative)).norm();
                slip = slip.max(speed);
                sticking += if speed < e { weight * traction.pressure.value } else { 0.0 };
            }
        }
        let gap = gaps.all.iter().map(|(_, d)| *d).fold(f64::INFINITY, f64::min);
        let mut found = vec![("force_x", force.x), ("force_y", force.y)];
        if self.dim == 3 {
            found.extend([("force_z", force.z), ("moment_x", moment.x), ("moment_y", moment.y)]);
        }
        found.extend([("moment_z", moment.z), ("area", area), ("smallest_gap", gap), ("largest_pressure", pressure)]);
        if self.slip_speed.is_some() && at.step.is_some() {
            found.extend([("sticking", if normal > 0.0 { sticking / normal } else { 1.0 }), ("slip_speed", slip)]);
        }
        found
    }

    /// Of every node of the surface the mean pressure of its samples, by their shares of the node.
    pub(super) fn nodal_pressures(&self, at: &Instant) -> Vec<(u32, f64)> {
        let mut sums: BTreeMap<u32, [f64; 2]> = BTreeMap::new();
        for sample in 0..self.samples.len() {
            for &(node, shape) in self.samples.parts(sample) {
                sums.entry(node).or_default()[0] += self.samples.weights[sample] * shape;
            }
        }
        let touches = Gaps::at(self, at).map(|gaps| (gaps.pose, gaps.touches));
        for (pose, touch) in touches.iter().flat_map(|(pose, touches)| touches.iter().map(move |touch| (pose, touch))) {
            let pressure = self.traction(touch, pose, at).pressure.value;
            for &(node, shape) in self.samples.parts(touch.sample) {
                sums.entry(node).or_default()[1] += self.samples.weights[touch.sample] * shape * pressure;
            }
        }
        sums.into_iter().map(|(node, [area, force])| (node, if area > 0.0 { force / area } else { 0.0 })).collect()
    }
}
