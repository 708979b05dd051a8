//! Designs: numbers in front of laws, and what else follows the fields that give them.

use super::context::Context;
use super::control_field::ControlField;
use super::field::SamplePoints;
use super::law_inputs::inputs;
use nastic_control::{Consumer, Cost, CostContext, DesignMean, PowerLaw, Reduced};
use nastic_energy::{EnergyError, EnergyTerm, Weighted};
use nastic_fem::{BodyInertia, Solid};
use nastic_language::number::short;
use nastic_language::schema::{Case, Constraint, Control, Design, DesignKind, Load, Material, MixedLaw};
use nastic_language::syntax::{At, quoted};
use std::sync::Arc;

/// The name under which a body has the law of a material with slots.
pub(super) fn law_name(material: &Material) -> &str {
    material.name.as_deref().unwrap_or(material.at.as_str())
}

/// What the weight of a material that follows a design is called in messages: no other block has its place.
pub(super) fn weight_name(load: &Load, material: &Material) -> String {
    format!("gravity on a design, {}, {}", load.at, material.at)
}

/// A law with its numbers in front, each in front of those before it; `None` after a complaint.
pub(super) fn in_front(
    case: &Case,
    law: Arc<dyn EnergyTerm>,
    designs: &[Design],
    points: &SamplePoints<'_>,
    context: &mut Context<'_>,
) -> Option<Arc<dyn EnergyTerm>> {
    designs.iter().try_fold(law, |law, design| {
        let made = match (design.scale(), &design.with) {
            (Some(scale), _) => Weighted::scaled(&design.name, law, scale),
            (None, Some(with)) => Weighted::mixture(&design.name, law, other_law(case, with, design, points, context)?),
            // complained about when the block was read
            (None, None) => return None,
        };
        let at = made.as_ref().err().map_or_else(|| design.at.clone(), |error| key_of(&design.at, error));
        context.take(&at, made).map(|own| Arc::new(own) as Arc<dyn EnergyTerm>)
    })
}

/// The key of a design that an error of its factor speaks of.
fn key_of(at: &At, error: &EnergyError) -> At {
    match error {
        EnergyError::Parameter { name: "floor", .. } => at.key("least"),
        EnergyError::Parameter { name: "exponent" | "penalty", .. } => at.key("power"),
        _ => at.clone(),
    }
}

fn other_law(
    case: &Case,
    with: &MixedLaw,
    design: &Design,
    points: &SamplePoints<'_>,
    context: &mut Context<'_>,
) -> Option<Arc<dyn EnergyTerm>> {
    let (row, parameters, at) = match with {
        MixedLaw::Name(_) => {
            let other = named_material(case, with)?;
            (other.law, &other.parameters, other.at.clone())
        }
        MixedLaw::Law(own) => (own.law, &own.parameters, own.at.clone()),
    };
    let inputs = inputs(parameters, &at, points, context)?;
    context.take(&design.at.key("with"), row.build(&inputs))
}

fn named_material<'c>(case: &'c Case, with: &MixedLaw) -> Option<&'c Material> {
    let MixedLaw::Name(name) = with else { return None };
    case.materials.iter().find(|material| material.name.as_ref() == Some(name))
}

/// How the mass of a material follows a design; `None` where it does not.
pub(super) fn mass_map(case: &Case, material: &Material) -> Option<(String, PowerLaw)> {
    let own = material.density?;
    let design = material.design.iter().find(|design| Material::follows(design, &case.materials))?;
    let map = match &design.with {
        None => PowerLaw::multiple_of(1.0),
        Some(_) => PowerLaw { low: 1.0, high: Material::other_density(design, &case.materials)? / own, exponent: 1.0 },
    };
    Some((design.name.clone(), map))
}

/// Complains of masses that follow a design on cells where another material has a mass too.
pub(super) fn check_masses(case: &Case, solid: &Solid, context: &mut Context<'_>) {
    let mesh = solid.mesh().clone();
    let cells = |material: &Material| mesh.cells_of(&material.region).unwrap_or_default();
    for (k, material) in case.materials.iter().enumerate().filter(|(_, own)| mass_map(case, own).is_some()) {
        let own = cells(material);
        let others = case.materials.iter().enumerate().filter(|(j, other)| *j != k && other.density.is_some());
        let shares = |other: &Material| cells(other).iter().any(|cell| own.binary_search(cell).is_ok());
        if let Some((_, other)) = others.into_iter().find(|(_, other)| shares(other)) {
            let message = format!(
                "the mass follows a design, and {} has a mass on the same cells: say \"mass\": false of the design, or leave one of the densities out",
                other.at
            );
            context.complain(&material.at.key("density"), message);
        }
    }
}

/// All that follows from a design.
pub(super) fn consumers(case: &Case, name: &str) -> Vec<Consumer> {
    let has = |designs: &[Design]| designs.iter().any(|design| design.name == name);
    let mut all = Vec::new();
    for material in case.materials.iter().filter(|material| has(&material.design)) {
        all.push(Consumer::of(&format!("{}.{name}", law_name(material))));
    }
    for actuation in case.actuation.iter().filter(|actuation| has(actuation.design())) {
        all.push(Consumer::of(&format!("{}.{name}", actuation.name)));
    }
    for material in &case.materials {
        let Some((_, map)) = mass_map(case, material).filter(|(of, _)| of == name) else { continue };
        all.push(Consumer::of(BodyInertia::FILLED).within(&material.region).through(map));
        for load in case.loads.iter().filter(|load| load.gravity.is_some()) {
            all.push(Consumer::of(&weight_name(load, material)).through(map));
        }
    }
    all
}

/// The least and the largest value that all laws behind a design admit; `None` of a control of something else.
pub(super) fn range(case: &Case, of: &str) -> Option<[f64; 2]> {
    let ranges = case.designs().filter(|design| design.name == of).map(Design::range);
    ranges.reduce(|[low, high], own| [low.max(own[0]), high.min(own[1])])
}

/// Whether a value is one at which all laws behind a design are defined: at the end of a filler's range the body would be rigid.
pub(super) fn admits(case: &Case, of: &str, value: f64) -> bool {
    let mut own = case.designs().filter(|design| design.name == of);
    own.all(|design| {
        let [low, high] = design.range();
        (low..=high).contains(&value) && design.scale().is_none_or(|scale| scale.is_defined(value))
    })
}

/// Complains of bounds of a design beyond its range, and of a filler without an upper one.
pub(super) fn check_bounds(
    case: &Case,
    control: &Control,
    given: [Option<f64>; 2],
    [low, high]: [f64; 2],
    context: &mut Context<'_>,
) -> Option<()> {
    let is_filler = |own: &Design| own.name == control.of && own.kind == DesignKind::Filler;
    let below = if case.designs().any(is_filler) { ", below which a filler stays" } else { "" };
    for (key, value) in ["lower", "upper"].into_iter().zip(given) {
        if let Some(value) = value.filter(|value| !admits(case, &control.of, *value)) {
            let message = format!("{value} lies outside what this design may be, {low} to {high}{below}");
            context.complain(&control.at.key(key), message);
            return None;
        }
    }
    if given[1].is_none() && case.designs().any(is_filler) {
        let message = format!("a filler needs an \"upper\" bound, below {high}: how dense its particles can lie");
        context.complain(&control.at, message);
        return None;
    }
    Some(())
}

/// Complains of means of what is no scalar field of the body, and of the greyness of what does not go from 0 to 1.
pub(super) fn check_means(case: &Case, reduced: &Reduced, context: &mut Context<'_>) {
    let rest = reduced.solid().rest();
    let costs = case.costs.iter().chain(case.constraints.iter().filter_map(|block| block.cost.as_ref()));
    for term in costs.filter_map(|cost| cost.term()).filter(|term| [VOLUME, GREYNESS].contains(&term.form.name)) {
        let control = case.controls.iter().find(|control| Some(control.name()) == term.control());
        let Some(of) = control.map(|control| control.of.as_str()) else { continue };
        let Ok(cost) = DesignMean::volume(of, 1.0) else { continue };
        let zeros = vec![0.0; reduced.layout_of_instant().len()];
        let is_filler = |own: &Design| own.kind == DesignKind::Filler;
        if let Err(error) = cost.at(&of_controls(reduced, &rest.u, &zeros)) {
            context.complain(&term.at.key("of"), error.to_string());
        } else if term.form.name == GREYNESS && !case.designs().any(|own| own.name == of && !is_filler(own)) {
            let message = format!("grey is what lies between 0 and 1, and {} does not go from 0 to 1", quoted(of));
            context.complain(&term.at.key("of"), message);
        }
    }
}

const VOLUME: &str = "design_volume";
const GREYNESS: &str = "greyness";

/// Where costs of the controls alone are evaluated.
fn of_controls<'a>(reduced: &'a Reduced, u: &'a [f64], m: &'a [f64]) -> CostContext<'a> {
    CostContext { solid: reduced.solid(), layout: reduced.layout_of_instant(), u, state: None, m, stage: 0, step: None }
}

/// Volumes below this share of a bound are rounding.
const ROUNDING: f64 = 1e-9;

/// Complains of bounds on the volume of a design that no values between its bounds meet.
pub(super) fn check_volumes(case: &Case, fields: &[ControlField], reduced: &Reduced, context: &mut Context<'_>) {
    let (rest, layout) = (reduced.solid().rest(), reduced.layout_of_instant());
    let volumes = case.constraints.iter().filter_map(|block| {
        let term = block.cost.as_ref().filter(|cost| cost.kind() == VOLUME)?.term()?;
        let control = case.controls.iter().find(|control| Some(control.name()) == term.control())?;
        Some((block, term.weight, control.of.as_str()))
    });
    for (block, weight, of) in volumes {
        let (Ok(cost), Ok(own)) = (DesignMean::volume(of, weight), layout.block(of)) else { continue };
        let Some(bounds) = fields.iter().find_map(|field| field.bounds.as_ref().filter(|_| of_block(case, field, of)))
        else {
            continue;
        };
        let volume = |upper: bool| {
            let mut m = vec![0.0; layout.len()];
            let values = (0..own.size()).map(|i| if upper { bounds.at(i).1 } else { bounds.at(i).0 });
            m[own.first..own.first + own.size()].iter_mut().zip(values).for_each(|(m, value)| *m = value);
            cost.at(&of_controls(reduced, &rest.u, &m))
                .ok()
                .map(|point| point.value())
                .filter(|value| value.is_finite())
        };
        complain_of_volume(block, [volume(false), volume(true)], context);
    }
}

fn of_block(case: &Case, field: &ControlField, of: &str) -> bool {
    case.controls.iter().any(|control| control.at == field.at && control.of == of)
}

fn complain_of_volume(block: &Constraint, [least, most]: [Option<f64>; 2], context: &mut Context<'_>) {
    let above =
        |bound: f64| least.filter(|least| bound < least - ROUNDING * least.abs()).map(|least| ("at least", least));
    let below = |bound: f64| most.filter(|most| bound > most + ROUNDING * most.abs()).map(|most| ("at most", most));
    let (key, bound, beyond) = match (block.at_most, block.at_least, block.equal) {
        (Some(bound), ..) => ("at_most", bound, above(bound)),
        (_, Some(bound), _) => ("at_least", bound, below(bound)),
        (_, _, Some(bound)) => ("equal", bound, above(bound).or(below(bound))),
        _ => return,
    };
    if let Some((side, value)) = beyond {
        let message = format!(
            "{} cannot be met: with what is fixed and the bounds of {} the volume is {side} {}",
            short(bound),
            quoted(block.name()),
            short(value)
        );
        context.complain(&block.at.key(key), message);
    }
}
