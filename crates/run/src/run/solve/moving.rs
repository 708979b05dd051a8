//! `nastic solve` of a case that moves, and `nastic resume` of one that was stopped.

use crate::run::error::{Exit, RunError};
use crate::run::motion;
use crate::run::session::{CommandContext, Opened};
use crate::run::solve::equilibrium::{report, show, write};
use crate::run::solve::half_thickness;
use crate::run::time_steps;
use crate::saved::motion_checkpoint::MotionCheckpoint;
use nastic_case::analysis::Analysis;
use nastic_case::inspect::stillness;
use nastic_language::number::count;
use nastic_report::record::ResumedRecord;
use std::mem::take;

/// The motion at the start controls, from the beginning or from a checkpoint.
pub(super) fn run(
    opened: &mut Opened<'_>,
    from: Option<MotionCheckpoint>,
    analysis: &Analysis,
) -> Result<Exit, RunError> {
    if *analysis == Analysis::HalfThickness {
        half_thickness::check(&opened.input.problem)?;
    }
    time_steps::find(opened)?;
    let (context, findings) = opened.parts();
    let CommandContext { input, destination, console } = context;
    let (point, records) = motion::solve(context, findings, from)?;
    let found = findings.inspect(input, console, motion::state_name(&input.problem), &point);
    motion::warn(&input.problem, console, findings, &records);
    for record in &records {
        findings.warn_all(console, stillness(input.problem.member(record.member), &record.shown));
    }
    report(context, findings, &point, &found)?;
    motion::report(input, console, findings, &records, &point);
    findings.write(console, destination, |own, out| write(&input.problem, own, &point, &found, &records, &[], out))?;
    if *analysis == Analysis::HalfThickness {
        half_thickness::run(context, findings, &point)?;
    }
    show(&input.problem, findings, point, None, found);
    Ok(Exit::Done)
}

/// Goes on with a motion that was stopped.
pub(in crate::run) fn resume(opened: &mut Opened<'_>, mut checkpoint: MotionCheckpoint) -> Result<Exit, RunError> {
    let input = &opened.input;
    if input.options.spectrum.is_some() {
        let message = "--spectrum looks at optima, and this resumes the motion of nastic solve: leave it out";
        return Err(input.problem.complain("time", message).into());
    }
    time_steps::restore(opened, take(&mut checkpoint.steps))?;
    let Opened { console, findings, .. } = opened;
    let places = checkpoint.places();
    let shown = places.iter().map(usize::to_string).collect::<Vec<_>>().join(", ");
    console.say(format!("resumed     the motion goes on behind step {shown}"));
    let repeated = checkpoint.reached().into_iter().zip(&places).map(|(reached, place)| reached - place).max();
    if let Some(most) = repeated.filter(|most| *most > 0) {
        let again = count(most, "step");
        console.say(format!("            {again} behind it are in the results already and are computed once more"));
    }
    findings.record.resumed = ResumedRecord { steps: Some(places), ..ResumedRecord::default() };
    run(opened, Some(checkpoint), &Analysis::Equilibrium)
}
