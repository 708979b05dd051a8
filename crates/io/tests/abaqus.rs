//! Input files of Abaqus and CalculiX: sets, surfaces, instances by hand, with volumes and areas that are known; what is refused.

#![allow(clippy::unwrap_used, clippy::panic)] // clippy.toml frees test functions, not their helpers

use nastic_io::{parse_abaqus, read_mesh};
use nastic_mesh::{CellKind, Mesh};

/// Two unit cubes along x, in the ways of writing that files have.
const TWO_CUBES: &str = "*HEADING\nby hand\n** a comment\n*Node, nset=All\n  1, 0., 0., 0.\n 2, 1.0E0, 0, 0\n3, 2D0, 0, 0\n4, 0, 1\n5, 1, 1,\n6, 2, 1\n\
 11, 0, 0, 1\n12, 1, 0, 1\n13, 2, 0, 1\n14, 0, 1, 1\n15, 1, 1, 1\n16, 2, 1, 1\n99, 5, 5, 5\n\
 *ELEMENT, TYPE=C3D8RH,\nELSET=Cubes\n7, 1, 2, 5, 4,\n 11, 12, 15, 14\n8, 2, 3, 6, 5, 12, 13, 16, 15\n\
 *Elset, elset=\"Left\"\n7,\n*ELSET, ELSET=right, GENERATE\n8, 20, 4\n*ELSET, ELSET=both\nLEFT, Right\n*ELSET, ELSET=_own, INTERNAL\n8\n\
 *NSET, NSET=edge, GENERATE\n1, 14, 10\n*NSET, NSET=loose\n99, 1000\n\
 *SURFACE, NAME=End\nLeft, S6\n*SURFACE, NAME=top, TYPE=ELEMENT\n7, S2\nright, s2\n*SURFACE, NAME=around\nright\n*SURFACE, NAME=points, TYPE=NODE\nedge, 1.\n2\n\
 *MATERIAL, NAME=rubber\n*HYPERELASTIC\n1., 2.\n*ELEMENT, TYPE=MASS, ELSET=m\n9, 1\n*INCLUDE, INPUT=more.inp\n*STEP\n*END STEP\n";

fn read(text: &str) -> Mesh {
    parse_abaqus("x.inp", text.as_bytes(), 1.0).unwrap_or_else(|error| panic!("{error}"))
}

fn refusal(text: &str) -> String {
    parse_abaqus("bad.inp", text.as_bytes(), 1.0).map_or_else(|error| error.to_string(), |_| "read".to_owned())
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-12
}

#[test]
fn sets_become_regions_surfaces_and_node_sets() {
    let mesh = read(TWO_CUBES);
    assert!(near(mesh.measures().volume, 2.0) && mesh.cells() == 2);
    let regions: Vec<&str> = mesh.regions().keys().map(String::as_str).collect();
    assert_eq!(regions, ["Cubes", "Left", "both", "right"]);
    assert!(near(mesh.region_volume("right").unwrap(), 1.0) && near(mesh.region_volume("both").unwrap(), 2.0));
    for (name, area) in [("End", 1.0), ("top", 2.0), ("around", 5.0)] {
        assert!(near(mesh.surface_area(name).unwrap(), area), "{name}: {}", mesh.surface_area(name).unwrap());
    }
    let places = |name: &str| -> Vec<[f64; 3]> {
        mesh.node_set(name).unwrap().iter().map(|&node| mesh.points()[node as usize]).collect()
    };
    assert_eq!(places("edge"), [[0.0, 0.0, 0.0], [0.0, 0.0, 1.0]]);
    assert_eq!(places("points"), [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]);
    assert!(places("points").iter().all(|point| point[1] == 0.0) && mesh.node_set("All").unwrap().len() == 12);
    let end = mesh.nodes_of_facets(mesh.surface("End").unwrap());
    assert!(end.iter().all(|&node| mesh.points()[node as usize][0] == 0.0));
    let notes = mesh.notes().join("\n");
    for part in [
        "files of *INCLUDE are not read: \"more.inp\" (line ",
        "1 elements of type MASS passed over",
        "1 members of the set \"loose\" are not in the file",
        "the mesh alone is read, not *END STEP, *HYPERELASTIC, *MATERIAL, *STEP",
        "1 nodes belong to no cell; dropped",
    ] {
        assert!(notes.contains(part), "{part}:\n{notes}");
    }
}

/// meshio lists Gmsh's entities as a set, by numbers that are none of elements.
#[test]
fn sets_of_meshio_that_are_none_are_left_out() {
    let mesh = read(
        &TWO_CUBES.replace("*NSET, NSET=loose", "*ELSET, ELSET=gmsh:bounding_entities\n-1, 7\n2\n*NSET, NSET=loose"),
    );
    assert!(mesh.cells() == 2 && mesh.regions().keys().all(|name| !name.contains("gmsh")));
    let notes = mesh.notes().join("\n");
    assert!(notes.contains("the set \"gmsh:bounding_entities\" lists no elements"), "{notes}");
}

/// A cube whose instances are moved, and turned about a line.
const PARTS: &str = "*PART, NAME=Cube\n*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,0,0,1\n6,1,0,1\n7,1,1,1\n8,0,1,1\n\
 *ELEMENT, TYPE=C3D8, ELSET=solid\n1,1,2,3,4,5,6,7,8\n*NSET, NSET=foot\n1,2,3,4\n*SURFACE, NAME=face\nsolid, S4\n*END PART\n\
 *ASSEMBLY, NAME=A\n*INSTANCE, NAME=One, PART=cube\n10., 0., 0.\n*END INSTANCE\n*INSTANCE, NAME=Two, PART=CUBE\n0., 0., 0.\n0,0,0, 0,0,1, 90.\n*END INSTANCE\n\
 *NSET, NSET=pair, INSTANCE=One\n1\n*NSET, NSET=pair\nTwo.2, Two.foot\n*ELSET, ELSET=all\nOne.solid, Two.1\n*SURFACE, NAME=walls\nOne.solid, S4\nTwo.solid, S4\n*END ASSEMBLY\n";

#[test]
fn instances_of_parts_are_moved_and_name_their_sets() {
    let mesh = read(PARTS);
    assert_eq!((mesh.cells(), mesh.points().len()), (2, 16));
    let regions: Vec<&str> = mesh.regions().keys().map(String::as_str).collect();
    assert_eq!(regions, ["One.solid", "Two.solid", "all"]);
    let centre = |name: &str| mesh.cell_centre(mesh.region(name).unwrap()[0] as usize);
    assert!(centre("One.solid").iter().zip([10.5, 0.5, 0.5]).all(|(a, b)| near(*a, b)), "{:?}", centre("One.solid"));
    assert!(centre("Two.solid").iter().zip([-0.5, 0.5, 0.5]).all(|(a, b)| near(*a, b)), "{:?}", centre("Two.solid"));
    assert_eq!(mesh.node_set("pair").unwrap().len(), 5);
    assert!(near(mesh.surface_area("walls").unwrap(), 2.0));
    // the face x = 1 of a cube that was turned by a quarter: y = 1
    let wall = mesh.nodes_of_facets(mesh.surface("Two.face").unwrap());
    assert!(wall.iter().all(|&node| near(mesh.points()[node as usize][1], 1.0)));
    // alone, an instance does not show in names
    let cut = PARTS.find("*INSTANCE, NAME=Two").unwrap();
    let one = read(&format!("{}*END ASSEMBLY\n", &PARTS[..cut]));
    assert_eq!(one.regions().keys().collect::<Vec<_>>(), ["solid"]);
    assert!(one.surfaces().contains_key("face") && one.node_sets().contains_key("foot"));
}

#[test]
fn plane_bodies_take_their_edges_by_number_or_by_trusses() {
    let nodes = "*NODE\n1,0,0\n2,2,0\n3,2,1\n4,0,1\n";
    let elements = "*ELEMENT,TYPE=CPS4R,ELSET=plate\n1,1,2,3,4\n*ELEMENT,TYPE=T2D2,ELSET=left\n2,4,1\n*SURFACE,NAME=right\nplate,S2\n";
    let mesh = read(&format!("{nodes}{elements}"));
    assert_eq!((mesh.dim(), mesh.cell(0).kind), (2, CellKind::Quad4));
    assert!(near(mesh.surface_area("left").unwrap(), 1.0) && near(mesh.surface_area("right").unwrap(), 1.0));
    assert!(mesh.notes().contains(&"plane stress elements (CPS4R) are taken in plane strain".to_owned()));
    let strain = read(&format!("{nodes}{}", elements.replace("CPS4R", "CPE4H")));
    assert!(strain.notes().iter().all(|note| !note.contains("plane")), "{:?}", strain.notes());
    let shell = refusal(&format!("{nodes}{}", elements.replace("CPS4R", "S4R")));
    assert!(shell.contains("a body of shells or membranes (S4R, line 6)"), "{shell}");
    let round = refusal(&format!("{nodes}{}", elements.replace("CPS4R", "CAX4")));
    assert!(round.contains("line 6, in *ELEMENT: the element type CAX4"), "{round}");
}

#[test]
fn what_is_wrong_is_named_with_its_line() {
    for (from, to, words) in [
        ("7, 1, 2, 5, 4,\n", "7, 1, 2, 5, 44,\n", "line 21, in *ELEMENT: element 7 names node 44"),
        ("11, 12, 15, 14\n", "11, 12, 15\n", "elements"),
        ("8, 2, 3, 6, 5, 12", "7, 2, 3, 6, 5, 12", "element 7 is defined twice"),
        ("4, 0, 1\n", "4, 0, 1e999\n", "`1e999` where a number was expected"),
        ("4, 0, 1\n", "3, 0, 1\n", "node 3 is defined twice"),
        ("C3D8RH", "C3D6", "the element type C3D6"),
        ("Left, S6", "Left, S7", "element 7 (hex8) has no face \"S7\""),
        ("Left, S6", "Lift, S6", "there is no set of elements \"Lift\" before it"),
        (
            "*NSET, NSET=edge, GENERATE\n1, 14, 10",
            "*NSET, NSET=edge, GENERATE\n1",
            "GENERATE needs a first and a last number",
        ),
        ("*NSET, NSET=edge, ", "*NSET, ", "it has no NSET="),
        ("*MATERIAL, NAME=rubber", "*NGEN", "*NGEN is not supported"),
        ("*Node, nset=All", "*NODE, SYSTEM=C", "polar coordinates"),
        ("*Node, nset=All", "*NODE, INPUT=nodes.txt", "data in another file (INPUT=nodes.txt)"),
    ] {
        let bad = TWO_CUBES.replacen(from, to, 1);
        assert_ne!(bad, TWO_CUBES, "{from}");
        let message = refusal(&bad);
        let fits = if words == "elements" { message.contains("element") } else { message.contains(words) };
        assert!(message.starts_with("bad.inp, line ") && fits, "{from} -> {to}: {message}");
    }
    assert!(refusal(&PARTS.replace("PART=cube", "PART=tube")).contains("there is no part \"tube\" before it"));
    assert!(refusal("*NODE\n1,0,0,0\n").contains("the file has no elements"));
    assert!(refusal("*STEP\n").contains("the file has no elements"));
}

#[test]
fn numbers_that_claim_much_take_no_memory_and_damage_no_thread() {
    let huge = TWO_CUBES.replace("8, 20, 4", "8, 18446744073709551615, 4");
    assert_eq!(read(&huge).regions(), read(TWO_CUBES).regions());
    // a set of itself, doubled at every line
    let doubled: String = (0..64).map(|_| "*ELSET, ELSET=Cubes\nCubes, Cubes\n").collect();
    assert_eq!(read(&format!("{TWO_CUBES}{doubled}")).regions(), read(TWO_CUBES).regions());
    let whole = [TWO_CUBES, PARTS];
    let mut dice = 1_u64;
    for k in 0..4000 {
        let mut bad = whole[k % 2].as_bytes().to_vec();
        for _ in 0..3 {
            dice = dice.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            let at = (dice >> 33) as usize % bad.len();
            bad[at] = b"*,=\n0123456789-. SsE\xff"[(dice >> 20) as usize % 21];
        }
        let _ = parse_abaqus("bad.inp", &bad, 1.0);
    }
    let missing = read_mesh("nowhere.inp", 1.0).unwrap_err().to_string();
    assert!(missing.starts_with("cannot read nowhere.inp"), "{missing}");
}
