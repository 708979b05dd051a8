//! Chains of cells through opposite faces.

#![allow(clippy::unwrap_used)] // a test may

use nastic_mesh::{CellKind, Column, Domain, Mesh, RawMesh, box_mesh, rectangle};

#[test]
fn of_boxes_and_rectangles() {
    for kind in CellKind::ALL.into_iter().filter(|kind| kind.dim() > 1) {
        let mesh = match kind.dim() {
            2 => rectangle([8.0, 3.0], [4, 3], kind).unwrap(),
            _ => box_mesh([8.0, 3.0, 0.5], [4, 3, 1], kind).unwrap(),
        };
        let expected: &[(usize, f64, f64)] = match (kind.domain(), kind.dim()) {
            (Domain::Box, 2) => &[(3, 1.0, 3.0), (4, 2.0, 8.0)],
            (Domain::Box, _) => &[(1, 0.5, 0.5), (3, 1.0, 3.0), (4, 2.0, 8.0)],
            (Domain::Simplex, _) => &[],
        };
        for of_cell in &mesh.columns() {
            let mut found: Vec<(usize, f64, f64)> = of_cell.iter().map(|c| (c.cells, c.extent, c.length)).collect();
            found.sort_by_key(|column| column.0);
            assert_eq!(found, expected, "{kind:?}");
        }
    }
    let columns = rectangle([6.0, 1.0], [3, 2], CellKind::Quad4).unwrap().columns();
    let expected = [Column { extent: 2.0, length: 6.0, cells: 3 }, Column { extent: 0.5, length: 1.0, cells: 2 }];
    assert!(columns.iter().all(|of_cell| of_cell == &expected), "{columns:?}");
}

/// A square ring of four cells: around it there is no end, across it one cell.
#[test]
fn of_a_ring() {
    let corners = |r: f64| [[-r, -r, 0.0], [r, -r, 0.0], [r, r, 0.0], [-r, r, 0.0]];
    let points = [corners(1.0), corners(2.0)].concat();
    // Numbered from different corners, so that the local axes of neighbours differ.
    let mut raw = RawMesh { points, ..RawMesh::new("ring") };
    for cell in [[0, 4, 5, 1], [5, 6, 2, 1], [2, 6, 7, 3], [0, 3, 7, 4]] {
        raw.push(CellKind::Quad4, &cell, &[]);
    }
    let columns = Mesh::build(raw).unwrap().columns();
    for of_cell in &columns {
        let around = of_cell.iter().find(|column| column.length.is_infinite()).unwrap();
        let over = of_cell.iter().find(|column| column.length.is_finite()).unwrap();
        assert_eq!((around.cells, around.extent, over.cells), (4, 3.0, 1));
        assert!((over.length - 1.0).abs() < 1e-15);
    }
}
