//! Results in lines for the terminal.

use crate::console::Console;
use nastic_case::lower::CaseProblem;
use nastic_case::warning::Warning;
use nastic_language::number::{count, quantity, short, vector};
use nastic_language::quantity::Dimension;
use nastic_numeric::format::scientific;
use nastic_report::record::{
    FreeMotionRecord, MeasureRecord, Number, ProbeRecord, ProbesRecord, RigidMotion, RunRecord, StateRecord, number_of,
};

/// Says a warning; the caller keeps it.
pub(crate) fn say_warning(console: &Console, warning: &Warning) {
    console.say(format!("WARNING     {warning}"));
}

/// Smallest J and inertia, of the worst member.
pub(crate) fn say_stability(problem: &CaseProblem, console: &Console, state: &StateRecord) {
    let min_j = short(known(state.min_j));
    if problem.is_motion() {
        console.say(format!("deformation min J {min_j} over the motion"));
        return;
    }
    console.say(format!("stability   min J {min_j}, {}", inertia(state)));
}

/// Members whose numbers are said; the result has them all.
pub(crate) const SAID: usize = 12;

/// One line per member, and one about their risk.
pub(crate) fn say_members(console: &Console, result: &StateRecord) {
    let members = result.members();
    let width = members.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0);
    for (k, (name, state)) in members.iter().enumerate().take(SAID) {
        let head = if k == 0 { "members" } else { "" };
        let cost = state.cost.total.map_or_else(String::new, |cost| format!("cost {}, ", scientific(cost, 6)));
        let weight = match (state.probability, state.weight) {
            (Some(p), _) => format!("probability {}, ", short(p)),
            (None, Some(weight)) => format!("weight {}, ", short(weight)),
            (None, None) => String::new(),
        };
        let (min_j, stable) = (short(known(state.min_j)), inertia(state));
        console.say(format!("{head:<12}{name:<width$}  {weight}{cost}min J {min_j}, {stable}"));
    }
    if members.len() > SAID {
        console.say(format!("            and {} more, in result.json", members.len() - SAID));
    }
    if let Some(measures) = &result.risk.measures {
        let of = |(name, measure): (&String, &MeasureRecord)| {
            let level = measure.level.map_or_else(String::new, |level| format!(" (level {})", short(level)));
            format!("{name}{level} {}", digits(measure.plain(), 4))
        };
        let all: Vec<String> = measures.iter().map(of).collect();
        let deviation = scientific(known(result.risk.deviation), 4);
        console.say(format!("risk        {}; standard deviation {deviation}", all.join(", ")));
    }
}

/// What the inertia means.
pub(crate) fn inertia(state: &StateRecord) -> String {
    match (*state.inertia, &state.inertia_missing) {
        (Some(0), _) if state.free_motion.is_some() => {
            format!("neutral: {}", state.free_motion.as_ref().map_or_else(String::new, FreeMotionRecord::words))
        }
        (Some(0), _) => format!("stable ({})", state.no_negative()),
        (Some(n), _) => format!("UNSTABLE: {} of the tangent", count(n, "negative pivot")),
        (None, Some(missing)) if missing.singular => "the tangent is singular: a bifurcation".to_owned(),
        (None, missing) => {
            let why = missing.as_ref().and_then(|missing| missing.why.as_deref()).unwrap_or("no reason is known");
            format!("negative pivots not counted: {why}")
        }
    }
}

/// Mean and deviation to first order, and where it comes from.
pub(crate) fn say_first_order(console: &Console, state: &StateRecord) {
    if let Some(found) = &state.first_order {
        let [mean, deviation] = [found.mean, found.deviation].map(|x| scientific(known(x), 4));
        console.say(format!(
            "first order mean {mean}, standard deviation {deviation}, about the medians of the random parameters"
        ));
        console.say(format!("            from {}", found.sources_in_words()));
    }
}

/// Cost and distance, where there are any.
pub(crate) fn say_cost(problem: &CaseProblem, console: &Console, state: &StateRecord) {
    let terms = &state.cost.terms;
    if !terms.is_empty() {
        match state.risk.unsmoothed() {
            Some(exact) => {
                let what = state.risk.words(problem.ensemble.scenarios().len());
                console.say(format!("cost        {}, {what}", digits(exact, 9)));
                let smoothed = digits(state.cost.total, 9);
                console.say(format!("            smoothed, as it is optimised, {smoothed}"));
            }
            None => console.say(format!("cost        {}", digits(state.cost.total, 9))),
        }
        for (name, value) in terms.iter().filter(|_| terms.len() > 1) {
            console.say(format!("            {name} {}", digits(*value, 9)));
        }
        say_first_order(console, state);
    }
    if let Some(distances) = &state.hausdorff {
        let [smoothed, exact, floor] = distances.distances().map(|x| x.map_or_else(|| "-".to_owned(), short));
        let unit = problem.units().length().symbol;
        console.say(format!(
            "distance    true Hausdorff {exact} {unit}, smoothed {smoothed} {unit}, target to itself {floor} {unit}"
        ));
    }
}

/// Means and standard deviations of the probes' displacements over the scenarios.
fn say_spread(problem: &CaseProblem, console: &Console, state: &StateRecord) {
    let unit = problem.units().length().symbol;
    let say = |place: &str, probe: &ProbeRecord| {
        let Some(deviation) = &probe.deviation else { return };
        let [mean, deviation] = [&probe.displacement, deviation].map(|values| vector(&numbers(values)));
        console.say(format!(
            "probe       {place} moves by {mean} {unit} in the mean, standard deviation {deviation} {unit}"
        ));
    };
    for (name, probes) in state.probes.iter().flatten() {
        match probes {
            ProbesRecord::One(probe) => say(name, probe),
            ProbesRecord::OfLoadCase(probes) => {
                probes.iter().for_each(|(own, probe)| say(&format!("{name}/{own}"), probe));
            }
        }
    }
}

/// The probes' displacements, the volumes of cavities and the motions of rigid bodies, of every member.
pub(crate) fn say_probes(problem: &CaseProblem, console: &Console, result: &StateRecord) {
    say_spread(problem, console, result);
    let units = problem.units();
    let unit = units.length().symbol;
    for (member, state) in with_plain(result) {
        for (name, own) in &state.contributions {
            if let Some(motion) = RigidMotion::of(own) {
                console.say(format!("rigid body  {name} {}{}", motion.words(unit), inside(&member)));
            }
            if let Some([volume, rest]) = own.volumes() {
                let size = format!("{} {unit}^{}", short(volume), problem.mesh().dim());
                let times = short(volume / rest);
                let pressure = quantity(known(number_of(own, "pressure")), Dimension::PRESSURE, units);
                console.say(format!(
                    "volume      {name} {size}, {times} times that at rest, at {pressure}{}",
                    inside(&member)
                ));
            }
        }
        for (name, probe) in state.probes.iter().flatten() {
            let ProbesRecord::One(probe) = probe else { continue };
            let u = numbers(&probe.displacement);
            let digits = u.iter().map(|x| format!("{x:.9}")).collect::<Vec<_>>().join(", ");
            console.say(format!("probe       {name} moves by ({digits}) {unit}{}", inside(&member)));
        }
    }
}

/// The forces of supports, of every member.
pub(crate) fn say_reactions(problem: &CaseProblem, console: &Console, result: &StateRecord) {
    let unit = problem.units().force().symbol;
    for (member, state) in with_plain(result) {
        for (name, force) in state.reactions.iter().flatten() {
            let force = vector(&numbers(force));
            console.say(format!("reaction    {name} holds with {force} {unit}{}", inside(&member)));
        }
    }
}

/// The members that are said; of a plain case the result itself.
fn with_plain(result: &StateRecord) -> Vec<(String, &StateRecord)> {
    let mut members = result.members();
    if members.is_empty() {
        return vec![(String::new(), result)];
    }
    members.truncate(SAID);
    members
}

fn inside(member: &str) -> String {
    if member.is_empty() { String::new() } else { format!(" in {member}") }
}

fn numbers(values: &[Number]) -> Vec<f64> {
    values.iter().filter_map(|value| **value).collect()
}

/// A number, or NaN where there is none.
pub(crate) fn known(number: impl Into<Option<f64>>) -> f64 {
    number.into().unwrap_or(f64::NAN)
}

/// A number to so many digits, or a dash.
pub(crate) fn digits(number: impl Into<Option<f64>>, digits: usize) -> String {
    number.into().map_or_else(|| "-".to_owned(), |x| scientific(x, digits))
}

/// How far tracked points are from their targets, and were at the start of an optimisation; what other costs report.
pub(crate) fn say_tracked(problem: &CaseProblem, console: &Console, result: &RunRecord) {
    let unit = problem.units().length().symbol;
    let change = |before: Option<f64>, now: f64, number: &dyn Fn(f64) -> String| {
        let before = before.map_or_else(String::new, |before| format!("{} -> ", number(before)));
        format!("{before}{}", number(now))
    };
    for (name, now) in &result.tracking {
        let before = |key: &str| result.start.tracking.get(name).and_then(|before| number_of(before, key));
        let of = |key: &str| change(before(key), known(number_of(now, key)), &|x| scientific(x, 3));
        let (mean, most) = (of("root_mean_square"), of("largest"));
        console.say(format!("distance    {name}: root mean square {mean} {unit}, largest {most} {unit}"));
    }
    for (name, now) in &result.figures {
        let before = |key: &str| result.start.figures.get(name).and_then(|before| number_of(before, key));
        let moves = now.contains_key("position_distance_largest");
        let of = |(key, value): (&String, &Number)| {
            let at = if moves && key == "position_distance" { " at the end" } else { "" };
            format!("{}{at} {}", key.replace('_', " "), change(before(key), known(*value), &short))
        };
        let shown: Vec<String> = now.iter().map(of).collect();
        console.say(format!("reached     {name}: {}", shown.join(", ")));
    }
}
