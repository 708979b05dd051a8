//! Blocks that add a contribution each, as results have them.

use crate::describe::actuation::body_point;
use nastic_case::lower::CaseProblem;
use nastic_language::schema::{Block, Medium, Spring, SpringEnd, at_rest};
use nastic_report::record::{BlockRecords, BodyPointRecord, MediumRecord, SpringRecord};

pub(super) fn records(problem: &CaseProblem) -> BlockRecords {
    let (case, solid) = (&problem.case, problem.solid());
    let spring = |spring: &Spring| {
        let name = spring.name();
        let to = match &spring.to {
            SpringEnd::Body(to) => body_point(to),
            SpringEnd::Ground(to) => BodyPointRecord::Ground { ground: to.ground.xyz() },
        };
        SpringRecord {
            from: Some(body_point(&spring.from)).into(),
            to: Some(to).into(),
            stiffness: spring.stiffness.into(),
            rest_length: at_rest(solid, &name, "rest_length").into(),
            force_at_rest: at_rest(solid, &name, "force").into(),
            name,
        }
    };
    let medium = |medium: &Medium| MediumRecord {
        name: medium.name(),
        region: medium.region.iter().map(str::to_owned).collect(),
        stiffness: medium.stiffness.into(),
    };
    BlockRecords {
        springs: (!case.springs.is_empty()).then(|| case.springs.iter().map(spring).collect()),
        media: (!case.media.is_empty()).then(|| case.media.iter().map(medium).collect()),
    }
}
