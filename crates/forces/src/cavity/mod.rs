//! [`Cavity`]: a closed room in a body, under a pressure or of a volume.

mod enclosed;
mod lumen;
mod pressure;
mod rim;
mod triple_product;
mod volume;

use enclosed::Enclosed;
pub use lumen::Lumen;
use nastic_body::contribution::Contribution;
use nastic_body::discretization::quadrature_points::QuadraturePoints;
use nastic_body::discretization::supports::{AXES, Supports};
use nastic_body::error::FemError;
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
/// planes of symmetry need no lid: o lies on them, and V is then the volume on this side of them. Where the supports hold the rim, no
/// lid is needed either ([`open`](Self::open)).
///
/// By pressure (the default): potential `-p V(u)`, residual `-p dV/du`, tangent `-p d2V/du2`, symmetric. Positive pressure inflates.
/// Control: the pressure. By volume ([`by_volume`](Self::by_volume)): the constraint `V(u) = V_0 + dV`, V_0 the volume at rest,
/// with the pressure as its multiplier, potential `-p (V - V_0 - dV)`. Control: the added volume dV; like every control it grows
/// with the load steps of a solve, and dead loads and prescribed displacements do not scale it.
///
/// Units: Pa, m^3 (m^2 in plane strain). Source: docs/model/equilibrium.md; Rumpel & Schweizerhof, Int. J.
/// Numer. Methods Eng. 59 (2004), who show that the tangent is symmetric where the boundary is closed or held.
#[derive(Debug, Clone, PartialEq)]
pub struct Cavity {
    name: String,
    surface: GroupNames,
    /// Whether openings are closed by a lid.
    pub lid: bool,
    /// Whether the supports hold the rim of an open surface.
    pub open: bool,
    /// Surfaces in the planes of symmetry.
    pub symmetry: Vec<String>,
    /// Whether the volume is given, not the pressure.
    pub by_volume: bool,
    /// Whether the surface is the outside of the body.
    pub filled: bool,
}

impl Cavity {
    /// The room behind a named surface, or behind several that bound it together; `name` is that of the control.
    pub fn new(name: &str, surface: impl Into<GroupNames>) -> Self {
        Cavity {
            name: name.to_owned(),
            surface: surface.into(),
            lid: false,
            open: false,
            symmetry: Vec::new(),
            by_volume: false,
            filled: false,
        }
    }

    /// Closes every rim by a lid.
    #[must_use]
    pub fn lid(mut self) -> Self {
        self.lid = true;
        self
    }

    /// The surface is open, and the supports hold its rim: a membrane or a plate under a follower pressure. The potential is that with a
    /// lid, which loads held nodes alone. Every rim is held in all components; or it lies in a plane across an axis and is held along that axis alone, so that it
    /// moves within its plane: the lid stays in the plane, and the volume behind both does not change to first order with the rim, nothing but the pressure on the surface
    /// does work, and the tangent is symmetric.
    #[must_use]
    pub fn open(mut self) -> Self {
        self.open = true;
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

    /// The surface is the outside of a body, whose own volume it is: `V = (1/3) int (x - o) . cof(F) N dA`. By volume, a body that keeps it, like a
    /// drop or a bag of liquid, with its pressure as the multiplier.
    #[must_use]
    pub fn filled(mut self) -> Self {
        self.filled = true;
        self
    }

    /// The contribution on a mesh.
    ///
    /// # Errors
    /// Unknown names; a surface that is open where neither a lid nor a plane of symmetry closes it; one that encloses nothing.
    pub fn on(&self, mesh: &Arc<Mesh>) -> Result<Arc<dyn Contribution>, FemError> {
        let enclosed = Enclosed::new(mesh, self)?;
        let volume = enclosed.volume(None);
        if self.open {
            return self.on_open(mesh, enclosed, volume);
        }
        if volume <= 0.0 {
            let what = format!(
                "surface \"{}\" encloses no cavity \"{}\" (volume {volume:.3e}): name {}",
                self.surface,
                self.name,
                match self.filled {
                    false =>
                        "the inner surface, whose normal points out of the solid into the cavity; the volume of the body itself is meant by \"filled\"",
                    true => "the outer surface, as \"skin\", or leave out \"filled\"",
                }
            );
            return Err(FemError::Meaningless { what });
        }
        let room = Room { name: self.name.clone(), enclosed, reference_volume: volume, measure: volume, held: None };
        Ok(if self.by_volume { Arc::new(CavityVolume(room)) } else { Arc::new(CavityPressure(room)) })
    }

    /// That of an open surface, which encloses no volume: its measure is the cube of a length whose square is its area (in the
    /// plane the square of its length).
    fn on_open(&self, mesh: &Arc<Mesh>, enclosed: Enclosed, volume: f64) -> Result<Arc<dyn Contribution>, FemError> {
        let rims = enclosed.rims();
        let refused = match (rims.is_empty(), self.lid, self.by_volume) {
            (true, ..) => Some("is closed: leave out \"open\""),
            (_, true, _) => Some("has \"open\" and \"lid\", of which only one can be"),
            (.., true) => Some("is open and encloses no volume: control its pressure, or close it by a lid"),
            _ => None,
        };
        if let Some(why) = refused {
            let what = format!("surface \"{}\" of cavity \"{}\" {why}", self.surface, self.name);
            return Err(FemError::Meaningless { what });
        }
        let facets = mesh.facets_of(&self.surface)?;
        let points = QuadraturePoints::of_facets(mesh, &facets, |kind| kind.rule().clone());
        let dim = mesh.dim() as f64;
        let measure = points.weights().iter().sum::<f64>().powf(dim / (dim - 1.0));
        let (name, held) = (self.name.clone(), Some(rims));
        Ok(Arc::new(CavityPressure(Room { name, enclosed, reference_volume: volume, measure, held })))
    }
}

/// What both kinds of control act on.
#[derive(Debug)]
struct Room {
    name: String,
    enclosed: Enclosed,
    reference_volume: f64,
    /// Weight of its control in the inner product.
    measure: f64,
    /// The rims that the supports must hold, of an open surface.
    held: Option<Vec<Vec<u32>>>,
}

/// The control of a cavity under a pressure.
pub const PRESSURE: Slot = Slot::scalar("pressure", "Pa");
/// That of a cavity of a volume, in space.
pub const VOLUME: Slot = Slot::scalar("volume", "m^3");
/// The same in plane strain.
const AREA: Slot = Slot::scalar("volume", "m^2");

impl Room {
    fn check(&self, supports: &Supports) -> Result<(), FemError> {
        let (dim, fixed) = (self.enclosed.dim(), supports.fixed());
        let free = |&node: &u32| (0..dim).find(|axis| !fixed[dim * node as usize + axis]).map(|axis| (node, axis));
        let moving = self.held.iter().flatten().filter(|rim| !self.enclosed.stays_in_plane(rim, supports));
        if let Some((node, axis)) = moving.flatten().find_map(free) {
            let what = format!(
                "the surface of cavity \"{}\" is open, and node {node} of its rim may move along {}; hold the rim, or, where all of it lies in a plane \
                 across an axis, hold it along that axis, or close the surface by a lid, which loads the rim, or name the plane of symmetry on which it ends",
                self.name, AXES[axis]
            );
            return Err(FemError::Meaningless { what });
        }
        let Some((node, axis)) = self.enclosed.loose(supports) else { return Ok(()) };
        let what = format!(
            "cavity \"{}\" ends on a plane of symmetry across {}, but node {node} of its surface may leave that plane, or is \
             moved out of it; hold the surface of that plane there at zero",
            self.name, AXES[axis]
        );
        Err(FemError::Meaningless { what })
    }

    fn plane_strain(&self) -> bool {
        self.enclosed.dim() == 2
    }

    fn quantities(&self, u: &[f64], pressure: f64) -> Vec<(&'static str, f64)> {
        let volume = self.enclosed.volume(Some(u));
        if self.held.is_some() {
            // Reactions of the rim contain the force on the lid, which is the opposite of that on the surface.
            let force = self.enclosed.area_vector(u) * -pressure;
            let swept = vec![("pressure", pressure), ("swept_volume", volume - self.reference_volume)];
            let forces = ["force_x", "force_y", "force_z"].into_iter().zip(force.iter().copied());
            return swept.into_iter().chain(forces.take(self.enclosed.dim())).collect();
        }
        vec![("pressure", pressure), ("volume", volume), ("reference_volume", self.reference_volume)]
    }
}
