//! Distances between shapes against closed forms: shifted boxes, clouds above them, states of one mesh.

#![allow(clippy::unwrap_used)] // a test may

use nastic_io::{PointCloud, write_cloud, write_vtu};
use nastic_mesh::{CellKind, Snapshot, box_mesh, rectangle};
use nastic_report::record::{ComparisonRecord, DistancesRecord};
use nastic_report::{CompareRequest, ComparedPart, ReportError, compare};
use std::path::{Path, PathBuf};

fn boxed(directory: &Path, name: &str, cells: usize, shift: [f64; 3]) -> PathBuf {
    let mesh = box_mesh([1.0, 0.5, 0.25], [cells, 2, 2], CellKind::Hex27).unwrap();
    let u = mesh.points().iter().flat_map(|_| shift).collect();
    let path = directory.join(name);
    write_vtu(&path, &Snapshot::new(mesh).with_points("displacement", 3, u).unwrap()).unwrap();
    path
}

fn of(part: ComparedPart) -> CompareRequest {
    CompareRequest { part, scale: None }
}

fn near(value: impl Into<Option<f64>>, wanted: f64) -> bool {
    (value.into().unwrap() - wanted).abs() < 1e-12
}

fn all(way: &DistancesRecord, wanted: f64) -> bool {
    near(way.mean, wanted) && near(way.rms, wanted) && near(way.largest, wanted)
}

#[test]
fn a_shifted_box_is_its_shift_away() {
    let place = tempfile::tempdir().unwrap();
    let (a, b) = (boxed(place.path(), "a.vtu", 4, [0.0; 3]), boxed(place.path(), "b.vtu", 4, [0.0, 0.0, 0.03]));
    let whole = compare(&a, &b, &CompareRequest::default()).unwrap();
    let nodes = whole.node_by_node.clone().unwrap();
    assert!(near(nodes.rms, 0.03) && near(nodes.largest, 0.03) && nodes.nodes == 9 * 5 * 5);
    assert!((whole.hausdorff.unwrap() - 0.03).abs() <= whole.hausdorff_gap.unwrap() + 1e-9);
    // of the top every node is 0.03 below the other top, and back
    let top = compare(&a, &b, &of(ComparedPart::Surface("z+".into()))).unwrap();
    assert!(all(&top.a_to_b, 0.03) && all(&top.b_to_a, 0.03) && near(top.chamfer, 0.06) && near(top.hausdorff, 0.03));
    assert!(top.hausdorff_gap.is_none() && top.a.points == 9 * 5 && top.node_by_node.unwrap().nodes == 9 * 5);
    // the nearest points lie on faces, not on nodes: a mesh of other cells is as far away
    let other = boxed(place.path(), "c.vtu", 3, [0.0, 0.0, 0.03]);
    let top = compare(&a, &other, &of(ComparedPart::Surface("z+".into()))).unwrap();
    assert!(all(&top.a_to_b, 0.03) && top.node_by_node.is_none());
    assert!(top.text().contains("from A to B            0.03         0.03         0.03, at ("), "{}", top.text());
}

#[test]
fn a_cloud_above_a_face_is_its_height_away() {
    let place = tempfile::tempdir().unwrap();
    let a = boxed(place.path(), "a.vtu", 2, [0.0; 3]);
    let points: Vec<[f64; 3]> = (1..=4).map(|k| [0.2 * f64::from(k), 0.3, 0.25 + 0.01 * f64::from(k)]).collect();
    let cloud = place.path().join("scan.ply");
    write_cloud(&cloud, &PointCloud { points, ..PointCloud::default() }).unwrap();
    let found: ComparisonRecord = compare(&cloud, &a, &of(ComparedPart::Surface("z+".into()))).unwrap();
    assert!(near(found.a_to_b.mean, 0.025) && near(found.a_to_b.rms, (0.01f64 * 0.01 * 30.0 / 4.0).sqrt()));
    assert!(near(found.a_to_b.largest, 0.04) && near(found.a_to_b.from[2], 0.29) && near(found.a_to_b.to[2], 0.25));
    // back: the node (0, 0, 0.25) is nearest to the first point
    let far = found.b_to_a.largest.unwrap();
    let corner = [[0.0, 0.5], [0.0, 0.0], [1.0, 0.0], [1.0, 0.5]].map(|[x, y]: [f64; 2]| {
        (1..=4)
            .map(|k| (x - 0.2 * f64::from(k)).hypot(y - 0.3).hypot(0.01 * f64::from(k)))
            .fold(f64::INFINITY, f64::min)
    });
    assert!(near(far, corner.into_iter().fold(0.0, f64::max)));
    let scaled = compare(&a, &cloud, &CompareRequest { scale: Some(1e3), ..CompareRequest::default() }).unwrap();
    assert!(scaled.b_to_a.largest.unwrap() > 800.0);
}

#[test]
fn plane_bodies_are_compared_along_their_edges() {
    let place = tempfile::tempdir().unwrap();
    let mesh = rectangle([1.0, 0.5], [4, 2], CellKind::Quad9).unwrap();
    let u = mesh.points().iter().flat_map(|_| [0.1, 0.0, 0.0]).collect();
    let [a, b] = ["a.vtu", "b.vtu"].map(|name| place.path().join(name));
    write_vtu(&a, &Snapshot::new(mesh.clone())).unwrap();
    write_vtu(&b, &Snapshot::new(mesh).with_points("displacement", 3, u).unwrap()).unwrap();
    let found = compare(&a, &b, &CompareRequest::default()).unwrap();
    assert!(near(found.node_by_node.unwrap().rms, 0.1) && near(found.a_to_b.largest, 0.1));
}

#[test]
fn what_cannot_be_compared_is_named() {
    let place = tempfile::tempdir().unwrap();
    let a = boxed(place.path(), "a.vtu", 1, [0.0; 3]);
    let words = |b: &Path, request: &CompareRequest| compare(&a, b, request).unwrap_err().to_string();
    let whole = CompareRequest::default();
    assert!(
        words(&place.path().join("b.stl"), &whole).contains("is no shape: nastic compare takes result directories")
    );
    assert!(words(place.path(), &whole).contains("has no result.json"));
    assert!(words(&a, &of(ComparedPart::Surface("lid".into()))).contains("\"lid\""));
    let zero = CompareRequest { scale: Some(0.0), ..CompareRequest::default() };
    assert!(matches!(compare(&a, &a, &zero), Err(ReportError::Scale { .. })));
}
