//! The balance of energy of a motion in results, and what deserves attention in it.

use crate::run::motion::table::Table;
use crate::run::state_columns::ENERGY;
use nastic_case::lower::CaseMember;
use nastic_case::warning::{ENERGY_BALANCE, Warning};
use nastic_fem::EnergyBalance;
use nastic_language::number::{quantity, short};
use nastic_language::quantity::Dimension;
use nastic_report::record::EnergyBalanceRecord;

/// Share of the largest span of the other entries, of the kinetic energy of its largest value, from which on what a scheme adds or takes is warned of.
const MIN_SHARE: f64 = 0.02;
/// Share of the largest entry that counts as a span at least: below is rounding.
const MIN_SPAN: f64 = 1e-6;

/// What a scheme adds or takes between two instants.
#[derive(Clone, Copy, Default)]
struct Change {
    energy: f64,
    /// The end of the step in which most of it comes.
    t: f64,
}

/// What is found in a balance.
struct Found {
    last: EnergyBalance,
    span: f64,
    added: Change,
    taken: Change,
}

impl Found {
    fn of(table: &Table) -> Option<Self> {
        let last = table.last_balance()?;
        let mut bounds = [[f64::INFINITY, f64::NEG_INFINITY]; EnergyBalance::PHYSICAL];
        // a body that spins has what it spins with, although that hardly changes
        bounds[0] = [0.0, 0.0];
        for (_, balance) in table.balances() {
            for ([least, most], entry) in bounds.iter_mut().zip(balance.entries()) {
                (*least, *most) = (least.min(entry), most.max(entry));
            }
        }
        let span = bounds.iter().map(|[least, most]| most - least).fold(0.0, f64::max);
        let size = bounds.iter().flatten().map(|entry| entry.abs()).fold(0.0, f64::max);
        let shares: Vec<(f64, f64)> = table.balances().map(|(t, balance)| (t, balance.scheme)).collect();
        let (added, taken) = (largest_rise(&created(table), 1.0), largest_rise(&shares, -1.0));
        Some(Found { last, span: span.max(MIN_SPAN * size), added, taken })
    }
}

/// What the scheme adds, and what losses give back: one that falls, as friction by the velocity of a scheme of several steps may, is energy from nowhere too.
fn created(table: &Table) -> Vec<(f64, f64)> {
    let (mut before, mut returned) = (None::<EnergyBalance>, 0.0);
    let entry = |(t, balance): (f64, EnergyBalance)| {
        if let Some(before) = before.replace(balance) {
            returned += (before.friction_loss - balance.friction_loss).max(0.0);
            returned += (before.viscous_loss - balance.viscous_loss).max(0.0);
        }
        (t, balance.scheme + returned)
    };
    table.balances().map(entry).collect()
}

/// The largest rise of a sequence, times a sign, from any instant to a later one.
fn largest_rise(shares: &[(f64, f64)], sign: f64) -> Change {
    let (mut least, mut most, mut steepest) = (f64::INFINITY, Change::default(), Change::default());
    let mut before = None;
    for &(t, share) in shares {
        let share = sign * share;
        if share < least {
            (least, steepest) = (share, Change::default());
        }
        let step = before.map_or(0.0, |before| share - before);
        if step > steepest.energy {
            steepest = Change { energy: step, t };
        }
        if share - least > most.energy {
            most = Change { energy: share - least, t: steepest.t };
        }
        before = Some(share);
    }
    most
}

/// The entry of the result.
pub(super) fn record(member: CaseMember<'_>, table: &Table) -> Option<EnergyBalanceRecord> {
    let Found { last, span, added, taken } = Found::of(table)?;
    let by_formula = member.reduced().timeline()?.scheme().ends_at_its_last_stage();
    Some(EnergyBalanceRecord {
        kinetic: last.kinetic.into(),
        elastic: last.elastic.into(),
        contact: last.contact.into(),
        viscous_loss: last.viscous_loss.into(),
        friction_loss: last.friction_loss.into(),
        load_work: last.load_work.into(),
        pressure_work: last.pressure_work.into(),
        drive_work: last.drive_work.into(),
        support_work: last.support_work.into(),
        obstacle_work: last.obstacle_work.into(),
        scheme: last.scheme.into(),
        unbalanced: last.unbalanced.into(),
        scheme_by: if by_formula { "formula" } else { "remainder" }.to_owned(),
        span: span.into(),
        added: added.energy.into(),
        taken: taken.energy.into(),
    })
}

/// What deserves attention: energy that the scheme makes, and energy that it takes.
pub(super) fn warnings(member: CaseMember<'_>, table: &Table) -> Vec<Warning> {
    let (Some(found), Some(timeline)) = (Found::of(table), member.reduced().timeline()) else { return vec![] };
    if member.solid().body().grows() && found.last.drive_work != 0.0 {
        // a growth that the body follows freely leaves errors of its work alone, with nothing of their kind to compare them with
        return vec![];
    }
    let (units, scheme) = (member.problem().units(), timeline.scheme());
    let limit = MIN_SHARE * found.span;
    let describe = |change: Change, does: &str, advice: &str| {
        let message = format!(
            "\"{}\" {does} {} {}, {} % of the largest energy, work or loss of the motion, most of it in the step to t = {}; {advice}",
            scheme.name(),
            short(change.energy),
            units.label(ENERGY),
            short(100.0 * change.energy / found.span),
            quantity(change.t, Dimension::TIME, units)
        );
        Warning::new(&ENERGY_BALANCE, message).of(member.name())
    };
    let mut all = Vec::new();
    if found.added.energy > limit {
        let advice = match scheme.name() {
            "backward_euler" => "take shorter steps",
            _ => "take shorter steps, or \"backward_euler\", which takes what steps do not resolve",
        };
        all.push(describe(found.added, "creates", advice));
    }
    if found.taken.energy > limit {
        let advice = match (scheme.name(), member.case().contact.is_empty()) {
            ("backward_euler" | "linearly_implicit_euler" | "quasi_dynamic", true) => {
                "take shorter steps, or \"tr_bdf2\", which takes less"
            }
            _ => "if that matters, take shorter steps",
        };
        all.push(describe(found.taken, "takes", advice));
    }
    all
}
