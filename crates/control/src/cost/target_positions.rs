//! [`Target`]: where points of a body should be.

use super::body_points::BodyPoints;
use nastic_fem::Solid;
use nastic_fields::ControlError;
use nastic_mesh::Mesh;
use std::fmt;
use std::sync::Arc;

/// Target positions of the tracked points.
#[derive(Clone)]
pub enum Target {
    /// The target position of the point that is at X in the reference body.
    Position(Arc<dyn Fn([f64; 3]) -> [f64; 3] + Send + Sync>),
    /// A target displacement by node, flat (`dim` per node), interpolated.
    Displacement(Vec<f64>),
}

impl fmt::Debug for Target {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Target::Position(_) => f.write_str("Position(..)"),
            Target::Displacement(u) => write!(f, "Displacement({} entries)", u.len()),
        }
    }
}

impl Target {
    /// The target position as a function of the reference position.
    pub fn position(at: impl Fn([f64; 3]) -> [f64; 3] + Send + Sync + 'static) -> Self {
        Target::Position(Arc::new(at))
    }

    /// Where the displacement `u` (flat, `dim` per node) of another mesh of the same body takes the point. Points outside
    /// that mesh have no position, which is an error when the target is bound.
    ///
    /// # Errors
    /// A displacement of the wrong length.
    pub fn moved(mesh: impl Into<Arc<Mesh>>, u: Vec<f64>) -> Result<Self, ControlError> {
        let mesh = mesh.into();
        let (dim, expected) = (mesh.dim(), mesh.dim() * mesh.points().len());
        if u.len() != expected {
            let what = format!("the target's displacement has {} entries where its mesh needs {expected}", u.len());
            return Err(ControlError::Cost { what });
        }
        Ok(Target::position(move |x| {
            let Some(at) = mesh.locate(x) else { return [f64::NAN; 3] };
            let u = at.interpolate(&u, dim);
            [x[0] + u[0], x[1] + u[1], x[2] + u[2]]
        }))
    }

    /// Where points of the body should be: of a cost by its name, for its messages.
    ///
    /// # Errors
    /// A displacement of the wrong length; a position that is not finite.
    pub(super) fn at(&self, points: &BodyPoints, solid: &Solid, cost: &str) -> Result<Vec<[f64; 3]>, ControlError> {
        let reference = points.positions(solid, None);
        let out: Vec<[f64; 3]> = match self {
            Target::Position(at) => reference.into_iter().map(|x| at(x)).collect(),
            Target::Displacement(u) => {
                let expected = solid.discretization().dofs();
                if u.len() != expected {
                    let what = format!("{cost} target has {} entries where the mesh needs {expected}", u.len());
                    return Err(ControlError::Cost { what });
                }
                points.positions(solid, Some(u))
            }
        };
        if let Some(bad) = out.iter().position(|x| x.iter().any(|x| !x.is_finite())) {
            let what = format!(
                "{cost} target is not finite at its point {bad} ({:?}); check the formula, or whether the target's mesh covers the body",
                out[bad]
            );
            return Err(ControlError::Cost { what });
        }
        Ok(out)
    }
}
