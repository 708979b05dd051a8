//! Contacts as JSON.

use nastic_case::lower::CaseProblem;
use nastic_fem::TouchParameters;
use nastic_report::record::ContactRecord;

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
    problem.member(0).solid().model().contacts().parameters().into_iter().map(of).collect()
}
