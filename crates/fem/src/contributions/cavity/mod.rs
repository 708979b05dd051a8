//! [`Cavity`]: a closed room in a body, under pressure.

mod enclosed;
mod rim;
mod triple_product;

use super::catalogue::{Form, Key, KeyKind};
use super::{Contribution, Controls, Demand, Increment, Instant, SecondSensitivities, Sensitivities, Sums};
use crate::discretization::supports::AXES;
use crate::error::{FemError, InvertedAt, SecondDerivativeError};
use enclosed::{Enclosed, Patch};
use nastic_energy::Slot;
use nastic_linear::SparseMatrix;
use nastic_mesh::{GroupNames, Mesh};
use nastic_numeric::vector::{axpy, dot};
use std::sync::Arc;

/// A cavity under a pressure p that follows the surface: potential `-p V(u)`, with the enclosed volume
///
/// ```text
/// V = -(1/3) int (x - o) . cof(F) N dA      (plane strain, per unit of thickness: -(1/2) int (x - o) . cof(F) N ds)
/// ```
///
/// over a named surface whose reference normal N points out of the solid, so into the cavity. The residual is `-p dV/du`,
/// the tangent `-p d2V/du2`, symmetric. Positive pressure inflates. Where the surface is open, the rim is closed by a lid of
/// triangles from the mean of its nodes, which moves with them, so that the pressure on the lid loads the rim; planes of
/// symmetry need no lid: o lies on them, and V is then the volume on this side of them.
///
/// Control: one pressure. Units: Pa, m^3 (m^2 in plane strain). Source: docs/model.md section 4; Rumpel & Schweizerhof, Int. J.
/// Numer. Methods Eng. 59 (2004), who show that the tangent is symmetric where the boundary is closed or held.
#[derive(Debug, Clone, PartialEq)]
pub struct Cavity {
    name: String,
    surface: GroupNames,
    lid: bool,
    symmetry: Vec<String>,
}

impl Cavity {
    /// The room behind a named surface, or behind several that bound it together; `name` is that of the control.
    pub fn new(name: &str, surface: impl Into<GroupNames>) -> Self {
        Cavity { name: name.to_owned(), surface: surface.into(), lid: false, symmetry: Vec::new() }
    }

    /// Closes every rim by a lid.
    #[must_use]
    pub fn lid(mut self) -> Self {
        self.lid = true;
        self
    }

    /// The surface ends on a plane of symmetry, which is that of another named surface: hold that one across the plane. Not two
    /// parallel planes.
    #[must_use]
    pub fn symmetry(mut self, surface: &str) -> Self {
        self.symmetry.push(surface.to_owned());
        self
    }

    /// The contribution on a mesh.
    ///
    /// # Errors
    /// Unknown names; a surface that is open where neither a lid nor a plane of symmetry closes it; one that encloses nothing.
    pub(crate) fn on(&self, mesh: &Arc<Mesh>) -> Result<CavityPressure, FemError> {
        let enclosed = Enclosed::new(mesh, self)?;
        let volume = enclosed.volume(None);
        if volume <= 0.0 {
            let what = format!(
                "surface \"{}\" encloses no cavity \"{}\" (volume {volume:.3e}): name the inner surface, whose normal \
                 points out of the solid into the cavity",
                self.surface, self.name
            );
            return Err(FemError::Meaningless { what });
        }
        Ok(CavityPressure { name: self.name.clone(), enclosed, reference_volume: volume })
    }
}

/// How it stands in case files.
pub(super) const FORM: Form = Form {
    about: "A cavity under pressure, behind a closed surface of the body.",
    keys: &[
        Key {
            name: "surface",
            about: "Surface of the mesh that bounds the cavity, or several that do so together.",
            kind: KeyKind::Union,
        },
        Key {
            name: "lid",
            about: "Whether openings of the surface are closed by a lid that loads their rims.",
            kind: KeyKind::Flag,
        },
        Key {
            name: "symmetry",
            about: "Surfaces in the planes of symmetry on which the surface ends.",
            kind: KeyKind::Surfaces,
        },
    ],
    slots: &SLOTS,
    passive: false,
    add: |solid, name, values| {
        let mut cavity = Cavity::new(name, values.names.get("surface").cloned().unwrap_or_default());
        cavity.lid = values.flags.contains("lid");
        cavity.symmetry = values.names.get("symmetry").cloned().unwrap_or_default();
        solid.cavity(cavity)
    },
};

/// The contribution of a [`Cavity`].
#[derive(Debug)]
pub(crate) struct CavityPressure {
    name: String,
    enclosed: Enclosed,
    reference_volume: f64,
}

/// The control.
const SLOTS: [Slot; 1] = [Slot::scalar("pressure", "Pa")];

impl Contribution for CavityPressure {
    fn name(&self) -> &str {
        &self.name
    }

    fn couplings(&self) -> Vec<Vec<u32>> {
        self.enclosed.rims()
    }

    fn check(&self, fixed: &[bool]) -> Result<(), FemError> {
        let Some((node, axis)) = self.enclosed.loose(fixed) else { return Ok(()) };
        let what = format!(
            "cavity \"{}\" ends on a plane of symmetry across {}, but node {node} of its surface may leave that plane; \
             hold the surface of that plane there",
            self.name, AXES[axis]
        );
        Err(FemError::Meaningless { what })
    }

    fn slots(&self) -> &[Slot] {
        &SLOTS
    }

    fn measure(&self) -> f64 {
        self.reference_volume
    }

    fn quantities(&self, at: &Instant) -> Vec<(&'static str, f64)> {
        let volume = self.enclosed.volume(Some(at.u));
        vec![("pressure", at.control(0)), ("volume", volume), ("reference_volume", self.reference_volume)]
    }

    fn add_residual(&self, at: &Instant, demand: Demand, sums: &mut Sums) -> Result<(), InvertedAt> {
        let pressure = at.control(0);
        if pressure == 0.0 {
            return Ok(());
        }
        self.enclosed.each(Some(at.u), false, |patch: &Patch| {
            if demand.energy {
                sums.energy -= pressure * patch.volume.value;
                sums.energy_scale += pressure.abs() * patch.volume.scale;
            }
            if demand.force {
                patch.each_component(|dof, gradient| {
                    sums.force[dof] -= pressure * gradient;
                    sums.force_scale[dof] += (pressure * gradient).abs();
                });
            }
        });
        Ok(())
    }

    fn add_tangent(&self, at: &Instant, tangent: &mut SparseMatrix) -> Result<(), InvertedAt> {
        let pressure = at.control(0);
        if pressure != 0.0 {
            self.enclosed.each(Some(at.u), true, |patch| patch.add_hessian(-pressure, tangent));
        }
        Ok(())
    }

    fn add_tangent_product(&self, at: &Instant, v: &[f64], out: &mut [f64]) -> Result<bool, InvertedAt> {
        let pressure = at.control(0);
        if pressure != 0.0 {
            self.enclosed.each(Some(at.u), true, |patch| patch.add_hessian_product(-pressure, v, out));
        }
        Ok(true)
    }

    fn vjp(&self, at: &Instant, lambda: &[f64], into: &mut Sensitivities) -> Result<(), InvertedAt> {
        let mut work = 0.0;
        self.enclosed.each(Some(at.u), false, |patch| {
            patch.each_component(|dof, gradient| work -= lambda[dof] * gradient);
        });
        into.add_control(at, 0, work);
        Ok(())
    }

    fn add_control_product(&self, at: &Instant, v: &Controls, out: &mut [f64]) -> Result<(), SecondDerivativeError> {
        let change = at.slot_of(v, 0);
        self.enclosed.each(Some(at.u), false, |patch| {
            patch.each_component(|dof, gradient| out[dof] -= change * gradient);
        });
        Ok(())
    }

    /// `-p V_uuu[lambda, du] - v V_uu lambda` and `-lambda . V_uu du`.
    fn second_vjp(
        &self,
        at: &Instant,
        lambda: &[f64],
        along: &Increment,
        into: &mut SecondSensitivities,
    ) -> Result<(), SecondDerivativeError> {
        let (pressure, change) = (at.control(0), at.slot_of(along.controls, 0));
        let mut of_lambda = vec![0.0; lambda.len()];
        self.enclosed.each(Some(at.u), true, |patch| patch.add_hessian_product(-1.0, lambda, &mut of_lambda));
        into.add_control(at, 0, dot(&of_lambda, along.u));
        axpy(change, &of_lambda, &mut into.u);
        if pressure != 0.0 {
            self.enclosed.each_change(lambda, |patch| patch.add_hessian_product(-pressure, along.u, &mut into.u));
        }
        Ok(())
    }
}
