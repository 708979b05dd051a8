//! Lines in the picture: tendons and springs of bodies, paths.

use super::Picture;
use super::frame::Mark;
use super::scene::Scene;

/// Lines of all bodies, with a rim of the background's colour that sets them off from the body.
pub(super) fn marks(picture: &Picture, scene: &Scene, unit: f64) -> Vec<Mark> {
    let mut marks = Vec::new();
    let of_bodies = picture.bodies.iter().flat_map(|body| &body.polylines).map(|(colour, points)| (colour, points));
    let paths = picture.paths.iter().map(|path| (&path.colour, &path.points));
    for (colour, points) in of_bodies.chain(paths) {
        let placed: Vec<[f64; 2]> = points.iter().map(|point| scene.place(*point)).map(|[x, y, _]| [x, y]).collect();
        for (width, colour) in [(6.5 * unit, scene.ground.halo()), (3.5 * unit, *colour)] {
            marks.extend(placed.windows(2).map(|ends| Mark::Line { from: ends[0], to: ends[1], width, colour }));
        }
    }
    marks
}
