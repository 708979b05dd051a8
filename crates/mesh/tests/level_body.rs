//! Bodies above a level: closed, oriented outward, of the volume asked for.

use nastic_mesh::{CellKind, ClosedSurface, LevelBody, Mesh, MeshError, box_mesh, rectangle};
use std::collections::BTreeMap;

/// Every edge is passed as often one way as the other.
pub fn is_closed(surface: &ClosedSurface) -> bool {
    let mut passes: BTreeMap<(u32, u32), i32> = BTreeMap::new();
    for triangle in &surface.triangles {
        for k in 0..3 {
            let (a, b) = (triangle[k], triangle[(k + 1) % 3]);
            *passes.entry((a.min(b), a.max(b))).or_default() += if a < b { 1 } else { -1 };
        }
    }
    passes.values().all(|passes| *passes == 0)
}

/// A field by cell, by the mean of its corners.
fn level_body(mesh: &Mesh, cells: &[u32], s: impl Fn([f64; 3]) -> f64) -> LevelBody {
    let value = |cell: &u32| {
        let cell = mesh.cell(*cell as usize);
        let corners = &cell.nodes[..cell.kind.corners()];
        let sum = corners.iter().fold([0.0; 3], |sum, a| [0, 1, 2].map(|k| sum[k] + mesh.points()[*a as usize][k]));
        s(sum.map(|x| x / corners.len() as f64))
    };
    let values: Vec<f64> = cells.iter().map(value).collect();
    LevelBody::new(mesh, cells, &values, &vec![1.0; cells.len()], 0.1)
}

fn meshes() -> Result<Vec<Mesh>, MeshError> {
    let space = [CellKind::Hex8, CellKind::Hex20, CellKind::Hex27, CellKind::Tet4, CellKind::Tet10];
    let plane = [CellKind::Quad4, CellKind::Quad9, CellKind::Tri3, CellKind::Tri6];
    let space = space.into_iter().map(|kind| box_mesh([1.0, 1.0, 1.0], [12, 12, 12], kind));
    space.chain(plane.into_iter().map(|kind| rectangle([1.0, 1.0], [12, 12], kind))).collect()
}

#[test]
fn surfaces_are_closed_and_keep_the_volume() -> Result<(), MeshError> {
    for mesh in meshes()? {
        let cells: Vec<u32> = (0..mesh.cells() as u32).collect();
        let (what, whole) = (mesh.cell(0).kind, if mesh.dim() == 3 { 1.0 } else { 0.1 });
        // a ball around a corner, through the skin
        let ball = level_body(&mesh, &cells, |x| 1.0 - x.iter().map(|x| x * x).sum::<f64>().sqrt());
        let all = ball.surface(mesh.points(), -1.0);
        assert!(is_closed(&all) && (all.volume() - whole).abs() < 1e-12, "{what:?}: {}", all.volume());
        assert_eq!(ball.surface(mesh.points(), 2.0), ClosedSurface::default());
        for share in [0.1, 0.4] {
            let level = ball.level_of_volume(mesh.points(), share * whole);
            let surface = ball.surface(mesh.points(), level);
            assert!(is_closed(&surface), "{what:?}");
            assert!((surface.volume() - share * whole).abs() < 1e-3 * whole, "{what:?}: {}", surface.volume());
            // the radius of an eighth of a ball, of a quarter of a disc
            let radius = match mesh.dim() {
                3 => (share * 6.0 / std::f64::consts::PI).cbrt(),
                _ => (share * 4.0 / std::f64::consts::PI).sqrt(),
            };
            assert!((1.0 - level - radius).abs() < 0.03, "{what:?}: {level} {radius}");
        }
    }
    Ok(())
}

#[test]
fn parts_are_closed_where_they_end_and_move_with_the_body() -> Result<(), MeshError> {
    let mesh = box_mesh([1.0, 1.0, 1.0], [6, 6, 6], CellKind::Hex8)?;
    let in_half = |cell: &u32| mesh.cell(*cell as usize).nodes.iter().all(|a| mesh.points()[*a as usize][0] < 0.51);
    let half: Vec<u32> = (0..mesh.cells() as u32).filter(in_half).collect();
    let body = level_body(&mesh, &half, |x| x[2]);
    let moved: Vec<[f64; 3]> = mesh.points().iter().map(|x| [2.0 * x[0], x[1] + x[0], x[2]]).collect();
    for level in [0.0, 0.3, 0.5] {
        let (rest, moved) = (body.surface(mesh.points(), level), body.surface(&moved, level));
        assert!(is_closed(&rest) && rest.triangles == moved.triangles);
        assert!((rest.volume() - 0.5 * (1.0 - level)).abs() < 1e-3, "{level}: {}", rest.volume());
        assert!((moved.volume() - 2.0 * rest.volume()).abs() < 1e-12);
    }
    Ok(())
}

/// A plateau is in the body or not; levels lie between plateaus, beyond them of a uniform field.
#[test]
fn levels_lie_between_plateaus() -> Result<(), MeshError> {
    let mesh = rectangle([1.0, 1.0], [20, 20], CellKind::Quad4)?;
    let cells: Vec<u32> = (0..mesh.cells() as u32).collect();
    let whole = 0.1;
    let found = |s: &dyn Fn([f64; 3]) -> f64, share: f64| {
        let body = level_body(&mesh, &cells, s);
        let level = body.level_of_volume(mesh.points(), share * whole);
        (level, body.surface(mesh.points(), level).volume() / whole)
    };
    let uniform = |value: f64| found(&|_| value, value);
    assert_eq!(uniform(0.0), (0.5, 0.0));
    assert_eq!(uniform(0.3), (0.8, 0.0));
    let (level, share) = uniform(1.0);
    assert!(level == 0.5 && (share - 1.0).abs() < 1e-12, "{level} {share}");
    let (level, share) = uniform(0.7);
    assert!((level - 0.2).abs() < 1e-12 && (share - 1.0).abs() < 1e-12, "{level} {share}");
    // halves of two values: the level is between them where the volume at the upper one is not much nearer
    for [low, high] in [[0.0, 0.5], [0.1, 0.5], [0.0, 1.0]] {
        let (level, share) = found(&|x| if x[0] < 0.5 { high } else { low }, 0.5 * (low + high));
        assert!(
            (level - 0.5 * (low + high)).abs() < 1e-6 && (share - 0.5).abs() < 1e-4,
            "{low} {high}: {level} {share}"
        );
    }
    // of three levels that lie apart the one between the upper two
    let steps = |x: [f64; 3]| (3.0 * x[0]).floor() / 2.0;
    let (level, share) = found(&steps, 0.34);
    assert!((level - 0.75).abs() < 0.2 && (share - 0.34).abs() < 1e-4, "{level} {share}");
    Ok(())
}

/// Parts that do not touch: all levels between their values have the same volume.
#[test]
fn levels_of_parts_apart_lie_halfway() -> Result<(), MeshError> {
    let mesh = rectangle([1.0, 1.0], [10, 10], CellKind::Quad4)?;
    let x = |cell: u32| mesh.cell(cell as usize).nodes.iter().map(|a| mesh.points()[*a as usize][0]).sum::<f64>() / 4.0;
    let cells: Vec<u32> = (0..mesh.cells() as u32).filter(|cell| (x(*cell) - 0.5).abs() > 0.2).collect();
    let body = level_body(&mesh, &cells, |x| if x[0] < 0.5 { 1.0 } else { 0.0 });
    let level = body.level_of_volume(mesh.points(), 0.03);
    let share = body.surface(mesh.points(), level).volume();
    assert!((level - 0.5).abs() < 1e-6 && (share - 0.03).abs() < 1e-9, "{level} {share}");
    Ok(())
}
