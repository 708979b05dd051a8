//! [`GridSpline`]: cubic splines through values on a regular grid.

/// Values and derivatives of the B-splines of an interval: by order, by coefficient.
type Basis = [[f64; 4]; 4];

/// `s(x) = sum_ijk c_ijk B(x/h - i) B(y/h - j) B(z/h - k)`, B the cubic B-spline, with coefficients for which s is the given value at every node of a
/// regular grid, and `d2s/dx2 = 0` at its ends along each axis: two times continuously differentiable. In the plane without the third factor.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct GridSpline {
    low: [f64; 3],
    spacing: f64,
    /// Nodes along each axis; one along the third in the plane.
    nodes: [usize; 3],
    /// First along x, one more at either end than there are nodes.
    coefficients: Vec<f64>,
}

/// Derivatives by how often each coordinate is taken, three in all at most.
pub(super) type Partials = [[[f64; 4]; 4]; 4];

/// Coefficients along an axis of nodes.
fn extent(nodes: usize) -> usize {
    if nodes == 1 { 1 } else { nodes + 2 }
}

impl GridSpline {
    /// Through values at all nodes, first along x; along an axis there are one node or two at least.
    pub fn through(low: [f64; 3], spacing: f64, nodes: [usize; 3], values: &[f64]) -> Self {
        let [nx, ny, nz] = nodes.map(extent);
        let ghosts = nodes.map(|n| usize::from(n > 1));
        let mut coefficients = vec![0.0; nx * ny * nz];
        for (row, of_row) in values.chunks(nodes[0]).enumerate() {
            let (j, k) = (row % nodes[1] + ghosts[1], row / nodes[1] + ghosts[2]);
            let first = (k * ny + j) * nx + ghosts[0];
            coefficients[first..first + nodes[0]].copy_from_slice(of_row);
        }
        let (mut line, mut work) = (Vec::new(), Vec::new());
        for (axis, (stride, count)) in [(1, nx), (nx, ny), (nx * ny, nz)].into_iter().enumerate() {
            if nodes[axis] == 1 {
                continue;
            }
            for first in (0..coefficients.len()).filter(|at| (at / stride) % count == 0) {
                line.clear();
                line.extend((0..count).map(|i| coefficients[first + i * stride]));
                filter(&mut line, &mut work);
                line.iter().enumerate().for_each(|(i, c)| coefficients[first + i * stride] = *c);
            }
        }
        GridSpline { low, spacing, nodes, coefficients }
    }

    /// Numbers that it stores for a grid, by the nodes along each axis.
    pub fn numbers(nodes: [f64; 3]) -> f64 {
        nodes.iter().map(|n| if *n > 1.0 { n + 2.0 } else { 1.0 }).product()
    }

    pub fn spacing(&self) -> f64 {
        self.spacing
    }

    pub fn nodes(&self) -> [usize; 3] {
        self.nodes
    }

    /// The value at a place; `None` outside of the grid.
    pub fn value(&self, x: &[f64; 3]) -> Option<f64> {
        let (first, t) = self.cell(x)?;
        let [bx, by, bz] = self.bases(t).map(|basis| basis[0]);
        let mut sum = 0.0;
        for (k, wz) in bz.iter().enumerate().take(self.reach(2)) {
            for (j, wy) in by.iter().enumerate().take(self.reach(1)) {
                let row = self.row(first, j, k);
                sum += wz * wy * row.iter().zip(&bx).map(|(c, w)| c * w).sum::<f64>();
            }
        }
        Some(sum)
    }

    /// All derivatives to the third order at a place; `None` outside of the grid.
    pub fn partials(&self, x: &[f64; 3]) -> Option<Partials> {
        let (first, t) = self.cell(x)?;
        let [bx, by, bz] = self.bases(t);
        let mut out = [[[0.0; 4]; 4]; 4];
        for k in 0..self.reach(2) {
            let mut plane = [[0.0; 4]; 4];
            for j in 0..self.reach(1) {
                let row = self.row(first, j, k);
                for a in 0..4 {
                    let along: f64 = row.iter().zip(&bx[a]).map(|(c, w)| c * w).sum();
                    (0..4 - a).for_each(|b| plane[a][b] += along * by[b][j]);
                }
            }
            for a in 0..4 {
                for b in 0..4 - a {
                    (0..4 - a - b).for_each(|c| out[a][b][c] += plane[a][b] * bz[c][k]);
                }
            }
        }
        Some(out)
    }

    /// A bound of `|grad s|` on the whole grid: within a cell the gradient is a mean of the vectors of its Bezier net.
    pub fn steepest(&self) -> f64 {
        let cells = self.nodes.map(|n| n.max(2) - 1);
        let mut steepest = 0.0_f64;
        for first in (0..cells[2]).flat_map(|k| (0..cells[1]).flat_map(move |j| (0..cells[0]).map(move |i| [i, j, k])))
        {
            steepest = steepest.max(self.steepest_in(first));
        }
        steepest / self.spacing
    }

    /// Times the spacing.
    fn steepest_in(&self, first: [usize; 3]) -> f64 {
        let mut net = [0.0; 64];
        for (row, of_row) in net.chunks_exact_mut(4).enumerate() {
            let (j, k) = (row % 4, row / 4);
            if j < self.reach(1) && k < self.reach(2) {
                of_row.copy_from_slice(self.row(first, j, k));
            }
        }
        let axes = if self.nodes[2] > 1 { 3 } else { 2 };
        (0..axes).for_each(|axis| along(&mut net, axis, bezier));
        let mut squares = [0.0; 64];
        for axis in 0..axes {
            let mut slopes = net;
            along(&mut slopes, axis, slope);
            squares.iter_mut().zip(&slopes).for_each(|(sum, slope)| *sum += slope * slope);
        }
        squares.iter().fold(0.0, |most: f64, square| most.max(*square)).sqrt()
    }

    /// A bound from below of s on the boundary of the grid: there s is a mean of the coefficients next to it.
    pub fn least_on_boundary(&self) -> f64 {
        let sizes = self.nodes.map(extent);
        let is_next = |at: usize| {
            let index = [at % sizes[0], at / sizes[0] % sizes[1], at / (sizes[0] * sizes[1])];
            (0..3).any(|i| self.nodes[i] > 1 && (index[i] < 3 || index[i] + 3 >= sizes[i]))
        };
        let next = self.coefficients.iter().enumerate().filter(|(at, _)| is_next(*at));
        next.map(|(_, c)| *c).fold(f64::INFINITY, f64::min)
    }

    /// The point of the grid's box that is nearest.
    pub fn clamped(&self, x: &[f64; 3]) -> [f64; 3] {
        std::array::from_fn(|i| match self.nodes[i] {
            1 => x[i],
            n => x[i].max(self.low[i]).min(self.low[i] + self.spacing * (n - 1) as f64),
        })
    }

    /// The first coefficient of the interval that a point is in, along each axis, and the place within.
    fn cell(&self, x: &[f64; 3]) -> Option<([usize; 3], [f64; 3])> {
        let (mut first, mut within) = ([0; 3], [0.0; 3]);
        for i in (0..3).filter(|i| self.nodes[*i] > 1) {
            let (place, last) = ((x[i] - self.low[i]) / self.spacing, self.nodes[i] - 1);
            if !(place >= 0.0 && place <= last as f64) {
                return None;
            }
            first[i] = (place as usize).min(last - 1);
            within[i] = place - first[i] as f64;
        }
        Some((first, within))
    }

    /// Coefficients that act in an interval along an axis.
    fn reach(&self, axis: usize) -> usize {
        if self.nodes[axis] > 1 { 4 } else { 1 }
    }

    fn row(&self, [i, j, k]: [usize; 3], dj: usize, dk: usize) -> &[f64] {
        let [nx, ny, _] = self.nodes.map(extent);
        let first = ((k + dk) * ny + j + dj) * nx + i;
        &self.coefficients[first..first + self.reach(0)]
    }

    fn bases(&self, t: [f64; 3]) -> [Basis; 3] {
        std::array::from_fn(|axis| match self.nodes[axis] {
            1 => [[1.0, 0.0, 0.0, 0.0], [0.0; 4], [0.0; 4], [0.0; 4]],
            _ => basis(t[axis], self.spacing),
        })
    }
}

fn basis(t: f64, h: f64) -> Basis {
    let (u, h2) = (1.0 - t, h * h);
    let [t2, u2] = [t * t, u * u];
    [
        [u * u2 / 6.0, (3.0 * t * t2 - 6.0 * t2 + 4.0) / 6.0, (3.0 * u * u2 - 6.0 * u2 + 4.0) / 6.0, t * t2 / 6.0],
        [-u2 / 2.0, (3.0 * t2 - 4.0 * t) / 2.0, (4.0 * u - 3.0 * u2) / 2.0, t2 / 2.0].map(|b| b / h),
        [u, 3.0 * t - 2.0, 3.0 * u - 2.0, t].map(|b| b / h2),
        [-1.0, 3.0, -3.0, 1.0].map(|b| b / (h2 * h)),
    ]
}

/// Replaces all lines of a net of 4 x 4 x 4 along an axis.
fn along(net: &mut [f64; 64], axis: usize, change: fn([f64; 4]) -> [f64; 4]) {
    let stride = [1, 4, 16][axis];
    for first in (0..64).filter(|at| at / stride % 4 == 0) {
        let line = change(std::array::from_fn(|i| net[first + i * stride]));
        line.into_iter().enumerate().for_each(|(i, c)| net[first + i * stride] = c);
    }
}

/// Coefficients of an interval in Bernstein polynomials, by those in B-splines.
fn bezier([a, b, c, d]: [f64; 4]) -> [f64; 4] {
    [(a + 4.0 * b + c) / 6.0, (2.0 * b + c) / 3.0, (b + 2.0 * c) / 3.0, (b + 4.0 * c + d) / 6.0]
}

/// Those of the derivative, as of a cubic polynomial too.
fn slope([a, b, c, d]: [f64; 4]) -> [f64; 4] {
    [3.0 * (b - a), 2.0 * c - b - a, d + c - 2.0 * b, 3.0 * (d - c)]
}

/// Values between two free places become coefficients: `(c_{i-1} + 4 c_i + c_{i+1})/6 = f_i`, `c_{-1} - 2 c_0 + c_1 = 0` at either end.
fn filter(line: &mut [f64], work: &mut Vec<f64>) {
    let last = line.len() - 2;
    // the ends are their values; in between by elimination
    work.clear();
    work.resize(line.len(), 0.0);
    for i in 2..last {
        let pivot = 1.0 / (4.0 - work[i - 1]);
        work[i] = pivot;
        line[i] = (6.0 * line[i] - line[i - 1]) * pivot;
    }
    for i in (2..last).rev() {
        line[i] -= work[i] * line[i + 1];
    }
    line[0] = 2.0 * line[1] - line[2];
    line[last + 1] = 2.0 * line[last] - line[last - 1];
}
