//! Between points, Chebyshev coefficients and Chebyshev nodes of a box.
//!
//! Moments: m_k = sum_q w_q T_k(x_q). A grid of p nodes stands for the points with node weights
//! W_j = sum_{k<p} (2 - [k=0]) / p T_k(x_j) m_k, for sum_q w_q f(x_q) is then sum_j W_j f(x_j) up to interpolation.
//! The transpose takes values at nodes to coefficients, c_k = sum_j (2 - [k=0]) / p T_k(x_j) f_j. In three
//! directions these are products. Coefficients are stored with the last direction running fastest.
//!
//! Every grid has a wave, see `chebyshev`: points carry 2^(v.(x - c)), nodes the inverse.

use std::f64::consts::PI;

use super::aligned::Aligned;
use super::chebyshev::{DEGREE, Orders, Wave, nodes};
use super::frame::Frame;
use super::lanes::{Lanes, Machine, Task, WIDTH};
use super::tile::{Slab, coordinates, vectors};

/// Nodes and transform matrices for every number of nodes up to `DEGREE`.
#[derive(Debug)]
pub(super) struct Tables {
    /// matrices[p][j * p + k] = (2 - [k=0]) / p T_k(x_j)
    matrices: Vec<Vec<f64>>,
    /// nodes[p][j] = x_j
    nodes: Vec<Vec<f64>>,
}

impl Tables {
    pub fn new() -> Self {
        let angle = |p: usize, j: usize| PI * (2 * j + 1) as f64 / (2 * p) as f64;
        let entry = |p: usize, j: usize, k: usize| {
            let scale = if k == 0 { 1.0 } else { 2.0 };
            scale / p as f64 * (k as f64 * angle(p, j)).cos()
        };
        let matrix = |p: usize| (0..p * p).map(|jk| entry(p, jk / p, jk % p)).collect();
        let nodes = |p: usize| (0..p).map(|j| angle(p, j).cos()).collect();
        Self { matrices: (0..=DEGREE).map(matrix).collect(), nodes: (0..=DEGREE).map(nodes).collect() }
    }
}

/// Nodes of a grid on a box with the weights that stand for its points, as rows or (padded) as columns.
#[derive(Debug, Default)]
pub(super) struct Proxy {
    x: [Aligned; 3],
    pub weight: Aligned,
    /// 2^(-v.(x - c))
    tilt: Vec<f64>,
    values: Vec<f64>,
    scratch: [Vec<f64>; 2],
    count: usize,
}

impl Proxy {
    /// Puts the nodes of this grid in place, without weights.
    pub fn place(&mut self, tables: &Tables, frame: &Frame, wave: Wave, orders: Orders) {
        self.count = nodes(orders);
        let v = wave.vector(frame.half);
        // Per axis and node: the way from the centre, and the inverse wave.
        let mut steps = [[([0.0; 3], 1.0); DEGREE]; 3];
        for d in 0..3 {
            for (step, node) in steps[d].iter_mut().zip(&tables.nodes[orders[d] as usize]) {
                let u = frame.half[d] * node;
                *step = (frame.axes[d].map(|axis| u * axis), (-v[d] * u).exp2());
            }
        }
        let padded = self.count.next_multiple_of(WIDTH);
        let [x, y, z] = &mut self.x;
        let (x, y, z) = (x.reset(padded), y.reset(padded), z.reset(padded));
        self.tilt.clear();
        let [p0, p1, p2] = orders.map(usize::from);
        for (i, fi) in &steps[0][..p0] {
            for (j, fj) in &steps[1][..p1] {
                let ij: [f64; 3] = std::array::from_fn(|c| frame.centre[c] + i[c] + j[c]);
                for (k, fk) in &steps[2][..p2] {
                    let node = self.tilt.len();
                    (x[node], y[node], z[node]) = (ij[0] + k[0], ij[1] + k[1], ij[2] + k[2]);
                    self.tilt.push(fi * fj * fk);
                }
            }
        }
        for x in [x, y, z] {
            let last = x[self.count - 1];
            x[self.count..].fill(last);
        }
    }

    /// Node weights from the moments of the box, kept for a grid at least as fine.
    pub fn weigh(&mut self, tables: &Tables, orders: Orders, moments: &[f64], kept: Orders) {
        to_nodes(tables, orders, moments, kept, &mut self.values, &mut self.scratch);
        let weight = self.weight.reset(self.count.next_multiple_of(WIDTH));
        weight.iter_mut().zip(&self.values).zip(&self.tilt).for_each(|((w, value), tilt)| *w = value * tilt);
    }

    /// The factors of the inverse wave at the nodes.
    pub fn tilt(&self) -> &[f64] {
        &self.tilt
    }

    pub fn count(&self) -> usize {
        self.count
    }

    pub fn rows(&self) -> Slab<'_> {
        Slab { x: self.row_points(), weight: &self.weight[..self.count] }
    }

    /// The nodes alone.
    pub fn row_points(&self) -> [&[f64]; 3] {
        std::array::from_fn(|d| &self.x[d][..self.count])
    }

    pub fn columns(&self) -> Slab<'_> {
        Slab { x: std::array::from_fn(|d| &self.x[d][..]), weight: &self.weight }
    }
}

/// Node weights of the grid `orders` from moments of the grid `kept`.
pub(super) fn to_nodes(
    tables: &Tables,
    orders: Orders,
    moments: &[f64],
    kept: Orders,
    out: &mut Vec<f64>,
    scratch: &mut [Vec<f64>; 2],
) {
    let [p0, p1, p2] = orders.map(usize::from);
    let [_, k1, k2] = kept.map(usize::from);
    let [m0, m1, m2] = orders.map(|p| tables.matrices[p as usize].as_slice());
    let [last, middle] = scratch;
    // last[i, j, c] = sum_k m2[c, k] moments[i, j, k], then the middle and the first direction
    last.clear();
    for i in 0..p0 {
        for j in 0..p1 {
            let row = &moments[(i * k1 + j) * k2..][..p2];
            last.extend(m2.chunks_exact(p2).map(|m| dot(m, row)));
        }
    }
    middle.clear();
    middle.resize(p0 * p1 * p2, 0.0);
    for i in 0..p0 {
        multiply(m1, p1, &last[i * p1 * p2..][..p1 * p2], &mut middle[i * p1 * p2..][..p1 * p2]);
    }
    out.clear();
    out.resize(p0 * p1 * p2, 0.0);
    multiply(m0, p0, middle, out);
}

/// Adds the coefficients of values at the nodes of `orders` to those of the grid `kept`.
pub(super) fn add_from_nodes(
    tables: &Tables,
    orders: Orders,
    values: &[f64],
    kept: Orders,
    coefficients: &mut [f64],
    scratch: &mut [Vec<f64>; 2],
) {
    let [p0, p1, p2] = orders.map(usize::from);
    let [_, k1, k2] = kept.map(usize::from);
    let [m0, m1, m2] = orders.map(|p| tables.matrices[p as usize].as_slice());
    let [first, middle] = scratch;
    first.clear();
    first.resize(p0 * p1 * p2, 0.0);
    multiply_transposed(m0, p0, values, first);
    middle.clear();
    middle.resize(p0 * p1 * p2, 0.0);
    for i in 0..p0 {
        multiply_transposed(m1, p1, &first[i * p1 * p2..][..p1 * p2], &mut middle[i * p1 * p2..][..p1 * p2]);
    }
    for i in 0..p0 {
        for j in 0..p1 {
            let row = &middle[(i * p1 + j) * p2..][..p2];
            let target = &mut coefficients[(i * k1 + j) * k2..][..p2];
            multiply_transposed(m2, p2, row, target);
        }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// out[i, :] += sum_k matrix[i, k] values[k, :]
fn multiply(matrix: &[f64], p: usize, values: &[f64], out: &mut [f64]) {
    let n = values.len() / p;
    for (row, out) in matrix.chunks_exact(p).zip(out.chunks_exact_mut(n)) {
        for (m, values) in row.iter().zip(values.chunks_exact(n)) {
            out.iter_mut().zip(values).for_each(|(o, v)| *o += m * v);
        }
    }
}

/// out[k, :] += sum_i matrix[i, k] values[i, :]
fn multiply_transposed(matrix: &[f64], p: usize, values: &[f64], out: &mut [f64]) {
    let n = values.len() / p;
    for (row, values) in matrix.chunks_exact(p).zip(values.chunks_exact(n)) {
        for (m, out) in row.iter().zip(out.chunks_exact_mut(n)) {
            out.iter_mut().zip(values).for_each(|(o, v)| *o += m * v);
        }
    }
}

/// A box with the wave of a grid on it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Patch {
    frame: Frame,
    wave: [f64; 3],
    orders: Orders,
}

impl Patch {
    pub fn new(frame: &Frame, wave: Wave, orders: Orders) -> Self {
        Self { frame: *frame, wave: wave.vector(frame.half), orders }
    }
}

/// T_0 .. T_{DEGREE-1} of one vector of points along each axis, and the wave there.
#[inline(always)]
fn at_points<S: Lanes>(s: S, patch: &Patch, x: [S::f64s; 3]) -> ([[S::f64s; DEGREE]; 3], S::f64s) {
    let frame = &patch.frame;
    let mut t = [[s.splat_f64s(1.0); DEGREE]; 3];
    let mut exponent = s.splat_f64s(0.0);
    let x0 = s.sub_f64s(x[0], s.splat_f64s(frame.centre[0]));
    let x1 = s.sub_f64s(x[1], s.splat_f64s(frame.centre[1]));
    let x2 = s.sub_f64s(x[2], s.splat_f64s(frame.centre[2]));
    for d in 0..3 {
        let axis = frame.axes[d];
        let along = s.mul_f64s(x0, s.splat_f64s(axis[0]));
        let along = s.mul_add_e_f64s(x1, s.splat_f64s(axis[1]), along);
        let along = s.mul_add_e_f64s(x2, s.splat_f64s(axis[2]), along);
        exponent = s.mul_add_e_f64s(along, s.splat_f64s(patch.wave[d]), exponent);
        let inverse = if frame.half[d] > 0.0 { 1.0 / frame.half[d] } else { 0.0 };
        let u = s.mul_f64s(along, s.splat_f64s(inverse));
        let twice = s.add_f64s(u, u);
        t[d][1] = u;
        for k in 2..patch.orders[d] as usize {
            t[d][k] = s.sub_f64s(s.mul_f64s(twice, t[d][k - 1]), t[d][k - 2]);
        }
    }
    (t, s.exp2(exponent))
}

/// Moments of weighted points (padded): sum_q w_q 2^(v.(x_q - c)) T_k(x_q).
pub(super) fn moments(machine: Machine, points: Slab, patch: Patch) -> Vec<f64> {
    machine.run(Moments { points, patch })
}

struct Moments<'a> {
    points: Slab<'a>,
    patch: Patch,
}

impl Task for Moments<'_> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn run<S: Lanes>(self, s: S) -> Vec<f64> {
        let n = self.points.weight.len() / S::F64_LANES;
        let x = coordinates::<S>(&self.points, n);
        let weights = vectors::<S>(self.points.weight, n);
        let [p0, p1, p2] =
            [self.patch.orders[0] as usize, self.patch.orders[1] as usize, self.patch.orders[2] as usize];
        let mut sums = vec![s.splat_f64s(0.0); p0 * p1 * p2];
        for q in 0..n {
            let (t, wave) = at_points(s, &self.patch, [x[0][q], x[1][q], x[2][q]]);
            let weight = s.mul_f64s(weights[q], wave);
            for i in 0..p0 {
                let wi = s.mul_f64s(weight, t[0][i]);
                for j in 0..p1 {
                    let wij = s.mul_f64s(wi, t[1][j]);
                    for (sum, &t) in sums[(i * p1 + j) * p2..][..p2].iter_mut().zip(&t[2][..p2]) {
                        *sum = s.mul_add_e_f64s(wij, t, *sum);
                    }
                }
            }
        }
        let mut moments = Vec::with_capacity(sums.len());
        for sum in sums {
            moments.push(s.reduce_sum_f64s(sum));
        }
        moments
    }
}

/// For every field: out_q += 2^(v.(x_q - c)) sum_k c_k T_k(x_q) at points (padded). Fields follow each other in both
/// `coefficients` and `out`.
pub(super) fn expand(machine: Machine, points: Slab, patch: Patch, coefficients: &[f64], out: &mut [f64]) {
    machine.run(Expand { points, patch, coefficients, out });
}

struct Expand<'a> {
    points: Slab<'a>,
    patch: Patch,
    coefficients: &'a [f64],
    out: &'a mut [f64],
}

impl Task for Expand<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Lanes>(self, s: S) {
        let n = self.points.weight.len() / S::F64_LANES;
        let x = coordinates::<S>(&self.points, n);
        let [p0, p1, p2] =
            [self.patch.orders[0] as usize, self.patch.orders[1] as usize, self.patch.orders[2] as usize];
        let fields = self.coefficients.len() / (p0 * p1 * p2);
        let out = S::as_mut_simd_f64s(self.out).0;
        for q in 0..n {
            let (t, wave) = at_points(s, &self.patch, [x[0][q], x[1][q], x[2][q]]);
            for field in 0..fields {
                let coefficients = &self.coefficients[field * p0 * p1 * p2..][..p0 * p1 * p2];
                let mut over_i = s.splat_f64s(0.0);
                for i in 0..p0 {
                    let mut over_j = s.splat_f64s(0.0);
                    for j in 0..p1 {
                        let mut over_k = s.splat_f64s(0.0);
                        for (&c, &t) in coefficients[(i * p1 + j) * p2..][..p2].iter().zip(&t[2][..p2]) {
                            over_k = s.mul_add_e_f64s(s.splat_f64s(c), t, over_k);
                        }
                        over_j = s.mul_add_e_f64s(over_k, t[1][j], over_j);
                    }
                    over_i = s.mul_add_e_f64s(over_j, t[0][i], over_i);
                }
                out[field * n + q] = s.mul_add_e_f64s(over_i, wave, out[field * n + q]);
            }
        }
    }
}
