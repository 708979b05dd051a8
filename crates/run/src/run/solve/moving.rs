//! `nastic solve` of a case that moves, and `nastic resume` of one that was stopped.

use crate::run::error::{Exit, RunError};
use crate::run::motion;
use crate::run::session::Session;
use crate::run::solve::equilibrium::{report, show, write};
use crate::run::solve::half_thickness;
use crate::saved::motion_checkpoint::MotionCheckpoint;
use nastic_case::analysis::Analysis;
use nastic_case::inspect::stillness;
use nastic_language::number::count;
use nastic_report::record::ResumedRecord;
use std::mem::take;

/// The motion at the start controls, from the beginning or from a checkpoint.
pub(super) fn run(
    session: &mut Session<'_>,
    from: Option<MotionCheckpoint>,
    analysis: &Analysis,
) -> Result<Exit, RunError> {
    if *analysis == Analysis::HalfThickness {
        half_thickness::check(&session.input.problem)?;
    }
    session.find_steps()?;
    let (point, records) = motion::solve(session, from)?;
    let found = session.inspect(motion::state_name(&session.input.problem), &point);
    session.warn_of_motions(&records);
    for record in &records {
        let found = stillness(session.input.problem.member(record.member), &record.shown);
        found.into_iter().for_each(|warning| session.warn(warning));
    }
    report(session, &point, &found)?;
    session.report_motions(&records, &point);
    session.timed("write", |session| write(session, &point, &found, &records, &[]))?;
    if *analysis == Analysis::HalfThickness {
        half_thickness::run(session, &point)?;
    }
    show(session, point, None, found);
    Ok(Exit::Done)
}

/// Goes on with a motion that was stopped.
pub(in crate::run) fn resume(session: &mut Session<'_>, mut checkpoint: MotionCheckpoint) -> Result<Exit, RunError> {
    if session.input.options.spectrum.is_some() {
        let message = "--spectrum looks at optima, and this resumes the motion of nastic solve: leave it out";
        return Err(session.input.problem.complain("time", message).into());
    }
    session.restore_steps(take(&mut checkpoint.steps))?;
    let places = checkpoint.places();
    let shown = places.iter().map(usize::to_string).collect::<Vec<_>>().join(", ");
    session.console.say(format!("resumed     the motion goes on behind step {shown}"));
    let repeated = checkpoint.reached().into_iter().zip(&places).map(|(reached, place)| reached - place).max();
    if let Some(most) = repeated.filter(|most| *most > 0) {
        let again = count(most, "step");
        session
            .console
            .say(format!("            {again} behind it are in the results already and are computed once more"));
    }
    session.findings.record.resumed = ResumedRecord { steps: Some(places), ..ResumedRecord::default() };
    run(session, Some(checkpoint), &Analysis::Equilibrium)
}
