//! Legacy VTK files.

use nastic_io::{ReadError, read_mesh};
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
        ("binary", binary, "line 3"),
        ("short", format!("{HEAD}{POINTS}"), "CELL_TYPES"),
        ("word", format!("{HEAD}{}{CELLS}", POINTS.replace("0 1 0", "0 one 0")), "line 7"),
        ("node", format!("{HEAD}{POINTS}{}", CELLS.replace("1 2 3 4", "1 2 3 9")), "[1, 2, 3, 9]"),
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
