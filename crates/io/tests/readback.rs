//! VTU and PVD files open elsewhere: Python's `vtk` and `meshio` read them back and compare them to the bit.
//!
//! Python is looked for in `$NASTIC_PYTHON`, `target/python/bin/python`, `python3`; without it, or without `vtk` and
//! `meshio`, the test says so and passes, unless `$NASTIC_PYTHON` is set.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)] // clippy.toml frees test functions, not their helpers

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

use nastic_io::{PrintedBody, read_gmsh, read_mesh, read_snapshot, write_3mf, write_pvd, write_stl, write_vtu};
use nastic_mesh::{CellKind, ClosedSurface, LevelBody, Mesh, NamedArray, Snapshot, box_mesh, rectangle};

#[test]
fn vtk_and_meshio_read_every_kind_back() {
    let Some(python) = python() else { return };
    let directory = tempfile::tempdir().unwrap();
    let mut steps = Vec::new();
    for kind in CellKind::ALL.into_iter().filter(|kind| kind.dim() > 1) {
        let mesh = match kind.dim() {
            3 => box_mesh([1.0, 0.5, 0.25], [3, 2, 1], kind).unwrap(),
            _ => rectangle([1.0, 0.5], [3, 2], kind).unwrap(),
        };
        steps.push((steps.len() as f64 / 8.0, format!("{kind}.vtu")));
        put(directory.path(), kind.name(), &decorated(mesh), true);
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mixed = read_gmsh(root.join("tests/data/mixed.41a.msh")).unwrap();
    put(directory.path(), "mixed", &decorated(mixed), false);
    let target = read_gmsh(root.join("../../meshes/target.msh")).unwrap();
    put(directory.path(), "target", &decorated(target), false);
    // More than one block of zlib.
    let wide = decorated(box_mesh([1.0, 1.0, 1.0], [10, 10, 10], CellKind::Hex8).unwrap());
    let values = (0..128 * 11 * 11 * 11).map(|at| f64::from(at).cos()).collect();
    put(directory.path(), "wide", &wide.with_points("wide", 128, values).unwrap(), true);
    write_pvd(directory.path().join("all.pvd"), &steps).unwrap();
    let listed: Vec<String> = steps.iter().map(|(time, file)| format!("[{time:?}, \"{file}\"]")).collect();
    let description = format!("{{\"collection\": \"all.pvd\", \"steps\": [{}]}}", listed.join(", "));
    std::fs::write(directory.path().join("all.json"), description).unwrap();

    let script = root.join("../../tests/readback/readback.py");
    let output = Command::new(python).arg(script).arg(directory.path()).output().unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{text}");
    assert_eq!(text.matches("agrees").count(), 2 * (10 + 3) + 1, "{text}");
}

#[test]
fn vtk_reads_closed_surfaces_of_their_volume() {
    let Some(python) = python() else { return };
    let directory = tempfile::tempdir().unwrap();
    for kind in [CellKind::Hex8, CellKind::Tet4, CellKind::Quad4] {
        let mesh = match kind.dim() {
            3 => box_mesh([0.02, 0.01, 0.01], [10, 5, 5], kind).unwrap(),
            _ => rectangle([0.02, 0.01], [10, 5], kind).unwrap(),
        };
        let cells: Vec<u32> = (0..mesh.cells() as u32).collect();
        let wave = |cell: &u32| (0.7 * f64::from(*cell)).sin();
        let body =
            LevelBody::new(&mesh, &cells, &cells.iter().map(wave).collect::<Vec<_>>(), &vec![1.0; cells.len()], 0.002);
        let surface = body.surface(mesh.points(), 0.05);
        write_stl(directory.path().join(format!("{kind}.stl")), &surface, 1e3).unwrap();
        std::fs::write(directory.path().join(format!("{kind}.txt")), format!("{:?}", 1e9 * surface.volume())).unwrap();
    }
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/readback/stl.py");
    let output = Command::new(python).arg(script).arg(directory.path()).output().unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && text.matches("agrees").count() == 3, "{text}");
}

/// Archive, units, names and bodies, by Python's own `zipfile` and XML; the same bytes once more.
#[test]
fn python_reads_bodies_of_several_materials() {
    let directory = tempfile::tempdir().unwrap();
    let mesh = box_mesh([0.02, 0.01, 0.01], [10, 5, 5], CellKind::Hex8).unwrap();
    let cells: Vec<u32> = (0..mesh.cells() as u32).collect();
    let nodal = |s: &dyn Fn(&[f64; 3]) -> f64| mesh.points().iter().map(s).collect::<Vec<_>>();
    let filled = LevelBody::of_nodes(&mesh, &cells, nodal(&|x| (500.0 * x[0]).sin() + 100.0 * x[1]), 0.0).above(0.3);
    let part = |name: &str, sign: f64| {
        let surface = filled.with_values(nodal(&|x| sign * (x[2] - 0.0047))).above(0.0).whole(mesh.points());
        PrintedBody { name: name.to_owned(), material: format!("{name} & \"rubber\""), surface }
    };
    let bodies = [part("soft", -1.0), part("stiff <2>", 1.0)];
    let [file, again] = ["design.3mf", "again.3mf"].map(|name| directory.path().join(name));
    write_3mf(&file, "a \"design\"", &bodies, 1e3).unwrap();
    write_3mf(&again, "a \"design\"", &bodies, 1e3).unwrap();
    assert_eq!(std::fs::read(&file).unwrap(), std::fs::read(&again).unwrap());
    let nothing = PrintedBody { surface: ClosedSurface::default(), ..bodies[0].clone() };
    let refused = write_3mf(&again, "none", &[nothing], 1e3).unwrap_err().to_string();
    assert!(refused.contains("the body soft has no triangles"), "{refused}");
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/readback/three_mf.py");
    let Ok(output) = Command::new("python3").arg(script).arg(&file).output() else {
        println!("SKIPPED: no python3 to read 3MF files back with");
        return;
    };
    let text = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{text}");
    let read: Vec<Vec<&str>> = text.lines().map(|line| line.split(" | ").collect()).collect();
    for (read, body) in read.iter().zip(&bodies) {
        let (volume, expected) = (read[2].parse::<f64>().unwrap(), 1e9 * body.surface.volume());
        assert!(read[..2] == [&body.name, &body.material] && (volume / expected - 1.0).abs() < 1e-9, "{text}");
    }
    assert_eq!(read.len(), 2, "{text}");
}

#[test]
fn what_vtk_and_meshio_write_is_read() {
    let Some(python) = python() else { return };
    let directory = tempfile::tempdir().unwrap();
    let written = decorated(box_mesh([1.0, 0.5, 0.25], [4, 3, 2], CellKind::Hex27).unwrap());
    let source = directory.path().join("source.vtu");
    write_vtu(&source, &written).unwrap();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/readback/rewrite.py");
    let output = Command::new(python).arg(script).arg(&source).arg(directory.path()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let names = String::from_utf8(output.stdout).unwrap();
    for name in names.lines().filter(|name| name.starts_with("legacy")) {
        let read = read_mesh(directory.path().join(name).with_extension("vtk"), 1.0);
        let read = read.unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(read.blocks(), written.mesh.blocks(), "{name}");
        assert_eq!((read.regions(), read.surfaces()), (written.mesh.regions(), written.mesh.surfaces()), "{name}");
    }
    for name in names.lines().filter(|name| !name.starts_with("legacy")) {
        let read = read_snapshot(directory.path().join(name).with_extension("vtu"));
        let read = read.unwrap_or_else(|error| panic!("{error}"));
        // meshio's text has fewer digits than a real.
        let near = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-9 * b.abs() || (a.is_nan() && b.is_nan());
        let all_near = |a: &[f64], b: &[f64]| a.len() == b.len() && a.iter().zip(b).all(near);
        let same = |a: &NamedArray, b: &NamedArray| a.components == b.components && all_near(&a.values, &b.values);
        assert!(all_near(read.mesh.points().as_flattened(), written.mesh.points().as_flattened()), "{name}");
        assert_eq!(read.mesh.blocks(), written.mesh.blocks(), "{name}");
        for array in &written.point_data {
            assert!(same(read.point_array(&array.name).unwrap(), array), "{name}: {}", array.name);
        }
        for array in &written.cell_data {
            assert!(same(read.cell_array(&array.name).unwrap(), array), "{name}: {}", array.name);
        }
        assert_eq!(read.mesh.regions().len(), 1, "{name}");
        if name.starts_with("vtk") {
            assert_eq!(read.mesh.surfaces(), written.mesh.surfaces(), "{name}");
        }
    }
    assert_eq!(names.lines().count(), 1 + 8 + 16 + 4 + 3, "{names}");
}

/// A Python with `vtk` and `meshio`.
pub fn python() -> Option<PathBuf> {
    let can_import = |python: &Path| {
        let check = Command::new(python).args(["-c", "import vtk, meshio"]).output();
        check.is_ok_and(|output| output.status.success())
    };
    if let Some(python) = std::env::var_os("NASTIC_PYTHON").map(PathBuf::from) {
        assert!(can_import(&python), "NASTIC_PYTHON is {}, which cannot import vtk and meshio", python.display());
        return Some(python);
    }
    let local = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../target/python/bin/python");
    let found = [local, "python3".into()].into_iter().find(|python| can_import(python));
    if found.is_none() {
        println!("SKIPPED: no Python with vtk and meshio; set NASTIC_PYTHON, or: pip install vtk meshio");
    }
    found
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
        .and_then(|it| it.with_cells("P", 9, values(9 * cells, 0.3)))
        .and_then(|it| it.with_cells("energy", 1, energy))
        .unwrap()
}

/// Writes a snapshot and the description of what it holds.
fn put(directory: &Path, name: &str, snapshot: &Snapshot, affine: bool) {
    let file = format!("{name}.vtu");
    write_vtu(directory.join(&file), snapshot).unwrap();
    let mesh = &snapshot.mesh;
    let cells: Vec<String> = (0..mesh.cells())
        .map(|id| {
            let cell = mesh.cell(id);
            format!("{{\"type\": {}, \"nodes\": {:?}}}", cell.kind.vtk(), cell.nodes)
        })
        .collect();
    let arrays = |arrays: &[NamedArray]| {
        let entries: BTreeMap<_, _> = arrays.iter().map(|array| (&array.name, array)).collect();
        let entries: Vec<String> = entries
            .values()
            .map(|a| format!("{:?}: {{\"components\": {}, \"values\": {:?}}}", a.name, a.components, a.values))
            .collect();
        format!("{{{}}}", entries.join(", "))
    };
    let description = format!(
        "{{\"file\": \"{file}\", \"affine\": {affine}, \"points\": {:?}, \"cells\": [{}], \"point_data\": {}, \"cell_data\": {}}}",
        mesh.points().as_flattened(),
        cells.join(", "),
        arrays(&snapshot.point_data),
        arrays(&snapshot.cell_data)
    );
    std::fs::write(directory.join(format!("{name}.json")), description).unwrap();
}
