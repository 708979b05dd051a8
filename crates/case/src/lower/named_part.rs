//! Surfaces and regions by where they are, added to the mesh of the body.

use super::context::Context;
use super::obstacle::obstacle_of;
use nastic_language::schema::{Case, NamedSurface, Shape};
use nastic_language::syntax::At;
use nastic_mesh::spatial::Obstacle;
use nastic_mesh::{Facet, Mesh};

/// Points on the border of a shape are inside: this share of the body's diagonal.
const ON_BORDER: f64 = 1e-9;
/// Cosine of the largest angle between a normal and the direction that a surface faces.
const FACING: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// The mesh with the surfaces and regions of the case.
pub(super) fn add(mesh: &Mesh, case: &Case, context: &mut Context<'_>) -> Option<Mesh> {
    let mut out = mesh.clone();
    let mut complete = true;
    for surface in &case.surfaces {
        let facets = facets(mesh, surface, context);
        let found = facets.as_ref().map_or(1, Vec::len);
        complete &= fits(&surface.at, &surface.name, out.surfaces().contains_key(&surface.name), found, mesh, context);
        out = out.with_surface(&surface.name, facets.unwrap_or_default());
    }
    for region in &case.regions {
        let shape = shape(&region.inside, &region.at.key("inside"), mesh, context);
        let is_inside =
            |cell: &u32| shape.as_ref().is_some_and(|shape| inside(shape, &mesh.cell_centre(*cell as usize), mesh));
        let cells: Vec<u32> = (0..mesh.cells() as u32).filter(is_inside).collect();
        let found = if shape.is_some() { cells.len() } else { 1 };
        complete &= fits(&region.at, &region.name, out.regions().contains_key(&region.name), found, mesh, context);
        out = out.with_region(&region.name, cells);
    }
    complete.then_some(out)
}

/// Complains of a name that is taken, and of a part without members.
fn fits(at: &At, name: &str, taken: bool, found: usize, mesh: &Mesh, context: &mut Context<'_>) -> bool {
    if taken {
        context.complain(&at.key("name"), format!("the body has \"{name}\" already: choose another name"));
    }
    if found == 0 {
        let (low, high) = mesh.bounds();
        let message =
            format!("nothing of the body is there; in its unit of length it reaches from {low:?} to {high:?}");
        context.complain(at, message);
    }
    !taken && found > 0
}

/// Outer facets in a shape, or that face a direction, or both.
fn facets(mesh: &Mesh, surface: &NamedSurface, context: &mut Context<'_>) -> Option<Vec<Facet>> {
    let within = match &surface.inside {
        Some(inside) => Some(shape(inside, &surface.at.key("inside"), mesh, context)?),
        None => None,
    };
    let direction = surface.facing.map(|direction| direction.xyz());
    let is_there = |facet: &&Facet| {
        let (kind, nodes) = mesh.facet_nodes(**facet);
        let places = mesh.gather(mesh.points(), &nodes);
        let normal = kind.area_vector(&places, &kind.centre());
        let dot = |a: &[f64; 3], b: &[f64; 3]| (0..3).map(|i| a[i] * b[i]).sum::<f64>();
        let faces = direction.is_none_or(|d| dot(&normal, &d) >= FACING * (dot(&normal, &normal) * dot(&d, &d)).sqrt());
        faces && within.as_ref().is_none_or(|shape| places.iter().all(|point| inside(shape, point, mesh)))
    };
    Some(mesh.boundary().iter().filter(is_there).copied().collect())
}

fn inside(shape: &Obstacle, point: &[f64; 3], mesh: &Mesh) -> bool {
    shape.distance(point) <= ON_BORDER * mesh.diagonal()
}

fn shape(shape: &Shape, at: &At, mesh: &Mesh, context: &mut Context<'_>) -> Option<Obstacle> {
    let made = match shape {
        Shape::Mesh(source) => {
            let solid = super::mesh::load(source, at, context)?;
            context.take(at, Obstacle::solid(&solid))?
        }
        shape => obstacle_of(shape)?,
    };
    context.take(at, made.check(mesh.dim()).map(|()| made))
}
