//! What fields that are interpolated between nodes have: values on a grid, gradients.

use super::{Basis, Space};
use crate::grid::{Corner, Grid};
use nastic_fem::Discretization;

impl Basis {
    /// The corners of the grid cell that holds a place of the body: unknown, basis function, gradient. Empty without a grid; corners that
    /// have no unknown are left out.
    pub(crate) fn grid_corners(&self, x: [f64; 3]) -> Vec<Corner> {
        let corners = self.grid().map_or_else(Vec::new, |grid| grid.corners(x));
        let unknown = |node: u32| self.entities().binary_search(&node).ok().map(|i| i as u32);
        corners.into_iter().filter_map(|(node, shape, slope)| Some((unknown(node)?, shape, slope))).collect()
    }

    /// The most cells along each axis of a grid that the quadrature points of the body resolve: none smaller than the largest of the cells
    /// that the control acts on. In smaller ones there are too few points to see the gradient of the field, and the total variation and
    /// the inner products with gradients come out too small. `None` without a grid, or where this one is resolved.
    pub fn resolved_grid(&self, disc: &Discretization) -> Option<[u32; 3]> {
        let (grid, mesh) = (self.grid().filter(|_| !self.is_of_contribution())?, disc.mesh());
        let mut largest = [0.0f64; 3];
        for (id, (first, _)) in disc.points_of_cells().into_iter().enumerate() {
            if !self.acts_at(first) {
                continue;
            }
            let nodes = mesh.gather(mesh.points(), mesh.cell(id).nodes);
            for (k, largest) in largest.iter_mut().enumerate() {
                let along = nodes.iter().map(|x| x[k]);
                let (low, high) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
                *largest = largest.max(high - low);
            }
        }
        let most = grid.most_cells(largest);
        grid.cells().iter().zip(most).any(|(cells, most)| *cells > most).then_some(most)
    }

    /// A field of `components` components of this grid at a place, interpolated between the nodes that have unknowns; `None` where no
    /// grid is, or none of the nodes around the place has one.
    pub fn on_grid(&self, m: &[f64], components: usize, x: [f64; 3]) -> Option<Vec<f64>> {
        let mut corners = self.grid_corners(x);
        // Only rounding gives a node a share as small as that.
        corners.retain(|(_, shape, _)| *shape > 1e-9);
        let total: f64 = corners.iter().map(|(_, shape, _)| shape).sum();
        let value =
            |c: usize| corners.iter().map(|(i, shape, _)| shape / total * m[*i as usize * components + c]).sum();
        (total > 0.0).then(|| (0..components).map(value).collect())
    }

    /// The basis functions of a field that is interpolated between nodes, with their gradients, at every quadrature point; none where it does
    /// not act, and none of other spaces.
    pub(crate) fn gradients(&self, disc: &Discretization) -> Vec<Vec<Corner>> {
        let acts = |q: usize| self.acts_at(q);
        let mut out = vec![vec![]; self.points()];
        if self.grid().is_some() {
            let positions = match &self.own {
                Some((positions, _)) => positions.clone(),
                None => disc.points().positions(disc.mesh(), None),
            };
            let positions = positions.into_iter().enumerate();
            positions.filter(|(q, _)| acts(*q)).for_each(|(q, x)| out[q] = self.grid_corners(x));
            return out;
        }
        if self.space() != Space::Node {
            return out;
        }
        let inverses: Vec<&[f64; 9]> = disc.points().inverse_jacobians().collect();
        for (id, (first, count)) in disc.points_of_cells().into_iter().enumerate() {
            let kind = disc.mesh().cell(id).kind;
            let mut reference = vec![[0.0; 3]; kind.corners()];
            for (k, xi) in kind.rule().points.iter().enumerate().take(count).filter(|(k, _)| acts(first + k)) {
                kind.corner_kind().gradients(xi, &mut reference);
                let inverse = inverses[first + k];
                let gradient =
                    |r: &[f64; 3]| [0, 1, 2].map(|j| (0..kind.dim()).map(|k| r[k] * inverse[3 * k + j]).sum());
                let basis = self.at_point(first + k).zip(&reference);
                out[first + k] = basis.map(|((i, shape), r)| (i as u32, shape, gradient(r))).collect();
            }
        }
        out
    }
}

/// The corners of the grid cell of every point of the cells that an actuation acts on; none at others.
pub(super) fn corners(disc: &Discretization, grid: &Grid, acts: &[bool]) -> Vec<Vec<Corner>> {
    let positions = disc.points().positions(disc.mesh(), None);
    let cells = disc.points().cells().into_iter();
    let of = |(x, cell): (&[f64; 3], u32)| if acts[cell as usize] { grid.corners(*x) } else { vec![] };
    positions.iter().zip(cells).map(of).collect()
}
