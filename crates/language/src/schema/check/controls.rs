//! Controls against actuations, and costs against controls.

use crate::expression::Formula;
use crate::quantity::{Dimension, Want};
use crate::schema::actuation::{Actuation, Means};
use crate::schema::catalogue::SlotName;
use crate::schema::check::{Blocks, block, plain};
use crate::schema::contact::{Contact, pose_slots};
use crate::schema::control::{Bound, Control, Space, Start};
use crate::schema::cost::Cost;
use crate::schema::design::DesignKind;
use crate::schema::field::{Parameter, check_unit};
use crate::schema::material::Material;
use crate::schema::optimizer::{MMA, Optimizer};
use crate::schema::read::Reader;
use crate::syntax::{At, nearest, quoted};
use nastic_fem::FreeShape;
use std::collections::BTreeMap;

pub(super) fn check(blocks: &Blocks, reader: &mut Reader<'_>) {
    let alone: Vec<&[Control]> = blocks.load_cases.iter().map(|case| case.controls.as_slice()).collect();
    for control in blocks.controls.iter().chain(alone.iter().copied().flatten()) {
        check_slot(control, blocks, reader);
    }
    check_group(blocks, &[], &blocks.controls, &blocks.costs, reader);
    for case in &blocks.load_cases {
        check_group(blocks, &blocks.controls, &case.controls, &case.costs, reader);
    }
    for actuation in &blocks.actuation {
        let names = actuation.modes().into_iter().flat_map(BTreeMap::keys);
        names.for_each(|name| plain(name, &actuation.at.key("modes").key(name), &['.', '/'], reader));
    }
    check_constraints(blocks, reader);
    check_method(blocks, reader);
    check_damping(blocks, reader);
    check_purpose(blocks, reader);
}

/// Constraints on controls hold in every load case.
fn check_constraints(blocks: &Blocks, reader: &mut Reader<'_>) {
    if !["controls", "load_cases"].iter().all(|block| blocks.complete(block)) {
        return;
    }
    let own: Vec<&[Control]> = blocks.load_cases.iter().map(|case| case.controls.as_slice()).collect();
    for cost in blocks.constraints.iter().filter_map(|constraint| constraint.cost.as_ref()) {
        for (of, at) in cost.controls() {
            let among = |own: &[Control]| blocks.controls.iter().chain(own).any(|control| control.name() == of);
            if if own.is_empty() { among(&[]) } else { own.iter().all(|own| among(own)) } {
                continue;
            }
            let names: Vec<&str> = blocks.controls.iter().map(Control::name).collect();
            let whose = if own.is_empty() { "" } else { " of every load case" };
            reader.complain_at(&at, format!("no control {}{whose}{}", quoted(of), nearest::clause(of, &names)));
        }
    }
}

/// Moving asymptotes hold bounds of functionals from one side.
fn check_method(blocks: &Blocks, reader: &mut Reader<'_>) {
    if block::<Optimizer>(reader, "optimizer").is_none_or(|optimizer| optimizer.method.name() != MMA) {
        return;
    }
    for constraint in blocks.constraints.iter().filter(|constraint| constraint.equal.is_some()) {
        let message =
            format!("\"{MMA}\" holds bounds from one side: give \"at_most\" or \"at_least\", or take \"lbfgs\"");
        reader.complain_at(&constraint.at.key("equal"), message);
    }
}

/// Damping by stiffness takes the laws as they are written.
fn check_damping(blocks: &Blocks, reader: &mut Reader<'_>) {
    let damping = blocks.time.as_ref().and_then(|time| time.rayleigh.as_ref());
    let Some(damping) = damping.filter(|damping| damping.stiffness != 0.0) else { return };
    let of_cases = blocks.load_cases.iter().flat_map(|case| &case.controls);
    let changes = |control: &&Control| {
        blocks.materials.iter().any(|own| own.number_of(&control.of).is_some()) || blocks.has_design(&control.of)
    };
    if let Some(control) = blocks.controls.iter().chain(of_cases).find(changes) {
        let name = quoted(control.name());
        let message = format!(
            "its stiffness is that of the body as its laws are written, which {name} changes: leave it out, or take \"kelvin_voigt\" or a scheme that damps"
        );
        reader.complain_at(&damping.at.key("stiffness"), message);
    }
}

fn check_slot(control: &Control, blocks: &Blocks, reader: &mut Reader<'_>) {
    let slots = slots(blocks);
    if blocks.actuation.iter().any(|actuation| has_unknown_slots(actuation, &control.of, blocks, reader)) {
        return;
    }
    let Some((_, slot)) = slots.iter().find(|(name, _)| *name == control.of) else {
        // a material with a mistake may be what "rubber.mu" is of
        let read = blocks.complete("materials") || !control.of.contains('.');
        if read && ["actuation", "electrodes", "obstacles", "contact"].iter().all(|block| blocks.complete(block)) {
            let known: Vec<&str> = slots.iter().map(|(name, _)| name.as_str()).collect();
            let owner = blocks.actuation.iter().find_map(|actuation| {
                let slot = control.of.strip_prefix(&actuation.name)?.strip_prefix('.')?;
                Some((actuation, slot))
            });
            let clause = match owner {
                _ if known.is_empty() => ": the case has no actuation".into(),
                None if is_untouched(&control.of, blocks) => ": no contact touches that obstacle".into(),
                Some((actuation, slot)) => unknown_input(actuation, slot, &known, reader),
                None => nearest::clause(&control.of, &known),
            };
            let is_number = blocks.materials.iter().any(|material| material.number_of(&control.of).is_some());
            let what = if is_number { "number of a material" } else { "actuation" };
            let message = format!("no {what} {}{clause}", quoted(&control.of));
            reader.complain_at(&control.at.key("of"), message);
        }
        return;
    };
    check_number(control, blocks, reader);
    let is_direction =
        blocks.actuation.iter().any(|actuation| actuation.direction().is_some_and(|name| name == control.of));
    if is_direction {
        check_direction(control, reader);
    }
    if blocks.has_design(&control.of) {
        check_design(control, reader);
    }
    let is_own = |own: &&Actuation| own.loads().iter().any(|(name, _)| *name == control.of);
    let mut shapes = blocks.actuation.iter().filter(|own| own.modes().is_some() || own.kind() == FreeShape::KIND);
    if let Some(shape) = shapes.find(is_own) {
        check_shape(control, shape.modes().is_some(), reader);
    }
    if slot.vector && control.log {
        let message = format!("\"{}\" is a vector: a logarithm is that of a positive number", control.of);
        reader.complain_at(&control.at.key("log"), message);
    }
    if slot.vector && control.direction.is_none() {
        check_vector(control, is_direction, reader);
    } else {
        check_scalar(control, slot, reader);
    }
    check_dimensions(control, slot, reader);
}

/// A direction is a unit vector of the body itself.
fn check_direction(control: &Control, reader: &mut Reader<'_>) {
    let of = &control.of;
    if control.length() != Some(1.0) || control.direction.is_some() {
        reader.complain_at(
            &control.at,
            format!("\"{of}\" is a field of unit vectors: give \"norm\": 1, and no \"direction\""),
        );
    }
    if control.in_time.is_some() {
        let message = format!("\"{of}\" is a direction in the body, which does not change in time");
        reader.complain_at(&control.at.key("in_time"), message);
    }
}

/// What changes a shape is a length of the body itself, and the amplitude of a mode one number.
fn check_shape(control: &Control, is_mode: bool, reader: &mut Reader<'_>) {
    let (of, at) = (&control.of, &control.at);
    if control.in_time.is_some() {
        let message = format!(
            "\"{of}\" is a shape of the body, which does not change in time: what grows is of the kind \"growth\""
        );
        reader.complain_at(&at.key("in_time"), message);
    }
    if !is_mode && control.filter.is_some() {
        let message = format!("\"{of}\" is smoothed by the \"filter\" of its actuation: leave this one out");
        reader.complain_at(&at.key("filter"), message);
    }
    if is_mode && control.space != Space::Uniform {
        let message = format!("\"{of}\" is the amplitude of a field, one number: take the space \"uniform\"");
        reader.complain_at(&at.key("space"), message);
    }
}

/// A design is a scalar of the body itself, between bounds.
fn check_design(control: &Control, reader: &mut Reader<'_>) {
    let (of, at) = (&control.of, &control.at);
    if control.in_time.is_some() {
        let message = format!("\"{of}\" is a design, which does not change in time");
        reader.complain_at(&at.key("in_time"), message);
    }
    if control.log {
        let message = format!("\"{of}\" is a design, which may be 0: it has no logarithm");
        reader.complain_at(&at.key("log"), message);
    }
}

/// All that can be controlled, of actuations, contacts, obstacles that contacts touch, named materials, and designs.
fn slots(blocks: &Blocks) -> Vec<(String, SlotName)> {
    let touched = blocks.obstacles.iter().filter(|own| blocks.contact.iter().any(|contact| contact.is_on(&own.name)));
    let poses = touched.flat_map(|obstacle| pose_slots(&obstacle.name));
    let contacts = blocks.contact.iter().flat_map(Contact::slots);
    let numbers = blocks.materials.iter().flat_map(Material::slots);
    let slot = SlotName { key: "design", want: Want::NUMBER, vector: false, not_negative: false };
    let mut designs: Vec<(String, SlotName)> = Vec::new();
    for design in blocks.designs() {
        if !designs.iter().any(|(name, _)| *name == design.name) {
            designs.push((design.name.clone(), slot));
        }
    }
    let actuations = blocks.actuation.iter().flat_map(Actuation::slots);
    actuations.chain(poses).chain(contacts).chain(numbers).chain(designs).collect()
}

/// Whether a control is of the pose of an obstacle that no contact touches.
fn is_untouched(of: &str, blocks: &Blocks) -> bool {
    blocks.obstacles.iter().any(|obstacle| pose_slots(&obstacle.name).iter().any(|(name, _)| name == of))
}

/// Whether a control is of an actuation with a mistake that may hide which form of its kind it is, and so what its slots are.
fn has_unknown_slots(actuation: &Actuation, of: &str, blocks: &Blocks, reader: &Reader<'_>) -> bool {
    let forms = reader.document.catalogue().contributions().filter(|(kind, _)| *kind == actuation.kind()).count();
    let is_own = of.strip_prefix(&actuation.name).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'));
    forms > 1 && is_own && !blocks.is_sound(&actuation.at)
}

/// What can be controlled of an actuation that has no such input, and why not that.
fn unknown_input(actuation: &Actuation, wrong: &str, known: &[&str], reader: &Reader<'_>) -> String {
    let inputs = actuation.slots();
    let keys: Vec<&str> = inputs.iter().map(|(_, slot)| slot.key).collect();
    // an input that has another name here is no misspelling
    let meant = if keys.contains(&wrong) { None } else { nearest::nearest(wrong, &keys) };
    if let Some((name, _)) = meant.and_then(|key| inputs.iter().find(|(_, slot)| slot.key == key)) {
        return format!(": did you mean \"{name}\"? (one of: {})", known.join(", "));
    }
    let of = |(name, slot): &(String, SlotName)| format!("\"{name}\" (its {})", slot.key);
    let list: Vec<String> = inputs.iter().map(of).collect();
    let why = excluding(actuation, wrong, reader)
        .map(|key| format!("; with \"{key}\" a {} has no {wrong}", actuation.kind().replace('_', " ")));
    let one = if actuation.has_one_driver() { ", one of which drives it" } else { "" };
    format!(
        ": what can be controlled of \"{}\" is {}{one}{}",
        actuation.name,
        list.join(" and "),
        why.unwrap_or_default()
    )
}

/// The key that keeps an actuation from having an input that another form of its kind has.
fn excluding(actuation: &Actuation, input: &str, reader: &Reader<'_>) -> Option<&'static str> {
    let Means::Contribution { kind, form, .. } = &actuation.means else { return None };
    let mut forms = reader.document.catalogue().contributions().filter(|(other, _)| other == kind);
    let (_, other) = forms.find(|(_, other)| other.slots.iter().any(|slot| slot.group == input))?;
    form.keys.iter().map(|key| key.name).find(|key| !other.keys.iter().any(|known| known.name == *key))
}

/// A number of a material is the same for the whole motion, and a control of it gives it in all scenarios.
fn check_number(control: &Control, blocks: &Blocks, reader: &mut Reader<'_>) {
    let of = |material: &Material| Some((material.at.clone(), material.number_of(&control.of)?.to_owned()));
    let Some((at, key)) = blocks.materials.iter().find_map(of) else { return };
    if control.in_time.is_some() {
        let message = format!("\"{}\" is a number of a material, which does not change in time", control.of);
        reader.complain_at(&control.at.key("in_time"), message);
    }
    if varies(blocks, &at.key(&key)) || varies(blocks, &at.key("parameters").key(&key)) {
        let message =
            format!("\"{}\" varies from scenario to scenario: the control would give it to all of them", control.of);
        reader.complain_at(&control.at.key("of"), message);
    }
}

/// A direction starts from the one that is written with it, other vectors from zero.
fn check_vector(control: &Control, is_direction: bool, reader: &mut Reader<'_>) {
    let is_list = |bound: &Option<Bound>| bound.as_ref().map(|bound| bound.scalar().is_none());
    for (key, given) in [("lower", is_list(&control.lower)), ("upper", is_list(&control.upper))] {
        if given == Some(false) {
            let message =
                format!("\"{}\" is a vector: give two or three entries, or \"norm\" or \"max_norm\"", control.of);
            reader.complain_at(&control.at.key(key), message);
        } else if given.is_some() && (control.norm.is_some() || control.max_norm.is_some()) {
            let message = "bounds of the components do not go with \"norm\" and \"max_norm\": give one of them";
            reader.complain_at(&control.at.key(key), message);
        }
    }
    let start = control.at.key("start");
    match &control.start {
        Some(Start::Table(table)) if table.columns.is_none() => {
            reader.complain_at(&start, format!("\"{}\" is a vector: give two or three \"columns\"", control.of));
        }
        Some(Start::Scalar(_)) => {
            reader.complain_at(&start, format!("\"{}\" is a vector: give two or three entries", control.of));
        }
        None if control.norm.is_some() && !is_direction && reader.document.root().find(start.as_str()).is_none() => {
            reader.complain_at(&control.at, "missing key \"start\": zero, the default, does not have the \"norm\"");
        }
        Some(Start::Vector(entries)) if control.norm.is_some() && entries.iter().all(|e| e.constant() == Some(0.0)) => {
            reader.complain_at(&start, "a zero vector cannot be given the \"norm\"");
        }
        _ => {}
    }
}

fn check_scalar(control: &Control, slot: &SlotName, reader: &mut Reader<'_>) {
    match &control.direction {
        Some(_) if !slot.vector => {
            let message = format!("\"{}\" is a scalar, it has no direction", control.of);
            reader.complain_at(&control.at.key("direction"), message);
        }
        Some(direction) => {
            check_unit(&direction.field(), &control.at.key("direction"), reader);
        }
        None => {}
    }
    for (key, given) in [("norm", control.norm.is_some()), ("max_norm", control.max_norm.is_some() && !slot.vector)] {
        if given {
            let message = format!("\"{}\" is a scalar: give \"lower\" and \"upper\"", control.of);
            reader.complain_at(&control.at.key(key), message);
        }
    }
    for (key, bound) in [("lower", &control.lower), ("upper", &control.upper)] {
        if bound.as_ref().is_some_and(|bound| bound.scalar().is_none()) {
            reader.complain_at(&control.at.key(key), format!("\"{}\" is a scalar: give one value", control.of));
        }
    }
    let several = matches!(&control.start, Some(Start::Table(table)) if table.columns.is_some());
    if several || matches!(control.start, Some(Start::Vector(_) | Start::Random(_))) {
        reader.complain_at(&control.at.key("start"), format!("\"{}\" is a scalar: give one value", control.of));
    }
}

/// Start and bounds take the dimension of what they control.
fn check_dimensions(control: &Control, slot: &SlotName, reader: &mut Reader<'_>) {
    let start = control.at.key("start");
    let mut values: Vec<(At, &Formula)> = Vec::new();
    match &control.start {
        Some(Start::Scalar(formula)) => values.push((start, formula)),
        Some(Start::Vector(entries)) => values.extend(entries.iter().enumerate().map(|(i, e)| (start.index(i), e))),
        _ => {}
    }
    for (key, bound) in [("lower", &control.lower), ("upper", &control.upper)] {
        match bound {
            Some(Bound::Scalar(Parameter::Formula(formula))) => values.push((control.at.key(key), formula)),
            Some(Bound::Vector(entries)) => {
                values.extend(entries.iter().enumerate().map(|(i, e)| (control.at.key(key).index(i), e)));
            }
            _ => {}
        }
    }
    if let Some(prior) = &control.prior {
        values.extend([(prior.at.key("mean"), &prior.mean), (prior.at.key("deviation"), &prior.deviation)]);
    }
    values.extend(control.fixed.iter().map(|(region, value)| (control.at.key("fixed").key(region), value)));
    let per_time = slot.want.dimension.and_then(|dimension| dimension.over(Dimension::TIME));
    // a scalar has no length: that is reported
    let of_vector = slot.want.dimension.filter(|_| slot.vector);
    let sizes = [
        ("norm", &control.norm, of_vector),
        ("max_norm", &control.max_norm, of_vector),
        ("rate", &control.rate, per_time),
    ];
    for (key, size, dimension) in sizes {
        let Some(size) = size else { continue };
        if let Some(Err(why)) = dimension.map(|dimension| size.check(dimension)) {
            reader.complain_at(&control.at.key(key), why);
        }
    }
    for (at, formula) in values {
        if let Some(Err(why)) = slot.want.dimension.map(|dimension| formula.check(dimension)) {
            reader.complain_at(&at, why);
        }
    }
}

/// The controls and costs of one load case, or those that all share.
fn check_group(blocks: &Blocks, shared: &[Control], own: &[Control], costs: &[Cost], reader: &mut Reader<'_>) {
    for (i, control) in own.iter().enumerate() {
        plain(control.name(), &control.at.key("name"), &['/'], reader);
        let before: Vec<&Control> = shared.iter().chain(&own[..i]).collect();
        if let Some(first) = before.iter().find(|other| other.of == control.of) {
            let message = format!("{} has a control already, at {}", quoted(&control.of), first.at);
            reader.complain_at(&control.at.key("of"), message);
        } else if let Some(first) = before.iter().find(|other| other.name() == control.name()) {
            let message = format!("{} names a control already, at {}", quoted(control.name()), first.at);
            reader.complain_at(&control.at.key("name"), message);
        }
    }
    check_files(blocks, own, reader);
    let names: Vec<&str> = shared.iter().chain(own).map(Control::name).collect();
    if !blocks.complete("controls") || !blocks.complete("load_cases") {
        return;
    }
    let all = || shared.iter().chain(own);
    for cost in costs {
        let squared = |(of, _): &(&str, At)| all().any(|control| control.log && control.name() == *of);
        if cost.kind() == "control_norm" && cost.controls().any(|one| squared(&one)) {
            let message = "the square of a logarithm depends on the unit: take \"control_smoothness\", or the control without \"log\"";
            reader.complain_at(&cost.at().key("of"), message);
        }
        let number = |control: &Control| {
            blocks.materials.iter().any(|own| own.number_of(&control.of).is_some()) || blocks.has_design(&control.of)
        };
        if cost.kind() == "actuation_work" && all().any(number) {
            let message =
                "work of actuations does not go with controls that are numbers of a material: leave one of them out";
            reader.complain_at(cost.at(), message);
        }
        let growth = blocks.actuation.iter().find(|own| own.has_independent_slots());
        if let Some(growth) = growth.filter(|_| cost.kind() == "actuation_work") {
            let name = quoted(&growth.name);
            reader.complain_at(
                cost.at(),
                format!("it does not count the work of a growth, such as {name}: leave one of them out"),
            );
        }
        let own = all().find(|control| number(control)).filter(|_| cost.kind() == "pump_work");
        if let Some(own) = own {
            let name = quoted(own.name());
            let message = format!(
                "the work of pumps takes the body as it is at rest, and {name} changes it: leave one of them out"
            );
            reader.complain_at(cost.at(), message);
        }
        for (of, at) in cost.controls().filter(|(of, _)| !names.contains(of)) {
            let clause =
                if names.is_empty() { ": the case has no controls".into() } else { nearest::clause(of, &names) };
            reader.complain_at(&at, format!("no control {}{clause}", quoted(of)));
        }
    }
}

/// Designs are cut into files of their names: `design_a_rest.stl` is of a mixture `a` and of what is called `a_rest`.
fn check_files(blocks: &Blocks, own: &[Control], reader: &mut Reader<'_>) {
    let is = |control: &Control, kind: DesignKind| {
        blocks.designs().any(|design| design.name == control.of && design.kind == kind)
    };
    let of_two = |control: &Control| is(control, DesignKind::Mixture) || is(control, DesignKind::Electrode);
    let is_cut = |control: &Control| is(control, DesignKind::Density) || of_two(control);
    for control in own.iter().filter(|control| is_cut(control)) {
        let is_part = |other: &&Control| match control.name().strip_prefix(other.name()) {
            Some("_deformed") => is_cut(other),
            Some("_rest" | "_rest_deformed") => of_two(other),
            _ => false,
        };
        if let Some(other) = own.iter().find(is_part) {
            let (name, other) = (control.name(), quoted(other.name()));
            let message =
                format!("\"design_{name}.stl\" would be a file of {other} too: give one of them another \"name\"");
            reader.complain_at(&control.at, message);
        }
    }
}

/// An actuation that is zero and nobody's control does nothing, which nobody wants.
fn check_purpose(blocks: &Blocks, reader: &mut Reader<'_>) {
    if !["controls", "load_cases", "scenarios"].iter().all(|block| blocks.complete(block)) {
        return;
    }
    let controls = blocks.controls.iter().chain(blocks.load_cases.iter().flat_map(|case| &case.controls));
    let controlled: Vec<&str> = controls.map(|control| control.of.as_str()).collect();
    let known: Vec<String> = slots(blocks).into_iter().map(|(name, _)| name).collect();
    if controlled.iter().any(|of| !known.iter().any(|name| name == of)) {
        // A misspelt control may have meant any of them.
        return;
    }
    // what drives one with a mistake may be what could not be read
    let shown = |actuation: &&Actuation| !actuation.is_passive() && blocks.is_sound(&actuation.at);
    for actuation in blocks.actuation.iter().filter(shown) {
        let slots = actuation.loads();
        let drives = |(name, slot): &(String, SlotName)| {
            // A volume that stays as it is does something, a pressure of zero does not.
            let held = slot.key != slots[0].1.key && actuation.fixed.contains_key(slot.key);
            let at = actuation.at.key(slot.key);
            held || actuation.fixes(slot.key) || controlled.contains(&name.as_str()) || varies(blocks, &at)
        };
        if (actuation.has_one_driver() || actuation.has_independent_slots()) && slots.iter().any(drives) {
            continue;
        }
        for (name, slot) in slots.clone() {
            let at = actuation.at.key(slot.key);
            if actuation.fixes(slot.key) || controlled.contains(&name.as_str()) || varies(blocks, &at) {
                continue;
            }
            let no_shape = |space: &str| {
                format!(
                    "\"{}\" changes no shape: give a control {{ \"of\": \"{name}\", \"space\": \"{space}\" }}",
                    actuation.name
                )
            };
            let message = match actuation.modes() {
                Some(_) => no_shape("uniform"),
                None if actuation.kind() == FreeShape::KIND => no_shape("node"),
                None => format!(
                    "\"{}\" has no effect: its {} is zero; give \"{}\" a value, or a control {{ \"of\": \"{name}\", ... }}",
                    actuation.name, slot.key, slot.key
                ),
            };
            reader.complain_at(&actuation.at, message);
            if actuation.has_one_driver() || actuation.has_independent_slots() {
                break;
            }
        }
    }
}

fn varies(blocks: &Blocks, at: &At) -> bool {
    let mut paths = crate::schema::check::variants::paths(blocks);
    let own = at.as_str();
    let within =
        |path: &str, of: &str| path.strip_prefix(of).is_some_and(|rest| rest.is_empty() || rest.starts_with('/'));
    paths.any(|path| within(path, own))
}
