//! What a law does and does not, in sentences.

use crate::number::{count, short};
use crate::record::{GainsControlRecord, GainsLoopRecord, GainsOutputRecord, GainsRecord, Number};

/// A part of a direction from which it is named.
const NAMED: f64 = 0.1;
/// Outputs that are named of a direction, and directions that are named.
const MOST_NAMED: usize = 3;
/// A loop whose error shrinks by less than this share in all its steps has come to rest.
const AT_REST: f64 = 1e-3;
/// Share of the error in open loop, behind the last step, up to which a loop is said to have closed it.
const CLOSED: f64 = 0.02;
/// Share of the scales that the first step moves the controls of the case's own body by, above which the start is no optimum.
const MOVED: f64 = 0.01;

/// What deserves attention; `damped` is a larger damping with which the law converges on every body, if there is one that it needs.
#[must_use]
pub fn remarks(found: &GainsRecord, damped: Option<f64>) -> Vec<String> {
    let mut out = still(found);
    out.extend(combinations(found));
    if found.controls.len() > 1 {
        let unknown = found.controls.iter().filter(|one| *one.scale == Some(1.0) && *one.value == Some(0.0));
        out.extend(unknown.filter(|one| one.lower.is_none() || one.upper.is_none()).map(|one| {
            format!("the scale of {} is taken as 1 {}: give bounds, or a start other than 0", one.name, one.unit)
        }));
    }
    let is_held = |one: &&GainsControlRecord| one.lower.is_some() && *one.lower == *one.upper;
    let held: Vec<&str> = found.controls.iter().filter(is_held).map(|one| one.name.as_str()).collect();
    if !held.is_empty() {
        out.push(format!("bounds hold {}: the law leaves it where it is", held.join(", ")));
    }
    out.extend(start(found));
    let bodies = std::iter::once(("the case's own body", &found.nominal));
    let scenarios = found.scenarios.iter().flatten().map(|(name, one)| (name.as_str(), one));
    let all: Vec<(&str, &GainsLoopRecord)> = bodies.chain(scenarios).collect();
    out.extend(all.iter().map(|(name, one)| convergence(name, one)));
    if all.iter().any(|(_, one)| one.contraction.is_none_or(|value| value >= 1.0)) {
        out.push(match damped {
            Some(damping) => format!("with \"gains\": {{ \"damping\": {} }} the law converges from nearby on every body", short(damping)),
            None => "no damping makes the law converge on every body: there the outputs answer the controls in another direction; take a start nearer to that body, or other outputs".to_owned(),
        });
    }
    out
}

/// Outputs that no control moves.
fn still(found: &GainsRecord) -> Vec<String> {
    let is_still = |one: &&GainsOutputRecord| one.sensitivities.iter().all(|value| **value == Some(0.0));
    let names = |all: &[GainsOutputRecord]| -> Vec<String> {
        all.iter().filter(is_still).map(|one| one.name.clone()).collect()
    };
    let (followed, watched) = (names(&found.outputs), found.watched.as_deref().map(names).unwrap_or_default());
    let say = |names: &[String], hint: &str| {
        (!names.is_empty()).then(|| format!("no control moves {}{hint}", names.join(", ")))
    };
    let hint = ": an error there stays; leave its target out, or add a control that moves it";
    say(&followed, hint).into_iter().chain(say(&watched, "")).collect()
}

/// Combinations of several outputs that no control moves.
fn combinations(found: &GainsRecord) -> Vec<String> {
    let named = |direction: &Vec<Number>| {
        let mut parts: Vec<(&str, f64)> = found
            .outputs
            .iter()
            .zip(direction)
            .filter_map(|(one, part)| Some((one.name.as_str(), (**part)?)))
            .collect();
        parts.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
        parts.retain(|(_, part)| part.abs() >= NAMED);
        parts
    };
    let all: Vec<_> = found.unmoved.iter().flatten().map(named).filter(|parts| parts.len() > 1).collect();
    let say = |parts: &Vec<(&str, f64)>| {
        let more = if parts.len() > MOST_NAMED { " and more" } else { "" };
        let terms = parts.iter().take(MOST_NAMED).map(|(name, part)| format!("{} {name}", short(round(*part))));
        format!(
            "no control moves the combination {}{more} (each times the root of its weight): an error along it stays",
            terms.collect::<Vec<_>>().join(" + ")
        )
    };
    let mut out: Vec<String> = all.iter().take(MOST_NAMED).map(say).collect();
    if all.len() > MOST_NAMED {
        out.push(format!("{} more stand in \"unmoved\"", count(all.len() - MOST_NAMED, "combination")));
    }
    out
}

/// Whether the law begins at its own rest.
fn start(found: &GainsRecord) -> Option<String> {
    let part = |(control, row): (&GainsControlRecord, &Vec<Number>)| {
        let step: f64 =
            row.iter().zip(&found.nominal.open).filter_map(|(gain, error)| Some((**gain)? * (**error)?)).sum();
        // towards a bound on which it is nothing moves
        let presses = |bound: &Number, beyond: bool| beyond && **bound == *control.value && bound.is_some();
        let stays = presses(&control.lower, step > 0.0) || presses(&control.upper, step < 0.0);
        Some(if stays { 0.0 } else { (step / (*control.scale)?).abs() })
    };
    let most = found.controls.iter().zip(&found.gain).filter_map(part).fold(0.0, f64::max);
    (most > MOVED).then(|| {
        format!(
            "the start is not the optimum of the case's own body: a step moves a control by {} % of its scale; S and L hold near the start, so optimise first and begin there",
            short(round(100.0 * most))
        )
    })
}

/// How the law does on a body.
fn convergence(name: &str, one: &GainsLoopRecord) -> String {
    let rate = match *one.contraction {
        Some(value) if value < 1.0 => format!(
            "{name}: the error shrinks to {} of itself per step near the start, the law converges",
            share(value)
        ),
        Some(value) => format!(
            "{name}: the error grows to {} of itself per step near the start, the law DIVERGES",
            short(round(value))
        ),
        None => format!("{name}: by how much the error shrinks per step is not known"),
    };
    let ends = (one.errors.first().and_then(|value| **value), one.errors.last().and_then(|value| **value));
    let (Some(open), Some(closed)) = ends else { return rate };
    let many = one.errors.len() - 1;
    let before = many.checked_sub(1).and_then(|k| *one.errors[k]);
    let steps = count(many, "step");
    if let Some(why) = &one.failed {
        return format!("{rate}; the loop ended after {steps}: {why}");
    }
    if open == 0.0 {
        return rate;
    }
    let end = match *one.contraction_at_end {
        _ if one.on_bounds > 0 => String::new(),
        Some(value) if value < 1.0 => format!("; there it shrinks to {} of itself per step", share(value)),
        Some(value) => format!("; there it GROWS to {} of itself per step", short(round(value))),
        None => String::new(),
    };
    let leave = if many == 1 { "leaves" } else { "leave" };
    let left = format!("{rate}; {steps} {leave} {} % of the error in open loop", short(round(100.0 * closed / open)));
    let rest = one.unreachable.unwrap_or(0.0);
    let bounds = match one.on_bounds {
        0 => String::new(),
        bounds => format!(", with {} on a bound", count(bounds, "control")),
    };
    let why = if rest > CLOSED * open && (closed - rest).abs() < 0.5 * rest {
        ", which no controls reach"
    } else if closed > (1.0 + AT_REST) * open {
        ": more than before, S changes on the way; begin nearer to the optimum, or take more damping"
    } else if closed > (1.0 - AT_REST) * open {
        ": the law has nothing to mend there"
    } else if one.on_bounds == 0
        && closed > CLOSED * open
        && before.is_some_and(|before| closed > (1.0 - AT_REST) * before)
    {
        ", and the error falls no more"
    } else {
        ""
    };
    format!("{left}{why}{bounds}{end}")
}

/// A share below 1 whose distance from 1 is seen.
fn share(value: f64) -> String {
    if value > 0.9 { short(1.0 - round(1.0 - value)) } else { short(round(value)) }
}

/// Two digits.
fn round(value: f64) -> f64 {
    format!("{value:.1e}").parse().unwrap_or(value)
}
