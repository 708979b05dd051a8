//! The least width of bars and slits: plates and slits of known width, aslant to the mesh, in the plane and in space.

use nastic_mesh::WallKind::{Cut, Joint, Skin};
use nastic_mesh::{CellKind, LeastWidth, LevelBody, Mesh, MeshError, box_mesh, rectangle};

fn meshes() -> Result<Vec<Mesh>, MeshError> {
    let space = [CellKind::Hex8, CellKind::Tet4].into_iter().map(|kind| box_mesh([1.0, 1.0, 1.0], [12, 12, 12], kind));
    let plane = [CellKind::Quad4, CellKind::Tri3].into_iter().map(|kind| rectangle([1.0, 1.0], [12, 12], kind));
    space.chain(plane).collect()
}

/// What lies above 0 of a field by node.
fn body(mesh: &Mesh, cells: &[u32], s: impl Fn([f64; 3]) -> f64) -> LevelBody {
    LevelBody::of_nodes(mesh, cells, mesh.points().iter().map(|x| s(*x)).collect(), 0.1)
}

fn all(mesh: &Mesh) -> Vec<u32> {
    (0..mesh.cells() as u32).collect()
}

/// The distance from the plane 0.6 x + 0.8 y = 0.71.
fn distance(x: [f64; 3]) -> f64 {
    (0.6 * x[0] + 0.8 * x[1] - 0.71).abs()
}

#[test]
fn plates_and_slits_are_as_wide_as_they_are() -> Result<(), MeshError> {
    for mesh in meshes()? {
        let (cells, kind) = (all(&mesh), mesh.cell(0).kind);
        for width in [0.3, 0.45] {
            let plate = body(&mesh, &cells, |x| 0.5 * width - distance(x));
            let slit = body(&mesh, &cells, |x| distance(x) - 0.5 * width);
            let own = plate.least_width(mesh.points(), 0.0, &[Cut, Skin]);
            assert!(own.is_some_and(|own| (own.width - width).abs() < 1e-9), "{kind:?} {width}: {own:?}");
            assert!(own.is_some_and(|own| distance(own.position) < 1e-9), "{kind:?}: {own:?}");
            // the plate of void, by the other sign
            let void = slit.with_values(mesh.points().iter().map(|x| 0.5 * width - distance(*x)).collect());
            let gap = void.least_width(mesh.points(), 0.0, &[Cut, Joint]);
            assert!(gap.is_some_and(|gap| (gap.width - width).abs() < 1e-9), "{kind:?} {width}: {gap:?}");
            // what is beside the slit ends at the skin, aslant
            let beside = slit.least_width(mesh.points(), 0.0, &[Cut, Skin]);
            assert!(beside.is_none_or(|beside| beside.width > 0.01), "{kind:?}: {beside:?}");
        }
    }
    Ok(())
}

/// A neck: two walls that come near each other.
#[test]
fn necks_are_found_where_they_are() -> Result<(), MeshError> {
    let mesh = rectangle([1.0, 1.0], [60, 60], CellKind::Quad4)?;
    let neck = |x: [f64; 3]| 0.1 + (x[0] - 0.4).powi(2) - (x[1] - 0.5).abs();
    let found = body(&mesh, &all(&mesh), neck).least_width(mesh.points(), 0.0, &[Cut, Skin]);
    let LeastWidth { width, position } = found.unwrap_or(LeastWidth { width: 0.0, position: [0.0; 3] });
    assert!((width - 0.2).abs() < 2e-3, "{width}");
    assert!((position[0] - 0.4).abs() < 0.05 && (position[1] - 0.5).abs() < 1e-2, "{position:?}");
    Ok(())
}

#[test]
fn what_goes_on_beyond_a_joint_is_no_wall() -> Result<(), MeshError> {
    let mesh = box_mesh([1.0, 1.0, 1.0], [6, 6, 6], CellKind::Hex8)?;
    let in_half = |cell: &u32| mesh.cell(*cell as usize).nodes.iter().all(|a| mesh.points()[*a as usize][0] < 0.51);
    let half: Vec<u32> = all(&mesh).into_iter().filter(in_half).collect();
    let part = body(&mesh, &half, |x| x[0] - 0.3);
    assert_eq!(part.least_width(mesh.points(), 0.0, &[Cut, Skin]), None);
    let own = part.least_width(mesh.points(), 0.0, &[Cut, Skin, Joint]);
    assert!(own.is_some_and(|own| (own.width - 0.2).abs() < 1e-9), "{own:?}");
    // and the part before it ends at the skin
    let before = body(&mesh, &half, |x| 0.3 - x[0]).least_width(mesh.points(), 0.0, &[Cut, Skin]);
    assert!(before.is_some_and(|own| (own.width - 0.3).abs() < 1e-9), "{before:?}");
    assert_eq!(body(&mesh, &half, |x| 0.3 - x[0]).least_width(mesh.points(), 0.0, &[Cut, Joint]), None);
    Ok(())
}

/// An edge of 45 degrees is no bar.
#[test]
fn blunt_edges_are_no_bars() -> Result<(), MeshError> {
    for mesh in meshes()? {
        let corner = body(&mesh, &all(&mesh), |x| 0.8 - x[0] - x[1]);
        assert_eq!(corner.least_width(mesh.points(), 0.0, &[Cut, Skin, Joint]), None);
    }
    Ok(())
}
