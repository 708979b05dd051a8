//! Results in lines for the terminal.

use crate::run::session::Session;
use nastic_language::number::{quantity, short, vector};
use nastic_language::quantity::Dimension;
use nastic_numeric::format::scientific;
use serde_json::{Map, Value};

/// Smallest J and inertia, of the worst member.
pub(crate) fn say_stability(session: &Session<'_>, result: &Value) {
    let min_j = result["min_J"].as_f64().unwrap_or(f64::NAN);
    if session.problem.is_motion() {
        session.console.say(format!("deformation min J {} over the motion", short(min_j)));
        return;
    }
    session.console.say(format!("stability   min J {}, {}", short(min_j), inertia(result)));
}

/// Entries of all members with their names, of a case that is not plain.
pub(crate) fn members_of(result: &Value) -> Vec<(String, &Map<String, Value>)> {
    let mut out = Vec::new();
    for (name, scenario) in result["scenarios"].as_object().into_iter().flatten() {
        match scenario["load_cases"].as_object() {
            Some(cases) => {
                let own = cases.iter().filter_map(|(case, entry)| Some((format!("{name}/{case}"), entry.as_object()?)));
                out.extend(own);
            }
            None => out.extend(scenario.as_object().map(|entry| (name.clone(), entry))),
        }
    }
    let cases = result["load_cases"].as_object().into_iter().flatten();
    out.extend(cases.filter_map(|(name, entry)| Some((name.clone(), entry.as_object()?))));
    out
}

/// Members whose numbers are said; the result has them all.
pub(crate) const SAID: usize = 12;

/// One line per member, and one about their risk.
pub(crate) fn say_members(session: &Session<'_>, result: &Value) {
    let members = members_of(result);
    let width = members.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0);
    for (k, (name, entry)) in members.iter().enumerate().take(SAID) {
        let head = if k == 0 { "members" } else { "" };
        let number = |value: Option<&Value>| value.and_then(Value::as_f64);
        let cost = number(entry.get("cost").and_then(|cost| cost.get("total")));
        let cost = cost.map_or_else(String::new, |cost| format!("cost {}, ", scientific(cost, 6)));
        let weight = match (number(entry.get("probability")), number(entry.get("weight"))) {
            (Some(p), _) => format!("probability {}, ", short(p)),
            (None, Some(weight)) => format!("weight {}, ", short(weight)),
            (None, None) => String::new(),
        };
        let stable = inertia(&Value::Object((*entry).clone()));
        let min_j = number(entry.get("min_J")).unwrap_or(f64::NAN);
        session.console.say(format!("{head:<12}{name:<width$}  {weight}{cost}min J {}, {stable}", short(min_j)));
    }
    if members.len() > SAID {
        session.console.say(format!("            and {} more, in result.json", members.len() - SAID));
    }
    if let Some(measures) = result["risk"]["measures"].as_object() {
        let of = |(name, measure): (&String, &Value)| {
            let level =
                measure["level"].as_f64().map_or_else(String::new, |level| format!(" (level {})", short(level)));
            let value = measure["value"].as_f64().map_or_else(|| "-".to_owned(), |x| scientific(x, 4));
            format!("{name}{level} {value}")
        };
        let all: Vec<String> = measures.iter().map(of).collect();
        let deviation = scientific(result["risk"]["deviation"].as_f64().unwrap_or(f64::NAN), 4);
        session.console.say(format!("risk        {}; standard deviation {deviation}", all.join(", ")));
    }
}

/// What the inertia means.
pub(crate) fn inertia(result: &Value) -> String {
    match result["inertia"].as_u64() {
        Some(0) => "stable (no negative pivot of the tangent)".to_owned(),
        Some(1) => "UNSTABLE: 1 negative pivot of the tangent".to_owned(),
        Some(n) => format!("UNSTABLE: {n} negative pivots of the tangent"),
        None if result["inertia_missing"]["singular"] == true => "the tangent is singular: a bifurcation".to_owned(),
        None => {
            let why = result["inertia_missing"]["why"].as_str().unwrap_or("no reason is known");
            format!("negative pivots not counted: {why}")
        }
    }
}

/// Cost and distance, where there are any.
pub(crate) fn say_cost(session: &Session<'_>, result: &Value) {
    let number = |value: &Value| value.as_f64().map_or_else(|| "-".to_owned(), |x| scientific(x, 9));
    if let Some(terms) = result["cost"]["terms"].as_object() {
        session.console.say(format!("cost        {}", number(&result["cost"]["total"])));
        if terms.len() > 1 {
            for (name, value) in terms {
                session.console.say(format!("            {name} {}", number(value)));
            }
        }
    }
    if let Some(distance) = result["hausdorff"].as_object() {
        let entry = |key: &str| distance.get(key).and_then(Value::as_f64).map_or_else(|| "-".to_owned(), short);
        let unit = session.problem.units().length().symbol;
        session.console.say(format!(
            "distance    true Hausdorff {} {unit}, smoothed {} {unit}, target to itself {} {unit}",
            entry("true"),
            entry("smoothed"),
            entry("self")
        ));
    }
}

/// Means and standard deviations of the probes' displacements over the scenarios.
pub(crate) fn say_spread(session: &Session<'_>, result: &Value) {
    let unit = session.problem.units().length().symbol;
    for (place, probe) in nested(&result["probes"]).into_iter().filter(|(_, probe)| probe["deviation"].is_array()) {
        let [mean, deviation] = ["displacement", "deviation"].map(|key| vector(&numbers(&probe[key])));
        session.console.say(format!(
            "probe       {place} moves by {mean} {unit} in the mean, standard deviation {deviation} {unit}"
        ));
    }
}

/// Probes by their names, those of load cases as `CASE/NAME`.
pub(crate) fn nested(probes: &Value) -> Vec<(String, &Value)> {
    let mut out = Vec::new();
    for (name, entry) in probes.as_object().into_iter().flatten() {
        if entry["point"].is_array() {
            out.push((name.clone(), entry));
        } else {
            out.extend(nested(entry).into_iter().map(|(own, entry)| (format!("{name}/{own}"), entry)));
        }
    }
    out
}

/// The probes' displacements and the volumes of cavities, of every member.
pub(crate) fn say_probes(session: &Session<'_>, result: &Value) {
    say_spread(session, result);
    let unit = session.problem.units().length().symbol;
    for (member, entry) in with_plain(result) {
        for (name, cavity) in entry.get("contributions").and_then(Value::as_object).into_iter().flatten() {
            let number = |key: &str| cavity.get(key).and_then(Value::as_f64);
            if let (Some(volume), Some(rest)) = (number("volume"), number("reference_volume")) {
                let size = format!("{} {unit}^{}", short(volume), session.problem.mesh().dim());
                let times = short(volume / rest);
                let units = session.problem.units();
                let pressure = quantity(number("pressure").unwrap_or(f64::NAN), Dimension::PRESSURE, units);
                session.console.say(format!(
                    "volume      {name} {size}, {times} times that at rest, at {pressure}{}",
                    inside(&member)
                ));
            }
        }
        for (name, probe) in entry.get("probes").and_then(Value::as_object).into_iter().flatten() {
            let u = numbers(&probe["displacement"]);
            let digits = u.iter().map(|x| format!("{x:.9}")).collect::<Vec<_>>().join(", ");
            session.console.say(format!("probe       {name} moves by ({digits}) {unit}{}", inside(&member)));
        }
    }
}

pub(crate) fn say_reactions(session: &Session<'_>, result: &Value) {
    let unit = session.problem.units().force().symbol;
    for (member, entry) in with_plain(result) {
        for (name, force) in entry.get("reactions").and_then(Value::as_object).into_iter().flatten() {
            let force = vector(&numbers(force));
            session.console.say(format!("reaction    {name} holds with {force} {unit}{}", inside(&member)));
        }
    }
}

/// The entries of the members that are said; of a plain case the result itself.
pub(crate) fn with_plain(result: &Value) -> Vec<(String, &Map<String, Value>)> {
    let mut members = members_of(result);
    if !members.is_empty() {
        members.truncate(SAID);
        return members;
    }
    result.as_object().map(|result| (String::new(), result)).into_iter().collect()
}

pub(crate) fn inside(member: &str) -> String {
    if member.is_empty() { String::new() } else { format!(" in {member}") }
}

pub(crate) fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().into_iter().flatten().filter_map(Value::as_f64).collect()
}

/// How far tracked points are from their targets, and were at the start of an optimisation.
pub(crate) fn say_tracked(session: &Session<'_>, result: &Value) {
    let unit = session.problem.units().length().symbol;
    for (name, now) in result["tracking"].as_object().into_iter().flatten() {
        let of = |key: &str| {
            let before = result["start"]["tracking"][name][key].as_f64();
            let before = before.map_or_else(String::new, |before| format!("{} -> ", scientific(before, 3)));
            format!("{before}{} {unit}", scientific(now[key].as_f64().unwrap_or(f64::NAN), 3))
        };
        let (mean, most) = (of("root_mean_square"), of("largest"));
        session.console.say(format!("distance    {name}: root mean square {mean}, largest {most}"));
    }
    for (name, now) in result["figures"].as_object().into_iter().flatten() {
        let of = |(key, value): (&String, &Value)| {
            let before = result["start"]["figures"][name][key].as_f64();
            let before = before.map_or_else(String::new, |before| format!("{} -> ", short(before)));
            format!("{} {before}{}", key.replace('_', " "), short(value.as_f64().unwrap_or(f64::NAN)))
        };
        let told: Vec<String> = now.as_object().into_iter().flatten().map(of).collect();
        session.console.say(format!("reached     {name}: {}", told.join(", ")));
    }
}
