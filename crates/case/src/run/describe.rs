//! A problem in words: what `nastic check` prints.

mod actuation;
mod conventions;
mod duration;
mod existence;
mod members;
mod memory;
mod shape_cost;
mod spring;
mod time;

pub(super) use actuation::actuation;
pub(super) use conventions::conventions;
pub(super) use duration::duration;
pub(super) use existence::{conditions, existence};
pub(super) use members::{load_cases, scenarios};
pub(super) use memory::memory;
use shape_cost::shape_cost;
pub(super) use spring::springs;
pub(super) use time::time;

use super::number::{count, grouped, quantity, short, vector};
use crate::expression::dimension_of;
use crate::lower::{Admitted, CaseProblem, ControlField, TargetShape, grid_cells};
use crate::quantity::{Dimension, Units};
use crate::result::summary::owner;
use crate::schema::{Constraint, Cost, HoldsWhen, Input, Metric, Parameter, Phi, Stage, Stages, VectorField};
use nastic_control::EnsembleBlock;
use nastic_energy::catalogue::{self, Takes};
use nastic_fem::Formulation;
use nastic_mesh::{CellKind, GroupNames};
use nastic_opt::Constrained;
use serde_json::{Map, Value, json};
use std::collections::{BTreeMap, BTreeSet};

/// A line under a heading.
pub(super) struct Line {
    pub head: &'static str,
    pub text: String,
}

fn line(head: &'static str, text: impl Into<String>) -> Line {
    Line { head, text: text.into() }
}

pub(super) fn units(problem: &CaseProblem) -> Vec<Line> {
    let units = problem.units();
    let (length, force, time, field) = (units.length(), units.force(), units.time(), units.field());
    let pressure = units.label(Dimension::PRESSURE);
    let text =
        format!("{}, {}, {}, {}; pressures in {pressure}", length.symbol, force.symbol, time.symbol, field.symbol);
    vec![line("units", text)]
}

pub(super) fn mesh(problem: &CaseProblem) -> Vec<Line> {
    let (mesh, measures) = (problem.mesh(), problem.mesh().measures());
    let kinds: Vec<String> =
        mesh.blocks().iter().map(|block| format!("{} {}", grouped(block.len()), block.kind)).collect();
    let unit = problem.units().length().symbol;
    let (volume, area, cube, square) = match mesh.dim() {
        2 => ("area", "boundary length", format!("{unit}^2"), unit.to_owned()),
        _ => ("volume", "boundary area", format!("{unit}^3"), format!("{unit}^2")),
    };
    let size: Vec<String> = measures.size[..mesh.dim()].iter().map(|s| short(*s)).collect();
    let quality = mesh.quality();
    vec![
        line("mesh", format!("{}: {}, {}", mesh.name(), kinds.join(" + "), count(mesh.points().len(), "node"))),
        line(
            "mesh",
            format!(
                "size {} {unit}, {volume} {} {cube}, {area} {} {square}",
                size.join(" x "),
                short(measures.volume),
                short(measures.boundary)
            ),
        ),
        line(
            "mesh",
            format!(
                "quality: scaled Jacobian >= {:.3} (1 is best), Jacobian ratio >= {:.3}, aspect <= {:.2}, edges {} to {} {unit}",
                quality.scaled_jacobian(),
                quality.jacobian_ratio(),
                quality.aspect(),
                short(quality.shortest_edge),
                short(quality.longest_edge)
            ),
        ),
    ]
}

pub(super) fn groups(problem: &CaseProblem) -> Vec<Line> {
    let (mesh, measures) = (problem.mesh(), problem.mesh().measures());
    let unit = problem.units().length().symbol;
    let d = mesh.dim();
    let measure = |value: f64, dim: usize| match dim {
        1 => format!("length {} {unit}", short(value)),
        2 => format!("area {} {unit}^2", short(value)),
        _ => format!("volume {} {unit}^3", short(value)),
    };
    let mut out = Vec::new();
    for (name, cells) in mesh.regions() {
        let size = measures.regions.get(name).copied().unwrap_or(f64::NAN);
        out.push(line("regions", format!("{name}: {}, {}", count(cells.len(), "cell"), measure(size, d))));
    }
    for (name, facets) in mesh.surfaces() {
        let size = measures.surfaces.get(name).copied().unwrap_or(f64::NAN);
        out.push(line("surfaces", format!("{name}: {}, {}", count(facets.len(), "facet"), measure(size, d - 1))));
    }
    for (name, nodes) in mesh.node_sets() {
        out.push(line("node sets", format!("{name}: {}", count(nodes.len(), "node"))));
    }
    out
}

pub(super) fn materials(problem: &CaseProblem) -> Vec<Line> {
    let of = |material: &crate::schema::Material| {
        let units = problem.units();
        let values = parameters(&material.parameters, &catalogue_of(material.law.forms), units);
        let formulation = material.formulation.map(|chosen| format!("; formulation {chosen}")).unwrap_or_default();
        let formulation = formulation + &patches(problem, material);
        let (region, law) = (&material.region, material.law);
        let inertia = time::inertia(material, units);
        line("materials", format!("{region}: {} ({}); {values}{formulation}{inertia}", law.name, law.about))
    };
    problem.case.materials.iter().map(of).collect()
}

/// The patches that the formulation of a material takes together; nothing where it takes cells by themselves.
fn patches(problem: &CaseProblem, material: &crate::schema::Material) -> String {
    let cells = material.formulation.and_then(|_| problem.mesh().cells_of(&material.region).ok()).unwrap_or_default();
    let cells: BTreeSet<u32> = cells.into_iter().collect();
    let patches = problem.solid().body().patches();
    let own = patches.filter(|patch| patch.len() > 1 && patch.first().is_some_and(|first| cells.contains(first)));
    let sizes: Vec<usize> = own.map(|patch| patch.len()).collect();
    let (Some(least), Some(most)) = (sizes.iter().min(), sizes.iter().max()) else { return String::new() };
    let patches = if sizes.len() == 1 { "patch" } else { "patches" };
    format!(" over {} {patches} of {least} to {most} cells", grouped(sizes.len()))
}

pub(super) fn controls(problem: &CaseProblem) -> Vec<Line> {
    let fields = problem.ensemble.blocks().iter().zip(&problem.controls);
    let of = |(place, field): (&EnsembleBlock, &ControlField)| {
        let (block, shared) = (owner(problem, place), problem.leads().nth(1).is_some() && field.load_case.is_none());
        let shared = if shared { ", shared by all load cases" } else { "" };
        let values = place.of(&problem.start);
        let (low, high) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(*x), h.max(*x)));
        let unit = &field.unit;
        let start = if low == high { short(low) } else { format!("{} to {}", short(low), short(high)) };
        let components =
            if block.components > 1 { format!(" of {} components", block.components) } else { String::new() };
        let unknowns = count(block.basis.len(), "unknown");
        let admitted = admitted(field);
        let knots = time::knots(problem, block, &field.array);
        let grid =
            block.basis.grid().map(|grid| format!(" of {} cells", grid_cells(grid.cells(), problem.mesh().dim())));
        line(
            "controls",
            format!(
                "{}: by {}{}{knots}, {unknowns}{components}, start {start} {unit}, {admitted}{shared}",
                field.name,
                block.basis.space().name(),
                grid.unwrap_or_default()
            ),
        )
    };
    fields.map(of).collect()
}

fn admitted(field: &ControlField) -> String {
    let unit = &field.unit;
    match field.admitted {
        Admitted::Between { lower, upper } => format!("within [{}, {}] {unit}", short(lower), short(upper)),
        Admitted::Norm(norm) => format!("of length {} {unit}", short(norm)),
        Admitted::MaxNorm(most) => format!("no longer than {} {unit}", short(most)),
        Admitted::Any => "unbounded".to_owned(),
    }
}

pub(super) fn supports(problem: &CaseProblem) -> Vec<Line> {
    let (solid, units) = (problem.solid(), problem.units());
    let held: Vec<usize> =
        (0..).zip(solid.supports().fixed()).filter(|(_, fixed)| **fixed).map(|(dof, _)| dof).collect();
    let moved = held.iter().filter(|dof| !solid.supports().holds_at_rest(**dof)).count();
    let total = solid.discretization().dofs();
    let mut out = vec![line(
        "supports",
        format!(
            "{} of {} displacement components held, {} of them moved; {}",
            grouped(held.len()),
            grouped(total),
            grouped(moved),
            if solid.check().is_ok() { "no rigid motion is free" } else { "rigid motions are free" }
        ),
    )];
    if !problem.case.loads.is_empty() {
        let dim = problem.mesh().dim();
        let mut sum = [0.0; 3];
        solid.dead_load().iter().enumerate().for_each(|(dof, force)| sum[dof % dim] += force);
        let text = format!(
            "{}; total force {} {}",
            count(problem.case.loads.len(), "dead load"),
            vector(&sum[..dim]),
            units.force().symbol
        );
        out.push(line("loads", text));
    }
    out
}

pub(super) fn costs(problem: &CaseProblem) -> Vec<Line> {
    let mut out: Vec<Line> = problem.case.costs.iter().map(|cost| cost_line("costs", cost)).collect();
    let reduced = problem.member(0).reduced();
    for (k, (block, group)) in problem.case.constraints.iter().zip(reduced.constraints()).enumerate() {
        let instants = reduced.constraint_states(k).len().max(1);
        let bound = match (&block.obstacle, block.at_most, block.equal) {
            (Some(keep_out), ..) => format!(
                "{} at least {} {} from a {}",
                count(group.len / instants, "node"),
                short(keep_out.clearance),
                problem.units().length().symbol,
                keep_out.shape.name().replace('_', "-")
            ),
            (None, Some(most), _) => format!("at most {}", short(most)),
            (None, None, value) => format!("equal to {}", short(value.unwrap_or_default())),
        };
        let when = problem
            .case
            .time
            .as_ref()
            .map_or_else(String::new, |_| format!(", {}", instants_of(block, instants, problem.lacks_steps())));
        out.push(line("constraints", format!("{}: {bound}{when}", block.name())));
    }
    for target in problem.member(0).targets() {
        out.push(target_line(problem, target));
    }
    out
}

/// At which instants a constraint of a motion holds.
fn instants_of(block: &Constraint, count_of: usize, lacks_steps: bool) -> String {
    match &block.when {
        // how many there are is not known yet
        Some(HoldsWhen::Always) if lacks_steps => "at every instant".to_owned(),
        None if lacks_steps && block.obstacle.is_some() => "at every instant".to_owned(),
        _ => format!("at {}", count(count_of, "instant")),
    }
}

/// A term of the cost.
fn cost_line(head: &'static str, cost: &Cost) -> Line {
    let text = match cost {
        Cost::SmoothedHausdorff(block) => {
            let stages = match &block.stages {
                Stages::Auto => "automatic stages".to_owned(),
                Stages::List(stages) => {
                    let of = |s: &Stage| format!("({}, {}, {})", short(s.alpha), short(s.beta), short(s.gamma));
                    format!("(alpha, beta, gamma) = {}", stages.iter().map(of).collect::<Vec<_>>().join(" then "))
                }
            };
            format!("phi {}, {stages}", phi(&block.phi))
        }
        Cost::Tracking(block) => {
            let place = block.surface.as_ref().or(block.region.as_ref()).or(block.nodes.as_ref());
            format!("weight/2 int |x - x_target|^2 on {}", place.map(ToString::to_string).unwrap_or_default())
        }
        Cost::Position(_)
        | Cost::Orientation(_)
        | Cost::Curvature(_)
        | Cost::LargestStretch(_)
        | Cost::Compliance(_) => shape_cost(cost),
        Cost::Obstacle(block) => {
            let place = block.surface.as_ref().or(block.region.as_ref()).or(block.nodes.as_ref());
            let place = place.map(ToString::to_string).unwrap_or_default();
            format!("weight/2 int max(0, {} - d)^2 on {place}, d from a {}", short(block.clearance), block.shape.name())
        }
        Cost::ControlNorm(block) => format!("weight/2 int {}^2", block.of),
        Cost::ControlSmoothness(block) => format!("weight/2 int |grad {}|^2", block.of),
        Cost::ControlRate(block) => format!("weight/2 int int |d{}/dt|^2", block.of),
        Cost::KineticEnergy(_) => "kinetic energy of the body".to_owned(),
        Cost::ActuationWork(_) => "work that the actuations do".to_owned(),
        Cost::Added(block) => block.row.about.to_owned(),
    };
    let (name, kind) = (cost.name(), cost.kind());
    let name = if name == kind { name.to_owned() } else { format!("{name} ({kind})") };
    line(head, format!("{name}: {text}, weight {}{}", short(cost.weight()), time::when(cost.when())))
}

/// A shape that a term aims at.
fn target_line(problem: &CaseProblem, target: &TargetShape) -> Line {
    let unit = problem.units().length().symbol;
    if target.displacement.is_empty() {
        let size: Vec<String> = target.mesh.size()[..target.mesh.dim()].iter().map(|s| short(*s)).collect();
        let cells = count(target.mesh.cells(), "cell");
        return line(
            "targets",
            format!("{}: {} ({cells}), size {} {unit}", target.cost, target.mesh.name(), size.join(" x ")),
        );
    }
    let n = target.displacement.iter().filter(|(_, matters)| *matters).count();
    let length = |u: &[f64; 3]| u.iter().map(|x| x * x).sum::<f64>().sqrt();
    let far = target.displacement.iter().map(|(u, _)| length(u)).fold(0.0, f64::max);
    line("targets", format!("{}: {} to be moved by up to {} {unit}", target.cost, count(n, "node"), short(far)))
}

fn phi(phi: &Phi) -> String {
    match phi {
        Phi::Exponential(block) => match (block.length, block.fraction) {
            (Some(length), _) => format!("exp(-r/{})", short(length)),
            (None, Some(fraction)) => format!("exp(-r/l), l {} of the target's diagonal", short(fraction)),
            (None, None) => "exp(-r/l)".to_owned(),
        },
        Phi::Inverse(block) => format!("1/(r + {})", short(block.eps)),
        Phi::SmoothInverse(block) => format!("1/sqrt(r^2 + {}^2)", short(block.eps)),
    }
}

pub(super) fn optimizer(problem: &CaseProblem) -> Vec<Line> {
    if problem.start.is_empty() || !problem.has_costs() {
        return vec![];
    }
    let block = &problem.case.optimizer;
    let metric = match block.metric {
        Metric::L2 => "L2 (lumped)".to_owned(),
        Metric::H1(length) => format!("H1 of length {}", quantity(length, Dimension::LENGTH, problem.units())),
    };
    let text = format!(
        "{}, at most {} iterations, tolerance {}{} on the projected gradient, metric {metric}",
        block.method.name(),
        block.max_iterations,
        short(block.tolerance),
        if block.absolute_tolerance > 0.0 {
            format!(" (absolute {})", short(block.absolute_tolerance))
        } else {
            String::new()
        }
    );
    vec![line("optimizer", text)]
}

/// The parameters of all forms by name.
fn catalogue_of(forms: &'static [&'static [catalogue::Parameter]]) -> BTreeMap<&'static str, Dimension> {
    let dimension = |p: &catalogue::Parameter| match p.takes {
        Takes::Number { unit, .. } => dimension_of(unit).unwrap_or(Dimension::NONE),
        Takes::Direction { .. } | Takes::Choice { .. } | Takes::Name { .. } => Dimension::NONE,
    };
    forms.iter().copied().flatten().map(|p| (p.name, dimension(p))).collect()
}

fn parameters(
    inputs: &BTreeMap<&'static str, Input>,
    dimensions: &BTreeMap<&'static str, Dimension>,
    units: &Units,
) -> String {
    let of = |(name, input): (&&'static str, &Input)| {
        let value = match input {
            Input::Number(value) => scalar(value, dimensions.get(name).copied().unwrap_or(Dimension::NONE), units),
            Input::Direction(value) => vector_field(value),
            Input::Word(word) => (*word).to_owned(),
            Input::Name(place) => place.clone(),
        };
        format!("{name} {value}")
    };
    inputs.iter().map(of).collect::<Vec<_>>().join(", ")
}

fn scalar(value: &Parameter, dimension: Dimension, units: &Units) -> String {
    match value {
        Parameter::Formula(formula) => match formula.constant() {
            Some(value) => quantity(value, dimension, units),
            None => format!("\"{}\"", formula.text()),
        },
        Parameter::Array(file) => format!("array {} of {}", file.array, file.file),
        Parameter::Cells(_) => "by cell".to_owned(),
    }
}

fn vector_field(value: &VectorField) -> String {
    match (value.constant(), value) {
        (Some(constant), _) => vector(&constant),
        (None, VectorField::Formulas(entries)) => {
            let texts: Vec<String> = entries.iter().map(|entry| format!("\"{}\"", entry.text())).collect();
            format!("({})", texts.join(", "))
        }
        (None, VectorField::Array(file)) => format!("array {} of {}", file.array, file.file),
    }
}

/// The same for programs.
pub(super) fn json(problem: &CaseProblem) -> Map<String, Value> {
    let (mesh, measures, quality) = (problem.mesh(), problem.mesh().measures(), problem.mesh().quality());
    let kinds: BTreeMap<&str, usize> = mesh.blocks().iter().fold(BTreeMap::new(), |mut kinds, block| {
        *kinds.entry(CellKind::name(block.kind)).or_default() += block.len();
        kinds
    });
    let regions: Map<String, Value> = mesh
        .regions()
        .iter()
        .map(|(name, cells)| (name.clone(), json!({ "cells": cells.len(), "measure": measures.regions.get(name) })))
        .collect();
    let surfaces: Map<String, Value> = mesh
        .surfaces()
        .iter()
        .map(|(name, facets)| (name.clone(), json!({ "facets": facets.len(), "measure": measures.surfaces.get(name) })))
        .collect();
    let sets: Map<String, Value> =
        mesh.node_sets().iter().map(|(name, nodes)| (name.clone(), json!({ "nodes": nodes.len() }))).collect();
    let mut out = Map::new();
    out.insert(
        "mesh".into(),
        json!({
            "name": mesh.name(), "dimensions": mesh.dim(), "nodes": mesh.points().len(), "cells": mesh.cells(),
            "kinds": kinds, "unknowns": problem.solid().discretization().dofs(), "size": measures.size,
            "measure": measures.volume, "boundary": measures.boundary,
            "quality": {
                "scaled_jacobian": quality.scaled_jacobian(), "jacobian_ratio": quality.jacobian_ratio(),
                "aspect": quality.aspect(), "shortest_edge": quality.shortest_edge, "longest_edge": quality.longest_edge,
            },
            "regions": regions, "surfaces": surfaces, "node_sets": sets,
        }),
    );
    out.insert(
        "materials".into(),
        problem
            .case
            .materials
            .iter()
            .map(|m| {
                let mut entry = law(problem, &m.region, m.law.name, &m.parameters, m.law.forms);
                if let Some(formulation) = m.formulation.or((!m.law.reinforcing).then(Formulation::default)) {
                    entry["formulation"] = json!(formulation.name());
                }
                entry
            })
            .collect(),
    );
    out.insert("existence".into(), existence::json(problem));
    out.insert("actuation".into(), actuation::json(problem));
    if !problem.case.springs.is_empty() {
        out.insert("springs".into(), spring::json(problem));
    }
    out.insert("controls".into(), crate::result::summary::controls(problem, &problem.start));
    for (field, block) in problem.controls.iter().zip(problem.ensemble.blocks()) {
        if let Some(entry) = out.get_mut("controls").and_then(|controls| controls.get_mut(&field.name)) {
            entry["space"] = json!(owner(problem, block).basis.space().name());
            entry["unit"] = json!(field.unit);
            entry["fiber_limit"] = json!(field.limit);
            if let Admitted::Between { lower, upper } = field.admitted {
                entry["lower"] = json!(lower);
                entry["upper"] = json!(upper);
            }
        }
    }
    let held = problem.solid().supports().fixed().iter().filter(|fixed| **fixed).count();
    out.insert("held_components".into(), json!(held));
    out.insert("memory".into(), memory::json(problem));
    out.extend(members::json(problem));
    out
}

/// A law with its constants in the case's units and in SI.
fn law(
    problem: &CaseProblem,
    region: &GroupNames,
    name: &str,
    inputs: &BTreeMap<&'static str, Input>,
    forms: &'static [&'static [catalogue::Parameter]],
) -> Value {
    let dimensions = catalogue_of(forms);
    let units = problem.units();
    let of = |(name, input): (&&'static str, &Input)| {
        let dimension = dimensions.get(name).copied().unwrap_or(Dimension::NONE);
        let value = match input {
            Input::Number(value) => match value.constant() {
                Some(constant) => {
                    json!({ "value": constant, "unit": units.label(dimension), "si": units.in_si(constant, dimension) })
                }
                None => json!({ "varies": scalar(value, dimension, units) }),
            },
            Input::Direction(value) => match value.constant() {
                Some(constant) => json!(constant),
                None => json!({ "varies": vector_field(value) }),
            },
            Input::Word(word) => json!(word),
            Input::Name(place) => json!(place),
        };
        ((*name).to_owned(), value)
    };
    let values: Map<String, Value> = inputs.iter().map(of).collect();
    json!({ "region": names(region), "law": name, "parameters": values })
}

/// A name, or a list of several.
fn names(names: &GroupNames) -> Value {
    let list: Vec<&str> = names.iter().collect();
    if let [one] = list.as_slice() { json!(one) } else { json!(list) }
}
