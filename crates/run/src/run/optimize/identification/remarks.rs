//! What deserves attention in an identification, in sentences.

use super::parameters::Parameter;
use nastic_language::number::short;
use nastic_opt::{Covariance, Determined};
use nastic_report::record::{ByName, ShotRecord};

/// A direction that is uncertain by more than this share is weak.
const WEAK: f64 = 0.2;
/// Sums of squares per degree of freedom beyond which the model does not meet the readings, or meets them better than they are said to be.
const ABOVE: f64 = 2.0;
const BELOW: f64 = 0.2;
/// Readings beyond the parameters that a ratio below 1 says something with: with fewer it is often small by chance.
const LEAST_FREEDOM: usize = 5;
/// A share of a prior's deviation above which readings say little.
const MOST_LEFT: f64 = 0.9;
/// A component of a direction that is worth a word.
const NAMED: f64 = 0.2;
/// Two components that are as large as each other.
const ALIKE: f64 = 1e-2;
/// Parameters of a direction that are named.
const MOST_NAMED: usize = 4;

pub(super) fn of(
    parameters: &[Parameter],
    covariance: &Covariance,
    shots: &ByName<ShotRecord>,
    (per_freedom, freedom): (Option<f64>, usize),
) -> Vec<String> {
    let mut out: Vec<String> = per_freedom.and_then(|ratio| fit(ratio, freedom, shots)).into_iter().collect();
    let is_weak = |one: &&Determined| one.deviation.is_none_or(|deviation| deviation > WEAK);
    out.extend(covariance.directions.iter().filter(is_weak).map(|one| direction(parameters, one)));
    out.extend(parameters.iter().enumerate().filter_map(|(i, one)| by_prior(one, covariance.deviation(i)?)));
    out
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
fn fit(ratio: f64, freedom: usize, shots: &ByName<ShotRecord>) -> Option<String> {
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
