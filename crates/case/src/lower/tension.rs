//! Bounds of fibre tensions by what the laws bear: one family alone, and all on the same cells.

use super::variant::Variant;
use crate::lower::control_field::ControlField;
use crate::warning::CONVEXITY;
use nastic_control::Reduced;
use nastic_fem::{BodyEnergy, ExcessTension};
use nastic_language::quantity::{Dimension, Units};
use nastic_language::syntax::At;
use nastic_opt::Bounds;

use super::context::Context;

/// How much of the convexity bound an upper bound left out is: at the bound itself a free neo-Hookean block has no equilibrium.
const MARGIN: f64 = 0.95;

/// The smallest of the laws' bounds on a tension alone; bodies number their fields alike.
pub(super) fn limit<'b>(bodies: impl Iterator<Item = &'b Reduced>, field: usize) -> Option<f64> {
    least(bodies, field, BodyEnergy::fiber_limit)
}

/// The upper bound of a tension where none is given: `0.95 limit / lambda_max(sum_k a_k (x) a_k)` over the families on its cells,
/// with which all of them at once stay within the laws' bound. The smallest of all bodies.
pub(super) fn default_upper<'b>(bodies: impl Iterator<Item = &'b Reduced>, field: usize) -> Option<f64> {
    least(bodies, field, BodyEnergy::joint_fiber_limit).map(|limit| MARGIN * limit)
}

fn least<'b>(
    bodies: impl Iterator<Item = &'b Reduced>,
    field: usize,
    of: impl Fn(&BodyEnergy, usize) -> Option<f64>,
) -> Option<f64> {
    let of = |body: &Reduced| {
        let block = &body.layout().blocks()[field];
        let target = &block.targets[0];
        let all = body.solid().model().controllable();
        let is_load = all.get(target.actuation).is_some_and(|own| !own.slots[target.slot].is_design());
        (block.components == 1 && is_load).then(|| of(body.solid().body(), block.targets[0].actuation)).flatten()
    };
    bodies.filter_map(of).reduce(f64::min)
}

/// Warns, once, of families of which each is within the bound alone and which exceed it together, at their upper bounds and fixed
/// values. `shared` is the number of control fields that all members share.
pub(super) fn warn_of_families(
    shared: usize,
    variants: &[Variant],
    bodies: &[Reduced],
    fields: &[ControlField],
    contexts: &mut [Context<'_>],
) {
    for ((variant, body), context) in variants.iter().zip(bodies).zip(contexts) {
        let bounds = variant.case.controls.iter().enumerate().map(|(k, control)| {
            let load_case = variant.load_case.filter(|_| k >= shared);
            let own = fields.iter().find(|field| field.load_case == load_case && field.at == control.at);
            own.and_then(|field| field.bounds.as_ref())
        });
        if let Some(excess) = joint_excess(body, bounds) {
            let at = At::root().key(if variant.case.controls.is_empty() { "actuation" } else { "controls" });
            return context.warn(&CONVEXITY, &at, beyond_together(&excess, context.units));
        }
    }
}

/// Where the families of a body exceed the bound of its laws together, none of them alone, with the bounds of its fields.
pub(super) fn joint_excess<'f>(
    body: &Reduced,
    bounds: impl Iterator<Item = Option<&'f Bounds>>,
) -> Option<ExcessTension> {
    // Of a control in time the largest over its knots.
    let instant = body.layout_of_instant();
    let mut most = vec![0.0; instant.len()];
    for ((block, own), bounds) in body.layout().blocks().iter().zip(instant.blocks()).zip(bounds) {
        let Some(bounds) = bounds else { continue };
        for i in 0..block.len() {
            let (_, upper) = bounds.at(i);
            // What has no bound is reported by itself.
            let upper = if upper.is_finite() { upper } else { 0.0 };
            let place = &mut most[own.first + i % own.size()];
            *place = if i < own.size() { upper } else { place.max(upper) };
        }
    }
    let energy = body.solid().body();
    let excess = energy.excess_tension(&instant.to_points(&most).ok()?)?;
    let largest = energy.actuations().iter().position(|attached| attached.name == excess.actuation)?;
    let alone = energy.fiber_limit(largest).is_some_and(|limit| excess.tension > limit);
    (!alone && !excess.beside.is_empty()).then_some(excess)
}

/// What to say of a tension above the law's convexity bound.
pub(super) fn beyond_limit(tension: f64, limit: f64, units: Units) -> String {
    let unit = units.label(Dimension::PRESSURE);
    format!("a tension of {tension} {unit} exceeds {limit} {unit}, up to which the law stays polyconvex: {CONSEQUENCE}")
}

/// What to say of families that exceed it together.
pub(super) fn beyond_together(excess: &ExcessTension, units: Units) -> String {
    let unit = units.label(Dimension::PRESSURE);
    let ExcessTension { actuation, tension, limit, beside } = excess;
    let others: Vec<String> = beside.iter().map(|(name, tension)| format!("{tension} {unit} of \"{name}\"")).collect();
    let share = limit / tension;
    format!(
        "the tensions of {tension} {unit} of \"{actuation}\" and {} on the same cells are together beyond what the law bears: it stays \
         polyconvex up to {share:.3} times all of them; {CONSEQUENCE}",
        others.join(" and ")
    )
}

const CONSEQUENCE: &str = "beyond it the existence theorem does not hold and the body may have no equilibrium";
