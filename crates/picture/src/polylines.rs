//! Lines in the picture: tendons and springs of bodies, paths.

use super::frame::Mark;
use super::picture::Picture;
use super::scene::Scene;
use super::vector::V3;

/// Lines of all bodies, with a rim of the background's colour that sets them off from the body.
pub(super) fn marks(picture: &Picture, scene: &Scene, unit: f64) -> Vec<Mark> {
    let mut marks = Vec::new();
    let of_bodies = picture.bodies.iter().flat_map(|body| &body.polylines).map(|(colour, points)| (colour, points));
    let (dashed, solid): (Vec<_>, Vec<_>) = picture.paths.iter().partition(|path| path.is_dashed);
    let paths = solid.into_iter().map(|path| (&path.colour, &path.points));
    let place = |points: &Vec<V3>| -> Vec<[f64; 2]> {
        points.iter().map(|point| scene.place(*point)).map(|[x, y, _]| [x, y]).collect()
    };
    for (colour, points) in of_bodies.chain(paths) {
        let placed = place(points);
        for (width, colour) in [(6.5 * unit, scene.ground.halo()), (3.5 * unit, *colour)] {
            marks.extend(placed.windows(2).map(|ends| Mark::Line { from: ends[0], to: ends[1], width, colour }));
        }
    }
    // without a rim, so that what is followed exactly shows between the dashes
    for path in dashed {
        let lines = dashes(&place(&path.points), [DASH * unit, GAP * unit]);
        marks.extend(lines.into_iter().map(|[from, to]| Mark::Line {
            from,
            to,
            width: 3.5 * unit,
            colour: path.colour,
        }));
    }
    marks
}

/// Lengths of dashes and of what is between them, in thousandths of the height.
pub(super) const DASH: f64 = 11.0;
pub(super) const GAP: f64 = 8.0;

/// The parts of a line that dashes cover, by its length from its beginning; those at corners are bent.
pub(super) fn dashes(points: &[[f64; 2]], [dash, gap]: [f64; 2]) -> Vec<[[f64; 2]; 2]> {
    let (mut parts, mut passed) = (Vec::new(), 0.0);
    for ends in points.windows(2) {
        let [from, to] = [ends[0], ends[1]];
        let length = (to[0] - from[0]).hypot(to[1] - from[1]);
        let at = |along: f64| [0, 1].map(|k| from[k] + (to[k] - from[k]) * (along / length).clamp(0.0, 1.0));
        let first = ((passed - dash) / (dash + gap)).ceil().max(0.0) as usize;
        for k in first.. {
            let begin = k as f64 * (dash + gap) - passed;
            match begin < length {
                true if begin + dash > 0.0 => parts.push([at(begin), at(begin + dash)]),
                true => {}
                false => break,
            }
        }
        passed += length;
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::dashes;

    #[test]
    fn dashes_go_round_corners() {
        let found = dashes(&[[0.0, 0.0], [4.0, 0.0], [4.0, 0.0], [4.0, 5.0]], [3.0, 2.0]);
        // 0 to 3, 5 to 8 of a length of 9
        assert_eq!(found, [[[0.0, 0.0], [3.0, 0.0]], [[4.0, 1.0], [4.0, 4.0]]]);
        let bent = dashes(&[[0.0, 0.0], [2.0, 0.0], [2.0, 2.0]], [3.0, 2.0]);
        assert_eq!(bent, [[[0.0, 0.0], [2.0, 0.0]], [[2.0, 0.0], [2.0, 1.0]]]);
        assert!(dashes(&[[1.0, 1.0]], [3.0, 2.0]).is_empty());
    }
}
