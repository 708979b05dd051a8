//! What is known of controls before readings.

use crate::lower::context::Context;
use crate::lower::named_cost::Named;
use crate::lower::variant::Variant;
use nastic_control::{Cost, Prior, Reduced};

/// Adds what is known of the controls of a member: each prior once over the load cases that have the control, as they are weighted.
pub(super) fn add(
    variants: &[Variant],
    variant: &Variant,
    shared: usize,
    mut body: Reduced,
    context: &mut Context<'_>,
) -> Option<Reduced> {
    for (k, control) in variant.case.controls.iter().enumerate() {
        let Some(prior) = &control.prior else { continue };
        if variant.case.time.is_some() {
            context.complain(&prior.at, "a prior in a motion is not supported: a \"control_norm\" may do");
            return None;
        }
        let is_user = |other: &&Variant| k < shared || other.load_case == variant.load_case;
        let users = variants.iter().filter(|other| other.scenario == variant.scenario).filter(is_user);
        let share = 1.0 / users.map(|other| other.weight).sum::<f64>();
        let (mean, deviation) = (prior.mean.constant()?, prior.deviation.constant()?);
        if control.log && mean <= 0.0 {
            context.complain(&prior.at, "the mean is not positive, and the logarithm of the control is the unknown");
            return None;
        }
        let cost = Prior::of(&control.of, mean, deviation).and_then(|prior| prior.weight(share));
        let cost: Box<dyn Cost> = Box::new(context.take(&prior.at, cost)?);
        let name = format!("prior of {}", control.name());
        body = context.take(&prior.at, body.cost(Named::new(&name, cost)))?;
    }
    Some(body)
}
