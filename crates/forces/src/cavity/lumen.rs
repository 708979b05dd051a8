//! [`Lumen`]: the volume behind a surface as a function of the displacement, for costs.

use super::{Cavity, Enclosed};
use nastic_body::error::FemError;
use nastic_mesh::{GroupNames, Mesh};
use std::sync::Arc;

/// Volume below which it counts as zero, as a share of that of the body's box.
const MIN_VOLUME_SHARE: f64 = 1e-12;

/// The volume that a surface encloses, that of a [`Cavity`] of its walls with openings closed by lids,
///
/// ```text
/// V(u) = -(1/3) int (x - o) . cof(F) N dA      (plane strain, per unit of thickness: -(1/2) int (x - o) . cof(F) N ds)
/// ```
///
/// with its derivatives by u; of an outer surface, where that is negative at rest, -V, the volume within. It loads nothing. Units: m^3, in plane strain m^2.
#[derive(Debug)]
pub struct Lumen {
    enclosed: Enclosed,
    /// -1 of an outer surface, whose normals point out of what it encloses.
    sign: f64,
}

impl Lumen {
    /// Behind a named surface, or the union of several.
    ///
    /// # Errors
    /// Unknown names; a surface that encloses nothing.
    pub fn new(mesh: &Arc<Mesh>, surface: impl Into<GroupNames>) -> Result<Self, FemError> {
        let cavity = Cavity::new("volume", surface).lid();
        let enclosed = Enclosed::new(mesh, &cavity)?;
        let volume = enclosed.volume(None);
        if volume.abs() > MIN_VOLUME_SHARE * mesh.diagonal().powi(mesh.dim() as i32) {
            return Ok(Lumen { enclosed, sign: volume.signum() });
        }
        let what =
            format!("surface \"{}\" encloses no volume ({volume:.3e}): name all walls of the lumen", cavity.surface);
        Err(FemError::Meaningless { what })
    }

    /// `V(u)`; at rest without u.
    pub fn volume(&self, u: Option<&[f64]>) -> f64 {
        self.sign * self.enclosed.volume(u)
    }

    /// Adds `factor dV/du`.
    pub fn add_gradient(&self, u: &[f64], factor: f64, out: &mut [f64]) {
        let factor = self.sign * factor;
        self.enclosed.each(Some(u), false, |patch| patch.each_component(|dof, gradient| out[dof] += factor * gradient));
    }

    /// Adds `factor d2V/du2 v`.
    pub fn add_hessian_product(&self, u: &[f64], factor: f64, v: &[f64], out: &mut [f64]) {
        let factor = self.sign * factor;
        self.enclosed.each(Some(u), true, |patch| patch.add_hessian_product(factor, v, out));
    }
}
