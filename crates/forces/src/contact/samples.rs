//! [`Samples`]: the points of a surface at which it may touch.

use nastic_body::error::FemError;
use nastic_mesh::{CellKind, Facet, GroupNames, Mesh};
use nastic_tensor::Vec3;
use std::collections::BTreeMap;
use std::ops::Range;

/// Points of a surface, `x_s = sum_a N_a(x_s) x_a`, with weights by reference area: closed rules that contain the nodes, with
/// `sum_s w_s N_a(x_s) = int N_a dA` on every facet, so that a uniform pressure gives the consistent nodal forces (contact patch test).
///
/// Nodes alone on line2, line3, tri3, quad4 and quad9; with the centroid on tri6 (weight 9/20) and quad8 (16/36), whose corners would
/// else have weights of zero and below.
#[derive(Debug, Clone)]
pub(super) struct Samples {
    /// Nodes and values of their shape functions, of all samples one after the other.
    parts: Vec<(u32, f64)>,
    /// Where the parts of each sample begin; one more than there are samples.
    first: Vec<usize>,
    /// m^2; per unit of thickness in plane strain.
    pub weights: Vec<f64>,
    /// Those between nodes, by facet; the others come before them.
    pub between: Vec<Between>,
}

/// Nodes of a sample with the values of their shape functions, and its weight.
type Sample = (Vec<(u32, f64)>, f64);

/// The samples of a facet that are not at its nodes.
#[derive(Debug, Clone)]
pub(super) struct Between {
    pub samples: Range<usize>,
    /// The samples at the nodes of the facet.
    nodes: Vec<usize>,
    /// The largest `sum_a |N_a|` of them.
    spread: f64,
}

impl Between {
    /// The value v of a field at one node of the facet, and how much at most any of its samples differs from that: `|v_s - v| <= max_s sum_a |N_a|
    /// max_a |v_a - v|`.
    pub fn about(&self, at_node: impl Fn(usize) -> Vec3) -> (usize, Vec3, f64) {
        let (first, others) = self.nodes.split_first().map_or((0, &[][..]), |(first, others)| (*first, others));
        let value = at_node(first);
        let farthest = others.iter().map(|&node| (at_node(node) - value).norm()).fold(0.0, f64::max);
        (first, value, self.spread * farthest)
    }
}

impl Samples {
    /// Of a surface, each facet in `refine^2` pieces (`refine` in the plane), which facets may differ in.
    pub fn new(mesh: &Mesh, surface: &GroupNames, refine: impl Fn(&Facet) -> usize) -> Result<Self, FemError> {
        let mut at_nodes: BTreeMap<u32, f64> = BTreeMap::new();
        let mut between: Vec<Vec<Sample>> = Vec::new();
        let mut nodes_of: Vec<Vec<u32>> = Vec::new();
        for facet in mesh.facets_of(surface)? {
            let (kind, nodes) = mesh.facet_nodes(facet);
            let positions = mesh.gather(mesh.points(), &nodes);
            let mut of_facet: BTreeMap<[i64; 2], (Vec<f64>, f64)> = BTreeMap::new();
            for corners in pieces(kind, refine(&facet)) {
                for (xi, weight) in rule(kind, &positions, &corners) {
                    let mut shapes = vec![0.0; nodes.len()];
                    kind.shapes(&xi, &mut shapes);
                    // points that pieces share
                    let key = [xi[0], xi[1]].map(|x| (x * 1e9).round() as i64);
                    of_facet.entry(key).or_insert((shapes, 0.0)).1 += weight;
                }
            }
            let mut own = Vec::new();
            for (shapes, weight) in of_facet.into_values() {
                match shapes.iter().position(|shape| (shape - 1.0).abs() < 1e-9) {
                    Some(node) => *at_nodes.entry(nodes[node]).or_default() += weight,
                    None => {
                        let parts = nodes.iter().copied().zip(shapes).filter(|(_, shape)| shape.abs() > 1e-12);
                        own.push((parts.collect(), weight));
                    }
                }
            }
            between.push(own);
            nodes_of.push(nodes);
        }
        let mut samples = Samples { parts: Vec::new(), first: vec![0], weights: Vec::new(), between: Vec::new() };
        let numbers: BTreeMap<u32, usize> = at_nodes.keys().copied().zip(0..).collect();
        at_nodes.into_iter().for_each(|(node, weight)| samples.push(vec![(node, 1.0)], weight));
        for (own, nodes) in between.into_iter().zip(nodes_of).filter(|(own, _)| !own.is_empty()) {
            let begin = samples.len();
            let sum = |(parts, _): &Sample| parts.iter().map(|(_, shape)| shape.abs()).sum::<f64>();
            let spread = own.iter().map(sum).fold(0.0, f64::max);
            own.into_iter().for_each(|(parts, weight)| samples.push(parts, weight));
            let nodes = nodes.iter().filter_map(|node| numbers.get(node).copied()).collect();
            samples.between.push(Between { samples: begin..samples.len(), nodes, spread });
        }
        Ok(samples)
    }

    /// How many are at nodes: the first ones.
    pub fn at_nodes(&self) -> usize {
        self.between.first().map_or(self.len(), |between| between.samples.start)
    }

    fn push(&mut self, parts: Vec<(u32, f64)>, weight: f64) {
        self.parts.extend(parts);
        self.first.push(self.parts.len());
        self.weights.push(weight);
    }

    /// Of every node of some surfaces the mean of a value of their samples, by the positive shares of the node; zero where a sample has none. (With
    /// the negative ones of centroids the shares of a corner of tri6 would add up to nothing.)
    pub fn nodal_means(surfaces: &[(&Samples, Vec<(usize, f64)>)]) -> Vec<(u32, f64)> {
        let mut sums: BTreeMap<u32, [f64; 2]> = BTreeMap::new();
        for (samples, values) in surfaces {
            let mut add = |sample: usize, which: usize, value: f64| {
                for &(node, shape) in samples.parts(sample) {
                    sums.entry(node).or_default()[which] += samples.weights[sample] * shape.max(0.0) * value;
                }
            };
            (0..samples.len()).for_each(|sample| add(sample, 0, 1.0));
            values.iter().for_each(|&(sample, value)| add(sample, 1, value));
        }
        sums.into_iter().map(|(node, [area, sum])| (node, if area > 0.0 { sum / area } else { 0.0 })).collect()
    }

    pub fn len(&self) -> usize {
        self.weights.len()
    }

    /// Nodes of a sample, each with the value of its shape function there.
    pub fn parts(&self, sample: usize) -> &[(u32, f64)] {
        &self.parts[self.first[sample]..self.first[sample + 1]]
    }

    /// `n . u` at a sample, a sum of weighted unknowns of a field of `dim` components.
    pub fn component(&self, sample: usize, n: &[f64; 3], dim: usize) -> Vec<(u32, f64)> {
        let of_node = |&(node, shape): &(u32, f64)| (0..dim).map(move |i| (dim as u32 * node + i as u32, shape * n[i]));
        self.parts(sample).iter().flat_map(of_node).collect()
    }

    /// The value at a sample of a flat nodal field of `dim` components.
    pub fn of(&self, sample: usize, dim: usize, field: impl Fn(usize) -> f64) -> Vec3 {
        let mut out = Vec3::zeros();
        for &(node, shape) in self.parts(sample) {
            (0..dim).for_each(|i| out[i] += shape * field(dim * node as usize + i));
        }
        out
    }
}

/// Where a node is.
pub(super) fn place(mesh: &Mesh, u: &[f64], node: u32) -> Vec3 {
    let (mut x, dim) = (Vec3::from(mesh.points()[node as usize]), mesh.dim());
    (0..dim).for_each(|i| x[i] += u[dim * node as usize + i]);
    x
}

/// Corners of the pieces of a facet, in its own coordinates: as many as its corner kind has.
pub(super) fn pieces(kind: CellKind, n: usize) -> Vec<Vec<[f64; 3]>> {
    let corners = &kind.reference_nodes()[..kind.corners()];
    let mix = |s: f64, t: f64| -> [f64; 3] {
        std::array::from_fn(|i| match corners.len() {
            2 => corners[0][i] + s * (corners[1][i] - corners[0][i]),
            3 => corners[0][i] + s * (corners[1][i] - corners[0][i]) + t * (corners[2][i] - corners[0][i]),
            _ => {
                let (low, high) =
                    ((1.0 - s) * corners[0][i] + s * corners[1][i], (1.0 - s) * corners[3][i] + s * corners[2][i]);
                (1.0 - t) * low + t * high
            }
        })
    };
    let at = |i: usize, j: usize| mix(i as f64 / n as f64, j as f64 / n as f64);
    match corners.len() {
        2 => (0..n).map(|i| vec![at(i, 0), at(i + 1, 0)]).collect(),
        3 => {
            let up = (0..n).flat_map(|j| (0..n - j).map(move |i| (i, j)));
            let down = (0..n).flat_map(|j| (1..(n - j).max(1)).map(move |i| (i, j)));
            let up = up.map(|(i, j)| vec![at(i, j), at(i + 1, j), at(i, j + 1)]);
            up.chain(down.map(|(i, j)| vec![at(i, j), at(i, j + 1), at(i - 1, j + 1)])).collect()
        }
        _ => {
            let all = (0..n).flat_map(|j| (0..n).map(move |i| (i, j)));
            all.map(|(i, j)| vec![at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]).collect()
        }
    }
}

/// Share of a piece's area at its centroid, where its nodes alone would not do.
fn at_centroid(kind: CellKind) -> f64 {
    match kind {
        CellKind::Tri6 => 9.0 / 20.0,
        CellKind::Quad8 => 16.0 / 36.0,
        _ => 0.0,
    }
}

/// The rule of a piece: its points in the coordinates of the facet, and weights by reference area.
pub(super) fn rule(kind: CellKind, positions: &[[f64; 3]], corners: &[[f64; 3]]) -> Vec<([f64; 3], f64)> {
    let corner_kind = kind.corner_kind();
    let mut of_corners = vec![0.0; corners.len()];
    let mut within = |xi: &[f64; 3]| -> [f64; 3] {
        corner_kind.shapes(xi, &mut of_corners);
        std::array::from_fn(|i| of_corners.iter().zip(corners).map(|(shape, corner)| shape * corner[i]).sum())
    };
    // the piece is of the same kind, at the positions of its own nodes
    let points: Vec<[f64; 3]> = kind.reference_nodes().iter().map(&mut within).collect();
    let centre = within(&kind.centre());
    let mut shapes = vec![0.0; positions.len()];
    let nodes: Vec<[f64; 3]> = points
        .iter()
        .map(|xi| {
            kind.shapes(xi, &mut shapes);
            std::array::from_fn(|i| shapes.iter().zip(positions).map(|(shape, x)| shape * x[i]).sum())
        })
        .collect();
    let area = |xi: &[f64; 3]| {
        let [along, across, _] = kind.tangents(&nodes, xi).map(Vec3::from);
        if kind.dim() == 1 { along.norm() } else { along.cross(&across).norm() }
    };
    let gauss = kind.rule_of_degree(3 * kind.order() * kind.dim());
    let mut weights = vec![0.0; nodes.len()];
    for (xi, weight) in gauss.points.iter().zip(&gauss.weights) {
        kind.shapes(xi, &mut shapes);
        let area = weight * area(xi);
        weights.iter_mut().zip(&shapes).for_each(|(sum, shape)| *sum += area * shape);
    }
    let inner = at_centroid(kind) * kind.reference_measure() * area(&kind.centre());
    kind.shapes(&kind.centre(), &mut shapes);
    weights.iter_mut().zip(&shapes).for_each(|(weight, shape)| *weight -= inner * shape);
    let mut all: Vec<_> = points.into_iter().zip(weights).collect();
    if inner > 0.0 {
        all.push((centre, inner));
    }
    all
}
