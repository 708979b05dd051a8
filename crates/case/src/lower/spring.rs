//! Springs between points of the body, and to the ground.

use super::context::Context;
use super::named::attempt;
use nastic_fem::Solid;
use nastic_language::schema::{Case, Spring, SpringEnd};

pub(super) fn add(case: &Case, solid: &mut Solid, context: &mut Context<'_>) {
    for spring in &case.springs {
        attempt(solid, &spring.at, context, |solid| solid.spring(build(spring)));
    }
}

fn build(spring: &Spring) -> nastic_fem::Spring {
    let (name, from, stiffness) = (spring.name(), spring.from.clone(), spring.stiffness);
    let built = match &spring.to {
        SpringEnd::Body(to) => nastic_fem::Spring::between(&name, from, to.clone(), stiffness),
        SpringEnd::Ground(to) => nastic_fem::Spring::to_ground(&name, from, to.ground.xyz(), stiffness),
    };
    spring.length.into_iter().fold(built, nastic_fem::Spring::rest_length)
}
