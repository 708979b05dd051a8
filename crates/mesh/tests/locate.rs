//! Points of the reference body, found in its cells.

use nastic_mesh::{CellKind, box_mesh, rectangle};

type Outcome = Result<(), Box<dyn std::error::Error>>;

/// Shape functions of the cell found give the point back, also where sides are curved, and a quadratic field exactly
/// where the cells are straight and quadratic.
#[test]
fn every_point_of_a_body_is_found_and_no_other() -> Outcome {
    for kind in [CellKind::Hex8, CellKind::Hex20, CellKind::Hex27, CellKind::Tet4, CellKind::Tet10] {
        let straight = box_mesh([1.0, 0.2, 0.3], [3, 2, 1], kind)?;
        let bend = |x: [f64; 3]| [x[0], x[1] + 0.2 * x[0] * x[0], x[2]];
        let curved = straight.clone().mapped(bend)?;
        for point in [[0.0, 0.0, 0.0], [1.0, 0.2, 0.3], [0.31, 0.07, 0.22], [1.0 / 3.0, 0.1, 0.3]] {
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
        assert!(straight.locate([1.001, 0.1, 0.1]).is_none(), "{kind}");
        assert!(straight.locate([f64::NAN, 0.1, 0.1]).is_none(), "{kind}");
    }
    Ok(())
}

#[test]
fn plane_bodies_too() -> Outcome {
    for kind in [CellKind::Tri6, CellKind::Quad8, CellKind::Quad4] {
        let mesh = rectangle([1.0, 0.2], [4, 2], kind)?;
        let at = mesh.locate([0.7, 0.11, 0.0]).ok_or("not found")?;
        let x: Vec<f64> = mesh.points().iter().map(|x| x[0]).collect();
        assert!((at.interpolate(&x, 1)[0] - 0.7).abs() < 1e-13);
        assert!(mesh.locate([0.7, 0.11, 0.1]).is_none());
    }
    Ok(())
}
