//! Sizes that look like another unit was meant.

use super::context::Context;
use super::elements::Elastic;
use super::magnitude;
use crate::lower::target_shape::TargetShape;
use crate::warning::UNITS;
use nastic_fem::Solid;
use nastic_language::number::{count, short};
use nastic_language::quantity::{Dimension, Units};
use nastic_language::schema::{Case, Cost, Material, MeshSource, Shape, ShapeOrName};
use nastic_language::syntax::At;
use nastic_mesh::Mesh;

/// Soft bodies longer than this are rare, millimetres taken for metres are not.
const LARGE: f64 = 10.0;
/// Body and target that differ by this much were hardly drawn in one unit.
const APART: f64 = 50.0;
/// The same of obstacles, which may be a bead or the floor.
const OBSTACLE_APART: f64 = 100.0;

/// Young's moduli of silicones, gels and tissue, 1 kPa to 20 MPa, in Pa; the ends are among them whatever the rounding.
pub(super) const SOFT: std::ops::RangeInclusive<f64> = 0.999e3..=2.001e7;

/// Young's modulus, Pa, above that of all metals (tungsten has 4.1e11) and of what else bodies are made of.
const HARDEST: f64 = 4.5e11;

/// Materials softer than any silicone or harder than any metal, and bodies of which no part is soft: mostly kPa and Pa were mixed.
pub(super) fn check_moduli(case: &Case, solid: &Solid, context: &mut Context<'_>) {
    let points = solid.discretization().points_of_cells();
    let young = |cell: &u32| {
        let elastic = Elastic::of(solid, *cell as usize, points[*cell as usize].0)?;
        Some(context.units.in_si(elastic.young(), Dimension::PRESSURE))
    };
    let of = |material: &Material| {
        let cells = solid.mesh().cells_of(&material.region).ok()?;
        cells.iter().map(young).collect::<Option<Vec<f64>>>()?.into_iter().reduce(f64::min)
    };
    let moduli: Vec<Option<f64>> = case.materials.iter().map(of).collect();
    let stiff = moduli.iter().all(|young| young.is_some_and(|young| young > *SOFT.end()));
    // a reinforcement adds to the law of a matrix, which is looked at
    for (material, young) in case.materials.iter().zip(&moduli).filter(|(material, _)| !material.law.reinforcing) {
        let unusual = |young: &f64| stiff || young < SOFT.start() || *young > HARDEST;
        let Some(young) = young.filter(unusual) else { continue };
        let message = format!(
            "Young's modulus is {} Pa where silicones, gels and tissue have 1 kPa to 20 MPa{}",
            short(young),
            magnitude::likely(young, &SOFT, "Pa")
        );
        context.warn(&UNITS, &material.at, message);
    }
}

/// Poisson's ratios below this are no rounding of zero.
const NEGATIVE: f64 = -1e-2;

/// Materials that grow thicker when they are pulled: mostly a bulk modulus in another unit than the others.
pub(super) fn check_poissons_ratios(case: &Case, solid: &Solid, context: &mut Context<'_>) {
    let points = solid.discretization().points_of_cells();
    let unit = context.units.label(Dimension::PRESSURE);
    let is_meant = |material: &Material| material.law.reinforcing || material.parameters.contains_key("poisson");
    for material in case.materials.iter().filter(|material| !is_meant(material)) {
        let Ok(cells) = solid.mesh().cells_of(&material.region) else { continue };
        let elastic = |cell: &u32| Elastic::of(solid, *cell as usize, points[*cell as usize].0);
        let Some(least) = cells.iter().filter_map(elastic).min_by(|a, b| a.poisson().total_cmp(&b.poisson())) else {
            continue;
        };
        if least.poisson() < NEGATIVE {
            let message = format!(
                "Poisson's ratio at small strains is {}: the bulk modulus, {} {unit}, is below 2/3 of the shear modulus, {} {unit}. Silicones \
                 have 0.45 to 0.5, foams 0 to 0.3: is the bulk modulus in the unit of the others?",
                short((1e4 * least.poisson()).round() / 1e4),
                short(least.bulk()),
                short(least.shear())
            );
            context.warn(&UNITS, &material.at, message);
        }
    }
}

/// What is so many times as stiff as the body holds it rigidly.
const RIGID: f64 = 1e6;

/// Warns of foundations and other blocks beside which the body has no stiffness, and of their values in another unit.
pub(super) fn check_stiffness(case: &Case, solid: &Solid, context: &mut Context<'_>) {
    let (mesh, points) = (solid.mesh(), solid.discretization().points_of_cells());
    let young = |(cell, (point, _)): (usize, &(usize, usize))| Some(Elastic::of(solid, cell, *point)?.young());
    let stiffest = points.iter().enumerate().map(young).try_fold(0.0, |most: f64, young| Some(most.max(young?)));
    let Some(stiffest) = stiffest.filter(|young| *young > 0.0) else { return };
    let size = mesh.diagonal();
    let stiff = |ratio: f64, at: At, what: &str, context: &mut Context<'_>| {
        if ratio > RIGID {
            let message = format!(
                "{what} is {} times as stiff as a cube of the body's stiffest material and size: is its unit right? To hold the body, \
                 fix it",
                short(ratio)
            );
            context.warn(&UNITS, &at, message);
        }
    };
    for support in &case.supports {
        if let Some(stiffness) = support.foundation {
            stiff(stiffness * size / stiffest, support.at.key("foundation"), "this foundation", context);
        }
    }
    // of a plane body stiffness is per unit of thickness
    let of_size = if mesh.dim() == 2 { 1.0 } else { size };
    for block in case.blocks() {
        if let Some(stiffness) = block.stiffness() {
            let what = format!("this {}", block.kind());
            stiff(stiffness / (stiffest * of_size), block.at().key("stiffness"), &what, context);
        }
        if let Some((key, message)) = block.doubt(solid, &context.units) {
            context.warn(&UNITS, &block.at().key(key), message);
        }
    }
}

pub(super) fn check(case: &Case, mesh: &Mesh, targets: &[Option<TargetShape>], context: &mut Context<'_>) {
    let at = super::mesh::at(case);
    let unit = context.units.length().symbol;
    if let Some(large) = large(mesh, context.units) {
        let message = format!(
            "{large}: if {} is drawn in millimetres, write \"mesh\": {{ \"file\": ..., \"scale\": \
             1e-3 }}, or \"units\": \"mm\"",
            mesh.name()
        );
        context.warn(&UNITS, &at, message);
    }
    for target in targets.iter().flatten() {
        let ratio = target.mesh.diagonal() / mesh.diagonal();
        if !(1.0 / APART..=APART).contains(&ratio) {
            let (body, aim) = (show(mesh, unit), show(&target.mesh, unit));
            let message = format!(
                "the body measures {body}, this target {aim}: are both drawn in the same unit? Give the \"scale\" of one"
            );
            context.warn(&UNITS, &target.at.key("target"), message);
        }
    }
}

/// Reports the sizes of obstacles that are meshes, which show in no other place, and warns of those in another unit.
pub(super) fn check_obstacles(case: &Case, mesh: &Mesh, context: &mut Context<'_>) {
    let unit = context.units.length().symbol;
    for source in obstacles(case) {
        let at = super::mesh::place(source);
        let Some(obstacle) = super::mesh::load(source, &at, context) else { continue };
        let size: Vec<String> = obstacle.size()[..obstacle.dim()].iter().map(|s| short(*s)).collect();
        let cells = count(obstacle.cells(), "cell");
        context.note(format!("obstacle {}: {cells}, size {} {unit}", obstacle.name(), size.join(" x ")));
        let ratio = obstacle.diagonal() / mesh.diagonal();
        if !(1.0 / OBSTACLE_APART..=OBSTACLE_APART).contains(&ratio) {
            let message = format!(
                "the body measures {}, this obstacle {}: are both drawn in the same unit? Give the \"scale\" of one",
                show(mesh, unit),
                show(&obstacle, unit)
            );
            context.warn(&UNITS, &at, message);
        }
    }
}

/// The meshes of obstacles, of a list of their own and in costs and constraints.
fn obstacles(case: &Case) -> impl Iterator<Item = &MeshSource> {
    let bounded = case.constraints.iter().filter_map(|block| block.cost.as_ref());
    let of_costs = case.costs.iter().chain(bounded).flat_map(Cost::shapes).map(|(shape, _)| shape);
    let shapes = case.constraints.iter().filter_map(|block| block.obstacle.as_ref()).map(|keep_out| &keep_out.shape);
    let own = shapes.chain(of_costs).filter_map(|shape| match shape {
        ShapeOrName::Shape(shape) => Some(shape),
        ShapeOrName::Name(_) => None,
    });
    case.obstacles.iter().map(|obstacle| &obstacle.shape).chain(own).filter_map(|shape| match shape {
        Shape::Mesh(source) => Some(source),
        _ => None,
    })
}

/// What is said of a body that is larger than soft bodies are.
pub(super) fn large(mesh: &Mesh, units: Units) -> Option<String> {
    let size = mesh.size().into_iter().fold(0.0, f64::max);
    let metres = units.in_si(size, Dimension::LENGTH);
    (metres > LARGE).then(|| format!("the body measures {}", show(mesh, units.length().symbol)))
}

fn show(mesh: &Mesh, unit: &str) -> String {
    let size = mesh.size();
    let size: Vec<String> = size[..mesh.dim()].iter().map(|s| format!("{}", rounded(*s))).collect();
    format!("{} {unit}", size.join(" x "))
}

/// Four significant digits: a size, not a measurement.
fn rounded(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}
