//! What contacts report against forces on nodes and own distances: forces, moments, cones, depths, crossings.

use super::crossing::crossings;
use super::scene::Scene;
use super::shape::Shape;
use super::{At, EQUILIBRIUM, Found};
use crate::problem::Touching;
use nastic::fem::Touch;
use nastic::prelude::*;
use std::collections::BTreeSet;

/// Depth of a node that a contact does not report, over the thickness of its layer.
const UNREPORTED: f64 = 0.1;
/// How far forces may be beyond a cone, over what presses.
const CONE: f64 = 1e-6;

pub(super) fn check(scene: &Scene, at: &At, found: &mut Found) {
    let facts = scene.facts();
    for touching in &facts.touching {
        let Some((_, touch)) = at.touches.iter().find(|(name, _)| *name == touching.name) else {
            found.add("a contact that is not reported", 1.0, 0.5);
            continue;
        };
        of_obstacle(scene, at, (touching, touch), found);
    }
    let thickness = |name: &str| parameters(scene, name);
    for (name, surfaces) in &facts.pairs {
        let x: Vec<Vec3> = scene.places.iter().zip(&at.u).map(|(x, u)| x + u).collect();
        found.add("facets that cross", crossings(scene, surfaces, &x) as f64, 0.5);
        if let Some((_, touch)) = at.touches.iter().find(|(own, _)| own == name) {
            within_cone(scene, (touch, at.forces.scale), found);
            found.add("pressed through", touch.sunk / thickness(name), 1.0);
        }
    }
}

fn parameters(scene: &Scene, name: &str) -> f64 {
    let all = scene.problem.solid.model().contacts().parameters();
    all.iter().find(|(own, _)| own == name).map_or(f64::NAN, |own| own.1.thickness)
}

/// A sum of forces of a cone, whatever their normals, is no longer than what presses times `(1 + mu^2)^(1/2)`.
fn within_cone(scene: &Scene, (touch, scale): (&Touch, f64), found: &mut Found) {
    let most = touch.pressing * (1.0 + scene.facts().friction.powi(2)).sqrt();
    found.add(
        "force over its cone",
        Vec3::from(touch.force).norm() - most,
        CONE * touch.pressing + EQUILIBRIUM * scale,
    );
}

fn of_obstacle(scene: &Scene, at: &At, (touching, touch): (&Touching, &Touch), found: &mut Found) {
    let pose = scene.pose(touching, &at.state.controls);
    let nodes = scene.nodes_of(&touching.surface);
    let x = |node: usize| scene.places[node] + at.u[node];
    let gap = |node: &usize| touching.shape.distance(&pose.back(&x(*node)), scene.dim);
    let depth = -nodes.iter().map(gap).fold(f64::INFINITY, f64::min);
    let reported = (-touch.smallest_gap).max(0.0);
    found.add("depth that is not reported", (depth - reported) / parameters(scene, &touching.name), UNREPORTED);
    within_cone(scene, (touch, at.forces.scale), found);
    if !bears_alone(scene, touching, &nodes) {
        return;
    }
    let rest = &at.forces.rest;
    let (centre, scale) = (pose.centre + pose.shift, at.forces.scale);
    let force: Vec3 = nodes.iter().map(|node| rest[*node]).sum();
    let moment: Vec3 = nodes.iter().map(|node| (x(*node) - centre).cross(&rest[*node])).sum();
    found.add("force of a contact", (force - Vec3::from(touch.force)).norm() / scale, EQUILIBRIUM);
    // of what presses the body, on the obstacle: either sign has been a report's
    let told = Vec3::from(touch.moment);
    let arm = nodes.iter().map(|node| (x(*node) - centre).norm()).fold(scene.size(), f64::max);
    found.add("moment of a contact", (moment - told).norm() / (scale * arm), EQUILIBRIUM);
    if let Shape::HalfSpace { normal, .. } = &touching.shape {
        let n = pose.turned(&normal.normalize());
        let beyond = |force: &Vec3| {
            let along = force.dot(&n);
            (force - along * n).norm() - scene.facts().friction * along
        };
        let most = CONE * touch.pressing + EQUILIBRIUM * scale;
        found.add("beyond the cone of a plane", beyond(&force), most);
        let straight =
            scene.facets_of(&touching.surface).iter().all(|(kind, _)| ["line2", "tri3", "quad4"].contains(kind));
        if straight {
            let worst = nodes.iter().map(|node| beyond(&rest[*node])).fold(f64::NEG_INFINITY, f64::max);
            found.add("a node beyond the cone of a plane", worst, most);
        }
    }
}

/// Whether nothing but the contact bears anything at the nodes.
fn bears_alone(scene: &Scene, touching: &Touching, nodes: &BTreeSet<usize>) -> bool {
    let facts = scene.facts();
    let others = facts.touching.iter().filter(|other| other.name != touching.name).map(|other| &other.surface);
    let pairs = facts.pairs.iter().flat_map(|(_, surfaces)| surfaces);
    let apart = |name: &String| scene.nodes_of(name).is_disjoint(nodes);
    let rigid = scene.rigid_nodes();
    others.chain(pairs).chain(&facts.held).all(apart) && rigid.iter().all(|(_, own)| own.is_disjoint(nodes))
}
