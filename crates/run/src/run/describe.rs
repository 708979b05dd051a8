//! A problem in words: what `nastic check` prints.

mod actuation;
mod contact;
mod conventions;
pub(crate) mod costs;
mod duration;
mod existence;
pub(crate) mod line;
mod members;
mod memory;
mod parameters;
mod shape_cost;
mod spring;
mod time;

use crate::result::controls::owner;
pub(super) use crate::run::describe::actuation::actuation;
pub(super) use crate::run::describe::contact::contacts;
pub(super) use crate::run::describe::conventions::conventions;
pub(super) use crate::run::describe::duration::duration;
pub(super) use crate::run::describe::existence::{conditions, existence};
use crate::run::describe::line::{Line, line};
pub(super) use crate::run::describe::members::{load_cases, scenarios};
pub(super) use crate::run::describe::memory::memory;
use crate::run::describe::parameters::{catalogue_of, law, parameters};
pub(super) use crate::run::describe::spring::springs;
pub(super) use crate::run::describe::time::time;
use nastic_case::lower::{Admitted, CaseProblem, ControlField, grid_cells};
use nastic_control::EnsembleBlock;
use nastic_fem::Formulation;
use nastic_language::number::{count, grouped, quantity, short, vector};
use nastic_language::quantity::Dimension;
use nastic_language::schema::Metric;
use nastic_mesh::CellKind;
use nastic_report::record::{CaseDescription, LawRecord, MeshRecord, QualityRecord, RunRecord, SetRecord, numbers};
use std::collections::{BTreeMap, BTreeSet};

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
    let of = |material: &nastic_language::schema::Material| {
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
fn patches(problem: &CaseProblem, material: &nastic_language::schema::Material) -> String {
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

/// The same for programs.
pub(super) fn describe(problem: &CaseProblem, record: &mut RunRecord) {
    let material = |m: &nastic_language::schema::Material| {
        let formulation = m.formulation.or((!m.law.reinforcing).then(Formulation::default));
        let formulation = formulation.map(|chosen| chosen.name().to_owned());
        LawRecord { formulation, ..law(problem, &m.region, m.law.name, &m.parameters, m.law.forms) }
    };
    let held = problem.solid().supports().fixed().iter().filter(|fixed| **fixed).count();
    let case = &problem.case;
    record.description = CaseDescription {
        mesh: Some(mesh_record(problem)),
        materials: Some(case.materials.iter().map(material).collect()),
        existence: Some(existence::records(problem)),
        actuation: Some(actuation::records(problem)),
        contact: (!case.contact.is_empty()).then(|| contact::records(problem)),
        springs: (!case.springs.is_empty()).then(|| spring::records(problem)),
        held_components: Some(held),
        memory: Some(memory::record(problem)),
        valid: Some(true),
    };
    let mut controls = crate::result::controls::controls(problem, &problem.start);
    for field in &problem.controls {
        if let Some(entry) = controls.get_mut(&field.name) {
            entry.fiber_limit = field.limit.into();
        }
    }
    record.controls = Some(controls);
    members::describe(problem, &mut record.state);
}

fn mesh_record(problem: &CaseProblem) -> MeshRecord {
    let (mesh, measures, quality) = (problem.mesh(), problem.mesh().measures(), problem.mesh().quality());
    let mut kinds = BTreeMap::<String, usize>::new();
    mesh.blocks()
        .iter()
        .for_each(|block| *kinds.entry(CellKind::name(block.kind).to_owned()).or_default() += block.len());
    let regions = mesh.regions().iter().map(|(name, cells)| {
        let measure = measures.regions.get(name).copied().into();
        (name.clone(), SetRecord { cells: Some(cells.len()), measure, ..SetRecord::default() })
    });
    let surfaces = mesh.surfaces().iter().map(|(name, facets)| {
        let measure = measures.surfaces.get(name).copied().into();
        (name.clone(), SetRecord { facets: Some(facets.len()), measure, ..SetRecord::default() })
    });
    let sets = mesh.node_sets().iter();
    let sets = sets.map(|(name, nodes)| (name.clone(), SetRecord { nodes: Some(nodes.len()), ..SetRecord::default() }));
    MeshRecord {
        name: mesh.name().to_owned(),
        dimensions: mesh.dim(),
        nodes: mesh.points().len(),
        cells: mesh.cells(),
        kinds: Some(kinds.into_iter().collect()),
        unknowns: problem.solid().discretization().dofs(),
        size: numbers(&measures.size),
        measure: measures.volume.into(),
        boundary: measures.boundary.into(),
        quality: QualityRecord {
            scaled_jacobian: quality.scaled_jacobian().into(),
            jacobian_ratio: quality.jacobian_ratio().into(),
            aspect: quality.aspect().into(),
            shortest_edge: quality.shortest_edge.into(),
            longest_edge: quality.longest_edge.into(),
        },
        regions: Some(regions.collect()),
        surfaces: Some(surfaces.collect()),
        node_sets: Some(sets.collect()),
    }
}
