//! Points of the reference body, found in its cells.

use nastic_mesh::{CellKind, box_mesh, rectangle};

type Outcome = Result<(), Box<dyn std::error::Error>>;

/// Shape functions of the cell found give the point back, also where sides are curved, and a quadratic field exactly
/// where the cells are straight and quadratic.
#[test]
fn every_point_of_a_body_is_found_and_no_other() -> Outcome {
    for kind in CellKind::ALL.into_iter().filter(|kind| kind.dim() > 1) {
        let plane = kind.dim() == 2;
        let straight = match plane {
            true => rectangle([1.0, 0.2], [3, 2], kind)?,
            false => box_mesh([1.0, 0.2, 0.3], [3, 2, 1], kind)?,
        };
        let bend = |x: [f64; 3]| [x[0], x[1] + 0.2 * x[0] * x[0], x[2]];
        let curved = straight.clone().mapped(bend)?;
        for [x, y, z] in [[0.0, 0.0, 0.0], [1.0, 0.2, 0.3], [0.31, 0.07, 0.22], [1.0 / 3.0, 0.1, 0.3]] {
            let point = [x, y, if plane { 0.0 } else { z }];
            let at = straight.locate(point).ok_or("not found")?;
            let flat: Vec<f64> = straight.points().iter().flatten().copied().collect();
            let back = at.interpolate(&flat, 3);
            assert!((0..3).all(|k| (back[k] - point[k]).abs() < 1e-12), "{kind}: {point:?} {back:?}");
            if kind.order() == 2 {
                let square: Vec<f64> = straight.points().iter().map(|x| x[0] * x[1]).collect();
                assert!((at.interpolate(&square, 1)[0] - point[0] * point[1]).abs() < 1e-12, "{kind}: {point:?}");
                let moved = bend(point);
                let at = curved.locate(moved).ok_or("not found in the curved body")?;
                let flat: Vec<f64> = curved.points().iter().flatten().copied().collect();
                let back = at.interpolate(&flat, 3);
                assert!((0..3).all(|k| (back[k] - moved[k]).abs() < 1e-10), "{kind}, curved: {moved:?} {back:?}");
            }
        }
        for (node, x) in straight.points().iter().enumerate() {
            let at = straight.locate(*x).ok_or("a node was not found")?;
            assert_eq!(at.weights, [(node as u32, 1.0)], "{kind}");
        }
        let beside = if plane { [0.7, 0.11, 0.1] } else { [0.7, 0.11, 0.301] };
        for outside in [[1.001, 0.1, 0.0], [f64::NAN, 0.1, 0.0], beside] {
            assert!(straight.locate(outside).is_none(), "{kind}: {outside:?}");
        }
    }
    Ok(())
}
