//! A body in several files: the index names what every part has, and `vtk`, where it is there, reads one body.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)] // clippy.toml frees test functions, not their helpers

use crate::readback::python;
use nastic_io::{read_snapshot, write_pvtu, write_vtu};
use nastic_mesh::{CellKind, Snapshot, box_mesh};
use std::path::Path;
use std::process::Command;

/// Writes a box in three parts with a nodal and a cell field.
fn written(directory: &Path) -> usize {
    let mesh = box_mesh([3.0, 1.0, 1.0], [6, 2, 2], CellKind::Hex27).unwrap();
    let owners = mesh.bisected(3).unwrap();
    let (mut files, mut last) = (Vec::new(), None);
    for number in 0..3 {
        let part = mesh.part(&owners, number).unwrap();
        let place: Vec<f64> = part.mesh().points().iter().flat_map(|x| x.map(|x| 2.0 * x)).collect();
        let cells = part.cells().iter().map(|&cell| f64::from(cell)).collect();
        let snapshot = Snapshot::new(part.mesh().clone()).with_points("displacement", 3, place).unwrap();
        let snapshot = snapshot.with_cells("cell", 1, cells).unwrap();
        files.push(format!("part{number}.vtu"));
        write_vtu(directory.join(&files[number as usize]), &snapshot).unwrap();
        last = Some(snapshot);
    }
    write_pvtu(directory.join("body.pvtu"), &last.unwrap(), &files).unwrap();
    mesh.cells()
}

#[test]
fn the_index_names_what_every_part_has() {
    let directory = tempfile::tempdir().unwrap();
    let cells = written(directory.path());
    let index = std::fs::read_to_string(directory.path().join("body.pvtu")).unwrap();
    let parts = (0..3).map(|number| format!("part{number}.vtu"));
    let mut found = Vec::new();
    for file in parts {
        assert!(index.contains(&format!("<Piece Source=\"{file}\"/>")), "{index}");
        let text = std::fs::read_to_string(directory.path().join(&file)).unwrap();
        for line in index.lines().filter(|line| line.contains("<PDataArray")) {
            let named = line.split("<PDataArray ").nth(1).unwrap();
            let (kind, name) = (named.split(" Name").next().unwrap(), named.split('"').nth(3).unwrap());
            assert!(text.contains(&format!("<DataArray {kind} Name=\"{name}\"")), "{name} of {file}");
        }
        found.extend(read_snapshot(directory.path().join(&file)).unwrap().cell_array("cell").unwrap().values.clone());
    }
    found.sort_by(f64::total_cmp);
    assert_eq!(found, (0..cells).map(|cell| cell as f64).collect::<Vec<_>>());
    assert!(index.matches("<PDataArray").count() >= 4 + 6, "{index}");
    let snapshot = Snapshot::new(box_mesh([1.0; 3], [1; 3], CellKind::Hex8).unwrap());
    assert!(write_pvtu(directory.path().join("none.pvtu"), &snapshot, &[] as &[&str]).is_err());
}

/// Cells, sum of the numbers of cells, and the largest error of a nodal array that is twice the place.
const SCRIPT: &str = r#"
import sys, vtk
from vtk.util.numpy_support import vtk_to_numpy
reader = vtk.vtkXMLPUnstructuredGridReader()
reader.SetFileName(sys.argv[1])
reader.Update()
body = reader.GetOutput()
place = vtk_to_numpy(body.GetPoints().GetData())
moved = vtk_to_numpy(body.GetPointData().GetArray("displacement"))
cells = vtk_to_numpy(body.GetCellData().GetArray("cell"))
clamped = vtk_to_numpy(body.GetCellData().GetArray("surface:x-"))
print(body.GetNumberOfCells(), int(cells.sum()), abs(moved - 2 * place).max() == 0, int(clamped.sum()))
"#;

#[test]
fn vtk_reads_one_body() {
    let Some(python) = python() else { return };
    let directory = tempfile::tempdir().unwrap();
    let cells = written(directory.path());
    let output = Command::new(python).arg("-c").arg(SCRIPT).arg(directory.path().join("body.pvtu")).output().unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    assert_eq!(text.trim(), format!("{cells} {} True 4", cells * (cells - 1) / 2), "{text}");
}
