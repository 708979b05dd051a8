//! Parts of bodies above levels of several fields: closed, without gaps and overlaps, of known volumes.

use crate::level_body::is_closed;
use nastic_mesh::{CellKind, LevelBody, Mesh, MeshError, box_mesh, rectangle};

fn at_nodes(mesh: &Mesh, s: impl Fn([f64; 3]) -> f64) -> Vec<f64> {
    mesh.points().iter().map(|x| s(*x)).collect()
}

#[test]
fn two_fields_divide_a_body_without_gaps() -> Result<(), MeshError> {
    for kind in [CellKind::Hex8, CellKind::Hex27, CellKind::Tet4, CellKind::Quad4, CellKind::Tri6] {
        let mesh = match kind.dim() {
            3 => box_mesh([1.0, 1.0, 1.0], [5, 6, 4], kind)?,
            _ => rectangle([1.0, 1.0], [5, 6], kind)?,
        };
        let whole = if kind.dim() == 3 { 1.0 } else { 0.1 };
        let cells: Vec<u32> = (0..mesh.cells() as u32).collect();
        // oblique planes, linear between nodes: volumes are known
        let filled = LevelBody::of_nodes(&mesh, &cells, at_nodes(&mesh, |x| x[0] + 0.3 * x[1]), 0.1).above(0.52);
        let rest = mesh.points();
        let volume = filled.whole(rest).volume();
        assert!(is_closed(&filled.whole(rest)) && (volume - 0.63 * whole).abs() < 1e-3, "{kind:?}: {volume}");
        let mixed = |sign: f64| at_nodes(&mesh, |x| sign * (x[1] - 0.2 * x[0]));
        let [stiff, soft] = [1.0, -1.0].map(|sign| filled.with_values(mixed(sign)).above(0.41 * sign));
        // { x + 0.3 y > 0.52 } and { y > 0.41 + 0.2 x }: a trapezium between the lines to x = 1
        let corner = (0.52 - 0.3 * 0.41) / (1.0 + 0.3 * 0.2);
        let [left, right] = [(0.52 - 0.3, 1.0), (corner, 0.41 + 0.2 * corner)];
        let points = [left, right, (1.0, 0.61), (1.0, 1.0)];
        let area =
            0.5 * (0..4).map(|k| (points[k], points[(k + 1) % 4])).map(|(a, b)| a.0 * b.1 - a.1 * b.0).sum::<f64>();
        let [own, other] = [&stiff, &soft].map(|body| body.whole(rest));
        assert!(is_closed(&own) && is_closed(&other), "{kind:?}");
        assert!((own.volume() - whole * area).abs() < 1e-3, "{kind:?}: {} {}", own.volume(), whole * area);
        let sum = own.volume() + other.volume();
        assert!((sum - volume).abs() < 1e-9 * whole, "{kind:?}: {sum} {volume}");
        // they move with the body
        let moved: Vec<[f64; 3]> = rest.iter().map(|x| [2.0 * x[0], x[1] + x[0], x[2]]).collect();
        let moved = stiff.whole(&moved);
        assert!(is_closed(&moved) && (moved.volume() - 2.0 * own.volume()).abs() < 1e-12, "{kind:?}");
    }
    Ok(())
}

#[test]
fn parts_are_the_bodies_within_surfaces() -> Result<(), MeshError> {
    let mesh = box_mesh([1.0, 1.0, 1.0], [6, 6, 6], CellKind::Hex8)?;
    let cells: Vec<u32> = (0..mesh.cells() as u32).collect();
    let wave = at_nodes(&mesh, |x| (7.0 * x[0]).sin() + (5.0 * x[1]).cos() + (6.0 * x[2]).sin());
    let body = LevelBody::of_nodes(&mesh, &cells, wave, 0.0);
    for level in [-1.0, 0.0, 0.5, 1.5] {
        let [cut, part] = [body.surface(mesh.points(), level), body.above(level).whole(mesh.points())];
        assert!(is_closed(&part) && (part.volume() - cut.volume()).abs() < 1e-12, "{level}");
    }
    Ok(())
}
