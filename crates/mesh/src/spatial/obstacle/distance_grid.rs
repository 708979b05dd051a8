//! [`DistanceGrid`]: the signed distance from a meshed solid, interpolated on a grid.

use super::super::polyhedron::Polyhedron;
use super::grid_spline::{GridSpline, Partials};
use super::{SignedDistance, SpatialError, V, from_surface};
use std::sync::Arc;

/// Numbers of a grid, of 8 bytes each.
const MAX_NUMBERS: f64 = 8e6;
/// Ratio of one spacing that is tried to the one before.
const SPACING_GROWTH: f64 = 1.05;
/// Spacing at which the search begins, as a share of the solid's size: no grid is that fine.
const MIN_SPACING_SHARE: f64 = 1e-7;
/// Least margin around the solid, in spacings.
const MIN_MARGIN_SPACINGS: f64 = 4.0;
/// Least margin around the solid, as a share of the diagonal of its bounding box.
const MIN_MARGIN_SHARE: f64 = 0.05;
/// Spacings of the grid beyond the margin.
const BORDER_SPACINGS: f64 = 1.5;
/// Cosine between the normals of two sides of a wall.
const MAX_OPPOSITE_COSINE: f64 = -0.8;
/// Halvings of a spacing in the search for the other side of a wall.
const MAX_HALVINGS: usize = 20;

/// Of a closed solid with flat faces the exact signed distance at the nodes of a regular grid of spacing h around it, in between cubic B-splines through
/// these values: two times continuously differentiable, where the exact distance has edges. It differs from that by `O(h^2)` where that is smooth, and
/// rounds edges within some h.
///
/// The grid covers the solid and a margin around it; further out d is the exact distance. There it jumps by the error of the interpolation, where it is at
/// least the margin.
#[derive(Clone, Debug, PartialEq)]
pub struct DistanceGrid {
    solid: Arc<Polyhedron>,
    spline: GridSpline,
    margin: f64,
    steepest: f64,
    deepest: f64,
    error: f64,
    lost: Option<LostWall>,
}

/// A wall of a solid that is too thin for a grid: where it is thickest the interpolated distance is not negative, and a body goes through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LostWall {
    /// A point of its surface.
    pub place: [f64; 3],
    /// How thick it is there.
    pub thickness: f64,
}

impl DistanceGrid {
    /// With a spacing, and a margin around the solid's bounding box that is at least so wide.
    ///
    /// # Errors
    /// [`SpatialError::GridSpacing`], [`SpatialError::LargeGrid`], [`SpatialError::CoarseGrid`]: a spacing that is no length, that takes too many nodes, or none
    /// inside of the solid.
    pub fn of(solid: Arc<Polyhedron>, spacing: f64, margin: f64) -> Result<Self, SpatialError> {
        for (what, length, is_one) in [("spacing", spacing, spacing > 0.0), ("margin", margin, margin >= 0.0)] {
            if !(is_one && length.is_finite()) {
                return Err(SpatialError::GridSpacing { what, length });
            }
        }
        let (dim, (low, high)) = (solid.dim(), solid.bounds());
        let size: [f64; 3] = std::array::from_fn(|i| if i < dim { high[i] - low[i] } else { 0.0 });
        let nodes_at = |spacing: f64| {
            let margin = widened(margin, spacing, size);
            // next to its border d is less than on it
            let cells = |i: usize| ((size[i] + 2.0 * margin) / spacing + 2.0 * BORDER_SPACINGS).ceil();
            let nodes: [f64; 3] = std::array::from_fn(|i| if i < dim { cells(i) + 1.0 } else { 1.0 });
            (nodes, GridSpline::numbers(nodes))
        };
        let (nodes, numbers) = nodes_at(spacing);
        if numbers > MAX_NUMBERS {
            let enough = |spacing: &f64| nodes_at(*spacing).1 <= MAX_NUMBERS;
            let least = spacing.max(MIN_SPACING_SHARE * V::from(size).max());
            let coarser = std::iter::successors(Some(least), |h| Some(SPACING_GROWTH * h)).map(rounded_up).find(enough);
            let coarser = coarser.unwrap_or(f64::INFINITY);
            return Err(SpatialError::LargeGrid { spacing, numbers, most: MAX_NUMBERS, coarser });
        }
        let margin = widened(margin, spacing, size);
        // the rest of the last cell goes to both sides alike
        let nodes = nodes.map(|n| n as usize);
        let first = |i: usize| 0.5 * (low[i] + high[i] - spacing * (nodes[i] - 1) as f64);
        let first: [f64; 3] = std::array::from_fn(|i| if i < dim { first(i) } else { 0.0 });
        let values = sampled(&solid, first, spacing, nodes);
        let deepest = values.iter().fold(0.0, |deepest: f64, d| deepest.max(-d));
        if deepest == 0.0 {
            return Err(SpatialError::CoarseGrid { spacing, size: size[..dim].to_vec() });
        }
        let spline = GridSpline::through(first, spacing, nodes, &values);
        let (steepest, margin) = (spline.steepest().max(1.0), margin.min(spline.least_on_boundary()));
        let mut grid = DistanceGrid { solid, spline, margin, steepest, deepest, error: 0.0, lost: None };
        grid.look_at_faces();
        Ok(grid)
    }

    /// The solid whose distance it is.
    pub fn solid(&self) -> &Polyhedron {
        &self.solid
    }

    /// Distance of neighbouring nodes.
    pub fn spacing(&self) -> f64 {
        self.spline.spacing()
    }

    /// Nodes along each axis; one along the third in the plane.
    pub fn nodes(&self) -> [usize; 3] {
        self.spline.nodes()
    }

    /// Where d is less, it is interpolated.
    pub fn margin(&self) -> f64 {
        self.margin
    }

    /// The largest depth of a node.
    pub fn deepest(&self) -> f64 {
        self.deepest
    }

    /// The largest |d| found on the surface of the solid, whose distance is zero: at corners of its faces, and between them at points a spacing apart.
    pub fn error(&self) -> f64 {
        self.error
    }

    /// A wall that it has lost, of several the thinnest that was found.
    pub fn lost(&self) -> Option<LostWall> {
        self.lost
    }

    /// d
    pub fn distance(&self, x: &[f64; 3]) -> f64 {
        self.spline.value(x).unwrap_or_else(|| self.solid.nearest(*x).distance)
    }

    /// d with its derivatives.
    pub fn at(&self, x: &[f64; 3]) -> SignedDistance {
        self.spline.partials(x).map_or_else(|| from_surface(&self.solid.nearest(*x)), |found| signed_distance(&found))
    }

    /// A bound of how fast [`DistanceGrid::guarded`] changes over a length, at least 1: `|grad d|` is no larger on the grid.
    pub fn steepest(&self) -> f64 {
        self.steepest
    }

    /// d, where that is less than the margin; else the margin, beyond the grid with the distance from it: continuous, and never below the margin where d
    /// is not.
    pub fn guarded(&self, x: &[f64; 3]) -> f64 {
        match self.spline.value(x) {
            Some(d) => d.min(self.margin),
            None => self.margin + (V::from(*x) - V::from(self.spline.clamped(x))).norm(),
        }
    }

    /// How far the faces of the solid are off, and what wall behind them is lost.
    fn look_at_faces(&mut self) {
        let solid = self.solid.clone();
        for ([a, b, c], normal) in solid.faces() {
            let longest = [b - a, c - b, a - c].iter().map(V::norm).fold(0.0, f64::max);
            let pieces = (longest / self.spacing()).ceil().max(1.0) as usize;
            let across = if b == c { 0 } else { pieces };
            for i in 0..=across {
                for j in 0..=pieces - i {
                    let [s, t] = [i, j].map(|k| k as f64 / pieces as f64);
                    let place = a + (c - a) * s + (b - a) * t;
                    self.error = self.error.max(self.distance(&place.into()).abs());
                    let thinner = |wall: &LostWall| self.lost.is_none_or(|known| wall.thickness < known.thickness);
                    self.lost = self.lost_wall(&place, &normal).filter(thinner).or(self.lost);
                }
            }
        }
    }

    /// The wall behind a point of the surface, where that is less than a spacing thick and d has no inside of it.
    fn lost_wall(&self, place: &V, normal: &V) -> Option<LostWall> {
        let behind = |depth: f64| -> [f64; 3] { (place - depth * normal).into() };
        let h = self.spacing();
        if self.distance(&behind(0.5 * h)) < 0.0 {
            return None;
        }
        let (mut inside, mut outside) = (0.0, h);
        for _ in 0..MAX_HALVINGS {
            let middle = 0.5 * (inside + outside);
            if self.solid.nearest(behind(middle)).distance < 0.0 { inside = middle } else { outside = middle }
        }
        let (thickness, other) = (inside, self.solid.nearest(behind(inside)));
        let is_wall = thickness > 0.0 && V::from(other.normal).dot(normal) < MAX_OPPOSITE_COSINE;
        let is_lost = is_wall && self.distance(&behind(0.5 * thickness)) >= 0.0;
        is_lost.then(|| LostWall { place: (*place).into(), thickness })
    }
}

/// The distance at every node, first along x: no further than the node before by more than a spacing.
fn sampled(solid: &Polyhedron, first: [f64; 3], spacing: f64, nodes: [usize; 3]) -> Vec<f64> {
    let reach = |before: f64| before.abs() + 1.000_001 * spacing;
    let mut values = Vec::with_capacity(nodes.iter().product());
    let mut of_row = f64::INFINITY;
    for k in 0..nodes[2] {
        for j in 0..nodes[1] {
            // rows of neighbouring planes begin further apart
            let mut within = if j == 0 { f64::INFINITY } else { reach(of_row) };
            for i in 0..nodes[0] {
                let index = [i, j, k];
                let x = std::array::from_fn(|axis| first[axis] + spacing * index[axis] as f64);
                let d = solid.nearest_within(x, within).distance;
                if i == 0 {
                    of_row = d;
                }
                within = reach(d);
                values.push(d);
            }
        }
    }
    values
}

fn signed_distance(d: &Partials) -> SignedDistance {
    let of = |axes: &[usize]| {
        let [a, b, c] = [0, 1, 2].map(|axis| axes.iter().filter(|own| **own == axis).count());
        d[a][b][c]
    };
    SignedDistance::interpolated(of)
}

/// The margin of a grid of a spacing around a solid of a size.
fn widened(margin: f64, spacing: f64, size: [f64; 3]) -> f64 {
    margin.max(MIN_MARGIN_SPACINGS * spacing).max(MIN_MARGIN_SHARE * V::from(size).norm())
}

/// To two digits.
fn rounded_up(x: f64) -> f64 {
    let unit = 10f64.powf(x.log10().floor() - 1.0);
    unit * (x / unit).ceil()
}
