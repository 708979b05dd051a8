//! [`Enclosed`]: the volume behind a surface as a sum over its facets and lids.

use super::Cavity;
use super::rim::{PLANE_TOLERANCE, Plane, RimEdge, open_edges, places, rims};
use super::triple_product::{Term, Volume};
use nastic_body::discretization::supports::Supports;
use nastic_body::error::FemError;
use nastic_linear::{NotCoupled, SparseMatrix};
use nastic_mesh::{CellKind, Mesh, Rule};
use nastic_tensor::Vec3;
use std::collections::BTreeSet;
use std::sync::Arc;

/// The enclosed volume of a surface and its lids.
#[derive(Debug)]
pub(super) struct Enclosed {
    mesh: Arc<Mesh>,
    /// o, from which all positions are taken.
    origin: Vec3,
    /// By kind of facet: the terms of one facet, and the nodes of all.
    facets: Vec<(Vec<Term>, Vec<Vec<u32>>)>,
    lids: Vec<Lid>,
    planes: Vec<Plane>,
}

/// Triangles from the mean c of a rim's nodes to its edges.
#[derive(Debug)]
struct Lid {
    nodes: Vec<u32>,
    /// For each edge its nodes as positions in `nodes`; its terms are in those nodes, then c.
    edges: Vec<(Vec<usize>, Vec<Term>)>,
    /// Planes of symmetry that the rim ends on: there c lies on them.
    planes: Vec<Plane>,
}

/// A share of the volume with its derivatives by the positions of some nodes.
pub(super) struct Patch<'a> {
    nodes: &'a [u32],
    dim: usize,
    pub volume: Volume,
}

impl Enclosed {
    pub fn new(mesh: &Arc<Mesh>, cavity: &Cavity) -> Result<Self, FemError> {
        let surface = mesh.facets_of(&cavity.surface)?;
        let planes = cavity.symmetry.iter().map(|name| Plane::of(mesh, name)).collect::<Result<Vec<_>, _>>()?;
        // o can lie on one plane across an axis alone; the cap on another one would be missing from the volume.
        let parallel = |p: &Plane| {
            planes.iter().any(|q| q.axis == p.axis && (q.at - p.at).abs() > PLANE_TOLERANCE * mesh.diagonal())
        };
        if planes.iter().any(parallel) {
            let what = format!(
                "cavity \"{}\" ends on two parallel planes of symmetry; name one of them and close the other end by a lid",
                cavity.name
            );
            return Err(FemError::Meaningless { what });
        }
        if cavity.filled && (cavity.lid || cavity.open) {
            let what = format!(
                "cavity \"{}\" is the body itself (\"filled\") and has a lid or is open: name a closed surface",
                cavity.name
            );
            return Err(FemError::Meaningless { what });
        }
        let open = open_edges(mesh, &surface, &planes);
        if !open.is_empty() && !cavity.lid && !cavity.open {
            let what = format!(
                "surface \"{}\" of cavity \"{}\" is open at {} edges, {}; name the surfaces that are missing there, close it by a lid, or \
                 name the planes of symmetry on which it ends, or, where the supports hold its rim, say that it is \"open\"",
                cavity.surface,
                cavity.name,
                open.len(),
                places(mesh, open)
            );
            return Err(FemError::Meaningless { what });
        }
        let mut facets: Vec<(CellKind, Vec<Vec<u32>>)> = Vec::new();
        for &facet in &surface {
            let (kind, nodes) = mesh.facet_nodes(facet);
            match facets.iter_mut().find(|(known, _)| *known == kind) {
                Some((_, all)) => all.push(nodes),
                None => facets.push((kind, vec![nodes])),
            }
        }
        let sign = if cavity.filled { 1.0 } else { -1.0 };
        let facets = facets.into_iter().map(|(kind, nodes)| (facet_terms(kind, sign), nodes)).collect();
        let plane_strain = mesh.dim() == 2;
        let lids = rims(open, plane_strain).into_iter().map(|rim| Lid::new(mesh, rim, &planes)).collect();
        // the volume of what is closed is the same from everywhere, and loses digits from far away
        let near = surface.first().filter(|_| !cavity.open).map(|facet| mesh.facet_nodes(*facet).1);
        let near = near.and_then(|nodes| Some(mesh.points()[*nodes.first()? as usize]));
        let mut origin = near.map_or(Vec3::zeros(), Vec3::from);
        planes.iter().for_each(|plane| origin[plane.axis] = plane.at);
        Ok(Enclosed { mesh: mesh.clone(), origin, facets, lids, planes })
    }

    pub fn dim(&self) -> usize {
        self.mesh.dim()
    }

    /// A node of the surface on a plane of symmetry that may leave it or is moved out of it, with the axis across which it moves: the
    /// volume is measured from the plane where it is at rest.
    pub fn loose(&self, supports: &Supports) -> Option<(u32, usize)> {
        let dim = self.mesh.dim();
        let nodes = self.facets.iter().flat_map(|(_, facets)| facets.iter().flatten());
        let on_planes = nodes.flat_map(|&node| self.planes.iter().map(move |plane| (node, plane)));
        on_planes
            .filter(|(node, plane)| plane.has(&self.mesh, *node))
            .find(|(node, plane)| !supports.holds_at_rest(dim * *node as usize + plane.axis))
            .map(|(node, plane)| (node, plane.axis))
    }

    /// Whether the nodes of a rim lie, and are held, in one plane across an axis: no control moves them out of it.
    pub fn stays_in_plane(&self, rim: &[u32], supports: &Supports) -> bool {
        let (dim, tolerance) = (self.mesh.dim(), PLANE_TOLERANCE * self.mesh.diagonal());
        let dof = |node: u32, axis: usize| dim * node as usize + axis;
        (0..dim).any(|axis| {
            let held = rim.iter().all(|&node| supports.holds_still(dof(node, axis)));
            let place = |node: u32| self.mesh.points()[node as usize][axis] + supports.values()[dof(node, axis)];
            held && rim.windows(2).all(|pair| (place(pair[0]) - place(pair[1])).abs() <= tolerance)
        })
    }

    /// The nodes of the surface, ascending, each once.
    pub fn nodes(&self) -> Vec<u32> {
        let nodes: BTreeSet<u32> =
            self.facets.iter().flat_map(|(_, facets)| facets.iter().flatten()).copied().collect();
        nodes.into_iter().collect()
    }

    /// The nodes of every rim that has a lid.
    pub fn rims(&self) -> Vec<Vec<u32>> {
        self.lids.iter().map(|lid| lid.nodes.clone()).collect()
    }

    /// The volume of the body displaced by u.
    pub fn volume(&self, u: Option<&[f64]>) -> f64 {
        let mut sum = 0.0;
        self.each(u, false, |patch| sum += patch.volume.value);
        sum
    }

    /// `int cof(F) N dA` over the surface itself, lids left out: d times the sum of the derivatives of its share of the volume, with the sign
    /// of N.
    pub fn area_vector(&self, u: &[f64]) -> Vec3 {
        let dim = self.mesh.dim();
        let mut sum = Vec3::zeros();
        let facets: usize = self.facets.iter().map(|(_, facets)| facets.len()).sum();
        let mut left = facets;
        self.each(Some(u), false, |patch| {
            if left > 0 {
                left -= 1;
                patch.each_component(|dof, gradient| sum[dof % dim] -= dim as f64 * gradient);
            }
        });
        sum
    }

    /// Calls with every share of the volume, in a fixed order, the surface's before those of lids; with second derivatives if asked.
    pub fn each<'s>(&'s self, u: Option<&[f64]>, second: bool, mut call: impl FnMut(&Patch<'s>)) {
        self.each_patch(u, 1.0, second, |patch| call(&patch));
    }

    /// Every share of the volume of the body displaced by u, with first derivatives, in the order of [`each`](Self::each).
    pub fn shares(&self, u: &[f64]) -> Vec<Patch<'_>> {
        let mut all = Vec::new();
        self.each_patch(Some(u), 1.0, false, |patch| all.push(patch));
        all
    }

    /// Adds `factor` times the second derivative at a displacement.
    pub fn add_hessian(&self, u: &[f64], factor: f64, tangent: &mut SparseMatrix) -> Result<(), NotCoupled> {
        let mut added = Ok(());
        if factor != 0.0 {
            self.each(Some(u), true, |patch| {
                if added.is_ok() {
                    added = patch.add_hessian(factor, tangent);
                }
            });
        }
        added
    }

    /// Calls with the change of every share along a change a of the displacement, whose second derivatives are `V_uuu[a]`: the
    /// volume is cubic in positions, so its second derivatives are affine in them, and their linear part is what they are at a
    /// alone, where nothing else (o, c on planes of symmetry, the normal in plane strain) has a position.
    pub fn each_change<'s>(&'s self, a: &[f64], mut call: impl FnMut(&Patch<'s>)) {
        self.each_patch(Some(a), 0.0, true, |patch| call(&patch));
    }

    /// `constants` multiplies all positions that do not depend on the displacement: 1, or 0 for the part of highest degree.
    fn each_patch<'s>(&'s self, u: Option<&[f64]>, constants: f64, second: bool, mut call: impl FnMut(Patch<'s>)) {
        let dim = self.mesh.dim();
        // from o, before the displacement is added, which is small beside the place of a body that is far away
        let position = |node: u32| {
            let mut x = constants * (Vec3::from(self.mesh.points()[node as usize]) - self.origin);
            if let Some(u) = u {
                (0..dim).for_each(|i| x[i] += u[dim * node as usize + i]);
            }
            x
        };
        for (terms, facets) in &self.facets {
            for nodes in facets {
                let x: Vec<Vec3> = nodes.iter().map(|&node| position(node)).collect();
                let mut volume = Volume::zero(nodes.len(), second);
                terms.iter().for_each(|term| volume.add(term, &x, constants));
                call(Patch { nodes, dim, volume });
            }
        }
        for lid in &self.lids {
            let x: Vec<Vec3> = lid.nodes.iter().map(|&node| position(node)).collect();
            call(Patch { nodes: &lid.nodes, dim, volume: lid.volume(&x, second, &self.origin, constants) });
        }
    }
}

impl Patch<'_> {
    /// Calls with every unknown and the derivative of the volume by it.
    pub fn each_component(&self, mut call: impl FnMut(usize, f64)) {
        for (&node, gradient) in self.nodes.iter().zip(&self.volume.gradient) {
            (0..self.dim).for_each(|i| call(self.dim * node as usize + i, gradient[i]));
        }
    }

    /// Entry of the second derivative by components i, j of the a-th and b-th node.
    fn second(&self, a: usize, i: usize, b: usize, j: usize) -> f64 {
        self.volume.hessian[3 * self.nodes.len() * (3 * a + i) + 3 * b + j]
    }

    /// Adds `factor` times the second derivative.
    pub fn add_hessian(&self, factor: f64, tangent: &mut SparseMatrix) -> Result<(), NotCoupled> {
        let (n, dim) = (self.nodes.len(), self.dim);
        let entry = |at: usize| {
            let (row, column) = (at / (dim * n), at % (dim * n));
            factor * self.second(row / dim, row % dim, column / dim, column % dim)
        };
        let element: Vec<f64> = (0..(dim * n).pow(2)).map(entry).collect();
        tangent.add_pairs(self.nodes, &element)
    }

    /// Adds `factor` times the second derivative times v.
    pub fn add_hessian_product(&self, factor: f64, v: &[f64], out: &mut [f64]) {
        for (a, &row) in self.nodes.iter().enumerate() {
            for (b, &column) in self.nodes.iter().enumerate() {
                for i in 0..self.dim {
                    let sum: f64 =
                        (0..self.dim).map(|j| self.second(a, i, b, j) * v[self.dim * column as usize + j]).sum();
                    out[self.dim * row as usize + i] += factor * sum;
                }
            }
        }
    }
}

/// `s (1/3) (x - o) . (x_xi x x_eta)` at the points of a facet, `s (1/2) det(x - o, x_xi, e_z)` of an edge: s = -1 of a room, 1 of the body itself.
fn facet_terms(kind: CellKind, sign: f64) -> Vec<Term> {
    let (n, dim) = (kind.nodes(), kind.dim());
    // a triple product of shapes of order k has degree 3 k on triangles, and no more along each axis of a quadrilateral
    let rule = kind.rule_of_degree(3 * kind.order());
    let (mut shapes, mut gradients) = (vec![0.0; n], vec![[0.0; 3]; n]);
    let term = |(xi, weight): (&[f64; 3], &f64)| {
        kind.shapes(xi, &mut shapes);
        kind.gradients(xi, &mut gradients);
        let along = |k: usize| gradients.iter().map(|g| g[k]).collect::<Vec<f64>>();
        let (p, q) = (shapes.clone(), along(0));
        match dim {
            1 => Term { weight: sign * 0.5 * weight, p, q, r: vec![0.0; n], normal: Vec3::z() },
            _ => Term { weight: sign * weight / 3.0, p, q, r: along(1), normal: Vec3::zeros() },
        }
    };
    rule.points.iter().zip(&rule.weights).map(term).collect()
}

impl Lid {
    fn new(mesh: &Mesh, rim: Vec<RimEdge>, planes: &[Plane]) -> Self {
        let mut nodes: Vec<u32> = rim.iter().flat_map(|edge| edge.nodes.iter().copied()).collect();
        nodes.sort_unstable();
        nodes.dedup();
        // in plane strain a single end is left where the other one lies on a plane of symmetry
        let single = nodes.len() == 1;
        let touched = |plane: &&Plane| single || nodes.iter().any(|&node| plane.has(mesh, node));
        let planes = planes.iter().filter(touched).copied().collect();
        let local = |node: &u32| nodes.binary_search(node).unwrap_or_default();
        let edges = rim.iter().map(|edge| (edge.nodes.iter().map(local).collect(), edge_terms(edge))).collect();
        Lid { nodes, edges, planes }
    }

    /// By the rim's nodes, whose places x are from o: c is their mean, on the planes of symmetry. See [`Volume::add`].
    fn volume(&self, x: &[Vec3], second: bool, origin: &Vec3, constants: f64) -> Volume {
        let n = self.nodes.len();
        let share = 1.0 / n as f64;
        let mut c = share * x.iter().sum::<Vec3>();
        let mut free = Vec3::repeat(share);
        for plane in &self.planes {
            (c[plane.axis], free[plane.axis]) = (constants * (plane.at - origin[plane.axis]), 0.0);
        }
        let mut sum = Volume::zero(n, second);
        let mut by_c = Vec3::zeros();
        // second derivatives by c and a component of a node, and by c twice
        let mut mixed = vec![[[0.0; 3]; 3]; if second { n } else { 0 }];
        let mut twice = [[0.0; 3]; 3];
        for (edge, terms) in &self.edges {
            let m = edge.len();
            let local: Vec<Vec3> = edge.iter().map(|&a| x[a]).chain([c]).collect();
            let mut own = Volume::zero(m + 1, second);
            terms.iter().for_each(|term| own.add(term, &local, constants));
            sum.value += own.value;
            sum.scale += own.scale;
            edge.iter().zip(&own.gradient).for_each(|(&a, g)| sum.gradient[a] += g);
            by_c += own.gradient[m];
            if !second {
                continue;
            }
            let entry =
                |(a, i): (usize, usize), (b, j): (usize, usize)| own.hessian[3 * (m + 1) * (3 * a + i) + 3 * b + j];
            for (i, j) in (0..9).map(|k| (k / 3, k % 3)) {
                twice[i][j] += entry((m, i), (m, j));
                for (k, &a) in edge.iter().enumerate() {
                    mixed[a][i][j] += entry((k, i), (m, j));
                    for (l, &b) in edge.iter().enumerate() {
                        sum.hessian[3 * n * (3 * a + i) + 3 * b + j] += entry((k, i), (l, j));
                    }
                }
            }
        }
        sum.gradient.iter_mut().for_each(|g| *g += free.component_mul(&by_c));
        if second {
            for a in 0..n {
                for b in 0..n {
                    for (i, j) in (0..9).map(|k| (k / 3, k % 3)) {
                        sum.hessian[3 * n * (3 * a + i) + 3 * b + j] +=
                            free[j] * mixed[a][i][j] + free[i] * mixed[b][j][i] + free[i] * free[j] * twice[i][j];
                    }
                }
            }
        }
        sum
    }
}

/// `-(1/6) (c - o) . (x' x (x - c))` along an edge, in its nodes, then c; in plane strain `+-(1/2) det(c - o, x - c, e_z)`.
fn edge_terms(edge: &RimEdge) -> Vec<Term> {
    let m = edge.nodes.len();
    let of_c = |value: f64| (0..=m).map(|a| if a == m { value } else { 0.0 }).collect::<Vec<f64>>();
    if m == 1 {
        let weight = if edge.end { 0.5 } else { -0.5 };
        return vec![Term { weight, p: of_c(1.0), q: vec![1.0, -1.0], r: vec![0.0; 2], normal: Vec3::z() }];
    }
    let kind = if m == 2 { CellKind::Line2 } else { CellKind::Line3 };
    let rule = Rule::tensor(1, m);
    let (mut shapes, mut gradients) = (vec![0.0; m], vec![[0.0; 3]; m]);
    let term = |(xi, weight): (&[f64; 3], &f64)| {
        kind.shapes(xi, &mut shapes);
        kind.gradients(xi, &mut gradients);
        let q = gradients.iter().map(|g| g[0]).chain([0.0]).collect();
        let r = shapes.iter().copied().chain([-1.0]).collect();
        Term { weight: -weight / 6.0, p: of_c(1.0), q, r, normal: Vec3::zeros() }
    };
    rule.points.iter().zip(&rule.weights).map(term).collect()
}
