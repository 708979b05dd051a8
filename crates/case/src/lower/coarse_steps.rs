//! Values that change within a time step: what a motion sees of them are the instants alone.

use super::context::Context;
use crate::warning::TIME_STEP;
use nastic_language::expression::Formula;
use nastic_language::number::short;
use nastic_language::syntax::At;

/// Share of the range of a value that its course within a step may depart from a straight line.
const DEPARTURE: f64 = 0.25;
/// Steps in which it does so: one or two are a jump.
const STEPS: usize = 3;
/// Where in a step it is looked at.
const WITHIN: [f64; 3] = [0.25, 0.5, 0.75];

/// Points of a field at which it is looked at, over all of them.
const POINTS: usize = 20;

/// Warns of a value given in time that steps do not resolve, at the places of the points of a field, or one.
pub(super) fn check(instants: &[f64], formula: &Formula, places: &[[f64; 3]], at: &At, context: &mut Context<'_>) {
    let places: Vec<[f64; 3]> = places.iter().step_by(places.len().div_ceil(POINTS).max(1)).copied().collect();
    let values = |t: f64| {
        let formula = formula.at_time(t);
        places.iter().map(|place| formula.at(*place).ok()).collect::<Option<Vec<f64>>>()
    };
    let Some(each) = instants.iter().map(|t| values(*t)).collect::<Option<Vec<_>>>() else { return };
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    let mut widen = |value: f64| (low, high) = (low.min(value), high.max(value));
    each.iter().flatten().for_each(|value| widen(*value));
    let mut departures = Vec::new();
    for (n, step) in instants.windows(2).enumerate() {
        let mut largest = 0.0f64;
        for s in WITHIN {
            let Some(seen) = values(step[0] + s * (step[1] - step[0])) else { return };
            for (value, (a, b)) in seen.iter().zip(each[n].iter().zip(&each[n + 1])) {
                widen(*value);
                largest = largest.max((value - (a + s * (b - a))).abs());
            }
        }
        departures.push(largest);
    }
    let coarse = |departure: &&f64| **departure > DEPARTURE * (high - low);
    let count = departures.iter().filter(coarse).count();
    if count < STEPS {
        return;
    }
    let first = departures.iter().position(|departure| coarse(&departure)).unwrap_or_default();
    let unit = context.units.time().symbol;
    let message = format!(
        "it changes within time steps: in {count} of {} its course departs from a straight line by more than a quarter of its \
         range, first between t = {} and {} {unit}; the motion sees the instants alone",
        departures.len(),
        short(instants[first]),
        short(instants[first + 1])
    );
    context.warn(&TIME_STEP, at, message);
}
