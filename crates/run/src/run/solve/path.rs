//! `nastic solve --path`: the equilibrium path from rest to the start controls and full loads, through limit points.

use crate::run::error::{Exit, RunError};
use crate::run::session::{CommandContext, Opened};
use crate::run::solve::series::{Row, Series};
use nastic_case::lower::CaseMember;
use nastic_case::warning::Warning;
use nastic_control::{ControlAt, ControlBlock, ControlError, ControlTarget};
use nastic_fem::{
    EquilibriumPath, EventKind, PathEnd, PathEvent, PathOptions, PathPoint, Progress, SolveOptions, Workspace,
};
use nastic_language::number::short;
use nastic_picture::Chart;
use nastic_report::record::{PointRecord, RangeRecord, SeriesRecord};
use nastic_result::summary;

/// Control fields that a line names.
const NAMED: usize = 3;

/// `to_limit`: to the first limit point, if there is one.
pub(super) fn run(opened: &mut Opened<'_>, to_limit: bool) -> Result<Exit, RunError> {
    let Opened { input, destination, .. } = opened;
    let unscaled = input.problem.members().find_map(|member| {
        member
            .fields()
            .find(|(block, _)| is_load(member, block) && !block.is_proportional())
            .map(|(_, field)| &field.name)
    });
    if let Some(name) = unscaled {
        let message = format!(
            "--path: the values of \"{name}\" are no shares of themselves on the way from rest, with what is fixed or projected: give each state a start of its own, nastic sweep CASE --set controls/K/start=A,B"
        );
        let error = input.problem.complain("controls", message).into();
        return Err(destination.refuse(error));
    }
    let (context, findings) = opened.parts();
    let CommandContext { input, destination, console } = context;
    let mut files = Vec::new();
    let mut exit = Exit::Done;
    for index in 0..input.problem.members().count() {
        let shown = findings.timed(console, "solve", |_| of_member(context, index, to_limit))?;
        let PathFindings { entry, files: own, stopped, warnings } = shown;
        findings.warn_all(console, warnings);
        findings.entries_of(input.problem.member(index)).path = Some(entry);
        files.extend(own);
        if let Some((how, why)) = stopped {
            console.say(format!("STOPPED     {why}"));
            findings.record.error = Some(why);
            exit = if exit == Exit::ForwardFailed { exit } else { how };
            if input.is_cancelled() {
                break;
            }
        }
    }
    if destination.out.is_some() {
        findings.say_files(console, files);
    }
    Ok(exit)
}

/// What became of a member.
struct PathFindings {
    entry: SeriesRecord,
    files: Vec<String>,
    /// Why its path stopped short of the end.
    stopped: Option<(Exit, String)>,
    warnings: Vec<Warning>,
}

fn of_member(context: CommandContext<'_>, index: usize, to_limit: bool) -> Result<PathFindings, RunError> {
    let CommandContext { input, destination, console } = context;
    let member = input.problem.member(index);
    let start = member.local(&input.problem.start);
    let failed = |error: ControlError| destination.member_failed(input, index, error);
    let controls = member.reduced().layout_in_stage(0).to_points(&start).map_err(failed)?;

    let mut series = Series::new(member, "path", ("s".to_owned(), String::new()));
    let inside = member.inside();
    console.say(format!("path        from rest (s = 0) to the start controls and full loads (s = 1){inside}"));
    console.say(series.header());
    let progress = |now: &Progress| {
        let line = format!("s {:.4}, Newton iteration {}, residual {:.1e}", now.load, now.newton, now.residual);
        console.progress(now.newton, line);
    };
    let how = SolveOptions { cancel: Some(&input.cancel), watch: Some(&progress), ..SolveOptions::default() };
    let mut found = |point: &PathPoint| {
        let (m, state) = (controls_at(member, &start, point.s), point.state.clone());
        let row = Row { parameter: point.s, m, newton: state.report.newton, state, negative: point.negative };
        console.say(series.line(&row));
        series.rows.push(row);
    };
    let model = member.solid().model();
    let (rest, options) = (model.rest_under(&controls), PathOptions { to_limit, ..PathOptions::default() });
    let path = model.stability().path(&rest, (&controls, 1.0), &options, &how, &mut Workspace::default(), &mut found);
    let path = path.map_err(|error| failed(error.into()))?;
    let layout = member.reduced().layout_in_stage(0);
    let shown = |event: &PathEvent| layout.described(&controls_at(member, &start, event.s)).map_err(failed);
    let controls: Vec<Vec<ControlAt>> = path.events.iter().map(shown).collect::<Result<_, _>>()?;
    let events = path.events.iter().zip(&controls);
    events.clone().for_each(|(event, controls)| console.say(line(event, controls)));
    let warnings = series.inspect();

    let files = match &destination.out {
        Some(out) => series.write(&chart(&series, &path), out)?,
        None => Vec::new(),
    };
    let stopped = stopped(&path, &member.name());
    let entry = SeriesRecord {
        points: series.points(),
        events: Some(events.map(|(event, controls)| event_record(member, event, controls)).collect()),
        stopped: stopped.as_ref().map(|(_, why)| why.clone()).into(),
        ..SeriesRecord::default()
    };
    Ok(PathFindings { entry, files, stopped, warnings })
}

/// The controls at s on the way from rest: loads have this share of their values, designs of the body theirs.
fn controls_at(member: CaseMember<'_>, start: &[f64], s: f64) -> Vec<f64> {
    let mut m = start.to_vec();
    for block in member.layout().blocks() {
        if is_load(member, block) {
            m[block.first..block.first + block.len()]
                .iter_mut()
                .for_each(|m| if block.log { *m += s.ln() } else { *m *= s });
        }
    }
    m
}

/// Whether a control is no number of the body.
fn is_load(member: CaseMember<'_>, block: &ControlBlock) -> bool {
    let all = member.solid().model().controllable();
    let of = |target: &ControlTarget| all[target.actuation].slots.get(target.slot).is_none_or(|slot| !slot.is_design());
    block.targets.iter().all(of)
}

fn name(kind: EventKind) -> &'static str {
    match kind {
        EventKind::LimitPoint => "limit point",
        EventKind::Bifurcation => "bifurcation",
    }
}

/// `critical    limit point at s = 0.512705, air = 4300 Pa: from 0 to 1 negative pivots`.
fn line(event: &PathEvent, controls: &[ControlAt]) -> String {
    let count = |n: Option<usize>| n.map_or_else(|| "-".to_owned(), |n| n.to_string());
    let (before, after) = (count(event.before), count(event.after));
    let named = controls.iter().take(NAMED).map(|control| format!(", {control}")).collect::<String>();
    let rest = controls.len().saturating_sub(NAMED);
    let more = if rest > 0 { format!(" and {rest} more") } else { String::new() };
    let kind = name(event.kind);
    format!("critical    {kind} at s = {:.6}{named}{more}: from {before} to {after} negative pivots", event.s)
}

fn event_record(member: CaseMember<'_>, event: &PathEvent, controls: &[ControlAt]) -> PointRecord {
    let control = |ControlAt { name, range: [min, max], unit }: &ControlAt| {
        (name.clone(), RangeRecord { min: (*min).into(), max: (*max).into(), unit: Some(unit.clone()) })
    };
    PointRecord {
        kind: Some(name(event.kind).to_owned()),
        value: event.s.into(),
        controls: Some(controls.iter().map(control).collect()),
        before: event.before.into(),
        after: event.after.into(),
        state: summary::shape(member, &event.state),
        ..PointRecord::default()
    }
}

/// The load-displacement curve with its limit points.
fn chart(series: &Series<'_>, path: &EquilibriumPath) -> Chart {
    path.events.iter().fold(series.chart(true), |chart, event| {
        let label = match event.kind {
            EventKind::LimitPoint => format!("limit point {}", short(event.s)),
            EventKind::Bifurcation => String::new(),
        };
        chart.dot(series.first_value(&event.state), event.s, &label)
    })
}

/// Why a path does not reach s = 1.
fn stopped(path: &EquilibriumPath, member: &str) -> Option<(Exit, String)> {
    let s = short(path.points.last().map_or(0.0, |point| point.s));
    let member = if member.is_empty() { String::new() } else { format!("{member}: ") };
    match &path.end {
        PathEnd::Left if path.points.last().is_some_and(|point| point.s > 0.0) => None,
        PathEnd::Left => {
            Some((Exit::NotConverged, format!("{member}the path turns back to s = {s} and is not followed further")))
        }
        PathEnd::LimitPoint => None,
        PathEnd::Points => {
            let many = path.points.len();
            Some((Exit::NotConverged, format!("{member}the path has {many} points and has come to s = {s}")))
        }
        PathEnd::Stuck(why) => Some((Exit::ForwardFailed, format!("{member}the path ends at s = {s}: {why}"))),
        PathEnd::Cancelled => Some((Exit::NotConverged, format!("{member}stopped at s = {s}"))),
    }
}
