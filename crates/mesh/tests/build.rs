//! Raw meshes in, checked meshes or clear errors out.

#![allow(clippy::unwrap_used, clippy::panic)]

use nastic_mesh::{CellKind, Facet, Fault, Mesh, MeshError, RawMesh, box_mesh};

/// Two unit tetrahedra glued at the face 1, 2, 3; the second tip is (1, 1, 1).
fn two_tets() -> RawMesh {
    let mut raw = RawMesh::new("two.msh");
    raw.points = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 1.0, 1.0]];
    raw.push(CellKind::Tet4, &[0, 1, 2, 3], &[]);
    raw.push(CellKind::Tet4, &[1, 2, 3, 4], &[]);
    raw
}

fn fault(raw: RawMesh) -> Fault {
    match Mesh::build(raw).unwrap_err() {
        MeshError::Faulty { mesh, fault } => {
            assert_eq!(mesh, "two.msh");
            *fault
        }
        other => panic!("unexpected {other}"),
    }
}

fn message(raw: RawMesh) -> String {
    Mesh::build(raw).unwrap_err().to_string()
}

fn has_note(mesh: &Mesh, text: &str) -> bool {
    mesh.notes().iter().any(|note| note.contains(text))
}

#[test]
fn a_plain_mesh_becomes_the_body() {
    let mesh = Mesh::build(two_tets()).unwrap();
    assert_eq!((mesh.dim(), mesh.cells(), mesh.name()), (3, 2, "two.msh"));
    assert_eq!(mesh.region("body").unwrap(), [0, 1]);
    assert_eq!(mesh.boundary().len(), 6);
    assert_eq!(mesh.neighbours().len(), 1);
    assert!((mesh.region_volume("body").unwrap() - 0.5).abs() < 1e-15);
    assert!(mesh.notes().is_empty());
}

#[test]
fn negative_volume_is_mended_and_noted_for_every_kind() {
    for kind in CellKind::ALL.into_iter().filter(|kind| kind.dim() > 1) {
        let mut raw = RawMesh::new("mirrored");
        raw.points = kind.reference_nodes().to_vec();
        let nodes: Vec<u32> = kind.mirror().iter().map(|&a| a as u32).collect();
        raw.push_labelled(kind, &nodes, &[], 77);
        let mesh = Mesh::build(raw).unwrap();
        let cell = mesh.cell(0);
        let expected: Vec<u32> = (0..kind.nodes() as u32).collect();
        assert_eq!(cell.nodes, expected, "{kind}");
        assert!(has_note(&mesh, "1 cell had negative volume; winding mended (first: cell 77)"), "{:?}", mesh.notes());
        assert_eq!(mesh.boundary().len(), kind.faces().len());
    }
}

#[test]
fn regions_surfaces_and_node_sets_get_their_names() {
    let mut raw = two_tets();
    raw.blocks[0].nodes.truncate(4);
    raw.blocks[0].tags = vec![3, 8];
    raw.push(CellKind::Tet4, &[1, 2, 3, 4], &[8]);
    raw.push(CellKind::Tri3, &[2, 0, 1], &[1]);
    raw.push(CellKind::Tri3, &[0, 3, 1], &[1, 2]);
    raw.push(CellKind::Tri3, &[0, 3, 2], &[]);
    raw.push(CellKind::Line2, &[4, 0], &[5]);
    raw.vertices = vec![(4, 9), (2, 9), (0, 0)];
    raw.name_group(3, 3, "lower");
    raw.name_group(2, 1, "clamp");
    raw.name_group(2, 2, "lower");
    raw.name_group(1, 5, "edge");
    let mesh = Mesh::build(raw).unwrap();
    assert_eq!(mesh.regions().keys().collect::<Vec<_>>(), ["8", "lower"]);
    assert_eq!((mesh.region("lower").unwrap(), mesh.region("8").unwrap()), (&[0][..], &[0, 1][..]));
    assert_eq!(mesh.surface("clamp").unwrap(), [Facet { cell: 0, face: 0 }, Facet { cell: 0, face: 3 }]);
    assert_eq!(mesh.surface("lower").unwrap(), [Facet { cell: 0, face: 0 }]);
    assert_eq!(mesh.node_sets().keys().collect::<Vec<_>>(), ["9", "edge"]);
    assert_eq!((mesh.node_set("edge").unwrap(), mesh.node_set("9").unwrap()), (&[0, 4][..], &[2, 4][..]));
    assert!((mesh.surface_area("clamp").unwrap() - 1.0).abs() < 1e-15);
}

#[test]
fn unknown_names_list_what_there_is_and_suggest() {
    let mut raw = two_tets();
    raw.push(CellKind::Tri3, &[0, 1, 2], &[1]);
    raw.push(CellKind::Tri3, &[0, 1, 3], &[2]);
    raw.name_group(2, 1, "clamp");
    raw.name_group(2, 2, "tip");
    let mesh = Mesh::build(raw).unwrap();
    assert_eq!(
        mesh.surface("clmp").unwrap_err().to_string(),
        "surface \"clmp\" not found in two.msh; it has: clamp, tip. Did you mean \"clamp\"?"
    );
    assert_eq!(mesh.region("muscle").unwrap_err().to_string(), "region \"muscle\" not found in two.msh; it has: body");
    assert!(mesh.node_set("a").unwrap_err().to_string().ends_with("it has none"));
}

#[test]
fn cells_without_a_group_are_noted() {
    let mut raw = two_tets();
    raw.blocks[0].nodes.truncate(4);
    raw.push(CellKind::Tet4, &[1, 2, 3, 4], &[7]);
    let mesh = Mesh::build(raw).unwrap();
    assert_eq!(mesh.regions().keys().collect::<Vec<_>>(), ["7"]);
    assert!(has_note(&mesh, "1 of 2 cells belong to no group"));
}

#[test]
fn repeated_cells_are_merged_with_their_groups() {
    let mut raw = two_tets();
    raw.push(CellKind::Tet4, &[1, 0, 2, 3], &[4]);
    raw.push(CellKind::Tet4, &[2, 3, 0, 1], &[5]);
    let mesh = Mesh::build(raw).unwrap();
    assert_eq!(mesh.cells(), 2);
    assert_eq!((mesh.region("4").unwrap(), mesh.region("5").unwrap()), (&[0][..], &[0][..]));
    assert!(has_note(&mesh, "2 cells were listed more than once"));
}

#[test]
fn unused_nodes_are_dropped_and_the_way_back_is_kept() {
    let mut raw = two_tets();
    raw.points.insert(2, [9.0; 3]);
    raw.blocks[0].nodes = vec![0, 1, 3, 4, 1, 3, 4, 5];
    raw.vertices = vec![(2, 1), (5, 1)];
    raw.name_group(0, 1, "pins");
    let mesh = Mesh::build(raw).unwrap();
    assert_eq!(mesh.points().len(), 5);
    assert_eq!(mesh.node_origin(), [0, 1, 3, 4, 5]);
    assert_eq!(mesh.node_set("pins").unwrap(), [4]);
    assert!(has_note(&mesh, "1 nodes belong to no cell") && has_note(&mesh, "node set \"pins\""));
}

#[test]
fn kinds_are_grouped_and_origins_kept() {
    let mut raw = RawMesh::new("mixed");
    raw.points = vec![
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [2.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [1.0, 1.0, 0.0],
        [2.0, 1.0, 0.0],
        [3.0, 0.0, 0.0],
        [3.0, 1.0, 0.0],
    ];
    raw.push(CellKind::Line2, &[0, 1], &[1]);
    raw.push(CellKind::Quad4, &[0, 1, 4, 3], &[]);
    raw.push(CellKind::Tri3, &[1, 2, 4], &[]);
    raw.push(CellKind::Tri3, &[2, 5, 4], &[]);
    raw.push(CellKind::Quad4, &[2, 6, 7, 5], &[]);
    let mesh = Mesh::build(raw).unwrap();
    assert_eq!(mesh.cell_origin(), [1, 4, 2, 3]);
    assert_eq!(
        mesh.blocks().iter().map(|b| (b.kind, b.first, b.len())).collect::<Vec<_>>(),
        [(CellKind::Quad4, 0, 2), (CellKind::Tri3, 2, 2)]
    );
    assert_eq!(mesh.cell(1).nodes, [2, 6, 7, 5]);
    assert_eq!(mesh.cell(3).nodes, [2, 5, 4]);
    assert_eq!((mesh.neighbours().len(), mesh.boundary().len()), (3, 8));
    assert!((mesh.region_volume("body").unwrap() - 3.0).abs() < 1e-15);
}

#[test]
fn first_order_surface_elements_match_second_order_cells() {
    let mut raw = RawMesh::new("two.msh");
    raw.points = CellKind::Tet10.reference_nodes().to_vec();
    raw.push(CellKind::Tet10, &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9], &[]);
    raw.push(CellKind::Tri3, &[2, 1, 0], &[1]);
    let mesh = Mesh::build(raw.clone()).unwrap();
    assert_eq!(mesh.facet_nodes(mesh.surface("1").unwrap()[0]), (CellKind::Tri6, vec![0, 2, 1, 6, 5, 4]));
    raw.push_labelled(CellKind::Tri6, &[0, 1, 2, 4, 5, 9], &[2], 31);
    assert_eq!(fault(raw), Fault::Dangling { surface: "2".into(), element: 31, kind: CellKind::Tri6 });
}

#[test]
fn surfaces_inside_the_body_are_allowed_and_noted() {
    let mut raw = two_tets();
    raw.push(CellKind::Tri3, &[1, 2, 3], &[6]);
    let mesh = Mesh::build(raw).unwrap();
    assert_eq!(mesh.surface("6").unwrap(), [Facet { cell: 0, face: 1 }]);
    assert!(has_note(&mesh, "surface \"6\": 1 facets lie between two cells"));
}

#[test]
fn plane_meshes_lie_at_z_zero() {
    let plane = |z: [f64; 3]| {
        let mut raw = RawMesh::new("two.msh");
        raw.points = vec![[0.0, 0.0, z[0]], [1.0, 0.0, z[1]], [0.0, 1.0, z[2]]];
        raw.node_labels = vec![11, 12, 13];
        raw.push(CellKind::Tri3, &[0, 1, 2], &[]);
        raw
    };
    let mesh = Mesh::build(plane([0.5; 3])).unwrap();
    assert_eq!(mesh.dim(), 2);
    assert!(mesh.points().iter().all(|p| p[2] == 0.0) && has_note(&mesh, "moved to z = 0"));
    assert!(Mesh::build(plane([0.0; 3])).unwrap().notes().is_empty());
    assert_eq!(fault(plane([0.0, 0.0, 0.1])), Fault::Membrane { node: 11, z: 0.0, other: 13, other_z: 0.1 });
    assert!(message(plane([0.0, 0.0, 0.1])).contains("Membranes and shells are not supported"));
}

#[test]
fn meshes_without_cells_are_refused() {
    let mut raw = RawMesh::new("two.msh");
    assert_eq!(fault(raw.clone()), Fault::NoCells);
    raw.points = vec![[0.0; 3], [1.0, 0.0, 0.0]];
    raw.push(CellKind::Line2, &[0, 1], &[1]);
    assert_eq!(fault(raw), Fault::NoCells);
}

#[test]
fn numbers_in_messages_are_those_of_the_file() {
    let labelled = || {
        let mut raw = two_tets();
        raw.blocks[0].labels = vec![101, 102];
        raw.node_labels = vec![21, 22, 23, 24, 25];
        raw
    };
    let mut raw = labelled();
    raw.points[3][1] = f64::NAN;
    assert!(matches!(fault(raw.clone()), Fault::NotFinite { node: 24, .. }));
    assert!(message(raw).starts_with("two.msh: node 24 has the coordinates (0, NaN, 1)"));

    let mut raw = labelled();
    raw.blocks[0].nodes[6] = 99;
    assert_eq!(fault(raw), Fault::NodeOutOfRange { cell: 102, kind: CellKind::Tet4, node: 99, nodes: 5 });

    let mut raw = labelled();
    raw.blocks[0].nodes[5] = 1;
    assert_eq!(fault(raw), Fault::RepeatedNode { cell: 102, kind: CellKind::Tet4, node: 22 });

    let mut raw = labelled();
    raw.points[4] = [0.5, 0.5, 0.0];
    assert!(matches!(fault(raw.clone()), Fault::ZeroVolume { cell: 102, .. }));
    assert!(message(raw).contains("tet4 102 has zero volume"));

    let mut raw = labelled();
    raw.push(CellKind::Tri3, &[0, 1, 4], &[3]);
    raw.name_group(2, 3, "skin");
    assert_eq!(fault(raw), Fault::Dangling { surface: "skin".into(), element: 2, kind: CellKind::Tri3 });

    let mut raw = labelled();
    raw.vertices.push((5, 3));
    assert_eq!(fault(raw), Fault::VertexOutOfRange { tag: 3, node: 5, nodes: 5 });
}

#[test]
fn lists_that_do_not_fit_are_refused() {
    let mut raw = two_tets();
    raw.blocks[0].nodes.pop();
    assert!(matches!(fault(raw), Fault::Inconsistent { found: 7, expected: 8, .. }));
    let mut raw = two_tets();
    raw.blocks[0].labels = vec![1];
    assert!(matches!(fault(raw), Fault::Inconsistent { found: 1, expected: 2, .. }));
    let mut raw = two_tets();
    raw.node_labels = vec![1, 2];
    assert!(matches!(fault(raw), Fault::Inconsistent { found: 2, expected: 5, .. }));
}

#[test]
fn folded_cells_are_refused() {
    // A quadrilateral in the zigzag order of image grids crosses itself.
    let mut raw = RawMesh::new("two.msh");
    raw.points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
    raw.push(CellKind::Quad4, &[0, 1, 2, 3], &[]);
    let found = fault(raw);
    assert!(matches!(found, Fault::Folded { cell: 0, kind: CellKind::Quad4, .. }));
    assert!(!found.to_string().contains("HighOrderOptimize"), "a cell of straight edges is not curved");
    // A midside node pulled past a corner.
    let mut raw = RawMesh::new("two.msh");
    raw.points = CellKind::Tet10.reference_nodes().to_vec();
    raw.points[4] = [1.9, 0.0, 0.0];
    raw.push(CellKind::Tet10, &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9], &[]);
    let found = fault(raw);
    assert!(matches!(found, Fault::Folded { .. }));
    assert!(found.to_string().ends_with("Gmsh untangles curved cells: -setnumber Mesh.HighOrderOptimize 2"), "{found}");
}

#[test]
fn flat_cells_are_found_far_from_the_origin() {
    let flat = |offset: f64| {
        let mut raw = RawMesh::new("two.msh");
        let h = 1e-3;
        raw.points = [[0.0, 0.0, 0.0], [1.0, 0.3, 0.1], [0.2, 1.0, 0.7], [0.6, 0.65, 0.4]]
            .map(|p| p.map(|x: f64| offset + h * x / 3.0))
            .to_vec();
        raw.push(CellKind::Tet4, &[0, 1, 2, 3], &[]);
        raw
    };
    for offset in [0.0, 1.0, 100.0, 1e6] {
        assert!(matches!(fault(flat(offset)), Fault::ZeroVolume { .. }), "{offset}");
    }
}

#[test]
fn coordinates_whose_volume_overflows_are_refused() {
    let mut raw = two_tets();
    raw.scale(1e200);
    assert!(matches!(fault(raw), Fault::ZeroVolume { .. } | Fault::Folded { .. }));
}

#[test]
fn cells_must_meet_properly() {
    let mut raw = two_tets();
    raw.points.push([2.0, 2.0, 2.0]);
    raw.push(CellKind::Tet4, &[1, 2, 3, 5], &[]);
    assert_eq!(fault(raw), Fault::NonManifold { cells: vec![0, 1, 2] });

    let mut raw = two_tets();
    raw.points[4] = [0.1; 3];
    assert_eq!(fault(raw), Fault::Overlap { cells: [0, 1] });

    let mut raw = two_tets();
    let middles: Vec<[f64; 3]> = CellKind::Tet10.reference_nodes()[4..].to_vec();
    raw.points.extend(middles);
    raw.blocks.clear();
    raw.push(CellKind::Tet10, &[0, 1, 2, 3, 5, 6, 7, 8, 9, 10], &[]);
    raw.push(CellKind::Tet4, &[1, 2, 3, 4], &[]);
    assert_eq!(fault(raw), Fault::NonConforming { cells: [0, 1], kinds: [CellKind::Tet10, CellKind::Tet4] });
}

#[test]
fn cells_that_share_corners_share_midside_nodes_too() {
    let glued = |middle: u32| {
        let mut raw = RawMesh::new("two.msh");
        raw.points = CellKind::Quad8.reference_nodes().to_vec();
        raw.points.extend([[3.0, -1.0, 0.0], [3.0, 1.0, 0.0], [2.0, -1.0, 0.0], [3.0, 0.0, 0.0], [2.0, 1.0, 0.0]]);
        raw.points.push([1.0, 0.0, 0.0]);
        raw.push(CellKind::Quad8, &[0, 1, 2, 3, 4, 5, 6, 7], &[]);
        raw.push(CellKind::Quad8, &[1, 8, 9, 2, 10, 11, 12, middle], &[]);
        raw
    };
    assert_eq!(Mesh::build(glued(5)).unwrap().neighbours().len(), 1);
    assert_eq!(fault(glued(13)), Fault::NonConforming { cells: [0, 1], kinds: [CellKind::Quad8; 2] });
}

#[test]
fn odd_meshes_are_noted() {
    let mut raw = two_tets();
    raw.points.extend([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    raw.blocks[0].nodes[4..7].copy_from_slice(&[5, 6, 7]);
    raw.name_group(2, 40, "nowhere");
    let mesh = Mesh::build(raw).unwrap();
    assert!(mesh.coincident_nodes() == 3 && has_note(&mesh, "2 separate pieces"));
    assert!(has_note(&mesh, "group \"nowhere\" (dimension 2) has no elements"));
    assert_eq!(mesh.pieces(), [0, 1]);
}

#[test]
fn moved_meshes_are_checked_again() {
    let mesh = || box_mesh([1.0; 3], [2; 3], CellKind::Hex27).unwrap();
    let bent = mesh().mapped(|[x, y, z]| [x + 0.1 * y * z, y, z - 0.2 * x * x]).unwrap();
    // det = 1 + 0.04 x y
    assert!((bent.region_volume("body").unwrap() - 1.01).abs() < 1e-13);
    assert_eq!(mesh().scaled(1e-3).unwrap().size(), [1e-3; 3]);
    let fails = |r: Result<Mesh, MeshError>| match r.unwrap_err() {
        MeshError::Faulty { fault, .. } => *fault,
        other => panic!("unexpected {other}"),
    };
    assert!(matches!(fails(mesh().mapped(|[x, y, z]| [-x, y, z])), Fault::InsideOut { cell: 0, .. }));
    assert!(matches!(fails(mesh().mapped(|[x, y, _]| [x, y, 0.0])), Fault::ZeroVolume { .. }));
    assert!(matches!(fails(mesh().mapped(|[x, y, z]| [x * (x - 0.7), y, z])), Fault::Folded { .. }));
    assert!(matches!(fails(mesh().mapped(|[x, y, z]| [x / 0.0, y, z])), Fault::NotFinite { .. }));
    assert!(matches!(fails(mesh().with_points(vec![])), Fault::Inconsistent { .. }));
    assert!(matches!(fails(mesh().scaled(-1.0)), Fault::Scale { .. }));
}

#[test]
fn building_is_deterministic() {
    let make = || box_mesh([1.0, 2.0, 3.0], [4, 3, 5], CellKind::Tet10).unwrap();
    assert_eq!(make(), make());
}
