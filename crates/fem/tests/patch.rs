//! Patch test at finite strain: a homogeneous deformation prescribed on the boundary is reproduced inside, for every
//! element on distorted meshes and every passive law.

#![allow(clippy::panic)] // helpers of tests

use crate::common;

use common::{
    Outcome, boundary_nodes, curved, distance, distorted, kinds, laws, nodal, prescribe, unit, with_node_sets,
};
use nastic_energy::check::evaluate;
use nastic_energy::{EnergyTerm, MaterialPoint};
use nastic_fem::{Discretization, Solid, SolveOptions};
use nastic_mesh::{CellKind, Mesh};
use nastic_tensor::{Kinematics, Mat3, Vec3};
use std::sync::Arc;

/// Stretched, sheared and turned; J = 1.2 in the plane, 1.08 in space.
fn deformation(dim: usize) -> Mat3 {
    let turn = |angle: f64| Mat3::new(angle.cos(), -angle.sin(), 0.0, angle.sin(), angle.cos(), 0.0, 0.0, 0.0, 1.0);
    match dim {
        2 => turn(0.5) * Mat3::new(1.3, 0.35, 0.0, -0.1, 0.9, 0.0, 0.0, 0.0, 1.0),
        _ => turn(0.5) * Mat3::new(1.3, 0.35, 0.1, -0.1, 0.9, 0.2, 0.15, -0.2, 0.85),
    }
}

/// Three cells along each axis for first-order kinds, two for second-order ones: nodes of every sort lie inside.
fn patch(kind: CellKind) -> Outcome<Mesh> {
    let cells = if kind.order() == 1 { 3 } else { 2 };
    distorted(unit(kind, cells)?, 0.18 / cells as f64)
}

fn assert_patch(mesh: Mesh, what: &str) -> Outcome {
    let held = boundary_nodes(&mesh);
    assert!(held.len() < mesh.points().len(), "{what}: no node inside");
    let disc = Discretization::new(Arc::new(with_node_sets(&mesh, &held)?))?;
    let f = deformation(mesh.dim());
    let u = |x: Vec3| (f - Mat3::identity()) * x;
    let expected = nodal(&mesh, u);
    for (name, law) in laws()? {
        let solid = prescribe(Solid::on(disc.clone()).material("body", law.clone())?, &held, u)?;
        let request = SolveOptions { accuracy: 1e-14, ..SolveOptions::default() };
        let state = solid.solve(&solid.controls(), &request).unwrap_or_else(|e| panic!("{what}, {name}: {e}"));
        let error = distance(&state.u, &expected) / common::largest(&expected);
        assert!(error < 1e-12, "{what}, {name}: relative error {error:e} of u");
        assert_homogeneous(&solid, &state, &*law, &f, &format!("{what}, {name}"))?;
    }
    Ok(())
}

/// Energy, stress and J are those of the law at F.
fn assert_homogeneous(solid: &Solid, state: &nastic_fem::State, law: &dyn EnergyTerm, f: &Mat3, what: &str) -> Outcome {
    let expected = evaluate(law, MaterialPoint { cell: 0, point: 0 }, &Kinematics::new(*f)?, &[]);
    let fields = solid.cell_fields(state)?;
    let scale = expected.stress.norm();
    for (cell, found) in fields.piola.chunks_exact(9).enumerate() {
        let error = (Mat3::from_row_slice(found) - expected.stress).norm() / scale;
        assert!(error < 1e-11, "{what}: relative error {error:e} of P in cell {cell}");
        let cauchy = Mat3::from_row_slice(&fields.cauchy[9 * cell..9 * cell + 9]);
        let error = (cauchy - expected.stress * f.transpose() / f.determinant()).norm() / scale;
        assert!(error < 1e-11, "{what}: relative error {error:e} of Cauchy's stress in cell {cell}");
        assert!((fields.j[cell] - f.determinant()).abs() < 1e-12, "{what}: J = {} in cell {cell}", fields.j[cell]);
    }
    // the unit cube or square
    let error = (state.report.energy - expected.energy).abs() / expected.energy;
    assert!(error < 1e-12, "{what}: relative error {error:e} of the energy");
    Ok(())
}

#[test]
fn straight_sided_cells_pass() -> Outcome {
    for kind in kinds() {
        assert_patch(patch(kind)?, &format!("{kind}, straight"))?;
    }
    Ok(())
}

/// The default rules integrate shape gradients over curved cells exactly, so these pass as well.
#[test]
fn curved_cells_pass() -> Outcome {
    for kind in kinds().filter(|kind| kind.order() == 2) {
        assert_patch(curved(patch(kind)?, 0.03)?, &format!("{kind}, curved"))?;
    }
    Ok(())
}
