//! Generated boxes and rectangles: counts, volumes, surfaces, conformity.

#![allow(clippy::unwrap_used)]

use nastic_mesh::{CellKind, Facet, Mesh, MeshError, box_mesh, rectangle};

fn volume(mesh: &Mesh) -> f64 {
    (0..mesh.cells())
        .map(|id| {
            let c = mesh.cell(id);
            c.kind.measure(&mesh.gather(mesh.points(), c.nodes))
        })
        .sum()
}

fn area(mesh: &Mesh, facets: &[Facet]) -> f64 {
    let one = |&facet| {
        let (kind, nodes) = mesh.facet_nodes(facet);
        kind.measure(&mesh.gather(mesh.points(), &nodes))
    };
    facets.iter().map(one).sum()
}

fn every_kind() -> Vec<Mesh> {
    let make = |kind: CellKind| match kind.dim() {
        3 => box_mesh([3.0, 2.0, 1.0], [3, 2, 4], kind).unwrap(),
        _ => rectangle([3.0, 2.0], [3, 5], kind).unwrap(),
    };
    CellKind::ALL.into_iter().filter(|kind| kind.dim() > 1).map(make).collect()
}

#[test]
fn volumes_and_areas_are_those_of_the_box() {
    for mesh in every_kind() {
        let dim = mesh.dim();
        let (size, full) = if dim == 3 { ([3.0, 2.0, 1.0], 6.0) } else { ([3.0, 2.0, 0.0], 6.0) };
        assert_eq!((mesh.size(), mesh.bounds().0), (size, [0.0; 3]));
        assert!((volume(&mesh) - full).abs() < 1e-13);
        let mut all = Vec::new();
        for (k, name) in ["x-", "x+", "y-", "y+", "z-", "z+"].iter().enumerate().take(2 * dim) {
            let facets = mesh.surface(name).unwrap();
            let across: f64 = (0..dim).filter(|d| *d != k / 2).map(|d| size[d]).product();
            assert!((area(&mesh, facets) - across).abs() < 1e-13, "{name}");
            let at = if k % 2 == 0 { 0.0 } else { size[k / 2] };
            for &facet in facets {
                let (kind, nodes) = mesh.facet_nodes(facet);
                let positions = mesh.gather(mesh.points(), &nodes);
                assert!(positions.iter().all(|p| p[k / 2] == at));
                let normal = kind.area_vector(&positions, &kind.centre());
                assert!(if k % 2 == 0 { normal[k / 2] < 0.0 } else { normal[k / 2] > 0.0 }, "{name} points outwards");
            }
            all.extend_from_slice(facets);
        }
        all.sort_unstable();
        assert_eq!(all, mesh.boundary(), "the sides are the boundary");
        assert_eq!(mesh.region("body").unwrap().len(), mesh.cells());
        assert!(mesh.notes().is_empty(), "{:?}", mesh.notes());
    }
}

#[test]
fn counts_of_nodes_and_cells() {
    let count = |kind, cells| {
        let m = box_mesh([1.0, 0.2, 0.2], cells, kind).unwrap();
        (m.points().len(), m.cells())
    };
    assert_eq!(count(CellKind::Hex8, [10, 2, 2]), (99, 40));
    assert_eq!(count(CellKind::Hex27, [10, 2, 2]), (525, 40));
    assert_eq!(count(CellKind::Tet10, [10, 2, 2]), (525, 240));
    // corners 11*3*3 + edges 10*9 + 2*11*3 * 2
    assert_eq!(count(CellKind::Hex20, [10, 2, 2]), (99 + 90 + 132, 40));
    let plane = rectangle([1.0, 1.0], [2, 3], CellKind::Tri6).unwrap();
    assert_eq!((plane.points().len(), plane.cells()), (35, 12));
}

#[test]
fn tetrahedra_share_the_body_diagonal_of_each_grid_cell() {
    for kind in [CellKind::Tet4, CellKind::Tet10] {
        let mesh = box_mesh([1.0; 3], [1, 1, 1], kind).unwrap();
        assert_eq!(mesh.cells(), 6);
        for id in 0..6 {
            let corners = mesh.gather(mesh.points(), &mesh.cell(id).nodes[..4]);
            assert!(corners.contains(&[0.0; 3]) && corners.contains(&[1.0; 3]));
        }
    }
}

#[test]
fn every_inner_facet_has_two_sides() {
    for mesh in every_kind() {
        let faces: usize = mesh.blocks().iter().map(|b| b.len() * b.kind.faces().len()).sum();
        assert_eq!(faces, mesh.boundary().len() + 2 * mesh.neighbours().len());
        for &(a, b) in mesh.neighbours() {
            assert!(a < b);
            let (mut na, mut nb) = (mesh.facet_nodes(a).1, mesh.facet_nodes(b).1);
            na.sort_unstable();
            nb.sort_unstable();
            assert_eq!(na, nb);
        }
    }
}

#[test]
fn requests_that_make_no_sense_are_refused() {
    let message = |r: Result<Mesh, MeshError>| r.unwrap_err().to_string();
    assert!(message(box_mesh([1.0; 3], [2; 3], CellKind::Quad4)).contains("quad4 is not a volume element"));
    let of_a_volume = message(rectangle([1.0; 2], [2; 2], CellKind::Hex8));
    assert!(of_a_volume.contains("hex8 is not a plane element"), "{of_a_volume}");
    let (_, instead) = of_a_volume.split_once("take ").unwrap();
    assert!(CellKind::ALL.iter().all(|kind| instead.contains(kind.name()) == (kind.dim() == 2)), "{instead}");
    assert!(message(box_mesh([1.0, 0.0, 1.0], [2; 3], CellKind::Hex8)).contains("size 0 is not a positive length"));
    assert!(message(box_mesh([1.0, f64::NAN, 1.0], [2; 3], CellKind::Hex8)).contains("not a positive length"));
    assert!(message(box_mesh([1.0; 3], [2, 0, 2], CellKind::Hex8)).contains("at least one along each axis"));
    assert!(message(box_mesh([1.0; 3], [1 << 40; 3], CellKind::Hex8)).contains("take fewer cells"));
}

/// Bodies of one mesh share no node and keep their names, behind their own.
#[test]
fn bodies_beside_each_other() {
    let pad = rectangle([2.0, 1.0], [4, 2], CellKind::Quad8).unwrap();
    let stone =
        rectangle([1.0, 1.0], [1, 1], CellKind::Tri3).unwrap().mapped(|x| [x[0] + 0.5, x[1] + 1.5, 0.0]).unwrap();
    let both = Mesh::together("both", &[("pad", pad.clone()), ("stone", stone.clone())]).unwrap();
    assert_eq!(both.points().len(), pad.points().len() + stone.points().len());
    assert_eq!(both.cells(), pad.cells() + stone.cells());
    assert_eq!(both.region("pad").unwrap().len(), pad.cells());
    assert_eq!(both.region("stone").unwrap().len(), stone.cells());
    assert!((volume(&both) - 3.0).abs() < 1e-12);
    for (name, length) in [("pad.x+", 1.0), ("pad.y+", 2.0), ("stone.x-", 1.0), ("stone.y-", 1.0)] {
        assert!((area(&both, both.surface(name).unwrap()) - length).abs() < 1e-12, "{name}");
    }
    let cube = box_mesh([1.0; 3], [1; 3], CellKind::Hex8).unwrap();
    assert!(Mesh::together("neither", &[("pad", pad), ("cube", cube)]).is_err());
}
