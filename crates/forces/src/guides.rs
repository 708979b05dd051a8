//! [`Guides`]: the length of a polyline through points of the body or of space, and its derivatives: of tendons and springs.

use nastic_body::contribution::Sums;
use nastic_body::contribution::body_point::AttachedPoint;
use nastic_body::error::MeetingGuides;
use nastic_linear::{NotCoupled, SparseMatrix};
use nastic_tensor::{Mat3, Vec3};

/// Distance below which two points coincide, as a share of the body's diagonal.
pub(crate) const COINCIDENCE_TOLERANCE: f64 = 1e-9;

/// Distance of neighbouring guides, as a share of their reference distance, below which they meet.
const MIN_DISTANCE_SHARE: f64 = 1e-2;

/// Points x_i of the body or of space, in the order in which the line passes them: `L = sum_j l_j`, `l_j = |d_j|`, `d_j = x_(j+1) - x_j`.
///
/// With the unit vectors `n_j = d_j / l_j` and `P_j = 1 - n_j (x) n_j`, along changes a, b, c of d_j:
///
/// ```text
/// l'[a]       = n . a
/// l''[a,b]    = a . P b / l
/// l'''[a,b,c] = -((n.c) (a . P b) + (n.a) (b . P c) + (n.b) (a . P c)) / l^2
/// ```
#[derive(Debug)]
pub(crate) struct Guides {
    dim: usize,
    points: Vec<AttachedPoint>,
}

/// The line through [`Guides`] at one displacement.
pub(crate) struct Line<'a> {
    guides: &'a Guides,
    /// Number of unknowns.
    unknowns: usize,
    pub segments: Vec<Segment<'a>>,
}

/// A straight piece of the line.
pub(crate) struct Segment<'a> {
    dim: usize,
    ends: [&'a AttachedPoint; 2],
    pub length: f64,
    /// Unit vector from its first to its second end; zero where both coincide.
    pub direction: Vec3,
}

impl Guides {
    pub fn new(dim: usize, points: Vec<AttachedPoint>) -> Self {
        Guides { dim, points }
    }

    /// Positions in the displaced body.
    pub fn positions(&self, u: &[f64]) -> Vec<[f64; 3]> {
        self.points.iter().map(|point| (point.reference + point.of(u, self.dim)).into()).collect()
    }

    /// The length in the reference body.
    pub fn reference_length(&self) -> f64 {
        self.points.windows(2).map(|pair| (pair[1].reference - pair[0].reference).norm()).sum()
    }

    /// The line in the displaced body.
    pub fn at(&self, u: &[f64]) -> Line<'_> {
        let position = |point: &AttachedPoint| point.reference + point.of(u, self.dim);
        let segments = self.points.windows(2).map(|pair| {
            let along = position(&pair[1]) - position(&pair[0]);
            let length = along.norm();
            let direction = if length > 0.0 { along / length } else { Vec3::zeros() };
            Segment { dim: self.dim, ends: [&pair[0], &pair[1]], length, direction }
        });
        Line { guides: self, unknowns: u.len(), segments: segments.collect() }
    }

    /// The two neighbours that are nearest to each other, measured by their reference distance, where less than [`MIN_DISTANCE_SHARE`] of that is left.
    pub fn meeting(&self, name: &str, u: &[f64]) -> Option<MeetingGuides> {
        let line = self.at(u);
        let pairs = self.points.windows(2).zip(&line.segments).map(|(pair, segment)| {
            let [a, b] = [pair[0].reference, pair[1].reference];
            ([a.into(), b.into()], segment.length / (b - a).norm())
        });
        let nearest = pairs.min_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, share)| *share < MIN_DISTANCE_SHARE);
        nearest.map(|(places, share)| MeetingGuides { name: name.to_owned(), places, share, limit: None })
    }

    /// The nodes of all points, ascending, each once.
    pub fn nodes(&self) -> Vec<u32> {
        union(self.points.iter())
    }

    /// The nodes of every two neighbouring points.
    pub fn neighbours(&self) -> Vec<Vec<u32>> {
        self.points.windows(2).map(|pair| union(pair.iter())).collect()
    }
}

impl Line<'_> {
    pub fn length(&self) -> f64 {
        self.segments.iter().map(|segment| segment.length).sum()
    }

    /// The longest step along v that lets no point pass the next one, where the direction jumps.
    pub fn max_step(&self, v: &[f64]) -> f64 {
        self.segments.iter().map(|segment| segment.max_step(v)).fold(1.0, f64::min)
    }

    /// Adds the force `N dL/du`, and its absolute values, to sums.
    pub fn add_force(&self, tension: f64, sums: &mut Sums) {
        for segment in &self.segments {
            segment.each_end(tension * segment.direction, |dof, force| {
                sums.force[dof] += force;
                sums.force_scale[dof] += force.abs();
            });
        }
    }

    /// `dL/du`, flat.
    pub fn gradient(&self) -> Vec<f64> {
        let mut out = vec![0.0; self.unknowns];
        self.segments.iter().for_each(|segment| segment.each_end(segment.direction, |dof, value| out[dof] += value));
        out
    }

    /// `dL/du . v`.
    pub fn slope(&self, v: &[f64]) -> f64 {
        self.segments.iter().map(|segment| segment.direction.dot(&segment.change(v))).sum()
    }

    /// Adds `factor d2L/du2 v`.
    pub fn add_curvature_product(&self, factor: f64, v: &[f64], out: &mut [f64]) {
        for segment in &self.segments {
            let change = segment.turned(&segment.change(v)) * factor;
            segment.each_end(change, |dof, value| out[dof] += value);
        }
    }

    /// Adds `factor d3L/du3[a, b]`.
    pub fn add_third_product(&self, factor: f64, [a, b]: [&[f64]; 2], out: &mut [f64]) {
        for segment in self.segments.iter().filter(|segment| segment.length > 0.0) {
            let (a, b) = (segment.change(a), segment.change(b));
            let (pa, pb, n) = (segment.turned(&a), segment.turned(&b), segment.direction);
            let third = -(a.dot(&pb) * n + n.dot(&a) * pb + n.dot(&b) * pa) / segment.length;
            segment.each_end(factor * third, |dof, value| out[dof] += value);
        }
    }

    /// Adds `factor d2L/du2`.
    pub fn add_curvature(&self, factor: f64, tangent: &mut SparseMatrix) -> Result<(), NotCoupled> {
        for segment in self.segments.iter().filter(|segment| segment.length > 0.0) {
            let n = segment.direction;
            segment.add_block(&(factor / segment.length * (Mat3::identity() - n * n.transpose())), tangent)?;
        }
        Ok(())
    }

    /// Adds `factor dL/du (x) dL/du`, which couples all points.
    pub fn add_gradient_product(&self, factor: f64, tangent: &mut SparseMatrix) -> Result<(), NotCoupled> {
        let (nodes, gradient) = (self.guides.nodes(), self.gradient());
        let component = |a: usize, i: usize| gradient[self.guides.dim * nodes[a] as usize + i];
        add_element(&nodes, self.guides.dim, tangent, |a, i, b, j| factor * component(a, i) * component(b, j))
    }
}

impl Segment<'_> {
    /// The change of `d` along that of the displacement.
    pub fn change(&self, v: &[f64]) -> Vec3 {
        self.ends[1].of(v, self.dim) - self.ends[0].of(v, self.dim)
    }

    /// `P a / l`: the change of the unit vector along a; zero where both ends coincide.
    fn turned(&self, a: &Vec3) -> Vec3 {
        if self.length > 0.0 { (a - self.direction * self.direction.dot(a)) / self.length } else { Vec3::zeros() }
    }

    /// Adds a second derivative by d.
    pub fn add_block(&self, block: &Mat3, tangent: &mut SparseMatrix) -> Result<(), NotCoupled> {
        let nodes = union(self.ends.into_iter());
        let weights = signed_weights(&nodes, self.ends);
        add_element(&nodes, self.dim, tangent, |a, i, b, j| weights[a] * weights[b] * block[(i, j)])
    }

    /// Calls with every unknown of both ends and its share of `d -> by_change . d`.
    pub fn each_end(&self, by_change: Vec3, mut call: impl FnMut(usize, f64)) {
        self.ends[0].each(self.dim, |dof, w, i| call(dof, -w * by_change[i]));
        self.ends[1].each(self.dim, |dof, w, i| call(dof, w * by_change[i]));
    }

    /// The longest step along v that keeps its ends apart by a tenth of their distance.
    fn max_step(&self, v: &[f64]) -> f64 {
        const MIN_DISTANCE_RATIO: f64 = 0.1;
        let (along, change) = (self.length * self.direction, self.change(v));
        let squared = change.norm_squared();
        let closest = if squared > 0.0 { (-along.dot(&change) / squared).clamp(0.0, 1.0) } else { 0.0 };
        let passes = (along + closest * change).norm() < MIN_DISTANCE_RATIO * self.length;
        if passes { (1.0 - MIN_DISTANCE_RATIO) * closest } else { 1.0 }
    }
}

fn union<'a>(points: impl Iterator<Item = &'a AttachedPoint>) -> Vec<u32> {
    let mut nodes: Vec<u32> = points.flat_map(AttachedPoint::nodes).collect();
    nodes.sort_unstable();
    nodes.dedup();
    nodes
}

/// The weight of every node in `d = x_1 - x_0`.
fn signed_weights(nodes: &[u32], ends: [&AttachedPoint; 2]) -> Vec<f64> {
    let of = |node: u32, end: &AttachedPoint| -> f64 {
        end.weights.iter().filter(|(own, _)| *own == node).map(|(_, w)| w).sum()
    };
    nodes.iter().map(|&node| of(node, ends[1]) - of(node, ends[0])).collect()
}

/// Adds a matrix over the components of some nodes, by local node and component.
pub(crate) fn add_element(
    nodes: &[u32],
    dim: usize,
    tangent: &mut SparseMatrix,
    entry: impl Fn(usize, usize, usize, usize) -> f64,
) -> Result<(), NotCoupled> {
    tangent.add_pairs(nodes, &element(nodes, dim, entry))
}

/// The element matrix of a function of local node, component, local node and component.
pub(crate) fn element(nodes: &[u32], dim: usize, entry: impl Fn(usize, usize, usize, usize) -> f64) -> Vec<f64> {
    let n = dim * nodes.len();
    let of = |at: usize| {
        let (row, column) = (at / n, at % n);
        entry(row / dim, row % dim, column / dim, column % dim)
    };
    (0..n * n).map(of).collect()
}
