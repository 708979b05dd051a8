//! The mean shape of an ensemble, and how far single scenarios lie from it.

use super::Ensemble;
use crate::error::EnsembleError;
use crate::member::Member;
use crate::point::EnsemblePoint;
use nastic_control::{ControlError, Evaluated};
use nastic_mesh::Snapshot;

impl Ensemble {
    /// Mean and scatter of the positions over the scenarios, for viewers, of one load case (`""` where there is but one).
    ///
    /// Point data: `displacement`, the expected one `E[u]`; `deviation`, the standard deviation of each coordinate;
    /// `deviation_norm`, `sqrt(E |u - E[u]|^2)`. All are lengths. Negative weights (of sparse rules) may leave a variance
    /// below zero, which is shown as zero.
    ///
    /// # Errors
    /// [`EnsembleError::Shape`] for an unknown load case, or scenarios on different meshes.
    pub fn mean_shape(&self, point: &EnsemblePoint, load_case: &str) -> Result<Snapshot, EnsembleError> {
        let members: Vec<(&Member, &Evaluated)> =
            self.members.iter().zip(&point.members).filter(|(member, _)| member.case == load_case).collect();
        let Some((first, at)) = members.first() else {
            return Err(EnsembleError::Shape { what: format!("there is no load case \"{load_case}\"") });
        };
        let mesh = first.problem.solid().mesh();
        for (member, _) in &members {
            if member.problem.solid().mesh().points() != mesh.points() {
                let what =
                    format!("{} and {} have different meshes, so there is no mean of both", member.name, first.name);
                return Err(EnsembleError::Shape { what });
            }
        }
        let p = |member: &Member| self.probabilities[member.scenario];
        let moved = |at: &Evaluated| first.problem.solid().model().displacement(&at.state().u).into_owned();
        let mut mean = vec![0.0; moved(at).len()];
        for (member, at) in &members {
            mean.iter_mut().zip(moved(at)).for_each(|(mean, u)| *mean += p(member) * u);
        }
        let mut variance = vec![0.0; mean.len()];
        for (member, at) in &members {
            for ((variance, u), mean) in variance.iter_mut().zip(moved(at)).zip(&mean) {
                *variance += p(member) * (u - mean).powi(2);
            }
        }
        let triples = |values: &[f64]| -> Vec<f64> {
            values.chunks_exact(mesh.dim()).flat_map(|v| [v[0], v[1], v.get(2).copied().unwrap_or(0.0)]).collect()
        };
        let deviation: Vec<f64> = variance.iter().map(|v| v.max(0.0).sqrt()).collect();
        let norm = variance.chunks_exact(mesh.dim()).map(|v| v.iter().sum::<f64>().max(0.0).sqrt()).collect();
        Snapshot::new(mesh.clone())
            .with_points("displacement", 3, triples(&mean))
            .and_then(|shot| shot.with_points("deviation", 3, triples(&deviation)))
            .and_then(|shot| shot.with_points("deviation_norm", 1, norm))
            .map_err(|e| EnsembleError::member(&first.name, ControlError::from(e)))
    }
}
