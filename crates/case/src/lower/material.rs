//! Passive laws.

use super::context::Context;
use super::design;
use super::field::SamplePoints;
use super::law_inputs::inputs;
use super::named::{attempt, complain_of_law};
use super::named_groups;
use super::uncertain::Uncertain;
use crate::lower::control_field::{Admitted, ControlField};
use crate::warning::{CONVEXITY, INPUT};
use nastic_energy::EnergyError;
use nastic_energy::catalogue::Inputs;
use nastic_fem::{Discretization, RigidBody, Solid};
use nastic_language::number::short;
use nastic_language::schema::{Case, Control, Material};
use std::collections::BTreeSet;

pub(super) fn add(case: &Case, uncertain: &[Uncertain], solid: &mut Solid, context: &mut Context<'_>) {
    let mut covered: Vec<Option<usize>> = vec![None; solid.mesh().cells()];
    let mut reinforced: Vec<Option<usize>> = vec![None; solid.mesh().cells()];
    for (k, material) in case.materials.iter().enumerate() {
        let mesh = solid.mesh().clone();
        let Some(cells) = named_groups::cells(&mesh, &material.region, &material.at.key("region"), context) else {
            continue;
        };
        if material.law.reinforcing {
            cells.iter().for_each(|&cell| reinforced[cell as usize] = Some(k));
        }
        let covered = if material.law.reinforcing { &mut vec![None; covered.len()] } else { &mut covered };
        let before = cells.iter().filter_map(|&cell| covered[cell as usize].replace(k));
        let before: Vec<usize> = before.collect();
        if let Some(&first) = before.first() {
            let message = format!(
                "{} of its cells have the law of \"{}\" too: both energies add up",
                before.len(),
                case.materials[first].region
            );
            context.warn(&INPUT, &material.at.key("region"), message);
        }
        if let Some(formulation) = material.formulation {
            attempt(solid, &material.at.key("formulation"), context, |solid| {
                solid.formulation(&material.region, formulation)
            });
        }
        let disc = solid.discretization().clone();
        let points = SamplePoints::of_body(case, &disc, &cells);
        let Some(inputs) = inputs(&material.parameters, &material.at, &points, context) else { continue };
        let controlled = case.controls.iter().filter_map(|control| material.number_of(&control.of));
        let random = uncertain.iter().filter(|own| own.material == k).map(|own| own.number.as_str());
        let numbers: Vec<&str> = controlled.chain(random).collect();
        let (name, of) = (design::law_name(material), &material.region);
        let law = match numbers.is_empty() {
            true => material.law.build(&inputs),
            false => material.law.parametrised(&inputs, &numbers),
        };
        let added = law.map(|law| match (numbers.is_empty(), material.design.is_empty()) {
            (true, true) => attempt(solid, &material.at, context, |solid| solid.material(of, law)),
            _ => {
                if let Some(law) = design::in_front(case, law, &material.design, &points, context) {
                    attempt(solid, &material.at, context, |solid| solid.actuate(of, name, law));
                }
            }
        });
        added.unwrap_or_else(|error| {
            let named = |control: &&Control| match &error {
                EnergyError::NotLinear { name, .. } => material.number_of(&control.of) == Some(name),
                _ => false,
            };
            let random = |own: &&Uncertain| match &error {
                EnergyError::NotLinear { name, .. } => own.material == k && own.number == *name,
                _ => false,
            };
            let of = case.controls.iter().find(named).map(|control| control.at.key("of"));
            let of = of.or(uncertain.iter().find(random).map(|own| own.at.key("path")));
            complain_of_law(of.as_ref().unwrap_or(&material.at), &error, context);
        });
    }
    for (k, material) in case.materials.iter().enumerate() {
        let bare = (0..covered.len()).filter(|&cell| covered[cell].is_none() && reinforced[cell] == Some(k)).count();
        if bare > 0 {
            let name = material.law.name;
            let message = format!(
                "\"{name}\" adds to the law of a matrix, and {bare} of its cells have none: name their region with \
                 another law too, as \"neo_hooke\""
            );
            context.complain(&material.at.key("law"), message);
        }
    }
}

/// Regions that are rigid bodies, each under the name of its region.
pub(super) fn add_rigid(case: &Case, solid: &mut Solid, context: &mut Context<'_>) {
    for material in case.materials.iter().filter(|material| material.rigid) {
        let body = RigidBody::new(&material.region.to_string(), material.region.clone());
        attempt(solid, &material.at.key("rigid"), context, |solid| solid.rigid(&body));
        let cells: BTreeSet<u32> = solid.mesh().cells_of(&material.region).unwrap_or_default().into_iter().collect();
        let within = |own: &[u32]| !own.is_empty() && own.iter().all(|cell| cells.contains(cell));
        for own in solid.model().controllable().iter().filter(|own| own.cells.is_some_and(within)) {
            let message =
                format!("\"{}\" acts in this region alone, which does not strain: actuate another one", own.name);
            context.complain(&material.at.key("rigid"), message);
        }
    }
}

/// What the law of a control's number says to values of it, the other numbers of the material as they are written; nothing of a control of something else.
pub(super) fn refused(
    case: &Case,
    of: &str,
    values: [f64; 2],
    solid: &Solid,
    context: &mut Context<'_>,
) -> Option<EnergyError> {
    let material = case.materials.iter().find(|material| material.number_of(of).is_some())?;
    let number = material.number_of(of).filter(|number| material.parameters.contains_key(number))?;
    let inputs = inputs_of(case, material, solid, context)?;
    let finite = values.into_iter().filter(|value| value.is_finite());
    finite.map(|value| material.law.build(&inputs.clone().number(number, value))).find_map(Result::err)
}

fn inputs_of(case: &Case, material: &Material, solid: &Solid, context: &mut Context<'_>) -> Option<Inputs> {
    let cells = solid.mesh().cells_of(&material.region).ok()?;
    inputs(&material.parameters, &material.at, &SamplePoints::of_body(case, solid.discretization(), &cells), context)
}

/// Warns of bounds of several numbers of one law, each of which holds by itself, but not all ends together.
pub(super) fn warn_of_corners(case: &Case, fields: &[ControlField], solid: &Solid, context: &mut Context<'_>) {
    for material in &case.materials {
        let own = |control: &Control| {
            let number = material.number_of(&control.of).filter(|number| material.parameters.contains_key(number))?;
            match fields.iter().find(|field| field.at == control.at)?.admitted {
                Admitted::Between { lower, upper } if upper.is_finite() => Some((number.to_owned(), [lower, upper])),
                _ => None,
            }
        };
        let own: Vec<(String, [f64; 2])> = case.controls.iter().filter_map(own).collect();
        let Some(inputs) = inputs_of(case, material, solid, context).filter(|_| (2..=8).contains(&own.len())) else {
            continue;
        };
        let refused = |corner: usize| {
            let at: Vec<(&str, f64)> =
                own.iter().enumerate().map(|(k, (name, ends))| (name.as_str(), ends[corner >> k & 1])).collect();
            let given = at.iter().fold(inputs.clone(), |inputs, (name, value)| inputs.number(name, *value));
            let named = || at.iter().map(|(name, value)| format!("{name} = {}", short(*value))).collect::<Vec<_>>();
            material.law.build(&given).err().map(|error| (named().join(", "), error))
        };
        if let Some((named, error)) = (0..1 << own.len()).find_map(refused) {
            let message = format!("within the bounds of its controls, at {named}, its law does not hold: {error}");
            context.warn(&CONVEXITY, &material.at, message);
        }
    }
}

/// What keeps the parameters of a material from being one: `None` if nothing does, or something else is wrong with it.
pub(super) fn inadmissible(
    case: &Case,
    index: usize,
    disc: &Discretization,
    context: &mut Context<'_>,
) -> Option<EnergyError> {
    let material = case.materials.get(index)?;
    let cells = disc.mesh().cells_of(&material.region).ok()?;
    let points = SamplePoints::of_body(case, disc, &cells);
    let inputs = inputs(&material.parameters, &material.at, &points, context)?;
    material.law.build(&inputs).err()
}
