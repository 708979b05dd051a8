//! What contacts carry, and what deserves attention in them, of equilibria and of motions.

use crate::console::Console;
use crate::run::motion::record::Record;
use crate::run::motion::table::Table;
use crate::run::session::CommandFindings;
use nastic_case::inspect::touches;
use nastic_case::lower::{CaseMember, CaseProblem};
use nastic_case::warning::{CREEPS, NO_CONTACT, STEPS_PER_CONTACT, Warning};
use nastic_ensemble::EnsemblePoint;
use nastic_fem::{Sliding, Touch, TouchParameters};
use nastic_language::number::{count, quantity, short, vector};
use nastic_language::quantity::Dimension;
use nastic_report::record::{ContributionRecord, number_of};

/// A touch of fewer steps has no sharp end: how fast the body parts again is a number of the step.
const FEW_STEPS: usize = 5;
/// Creep beyond this share of the body's diagonal is said.
const CREEP: f64 = 0.01;

/// Says what the contacts of equilibria carry, and which never act.
pub(super) fn report(problem: &CaseProblem, console: &Console, findings: &mut CommandFindings, point: &EnsemblePoint) {
    if problem.is_motion() || problem.case.contact.is_empty() {
        return;
    }
    let mut untouched = Vec::new();
    for (member, at) in problem.members().zip(&point.members) {
        for (name, touch) in touches::of_state(member, at.state()) {
            console.say(line(&name, &touch, member));
            untouched.extend((touch.area == 0.0).then(|| {
                let gap = quantity(touch.smallest_gap, Dimension::LENGTH, member.problem().units());
                let message = format!("contact \"{name}\" does not act: its smallest gap is {gap}");
                Warning::new(&NO_CONTACT, message).of(member.name())
            }));
        }
    }
    findings.warn_all(console, untouched);
}

/// The same of motions, which know how contacts slide, at their ends.
pub(super) fn report_motions(
    problem: &CaseProblem,
    console: &Console,
    findings: &mut CommandFindings,
    records: &[Record],
) {
    let (mut found, dim) = (Vec::new(), problem.mesh().dim());
    for record in records {
        for (name, touch) in &record.touches {
            findings
                .entries_of(problem.member(record.member))
                .contributions
                .insert(name.clone(), touch.quantities(dim).into());
            let (member, Some(table)) = (problem.member(record.member), &record.table) else { continue };
            console.say(line(name, touch, member));
            let Some(parameters) = touches::parameters(member, name) else { continue };
            let history = History::of(table, name, touch.sliding);
            let warnings = history.warnings(name, &parameters, member);
            found.extend(warnings.into_iter().map(|warning| warning.of(member.name())));
        }
    }
    findings.warn_all(console, found);
}

/// One line for the terminal.
fn line(name: &str, touch: &Touch, member: CaseMember<'_>) -> String {
    let units = member.problem().units();
    let of = |value: f64, dimension: Dimension| quantity(value, dimension, units);
    let inside = member.inside();
    let gap = of(touch.smallest_gap, Dimension::LENGTH);
    if touch.area == 0.0 {
        return format!("contact     {name} does not act, smallest gap {gap}{inside}");
    }
    let unit = units.force().symbol;
    // on a surface that touches itself there is no force in all
    let force = match touch.force == [0.0; 3] {
        true => format!("normal forces sum to {} {unit}", short(touch.pressing)),
        false => format!("pushes with {} {unit}", vector(&touch.force[..member.mesh().dim()])),
    };
    let pressure = of(touch.largest_pressure, Dimension::PRESSURE);
    let sliding = touch.sliding.map_or_else(String::new, |sliding| {
        format!(", {} % of its pressure sticks", short((1000.0 * sliding.sticking).round() / 10.0))
    });
    format!("contact     {name} {force}, largest pressure {pressure}, smallest gap {gap}{sliding}{inside}")
}

/// What the steps of a motion say of a contact.
#[derive(Debug, Default)]
struct History {
    acted: bool,
    /// Steps of the shortest touch that began and ended, and when it ended.
    shortest: Option<(usize, f64)>,
    /// How far it crept while all of it stuck.
    creep: f64,
    /// The smallest gap, and when.
    gap: (f64, f64),
    /// The smallest between samples, and when.
    between: (f64, f64),
    /// The largest pressure, the area at that instant, and when.
    pressed: [f64; 3],
}

impl History {
    fn of(table: &Table, name: &str, sliding: Option<Sliding>) -> Self {
        let steps: Vec<(f64, ContributionRecord)> = table.contribution(name).collect();
        let smallest = |what: &str| {
            let all = steps.iter().filter_map(|(t, own)| Some((number_of(own, what)?, *t)));
            all.fold((f64::INFINITY, 0.0), |least, one| if one.0 < least.0 { one } else { least })
        };
        let mut history =
            History { gap: smallest("smallest_gap"), between: smallest("gap_between"), ..Self::default() };
        let (mut begun, mut before) = (None, None::<f64>);
        for (n, (t, contact)) in steps.iter().enumerate() {
            let of = |what: &str| number_of(contact, what).unwrap_or(0.0);
            let (area, pressure) = (of("area"), of("largest_pressure"));
            let touches = area > 0.0;
            history.acted |= touches;
            if pressure > history.pressed[0] {
                history.pressed = [pressure, area, *t];
            }
            match (touches, begun) {
                (true, None) if n > 0 => begun = Some(n),
                (false, Some(first)) => {
                    let steps = n - first;
                    if history.shortest.is_none_or(|(least, _)| steps < least) {
                        history.shortest = Some((steps, *t));
                    }
                    begun = None;
                }
                _ => {}
            }
            if sliding.is_some() && of("sticking") == 1.0 {
                history.creep += before.map_or(0.0, |before| of("sliding_speed") * (t - before));
            }
            before = Some(*t);
        }
        history
    }

    fn warnings(&self, name: &str, of: &TouchParameters, member: CaseMember<'_>) -> Vec<Warning> {
        let units = member.problem().units();
        let length = |value: f64| quantity(value, Dimension::LENGTH, units);
        let at = |time: f64| format!("at t = {}", quantity(time, Dimension::TIME, units));
        let mut out = Vec::new();
        if !self.acted {
            let message = format!("contact \"{name}\" never acts: its smallest gap is {}", length(self.gap.0));
            out.push(Warning::new(&NO_CONTACT, message));
        }
        // what overlaps the body where it was says little of one that has moved
        let depth = -of.inset - self.between.0;
        if touches::is_between(member, of.thickness, [depth, 0.0]) {
            out.push(touches::between(member, name, depth, 0.0, &at(self.between.1)));
        }
        if self.gap.0 < -of.inset {
            out.push(touches::penetrated(member, name, -of.inset - self.gap.0, &at(self.gap.1)));
        }
        if let Some((steps, t)) = self.shortest.filter(|(steps, _)| *steps < FEW_STEPS) {
            let steps = count(steps, "step");
            let message = format!("contact \"{name}\": a touch that ends {} lasts {steps}", at(t));
            out.push(Warning::new(&STEPS_PER_CONTACT, message));
        }
        let [_, area, when] = self.pressed;
        out.extend(touches::few_facets(member, name, area, &format!(" when it presses most, {}", at(when))));
        if self.creep > CREEP * member.mesh().diagonal() {
            let creep = length(self.creep);
            let message = format!("contact \"{name}\" creeps by {creep} while it sticks, at most below its slip speed");
            out.push(Warning::new(&CREEPS, message));
        }
        out
    }
}
