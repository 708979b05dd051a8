//! The motions of `solve`: they leave what they found where they fail or are stopped, and go on from a checkpoint.

use crate::run::error::RunError;
use crate::run::motion::record::Record;
use crate::run::motion::recorder::{MemberObserver, Recorder};
use crate::run::motion::write;
use crate::run::session::{CommandContext, CommandFindings, CommandInput, Destination, START_ACCURACY};
use crate::saved::motion_checkpoint::{MotionCheckpoint, NAME};
use nastic_control::{ControlError, MotionObserver};
use nastic_ensemble::{EnsembleError, EnsemblePoint, EnsembleWorkspace};
use nastic_fem::StateError;
use nastic_language::number::{count, quantity};
use nastic_language::quantity::Dimension;
use nastic_opt::Request;
use nastic_report::record::ReachedRecord;
use std::time::Instant;

/// The motions at the start controls, and what is reported of them.
pub(in crate::run) fn solve(
    context: CommandContext<'_>,
    findings: &mut CommandFindings,
    from: Option<MotionCheckpoint>,
) -> Result<(EnsemblePoint, Vec<Record>), RunError> {
    let CommandContext { input, destination, console } = context;
    if let (Some(out), None) = (&destination.out, &from)
        && out.file(NAME).exists()
    {
        let file = NAME;
        console.say(format!("note        {file} of a motion that was stopped is removed: this one begins anew"));
        out.remove(file)?;
    }
    console.phase("motion");
    let began = Instant::now();
    let recorder = Recorder::new(context, &findings.steps, from)?;
    let how = Request { accuracy: START_ACCURACY, ..Request::default() };
    let observers = recorder.observers();
    let observers: Vec<&dyn MotionObserver> = observers.iter().map(|one: &MemberObserver<'_>| one as _).collect();
    let problem = &input.problem;
    let found = problem.ensemble.observe(&problem.start, &how, &observers, &mut EnsembleWorkspace::default());
    console.clear();
    let goes_on = found.as_ref().is_err_and(may_go_on);
    if goes_on || found.is_ok() {
        // before results are written: whoever is killed while that is done goes on with no less than is there
        recorder.save();
    }
    // one that could be written earlier is as good
    let is_there = || destination.out.as_ref().is_some_and(|out| out.file(NAME).is_file());
    let repeated = if goes_on && is_there() { Some(recorder.repeated()) } else { None };
    let records = recorder.finish();
    findings.clock.note("solve", began.elapsed().as_secs_f64());
    match found {
        Ok(point) => Ok((point, records)),
        Err(error) => Err(unfinished(input, destination, findings, &records, repeated, error)),
    }
}

/// Whether the motion did not fail by itself.
fn may_go_on(error: &EnsembleError) -> bool {
    let EnsembleError::Member { source, .. } = error else { return false };
    source.is_lack_of_memory() || matches!(source.as_ref(), ControlError::State(StateError::Cancelled))
}

/// The error of motions that ended early, which says where they are; `repeated`: how many steps of each come again where it goes on, if it can.
fn unfinished(
    input: &CommandInput,
    destination: &Destination,
    findings: &mut CommandFindings,
    records: &[Record],
    repeated: Option<Vec<usize>>,
    error: EnsembleError,
) -> RunError {
    let source = Box::new(destination.forward_failed(input, error));
    // of several members the one that came least far
    let reached = records.iter().filter_map(Record::reached).min_by(|a, b| a.1.total_cmp(&b.1));
    let (Some(out), Some((steps, t))) = (&destination.out, reached) else { return *source };
    let files = match write(&input.problem, records, out) {
        Ok(files) => files,
        Err(error) => return error,
    };
    findings.list_files(files.clone());
    findings.record.reached = ReachedRecord { t: t.into(), steps };
    if repeated.is_none()
        && let Err(error) = out.remove(NAME)
    {
        return error.into();
    }
    let until = quantity(t, Dimension::TIME, input.problem.units());
    let csv = out.file(files.first().map_or("", String::as_str));
    let mut kept = format!("the motion until t = {until} is in {} and motion.pvd", csv.display());
    if let Some(repeated) = repeated {
        kept += &format!("; nastic resume {} goes on with it", out.path().display());
        if let Some(most) = repeated.into_iter().max().filter(|most| *most > 0) {
            kept += &format!(" and computes the last {} once more", count(most, "step"));
        }
    }
    RunError::Motion { source, kept }
}
