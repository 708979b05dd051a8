//! Numbers in front of laws against all that has a name, and against controls.

use crate::schema::check::{Blocks, plain};
use crate::schema::design::{Design, MixedLaw};
use crate::schema::material::Material;
use crate::schema::read::Reader;
use crate::syntax::{At, nearest, quoted};

pub(super) fn check(blocks: &Blocks, reader: &mut Reader<'_>) {
    let mut seen: Vec<&str> = Vec::new();
    for design in blocks.designs() {
        check_other_law(design, blocks, reader);
        if seen.contains(&design.name.as_str()) {
            continue;
        }
        seen.push(&design.name);
        plain(&design.name, &design.at.key("name"), &['.', '/'], reader);
        if let Some(first) = named(&design.name, blocks) {
            let message = format!("{} is a name already, at {first}", quoted(&design.name));
            reader.complain_at(&design.at.key("name"), message);
        }
        let all = blocks.controls.iter().chain(blocks.load_cases.iter().flat_map(|case| &case.controls));
        let read = ["controls", "load_cases"].iter().all(|block| blocks.complete(block));
        if read && !all.clone().any(|control| control.of == design.name) {
            let message = format!(
                "nothing says what {0} is: give a control {{ \"of\": {0}, \"space\": \"cell\", \"start\": .. }}",
                quoted(&design.name)
            );
            reader.complain_at(&design.at, message);
        }
    }
    blocks.materials.iter().for_each(|material| check_masses(material, reader));
}

/// What else has the name.
fn named<'b>(name: &str, blocks: &'b Blocks) -> Option<&'b At> {
    let materials = blocks.materials.iter().filter(|own| own.name.as_deref() == Some(name)).map(|own| &own.at);
    let actuations = blocks.actuation.iter().filter(|own| own.name == name).map(|own| &own.at);
    materials.chain(actuations).next()
}

fn check_other_law(design: &Design, blocks: &Blocks, reader: &mut Reader<'_>) {
    let Some(MixedLaw::Name(name)) = &design.with else { return };
    let known: Vec<&str> = blocks.materials.iter().filter_map(|material| material.name.as_deref()).collect();
    if blocks.complete("materials") && !known.contains(&name.as_str()) {
        let clause = if known.is_empty() { ": no material has a name".into() } else { nearest::clause(name, &known) };
        reader.complain_at(&design.at.key("with"), format!("no material {}{clause}", quoted(name)));
    }
}

/// The mass of a material follows one field.
fn check_masses(material: &Material, reader: &mut Reader<'_>) {
    if material.density.is_none() {
        return;
    }
    let mut follow = material.design.iter().filter(|design| design.has_mass());
    if let (Some(first), Some(second)) = (follow.next(), follow.next()) {
        let message = format!(
            "mass and weight follow one design, and {} gives them already: say \"mass\": false of one of them",
            quoted(&first.name)
        );
        reader.complain_at(&second.at, message);
    }
}
