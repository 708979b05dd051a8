//! The springs in words and as JSON.

use crate::run::describe::actuation::{at_rest, body_point, point};
use nastic_case::describe::{Line, line};
use nastic_case::lower::CaseProblem;
use nastic_fem::BodyPoint;
use nastic_language::number::quantity;
use nastic_language::quantity::{Dimension, Want};
use nastic_language::schema::{Spring, SpringEnd};
use nastic_report::record::{BodyPointRecord, SpringRecord};

pub(in crate::run) fn springs(problem: &CaseProblem) -> Vec<Line> {
    let units = problem.units();
    let of = |spring: &Spring| {
        let name = spring.name();
        let to = match &spring.to {
            SpringEnd::Body(to) => point(to),
            SpringEnd::Ground(to) => format!("the ground at {}", point(&BodyPoint::At(to.ground.xyz()))),
        };
        let shown = |key: &str, of: Want| {
            let value = at_rest(problem, &name, key).zip(of.dimension);
            value.map_or_else(String::new, |(value, dimension)| quantity(value, dimension, units))
        };
        let stiffness = quantity(spring.stiffness, Dimension::STIFFNESS, units);
        let text = format!(
            "{name}: from {} to {to}; stiffness {stiffness}; rest length {}, force {} where the body is at rest",
            point(&spring.from),
            shown("rest_length", Want::LENGTH),
            shown("force", Want::FORCE)
        );
        line("springs", text)
    };
    problem.case.springs.iter().map(of).collect()
}

/// The springs as results have them.
pub(super) fn records(problem: &CaseProblem) -> Vec<SpringRecord> {
    let of = |spring: &Spring| {
        let (name, to) = (spring.name(), &spring.to);
        let to = match to {
            SpringEnd::Body(to) => body_point(to),
            SpringEnd::Ground(to) => BodyPointRecord::Ground { ground: to.ground.xyz() },
        };
        SpringRecord {
            from: Some(body_point(&spring.from)).into(),
            to: Some(to).into(),
            stiffness: spring.stiffness.into(),
            rest_length: at_rest(problem, &name, "rest_length").into(),
            force_at_rest: at_rest(problem, &name, "force").into(),
            name,
        }
    };
    problem.case.springs.iter().map(of).collect()
}
