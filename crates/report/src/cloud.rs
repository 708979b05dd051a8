//! The points of a state: [`cloud`].

use crate::compare::{ComparedPart, nodes_of};
use crate::error::ReportError;
use crate::figure::State;
use crate::folder::ResultFolder;
use nastic_io::PointCloud;
use std::path::Path;

/// The nodes of a body or of a part of it in a state of a result directory, in the case's unit of length: the optimum, the equilibrium or the
/// last instant unless a state is named (`motion_0040`, `optimum`, ..).
///
/// # Errors
/// [`ReportError`]: no results, a state or part that they do not have.
pub fn cloud(directory: &Path, state: Option<&str>, part: &ComparedPart) -> Result<PointCloud, ReportError> {
    let folder = ResultFolder::open(directory)?;
    let shot = State::find(&folder, state)?.shot;
    let (nodes, positions) = (nodes_of(&shot.mesh, part)?, shot.positions());
    let at = |points: &[[f64; 3]]| nodes.iter().map(|&node| points[node as usize]).collect();
    Ok(PointCloud { reference: at(shot.mesh.points()), points: at(&positions), nodes })
}
