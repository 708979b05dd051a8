//! [`VolumeModes`]: the changes of volume that a nearly incompressible matrix resists.

use crate::error::NotCoupled;
use crate::pattern::matrix::SparseMatrix;
use rayon::prelude::*;

/// Modes or nodes of one task.
const ROWS_PER_TASK: usize = 2048;

/// The stiff part of a symmetric matrix, `sum_e c_e b_e b_e^T`: of a nearly incompressible body every `b_e` is the derivative of the mean volume of a
/// cell or patch of cells, and `c_e` its bulk modulus, less a share that stays with the rest. Any split will do that leaves a rest which is positive definite and
/// not stiff, since the sum is taken from the matrix and added again.
#[derive(Clone, Debug)]
pub struct VolumeModes {
    dim: usize,
    /// Where the entries of every group of modes with the same nodes begin: among the nodes, and among the modes.
    groups: Vec<[usize; 2]>,
    nodes: Vec<u32>,
    /// By mode: where its coefficients begin, `dim` per node of its group.
    starts: Vec<usize>,
    coefficients: Vec<f64>,
    /// By mode: where the nodes of its group begin and end.
    own: Vec<[u32; 2]>,
    /// By mode: c, and what is left of it in the rest of the matrix.
    stiffness: Vec<[f64; 2]>,
    /// By mode: the change `b_e . u` that a solution is expected to have; nothing where none is known.
    expected: Option<Vec<f64>>,
    /// By node: where its entries begin in `back`.
    back_starts: Vec<u32>,
    /// Mode and place of the coefficients of every entry, by nodes.
    back: Vec<(u32, u32)>,
}

impl VolumeModes {
    /// None, of nodes with `dim` unknowns each.
    pub fn none(dim: usize) -> Self {
        VolumeModes {
            dim,
            groups: vec![[0, 0]],
            nodes: Vec::new(),
            starts: vec![0],
            coefficients: Vec::new(),
            own: Vec::new(),
            stiffness: Vec::new(),
            expected: None,
            back_starts: Vec::new(),
            back: Vec::new(),
        }
    }

    /// Adds modes on the same distinct nodes, each with `dim` coefficients per node: their stiffness, and what is left of it in the rest of the matrix.
    pub fn push(&mut self, nodes: &[u32], modes: &[Vec<f64>], stiffness: [f64; 2]) {
        let first = self.nodes.len() as u32;
        self.nodes.extend_from_slice(nodes);
        for mode in modes {
            self.coefficients.extend_from_slice(mode);
            self.starts.push(self.coefficients.len());
            self.own.push([first, self.nodes.len() as u32]);
            self.stiffness.push(stiffness);
        }
        self.groups.push([self.nodes.len(), self.own.len()]);
    }

    /// The change by mode that the solution of the next step is expected to have, with which its pressures begin. Such a step may leave its pressures apart
    /// from those of its changes ([`changes_left`](crate::solver::Step::changes_left)).
    #[must_use]
    pub fn expecting(self, changes: Vec<f64>) -> Self {
        VolumeModes { expected: Some(changes), ..self }
    }

    /// Whether changes are expected.
    pub(crate) fn expects(&self) -> bool {
        self.expected.is_some()
    }

    /// The pressures that a system begins with.
    pub(crate) fn first_pressures(&self) -> Vec<f64> {
        let mut p = self.expected.clone().unwrap_or_default();
        p.resize(self.len(), 0.0);
        p.iter_mut().zip(&self.stiffness).for_each(|(p, [c, _])| *p *= c);
        p
    }

    /// `b_e . u - p_e / c_e`
    pub(crate) fn left(&self, u: &[f64], p: &[f64], parallel: bool) -> Vec<f64> {
        let mut left = vec![0.0; self.len()];
        self.of(u, &mut left, parallel);
        left.iter_mut().zip(p).zip(&self.stiffness).for_each(|((left, p), [c, _])| *left -= p / c);
        left
    }

    /// Ready for use, with nothing at unknowns that are `fixed`.
    #[must_use]
    pub fn supported(mut self, fixed: &[bool]) -> Self {
        let (dim, nodes) = (self.dim, fixed.len() / self.dim.max(1));
        let mut starts = vec![0u32; nodes + 1];
        for (mode, &[first, last]) in self.own.iter().enumerate() {
            let coefficients = self.coefficients[self.starts[mode]..self.starts[mode + 1]].chunks_exact_mut(dim);
            for (&node, own) in self.nodes[first as usize..last as usize].iter().zip(coefficients) {
                let fixed = &fixed[dim * node as usize..][..dim];
                own.iter_mut().zip(fixed).filter(|(_, fixed)| **fixed).for_each(|(own, _)| *own = 0.0);
                starts[node as usize + 1] += 1;
            }
        }
        (0..nodes).for_each(|node| starts[node + 1] += starts[node]);
        let mut next = starts.clone();
        self.back = vec![(0, 0); starts[nodes] as usize];
        for (mode, &[first, last]) in self.own.iter().enumerate() {
            for (k, &node) in self.nodes[first as usize..last as usize].iter().enumerate() {
                let at = &mut next[node as usize];
                self.back[*at as usize] = (mode as u32, (self.starts[mode] + dim * k) as u32);
                *at += 1;
            }
        }
        self.back_starts = starts;
        self
    }

    /// Memory, in bytes.
    pub fn bytes(&self) -> usize {
        let wide = size_of_val(&self.groups[..]) + size_of_val(&self.starts[..]) + size_of_val(&self.coefficients[..]);
        let narrow = size_of_val(&self.nodes[..]) + size_of_val(&self.own[..]) + size_of_val(&self.back_starts[..]);
        let expected = self.expected.as_ref().map_or(0, |expected| size_of_val(&expected[..]));
        wide + narrow + expected + size_of_val(&self.stiffness[..]) + size_of_val(&self.back[..])
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.own.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.own.is_empty()
    }

    /// By mode: its stiffness, and what is left of it in the rest of the matrix.
    pub fn stiffness(&self) -> &[[f64; 2]] {
        &self.stiffness
    }

    /// By mode: `|b_e|`.
    pub(crate) fn norms(&self) -> impl Iterator<Item = f64> {
        let of = |own: &[usize]| self.coefficients[own[0]..own[1]].iter().map(|b| b * b).sum::<f64>().sqrt();
        self.starts.windows(2).map(of)
    }

    /// `p_e = b_e . u`
    pub fn of(&self, u: &[f64], p: &mut [f64], parallel: bool) {
        let dim = self.dim;
        let of_mode = |mode: usize| {
            let [first, last] = self.own[mode].map(|at| at as usize);
            let coefficients = self.coefficients[self.starts[mode]..self.starts[mode + 1]].chunks_exact(dim);
            let of_node = |(&node, own): (&u32, &[f64])| {
                own.iter().zip(&u[dim * node as usize..][..dim]).map(|(b, u)| b * u).sum::<f64>()
            };
            self.nodes[first..last].iter().zip(coefficients).map(of_node).sum()
        };
        each(p, 1, parallel, |mode, p| p[0] = of_mode(mode));
    }

    /// `u += sum_e p_e b_e`
    pub fn add(&self, p: &[f64], u: &mut [f64], parallel: bool) {
        let dim = self.dim;
        each(u, dim, parallel, |node, u| {
            let [first, last] = [node, node + 1].map(|at| self.back_starts[at] as usize);
            for &(mode, at) in &self.back[first..last] {
                let (p, own) = (p[mode as usize], &self.coefficients[at as usize..][..dim]);
                u.iter_mut().zip(own).for_each(|(u, b)| *u += p * b);
            }
        });
    }

    /// The rest of a matrix that they are a part of.
    ///
    /// # Errors
    /// [`NotCoupled`] where the matrix has no room for one.
    pub fn rest(&self, matrix: &SparseMatrix) -> Result<SparseMatrix, NotCoupled> {
        let (mut rest, pattern) = (matrix.clone(), matrix.pattern());
        let mut element = Vec::new();
        for group in self.groups.windows(2) {
            let nodes = &self.nodes[group[0][0]..group[1][0]];
            let n = self.dim * nodes.len();
            element.clear();
            element.resize(n * n, 0.0);
            for mode in group[0][1]..group[1][1] {
                let b = &self.coefficients[self.starts[mode]..self.starts[mode + 1]];
                for (i, row) in element.chunks_exact_mut(n).enumerate() {
                    let factor = self.stiffness[mode][0] * b[i];
                    row.iter_mut().zip(b).for_each(|(entry, b)| *entry -= factor * b);
                }
            }
            pattern.scatter(&pattern.scatter_map(nodes)?, &element, &mut rest.values);
        }
        Ok(rest)
    }
}

/// Calls a function with the index of every part, and the part.
fn each(values: &mut [f64], size: usize, parallel: bool, set: impl Fn(usize, &mut [f64]) + Sync) {
    let chunk = |(k, chunk): (usize, &mut [f64])| {
        chunk.chunks_exact_mut(size).enumerate().for_each(|(at, part)| set(ROWS_PER_TASK * k + at, part));
    };
    if parallel && values.len() > ROWS_PER_TASK * size {
        values.par_chunks_mut(ROWS_PER_TASK * size).enumerate().for_each(chunk);
    } else {
        values.chunks_mut(ROWS_PER_TASK * size).enumerate().for_each(chunk);
    }
}
