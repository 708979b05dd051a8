//! Contacts, costs and constraints against obstacles.

use crate::schema::check::{Blocks, plain, unique};
use crate::schema::cost::Cost;
use crate::schema::obstacle::{Obstacle, ShapeOrName};
use crate::schema::read::Reader;
use crate::syntax::{At, nearest, quoted};

pub(super) fn check(blocks: &Blocks, reader: &mut Reader<'_>) {
    check_names(blocks, reader);
    let known: Vec<&str> = blocks.obstacles.iter().map(|obstacle| obstacle.name.as_str()).collect();
    let mut named: Vec<(&str, At)> = Vec::new();
    for contact in &blocks.contact {
        named.extend(contact.obstacle.as_ref().map(|name| (name.as_str(), contact.at.key("obstacle"))));
        // one that could not be read was complained about
        let given = reader.document.root().find(contact.at.key("friction").as_str()).is_some();
        let of_friction = [
            ("slip_speed", contact.slip_speed.is_some(), "the slip speed of"),
            ("lagged", contact.lagged, "lagged friction of"),
        ];
        for (key, _, what) in
            of_friction.iter().filter(|(_, is_there, _)| *is_there && contact.friction.is_none() && !given)
        {
            let message = format!("{what} a contact without friction: give \"friction\", or leave this out");
            reader.complain_at(&contact.at.key(key), message);
        }
    }
    let shapes: Vec<(&ShapeOrName, At)> = shapes(blocks).collect();
    let of_name = |(shape, at): &(&'_ ShapeOrName, At)| match shape {
        ShapeOrName::Name(_) => Some(at.clone()),
        ShapeOrName::Shape(_) => None,
    };
    for (shape, at) in &shapes {
        let ShapeOrName::Name(name) = shape else { continue };
        named.push((name, at.clone()));
        if let Some(moved) =
            blocks.obstacles.iter().find(|obstacle| obstacle.name == *name && is_moved(obstacle, blocks))
        {
            let message = format!(
                "{} moves; costs and constraints take obstacles that rest: give a shape of its own here, or leave out its pose",
                quoted(&moved.name)
            );
            reader.complain_at(at, message);
        }
    }
    if !blocks.complete("obstacles") {
        return;
    }
    for (name, at) in named.iter().filter(|(name, _)| !known.contains(name)) {
        let clause = match known.is_empty() {
            true => ": the case has no \"obstacles\"".to_owned(),
            false => nearest::clause(name, &known),
        };
        let own = if shapes.iter().filter_map(of_name).any(|place| place == *at) {
            "; or give a shape, as { \"sphere\": .. }"
        } else {
            ""
        };
        reader.complain_at(at, format!("no obstacle {}{clause}{own}", quoted(name)));
    }
}

/// Whether its pose is not that of its shape.
fn is_moved(obstacle: &Obstacle, blocks: &Blocks) -> bool {
    let controls = blocks.controls.iter().chain(blocks.load_cases.iter().flat_map(|case| &case.controls));
    let mut of = controls.map(|control| control.of.as_str());
    let own =
        |of: &str| of.strip_prefix(&obstacle.name).is_some_and(|rest| [".translation", ".rotation"].contains(&rest));
    obstacle.pose().next().is_some() || of.any(own)
}

/// The obstacles of costs and constraints.
fn shapes(blocks: &Blocks) -> impl Iterator<Item = (&ShapeOrName, At)> {
    let costs = blocks.costs.iter().chain(blocks.load_cases.iter().flat_map(|case| &case.costs));
    let of_constraint = blocks.constraints.iter().filter_map(|constraint| constraint.cost.as_ref());
    let costs = costs.chain(of_constraint).flat_map(Cost::shapes);
    let kept_out = blocks.constraints.iter().filter_map(|constraint| constraint.obstacle.as_ref());
    costs.chain(kept_out.map(|block| (&block.shape, block.at.key("shape"))))
}

fn check_names(blocks: &Blocks, reader: &mut Reader<'_>) {
    unique(blocks.obstacles.iter().map(|o| (o.name.as_str(), o.at.key("name"))), "an obstacle", reader);
    let names: Vec<(String, At)> =
        blocks.contact.iter().map(|contact| (contact.name(), contact.at.key("name"))).collect();
    unique(names.iter().map(|(name, at)| (name.as_str(), at.clone())), "a contact", reader);
    // they share the names of controls
    let others = || blocks.actuation.iter().map(|actuation| actuation.name.as_str());
    for (name, at) in
        names.iter().chain(&blocks.obstacles.iter().map(|o| (o.name.clone(), o.at.key("name"))).collect::<Vec<_>>())
    {
        plain(name, at, &['.', '/'], reader);
        if others().any(|other| other == name) {
            reader.complain_at(at, format!("{} is the name of an actuation; rename one", quoted(name)));
        }
    }
    for (name, at) in names.iter().filter(|(name, _)| blocks.obstacles.iter().any(|obstacle| obstacle.name == *name)) {
        reader.complain_at(at, format!("{} is the name of an obstacle; rename one", quoted(name)));
    }
}
