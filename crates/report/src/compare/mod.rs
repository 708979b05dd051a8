//! Distances between two shapes: [`compare`].

mod distances;
mod print;
mod side;

use crate::error::ReportError;
use crate::record::{ComparedRecord, ComparisonRecord, DistancesRecord, NodeByNodeRecord};
use distances::Distances;
use nastic_mesh::spatial::hausdorff;
use nastic_mesh::{GroupNames, Mesh, MeshError};
use side::{Body, Side};
use std::path::Path;

/// What is compared of two shapes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CompareRequest {
    /// Which part of the bodies; clouds are taken whole.
    pub part: ComparedPart,
    /// Factor of the second shape's lengths; without one, results in different units are refused.
    pub scale: Option<f64>,
}

/// A part of a body.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum ComparedPart {
    /// All of it.
    #[default]
    Whole,
    /// Surfaces, by their names.
    Surface(GroupNames),
    /// Regions, by their names.
    Region(GroupNames),
}

/// How far two shapes are apart: result directories (their optimum, equilibrium or last instant), states of them (`DIR/NAME`), VTU files,
/// meshes, point clouds (CSV, NPY, PLY).
///
/// With the points `P_A` (nodes of the boundary or of the part of a body, points of a cloud) and `d(x, B)`, the distance to the nearest point of
/// B's boundary, curved faces as they are, or of its points: mean, root mean square and largest value of `d` over `P_A`, and the same from
/// B to A; chamfer `mean d(x, B) + mean d(y, A)`; Hausdorff distance, of whole bodies that of the solids with its proof.
/// States of one mesh are compared node by node too.
///
/// # Errors
/// [`ReportError`]: anything else, a part that is not there, units that differ.
pub fn compare(a: &Path, b: &Path, request: &CompareRequest) -> Result<ComparisonRecord, ReportError> {
    if let Some(scale) = request.scale.filter(|scale| !(scale.is_finite() && *scale > 0.0)) {
        return Err(ReportError::Scale { scale });
    }
    let (a, b) = (Side::open(a, &request.part, 1.0)?, Side::open(b, &request.part, request.scale.unwrap_or(1.0))?);
    if let (None, Some(of_a), Some(of_b)) = (request.scale, &a.unit, &b.unit)
        && of_a != of_b
    {
        return Err(ReportError::Units { a: of_a.clone(), b: of_b.clone() });
    }
    let (there, back) = (Distances::between(&a, &b), Distances::between(&b, &a));
    let mut found = ComparisonRecord {
        unit: a.unit.clone().or_else(|| b.unit.clone()).unwrap_or_default(),
        chamfer: (there.mean + back.mean).into(),
        hausdorff: there.largest.max(back.largest).into(),
        a_to_b: record(&there),
        b_to_a: record(&back),
        a: compared(&a),
        b: compared(&b),
        ..ComparisonRecord::default()
    };
    if let (Some(a), Some(b)) = (&a.body, &b.body) {
        if let (Some(a), Some(b)) = (&a.solid, &b.solid) {
            let distance = hausdorff(a, b)?;
            found.hausdorff = distance.distance.into();
            found.hausdorff_gap = distance.gap.into();
        }
        found.node_by_node = node_by_node(a, b);
    }
    Ok(found)
}

/// The nodes of a part.
pub(crate) fn nodes_of(mesh: &Mesh, part: &ComparedPart) -> Result<Vec<u32>, MeshError> {
    Ok(match part {
        ComparedPart::Whole => (0..mesh.points().len() as u32).collect(),
        ComparedPart::Region(names) => mesh.nodes_of_cells(&mesh.cells_of(names)?),
        ComparedPart::Surface(names) => mesh.nodes_of_facets(&mesh.facets_of(names)?),
    })
}

fn compared(side: &Side) -> ComparedRecord {
    ComparedRecord { shape: side.name.clone(), of: side.of.clone(), points: side.points.len() }
}

fn record(distances: &Distances) -> DistancesRecord {
    DistancesRecord {
        mean: distances.mean.into(),
        rms: distances.rms.into(),
        largest: distances.largest.into(),
        from: distances.from.to_vec(),
        to: distances.to.to_vec(),
    }
}

/// Of two states of one mesh.
fn node_by_node(a: &Body, b: &Body) -> Option<NodeByNodeRecord> {
    let same = a.mesh.points().len() == b.mesh.points().len() && a.nodes == b.nodes && a.is_on_mesh_of(b);
    if !same || a.nodes.is_empty() {
        return None;
    }
    let (mut squares, mut largest, mut farthest) = (0.0, -1.0, 0);
    for &node in &a.nodes {
        let distance = distances::apart(a.positions[node as usize], b.positions[node as usize]);
        squares += distance * distance;
        if distance > largest {
            (largest, farthest) = (distance, node as usize);
        }
    }
    let rms = (squares / a.nodes.len() as f64).sqrt();
    Some(NodeByNodeRecord { nodes: a.nodes.len(), rms: rms.into(), largest: largest.into(), node: farthest })
}
