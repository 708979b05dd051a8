//! Fields, densities and accelerations that no matter has, mostly because a unit is not the one meant.

use super::context::Context;
use crate::lower::control_field::{Admitted, ControlField};
use crate::warning::UNITS;
use nastic_language::number::short;
use nastic_language::quantity::Dimension;
use nastic_language::schema::Case;
use nastic_language::syntax::At;
use std::ops::RangeInclusive;

/// Factors between units that are mistaken for each other, the likeliest first.
const FACTORS: [f64; 8] = [1e3, 1e-3, 1e6, 1e-6, 1e9, 1e-9, 1e12, 1e-12];

/// `: 1070 kg/m^3 would be usual, is a factor of 1000 missing?`, of a value in a unit that is not among usual ones.
pub(super) fn likely(value: f64, usual: &RangeInclusive<f64>, unit: &str) -> String {
    let Some(factor) = FACTORS.into_iter().find(|factor| usual.contains(&(value * factor))) else {
        return ": is its unit right?".to_owned();
    };
    let meant = short(format!("{:.2e}", value * factor).parse().unwrap_or(value * factor));
    let (factor, lacks) = if factor > 1.0 { (factor, "missing") } else { (1.0 / factor, "too many") };
    format!(": {meant} {unit} would be usual, is a factor of {} {lacks}?", short(factor))
}

/// The largest field of a kind, in SI, and who has it.
struct Strongest {
    dimension: Dimension,
    /// The slot, where fields of one dimension differ.
    slot: Option<&'static str>,
    usual: RangeInclusive<f64>,
    who: &'static str,
}

const STRONGEST: [Strongest; 3] = [
    Strongest {
        dimension: Dimension::FIELD,
        slot: Some("remanence"),
        usual: 1e-3..=2.0,
        who: "the strongest magnets have 1.5 T, particles in an elastomer some 0.1 T",
    },
    Strongest {
        dimension: Dimension::FIELD,
        slot: None,
        usual: 1e-4..=5.0,
        who: "coils and permanent magnets give up to some 1 T",
    },
    Strongest {
        dimension: Dimension::ELECTRIC_FIELD,
        slot: None,
        usual: 1e5..=1e9,
        who: "films break down at 20 to 400 kV/mm, 4e8 V/m",
    },
];

/// Warns of a field whose largest value, in the case's unit, no apparatus reaches.
pub(super) fn check_field(
    dimension: Dimension,
    slot: &str,
    largest: f64,
    what: &str,
    at: &At,
    context: &mut Context<'_>,
) {
    let of = |one: &&Strongest| one.dimension == dimension && one.slot.is_none_or(|own| own == slot);
    let Some(strongest) = STRONGEST.iter().find(of) else { return };
    let value = context.units.in_si(largest, dimension).abs();
    if !value.is_finite() || value <= *strongest.usual.end() {
        return;
    }
    let unit = if dimension == Dimension::FIELD { "T" } else { "V/m" };
    let message =
        format!("{what} {} {unit}, where {}{}", short(value), strongest.who, likely(value, &strongest.usual, unit));
    context.warn(&UNITS, at, message);
}

/// The same of a component over the time, where that at t = 0, which is looked at by itself, is a usual one.
pub(super) fn check_field_in_time(field: (Dimension, &str), values: &[Vec<f64>], at: &At, context: &mut Context<'_>) {
    let largest = |values: &Vec<f64>| values.iter().map(|value| value.abs()).fold(0.0, f64::max);
    let most = values.iter().map(largest).fold(0.0, f64::max);
    if values.first().is_some_and(|first| largest(first) < most) {
        check_field(field.0, field.1, most, "over the time it reaches", at, context);
    }
}

/// The same of what bounds let controls reach.
pub(super) fn check_controls(case: &Case, controls: &[ControlField], context: &mut Context<'_>) {
    let own = case.load_cases.iter().flat_map(|block| &block.controls);
    let blocks: Vec<_> = case.controls.iter().chain(own).collect();
    for field in controls {
        let most = match field.admitted {
            Admitted::Between { lower, upper } => {
                [lower, upper].into_iter().map(f64::abs).filter(|bound| bound.is_finite()).fold(0.0, f64::max)
            }
            Admitted::Norm(norm) | Admitted::MaxNorm(norm) => norm,
            Admitted::Any => continue,
        };
        let slot = blocks.iter().find(|block| block.at == field.at);
        let slot = slot.and_then(|block| block.of.rsplit('.').next()).unwrap_or_default();
        for dimension in [Dimension::FIELD, Dimension::ELECTRIC_FIELD] {
            if field.unit == context.units.label(dimension) {
                check_field(dimension, slot, most, "the bounds reach", &field.at, context);
            }
        }
    }
}

/// Materials are between these, kg/m^3: foams and heavy metals.
const DENSITIES: RangeInclusive<f64> = 10.0..=30_000.0;

/// Warns of a density that no material has.
pub(super) fn check_density(density: f64, at: &At, context: &mut Context<'_>) {
    let density = context.units.in_si(density, Dimension::DENSITY);
    if !DENSITIES.contains(&density) {
        let likely = likely(density, &DENSITIES, "kg/m^3");
        let message = format!(
            "a density of {} kg/m^3 is no usual one{likely} Give its unit, as in \"1000 kg/m^3\"",
            short(density)
        );
        context.warn(&UNITS, at, message);
    }
}

/// Gravity on moons and planets, with a margin, m/s^2.
const GRAVITIES: RangeInclusive<f64> = 0.1..=100.0;

/// Warns of a gravity that acts nowhere; none at all is weightlessness.
pub(super) fn check_gravity(gravity: [f64; 3], at: &At, context: &mut Context<'_>) {
    let size = gravity.iter().map(|g| g * g).sum::<f64>().sqrt();
    let size = context.units.in_si(size, Dimension::ACCELERATION);
    if size > 0.0 && !GRAVITIES.contains(&size) {
        let message = format!(
            "gravity is {} m/s^2, on earth 9.81 m/s^2{} Give its unit, as in \"-9.81 m/s^2\"",
            short(size),
            likely(size, &GRAVITIES, "m/s^2")
        );
        context.warn(&UNITS, at, message);
    }
}
