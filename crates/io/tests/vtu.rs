//! VTU files: what is written comes back; what other programs write is read.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // clippy.toml frees test functions, not their helpers

use std::path::Path;

use nastic_io::{
    Entity, WriteError, parse_vtu, read_array, read_lines, read_snapshot, read_vtu, read_vtu_scaled, write_lines,
    write_vtu,
};
use nastic_mesh::{CellKind, Mesh, NamedArray, Polyline, RawMesh, Snapshot, box_mesh, rectangle};

/// A small mesh of any kind of cell.
fn small(kind: CellKind) -> Mesh {
    match kind.dim() {
        3 => box_mesh([1.0, 0.5, 0.25], [3, 2, 1], kind).unwrap(),
        _ => rectangle([1.0, 0.5], [3, 2], kind).unwrap(),
    }
}

/// Fields that no mix-up of entities or components survives.
fn decorated(mesh: Mesh) -> Snapshot {
    let values = |count: usize, seed: f64| (0..count).map(|at| (at as f64 + seed).sin() * 1e3).collect::<Vec<_>>();
    let (points, cells) = (mesh.points().len(), mesh.cells());
    let mut energy = values(cells, 0.4);
    energy[0] = f64::NAN;
    Snapshot::new(mesh)
        .with_points("displacement", 3, values(3 * points, 0.1))
        .and_then(|it| it.with_points("tension", 1, values(points, 0.2)))
        .and_then(|it| it.with_cells("P <&\"> 1", 9, values(9 * cells, 0.3)))
        .and_then(|it| it.with_cells("energy", 1, energy))
        .unwrap()
}

fn assert_same(a: &[NamedArray], b: &[NamedArray]) {
    assert_eq!(a.len(), b.len());
    for (a, b) in a.iter().zip(b) {
        let bits = |array: &NamedArray| array.values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
        assert_eq!((&a.name, a.components, bits(a)), (&b.name, b.components, bits(b)));
    }
}

fn assert_same_mesh(a: &Mesh, b: &Mesh) {
    assert_eq!(a.points(), b.points());
    assert_eq!(a.blocks(), b.blocks());
    assert_eq!(a.regions(), b.regions());
    assert_eq!(a.surfaces(), b.surfaces());
    assert_eq!(a.node_sets(), b.node_sets());
}

/// One cell per line; a quantity that a line lacks is not a number.
#[test]
fn lines_are_polylines_with_their_quantities() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("lines.vtu");
    let line = |name: &str, points: &[[f64; 3]], quantities: &[(&str, f64)]| Polyline {
        name: name.to_owned(),
        points: points.to_vec(),
        quantities: quantities.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect(),
    };
    let long =
        line("upper", &[[0.0, 0.0, 1.0], [1.0, 0.5, 1.0], [2.0, 0.0, 1.25]], &[("tension", 3.5), ("length", 2.5)]);
    let short = line("lower", &[[0.0; 3], [2.0, 0.0, 0.0]], &[("tension", 0.0)]);
    let written = [long, short];
    write_lines(&path, &written).unwrap();
    let sorted = |mut line: Polyline| {
        line.quantities.sort_by(|a, b| a.0.cmp(&b.0));
        line
    };
    let read = read_lines(&path).unwrap();
    assert_eq!(read.into_iter().map(sorted).collect::<Vec<_>>(), written.map(sorted));
    let of = |name: &str| read_array(&path, name).unwrap();
    assert_eq!((of("tension").entity, of("tension").values), (Entity::Cell, vec![3.5, 0.0]));
    assert_eq!(of("line").values, [0.0, 1.0]);
    assert!(of("length").values[0] == 2.5 && of("length").values[1].is_nan());
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.contains(r#"<Piece NumberOfPoints="5" NumberOfCells="2">"#) && text.contains("line:lower"));
    let refused = read_vtu(&path).expect_err("lines are no body").to_string();
    assert!(refused.contains('4'), "{refused}");
}

#[test]
fn snapshots_of_every_kind_come_back_to_the_bit() {
    let directory = tempfile::tempdir().unwrap();
    for kind in CellKind::ALL.into_iter().filter(|kind| kind.dim() > 1) {
        let path = directory.path().join(format!("{kind}.vtu"));
        let written = decorated(small(kind));
        write_vtu(&path, &written).unwrap();
        let read = read_snapshot(&path).unwrap();
        assert_same_mesh(&read.mesh, &written.mesh);
        assert!(read.mesh.notes().is_empty(), "{:?}", read.mesh.notes());
        assert_same(&read.point_data, &written.point_data);
        assert_same(&read.cell_data, &written.cell_data);
        // Written again, the file is the same.
        let again = directory.path().join("again.vtu");
        write_vtu(&again, &read).unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), std::fs::read(&again).unwrap());
    }
}

#[test]
fn gmsh_groups_survive_the_way_through_vtu() {
    let directory = tempfile::tempdir().unwrap();
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    for name in ["hex27", "tet10", "quad8", "overlap", "mixed", "bare"] {
        let mesh = nastic_io::read_gmsh(data.join(format!("{name}.41b.msh"))).unwrap();
        let path = directory.path().join("mesh.vtu");
        write_vtu(&path, &Snapshot::new(mesh.clone())).unwrap();
        assert_same_mesh(&read_vtu(&path).unwrap(), &mesh);
    }
}

#[test]
fn groups_are_cell_arrays_of_zeros_and_ones_too() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("box.vtu");
    let mesh = box_mesh([1.0, 1.0, 1.0], [3, 2, 1], CellKind::Hex8).unwrap();
    let single = (0..6).map(|k| f64::from(k) / 3.0).collect();
    let written = Snapshot::new(mesh).with_cells("mean", 1, single).unwrap().in_single(&["mean"]);
    write_vtu(&path, &written).unwrap();
    for (name, count) in [("region:body", 6), ("surface:x-", 2), ("surface:y+", 3), ("surface:z+", 6)] {
        let array = read_array(&path, name).unwrap();
        assert_eq!(array.values.iter().filter(|mark| **mark == 1.0).count(), count, "{name}");
        assert_eq!(array.values.iter().filter(|mark| **mark == 0.0).count(), 6 - count, "{name}");
    }
    let read = read_snapshot(&path).unwrap();
    assert_same(&read.cell_data, &written.cell_data);
    assert_eq!(read.cell_array("mean").unwrap().values[1], f64::from(1.0_f32 / 3.0), "rounded once");
    assert!(std::fs::read_to_string(&path).unwrap().contains(r#"type="Float32" Name="mean""#));
}

#[test]
fn many_blocks_of_zlib_come_back() {
    let mesh = box_mesh([1.0, 1.0, 1.0], [40, 40, 40], CellKind::Hex8).unwrap();
    let noise = (0..3 * mesh.points().len()).map(|at| (at as f64).cos()).collect();
    let written = Snapshot::new(mesh).with_points("displacement", 3, noise).unwrap();
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("large.vtu");
    write_vtu(&path, &written).unwrap();
    assert_same(&read_snapshot(&path).unwrap().point_data, &written.point_data);
}

#[test]
fn single_arrays_are_found_by_name() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("optimum.vtu");
    let written = decorated(small(CellKind::Hex20));
    write_vtu(&path, &written).unwrap();
    let tension = read_array(&path, "tension").unwrap();
    assert_eq!((tension.entity, tension.components), (Entity::Point, 1));
    assert_eq!(tension.values, written.point_array("tension").unwrap().values);
    assert_eq!(read_array(&path, "P <&\"> 1").unwrap().entity, Entity::Cell);
    let message = read_array(&path, "tensoin").unwrap_err().to_string();
    assert!(message.contains("\"tensoin\" not found") && message.contains("displacement, tension"), "{message}");
    assert!(message.contains("energy, region"), "{message}");
}

#[test]
fn what_does_not_fit_is_refused_and_nothing_is_written() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("bad.vtu");
    let mut short = decorated(small(CellKind::Tet4));
    short.point_data[1].values.pop();
    let mut twice = decorated(small(CellKind::Tet4));
    twice.cell_data[1].name = twice.cell_data[0].name.clone();
    for (bad, says) in [(short, "\"tension\" holds"), (twice, "two cell arrays")] {
        let error = write_vtu(&path, &bad).unwrap_err();
        assert!(matches!(error, WriteError::Content { .. }) && error.to_string().contains(says), "{error}");
    }
    let under_a_file = directory.path().join("file");
    std::fs::write(&under_a_file, "").unwrap();
    let error = write_vtu(under_a_file.join("x.vtu"), &decorated(small(CellKind::Tet4))).unwrap_err();
    assert!(matches!(error, WriteError::System { .. }) && error.to_string().contains("x.vtu"), "{error}");
    assert_eq!(std::fs::read_dir(directory.path()).unwrap().count(), 1);
}

#[test]
fn plane_vectors_get_a_third_component() {
    let mesh = small(CellKind::Quad9);
    let u: Vec<f64> = (0..2 * mesh.points().len()).map(|at| at as f64).collect();
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("plane.vtu");
    write_vtu(&path, &Snapshot::new(mesh).with_points("displacement", 2, u).unwrap()).unwrap();
    let read = read_array(&path, "displacement").unwrap();
    assert_eq!((read.components, &read.values[..6]), (3, &[0.0, 1.0, 0.0, 2.0, 3.0, 0.0][..]));
}

/// Two triangles over a square, a vertex and two boundary lines, with tags; every encoding says the same.
fn square(header: &str, arrays: [&str; 5], tail: &str) -> String {
    let [points, nodes, offsets, types, tags] = arrays;
    format!(
        r#"<?xml version="1.0"?>
<!-- written by hand -->
<VTKFile type="UnstructuredGrid" version="1.0" {header}>
<UnstructuredGrid><Piece NumberOfPoints="4" NumberOfCells="4">
<Points><DataArray type="Float32" NumberOfComponents="3" {points}</Points>
<Cells><DataArray type="Int32" Name="connectivity" {nodes}<DataArray type="Int16" Name="offsets" {offsets}
<DataArray type="UInt8" Name="types" {types}</Cells>
<CellData Scalars='x'><DataArray type="Int8" Name="gmsh:physical" {tags}</CellData>
</Piece></UnstructuredGrid>{tail}
</VTKFile>"#
    )
}

fn check_square(mesh: &Mesh) {
    assert_eq!(mesh.points(), [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]);
    assert_eq!(mesh.cells(), 2);
    assert_eq!(mesh.region("7").unwrap(), [0, 1]);
    assert_eq!(mesh.surface("5").unwrap().len(), 1);
    assert_eq!(mesh.node_set("9").unwrap(), [2]);
}

const POINTS: [f32; 12] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0];
const NODES: [i32; 9] = [0, 1, 0, 1, 2, 0, 2, 3, 2];
const OFFSETS: [i16; 4] = [2, 5, 8, 9];
const TYPES: [u8; 4] = [3, 5, 5, 1];
const TAGS: [i8; 4] = [5, 7, 7, 9];

/// The arrays of the square as bytes of either order.
fn bytes(big: bool) -> [Vec<u8>; 5] {
    fn flat<T, const N: usize>(values: &[T], to: impl Fn(&T) -> [u8; N]) -> Vec<u8> {
        values.iter().flat_map(to).collect()
    }
    [
        flat(&POINTS, |x| if big { x.to_be_bytes() } else { x.to_le_bytes() }),
        flat(&NODES, |x| if big { x.to_be_bytes() } else { x.to_le_bytes() }),
        flat(&OFFSETS, |x| if big { x.to_be_bytes() } else { x.to_le_bytes() }),
        TYPES.to_vec(),
        flat(&TAGS, |x| x.to_be_bytes()),
    ]
}

#[test]
fn text_is_read() {
    let text = square(
        "",
        [
            "format=\"ascii\">0 0 0 1 0 0\n1 1 0 0 1.0e0 0</DataArray>",
            "format=\"ascii\"> 0 1  0 1 2  0 2 3  2 </DataArray>",
            "format=\"ascii\">2 5 8 9</DataArray>",
            "format=\"ascii\">3 5 5 1</DataArray>",
            "format='ascii'><InformationKey name=\"a\" location=\"b\"/>5 7 7 9</DataArray>",
        ],
        "",
    );
    check_square(&parse_vtu("square.vtu", text.as_bytes(), 1.0).unwrap());
    let scaled = parse_vtu("square.vtu", text.as_bytes(), 1e-3).unwrap();
    assert_eq!(scaled.points()[2], [1e-3, 1e-3, 0.0]);
    let cut = parse_vtu("square.vtu", &text.as_bytes()[..300], 1.0).unwrap_err().to_string();
    assert!(cut.starts_with("square.vtu, line ") && cut.contains("truncated"), "{cut}");
    let few = parse_vtu("square.vtu", text.replace("5 7 7 9<", "5 7 7<").as_bytes(), 1.0).unwrap_err().to_string();
    assert!(few.contains("\"gmsh:physical\": 3 values stand where 4 are needed"), "{few}");
    let wedge = text.replace("3 5 5 1", "3 13 5 1");
    let wedge = parse_vtu("square.vtu", wedge.as_bytes(), 1.0).unwrap_err().to_string();
    assert!(wedge.contains("the wedge of VTK type 13 (cell 1) is not supported"), "{wedge}");
    let outside = parse_vtu("square.vtu", text.replace("0 2 3  2", "0 2 4  2").as_bytes(), 1.0).unwrap_err();
    assert!(outside.to_string().contains("cell 2 names a node outside 0..4"), "{outside}");
}

/// Plain base64 without a library, padded.
fn base64(bytes: &[u8]) -> String {
    const ALPHABET: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut out = String::new();
    for chunk in bytes.chunks(3) {
        let word = (0..3).fold(0u32, |word, at| word << 8 | u32::from(*chunk.get(at).unwrap_or(&0)));
        for at in 0..4 {
            let six = ALPHABET[(word >> (18 - 6 * at)) as usize & 63];
            out.push(if at <= chunk.len() { char::from(six) } else { '=' });
        }
    }
    out
}

fn length(bytes: usize, big: bool) -> [u8; 4] {
    if big { (bytes as u32).to_be_bytes() } else { (bytes as u32).to_le_bytes() }
}

#[test]
fn inline_base64_of_either_byte_order_is_read() {
    for big in [false, true] {
        // VTK encodes the length together with the data; others encode it on its own.
        for apart in [false, true] {
            let arrays = bytes(big).map(|bytes| {
                let head = length(bytes.len(), big);
                let text = if apart { base64(&head) + &base64(&bytes) } else { base64(&[&head[..], &bytes].concat()) };
                format!("format=\"binary\">\n {text}\n</DataArray>")
            });
            let order = if big { "byte_order=\"BigEndian\"" } else { "byte_order=\"LittleEndian\"" };
            let text = square(order, arrays.each_ref().map(String::as_str), "");
            check_square(&parse_vtu("square.vtu", text.as_bytes(), 1.0).unwrap());
        }
    }
}

#[test]
fn appended_data_is_read_raw_and_in_base64() {
    for raw in [false, true] {
        let mut body = Vec::new();
        let arrays = bytes(false).map(|bytes| {
            let offset = body.len();
            let whole = [&length(bytes.len(), false)[..], &bytes].concat();
            body.extend(if raw { whole } else { base64(&whole).into_bytes() });
            format!("format=\"appended\" offset=\"{offset}\"/>")
        });
        let encoding = if raw { "raw" } else { "base64" };
        let tail = format!("<AppendedData encoding=\"{encoding}\">\n_@\n</AppendedData>");
        let text = square("", arrays.each_ref().map(String::as_str), &tail);
        let (before, after) = text.split_once('@').unwrap();
        let file = [before.as_bytes(), &body, after.as_bytes()].concat();
        check_square(&parse_vtu("square.vtu", &file, 1.0).unwrap());
    }
}

#[test]
fn raw_cell_order_is_followed_by_arrays() {
    // Triangles and quadrangles interleaved: the mesh groups them by kind, arrays follow.
    let mut raw = RawMesh::new("mixed");
    raw.points =
        vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [2.0, 0.0, 0.0], [2.0, 1.0, 0.0]];
    raw.push(CellKind::Tri3, &[0, 1, 2], &[]);
    raw.push(CellKind::Quad4, &[1, 4, 5, 2], &[]);
    raw.push(CellKind::Tri3, &[0, 2, 3], &[]);
    let mesh = Mesh::build(raw).unwrap();
    let text = r#"<VTKFile type="UnstructuredGrid"><UnstructuredGrid><Piece NumberOfPoints="7" NumberOfCells="3">
<PointData><DataArray type="Float64" Name="p" format="ascii">-1 0 1 2 3 4 5</DataArray></PointData>
<CellData><DataArray type="Float64" Name="c" format="ascii">10 11 12</DataArray></CellData>
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">
9 9 0 0 0 0 1 0 0 1 1 0 0 1 0 2 0 0 2 1 0</DataArray></Points>
<Cells><DataArray type="Int64" Name="connectivity" format="ascii">1 2 3 2 5 6 3 1 3 4</DataArray>
<DataArray type="Int64" Name="offsets" format="ascii">3 7 10</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">5 9 5</DataArray></Cells>
</Piece></UnstructuredGrid></VTKFile>"#;
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("mixed.vtu");
    std::fs::write(&path, text).unwrap();
    let read = read_snapshot(&path).unwrap();
    assert_eq!(read.mesh.blocks(), mesh.blocks());
    assert_eq!(read.cell_array("c").unwrap().values, [10.0, 12.0, 11.0]);
    assert_eq!(read.point_array("p").unwrap().values, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
    assert!(read.mesh.notes().join(" ").contains("1 nodes belong to no cell"), "{:?}", read.mesh.notes());
    assert!(read_vtu_scaled(&path, 0.0).is_err());
    assert!(read_vtu(directory.path().join("none.vtu")).unwrap_err().to_string().contains("none.vtu"));
}

/// Entries in a row with one time are parts of it, numbered from zero; ParaView shows parts together.
#[test]
fn parts_of_one_time_are_numbered() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("all.pvd");
    let steps = [(0.0, "a.vtu"), (0.5, "b.vtu"), (0.5, "b_lines.vtu"), (0.5, "b_obstacles.vtu"), (1.0, "c.vtu")];
    nastic_io::write_pvd(&file, &steps).unwrap();
    let text = std::fs::read_to_string(file).unwrap();
    let parts: Vec<&str> = text.split("part=\"").skip(1).map(|rest| &rest[..1]).collect();
    assert_eq!(parts, ["0", "0", "1", "2", "0"]);
}

#[test]
fn compressed_blocks_that_lie_are_refused_before_memory_is_taken() {
    let block = |unpacked: u64, packed: &[u8]| {
        let header = [1, unpacked, 0, packed.len() as u64];
        let header: Vec<u8> = header.iter().flat_map(|number: &u64| number.to_le_bytes()).collect();
        nastic_io::base64(&header) + &nastic_io::base64(packed)
    };
    let file = |compressor: &str, points: &str| {
        format!(
            "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" header_type=\"UInt64\" compressor=\"{compressor}\">\
             <UnstructuredGrid><Piece NumberOfPoints=\"3\" NumberOfCells=\"1\"><Points><DataArray type=\"Float64\" \
             NumberOfComponents=\"3\" format=\"binary\">{points}</DataArray></Points><Cells>\
             <DataArray type=\"Int8\" Name=\"connectivity\" format=\"ascii\">0 1 2</DataArray>\
             <DataArray type=\"Int8\" Name=\"offsets\" format=\"ascii\">3</DataArray>\
             <DataArray type=\"Int8\" Name=\"types\" format=\"ascii\">5</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>"
        )
    };
    let points: Vec<u8> = [0.0f64, 0., 0., 1., 0., 0., 0., 1., 0.].iter().flat_map(|x| x.to_le_bytes()).collect();
    // LZ4 of literals alone: 15 in the token and the rest of the length in a byte
    let literals = [&[0xf0, 72 - 15], points.as_slice()].concat();
    let sound = file("vtkLZ4DataCompressor", &block(72, &literals));
    assert_eq!(parse_vtu("lz4.vtu", sound.as_bytes(), 1.0).unwrap().measures().volume, 0.5);
    for (compressor, unpacked, packed) in [
        ("vtkLZ4DataCompressor", 1 << 60, literals.as_slice()),
        ("vtkLZ4DataCompressor", 73, &literals),
        ("vtkLZ4DataCompressor", 71, &literals),
        ("vtkLZ4DataCompressor", 72, &literals[..60]),
        ("vtkLZMADataCompressor", 72, &literals),
        ("vtkLZMADataCompressor", 72, b"\xfd7zXZ\0\0\x01\x69\x22\xde\x36"),
    ] {
        let message =
            parse_vtu("bad.vtu", file(compressor, &block(unpacked, packed)).as_bytes(), 1.0).unwrap_err().to_string();
        assert!(message.starts_with("bad.vtu, line 1") && message.contains("data is corrupt"), "{message}");
    }
    let message = parse_vtu("bad.vtu", file("vtkOwnCompressor", "").as_bytes(), 1.0).unwrap_err().to_string();
    assert!(message.contains("compressor \"vtkOwnCompressor\" is not supported"), "{message}");
}
