//! The springs in words and as JSON.

use crate::run::describe::actuation::{at_rest, point};
use crate::run::describe::line::{Line, line};
use nastic_case::lower::CaseProblem;
use nastic_fem::BodyPoint;
use nastic_language::number::quantity;
use nastic_language::quantity::{Dimension, Want};
use nastic_language::schema::{Spring, SpringEnd};
use serde_json::{Value, json};

pub(in crate::run) fn springs(problem: &CaseProblem) -> Vec<Line> {
    let units = problem.units();
    let of = |spring: &Spring| {
        let name = spring.name();
        let to = match &spring.to {
            SpringEnd::Body(to) => point(to),
            SpringEnd::Ground(to) => format!("the ground at {}", point(&BodyPoint::At(to.ground.xyz()))),
        };
        let told = |key: &str, of: Want| {
            let value = at_rest(problem, &name, key).zip(of.dimension);
            value.map_or_else(String::new, |(value, dimension)| quantity(value, dimension, units))
        };
        let stiffness = quantity(spring.stiffness, Dimension::STIFFNESS, units);
        let text = format!(
            "{name}: from {} to {to}; stiffness {stiffness}; rest length {}, force {} where the body is at rest",
            point(&spring.from),
            told("rest_length", Want::LENGTH),
            told("force", Want::FORCE)
        );
        line("springs", text)
    };
    problem.case.springs.iter().map(of).collect()
}

/// The springs as `check --json` has them.
pub(super) fn json(problem: &CaseProblem) -> Value {
    let place = |point: &BodyPoint| match point {
        BodyPoint::At(place) => json!(place),
        BodyPoint::Nodes(name) => json!(name),
    };
    let of = |spring: &Spring| {
        let to = match &spring.to {
            SpringEnd::Body(to) => place(to),
            SpringEnd::Ground(to) => json!({ "ground": to.ground.xyz() }),
        };
        let name = spring.name();
        json!({
            "name": name, "from": place(&spring.from), "to": to, "stiffness": spring.stiffness,
            "rest_length": at_rest(problem, &name, "rest_length"), "force_at_rest": at_rest(problem, &name, "force"),
        })
    };
    problem.case.springs.iter().map(of).collect()
}
