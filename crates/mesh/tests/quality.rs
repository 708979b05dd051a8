//! Quality, measures and snapshots.

#![allow(clippy::unwrap_used)]

use nastic_mesh::{CellKind, Domain, Mesh, MeshError, RawMesh, Snapshot, box_mesh, rectangle};

fn one(kind: CellKind, points: Vec<[f64; 3]>) -> Mesh {
    let mut raw = RawMesh::new("one");
    let nodes: Vec<u32> = (0..points.len() as u32).collect();
    raw.points = points;
    raw.push(kind, &nodes, &[]);
    Mesh::build(raw).unwrap()
}

/// Corners of the best shape of a kind.
fn best(kind: CellKind) -> Vec<[f64; 3]> {
    let h = 3f64.sqrt() / 2.0;
    match (kind.domain(), kind.dim()) {
        (Domain::Box, _) => kind.corner_kind().reference_nodes().to_vec(),
        (Domain::Simplex, 2) => vec![[0.0; 3], [1.0, 0.0, 0.0], [0.5, h, 0.0]],
        (Domain::Simplex, _) => vec![[1.0, 1.0, 1.0], [-1.0, -1.0, 1.0], [-1.0, 1.0, -1.0], [1.0, -1.0, -1.0]],
    }
}

#[test]
fn best_shapes_score_one() {
    for kind in CellKind::ALL.into_iter().filter(|kind| kind.dim() > 1) {
        let corners = best(kind);
        let nodes = kind.reference_nodes().iter().map(|xi| kind.corner_kind().map(&corners, xi));
        let quality = one(kind, nodes.collect()).quality();
        assert!((quality.scaled_jacobian() - 1.0).abs() < 1e-14, "{kind}: {quality}");
        assert!((quality.jacobian_ratio() - 1.0).abs() < 1e-13, "{kind}: {quality}");
        assert!((quality.aspect() - 1.0).abs() < 1e-14, "{kind}: {quality}");
        assert!(quality.warnings().is_empty(), "{kind}: {quality}");
    }
}

#[test]
fn a_known_trapezoid() {
    // Corners at 45 degrees have sine 1/sqrt 2; det runs linearly from 3 at the bottom to 1 at the top.
    let mesh = one(CellKind::Quad4, vec![[0.0; 3], [3.0, 0.0, 0.0], [2.0, 1.0, 0.0], [1.0, 1.0, 0.0]]);
    let quality = mesh.quality();
    assert!((quality.scaled_jacobian() - 0.5f64.sqrt()).abs() < 1e-15);
    assert!((quality.jacobian_ratio() - 1.0 / 3.0).abs() < 1e-15);
    assert_eq!((quality.shortest_edge, quality.longest_edge, quality.aspect()), (1.0, 3.0, 3.0));
}

#[test]
fn worst_cells_come_first_and_are_warned_about() {
    let dented = |by: f64| {
        let dent = |[x, y, z]: [f64; 3]| if x > 2.5 && y > 0.5 { [x - by, y - by, z] } else { [x, y, z] };
        rectangle([3.0, 1.0], [3, 1], CellKind::Quad4).unwrap().mapped(dent).unwrap().quality()
    };
    let flat = dented(0.48);
    assert_eq!((flat.worst(2)[0].cell, flat.worst(9).len()), (2, 3));
    assert!(flat.warnings()[0].contains("1 cells have a scaled Jacobian below 0.1 (cell 2"), "{flat}");
    let turned = dented(0.52);
    assert!(turned.scaled_jacobian() < 0.0 && turned.jacobian_ratio() < 0.0);
    assert!(turned.warnings()[0].contains("turns over at a node (first: cell 2)"), "{turned}");
}

#[test]
fn measures_of_a_curved_body() {
    // A quarter of a ring between radii 1 and 2, height 1: volume 3 pi / 4. Quadratic cells converge as h^4.
    let ring = |n| {
        box_mesh([1.0, 1.0, 1.0], [n, 2 * n, 1], CellKind::Hex27)
            .unwrap()
            .mapped(|[x, y, z]| {
                let (r, t) = (1.0 + x, y * std::f64::consts::FRAC_PI_2);
                [r * t.cos(), r * t.sin(), z]
            })
            .unwrap()
    };
    let error = |n| {
        let m = ring(n).measures();
        [m.volume - 0.75 * std::f64::consts::PI, m.surfaces["x+"] - std::f64::consts::PI, m.surfaces["z-"] - m.volume]
    };
    let (coarse, fine) = (error(2), error(4));
    assert!(fine[0].abs() < 1e-4 && coarse[0] / fine[0] > 15.0, "{coarse:?} {fine:?}");
    assert!(fine[1].abs() < 1e-4 && coarse[1] / fine[1] > 15.0, "{coarse:?} {fine:?}");
    assert!(fine[2].abs() < 1e-13);
    let measures = ring(2).measures();
    assert_eq!(measures.regions["body"], measures.volume);
    let sides: f64 = measures.surfaces.values().sum();
    assert!((sides - measures.boundary).abs() < 1e-13);
    assert!(measures.to_string().starts_with("size 2.000000 x 2.000000 x 1.000000, volume"));
}

#[test]
fn volumes_follow_the_deformed_positions() {
    for kind in CellKind::ALL.into_iter().filter(|kind| kind.dim() > 1) {
        let mesh = match kind.dim() {
            2 => rectangle([1.0; 2], [2; 2], kind).unwrap(),
            _ => box_mesh([1.0; 3], [2; 3], kind).unwrap(),
        };
        let stretched: Vec<[f64; 3]> = mesh.points().iter().map(|[x, y, z]| [2.0 * x, *y, *z]).collect();
        let volume: f64 = mesh.volumes(&stretched).iter().sum();
        assert!((volume - 2.0).abs() < 1e-13, "{kind}: {volume}");
    }
    let hexes = box_mesh([1.0, 2.0, 3.0], [2, 1, 1], CellKind::Hex20).unwrap();
    assert!((0..3).all(|i| (hexes.cell_centre(1)[i] - [0.75, 1.0, 1.5][i]).abs() < 1e-15));
}

#[test]
fn snapshots_check_their_arrays() {
    let mesh = rectangle([1.0; 2], [1, 1], CellKind::Tri3).unwrap();
    let snapshot = Snapshot::new(mesh)
        .with_points("displacement", 2, vec![0.5; 8])
        .and_then(|s| s.with_cells("J", 1, vec![1.0, 2.0]))
        .and_then(|s| s.with_cells("J", 1, vec![3.0, 4.0]))
        .unwrap();
    assert_eq!(snapshot.cell_data.len(), 1);
    assert_eq!(snapshot.cell_array("J").unwrap().at(1), [4.0]);
    assert_eq!(snapshot.positions()[3], [1.5, 1.5, 0.0]);
    assert!(snapshot.point_array("J").is_none());
    let error = snapshot.with_points("u", 3, vec![0.0; 8]).unwrap_err();
    assert_eq!(error.to_string(), "array \"u\" has 8 values; 12 needed (4 entities of 3 components)");
    assert!(matches!(error, MeshError::ArrayLength { .. }));
}
