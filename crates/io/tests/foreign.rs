//! What VTK, meshio and Gmsh write at test time is read: volumes, groups, notes; see `tests/readback/foreign.py`.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // clippy.toml frees test functions, not their helpers

use crate::readback::python;
use nastic_io::read_mesh;
use nastic_mesh::Mesh;
use std::path::Path;
use std::process::Command;

#[test]
fn files_of_other_programs_are_read_with_their_groups() {
    let Some(python) = python() else { return };
    let directory = tempfile::tempdir().unwrap();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/readback/foreign.py");
    let output = Command::new(python).arg(script).arg(directory.path()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let list = String::from_utf8(output.stdout).unwrap();
    // meshio prints warnings among them
    let lines = || list.lines().filter(|line| line.contains('|'));
    let wrong: Vec<String> = lines().filter_map(|line| judge(directory.path(), line).err()).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(lines().count() >= 30, "{list}");
}

/// Whether a file holds what its line says.
fn judge(directory: &Path, line: &str) -> Result<(), String> {
    let words: Vec<&str> = line.split('|').collect();
    let read = |name: &str| read_mesh(directory.join(name), 1.0).map_err(|error| format!("{line}: {error}"));
    let mesh = read(words[0])?;
    let wrong = |what: String| Err(format!("{line}: {what}; {:?}", mesh.notes()));
    if let Ok(volume) = words[1].parse::<f64>() {
        if !near(mesh.measures().volume, volume) {
            return wrong(format!("volume {}", mesh.measures().volume));
        }
    } else {
        let sound = read(words[1])?;
        if !same(&mesh, &sound) {
            return wrong(format!("another mesh than {}", words[1]));
        }
    }
    if mesh.cells().to_string() != words[2] {
        return wrong(format!("{} cells", mesh.cells()));
    }
    let groups: Vec<&str> = words[3..].iter().filter(|word| !word.starts_with(['!', '?', '+'])).copied().collect();
    if let Some(missing) = groups.iter().find(|group| !has(&mesh, group)) {
        let names: Vec<_> =
            mesh.regions().keys().chain(mesh.surfaces().keys()).chain(mesh.node_sets().keys()).collect();
        return wrong(format!("not {missing}, of {names:?}"));
    }
    let count =
        mesh.regions().len() + mesh.surfaces().keys().filter(|name| *name != "skin").count() + mesh.node_sets().len();
    if !groups.is_empty() && !words.contains(&"+") && count != groups.len() {
        return wrong(format!("{count} groups"));
    }
    let notes = words[3..].iter().filter_map(|word| word.strip_prefix('!'));
    for note in notes {
        if !mesh.notes().iter().any(|own| own.contains(note)) {
            return wrong(format!("no note with {note:?}"));
        }
    }
    let lost: Vec<&str> = words[3..].iter().filter_map(|word| word.strip_prefix('?')).collect();
    if mesh.lost_regions() != lost {
        return wrong(format!("lost {:?}", mesh.lost_regions()));
    }
    Ok(())
}

/// Whether the cells have their nodes at the same places in the same order, whatever the numbers of the nodes.
fn same(a: &Mesh, b: &Mesh) -> bool {
    let places = |mesh: &Mesh, cell: usize| mesh.gather(mesh.points(), mesh.cell(cell).nodes);
    let alike = |cell: usize| {
        let (a, b) = (places(a, cell), places(b, cell));
        a.len() == b.len() && a.iter().flatten().zip(b.iter().flatten()).all(|(x, y)| (x - y).abs() < 1e-12)
    };
    a.cells() == b.cells() && (0..a.cells()).all(alike)
}

/// `KIND:NAME=MEASURE`.
fn has(mesh: &Mesh, group: &str) -> bool {
    let (kind, rest) = group.split_once(':').unwrap();
    let (name, measure) = rest.rsplit_once('=').unwrap();
    let found = match kind {
        "region" => mesh.region_volume(name).ok(),
        "surface" => mesh.surface_area(name).ok(),
        _ => mesh.node_set(name).ok().map(|nodes| nodes.len() as f64),
    };
    found.is_some_and(|found| near(found, measure.parse().unwrap()))
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-9 * b.abs()
}
