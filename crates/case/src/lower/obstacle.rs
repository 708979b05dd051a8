//! Obstacles as the library makes them.

use super::context::Context;
use super::obstacle_grid;
use nastic_language::schema::{AlignedBox, Case, Outline, Shape, ShapeOrName};
use nastic_mesh::spatial::Obstacle;

/// Of a shape from which distances up to a reach matter.
pub(super) fn build(outline: Outline<'_>, reach: f64, context: &mut Context<'_>) -> Option<Obstacle> {
    let built = match outline.shape {
        Shape::Mesh(source) => {
            let at = super::mesh::place(source);
            let mesh = super::mesh::load(source, &at, context)?;
            match outline.grid {
                Some((spacing, block)) => obstacle_grid::build(block, spacing, &mesh, reach, context)?,
                None => context.take(&at, Obstacle::solid(&mesh))?,
            }
        }
        shape => obstacle_of(shape)?,
    };
    Some(built.rounded(outline.rounding))
}

/// Of a shape that is given by numbers; `None` of a meshed one.
#[must_use]
pub fn obstacle_of(shape: &Shape) -> Option<Obstacle> {
    match shape {
        Shape::Sphere(sphere) => Some(Obstacle::sphere(sphere.center.xyz(), sphere.radius)),
        Shape::HalfSpace(half) => Some(Obstacle::half_space(half.point.xyz(), half.normal.xyz())),
        Shape::Box(block) => Some(aligned_box(block)),
        Shape::Capsule(capsule) => Some(Obstacle::capsule(capsule.from.xyz(), capsule.to.xyz(), capsule.radius)),
        Shape::Mesh(_) => None,
    }
}

/// In plane strain z is left out: the box is there at every z.
fn aligned_box(block: &AlignedBox) -> Obstacle {
    let [low, high] = block.corners();
    if !block.is_plane() {
        return Obstacle::aligned_box(low, high);
    }
    let ([x0, y0, _], [x1, y1, _]) = (low, high);
    let reach = (x1 - x0).abs().max((y1 - y0).abs());
    Obstacle::aligned_box([x0, y0, -reach], [x1, y1, reach])
}

/// Of a cost or constraint with a clearance; a name that is not there has been complained about.
pub(super) fn of(case: &Case, shape: &ShapeOrName, clearance: f64, context: &mut Context<'_>) -> Option<Obstacle> {
    build(shape.among(&case.obstacles)?, clearance, context)
}
