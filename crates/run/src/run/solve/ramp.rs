//! `nastic solve --ramp CONTROL=FROM:TO:N`: equilibria with one control going from one value to another.

use crate::console::Console;
use crate::run::error::{Exit, RunError};
use crate::run::report::remove_earlier;
use crate::run::session::{CommandContext, CommandFindings, Opened};
use crate::run::solve::ramp_failure::RampFailure;
use crate::run::solve::ramp_jumps::jumps;
use crate::run::solve::series::{Row, Series};
use nastic_case::lower::{CaseMember, ControlField, doubt_of_ramp};
use nastic_case::warning::{BOUNDS, Warning};
use nastic_control::{ControlBlock, ControlError};
use nastic_fem::{Progress, Ramp, RampPoint, SolveOptions, StateError, Workspace};
use nastic_language::expression::{Formula, dimension_of};
use nastic_language::number::short;
use nastic_language::quantity::{Dimension, Units};
use nastic_report::record::{PointRecord, SeriesRecord};

/// Most equilibria of one ramp.
const MOST: usize = 10_000;

/// What goes without a ramp.
const ONE_BY_ONE: &str = "give it value by value, nastic sweep CASE --set controls/K/start=A,B";

/// What is asked for.
struct Asked {
    control: String,
    from: Formula,
    to: Formula,
    count: usize,
}

pub(super) fn run(opened: &mut Opened<'_>, text: &str) -> Result<Exit, RunError> {
    let Opened { input, destination, .. } = opened;
    let complain = |what: String| RunError::from(input.problem.complain("controls", format!("--ramp: {what}")));
    let asked = Asked::parse(text, input.problem.units()).map_err(|what| destination.refuse(complain(what)))?;
    let members = 0..input.problem.members().count();
    let owners: Vec<usize> = members.filter(|&k| asked.field(input.problem.member(k)).is_some()).collect();
    if owners.is_empty() {
        let known: Vec<&str> = input.problem.controls.iter().map(|field| field.name.as_str()).collect();
        let what = match known.is_empty() {
            true => "the case has no controls to ramp; --path raises loads and displacements".to_owned(),
            false => format!("control \"{}\" not found; there are: {}", asked.control, known.join(", ")),
        };
        return Err(destination.refuse(complain(what)));
    }
    let (context, findings) = opened.parts();
    let CommandContext { input, destination, console } = context;
    remove_earlier(input, destination)?;
    let mut files = Vec::new();
    let mut exit = Exit::Done;
    for index in owners {
        asked.doubt(input.problem.member(index), console, findings);
        let (entry, own, failure, warnings) = findings.timed(console, "solve", |_| asked.of_member(context, index))?;
        findings.warn_all(console, warnings);
        findings.entries_of(input.problem.member(index)).ramp = Some(entry);
        files.extend(own);
        if let Some((why, error)) = failure {
            let member = input.problem.member(index).name();
            let member = if member.is_empty() { member } else { format!("{member}: ") };
            let what = format!("{member}the ramp stops at {why}");
            console.say(format!("STOPPED     {what}"));
            findings.record.error = Some(what);
            if matches!(error, StateError::Cancelled) {
                exit = if exit == Exit::Done { Exit::NotConverged } else { exit };
                break;
            }
            exit = Exit::ForwardFailed;
        }
    }
    if destination.out.is_some() {
        findings.say_files(console, files);
    }
    Ok(exit)
}

impl Asked {
    fn parse(text: &str, units: &Units) -> Result<Self, String> {
        let form = || format!("\"{text}\" is not CONTROL=FROM:TO:N, as in \"air=0 Pa:60 kPa:12\"");
        let (control, values) = text.split_once('=').ok_or_else(form)?;
        let [from, to, count] = values.split(':').collect::<Vec<_>>()[..] else { return Err(form()) };
        let count = count.trim().parse().ok().filter(|n| (2..=MOST).contains(n));
        let count = count.ok_or_else(|| format!("N must be a whole number from 2 to {MOST} in \"{text}\""))?;
        let value = |text: &str| {
            let formula = Formula::parse(text.trim(), units).map_err(|error| error.to_string())?;
            match formula.constant() {
                Some(_) => Ok(formula),
                None => Err(format!("\"{text}\" varies over the body; a ramp goes between two values")),
            }
        };
        Ok(Self { control: control.trim().to_owned(), from: value(from)?, to: value(to)?, count })
    }

    /// The field of that name.
    fn field<'p>(&self, member: CaseMember<'p>) -> Option<(&'p ControlBlock, &'p ControlField)> {
        member.fields().find(|(block, field)| [&field.name, &field.array, &block.name].contains(&&self.control))
    }

    /// Both ends, in the case's units.
    fn ends(&self, member: CaseMember<'_>, block: &ControlBlock) -> Result<[f64; 2], String> {
        if block.components != 1 {
            let name = &self.control;
            return Err(format!("control \"{name}\" is a vector; give it a \"direction\", then its amplitude can go"));
        }
        if is_number(member, block) {
            let name = &self.control;
            return Err(format!("\"{name}\" is a number of the body, which loads do not change: {ONE_BY_ONE}"));
        }
        if !block.goes_straight() {
            let name = &self.control;
            return Err(format!(
                "what stands between the unknowns of \"{name}\" and its values does not go straight with them, as a projection: {ONE_BY_ONE}"
            ));
        }
        let dimension = dimension_of(block.unit).unwrap_or(Dimension::NONE);
        self.from.check(dimension)?;
        self.to.check(dimension)?;
        let ends = [&self.from, &self.to].map(|end| end.constant().unwrap_or(f64::NAN));
        match ends.iter().find(|end| block.log && **end <= 0.0) {
            Some(end) => Err(format!("{end} has no logarithm: the values of \"{}\" are positive", self.control)),
            None => Ok(ends),
        }
    }

    /// Warns, before anything is solved, of an end that was hardly meant.
    fn doubt(&self, member: CaseMember<'_>, console: &Console, findings: &mut CommandFindings) {
        let Some((block, field)) = self.field(member) else { return };
        let Ok(ends) = self.ends(member, block) else { return };
        let doubt = |end: &f64| doubt_of_ramp(member.case(), field, *end, member.solid());
        if let Some(why) = ends.iter().rev().find_map(doubt) {
            findings.warn(console, Warning::new(&BOUNDS, why));
        }
    }

    /// The result's entry, the files, where it failed, and what deserves attention.
    fn of_member(&self, context: CommandContext<'_>, index: usize) -> Result<RampFindings, RunError> {
        let CommandContext { input, destination, console } = context;
        let problem = &input.problem;
        let member = problem.member(index);
        let complain = |what: String| RunError::from(problem.complain("controls", format!("--ramp: {what}")));
        let Some((block, field)) = self.field(member) else { return Err(complain(self.control.clone())) };
        let [from, to] = self.ends(member, block).map_err(complain)?;
        let start = member.local(&problem.start);
        let at = |value: f64| {
            let mut m = start.clone();
            m[block.first..block.first + block.len()].fill(if block.log { value.ln() } else { value });
            m
        };
        let points = |value: f64| member.reduced().layout_in_stage(0).to_points(&at(value));
        let failed = |error: ControlError| destination.member_failed(input, index, error);
        let (first, last) = (points(from).map_err(failed)?, points(to).map_err(failed)?);

        let mut series = Series::new(member, "ramp", (field.array.clone(), field.unit.clone()));
        let inside = member.inside();
        let ends = format!("{} to {} {}", short(from), short(to), field.unit);
        console.say(format!("ramp        {} from {ends} in {} equilibria{inside}", field.array, self.count));
        console.say(series.header());
        let progress = |now: &Progress| {
            let line = format!("Newton iteration {}, residual {:.1e}", now.newton, now.residual);
            console.progress(now.newton, line);
        };
        let how = SolveOptions { cancel: Some(&input.cancel), watch: Some(&progress), ..SolveOptions::default() };
        let value = |s: f64| if s == 1.0 { to } else { from + s * (to - from) };
        let mut found = |point: &RampPoint| {
            let (parameter, state) = (value(point.s), point.state.clone());
            let row = Row { parameter, m: at(parameter), newton: state.report.newton, state, negative: point.negative };
            console.say(series.line(&row));
            series.rows.push(row);
        };
        let model = member.solid().model();
        let ramp = model.stability().ramp(&first, &last, self.count, &how, &mut Workspace::default(), &mut found);
        let ramp = ramp.map_err(|error| failed(error.into()))?;
        let critical = critical(console, &ramp, from, to, &field.unit);
        let mut warnings = series.inspect();
        let (jumps, told_of_jumps) = jumps(&series, &how);
        warnings.extend(told_of_jumps);

        let mut chart = series.chart(false);
        for point in &ramp.critical {
            chart = chart.mark(value(point.s), &format!("{} > {}", point.before, point.after));
        }
        let mut files = match &destination.out {
            Some(out) if !series.rows.is_empty() => series.write(&chart, out)?,
            _ => Vec::new(),
        };
        let (mut shown, mut failure) = (None, None);
        if let Some((s, error)) = ramp.failure {
            let before = ramp.points.last().map(|point| value(point.s));
            let stopped = RampFailure { error: &error, before, target: value(s), unit: &field.unit };
            shown = Some(stopped.record(member));
            let (name, m) = (member.file("failure.vtu"), at(stopped.reached()));
            files.extend(destination.write_failure(member, &name, &m, &error)?.map(|_| name));
            failure = Some((format!("{}: {}", stopped.at(), stopped.why()), error));
        }
        let entry = SeriesRecord {
            control: Some(field.name.clone()),
            unit: Some(field.unit.clone()),
            from: from.into(),
            to: to.into(),
            points: series.points(),
            critical: Some(critical),
            jumps: Some(jumps),
            failed: shown.into(),
            ..SeriesRecord::default()
        };
        Ok((entry, files, failure, warnings))
    }
}

type RampFindings = (SeriesRecord, Vec<String>, Option<(String, StateError)>, Vec<Warning>);

/// Critical values, said and as a list.
fn critical(console: &Console, ramp: &Ramp, from: f64, to: f64, unit: &str) -> Vec<PointRecord> {
    let of = |point: &nastic_fem::CriticalPoint| {
        let (value, error) = (from + point.s * (to - from), 0.5 * point.width * (to - from).abs());
        console.say(format!(
            "critical    {} {unit} (within {}): from {} to {} negative pivots",
            short(value),
            short(error),
            point.before,
            point.after
        ));
        let pivots = |n: usize| Some(n).into();
        let (before, after) = (pivots(point.before), pivots(point.after));
        PointRecord { value: value.into(), error: error.into(), before, after, ..PointRecord::default() }
    };
    ramp.critical.iter().map(of).collect()
}

/// Whether a control is a number of the body, such as a modulus.
fn is_number(member: CaseMember<'_>, block: &ControlBlock) -> bool {
    let all = member.solid().model().controllable();
    block.targets.iter().any(|target| all[target.actuation].slots.get(target.slot).is_some_and(|slot| slot.is_design()))
}
