//! Obstacles, contacts and rigid bodies in words.

use super::line::{Line, line};
use crate::lower::CaseProblem;
use nastic_fem::{Instant, TouchParameters};
use nastic_language::number::{count, quantity, short};
use nastic_language::quantity::Dimension;
use nastic_language::schema::{Material, Obstacle};
use std::collections::BTreeSet;

/// How far what sticks at half of the cone creeps, as a share of the slip speed times the time.
const CREEP_AT_HALF: f64 = 1.0 - std::f64::consts::FRAC_1_SQRT_2;

/// Obstacles, and contacts with their layers.
pub fn contacts(problem: &CaseProblem) -> Vec<Line> {
    let obstacles = problem.case.obstacles.iter().map(|obstacle| {
        let shape = obstacle.shape.name().replace('_', "-");
        line("obstacles", format!("{}: a {shape}, {}", obstacle.name, moves(problem, obstacle)))
    });
    let solid = problem.solid();
    let rest = solid.rest();
    let gaps = solid.model().contacts().touches(&Instant::of(&rest));
    let contact = |(name, parameters): (String, TouchParameters)| {
        let gap = gaps.iter().find(|(known, _)| *known == name).map(|(_, touch)| touch.smallest_gap);
        line("contact", format!("{name}: {}", shown(problem, &parameters, gap)))
    };
    obstacles.chain(solid.model().contacts().parameters().into_iter().map(contact)).collect()
}

fn moves(problem: &CaseProblem, obstacle: &Obstacle) -> String {
    let controlled =
        |key: &&str| problem.case.controls.iter().any(|control| control.of == format!("{}.{key}", obstacle.name));
    let controlled: Vec<&str> = ["translation", "rotation"].into_iter().filter(|key| controlled(key)).collect();
    let given: Vec<&str> = obstacle.pose().map(|(key, _)| key).collect();
    let shown: Vec<String> = [("controlled", controlled), ("given", given)]
        .into_iter()
        .filter(|(_, keys)| !keys.is_empty())
        .map(|(how, keys)| format!("its {} {how}", keys.join(" and ")))
        .collect();
    match (shown.is_empty(), problem.is_motion()) {
        (true, _) => "at rest".to_owned(),
        (false, true) => shown.join(", "),
        (false, false) => format!("{}: it comes there from its shape's place while loads grow", shown.join(", ")),
    }
}

fn shown(problem: &CaseProblem, of: &TouchParameters, gap: Option<f64>) -> String {
    let units = problem.units();
    let length = |value: f64| quantity(value, Dimension::LENGTH, units);
    let stiffness = quantity(of.stiffness, Dimension::PRESSURE, units);
    let mut parts = vec![format!(
        "layer {} thick, stiffness {stiffness}, {}, smallest gap at rest {}",
        length(of.thickness),
        count(of.samples, "sample"),
        gap.map_or_else(|| "not known".to_owned(), length)
    )];
    if let (Some((friction, slip_speed)), Some(time)) = (of.friction, &problem.case.time) {
        let speed = quantity(slip_speed, Dimension::VELOCITY, units);
        let creep = length(CREEP_AT_HALF * slip_speed * time.end);
        parts.push(format!(
            "friction {}{}, slip speed {speed}: held at half of what friction bears it creeps by {creep} until the end",
            short(friction),
            if of.lagged { ", with the normal forces of the instant before" } else { "" }
        ));
    }
    if of.inset > 0.0 {
        parts.push(format!("the body touches at rest: gaps count from {} inside the obstacle", length(of.inset)));
    }
    if of.between_samples > 0.1 * of.thickness {
        parts.push(format!("the obstacle enters by {} between samples", length(of.between_samples)));
    }
    parts.join("; ")
}

/// How many regions are rigid, with their masses.
pub fn rigid_bodies(problem: &CaseProblem) -> Vec<Line> {
    let bodies: Vec<&Material> = problem.case.materials.iter().filter(|material| material.rigid).collect();
    if bodies.is_empty() {
        return vec![];
    }
    let unknowns = if problem.mesh().dim() == 2 { 3 } else { 6 };
    let held = if problem.case.supports.is_empty() { "" } else { ", less what supports hold" };
    let number = match bodies.len() {
        1 => format!("1 rigid body of {unknowns} unknowns, translation and rotation{held}"),
        n => format!("{n} rigid bodies of {unknowns} unknowns each, translation and rotation{held}"),
    };
    let body = |material: &&Material| {
        let mass = mass(problem, material).map_or_else(|| "without a mass".to_owned(), |mass| format!("mass {mass}"));
        line("rigid", format!("{}: {mass}", material.region))
    };
    [line("rigid", number)].into_iter().chain(bodies.iter().map(body)).collect()
}

/// In kg, in plane strain per metre of thickness, by all materials with a density on the cells.
fn mass(problem: &CaseProblem, body: &Material) -> Option<String> {
    let mesh = problem.mesh();
    let cells: BTreeSet<u32> = mesh.cells_of(&body.region).ok()?.into_iter().collect();
    let volumes = mesh.volumes(mesh.points());
    let of = |material: &Material| {
        let own = mesh.cells_of(&material.region).ok()?;
        let shared = own.iter().filter(|cell| cells.contains(cell));
        Some(material.density? * shared.map(|&cell| volumes[cell as usize]).sum::<f64>())
    };
    let sum: f64 = problem.case.materials.iter().filter_map(of).sum();
    let (dimension, unit) = match mesh.dim() {
        2 => (Dimension::of(-2, 1, 2, 0), "kg/m, per thickness"),
        _ => (Dimension::MASS, "kg"),
    };
    (sum > 0.0).then(|| format!("{} {unit}", short(problem.units().in_si(sum, dimension))))
}
