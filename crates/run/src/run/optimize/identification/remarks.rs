//! What deserves attention in an identification, in sentences.

use super::blocks::MOST_SPREAD;
use super::parameters::Parameter;
use nastic_language::number::{count, short};
use nastic_opt::{Covariance, Determined};
use nastic_report::record::{ByName, ShotRecord};

/// A direction that is uncertain by more than this share is weak.
const WEAK: f64 = 0.2;
/// Sums of squares per degree of freedom beyond which the model does not meet the readings, or meets them better than they are said to be.
const ABOVE: f64 = 2.0;
const BELOW: f64 = 0.2;
/// Readings beyond the parameters that a ratio below 1 says something with: with fewer it is often small by chance.
const LEAST_FREEDOM: usize = 5;
/// Deviations that an optimum may be away from the minimum of its quadratic model.
const MOST_AWAY: f64 = 0.1;
/// A share of a prior's deviation above which readings say little.
const MOST_LEFT: f64 = 0.9;
/// A component of a direction that is worth a word.
const NAMED: f64 = 0.2;
/// Two components that are as large as each other.
const ALIKE: f64 = 1e-2;
/// Parameters of a direction that are named.
const MOST_NAMED: usize = 4;

/// How the optimum meets the readings.
pub(super) struct Fit {
    pub per_freedom: Option<f64>,
    pub freedom: usize,
    /// Deviations that it is away from the minimum of its quadratic model.
    pub away: f64,
}

pub(super) fn of(
    parameters: &[Parameter],
    covariance: &Covariance,
    shots: &ByName<ShotRecord>,
    fit: &Fit,
) -> Vec<String> {
    let mut out: Vec<String> = (fit.away > MOST_AWAY).then(|| not_there(fit.away)).into_iter().collect();
    out.extend(fit.per_freedom.and_then(|ratio| met(ratio, fit.freedom, shots)));
    let is_weak = |one: &&Determined| match one.deviation {
        // shares of the prior's deviation are remarked one by one
        Some(deviation) => deviation > WEAK && !is_of_priors(parameters, one),
        None => true,
    };
    out.extend(covariance.directions.iter().filter(is_weak).map(|one| direction(parameters, one)));
    let held: Vec<&str> = parameters
        .iter()
        .enumerate()
        .filter(|(i, one)| !covariance.determined[*i] && one.is_on_bound())
        .map(|(_, one)| one.name.as_str())
        .collect();
    out.extend((!held.is_empty() && held.len() < parameters.len()).then(|| {
        format!(
            "the deviations hold for {} on the bound: where that is no knowledge, they are too small",
            held.join(" and ")
        )
    }));
    let wide = covariance.directions.iter().filter(|one| one.deviation.is_some_and(|own| own > MOST_SPREAD)).count();
    out.extend((wide > 0).then(|| {
        format!("\"scenarios\" leave out {}, which are wider than the linearisation reaches", count(wide, "direction"))
    }));
    out.extend(parameters.iter().enumerate().filter_map(|(i, one)| by_prior(one, covariance.deviation(i)?)));
    out
}

/// Whether the largest part of a direction is of a parameter with a prior.
fn is_of_priors(parameters: &[Parameter], one: &Determined) -> bool {
    let parts = parameters.iter().zip(&one.components);
    parts.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())).is_some_and(|(own, _)| own.prior.is_some())
}

/// That the run ended before the optimum.
fn not_there(away: f64) -> String {
    format!(
        "the optimum is about {} deviations away still: go on with a smaller \"optimizer/tolerance\" or more iterations, from what was found",
        short(round(away))
    )
}

/// That the readings hardly say more than what was known before.
fn by_prior(one: &Parameter, deviation: f64) -> Option<String> {
    let left = deviation / one.prior?[1];
    let message = || {
        let left = short(round(100.0 * left));
        format!("{} is known by its prior: the readings leave {left} % of that deviation", one.name)
    };
    (left > MOST_LEFT).then(message)
}

/// How the model meets the readings.
fn met(ratio: f64, freedom: usize, shots: &ByName<ShotRecord>) -> Option<String> {
    let times = short(round(ratio.sqrt()));
    if ratio > ABOVE {
        let by_reading = |shot: &ShotRecord| shot.squares.unwrap_or(0.0) / shot.readings.max(1) as f64;
        let worst = shots.iter().max_by(|a, b| by_reading(a.1).total_cmp(&by_reading(b.1)));
        let worst = worst.map_or_else(String::new, |(name, _)| format!(", the shot \"{name}\" worst"));
        return Some(format!(
            "the model cannot meet the readings: they are missed by {times} times their deviations{worst}; intervals are that much too narrow if the deviations are what is wrong"
        ));
    }
    (ratio < BELOW && freedom >= LEAST_FREEDOM).then(|| {
        format!("the readings are met to {times} of their deviations: these are too large, and so are the intervals")
    })
}

/// What a weak direction means.
fn direction(parameters: &[Parameter], one: &Determined) -> String {
    let mut parts: Vec<(&Parameter, f64)> = parameters.iter().zip(one.components.iter().copied()).collect();
    parts.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
    parts.retain(|(_, part)| part.abs() >= NAMED);
    let names: Vec<&str> = parts.iter().take(MOST_NAMED).map(|(own, _)| own.name.as_str()).collect();
    let more = if parts.len() > MOST_NAMED { " and others" } else { "" };
    let known = one.deviation.map(|own| format!("{} %", short(round(100.0 * own))));
    match (parts.as_slice(), known) {
        ([_], None) => format!("no reading sees {}: fix it, or add a shot that it moves", names.concat()),
        ([_], Some(known)) => {
            format!("{} is known to {known} only: add a shot that it moves more", names.concat())
        }
        (_, None) => format!(
            "no reading tells {}{more} apart{}: fix one of them, or add a shot or a force that moves one without the other",
            names.join(" and "),
            combination(&parts)
        ),
        (_, Some(known)) => format!(
            "{}{more} are told apart to {known} only: add a shot or a force that moves one without the other",
            names.join(" and ")
        ),
    }
}

/// What is seen of two parameters that change by equal shares.
fn combination(parts: &[(&Parameter, f64)]) -> &'static str {
    let [(first, a), (second, b)] = parts else { return "" };
    let ratio = second.share(b * second.scale) / first.share(a * first.scale);
    match (ratio.abs() - 1.0).abs() < ALIKE {
        true if ratio > 0.0 => ", only their ratio is seen",
        true => ", only their product is seen",
        false => "",
    }
}

/// Two digits.
fn round(value: f64) -> f64 {
    format!("{value:.1e}").parse().unwrap_or(value)
}
