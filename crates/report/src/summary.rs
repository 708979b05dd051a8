//! The head of the page: what deserves attention, and the result in words.

use crate::html::{escape, paragraph, section, tiles};
use crate::number::{count, duration, millimetres, number, short};
use crate::record::{FreeMotionRecord, HausdorffRecord, RunRecord, StateRecord, WarningRecord, number_of};
use crate::tables::measure;

/// What went wrong, then warnings, each with what to try; nothing where all is well.
pub(crate) fn warnings(result: &RunRecord) -> String {
    let mut items = String::new();
    let mut item = |class: &str, code: &str, message: &str, advice: &str| {
        let advice = if advice.is_empty() { String::new() } else { format!("<em>{}</em>", escape(advice)) };
        items += &format!("<li class=\"{class}\"><b>{}</b> {}{advice}</li>\n", escape(code), escape(message));
    };
    if let Some(error) = &result.error {
        item("error", "failed", error, "");
    }
    for miss in result.expect.iter().flat_map(|expect| &expect.missed) {
        let message = format!("{}: found {}, expected {}", miss.path, miss.found, miss.expected);
        item("error", "expectation missed", &message, "");
    }
    if result.gradient_check.verdict.as_deref() == Some("wrong") {
        let message = "the derivative does not belong to the cost at the start: see the gradient certificate";
        item("error", "gradient", message, "nastic gradcheck shows which term is at fault");
    }
    for WarningRecord { code, place, message, advice } in &result.warnings {
        let place = if place.is_empty() { String::new() } else { format!("{place}: ") };
        item("warning", code, &format!("{place}{message}"), advice);
    }
    if items.is_empty() {
        return String::new();
    }
    section("warnings", "Attention", &format!("<ul class=\"warnings\">\n{items}</ul>\n"))
}

/// The result in words, and its main figures.
pub(crate) fn summary(result: &RunRecord) -> String {
    let mut content = paragraph(&sentence(result));
    content += &tiles(&figures(result));
    section("summary", "Summary", &content)
}

fn sentence(result: &RunRecord) -> String {
    let time = number_of(&result.seconds, "total").map(duration);
    let threads = result.threads.map_or_else(String::new, |n| format!(" on {}", count(n, "thread")));
    let took = time.map_or_else(String::new, |time| format!(" It took {time}{threads}."));
    if ["optimize", "identify"].contains(&result.command.as_str()) {
        let Some(stop) = &result.optimum.stop else {
            return format!("The optimisation did not reach a result.{took}");
        };
        let iterations = count(result.optimum.iterations.unwrap_or(0), "iteration");
        let trials = count(result.optimum.trials.unwrap_or(0), "trial");
        let failed = result.optimum.failed_solves.filter(|n| *n > 0);
        let failed = failed.map_or_else(String::new, |n| format!(" ({n} without an equilibrium)"));
        return format!("The optimisation ended after {iterations} and {trials}{failed}; {stop}.{took}");
    }
    if result.error.is_some() {
        return format!("The run did not reach a result.{took}");
    }
    if result.command == "modes" {
        let about = result.modes.about.as_ref().map_or_else(String::new, |about| format!(" about the {about}"));
        return format!("The modes of small vibrations{about} were found.{took}");
    }
    let work = result.newton_iterations.map_or_else(String::new, |n| format!(" with {}", count(n, "Newton iteration")));
    let several = result.ramp.is_some() || result.path.is_some() || result.equilibria.is_some();
    let what = match several {
        true => "Equilibria were found",
        false if result.time.is_some() => "The motion was computed",
        false => "The equilibrium was found",
    };
    format!("{what}{work}.{took}")
}

/// Name, value and remark of what a reader looks for first.
fn figures(result: &RunRecord) -> Vec<(String, String, String)> {
    let length = &result.units.length;
    let mut out = Vec::new();
    let mut add = |name: &str, value: String, remark: String| out.push((name.to_owned(), value, remark));
    if result.cost.total.is_some() {
        let name = match result.risk.measure.as_str() {
            "" => "Cost".to_owned(),
            name => {
                let level = result.risk.measures.as_ref().and_then(|all| all.get(name)?.level);
                format!("Cost ({} over scenarios)", measure(name, level))
            }
        };
        let before = |x: Option<f64>| x.map_or_else(String::new, |x| format!("at the start {}", short(x)));
        match result.risk.unsmoothed() {
            Some(exact) => {
                let smoothed = format!("smoothed, as it is optimised, {}", number(result.cost.total, ""));
                let before = before(result.start.risk.unsmoothed());
                let remarks: Vec<String> = [before, smoothed].into_iter().filter(|remark| !remark.is_empty()).collect();
                add(&name, short(exact), remarks.join("; "));
            }
            None => add(&name, number(result.cost.total, ""), before(*result.start.cost.total)),
        }
    }
    if let Some(deviation) = *result.risk.deviation {
        let before = result.start.risk.deviation.map_or_else(String::new, |x| format!("at the start {}", short(x)));
        add("Standard deviation of the cost", short(deviation), before);
    }
    for (name, group) in &result.optimum.constraints.groups {
        let share = group.violation.zip(*group.scale).map_or(f64::NAN, |(v, scale)| v / scale);
        let remark = format!("{} of its scale; {} of {} active", short(share), group.active, group.count);
        let unit = group.unit.as_deref().unwrap_or_default();
        add(&format!("Largest violation, {name}"), number(group.violation, unit), remark);
    }
    for (suffix, own, begin) in members(result) {
        let distances =
            |state: &StateRecord| state.hausdorff.as_ref().map(HausdorffRecord::distances).unwrap_or_default();
        let [smoothed, exact, floor] = distances(own);
        let [smoothed_before, exact_before, floor_before] = begin.map(distances).unwrap_or_default();
        if let Some(distance) = exact {
            let name = format!("True Hausdorff distance{suffix}");
            add(&name, millimetres(distance, length), from_length(exact_before, length));
        }
        if let (Some(smoothed), Some(floor)) = (smoothed, floor) {
            let begin = smoothed_before.map(|x| x - floor_before.unwrap_or(floor));
            let name = format!("Smoothed distance minus its floor{suffix}");
            add(&name, millimetres(smoothed - floor, length), from_length(begin, length));
        }
        for (term, tracked) in &own.tracking {
            let begin = begin.and_then(|begin| begin.tracking.get(term));
            for (key, name) in [("root_mean_square", "root mean square"), ("largest", "largest")] {
                let now = number_of(tracked, key).map_or_else(|| "–".to_owned(), |x| millimetres(x, length));
                let before = from_length(begin.and_then(|begin| number_of(begin, key)), length);
                add(&format!("Distance from target, {name}{suffix}"), now, before);
            }
        }
    }
    for (suffix, own, begin) in members(result) {
        for (term, figures) in &own.figures {
            for (key, of_motion) in [
                ("position_distance", " at the end"),
                ("position_distance_largest", ", largest"),
                ("position_distance_root_mean_square", ", root mean square"),
            ] {
                let Some(distance) = number_of(figures, key) else { continue };
                let begin = begin.and_then(|begin| number_of(begin.figures.get(term)?, key));
                let moves = figures.contains_key("position_distance_largest");
                let name = format!("Distance of {term} from its target{}{suffix}", if moves { of_motion } else { "" });
                add(&name, millimetres(distance, length), from_length(begin, length));
            }
        }
    }
    if result.min_j.is_some() {
        add("Smallest volume ratio J", number(result.min_j, ""), "1 is undeformed, 0 is inverted".to_owned());
    }
    // states of a motion are no equilibria
    if result.inertia.is_stated() && result.time.is_none() {
        let (value, remark) = stability(result);
        add("Stability", value.to_owned(), remark);
    }
    out
}

/// The plain result, or its load cases: what a figure is of, its entries now and at the start. Figures of single
/// scenarios stand in their own table.
fn members(result: &RunRecord) -> Vec<(String, &StateRecord, Option<&StateRecord>)> {
    if result.load_cases.is_empty() {
        return vec![(String::new(), &result.state, Some(&result.start))];
    }
    let cases = result.load_cases.iter();
    cases.map(|(name, entry)| (format!(", {name}"), entry, result.start.load_cases.get(name))).collect()
}

/// What the inertia means.
pub(crate) fn stability(state: &StateRecord) -> (&'static str, String) {
    let singular = state.inertia_missing.as_ref().is_some_and(|missing| missing.singular);
    match *state.inertia {
        Some(0) if state.free_motion.is_some() => {
            ("neutral", state.free_motion.as_ref().map_or_else(String::new, FreeMotionRecord::words))
        }
        Some(0) => ("stable", state.no_negative().to_owned()),
        Some(n) => ("UNSTABLE", format!("{} of the tangent", count(n, "negative pivot"))),
        None if singular => ("undecided", "the tangent is singular".to_owned()),
        None => ("undecided", "negative pivots of the tangent were not counted".to_owned()),
    }
}

fn from_length(start: Option<f64>, unit: &str) -> String {
    start.map_or_else(String::new, |x| format!("at the start {}", millimetres(x, unit)))
}
