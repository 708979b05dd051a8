//! `nastic solve --half-thickness`: the state whose contacts have layers half as thick, beside the one that was asked for.

use crate::console::Console;
use crate::run::error::{Exit, RunError};
use crate::run::motion;
use crate::run::session::{CommandContext, CommandFindings, START_ACCURACY};
use nastic_case::lower::{CaseMember, CaseProblem};
use nastic_control::Evaluated;
use nastic_ensemble::{EnsemblePoint, EnsembleWorkspace};
use nastic_fem::Touch;
use nastic_language::number::{quantity, short};
use nastic_language::quantity::Dimension;
use nastic_opt::{Objective, Request};
use nastic_report::record::HalfThicknessRecord;

const HALF: f64 = 0.5;

/// Refuses a case without contacts, before anything is solved.
pub(super) fn check(problem: &CaseProblem) -> Result<(), RunError> {
    match problem.case.contact.is_empty() {
        true => {
            let message = "--half-thickness looks at the layers of contacts, and the case has none: leave it out";
            Err(problem.complain("contact", message).into())
        }
        false => Ok(()),
    }
}

/// Solves, says and puts it into the result, for every member.
pub(super) fn run(
    context: CommandContext<'_>,
    findings: &mut CommandFindings,
    point: &EnsemblePoint,
) -> Result<Exit, RunError> {
    let CommandContext { input, destination, console } = context;
    let (problem, thin) = findings.timed(console, "half thickness", |_| {
        let problem = input.problem.with_thinner_layers(HALF, input.signal.clone())?;
        let how = Request { accuracy: START_ACCURACY, ..Request::default() };
        let found = problem.ensemble.evaluate(&problem.start, &how, &mut EnsembleWorkspace::default());
        console.clear();
        let thin = found.map_err(|failed| destination.evaluation_failed(input, &failed))?;
        Ok::<_, RunError>((problem, thin))
    })?;
    for index in 0..point.members.len() {
        let whole = (input.problem.member(index), &point.members[index]);
        let entry = say(console, whole, (problem.member(index), &thin.members[index]));
        findings.entries_of(input.problem.member(index)).half_thickness = Some(entry);
    }
    Ok(Exit::Done)
}

/// What contacts carry in a state, of a motion at the end of its last step.
fn touches(member: CaseMember<'_>, at: &Evaluated) -> Vec<(String, Touch)> {
    let before = match at.states() {
        [.., before, _] => Some(before),
        _ => None,
    };
    motion::touches(member, before, at.state())
}

/// Says what halving the layers changes in a member.
fn say(
    console: &Console,
    whole: (CaseMember<'_>, &Evaluated),
    half: (CaseMember<'_>, &Evaluated),
) -> HalfThicknessRecord {
    let member = whole.0;
    let (units, dim) = (member.problem().units(), member.mesh().dim());
    let length = |value: f64| quantity(value, Dimension::LENGTH, units);
    let [of_whole, of_half] =
        [whole, half].map(|(member, at)| member.solid().model().displacement(&at.state().u).into_owned());
    let largest = |values: &mut dyn Iterator<Item = f64>| values.map(f64::abs).fold(0.0, f64::max);
    let change = largest(&mut of_half.iter().zip(&of_whole).map(|(a, b)| a - b));
    let displacement = largest(&mut of_half.iter().copied());
    console.say(format!(
        "half        layers half as thick: displacements, {} at most, change by at most {}{}",
        length(displacement),
        length(change),
        member.inside()
    ));
    let (before, after) = (touches(whole.0, whole.1), touches(half.0, half.1));
    for ((name, after), (_, before)) in after.iter().zip(&before) {
        let percent = 100.0 * (after.pressing / before.pressing - 1.0);
        let changed =
            if before.pressing > 0.0 { format!(", changed by {} %", short(round(percent))) } else { String::new() };
        let force = format!("normal forces sum to {} {}{changed}", short(after.pressing), units.force().symbol);
        console.say(format!(
            "            {name}: {force}, smallest gap {} instead of {}",
            length(after.smallest_gap),
            length(before.smallest_gap)
        ));
    }
    HalfThicknessRecord {
        newton_iterations: half.1.work.newton,
        largest_change: change.into(),
        largest_displacement: displacement.into(),
        contacts: Some(after.iter().map(|(name, touch)| (name.clone(), touch.quantities(dim).into())).collect()),
    }
}

/// To hundredths.
fn round(percent: f64) -> f64 {
    (100.0 * percent).round() / 100.0
}
