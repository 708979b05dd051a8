//! What has a meaning in motion alone, and what a motion needs.

use crate::schema::check::{Blocks, block};
use crate::schema::control::{Bound, Control, Start};
use crate::schema::optimizer::{Optimizer, Unstable};
use crate::schema::read::Reader;
use crate::schema::time::{Beginning, MOST_STEPS, Time};
use crate::syntax::At;
use nastic_fem::Scheme;

pub(super) fn check(blocks: &Blocks, reader: &mut Reader<'_>) {
    if reader.document.root().find("time").is_none() {
        check_static(blocks, reader);
    } else if let Some(mut time) = block::<Time>(reader, "time") {
        time.choose_scheme(!blocks.contact.is_empty());
        check_motion(&time, blocks, reader);
    }
}

fn controls(blocks: &Blocks) -> impl Iterator<Item = &Control> {
    blocks.controls.iter().chain(blocks.load_cases.iter().flat_map(|case| &case.controls))
}

fn check_static(blocks: &Blocks, reader: &mut Reader<'_>) {
    const GIVE: &str = "give \"time\": { \"end\": \"1 s\", \"step\": \"10 ms\" }, or leave this out";
    for control in controls(blocks).filter(|control| control.in_time.is_some()) {
        reader.complain_at(&control.at.key("in_time"), format!("the case is static: {GIVE}"));
    }
    for constraint in blocks.constraints.iter().filter(|constraint| constraint.when.is_some()) {
        reader.complain_at(&constraint.at.key("when"), format!("the case is static: {GIVE}"));
    }
    for contact in blocks.contact.iter().filter(|contact| contact.friction.is_some()) {
        let message = "with friction an equilibrium depends on the way to it, and the case is static: give \"time\": { \"end\": \"1 s\", \"step\": \
                       \"10 ms\", \"start\": \"rest\", \"scheme\": \"quasi_static\" } with loads that grow, or leave this out";
        reader.complain_at(&contact.at.key("friction"), message);
    }
    let costs = blocks.costs.iter().chain(blocks.load_cases.iter().flat_map(|case| &case.costs));
    for cost in costs {
        if cost.when().is_some() {
            reader.complain_at(&cost.at().key("when"), format!("the case is static: {GIVE}"));
        }
        if cost.is_of_motion() {
            reader.complain_at(cost.at(), format!("\"{}\" where the case is static: {GIVE}", cost.kind()));
        }
    }
}

fn check_motion(time: &Time, blocks: &Blocks, reader: &mut Reader<'_>) {
    for contact in blocks.contact.iter().filter(|contact| contact.friction.is_some()) {
        if time.start == Beginning::Equilibrium {
            let message = "with friction an equilibrium depends on the way to it, and the motion would begin at one: give \"start\": \"rest\" in \"time\"";
            reader.complain_at(&contact.at.key("friction"), message);
        }
    }
    for control in controls(blocks) {
        let start = control.start.as_ref().is_some_and(Start::uses_time);
        let bound = |bound: &Option<Bound>| bound.as_ref().is_some_and(Bound::uses_time);
        let used = [("start", start), ("lower", bound(&control.lower)), ("upper", bound(&control.upper))];
        for (key, _) in used.into_iter().filter(|(_, uses)| *uses && control.in_time.is_none()) {
            let message = "depends on the time t, and the control does not: give \"in_time\": { \"every\": \"50 ms\" }";
            reader.complain_at(&control.at.key(key), format!("the {key} {message}"));
        }
        let Some(in_time) = &control.in_time else { continue };
        if time.end / in_time.every > MOST_STEPS {
            let message = format!("more than {MOST_STEPS} knots until the end: take a longer time");
            reader.complain_at(&in_time.at.key("every"), message);
            continue;
        }
        let between = |step: &f64| {
            let steps = in_time.every / step;
            (steps - steps.round()).abs() > 1e-6 * steps || steps < 0.5
        };
        if let Some(step) = time.step.filter(between) {
            let message =
                format!("{} is no multiple of the step {step}: a knot between steps is seen by none", in_time.every);
            reader.complain_at(&in_time.at.key("every"), message);
            continue;
        }
        let parts = time.end / in_time.every;
        if (parts - parts.round()).abs() > 1e-6 * parts || parts < 0.5 {
            let near = time.end / parts.ceil();
            let message = format!("the end {} is no multiple of {}: take {near}", time.end, in_time.every);
            reader.complain_at(&in_time.at.key("every"), message);
        }
    }
    check_scheme(time, blocks, reader);
    let optimizer: Option<Optimizer> = block(reader, "optimizer");
    let given = |key: &str, wanted: bool, reader: &mut Reader<'_>, message: &str| {
        if wanted {
            reader.complain_at(&At::root().key("optimizer").key(key), message);
        }
    };
    if let Some(optimizer) = &optimizer {
        let from_rest =
            "every motion is computed from its start, whatever came before: there is nothing to verify, leave this out";
        given("verify", optimizer.verify, reader, from_rest);
        let no_equilibria = "the states of a motion are no equilibria, which alone can be refused for their negative pivots: leave this out";
        given("unstable", optimizer.unstable == Unstable::Refuse, reader, no_equilibria);
    }
    let method = optimizer.map(|optimizer| optimizer.method.name());
    if let Some(method) = method.filter(|method| ["gauss_newton", "newton_cg"].contains(method)) {
        let message = format!("\"{method}\" needs second derivatives, which motions do not have: take \"lbfgs\"");
        reader.complain_at(&At::root().key("optimizer").key("method"), message);
    }
}

/// What a scheme cannot begin with.
fn check_scheme(time: &Time, blocks: &Blocks, reader: &mut Reader<'_>) {
    let (Ok(scheme), true) = (time.built_scheme(), time.velocity.is_some()) else { return };
    let name = scheme.name();
    let accelerated = scheme.needs_acceleration() || scheme.start().is_some_and(Scheme::needs_acceleration);
    if scheme.is_quasi_static() {
        let message = format!("\"{name}\" has no inertia, and so no velocity: leave it out, or take \"tr_bdf2\"");
        reader.complain_at(&time.at.key("velocity"), message);
    } else if accelerated && blocks.materials.iter().any(|material| material.kelvin_voigt.is_some()) {
        let message = format!(
            "\"{name}\" begins with an acceleration, which is not known of a body that moves and has \"kelvin_voigt\" damping: take \"backward_euler\""
        );
        reader.complain_at(&time.at.key("velocity"), message);
    }
}
