//! [`Grid`]: a regular grid over a box, with multilinear basis functions: a control mesh of its own.

use crate::error::ControlError;

/// A corner of a grid cell as a point sees it: number of the grid node, basis function, its gradient.
pub(crate) type Corner = (u32, f64, [f64; 3]);

/// Least distance of a point from a face of its grid cell, as a share of the cell: a point on a plane of the grid belongs to the cell above.
const FACE_TOLERANCE: f64 = 1e-12;

/// Share by which a cell of the body may exceed a cell of the grid: rounding.
const SIZE_TOLERANCE: f64 = 1e-9;

/// A box divided into `cells` of equal size along each axis; node `(i, j, k)` has number `i + (n_x + 1) (j + (n_y + 1) k)`.
///
/// The basis function of a node is the product over the axes of `max(0, 1 - |x_k - node_k| / h_k)`: not negative, and their sum is one
/// in the box. An axis along which the box has no extent (the third of a plane body) has one layer of nodes and no derivative.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    lowest: [f64; 3],
    /// Edge lengths of a cell; 0 along an axis without extent.
    edges: [f64; 3],
    cells: [u32; 3],
}

impl Grid {
    /// Over the bounding box of points.
    ///
    /// # Errors
    /// No cells along an axis, or more nodes than numbers of 32 bits.
    pub fn over(points: impl IntoIterator<Item = [f64; 3]>, cells: [u32; 3]) -> Result<Self, ControlError> {
        let (mut lowest, mut highest) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for x in points {
            lowest = [0, 1, 2].map(|k| x[k].min(lowest[k]));
            highest = [0, 1, 2].map(|k| x[k].max(highest[k]));
        }
        let nodes = cells.iter().try_fold(1u32, |n, cells| n.checked_mul(cells.checked_add(1)?));
        if cells.contains(&0) || nodes.is_none() {
            return Err(ControlError::Grid { cells });
        }
        let edge = |k: usize| if highest[k] > lowest[k] { (highest[k] - lowest[k]) / f64::from(cells[k]) } else { 0.0 };
        Ok(Grid { lowest, edges: [0, 1, 2].map(edge), cells })
    }

    /// Number of cells along each axis.
    pub fn cells(&self) -> [u32; 3] {
        self.cells
    }

    /// The most cells along each axis, over the same box, none of which is smaller than the lengths given (to rounding).
    pub(crate) fn most_cells(&self, least: [f64; 3]) -> [u32; 3] {
        [0, 1, 2].map(|k| {
            let room = self.edges[k] * f64::from(self.cells[k]) * (1.0 + SIZE_TOLERANCE);
            // An axis without extent, or cells without extent along it, ask for nothing.
            if room > 0.0 && least[k] > 0.0 { (room / least[k]).floor().max(1.0) as u32 } else { self.cells[k] }
        })
    }

    /// Where a node lies.
    pub fn node(&self, number: u32) -> [f64; 3] {
        let (x, y) = (self.cells[0] + 1, self.cells[1] + 1);
        let at = [number % x, number / x % y, number / (x * y)];
        [0, 1, 2].map(|k| self.lowest[k] + f64::from(at[k]) * self.edges[k])
    }

    /// The corners of the cell that holds a point, which is moved into the box if it lies outside. Basis functions are positive, if
    /// only by rounding.
    pub(crate) fn corners(&self, x: [f64; 3]) -> Vec<Corner> {
        let mut corners: Vec<Corner> = vec![(0, 1.0, [0.0; 3])];
        let mut stride = 1;
        for k in 0..3 {
            if self.edges[k] > 0.0 {
                let t = ((x[k] - self.lowest[k]) / self.edges[k]).clamp(0.0, f64::from(self.cells[k]));
                // To the cell above where rounding keeps the point just below a plane; the last plane belongs to the last cell.
                let cell = (t + FACE_TOLERANCE).floor().min(f64::from(self.cells[k] - 1));
                let t = (t - cell).clamp(FACE_TOLERANCE, 1.0 - FACE_TOLERANCE);
                let slope = 1.0 / self.edges[k];
                let ends = [(0, 1.0 - t, -slope), (1, t, slope)];
                let with = |(end, shape, slope): (u32, f64, f64)| {
                    corners.iter().map(move |&(node, value, gradient)| {
                        let mut gradient = gradient.map(|g| g * shape);
                        gradient[k] = value * slope;
                        (node + (cell as u32 + end) * stride, value * shape, gradient)
                    })
                };
                corners = ends.into_iter().flat_map(with).collect();
            }
            stride *= self.cells[k] + 1;
        }
        corners
    }
}
