//! Obstacles as the library makes them.

use super::context::Context;
use nastic_language::schema::{AlignedBox, Case, Shape, ShapeOrName};
use nastic_mesh::spatial::Obstacle;

/// Of a shape with a rounding radius.
pub(super) fn build((shape, rounding): (&Shape, f64), context: &mut Context<'_>) -> Option<Obstacle> {
    let built = match shape {
        Shape::Sphere(sphere) => Obstacle::sphere(sphere.center.xyz(), sphere.radius),
        Shape::HalfSpace(half) => Obstacle::half_space(half.point.xyz(), half.normal.xyz()),
        Shape::Box(block) => aligned_box(block),
        Shape::Capsule(capsule) => Obstacle::capsule(capsule.from.xyz(), capsule.to.xyz(), capsule.radius),
        Shape::Mesh(source) => {
            let at = super::mesh::place(source);
            let mesh = super::mesh::load(source, &at, context)?;
            context.take(&at, Obstacle::solid(&mesh))?
        }
    };
    Some(built.rounded(rounding))
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

/// Of a cost or constraint; a name that is not there has been complained about.
pub(super) fn of(case: &Case, shape: &ShapeOrName, context: &mut Context<'_>) -> Option<Obstacle> {
    build(shape.among(&case.obstacles)?, context)
}
