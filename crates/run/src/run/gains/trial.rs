//! The law on one body: how fast it converges, and its loop.

use super::law::Law;
use crate::run::session::START_ACCURACY;
use nastic_case::lower::CaseMember;
use nastic_control::{ControlError, Evaluated, Partials, ReducedWorkspace};
use nastic_fem::StateError;
use nastic_opt::Request;
use nastic_report::record::{GainsLoopRecord, Number, numbers};

/// The law on a body.
pub(super) struct Trial {
    pub record: GainsLoopRecord,
    /// S of this body.
    pub jacobian: Vec<Vec<f64>>,
}

/// From a body's equilibrium at the start: its contraction, and so many steps, each to the equilibrium under its controls.
pub(super) fn of(law: &Law, member: CaseMember<'_>, start: &Evaluated, steps: usize) -> Result<Trial, ControlError> {
    let mut workspace = ReducedWorkspace::default();
    let (open, outputs) = law.errors(member, start)?;
    let partials: Vec<&Partials> = outputs.iter().map(|one| &one.partials).collect();
    let jacobian = member.reduced().output_jacobian(start, &partials, &law.scales, &mut workspace)?.rows;
    let mut record = GainsLoopRecord {
        contraction: law.feedback.contraction(&jacobian).into(),
        unreachable: law.unreachable(&jacobian, &open).into(),
        errors: vec![law.size(&open).into()],
        open: numbers(&open),
        ..GainsLoopRecord::default()
    };
    let (mut at, mut errors) = (start.clone(), open);
    for _ in 0..steps {
        let m = law.feedback.step(&at.m, &errors, &law.bounds);
        let how = Request { near: Some(&at), accuracy: START_ACCURACY, ..Request::default() };
        let next = member.reduced().evaluate_typed(&m, &how, &mut workspace);
        let stepped = next.and_then(|next| Ok((law.errors(member, &next)?.0, next)));
        match stepped {
            Ok((new, next)) => (errors, at) = (new, next),
            Err(ControlError::State(StateError::Cancelled)) => return Err(StateError::Cancelled.into()),
            Err(error) if error.is_lack_of_memory() => return Err(error),
            Err(error) => {
                record.failed = Some(error.to_string());
                break;
            }
        }
        record.errors.push(Number::from(law.size(&errors)));
    }
    if record.failed.is_none() {
        let outputs = law.errors(member, &at)?.1;
        let partials: Vec<&Partials> = outputs.iter().map(|one| &one.partials).collect();
        let end = member.reduced().output_jacobian(&at, &partials, &law.scales, &mut workspace)?.rows;
        record.contraction_at_end = law.feedback.contraction(&end).into();
    }
    let on_bound = |(m, [lower, upper]): (&f64, &[f64; 2])| m <= lower || m >= upper;
    Ok(Trial {
        record: GainsLoopRecord {
            closed: numbers(&errors),
            controls: numbers(&at.m),
            on_bounds: at.m.iter().zip(&law.bounds).filter(|pair| on_bound(*pair)).count(),
            ..record
        },
        jacobian,
    })
}
