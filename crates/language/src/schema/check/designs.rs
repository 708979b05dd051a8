//! Numbers in front of laws against all that has a name, and against controls.

use crate::schema::actuation::Actuation;
use crate::schema::design::{Design, MixedLaw};
use crate::schema::material::Material;
use crate::schema::read::Reader;
use crate::syntax::{At, nearest, quoted};

/// What the designs of a case are held against.
pub(super) struct Beside<'b> {
    pub materials: &'b [Material],
    /// Whether all of these could be read.
    pub are_all: bool,
    pub actuation: &'b [Actuation],
    /// What the controls of every load case are of, of a case without them those that it has; `None` where some could not be read.
    pub controlled: Option<Vec<Vec<&'b str>>>,
}

pub(super) fn check<'b>(designs: impl Iterator<Item = &'b Design>, beside: &Beside<'b>, reader: &mut Reader<'_>) {
    let mut seen: Vec<&str> = Vec::new();
    for design in designs {
        check_other_law(design, beside, reader);
        if seen.contains(&design.name.as_str()) {
            continue;
        }
        seen.push(&design.name);
        if let Some(first) = named(&design.name, beside) {
            let message = format!("{} is a name already, at {first}", quoted(&design.name));
            reader.complain_at(&design.at.key("name"), message);
        }
        if beside.controlled.iter().flatten().any(|of| !of.contains(&design.name.as_str())) {
            let several = beside.controlled.as_ref().is_some_and(|all| all.len() > 1);
            let whose = if several { " in every load case" } else { "" };
            let message = format!(
                "nothing says what {0} is{whose}: give a control {{ \"of\": {0}, \"space\": \"cell\", \"start\": .. }}",
                quoted(&design.name)
            );
            reader.complain_at(&design.at, message);
        }
    }
    for material in beside.materials.iter().filter(|material| !material.design.is_empty()) {
        check_masses(material, beside, reader);
        check_stiffness(material, beside, reader);
        if !material.maxwell.is_empty() || material.kelvin_voigt.is_some() {
            let message = "the viscosity of a material does not follow its designs: leave one of them out";
            reader.complain_at(&material.at.key("design"), message);
        }
    }
}

/// What else has the name.
fn named<'b>(name: &str, beside: &Beside<'b>) -> Option<&'b At> {
    let materials = beside.materials.iter().filter(|own| own.name.as_deref() == Some(name)).map(|own| &own.at);
    let actuations = beside.actuation.iter().filter(|own| own.name == name).map(|own| &own.at);
    materials.chain(actuations).next()
}

fn check_other_law(design: &Design, beside: &Beside<'_>, reader: &mut Reader<'_>) {
    let Some(MixedLaw::Name(name)) = &design.with else { return };
    let other = beside.materials.iter().find(|material| material.name.as_ref() == Some(name));
    if other.is_some_and(|material| !material.design.is_empty()) {
        let message = format!(
            "{} follows designs of its own, which a mixture does not take: give {{ \"law\": .. }}",
            quoted(name)
        );
        reader.complain_at(&design.at.key("with"), message);
    }
    let mut controlled = beside.controlled.iter().flatten().flatten();
    let number = other.and_then(|material| controlled.find(|of| material.number_of(of).is_some()));
    if let Some(of) = number {
        let message = format!(
            "the control {} changes {}, and a mixture takes the numbers as they are written: give {{ \"law\": .. }}",
            quoted(of),
            quoted(name)
        );
        reader.complain_at(&design.at.key("with"), message);
    }
    let known: Vec<&str> = beside.materials.iter().filter_map(|material| material.name.as_deref()).collect();
    if beside.are_all && !known.contains(&name.as_str()) {
        let clause = if known.is_empty() { ": no material has a name".into() } else { nearest::clause(name, &known) };
        reader.complain_at(&design.at.key("with"), format!("no material {}{clause}", quoted(name)));
    }
}

/// A law that holds a body is mixed with another one that does.
fn check_stiffness(material: &Material, beside: &Beside<'_>, reader: &mut Reader<'_>) {
    for design in material.design.iter().filter(|_| !material.law.reinforcing) {
        let other = match &design.with {
            Some(MixedLaw::Law(law)) => Some(law.law),
            Some(MixedLaw::Name(name)) => {
                beside.materials.iter().find(|own| own.name.as_ref() == Some(name)).map(|own| own.law)
            }
            None => None,
        };
        if let Some(law) = other.filter(|law| law.reinforcing) {
            let message = format!(
                "{} only reinforces a body, which nothing else would hold where its share is 1: put it beside the law as a material of its own, with a design \"density\"",
                quoted(law.name)
            );
            reader.complain_at(&design.at.key("with"), message);
        }
    }
}

/// The mass of a material follows one field.
fn check_masses(material: &Material, beside: &Beside<'_>, reader: &mut Reader<'_>) {
    for design in material.design.iter().filter(|design| design.mass == Some(true)) {
        let message = if material.density.is_none() {
            format!("no mass follows: {} has no \"density\"", material.at)
        } else if !Material::follows(design, beside.materials) && beside.are_all {
            "no mass follows: the other law has no \"density\"".to_owned()
        } else {
            continue;
        };
        reader.complain_at(&design.at.key("mass"), message);
    }
    if material.density.is_none() {
        return;
    }
    let mut follow = material.design.iter().filter(|design| Material::follows(design, beside.materials));
    if let (Some(first), Some(second)) = (follow.next(), follow.next()) {
        let message = format!(
            "mass and weight follow one design, and {} gives them already: say \"mass\": false of one of them",
            quoted(&first.name)
        );
        reader.complain_at(&second.at, message);
    }
}
