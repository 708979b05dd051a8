//! What a fit says on the terminal.

use super::entry::Fitted;
use crate::console::Console;
use crate::run::number::short;
use crate::schema::FitData;
use nastic_fit::{Estimate, FitError, Law, Mode, Test};

/// Correlations beyond which two parameters are hardly told apart.
const ALIKE: f64 = 0.99;

pub(super) fn introduce(asked: &FitData, tests: &[Test], console: &Console) {
    if let Some(title) = &asked.title {
        console.say(format!("fit         {title}"));
    }
    for test in tests {
        let ends = test.points.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], [x, _]| [a.min(*x), b.max(*x)]);
        let (kind, what) = (test.mode.name(), test.response.name().trim_start_matches("a "));
        let weight = if test.weight == 1.0 { String::new() } else { format!(", weight {}", short(test.weight)) };
        console.say(format!(
            "test        {}: {kind}, {what}, {} points, {} {} to {}{weight}",
            test.name,
            test.points.len(),
            test.mode.deformation(),
            short(ends[0]),
            short(ends[1])
        ));
    }
}

pub(super) fn found(fitted: &[Fitted], failed: &[(Law, FitError)], console: &Console) {
    let Some(best) = fitted.first() else { return };
    console.say("laws        by AICc: the first is best; 10 more are decisive");
    console.say("            law                   parameters     scatter      AICc   above best       BIC");
    for one in fitted {
        let above = one.fit.criteria.aicc - best.fit.criteria.aicc;
        console.say(format!(
            "            {:<20} {:>11} {:>11.4e} {:>9.1} {above:>12.1} {:>9.1}",
            one.fit.law.label(),
            one.fit.parameters.len(),
            one.fit.scatter,
            one.fit.criteria.aicc,
            one.fit.criteria.bic
        ));
    }
    for (law, error) in failed {
        console.say(format!("            {:<20} {error}", law.label()));
    }
    for one in fitted {
        console.say(format!("{:<11} {}", "law", one.fit.law.label()));
        one.fit.parameters.iter().for_each(|parameter| console.say(format!("            {}", estimate(parameter))));
        remarks(one).into_iter().for_each(|remark| console.say(format!("            {remark}")));
    }
    let block = serde_json::to_string(&best.materials()).unwrap_or_default();
    console.say(format!("to paste    \"materials\": {block}"));
    console.say("            with its uncertainty: \"materials\" and \"scenarios\" of each law in fit.json");
}

/// `c10 = 172.3 kPa +- 5 kPa`.
fn estimate(one: &Estimate) -> String {
    let unit = if Law::is_pressure(one.name) { " Pa" } else { "" };
    let interval = match one.half_width {
        Some(half) => format!(" +- {}{unit} (95 %)", short(half)),
        None => " (no interval: on the border of what the law admits, or not determined by the data)".to_owned(),
    };
    format!("{} = {}{unit}{interval}", one.name, short(one.value))
}

/// Stability, existence, parameters that move together, starts that differ.
fn remarks(one: &Fitted) -> Vec<String> {
    let mut out = Vec::new();
    for (mode, range) in &one.stable {
        let limits = [(range.ends[0], range.from), (range.ends[1], range.to)];
        let limits: Vec<String> = limits.iter().filter(|(ends, _)| *ends).map(|(_, at)| short(*at)).collect();
        if !limits.is_empty() {
            let within = range.ends[1] && range.to < one.measured && *mode == Mode::Uniaxial;
            let told = if within { ": WITHIN THE DATA" } else { "" };
            out.push(format!(
                "unstable (Drucker) in {} tests beyond stretch {}{told}",
                mode.name(),
                limits.join(" and ")
            ));
        }
    }
    if one.stable.iter().all(|(_, range)| range.ends == [false, false])
        && let Some((_, range)) = one.stable.first()
    {
        out.push(format!("stable (Drucker) in all tests, stretches {} to {}", short(range.from), short(range.to)));
    }
    if let Some(existence) = one.existence {
        let polyconvex = if existence.polyconvex { "polyconvex" } else { "not known to be polyconvex" };
        let coercive = if existence.growth.is_coercive() { "coercive" } else { "not coercive" };
        out.push(format!("{polyconvex}, {coercive}"));
    }
    let names = one.fit.law.parameters();
    for (i, row) in one.fit.correlation.iter().enumerate() {
        for (j, value) in row.iter().enumerate().take(i) {
            if let Some(value) = value.filter(|value| value.abs() > ALIKE) {
                out.push(format!("{} and {} are hardly told apart: correlation {value:.3}", names[j], names[i]));
            }
        }
    }
    let [tried, _, alike] = one.fit.starts;
    if tried > 3 && alike < 3 {
        out.push(format!("only {alike} of {tried} starts led here: try more (\"starts\")"));
    }
    out
}
