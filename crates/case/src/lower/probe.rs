//! Probes: points of the body, found in its cells.

use super::context::Context;
use nastic_language::schema::Case;
use nastic_mesh::{Located, Mesh};

/// A probe and where in the mesh it lies.
#[derive(Clone, PartialEq, Debug)]
pub struct LocatedProbe {
    /// Its name.
    pub name: String,
    /// Its reference position.
    pub point: [f64; 3],
    /// The cell that holds it, and the shape functions there.
    pub located: Located,
}

impl LocatedProbe {
    /// The displacement there; `u` is flat, `dim` per node.
    #[must_use]
    pub fn displacement(&self, u: &[f64], dim: usize) -> [f64; 3] {
        self.located.interpolate(u, dim)
    }
}

pub(super) fn locate(case: &Case, mesh: &Mesh, context: &mut Context<'_>) -> Vec<LocatedProbe> {
    let mut out = Vec::new();
    for probe in &case.probes {
        let point = probe.point.xyz();
        if let Some(located) = context.take(&probe.at.key("point"), mesh.locate_inside(point)) {
            out.push(LocatedProbe { name: probe.name.clone(), point, located });
        }
    }
    out
}
