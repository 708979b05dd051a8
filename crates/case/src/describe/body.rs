//! Units, mesh, materials and supports in words.

use super::line::{Line, line};
use super::parameters::{catalogue_of, parameters};
use super::time;
use crate::lower::{CaseProblem, Elastic};
use nastic_language::number::{count, grouped, short, vector};
use nastic_language::quantity::Dimension;
use nastic_language::schema::Material;
use std::collections::BTreeSet;

/// The system of units.
pub fn units(problem: &CaseProblem) -> Vec<Line> {
    let units = problem.units();
    let (length, force, time, field) = (units.length(), units.force(), units.time(), units.field());
    let pressure = units.label(Dimension::PRESSURE);
    let text =
        format!("{}, {}, {}, {}; pressures in {pressure}", length.symbol, force.symbol, time.symbol, field.symbol);
    vec![line("units", text)]
}

/// Cells, sizes and quality of the mesh.
pub fn mesh(problem: &CaseProblem) -> Vec<Line> {
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

/// Its regions, surfaces and node sets.
pub fn groups(problem: &CaseProblem) -> Vec<Line> {
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

/// The passive laws, with what acts in motion.
pub fn materials(problem: &CaseProblem) -> Vec<Line> {
    let of = |material: &Material| {
        let units = problem.units();
        let values = parameters(&material.parameters, &catalogue_of(material.law.forms), units);
        let formulation = material.formulation.map(|chosen| format!("; formulation {chosen}")).unwrap_or_default();
        let formulation = formulation + &patches(problem, material);
        let formulation = formulation + if material.rigid { "; rigid" } else { "" };
        let formulation = material.design.iter().fold(formulation, |text, own| format!("{text}; design {own}"));
        let (region, law) = (&material.region, material.law);
        let inertia = at_rest(problem, material) + &time::inertia(material, units);
        line("materials", format!("{region}: {} ({}); {values}{formulation}{inertia}", law.name, law.about))
    };
    problem.case.materials.iter().map(of).collect()
}

/// Young's modulus and Poisson's ratio at small strains of all that acts on the region, where they are not what is given, are the same in all of it, and no law
/// has fibres.
fn at_rest(problem: &CaseProblem, material: &Material) -> String {
    if material.parameters.contains_key("young") || material.rigid || material.law.reinforcing {
        return String::new();
    }
    let (solid, unit) = (problem.solid(), problem.units().label(Dimension::PRESSURE));
    let (cells, points) =
        (solid.mesh().cells_of(&material.region).unwrap_or_default(), solid.discretization().points_of_cells());
    let isotropic = |cell: usize| Elastic::isotropic(solid, cell, points[cell].0);
    let first = cells.first().and_then(|cell| isotropic(*cell as usize));
    let same = |one: Elastic| first.is_some_and(|first| (one.young() / first.young() - 1.0).abs() < 1e-9);
    let elastic = first.filter(|_| cells.iter().all(|cell| isotropic(*cell as usize).is_some_and(same)));
    elastic.map_or_else(String::new, |elastic| {
        let [young, poisson] = [elastic.young(), elastic.poisson()]
            .map(|value| format!("{value:.4e}").parse().unwrap_or(value))
            .map(short);
        format!("; at small strains Young's modulus {young} {unit}, Poisson's ratio {poisson}")
    })
}

/// The patches that the formulation of a material takes together; nothing where it takes cells by themselves.
fn patches(problem: &CaseProblem, material: &Material) -> String {
    let cells = material.formulation.and_then(|_| problem.mesh().cells_of(&material.region).ok()).unwrap_or_default();
    let cells: BTreeSet<u32> = cells.into_iter().collect();
    let patches = problem.solid().body().patches();
    let own = patches.filter(|patch| patch.len() > 1 && patch.first().is_some_and(|first| cells.contains(first)));
    let sizes: Vec<usize> = own.map(|patch| patch.len()).collect();
    let (Some(least), Some(most)) = (sizes.iter().min(), sizes.iter().max()) else { return String::new() };
    let patches = if sizes.len() == 1 { "patch" } else { "patches" };
    format!(" over {} {patches} of {least} to {most} cells", grouped(sizes.len()))
}

/// What the supports hold, and the sum of dead loads.
pub fn supports(problem: &CaseProblem) -> Vec<Line> {
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
            match (solid.model().checks().is_held_without_contact(), solid.check().is_ok()) {
                (true, _) => "no rigid motion is free",
                (false, true) => "contact alone holds what they leave free",
                (false, false) => "rigid motions are free",
            }
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

/// The blocks that add a contribution each.
pub fn blocks(problem: &CaseProblem) -> Vec<Line> {
    let (solid, units) = (problem.solid(), problem.units());
    problem.case.blocks().map(|block| line(block.head(), block.words(solid, units))).collect()
}
