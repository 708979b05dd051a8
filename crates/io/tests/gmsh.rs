//! Gmsh files of every element type, in every format.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // clippy.toml frees test functions, not their helpers

use std::collections::BTreeSet;
use std::f64::consts::PI;
use std::path::PathBuf;

use nastic_io::{parse_gmsh, read_gmsh, read_gmsh_scaled, read_mesh};
use nastic_mesh::{CellKind, Mesh};

const FORMATS: [&str; 4] = ["22a", "22b", "41a", "41b"];

/// Area of the slanted rectangle of `data/make.py`, by the shoelace formula.
const AREA: f64 = 2.19;
const HEIGHT: f64 = 1.5;

fn data(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)
}

fn meshes(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../meshes").join(name)
}

/// The same file content in four formats, under one name.
fn four(name: &str) -> [Mesh; 4] {
    FORMATS.map(|format| {
        let file = data(&format!("{name}.{format}.msh"));
        read_gmsh(&file).unwrap_or_else(|error| panic!("{error}")).named(name)
    })
}

/// The meshes are the same, up to what 2.2 lists twice and says so. Gmsh prints 16 digits, one less than a real holds.
fn same(meshes: &[Mesh; 4]) -> &Mesh {
    assert_eq!(meshes[0].points(), meshes[2].points());
    assert_eq!(meshes[1].points(), meshes[3].points());
    for (text, binary) in meshes[0].points().as_flattened().iter().zip(meshes[1].points().as_flattened()) {
        assert!((text - binary).abs() < 1e-15, "{text} {binary}");
    }
    for mesh in &meshes[1..] {
        assert_eq!(mesh.blocks(), meshes[0].blocks());
        assert_eq!(mesh.regions(), meshes[0].regions());
        assert_eq!(mesh.surfaces(), meshes[0].surfaces());
        assert_eq!(mesh.node_sets(), meshes[0].node_sets());
    }
    &meshes[0]
}

fn measure(mesh: &Mesh) -> f64 {
    (0..mesh.cells())
        .map(|id| {
            let cell = mesh.cell(id);
            cell.kind.measure(&mesh.gather(mesh.points(), cell.nodes))
        })
        .sum()
}

/// Every node of a straight cell lies where its corners put it: a wrong permutation cannot pass.
fn assert_nodes_in_vtk_order(mesh: &Mesh) {
    for id in 0..mesh.cells() {
        let cell = mesh.cell(id);
        let positions = mesh.gather(mesh.points(), cell.nodes);
        let corners = &positions[..cell.kind.corners()];
        for (position, xi) in positions.iter().zip(cell.kind.reference_nodes()) {
            let straight = cell.kind.corner_kind().map(corners, xi);
            let distance = (0..3).map(|i| (position[i] - straight[i]).powi(2)).sum::<f64>().sqrt();
            assert!(distance < 1e-9, "{}: cell {id}, node at {xi:?} is off by {distance}", cell.kind);
        }
    }
}

#[test]
fn every_kind_in_four_formats_is_the_same_mesh() {
    for kind in CellKind::ALL.into_iter().filter(|kind| kind.dim() > 1) {
        let meshes = four(kind.name());
        let mesh = same(&meshes);
        assert!(mesh.blocks().len() == 1 && mesh.blocks()[0].kind == kind, "{kind}");
        assert!(mesh.notes().is_empty(), "{kind}: {:?}", mesh.notes());
        assert_nodes_in_vtk_order(mesh);
        let solid = kind.dim() == 3;
        let expected = if solid { AREA * HEIGHT } else { AREA };
        assert!((measure(mesh) - expected).abs() < 1e-9, "{kind}: {}", measure(mesh));
        assert_eq!(mesh.region("body").unwrap().len(), mesh.cells());
        let simplex = matches!(kind.corner_kind(), CellKind::Tri3 | CellKind::Tet4);
        assert_eq!(mesh.surface("clamp").unwrap().len(), if simplex && solid { 2 } else { 1 }, "{kind}");
        for facet in mesh.surface("clamp").unwrap() {
            let (_, nodes) = mesh.facet_nodes(*facet);
            assert!(nodes.iter().all(|node| mesh.points()[*node as usize][0].abs() < 1e-12));
        }
        assert_eq!(mesh.surfaces().keys().collect::<Vec<_>>(), ["clamp", "skin"]);
        let corner = mesh.node_set("corner").unwrap();
        assert_eq!(mesh.points()[corner[0] as usize], [2.2, 1.2, 0.0]);
        if solid {
            assert_eq!(mesh.node_set("edge").unwrap().len(), if kind.order() == 2 { 5 } else { 3 });
        }
    }
}

#[test]
fn groups_without_names_bear_their_tags() {
    let meshes = four("bare");
    let mesh = same(&meshes);
    assert_eq!(mesh.regions().keys().collect::<Vec<_>>(), ["1"]);
    assert_eq!(mesh.surfaces().keys().collect::<Vec<_>>(), ["2", "3"]);
    assert_eq!(mesh.node_sets().keys().collect::<Vec<_>>(), ["4", "5"]);
}

#[test]
fn without_groups_everything_is_the_body() {
    for file in ["plain.22a.msh", "plain.41a.msh"] {
        let mesh = read_gmsh(data(file)).unwrap();
        assert_eq!(mesh.regions().keys().collect::<Vec<_>>(), ["body"]);
        assert!(mesh.surfaces().is_empty() && mesh.node_sets().is_empty());
    }
}

#[test]
fn parametric_nodes_and_partitions_are_read_over() {
    for name in ["parametric", "partitioned"] {
        let meshes = four(name);
        let kind = if name == "parametric" { "tet10" } else { "hex8" };
        let plain = read_gmsh(data(&format!("{kind}.41a.msh"))).unwrap();
        for mesh in &meshes {
            assert_eq!(mesh.cells(), plain.cells());
            assert!((measure(mesh) - measure(&plain)).abs() < 1e-12);
            assert_eq!(mesh.region("body").unwrap().len(), plain.cells(), "{name}");
            for (surface, facets) in plain.surfaces() {
                assert_eq!(mesh.surface(surface).unwrap().len(), facets.len(), "{name}");
            }
        }
    }
}

#[test]
fn overlapping_groups_hold_their_cells_in_both_formats() {
    let meshes = four("overlap");
    let mesh = same(&meshes);
    let region = |name: &str| mesh.region(name).unwrap().to_vec();
    assert_eq!((region("left"), region("right"), region("all of it")), (vec![0], vec![1], vec![0, 1]));
    assert_eq!(mesh.surface("middle").unwrap().len(), 1);
    // 2.2 lists the cells twice, once per group; 4.1 does not.
    let merged = |mesh: &Mesh| mesh.notes().iter().any(|note| note.contains("listed more than once"));
    assert_eq!(meshes.each_ref().map(merged), [true, true, false, false]);
    assert!(meshes[3].notes().iter().any(|note| note.contains("\"middle\"")), "{:?}", meshes[3].notes());
}

#[test]
fn kinds_may_be_mixed() {
    let meshes = four("mixed");
    let mesh = same(&meshes);
    let kinds: Vec<_> = mesh.blocks().iter().map(|block| (block.kind, block.len())).collect();
    assert_eq!(kinds, [(CellKind::Tri6, 2), (CellKind::Quad9, 1)]);
    assert_nodes_in_vtk_order(mesh);
}

#[test]
fn lengths_are_scaled() {
    let file = data("hex20.41b.msh");
    let (metres, millimetres) = (read_gmsh(&file).unwrap(), read_gmsh_scaled(&file, 1e-3).unwrap());
    assert!((measure(&millimetres) / measure(&metres) - 1e-9).abs() < 1e-20);
    for scale in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let message = read_mesh(&file, scale).unwrap_err().to_string();
        assert!(message.contains("hex20.41b.msh") && message.contains("1e-3"), "{message}");
    }
}

#[test]
fn a_mirrored_mesh_is_mended_and_says_so() {
    let text = std::fs::read_to_string(data("tet10.41a.msh")).unwrap();
    let right = parse_gmsh("right.msh", text.as_bytes(), 1.0).unwrap();
    let (head, rest) = text.split_once("$Nodes").unwrap();
    let (nodes, tail) = rest.split_once("$EndNodes").unwrap();
    // Lines of three words are coordinates; mirror z.
    let mirrored: Vec<String> = nodes
        .lines()
        .map(|line| match line.split(' ').collect::<Vec<_>>()[..] {
            [x, y, z] => format!("{x} {y} {}", -z.parse::<f64>().unwrap()),
            _ => line.to_owned(),
        })
        .collect();
    let text = format!("{head}$Nodes{}\n$EndNodes{tail}", mirrored.join("\n"));
    let mended = parse_gmsh("mirrored.msh", text.as_bytes(), 1.0).unwrap();
    assert!((measure(&mended) - measure(&right)).abs() < 1e-12);
    assert_nodes_in_vtk_order(&mended);
    let note = mended.notes().join("; ");
    assert!(note.contains("negative volume") && note.contains(&format!("{} cells", right.cells())), "{note}");
}

#[test]
fn the_committed_meshes_are_what_their_scripts_say() {
    // The stem's section is four quarter circles as parabolas through their ends and middles, about a square.
    let corner = std::f64::consts::FRAC_1_SQRT_2;
    let stem = (2.0 + 16.0 / 3.0 * corner * (1.0 - corner)) * 0.005f64.powi(2) * 0.1;
    // The target: a bar on an arc of angle 0.62; volume and area of its ends as the straight bar's.
    let (radius, half) = (8.5_f64, 1.25_f64);
    let inside = half * (radius * radius - half * half).sqrt() + radius * radius * (half / radius).asin();
    let berry = PI * radius * radius + 2.0 * half * 30.0 - inside;
    let expected = [
        ("cantilever.msh", CellKind::Hex27, 0.04),
        ("cantilever_tet.msh", CellKind::Tet10, 0.04),
        ("target.msh", CellKind::Tet10, 0.04),
        ("strip_tri6.msh", CellKind::Tri6, 0.1),
        ("strip_quad9.msh", CellKind::Quad9, 0.1),
        ("t.msh", CellKind::Hex27, (0.8 * 0.2 + 0.2) * 0.05),
        ("t_tet.msh", CellKind::Tet10, (0.8 * 0.2 + 0.2) * 0.05),
        ("stem.msh", CellKind::Hex20, stem),
        ("finger.msh", CellKind::Hex20, 1e-9 * (47.0 * 7.0 * 14.5 - 4.0 * 2.0 * 7.0 * 6.5 - 1300.0)),
        ("arch.msh", CellKind::Quad9, 0.02),
        ("petal.msh", CellKind::Hex27, (4.0 * 0.13 * 0.06 + 0.06 * 0.06) * 1e-3),
        // Of the tutorials, in millimetres.
        ("first_finger.msh", CellKind::Tet10, 80.0 * 12.0 * 12.0),
        ("jointed_finger.msh", CellKind::Tet10, 80.0 * 12.0 * 12.0),
        ("bent_finger.msh", CellKind::Tet10, (40.0 + 38.0) * 12.0 * 12.0),
        // Fingers less their chambers, the disc and what of the stalk is outside of it.
        ("berry.msh", CellKind::Tri6, 2.0 * (600.0 - 7.0 * 4.0 * 5.5) + berry),
        ("carry.msh", CellKind::Tri6, 2.0 * (600.0 - 7.0 * 4.0 * 5.5) + PI * radius * radius),
        ("torus.msh", CellKind::Tet4, 2.0 * PI * PI * 59.4 * 28.4 * 28.4),
        // Caps of spheres, the outer one less the inner one.
        ("bowl.msh", CellKind::Tet4, PI / 3.0 * (40.0 * 40.0 * (138.0 - 40.0) - 34.0 * 34.0 * (120.0 - 34.0))),
        ("disc.msh", CellKind::Hex27, PI * 20.0 * 20.0 * 2.0),
        // As thick as the disc, its middle surface larger by a^2/4R^2 of the radius a, to second order.
        ("saddle.msh", CellKind::Tet4, PI * 20.0 * 20.0 * 2.0 * (1.0 + 0.25 * (20.0f64 / 100.0).powi(2))),
        ("bilayer.msh", CellKind::Hex27, 32.0 * 8.0 * 0.6),
        ("tube.msh", CellKind::Hex20, PI * (8.0 * 8.0 - 6.0 * 6.0) * 60.0),
        ("manipulator.msh", CellKind::Tet10, PI * 1e-9 * (81.0 * 40.0 - 3.0 * 2.2 * 2.2 * 32.0)),
    ];
    let committed =
        std::fs::read_dir(meshes("")).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let committed: BTreeSet<String> = committed.filter(|name| name.ends_with(".msh")).collect();
    assert_eq!(committed, expected.iter().map(|(file, ..)| (*file).to_owned()).collect(), "a mesh without its row");
    for (file, kind, volume) in expected {
        let mesh = read_mesh(meshes(file), 1.0).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(mesh.blocks().len(), 1, "{file}");
        assert_eq!(mesh.blocks()[0].kind, kind, "{file}");
        // Quadratic sides meet the arc to fourth order in the size of an element; the sides of the manipulator are straight.
        let tolerance = match file {
            "manipulator.msh" => 0.015,
            // straight facets, a third of the tube's circumference long
            "torus.msh" => 0.07,
            "bowl.msh" => 0.01,
            "berry.msh" | "carry.msh" => 1e-5,
            "saddle.msh" => 0.003,
            "tube.msh" | "disc.msh" => 1e-4,
            _ => 1e-6,
        };
        assert!((measure(&mesh) / volume - 1.0).abs() < tolerance, "{file}: {}", measure(&mesh));
        // two fingers and what they hold
        let notes = usize::from(["berry.msh", "carry.msh"].contains(&file));
        assert_eq!(mesh.notes().len(), notes, "{file}: {:?}", mesh.notes());
        assert!(mesh.regions().len() > 1 || mesh.region("body").is_ok(), "{file}");
    }
    let target = read_gmsh(meshes("target.msh")).unwrap();
    let tip = target.nodes_of_facets(target.surface("tip").unwrap());
    let heights = tip.iter().map(|node| target.points()[*node as usize][2]);
    let (low, high) = heights.fold((f64::MAX, f64::MIN), |(low, high), z| (low.min(z), high.max(z)));
    assert!((0.5 * (low + high) - 0.1 - 0.3).abs() < 1e-3, "tip at {}", 0.5 * (low + high));
    let cantilever = read_gmsh(meshes("cantilever.msh")).unwrap();
    assert_eq!((cantilever.points().len(), cantilever.cells()), (525, 40));
    assert_eq!(cantilever.surface("clamp").unwrap().len(), 4);
}

#[test]
fn formats_are_numbers_and_names_have_no_blanks_around_them() {
    let two = std::fs::read_to_string(data("tet4.22a.msh")).unwrap();
    let four = std::fs::read_to_string(data("tet4.41a.msh")).unwrap();
    let plain = parse_gmsh("x", two.as_bytes(), 1.0).unwrap();
    for (text, from, to) in
        [(&two, "2.2 0 8", "2.000000 0 8"), (&two, "2.2 0 8", "2 0 8"), (&four, "4.1 0 8", "4.100000 0 8")]
    {
        assert!(text.contains(from));
        let read =
            parse_gmsh("x", text.replacen(from, to, 1).as_bytes(), 1.0).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!((read.blocks(), read.surfaces()), (plain.blocks(), plain.surfaces()), "{to}");
    }
    for (from, to) in [("2.2 0 8", "1.999 0 8"), ("2.2 0 8", "3.0 0 8"), ("2.2 0 8", "nan 0 8"), ("2.2 0 8", "5.0 0 8")]
    {
        let message = parse_gmsh("x", two.replacen(from, to, 1).as_bytes(), 1.0).unwrap_err().to_string();
        assert!(message.contains(&format!("format {}", &to[..to.len() - 4])), "{message}");
    }
    let padded = two.replace("\"clamp\"", &format!("\"{:80}\"", "clamp"));
    let read = parse_gmsh("x", padded.as_bytes(), 1.0).unwrap();
    assert_eq!(read.surfaces(), plain.surfaces());
    assert!(
        read.notes().contains(&"blanks around names of groups dropped: \"clamp\" (files of MED have them)".to_owned())
    );
    let fluent = "(0 \"GAMBIT to Fluent File\")\n(2 3)\n(10 (0 1 8 1 3))\n";
    let message = parse_gmsh("dir/duct.msh", fluent.as_bytes(), 1.0).unwrap_err().to_string();
    assert!(
        message.contains("a mesh of ANSYS Fluent")
            && message.contains("--input-format ansys dir/duct.msh dir/duct.vtu"),
        "{message}"
    );
}
