//! What a fit says on the terminal.

use crate::console::Console;
use crate::run::fit::entry::{Fitted, Stable, fibers_name, scatter_unit};
use nastic_fit::{Coverage, End, Errors, Estimate, Fibers, FitError, Law, Starts, Test};
use nastic_language::number::short;
use nastic_language::schema::FitData;

/// Correlations beyond which two parameters are hardly distinguished.
const ALIKE: f64 = 0.99;
/// Angles of two families to the axis of the fibres, in degrees, above which that axis is hardly meant.
const NEARLY_ACROSS: f64 = 80.0;

pub(super) fn introduce(asked: &FitData, tests: &[Test], console: &Console) {
    if let Some(title) = &asked.title {
        console.say(format!("fit         {title}"));
    }
    for (test, own) in tests.iter().zip(&asked.tests) {
        let ends = test.points.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], [x, _]| [a.min(*x), b.max(*x)]);
        let (kind, what) = (test.mode.name(), test.response.name().trim_start_matches("a "));
        let weight = if test.weight == 1.0 { String::new() } else { format!(", weight {}", short(test.weight)) };
        let fibers = test.fibers.map_or(String::new(), |fibers| format!(" {} the fibres", fibers_name(fibers)));
        let rest = match test.at_rest() {
            0 => String::new(),
            some => format!(" ({some} at rest left out)"),
        };
        console.say(format!(
            "test        {}: {kind}{fibers}, {what}, {} points{rest}, {} {} to {}{weight}{}",
            test.name,
            test.points.len(),
            test.mode.deformation(),
            short(ends[0]),
            short(ends[1]),
            if own.held_out { ", held out" } else { "" }
        ));
    }
}

pub(super) fn found(fitted: &[Fitted], tests: &[Test], failed: &[(Law, FitError)], errors: Errors, console: &Console) {
    let Some(best) = fitted.first() else { return };
    let scatter = format!("scatter, {}", scatter_unit(errors));
    if best.fit.criteria.aicc == f64::INFINITY {
        console.say("laws        by BIC: AICc decides nothing, for no law of k parameters has more than k + 2 points");
    } else {
        console.say("laws        by AICc: the first is best; 10 more are decisive");
    }
    console.say(format!("            law                   parameters {scatter:>11}      AICc   above best       BIC"));
    for one in fitted {
        let criteria = &one.fit.criteria;
        console.say(format!(
            "            {:<25} {:>6} {:>11.4e} {:>9} {:>12} {:>9}",
            one.fit.law.label(),
            one.fit.parameters.len(),
            one.fit.scatter,
            tenths(criteria.aicc),
            tenths(criteria.aicc - best.fit.criteria.aicc),
            tenths(criteria.bic)
        ));
    }
    for (law, error) in failed {
        console.say(format!("            {:<25} {error}", law.label()));
    }
    for one in fitted {
        console.say(format!("{:<11} {}", "law", one.fit.law.label()));
        match one.network_file() {
            Some((name, _)) => console.say(format!("            {} numbers: {name}", one.fit.parameters.len())),
            None => one.fit.parameters.iter().for_each(|own| console.say(format!("            {}", estimate(own)))),
        }
        remarks(one, tests).into_iter().for_each(|remark| console.say(format!("            {remark}")));
    }
    let mut block = best.materials();
    if let Some((name, _)) = best.network_file() {
        block[0]["network"] = name.into();
    }
    let block = serde_json::to_string(&block).unwrap_or_default();
    console.say(format!("to paste    \"materials\": {block}"));
    console.say("            with its uncertainty: \"materials\" and \"scenarios\" of each law in fit.json");
}

/// A criterion, where there is one.
fn tenths(value: f64) -> String {
    if value.is_finite() { format!("{value:.1}") } else { "-".to_owned() }
}

/// `c10 = 172.3 kPa +- 5 kPa`.
fn estimate(one: &Estimate) -> String {
    let unit = match one.unit {
        "1" => String::new(),
        unit => format!(" {unit}"),
    };
    let interval = match one.half_width {
        Some(half) => format!(" +- {}{unit} (95 %)", short(half)),
        None => " (no interval: on the border of what the law admits, or not determined by the data)".to_owned(),
    };
    format!("{} = {}{unit}{interval}", one.name, short(one.value))
}

/// Stability, existence, parameters that move together, starts that differ.
fn remarks(one: &Fitted, tests: &[Test]) -> Vec<String> {
    let shares = one.r_squared.iter().map(|(name, share)| format!("{name} {share:.4}"));
    let mut out = vec![format!("R^2: {}", shares.collect::<Vec<_>>().join(", "))];
    if one.fit.law.is_network() {
        let seen = Coverage::of(tests);
        let warning = if seen.missing.is_empty() { "" } else { "WARNING: " };
        out.push(format!("{warning}{seen}"));
    }
    let before = out.len();
    out.extend(one.stable.iter().flat_map(|stable| ends(stable, &one.fit.law.label())));
    if out.len() == before
        && let Some(Stable { range, .. }) = one.stable.first()
    {
        out.push(format!("stable (Drucker) in all tests, stretches {} to {}", short(range.from), short(range.to)));
    }
    let lies = |fibers: Fibers| tests.iter().any(|test| test.fibers == Some(fibers));
    if one.fit.law.has_fibers() && lies(Fibers::Along) != lies(Fibers::Across) {
        let missing = fibers_name(if lies(Fibers::Along) { Fibers::Across } else { Fibers::Along });
        out.push(format!("no test {missing} the fibres: the data hardly tell fibres from matrix"));
    }
    let angle = one.fit.parameters.iter().find(|parameter| parameter.name == "fiber_angle");
    if angle.is_some_and(|angle| angle.value > NEARLY_ACROSS) {
        out.push("both families lie nearly across: are \"along\" and \"across\" exchanged?".to_owned());
    }
    let numbers = if one.fit.law.is_network() { &[] } else { one.fit.parameters.as_slice() };
    for parameter in numbers.iter().filter(|parameter| parameter.at_least) {
        out.push(format!(
            "{} is the least that the law admits: the data ask for less, which is excluded",
            parameter.name
        ));
    }
    if let Some(poisson) = one.poisson().filter(|ratio| *ratio < 0.0) {
        out.push(format!(
            "WARNING: the bulk modulus, {} Pa, is below 2/3 of the shear modulus, {} Pa: Poisson's ratio is negative, {}",
            short(one.bulk.value),
            short(one.shear),
            short(poisson)
        ));
    }
    if let Some(existence) = one.existence {
        let polyconvex = if existence.polyconvex { "polyconvex" } else { "not known to be polyconvex" };
        let coercive = if existence.growth.is_coercive() { "coercive" } else { "not coercive" };
        out.push(format!("{polyconvex}, {coercive}"));
    }
    let names = one.fit.law.parameters();
    for (i, row) in one.fit.correlation.iter().enumerate() {
        for (j, value) in row.iter().enumerate().take(if numbers.is_empty() { 0 } else { i }) {
            if let Some(value) = value.filter(|value| value.abs() > ALIKE) {
                out.push(format!("{} and {} are hardly told apart: correlation {value:.3}", names[j], names[i]));
            }
        }
    }
    let Starts { tried, converged, exhausted, alike, best_exhausted } = one.fit.starts;
    if tried > 1 {
        let spent = if exhausted > 0 { format!(", {exhausted} ran out of evaluations") } else { String::new() };
        out.push(format!("{tried} starts: {converged} converged{spent}, {alike} led here"));
    }
    if best_exhausted {
        out.push("the best start ran out of evaluations: its parameters may not be those of least squares".to_owned());
    }
    if tried > 3 && alike < 3 {
        out.push(format!("only {alike} of {tried} starts led here: try more (\"starts\")"));
    }
    out
}

/// Where stability ends, below and above, and why.
fn ends(stable: &Stable, law: &str) -> Vec<String> {
    let Stable { mode, fibers, range, within } = stable;
    let of = |end: End, side: &str, at: f64, within: bool| {
        let shown = if within { ": WITHIN THE DATA" } else { "" };
        let lies = fibers.map_or(String::new(), |fibers| format!(" {} the fibres", fibers_name(fibers)));
        let (kind, at) = (format!("{} tests{lies}", mode.name()), short(at));
        match end {
            End::Examined => None,
            End::Unstable => Some(format!("unstable (Drucker) in {kind} {side} stretch {at}{shown}")),
            End::Undefined => {
                Some(format!("stable in {kind} up to the limit of {law}: none {side} stretch {at}{shown}"))
            }
        }
    };
    let both = [of(range.ends[0], "below", range.from, within[0]), of(range.ends[1], "above", range.to, within[1])];
    both.into_iter().flatten().collect()
}
