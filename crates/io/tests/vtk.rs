//! Legacy VTK files.

use nastic_io::{ReadError, parse_vtk, read_mesh};
use nastic_mesh::CellKind;

type Outcome = Result<(), Box<dyn std::error::Error>>;

const HEAD: &str = "# vtk DataFile Version 2.0\nby hand\nASCII\nDATASET UNSTRUCTURED_GRID\n";
const POINTS: &str = "POINTS 5 double\n0 0 0  1 0 0\n0 1 0\n0 0 1 1 1 1\n";
const CELLS: &str = "CELLS 2 10\n4 0 1 2 3\n4 1 2 3 4\nCELL_TYPES 2\n10 10\n";

fn file(name: &str, text: &str) -> std::io::Result<std::path::PathBuf> {
    let path = std::env::temp_dir().join(format!("nastic_vtk_{}_{name}.vtk", std::process::id()));
    std::fs::write(&path, text).map(|()| path)
}

#[test]
fn two_tetrahedra_are_read_with_their_skin() -> Outcome {
    let path = file("two", &format!("{HEAD}{POINTS}{CELLS}"))?;
    let mesh = read_mesh(&path, 2.0)?;
    std::fs::remove_file(path)?;
    assert_eq!((mesh.cells(), mesh.points().len(), mesh.cell(0).kind), (2, 5, CellKind::Tet4));
    assert!((mesh.bounds().1[0] - 2.0).abs() < 1e-15);
    assert_eq!(mesh.region("body")?.len(), 2);
    assert_eq!(mesh.surface("skin")?.len(), 6);
    assert!(mesh.surface("side").is_err());
    Ok(())
}

#[test]
fn damaged_files_are_named_by_line() -> Outcome {
    let binary = format!("{HEAD}{POINTS}{CELLS}").replace("ASCII", "BINARY");
    for (name, text, words) in [
        ("binary", binary, "byte "),
        ("short", format!("{HEAD}{POINTS}"), "CELL_TYPES"),
        ("word", format!("{HEAD}{}{CELLS}", POINTS.replace("0 1 0", "0 one 0")), "line 7"),
        (
            "node",
            format!("{HEAD}{POINTS}{}", CELLS.replace("1 2 3 4", "1 2 3 9")),
            "cell 1 has the nodes [1, 2, 3, 9], of 5",
        ),
        ("kind", format!("{HEAD}{POINTS}{}", CELLS.replace("10 10\n", "10 77\n")), "77"),
        ("count", format!("{HEAD}{POINTS}{}", CELLS.replace("CELL_TYPES 2", "CELL_TYPES 3")), "3 types for 2"),
    ] {
        let path = file(name, &text)?;
        let refused = read_mesh(&path, 1.0);
        std::fs::remove_file(path)?;
        match refused {
            Err(error @ (ReadError::Malformed { .. } | ReadError::Unsupported { .. })) => {
                assert!(error.to_string().contains(words), "{error}");
            }
            other => return Err(format!("{name}: {other:?}").into()),
        }
    }
    Ok(())
}

/// Version 5.1 as VTK writes it: a field before the points, metadata behind arrays, two arrays of cells. A tetrahedron of group 17 with a
/// face of 42, by Gmsh's name of tags, among arrays that are passed over.
fn text_of_5_1() -> String {
    "# vtk DataFile Version 5.1\nby hand\nASCII\nDATASET UNSTRUCTURED_GRID\nFIELD FieldData 2\nnote%20s 1 1 string\ntwo words\nTIME 1 1 double\n0.5 \n\
     POINTS 4 float\n0 0 0 1 0 0 \n0 1 0 0 0 1 \nMETADATA\nINFORMATION 1\nNAME L2_NORM_RANGE LOCATION vtkDataArray\nDATA 2 0 1\n\n\
     CELLS 4 8\nOFFSETS vtktypeint64\n0 4 7 8 \nCONNECTIVITY vtktypeint64\n0 1 2 3 0 1 2 \n0\nCELL_TYPES 3\n10\n5\n1\n\n\
     POINT_DATA 4\nVECTORS shift float\n0 0 0 0 0 0 0 0 0 0 0 0\nMETADATA\nCOMPONENT_NAMES\na\nb\nc\n\n\
     CELL_DATA 3\nSCALARS quality double\nLOOKUP_TABLE own\nnan 1 2\nLOOKUP_TABLE own 1\n0 0 0 1\n\
     FIELD FieldData 1\nCellEntityIds 1 3 int\n17 42 -1\n"
        .to_owned()
}

/// The same mesh in binary: the tests' own little writer.
fn binary(version: &str) -> Vec<u8> {
    fn reals(out: &mut Vec<u8>, values: &[f64]) {
        out.extend(values.iter().flat_map(|value| value.to_be_bytes()));
    }
    fn ints(out: &mut Vec<u8>, values: &[i32]) {
        out.extend(values.iter().flat_map(|value| value.to_be_bytes()));
    }
    let mut out =
        format!("# vtk DataFile Version {version}\nby hand\nBINARY\nDATASET UNSTRUCTURED_GRID\n").into_bytes();
    out.extend(b"POINTS 4 double\n");
    reals(&mut out, &[0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 0., 1.]);
    if version == "5.1" {
        out.extend(b"\nCELLS 4 8\nOFFSETS vtktypeint32\n");
        ints(&mut out, &[0, 4, 7, 8]);
        out.extend(b"\nCONNECTIVITY vtktypeint32\n");
        ints(&mut out, &[0, 1, 2, 3, 0, 1, 2, 0]);
    } else {
        out.extend(b"\nCELLS 3 11\n");
        ints(&mut out, &[4, 0, 1, 2, 3, 3, 0, 1, 2, 1, 0]);
    }
    out.extend(b"\nCELL_TYPES 3\n");
    ints(&mut out, &[10, 5, 1]);
    out.extend(b"\nCELL_DATA 3\nFIELD FieldData 3\nbits 1 3 bit\n");
    out.push(0b1010_0000);
    out.extend(b"\nwords 1 2 string\n");
    out.extend(b"\xc3abc\x80\x05");
    out.extend(b"edcba\nregion 1 3 long\n");
    out.extend([17_i64, 42, 0].iter().flat_map(|tag| tag.to_be_bytes()));
    out.push(b'\n');
    out
}

#[test]
fn sections_of_every_version_are_read_with_their_groups() -> Outcome {
    let files = [("text", text_of_5_1().into_bytes()), ("5.1", binary("5.1")), ("3.0", binary("3.0"))];
    for (name, bytes) in files {
        let mesh = parse_vtk(name, &bytes, 1.0)?;
        assert!((mesh.region_volume("17")? - 1.0 / 6.0).abs() < 1e-15, "{name}");
        assert!((mesh.surface_area("42")? - 0.5).abs() < 1e-15, "{name}");
        assert_eq!((mesh.regions().len(), mesh.node_sets().len()), (1, 0), "{name}");
    }
    Ok(())
}

#[test]
fn claims_truncations_and_mutations_end_in_errors_that_say_where() {
    let text = text_of_5_1();
    for (from, to, words) in [
        ("POINTS 4", "POINTS 99999999999999999", "claims 299999999999999997 values"),
        ("POINTS 4", "POINTS 18446744073709551615", "points cannot be"),
        ("CELLS 4 8", "CELLS 999999999999 8", "claims 999999999999 values"),
        ("17 42 -1", "17 42", "in FIELD: the file ends in it"),
        ("17 42 -1", "17 4.5 -1", "`4.5` is not such a number"),
        ("0 4 7 8 ", "0 4 2 8 ", "the offset of cell 1 is out of order"),
        ("VECTORS shift float", "VECTORS shift variant", "the type \"variant\""),
        ("CELL_DATA 3", "CELL_DATAS 3", "no section CELL_DATAS"),
        ("CELL_DATA 3", "CELL_DATA 2", "expected a section such as CELL_DATA, found `2`"),
        ("DATASET UNSTRUCTURED_GRID", "DATASET POLYDATA", "cast_to_unstructured_grid"),
        ("\n10\n", "\n13\n", "the wedge of VTK type 13 (cell 0)"),
    ] {
        let bad = text.replacen(from, to, 1);
        assert_ne!(bad, text, "{from}");
        let message =
            parse_vtk("bad.vtk", bad.as_bytes(), 1.0).map_or_else(|error| error.to_string(), |_| "read".into());
        assert!(message.starts_with("bad.vtk, line ") && message.contains(words), "{from} -> {to}: {message}");
    }
    for whole in [binary("5.1"), binary("3.0"), text.into_bytes()] {
        let needed = whole.windows(10).position(|window| window == b"CELL_TYPES").unwrap_or(0);
        for length in 0..whole.len() - 1 {
            let read = parse_vtk("cut.vtk", &whole[..length], 1.0);
            assert!(length > needed || read.is_err(), "cut to {length} of {}", whole.len());
        }
        let mut dice = 1_u64;
        for _ in 0..3000 {
            dice = dice.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            let mut bad = whole.clone();
            let at = (dice >> 33) as usize % bad.len();
            bad[at] = (dice >> 20) as u8;
            let _ = parse_vtk("bad.vtk", &bad, 1.0);
        }
    }
}
