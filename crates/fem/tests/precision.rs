//! In which precision tangents are factorised.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use nastic_energy::MooneyRivlin;
use nastic_fem::{Solid, SolveOptions, Workspace};
use nastic_mesh::{CellKind, box_mesh};
use nastic_tensor::Vec3;

/// A stout bar is solved with factors in single precision. A strip fifty times as long as it is thick is too slender for
/// them and gets others; what comes out is as exact with one as with the other.
#[test]
fn bodies_that_single_precision_is_too_coarse_for_get_double_precision() -> common::Outcome {
    let bar = |size: [f64; 3], cells: [usize; 3], traction: f64| -> common::Outcome<_> {
        let solid = Solid::new(box_mesh(size, cells, CellKind::Hex27)?)?
            .material("body", MooneyRivlin::new(1e5, 2e4, 1e6)?)?
            .clamp("x-")?
            .traction("x+", Vec3::new(0.0, 0.0, traction))?;
        let controls = solid.controls();
        let mut workspace = Workspace::default();
        let how = SolveOptions { accuracy: 1e-12, ..SolveOptions::default() };
        let residual = solid.solve_with(&controls, &how, &mut workspace)?.report.residual;
        assert!(residual < 1e-10, "{residual:e}");
        Ok((workspace.factor_bytes(), solid.model().tangent_structure().factor_bytes()))
    };
    let (single, whole) = bar([1.0, 0.2, 0.2], [5, 1, 1], 3e3)?;
    assert_eq!(2 * single, whole);
    let (double, whole) = bar([1.0, 0.2, 0.02], [60, 1, 1], 3.0)?;
    assert_eq!(double, whole);
    Ok(())
}
