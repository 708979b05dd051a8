//! [`Foundation`]: a surface on an elastic bed.

use crate::element_matrices::ElementMatrices;
use nastic_body::contribution::Contribution;
use nastic_body::contribution::point::{ContributionPoint, Need};
use nastic_body::error::{FemError, Inadmissible};
use nastic_body::instant::Instant;
use nastic_mesh::{CellKind, GroupNames, Mesh};
use nastic_tensor::{Mat3, Vec3};

/// An elastic foundation (Winkler): a surface tied to its reference position by springs of stiffness k per reference area (N/m^3),
/// potential
///
/// ```text
/// (k/2) int |u|^2 dA,      of the normal component alone (k/2) int (N . u)^2 dA
/// ```
///
/// with the reference normal N: linear, without loss of contact. It may hold a body that nothing else holds. In plane strain per unit of
/// thickness. Source: docs/model/equilibrium.md.
#[derive(Debug, Clone, PartialEq)]
pub struct Foundation {
    surface: GroupNames,
    stiffness: f64,
    normal_only: bool,
}

impl Foundation {
    /// Springs of this stiffness per reference area in every direction.
    pub fn on(surface: impl Into<GroupNames>, stiffness: f64) -> Self {
        Foundation { surface: surface.into(), stiffness, normal_only: false }
    }

    /// Springs along the reference normal alone: the surface slides freely along itself.
    #[must_use]
    pub fn normal_only(mut self) -> Self {
        self.normal_only = true;
        self
    }

    /// The contribution on a mesh.
    ///
    /// # Errors
    /// An unknown surface; a stiffness that is not positive.
    pub fn of(&self, mesh: &Mesh) -> Result<Springs, FemError> {
        let name = format!("foundation on {}", self.surface);
        if !(self.stiffness.is_finite() && self.stiffness > 0.0) {
            let what = format!("{name} has a stiffness of {}; it must be positive and finite", self.stiffness);
            return Err(FemError::Meaningless { what });
        }
        let (dim, holds) = (mesh.dim(), Vec::new());
        let mut springs = Springs { name, dim, facets: ElementMatrices::by_component(dim), holds };
        for facet in mesh.facets_of(&self.surface)? {
            let (kind, nodes) = mesh.facet_nodes(facet);
            springs.add(mesh, kind, nodes, self);
        }
        Ok(springs)
    }
}

/// The contribution of a [`Foundation`]: residual K u.
#[derive(Debug)]
pub struct Springs {
    name: String,
    dim: usize,
    facets: ElementMatrices,
    /// Displacements that it resists to.
    holds: Vec<Vec<(u32, f64)>>,
}

impl Springs {
    /// `k int N_a N_b dA 1`, of the normal alone `k int N_a N_b N (x) N dA`.
    fn add(&mut self, mesh: &Mesh, kind: CellKind, nodes: Vec<u32>, of: &Foundation) {
        let (dim, n) = (self.dim, self.dim * nodes.len());
        let positions = mesh.gather(mesh.points(), &nodes);
        // products of two shape functions
        let rule = kind.rule_of_degree(2 * kind.order() * kind.dim());
        let mut shapes = vec![0.0; nodes.len()];
        let mut k = vec![0.0; n * n];
        for (xi, weight) in rule.points.iter().zip(&rule.weights) {
            kind.shapes(xi, &mut shapes);
            let [along, across, _] = kind.tangents(&positions, xi).map(Vec3::from);
            let normal = if dim == 2 { along.cross(&Vec3::z()) } else { along.cross(&across) };
            let (area, normal) = (weight * normal.norm(), normal.normalize());
            let block = if of.normal_only { normal * normal.transpose() } else { Mat3::identity() };
            for (at, entry) in k.iter_mut().enumerate() {
                let (row, column) = (at / n, at % n);
                let pair = shapes[row / dim] * shapes[column / dim];
                *entry += of.stiffness * area * pair * block[(row % dim, column % dim)];
            }
            for direction in (0..dim).filter(|i| !of.normal_only || *i == 0) {
                let component = |i: usize| if of.normal_only { normal[i] } else { f64::from(u8::from(i == direction)) };
                let of_node = |(a, node): (usize, &u32)| {
                    let shape = shapes[a];
                    (0..dim).map(move |i| (dim as u32 * node + i as u32, shape * component(i))).collect::<Vec<_>>()
                };
                self.holds.push(nodes.iter().enumerate().flat_map(of_node).collect());
            }
        }
        self.facets.push(nodes, k);
    }
}

impl Contribution for Springs {
    fn name(&self) -> &str {
        &self.name
    }

    fn stores_energy(&self) -> bool {
        true
    }

    fn spans_ranks(&self) -> bool {
        true
    }

    fn resists(&self) -> &[Vec<(u32, f64)>] {
        &self.holds
    }

    fn drawn_nodes(&self) -> Vec<u32> {
        self.facets.nodes()
    }

    /// The force of the bed on the body.
    fn quantities(&self, at: &Instant) -> Vec<(&'static str, f64)> {
        let mut force = [0.0; 3];
        self.facets.each_product(at.u, |dof, value| force[dof % self.dim] -= value);
        ["force_x", "force_y", "force_z"].into_iter().zip(force).take(self.dim).collect()
    }

    fn at<'a>(&'a self, _: &Instant, _: Need) -> Result<Box<dyn ContributionPoint + 'a>, Inadmissible> {
        Ok(Box::new(&self.facets))
    }
}
