//! [`Medium`]: what keeps cells of a void from folding.

use crate::element_matrices::ElementMatrices;
use nastic_body::contribution::Contribution;
use nastic_body::contribution::point::{ContributionPoint, Need};
use nastic_body::error::{FemError, Inadmissible};
use nastic_body::instant::Instant;
use nastic_mesh::{Cell, CellKind, GroupNames, Mesh};
use nastic_tensor::{Mat3, Vec3};
use std::collections::{BTreeMap, BTreeSet};

/// A third medium: the cells of a region, most often of a `density` near 0, resist to what their deformation gradient varies by, potential
///
/// ```text
/// (k/2) int |F - F_c|^2 dX,     F_c the mean of F over each cell,
/// ```
///
/// with a stiffness k (Pa): quadratic in u and zero where cells deform affinely. It takes away the modes in which cells fold while their mean is sound, so
/// that parts which meet across the region press on each other through it. Of linear simplices, in which F is constant, F_c is the mean over the patch P of cells
/// of the region round a node, each cell with the share 1/(d + 1) of its volume:
///
/// ```text
/// (k/2) sum_nodes sum_{c in P} |c|/(d + 1) |F_c - F_P|^2.
/// ```
///
/// In plane strain per unit of thickness.
///
/// **Source.** O. Faltus, A. Amato & M. Horak, arXiv:2603.13063.
#[derive(Debug, Clone, PartialEq)]
pub struct Medium {
    name: String,
    region: GroupNames,
    stiffness: f64,
}

impl Medium {
    /// Over a region.
    pub fn over(name: &str, region: impl Into<GroupNames>, stiffness: f64) -> Self {
        Medium { name: name.to_owned(), region: region.into(), stiffness }
    }

    /// The contribution on a mesh.
    ///
    /// # Errors
    /// An unknown region; a stiffness that is not positive; a cell without volume.
    pub fn of(&self, mesh: &Mesh) -> Result<FilledCells, FemError> {
        let fail = |what: String| Err(FemError::Meaningless { what: format!("{} {what}", self.name) });
        if !(self.stiffness.is_finite() && self.stiffness > 0.0) {
            return fail(format!("has a stiffness of {}; it must be positive and finite", self.stiffness));
        }
        let mut cells = ElementMatrices::by_node(mesh.dim());
        let mut patches: BTreeMap<u32, Patch> = BTreeMap::new();
        for cell in mesh.cells_of(&self.region)? {
            let Cell { kind, nodes } = mesh.cell(cell as usize);
            let Some(points) = gradients(mesh, kind, nodes) else {
                return fail(format!("lies on cell {cell}, which is turned over or has no volume at a point"));
            };
            if matches!(kind, CellKind::Tri3 | CellKind::Tet4) {
                for node in nodes {
                    let own = points.iter().map(|(volume, all)| (volume / nodes.len() as f64, all));
                    patches.entry(*node).or_default().extend(own.map(|(volume, all)| {
                        (volume, nodes.iter().copied().zip(all.iter().copied()).collect::<BTreeMap<_, _>>())
                    }));
                }
                continue;
            }
            let n = nodes.len();
            let k = variation(n, &points, self.stiffness);
            cells.push(nodes.to_vec(), k);
        }
        let mut couplings = Vec::new();
        for patch in patches.values().filter(|patch| patch.len() > 1) {
            let nodes: Vec<u32> =
                patch.iter().flat_map(|(_, own)| own.keys().copied()).collect::<BTreeSet<_>>().into_iter().collect();
            let of = |own: &BTreeMap<u32, Vec3>| {
                nodes.iter().map(|node| own.get(node).copied().unwrap_or_default()).collect::<Vec<_>>()
            };
            let points: Vec<(f64, Vec<Vec3>)> = patch.iter().map(|(volume, own)| (*volume, of(own))).collect();
            let k = variation(nodes.len(), &points, self.stiffness);
            cells.push(nodes.clone(), k);
            couplings.push(nodes);
        }
        Ok(FilledCells { name: self.name.clone(), cells, couplings })
    }
}

/// Of each cell round a node its share of volume, and the gradients of its shape functions by node.
type Patch = Vec<(f64, BTreeMap<u32, Vec3>)>;

/// Volume and gradients of the shape functions at the points of a cell; `None` where it has no volume.
fn gradients(mesh: &Mesh, kind: CellKind, nodes: &[u32]) -> Option<Vec<(f64, Vec<Vec3>)>> {
    let (dim, n) = (mesh.dim(), nodes.len());
    let positions = mesh.gather(mesh.points(), nodes);
    let rule = kind.rule_of_degree(2 * kind.order());
    let mut reference = vec![[0.0; 3]; n];
    let mut gradients: Vec<(f64, Vec<Vec3>)> = Vec::new();
    for (xi, weight) in rule.points.iter().zip(&rule.weights) {
        kind.gradients(xi, &mut reference);
        // dx_i/dxi_k in column k, the third direction of a plane body left alone
        let mut tangents = Mat3::from_columns(&kind.tangents(&positions, xi).map(Vec3::from));
        if dim == 2 {
            tangents[(2, 2)] = 1.0;
        }
        let (volume, inverse) = (weight * tangents.determinant(), tangents.try_inverse()?);
        if volume <= 0.0 || volume.is_nan() {
            return None;
        }
        gradients.push((volume, reference.iter().map(|own| inverse.transpose() * Vec3::from(*own)).collect()));
    }
    Some(gradients)
}

/// `k int (grad N_a - mean) . (grad N_b - mean) dX` by nodes a and b, row after row.
fn variation(n: usize, gradients: &[(f64, Vec<Vec3>)], stiffness: f64) -> Vec<f64> {
    let whole: f64 = gradients.iter().map(|(volume, _)| volume).sum();
    let mean = |a: usize| gradients.iter().map(|(volume, own)| own[a] * (volume / whole)).sum::<Vec3>();
    let means: Vec<Vec3> = (0..n).map(mean).collect();
    let mut k = vec![0.0; n * n];
    for (volume, own) in gradients {
        for (at, entry) in k.iter_mut().enumerate() {
            let (a, b) = (at / n, at % n);
            *entry += stiffness * volume * (own[a] - means[a]).dot(&(own[b] - means[b]));
        }
    }
    k
}

/// The contribution of a [`Medium`]: residual K u, K the same for every component.
#[derive(Debug)]
pub struct FilledCells {
    name: String,
    cells: ElementMatrices,
    /// Nodes of the patches of linear simplices.
    couplings: Vec<Vec<u32>>,
}

impl Contribution for FilledCells {
    fn name(&self) -> &str {
        &self.name
    }

    fn couplings(&self) -> Vec<Vec<u32>> {
        self.couplings.clone()
    }

    fn stores_energy(&self) -> bool {
        true
    }

    /// Deformation gradients are those from the drawn cells.
    fn drawn_nodes(&self) -> Vec<u32> {
        self.cells.nodes()
    }

    fn quantities(&self, at: &Instant) -> Vec<(&'static str, f64)> {
        let mut energy = 0.0;
        self.cells.each_product(at.u, |dof, force| energy += 0.5 * force * at.u[dof]);
        vec![("energy", energy)]
    }

    fn at<'a>(&'a self, _: &Instant, _: Need) -> Result<Box<dyn ContributionPoint + 'a>, Inadmissible> {
        Ok(Box::new(&self.cells))
    }
}
