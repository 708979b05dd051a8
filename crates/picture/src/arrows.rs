//! Vectors of cells as arrows in the picture.

use super::body::Body;
use super::colour::Colour;
use super::frame::Mark;
use super::picture::Picture;
use super::scene::Scene;
use super::vector::{V3, add, length, scale};

/// Shaft and head from one pixel to another.
pub(super) fn arrow(from: [f64; 2], to: [f64; 2], width: f64, colour: Colour) -> Vec<Mark> {
    let along = [to[0] - from[0], to[1] - from[1]];
    let reach = along[0].hypot(along[1]);
    if reach < 0.5 {
        return Vec::new();
    }
    let unit = [along[0] / reach, along[1] / reach];
    let head = (3.6 * width).min(0.6 * reach);
    let half = 0.42 * head;
    let neck = [to[0] - unit[0] * head, to[1] - unit[1] * head];
    let side = [-unit[1] * half, unit[0] * half];
    let points = vec![to, [neck[0] + side[0], neck[1] + side[1]], [neck[0] - side[0], neck[1] - side[1]]];
    let inside = [neck[0] + unit[0] * 0.5, neck[1] + unit[1] * 0.5];
    vec![Mark::Line { from, to: inside, width, colour }, Mark::Polygon { points, colour, opacity: 1.0 }]
}

/// Arrows of all bodies, thinned out where they would cover each other.
pub(super) fn marks(picture: &Picture, scene: &Scene, unit: f64) -> Vec<Mark> {
    let mut marks = Vec::new();
    for (body, arrows) in picture.bodies.iter().flat_map(|body| body.arrows.iter().map(move |own| (body, own))) {
        let longest = arrows.vectors.iter().map(|v| length(*v)).filter(|l| l.is_finite()).fold(0.0, f64::max);
        if longest == 0.0 {
            continue;
        }
        let reach = spacing(body, scene).clamp(26.0 * unit, 60.0 * unit);
        let mut taken: Vec<[f64; 2]> = Vec::new();
        for (cell, vector) in arrows.vectors.iter().enumerate() {
            let centre = centre(body, cell);
            let at = scene.place(centre);
            let near = |other: &[f64; 2]| (other[0] - at[0]).hypot(other[1] - at[1]) < 0.66 * reach;
            if !length(*vector).is_finite() || taken.iter().any(near) {
                continue;
            }
            taken.push([at[0], at[1]]);
            let half = scale(*vector, 0.5 * reach / (scene.scale * longest));
            let (from, to) = (scene.place(add(centre, scale(half, -1.0))), scene.place(add(centre, half)));
            let (from, to) = ([from[0], from[1]], [to[0], to[1]]);
            marks.extend(arrow(from, to, 5.5 * unit, scene.ground.halo()));
            marks.extend(arrow(from, to, 3.2 * unit, arrows.colour));
        }
    }
    marks
}

/// The mean distance of cells if they filled the picture of the body evenly, in pixels.
fn spacing(body: &Body, scene: &Scene) -> f64 {
    let seen = body.positions.iter().map(|p| scene.place(*p));
    let none = ([f64::MAX; 2], [f64::MIN; 2]);
    let (low, high) = seen.fold(none, |(low, high), p| {
        (std::array::from_fn(|k| f64::min(low[k], p[k])), std::array::from_fn(|k| f64::max(high[k], p[k])))
    });
    ((high[0] - low[0]) * (high[1] - low[1]) / body.mesh.cells().max(1) as f64).sqrt()
}

fn centre(body: &Body, cell: usize) -> V3 {
    let cell = body.mesh.cell(cell);
    let corners = &cell.nodes[..cell.kind.corners()];
    let sum = corners.iter().fold([0.0; 3], |sum, node| add(sum, body.positions[*node as usize]));
    scale(sum, 1.0 / corners.len() as f64)
}
