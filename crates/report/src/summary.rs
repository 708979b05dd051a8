//! The head of the page: what deserves attention, and the result in words.

use crate::html::{escape, paragraph, section, tiles};
use crate::number::{count, duration, millimetres, number, short};
use crate::tables::measure;
use serde_json::Value;

/// What went wrong, then warnings, each with what to try; nothing where all is well.
pub(crate) fn warnings(result: &Value) -> String {
    let mut items = String::new();
    let mut item = |class: &str, code: &str, message: &str, advice: &str| {
        let advice = if advice.is_empty() { String::new() } else { format!("<em>{}</em>", escape(advice)) };
        items += &format!("<li class=\"{class}\"><b>{}</b> {}{advice}</li>\n", escape(code), escape(message));
    };
    if let Some(error) = result["error"].as_str() {
        item("error", "failed", error, "");
    }
    for miss in result["expect"]["missed"].as_array().into_iter().flatten() {
        let message = format!("{}: found {}, expected {}", text(&miss["path"]), miss["found"], miss["expected"]);
        item("error", "expectation missed", &message, "");
    }
    let verdict = text(&result["gradient_check"]["verdict"]);
    if verdict == "wrong" {
        let message = "the derivative does not belong to the cost at the start: see the gradient certificate";
        item("error", "gradient", message, "nastic gradcheck shows which term is at fault");
    }
    for warning in result["warnings"].as_array().into_iter().flatten() {
        let place = text(&warning["place"]);
        let place = if place.is_empty() { String::new() } else { format!("{place}: ") };
        let message = format!("{place}{}", text(&warning["message"]));
        item("warning", text(&warning["code"]), &message, text(&warning["try"]));
    }
    if items.is_empty() {
        return String::new();
    }
    section("warnings", "Attention", &format!("<ul class=\"warnings\">\n{items}</ul>\n"))
}

/// The result in words, and its main figures.
pub(crate) fn summary(result: &Value) -> String {
    let mut content = paragraph(&sentence(result));
    content += &tiles(&figures(result));
    section("summary", "Summary", &content)
}

fn sentence(result: &Value) -> String {
    let time = result["seconds"]["total"].as_f64().map(duration);
    let threads = result["threads"].as_u64().map_or_else(String::new, |n| format!(" on {}", count(n, "thread")));
    let took = time.map_or_else(String::new, |time| format!(" It took {time}{threads}."));
    if result["command"] == "optimize" {
        let Some(stop) = result["stop"].as_str() else {
            return format!("The optimisation did not reach a result.{took}");
        };
        let iterations = count(result["iterations"].as_u64().unwrap_or(0), "iteration");
        let trials = count(result["trials"].as_u64().unwrap_or(0), "trial");
        let failed = result["failed_solves"].as_u64().filter(|n| *n > 0);
        let failed = failed.map_or_else(String::new, |n| format!(" ({n} without an equilibrium)"));
        return format!("The optimisation ended after {iterations} and {trials}{failed}; {stop}.{took}");
    }
    if result["error"].is_string() {
        return format!("The run did not reach a result.{took}");
    }
    if result["command"] == "modes" {
        let about = result["modes"]["about"].as_str().map_or_else(String::new, |about| format!(" about the {about}"));
        return format!("The modes of small vibrations{about} were found.{took}");
    }
    let newton = result["newton_iterations"].as_u64();
    let work = newton.map_or_else(String::new, |n| format!(" with {}", count(n, "Newton iteration")));
    let several = result["ramp"].is_object() || result["path"].is_object() || result["equilibria"].is_object();
    let what = match several {
        true => "Equilibria were found",
        false if result["time"].is_object() => "The motion was computed",
        false => "The equilibrium was found",
    };
    format!("{what}{work}.{took}")
}

/// Name, value and remark of what a reader looks for first.
fn figures(result: &Value) -> Vec<(String, String, String)> {
    let length = text(&result["units"]["length"]);
    let mut out = Vec::new();
    let mut add = |name: &str, value: String, remark: String| out.push((name.to_owned(), value, remark));
    if result["cost"]["total"].is_number() {
        let name = match text(&result["risk"]["measure"]) {
            "" => "Cost".to_owned(),
            name => {
                let level = &result["risk"]["measures"][name]["level"];
                format!("Cost ({} over scenarios)", measure(name, level))
            }
        };
        add(&name, number(&result["cost"]["total"], ""), from(&result["start"]["cost"]["total"], ""));
    }
    if let Some(deviation) = result["risk"]["deviation"].as_f64() {
        let before = result["start"]["risk"]["deviation"].as_f64();
        let before = before.map_or_else(String::new, |x| format!("at the start {}", short(x)));
        add("Standard deviation of the cost", short(deviation), before);
    }
    for (name, group) in result["constraints"]["groups"].as_object().into_iter().flatten() {
        let share = group["violation"].as_f64().zip(group["scale"].as_f64()).map_or(f64::NAN, |(v, scale)| v / scale);
        let remark = format!("{} of its scale; {} of {} active", short(share), group["active"], group["count"]);
        add(&format!("Largest violation, {name}"), number(&group["violation"], text(&group["unit"])), remark);
    }
    for (suffix, own, begin) in members(result) {
        let (own_h, begin_h) = (&own["hausdorff"], &begin["hausdorff"]);
        if let Some(distance) = own_h["true"].as_f64() {
            let name = format!("True Hausdorff distance{suffix}");
            add(&name, millimetres(distance, length), from_length(&begin_h["true"], length));
        }
        if let (Some(smoothed), Some(floor)) = (own_h["smoothed"].as_f64(), own_h["self"].as_f64()) {
            let begin =
                begin_h["smoothed"].as_f64().map(|x| Value::from(x - begin_h["self"].as_f64().unwrap_or(floor)));
            let name = format!("Smoothed distance minus its floor{suffix}");
            let before = from_length(&begin.unwrap_or_default(), length);
            add(&name, millimetres(smoothed - floor, length), before);
        }
        for (term, tracked) in own["tracking"].as_object().into_iter().flatten() {
            let (rms, largest) = (&tracked["root_mean_square"], &tracked["largest"]);
            let begin = &begin["tracking"][term];
            let in_mm = |value: &Value| value.as_f64().map_or_else(|| "–".to_owned(), |x| millimetres(x, length));
            let before = from_length(&begin["root_mean_square"], length);
            add(&format!("Distance from target, root mean square{suffix}"), in_mm(rms), before);
            let before = from_length(&begin["largest"], length);
            add(&format!("Distance from target, largest{suffix}"), in_mm(largest), before);
        }
    }
    if result["min_J"].is_number() {
        add("Smallest volume ratio J", number(&result["min_J"], ""), "1 is undeformed, 0 is inverted".to_owned());
    }
    // states of a motion are no equilibria
    if result.get("inertia").is_some() && !result["time"].is_object() {
        let (value, remark) = stability(result);
        add("Stability", value.to_owned(), remark);
    }
    out
}

/// The plain result, or its load cases: what a figure is of, its entries now and at the start. Figures of single
/// scenarios stand in their own table.
fn members(result: &Value) -> Vec<(String, &Value, &Value)> {
    match result["load_cases"].as_object() {
        Some(cases) => {
            let of = |(name, entry)| {
                let name: &String = name;
                (format!(", {name}"), entry, &result["start"]["load_cases"][name])
            };
            cases.iter().map(of).collect()
        }
        None => vec![(String::new(), result, &result["start"])],
    }
}

/// What the inertia means.
pub(crate) fn stability(result: &Value) -> (&'static str, String) {
    match result["inertia"].as_u64() {
        Some(0) => ("stable", "no negative pivot of the tangent".to_owned()),
        Some(n) => ("UNSTABLE", format!("{} of the tangent", count(n, "negative pivot"))),
        None if result["inertia_missing"]["singular"] == true => ("undecided", "the tangent is singular".to_owned()),
        None => ("undecided", "negative pivots of the tangent were not counted".to_owned()),
    }
}

fn from(start: &Value, unit: &str) -> String {
    if start.is_number() { format!("at the start {}", number(start, unit)) } else { String::new() }
}

fn from_length(start: &Value, unit: &str) -> String {
    start.as_f64().map_or_else(String::new, |x| format!("at the start {}", millimetres(x, unit)))
}

fn text(value: &Value) -> &str {
    value.as_str().unwrap_or_default()
}
