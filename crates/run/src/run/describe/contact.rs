//! Obstacles and contacts in words and as JSON.

use nastic_case::describe::{Line, line};
use nastic_case::lower::CaseProblem;
use nastic_fem::{Instant, TouchParameters};
use nastic_language::number::{count, quantity, short};
use nastic_language::quantity::Dimension;
use nastic_language::schema::Obstacle;
use nastic_report::record::ContactRecord;

/// How far what sticks at half of the cone creeps, as a share of the slip speed times the time.
const CREEP_AT_HALF: f64 = 1.0 - std::f64::consts::FRAC_1_SQRT_2;

pub(in crate::run) fn contacts(problem: &CaseProblem) -> Vec<Line> {
    let obstacles = problem.case.obstacles.iter().map(|obstacle| {
        let shape = obstacle.shape.name().replace('_', "-");
        line("obstacles", format!("{}: a {shape}, {}", obstacle.name, moves(problem, obstacle)))
    });
    let solid = problem.member(0).solid();
    let rest = solid.rest();
    let gaps = solid.model().touches(&Instant::of(&rest));
    let contact = |(name, parameters): (String, TouchParameters)| {
        let gap = gaps.iter().find(|(known, _)| *known == name).map(|(_, touch)| touch.smallest_gap);
        line("contact", format!("{name}: {}", shown(problem, &parameters, gap)))
    };
    obstacles.chain(solid.model().touch_parameters().into_iter().map(contact)).collect()
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
    if shown.is_empty() { "at rest".to_owned() } else { shown.join(", ") }
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

/// The contacts as results have them.
pub(super) fn records(problem: &CaseProblem) -> Vec<ContactRecord> {
    let of = |(name, of): (String, TouchParameters)| {
        let (friction, slip_speed) = of.friction.unzip();
        ContactRecord {
            name,
            thickness: of.thickness.into(),
            stiffness: of.stiffness.into(),
            samples: of.samples,
            inset: of.inset.into(),
            between_samples: of.between_samples.into(),
            friction: friction.into(),
            slip_speed: slip_speed.into(),
            lagged: of.lagged,
        }
    };
    problem.member(0).solid().model().touch_parameters().into_iter().map(of).collect()
}
