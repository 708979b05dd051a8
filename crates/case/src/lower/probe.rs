//! Probes: points of the body, found in its cells.

use super::context::Context;
use crate::schema::Case;
use nastic_mesh::spatial::Shape;
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
        match mesh.locate(point) {
            Some(located) => out.push(LocatedProbe { name: probe.name.clone(), point, located }),
            None => context.complain(&probe.at.key("point"), outside(mesh, point)),
        }
    }
    out
}

pub(super) fn outside(mesh: &Mesh, point: [f64; 3]) -> String {
    let show = |p: [f64; 3]| format!("({}, {}, {})", p[0], p[1], p[2]);
    let (low, high) = mesh.bounds();
    let near = match Shape::new(mesh, mesh.points(), None) {
        Ok(shape) => {
            let (nearest, distance) = shape.nearest(point);
            format!("the nearest point of it is {}, {distance:.3e} away", show(nearest))
        }
        Err(error) => error.to_string(),
    };
    format!("{} is outside the body, which spans {} to {}; {near}", show(point), show(low), show(high))
}
