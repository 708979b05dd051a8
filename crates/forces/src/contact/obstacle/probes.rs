//! [`Probes`]: places between the samples of a surface, where an obstacle is looked for that none of them meets.

use crate::contact::pose::Pose;
use crate::contact::samples::{pieces, place};
use nastic_body::error::FemError;
use nastic_mesh::spatial::Obstacle;
use nastic_mesh::{CellKind, Facet, GroupNames, Mesh};
use nastic_tensor::Vec3;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Probes between one sample and the next.
const PROBES_PER_SAMPLE: usize = 4;
/// Largest distance of a point of a second-order facet from its middle over that of its nodes.
const MAX_REACH_RATIO: f64 = 1.25;

/// Places of a surface, four times as dense as its samples. They carry nothing: they show how deep an edge or a corner of an obstacle is inside of
/// the body between samples.
#[derive(Debug, Clone)]
pub(super) struct Probes {
    mesh: Arc<Mesh>,
    /// Nodes of every facet, and where its shape functions are among `shapes`.
    facets: Vec<(Vec<u32>, usize)>,
    /// No place is outside of what its nodes span.
    within_nodes: bool,
    /// Of every kind of facet and number of pieces the shape functions at its places.
    shapes: Vec<Vec<Vec<f64>>>,
}

impl Probes {
    /// Of a surface whose facets are in `refine^2` pieces each (`refine` in the plane).
    pub fn new(mesh: &Arc<Mesh>, surface: &GroupNames, refine: impl Fn(&Facet) -> usize) -> Result<Self, FemError> {
        let mut known: BTreeMap<(CellKind, usize), usize> = BTreeMap::new();
        let (mut facets, mut shapes, mut within_nodes) = (Vec::new(), Vec::new(), true);
        for facet in mesh.facets_of(surface)? {
            let (kind, nodes) = mesh.facet_nodes(facet);
            within_nodes &= kind.order() == 1;
            let n = PROBES_PER_SAMPLE * refine(&facet);
            let table = *known.entry((kind, n)).or_insert_with(|| {
                shapes.push(places(kind, n));
                shapes.len() - 1
            });
            facets.push((nodes, table));
        }
        Ok(Probes { mesh: mesh.clone(), facets, within_nodes, shapes })
    }

    /// The smallest signed distance between samples, where they have that of `nearest` at least, and where it is: theirs where none is smaller.
    pub fn least(&self, obstacle: &Obstacle, pose: &Pose, u: &[f64], nearest: (f64, Vec3)) -> (f64, Vec3) {
        if self.within_nodes && matches!(obstacle, Obstacle::HalfSpace { .. }) {
            return nearest;
        }
        let steepest = obstacle.steepest();
        let mut least = nearest;
        for (nodes, table) in &self.facets {
            let nodes: Vec<Vec3> = nodes.iter().map(|&node| place(&self.mesh, u, node)).collect();
            let middle = nodes.iter().sum::<Vec3>() / nodes.len() as f64;
            let reach = MAX_REACH_RATIO * nodes.iter().map(|x| (x - middle).norm()).fold(0.0, f64::max);
            if pose.guarded(obstacle, &middle) - steepest * reach >= least.0 {
                continue;
            }
            for shapes in &self.shapes[*table] {
                let x: Vec3 = shapes.iter().zip(&nodes).map(|(shape, x)| *shape * x).sum();
                let d = pose.distance(obstacle, &x);
                if d < least.0 {
                    least = (d, x);
                }
            }
        }
        least
    }
}

/// The shape functions at the corners of the pieces of a facet, each place once.
fn places(kind: CellKind, n: usize) -> Vec<Vec<f64>> {
    let key = |xi: &[f64; 3]| [xi[0], xi[1]].map(|x| (x * 1e9).round() as i64);
    let corners: BTreeMap<[i64; 2], [f64; 3]> =
        pieces(kind, n).into_iter().flatten().map(|corner| (key(&corner), corner)).collect();
    let at = |xi: [f64; 3]| {
        let mut shapes = vec![0.0; kind.nodes()];
        kind.shapes(&xi, &mut shapes);
        shapes
    };
    corners.into_values().map(at).collect()
}
