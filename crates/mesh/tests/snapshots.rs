//! Some cells of a body with its fields.

use nastic_mesh::{CellKind, MeshError, Snapshot, box_mesh};

#[test]
fn some_cells_keep_their_fields_and_have_a_skin_of_their_own() -> Result<(), MeshError> {
    let mesh = box_mesh([3.0, 1.0, 1.0], [3, 1, 1], CellKind::Hex8)?;
    let moved = mesh.points().iter().flat_map(|x| [x[0], 0.0, -x[0]]).collect();
    let whole = Snapshot::new(mesh).with_points("displacement", 3, moved)?.with_cells("s", 1, vec![0.1, 0.2, 0.9])?;
    let ends = whole.of_cells(|cell| cell != 1).unwrap();
    assert_eq!((ends.mesh.cells(), ends.mesh.points().len(), ends.mesh.boundary().len()), (2, 16, 12));
    assert_eq!(ends.cell_array("s").unwrap().values, [0.1, 0.9]);
    for (x, moved) in ends.mesh.points().iter().zip(ends.positions()) {
        assert_eq!(moved, [2.0 * x[0], x[1], x[2] - x[0]]);
    }
    assert!(whole.of_cells(|_| false).is_none());
    Ok(())
}
