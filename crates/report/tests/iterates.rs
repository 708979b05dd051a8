//! Kept iterations: which, how many, and that bytes are read as they were written or refused.

#![allow(clippy::unwrap_used)] // a test may

use nastic_mesh::{CellKind, Mesh, Snapshot, box_mesh};
use nastic_report::Iterates;
use std::sync::Arc;

fn shot(mesh: &Arc<Mesh>, iteration: usize) -> Snapshot {
    let u = mesh.points().iter().flat_map(|p| [0.0, 0.0, 0.01 * iteration as f64 * p[0]]).collect();
    let cells: Vec<f64> = (0..mesh.cells()).map(|cell| (cell + iteration) as f64).collect();
    let vectors = (0..mesh.cells()).flat_map(|_| [1.0, 0.0, 0.0]).collect();
    let shot = Snapshot::new(mesh.clone()).with_points("displacement", 3, u).unwrap();
    shot.with_cells("tension", 1, cells).unwrap().with_cells("design", 3, vectors).unwrap()
}

fn kept(mesh: &Arc<Mesh>, last: usize) -> Iterates {
    let mut iterates = Iterates::default();
    (0..=last).for_each(|k| iterates.add(k, &shot(mesh, k), &["design".to_owned()]));
    iterates
}

#[test]
fn at_most_sixty_are_kept_evenly_and_the_number_of_the_last_decides() {
    let mesh = Arc::new(box_mesh([1.0, 0.2, 0.2], [2, 1, 1], CellKind::Hex8).unwrap());
    assert_eq!(kept(&mesh, 59).iterations(), (0..60).collect::<Vec<_>>());
    assert_eq!(kept(&mesh, 60).iterations(), (0..=60).step_by(2).collect::<Vec<_>>());
    let many = kept(&mesh, 1000).iterations();
    assert_eq!(many, (0..=1000).step_by(32).collect::<Vec<_>>());
    // One that goes on from an earlier state ends with the same bytes.
    let mut resumed = Iterates::from_bytes(&kept(&mesh, 57).to_bytes()).unwrap();
    (58..=130).for_each(|k| resumed.add(k, &shot(&mesh, k), &["design".to_owned()]));
    assert_eq!(resumed.to_bytes(), kept(&mesh, 130).to_bytes());
}

#[test]
fn bytes_hold_positions_fields_and_carried_vectors() {
    let mesh = Arc::new(box_mesh([1.0, 1.0, 1.0], [1, 1, 1], CellKind::Hex8).unwrap());
    let bytes = kept(&mesh, 1).to_bytes();
    let end = bytes.iter().position(|b| *b == b'\n').unwrap();
    let floats: Vec<f32> =
        bytes[end + 1..].chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect();
    // 8 nodes, then 6 faces with a scalar and a vector each.
    let length = 8 * 3 + 6 + 6 * 3;
    assert_eq!(floats.len(), 2 * length);
    let second = &floats[length..];
    for (point, x) in mesh.points().iter().zip(second.chunks_exact(3)) {
        assert!((f64::from(x[2]) - point[2] - 0.01 * point[0]).abs() < 1e-7);
    }
    assert!(second[24..30].iter().all(|tension| *tension == 1.0));
    // F (1, 0, 0) = (1, 0, 0.01), with the length 1.
    let norm = f32::sqrt(1.0 + 1e-4);
    assert!((second[30] - 1.0 / norm).abs() < 1e-6 && (second[32] - 0.01 / norm).abs() < 1e-6);
}

#[test]
fn other_bytes_are_refused() {
    let mesh = Arc::new(box_mesh([1.0, 1.0, 1.0], [1, 1, 1], CellKind::Hex8).unwrap());
    let bytes = kept(&mesh, 3).to_bytes();
    assert_eq!(Iterates::from_bytes(&bytes).unwrap().to_bytes(), bytes);
    for end in [0, 1, 40, bytes.len() - 1] {
        assert!(Iterates::from_bytes(&bytes[..end]).is_err(), "{end} bytes");
    }
    let huge = br#"{"format":"nastic-iterates-1","nodes":18446744073709551615,"fields":[],"iterations":[0]}"#;
    assert!(Iterates::from_bytes(&[huge.as_slice(), b"\n"].concat()).is_err());
    assert!(Iterates::from_bytes(b"{\"format\":\"other\"}\n").unwrap_err().to_string().contains("another format"));
}
