//! [`Cavity`]: a closed room in a body, under a pressure or of a volume.

mod enclosed;
mod pressure;
mod rim;
mod triple_product;
mod volume;

use super::Contribution;
use super::catalogue::{Form, Key, KeyKind};
use crate::discretization::supports::AXES;
use crate::error::FemError;
use enclosed::Enclosed;
use nastic_energy::Slot;
use nastic_mesh::{GroupNames, Mesh};
use pressure::CavityPressure;
use std::sync::Arc;
use volume::CavityVolume;

/// A cavity: a gas under a pressure p that follows the surface, or a liquid of a given volume, whose pressure follows. The enclosed
/// volume is
///
/// ```text
/// V = -(1/3) int (x - o) . cof(F) N dA      (plane strain, per unit of thickness: -(1/2) int (x - o) . cof(F) N ds)
/// ```
///
/// over a named surface whose reference normal N points out of the solid, so into the cavity. Where the surface is open, the rim is
/// closed by a lid of triangles from the mean of its nodes, which moves with them, so that the pressure on the lid loads the rim;
/// planes of symmetry need no lid: o lies on them, and V is then the volume on this side of them.
///
/// By pressure (the default): potential `-p V(u)`, residual `-p dV/du`, tangent `-p d2V/du2`, symmetric. Positive pressure inflates.
/// Control: the pressure. By volume ([`by_volume`](Self::by_volume)): the constraint `V(u) = V_0 + dV`, V_0 the volume at rest,
/// with the pressure as its multiplier, potential `-p (V - V_0 - dV)`. Control: the added volume dV; like every control it grows
/// with the load steps of a solve, and dead loads and prescribed displacements do not scale it.
///
/// Units: Pa, m^3 (m^2 in plane strain). Source: docs/model.md section 4; Rumpel & Schweizerhof, Int. J.
/// Numer. Methods Eng. 59 (2004), who show that the tangent is symmetric where the boundary is closed or held.
#[derive(Debug, Clone, PartialEq)]
pub struct Cavity {
    name: String,
    surface: GroupNames,
    lid: bool,
    symmetry: Vec<String>,
    by_volume: bool,
}

impl Cavity {
    /// The room behind a named surface, or behind several that bound it together; `name` is that of the control.
    pub fn new(name: &str, surface: impl Into<GroupNames>) -> Self {
        Cavity { name: name.to_owned(), surface: surface.into(), lid: false, symmetry: Vec::new(), by_volume: false }
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

    /// The added volume is the control, and the pressure follows.
    #[must_use]
    pub fn by_volume(mut self) -> Self {
        self.by_volume = true;
        self
    }

    /// The contribution on a mesh.
    ///
    /// # Errors
    /// Unknown names; a surface that is open where neither a lid nor a plane of symmetry closes it; one that encloses nothing.
    pub(crate) fn on(&self, mesh: &Arc<Mesh>) -> Result<Arc<dyn Contribution>, FemError> {
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
        let room = Room { name: self.name.clone(), enclosed, reference_volume: volume };
        Ok(if self.by_volume { Arc::new(CavityVolume(room)) } else { Arc::new(CavityPressure(room)) })
    }
}

/// How it stands in case files.
pub(super) const FORM: Form = Form {
    about: "A cavity behind a closed surface of the body, under a pressure or with an added volume.",
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
    slots: &[PRESSURE, VOLUME],
    one_of: true,
    add: |solid, name, values| {
        let mut cavity = Cavity::new(name, values.names.get("surface").cloned().unwrap_or_default());
        cavity.lid = values.flags.contains("lid");
        cavity.by_volume = values.slot == Some(VOLUME.group);
        cavity.symmetry = values.names.get("symmetry").cloned().unwrap_or_default();
        solid.cavity(cavity)
    },
};

/// What both kinds of control act on.
#[derive(Debug)]
struct Room {
    name: String,
    enclosed: Enclosed,
    reference_volume: f64,
}

/// The controls, of which a cavity has one.
const PRESSURE: Slot = Slot::scalar("pressure", "Pa");
const VOLUME: Slot = Slot::scalar("volume", "m^3");

impl Room {
    fn check(&self, fixed: &[bool]) -> Result<(), FemError> {
        let Some((node, axis)) = self.enclosed.loose(fixed) else { return Ok(()) };
        let what = format!(
            "cavity \"{}\" ends on a plane of symmetry across {}, but node {node} of its surface may leave that plane; \
             hold the surface of that plane there",
            self.name, AXES[axis]
        );
        Err(FemError::Meaningless { what })
    }

    fn quantities(&self, u: &[f64], pressure: f64) -> Vec<(&'static str, f64)> {
        let volume = self.enclosed.volume(Some(u));
        vec![("pressure", pressure), ("volume", volume), ("reference_volume", self.reference_volume)]
    }
}
