//! [`Obstacle`]: shapes that bodies keep clear of, or touch, by their signed distance.

mod distance;
mod distance_grid;
mod drawn;
mod grid_spline;

use super::polyhedron::{Feature, Polyhedron, SurfacePoint};
use super::{SpatialError, V};
use crate::Mesh;
pub use distance::SignedDistance;
pub use distance_grid::{DistanceGrid, LostWall};
use std::sync::Arc;

/// A shape in space with its signed distance d(x): positive outside, negative inside; `|grad d| = 1`, but for one on a grid. In
/// plane strain its section with the plane z = 0 counts.
#[derive(Clone, Debug, PartialEq)]
pub enum Obstacle {
    /// `d(x) = |x - center| - radius`
    Sphere {
        /// Center.
        center: [f64; 3],
        /// Radius > 0.
        radius: f64,
    },
    /// `d(x) = normal . (x - point)`: the body belongs on the side that the normal points to.
    HalfSpace {
        /// A point of its plane.
        point: [f64; 3],
        /// Unit normal, out of the obstacle.
        normal: [f64; 3],
    },
    /// All points within a radius of the segment from `ends[0]` to `ends[1]`: `d(x) = |x - p(x)| - radius`, p the nearest point of the
    /// segment.
    Capsule {
        /// Ends of the segment.
        ends: [[f64; 3]; 2],
        /// Radius > 0.
        radius: f64,
    },
    /// All points between two corners, `low <= x <= high`: the distance from the nearest point outside, from the nearest face inside.
    Box {
        /// The corner with the smallest coordinates.
        low: [f64; 3],
        /// The corner with the largest ones.
        high: [f64; 3],
        /// Radius of its edges and corners, at least zero: outside of them d has a continuous gradient down to that depth.
        rounding: f64,
    },
    /// A meshed solid with flat faces, grown by a rounding radius: `d(x) = +-|x - p(x)| - rounding`, p the nearest point of its surface.
    /// The derivative of d jumps where the nearest face changes inside of it, and in front of its concave edges.
    Solid {
        /// What is grown.
        of: Arc<Polyhedron>,
        /// By how much, at least zero.
        rounding: f64,
    },
    /// A meshed solid whose distance is interpolated on a grid: two times continuously differentiable, also at concave edges.
    Grid(Arc<DistanceGrid>),
}

impl Obstacle {
    /// A sphere.
    pub fn sphere(center: [f64; 3], radius: f64) -> Self {
        Obstacle::Sphere { center, radius }
    }

    /// The half-space behind a plane; the body belongs where the normal points to, which need not have unit length.
    pub fn half_space(point: [f64; 3], normal: [f64; 3]) -> Self {
        // of any length: squares of very small and very large ones are no numbers
        let largest = normal.iter().fold(0.0, |largest: f64, n| largest.max(n.abs()));
        let scaled = normal.map(|n| n / largest);
        let size = norm(&scaled);
        Obstacle::HalfSpace { point, normal: scaled.map(|n| n / size) }
    }

    /// A cylinder with half spheres on its ends.
    pub fn capsule(from: [f64; 3], to: [f64; 3], radius: f64) -> Self {
        Obstacle::Capsule { ends: [from, to], radius }
    }

    /// A box along the axes.
    pub fn aligned_box(low: [f64; 3], high: [f64; 3]) -> Self {
        Obstacle::Box { low, high, rounding: 0.0 }
    }

    /// The cells of a mesh: linear ones.
    ///
    /// # Errors
    /// As [`Polyhedron::of`].
    pub fn solid(mesh: &Mesh) -> Result<Self, SpatialError> {
        Ok(Obstacle::Solid { of: Arc::new(Polyhedron::of(mesh, None)?), rounding: 0.0 })
    }

    /// The same with its distance on a grid of a spacing, interpolated up to a margin around the solid that is at least so wide.
    ///
    /// # Errors
    /// As [`Polyhedron::of`] and [`DistanceGrid::of`].
    pub fn on_grid(mesh: &Mesh, spacing: f64, margin: f64) -> Result<Self, SpatialError> {
        let solid = Arc::new(Polyhedron::of(mesh, None)?);
        Ok(Obstacle::Grid(Arc::new(DistanceGrid::of(solid, spacing, margin)?)))
    }

    /// With rounded edges: of a box, whose faces stay where they are, or of a meshed solid, which grows by the radius. Other shapes have
    /// no edges and stay, and so does a solid on a grid, which rounds them.
    #[must_use]
    pub fn rounded(mut self, radius: f64) -> Self {
        if let Obstacle::Box { rounding, .. } | Obstacle::Solid { rounding, .. } = &mut self {
            *rounding = radius;
        }
        self
    }

    /// Radius of its edges, zero of shapes without.
    pub fn rounding(&self) -> f64 {
        match self {
            Obstacle::Box { rounding, .. } | Obstacle::Solid { rounding, .. } => *rounding,
            _ => 0.0,
        }
    }

    /// Its signed distance at x: positive outside.
    pub fn distance(&self, x: &[f64; 3]) -> f64 {
        match self {
            Obstacle::Grid(grid) => grid.distance(x),
            Obstacle::Box { low, high, rounding } => {
                let (low, high) = (low.map(|x| x + rounding), high.map(|x| x - rounding));
                let (beyond, inside) = beyond_box(&low, &high, x);
                (if beyond == [0.0; 3] { inside } else { norm(&beyond) }) - rounding
            }
            _ => self.at(x).value,
        }
    }

    /// What d is replaced by to bound how far a point may go: it differs from d on a grid alone, and there only where d is at least the grid's margin, and
    /// changes by no more than [`Obstacle::steepest`] times the way.
    pub fn guarded(&self, x: &[f64; 3]) -> f64 {
        match self {
            Obstacle::Grid(grid) => grid.guarded(x),
            _ => self.distance(x),
        }
    }

    /// How fast at most [`Obstacle::guarded`] changes over a length: 1, but for a distance on a grid.
    pub fn steepest(&self) -> f64 {
        match self {
            Obstacle::Grid(grid) => grid.steepest(),
            _ => 1.0,
        }
    }

    /// Its signed distance at x with the derivatives.
    pub fn at(&self, x: &[f64; 3]) -> SignedDistance {
        match self {
            Obstacle::Sphere { center, radius } => around(center, x, *radius, [0.0; 3]),
            Obstacle::HalfSpace { point, normal } => {
                let value = (0..3).map(|i| normal[i] * (x[i] - point[i])).sum();
                SignedDistance::round(value, *normal, 0.0, [0.0; 3])
            }
            Obstacle::Capsule { ends: [from, to], radius } => {
                let along: [f64; 3] = std::array::from_fn(|i| to[i] - from[i]);
                let (length, offset) = (norm(&along), std::array::from_fn::<f64, 3, _>(|i| x[i] - from[i]));
                let axis = along.map(|a| if length > 0.0 { a / length } else { 0.0 });
                let place = axis.iter().zip(&offset).map(|(a, o)| a * o).sum::<f64>();
                let straight = if place > 0.0 && place < length { axis } else { [0.0; 3] };
                let nearest = std::array::from_fn(|i| from[i] + place.max(0.0).min(length) * axis[i]);
                around(&nearest, x, *radius, straight)
            }
            Obstacle::Box { low, high, rounding } => {
                from_box(&low.map(|x| x + rounding), &high.map(|x| x - rounding), x).plus(-rounding)
            }
            Obstacle::Solid { of, rounding } => from_surface(&of.nearest(*x)).plus(-rounding),
            Obstacle::Grid(grid) => grid.at(x),
        }
    }

    /// Checks its numbers, for bodies of a dimension.
    ///
    /// # Errors
    /// [`SpatialError::Obstacle`]: what is wrong.
    pub fn check(&self, dim: usize) -> Result<(), SpatialError> {
        let complain = |what: String| Err(SpatialError::Obstacle { what });
        let (numbers, radius) = match self {
            Obstacle::Sphere { center, radius } => (center.to_vec(), *radius),
            Obstacle::HalfSpace { point, normal } => ([*point, *normal].concat(), 1.0),
            Obstacle::Capsule { ends, radius } => (ends.concat(), *radius),
            Obstacle::Box { low, high, .. } => ([*low, *high].concat(), 1.0),
            Obstacle::Solid { .. } | Obstacle::Grid(_) => (Vec::new(), 1.0),
        };
        if numbers.iter().any(|x| !x.is_finite()) {
            let what = match self {
                Obstacle::HalfSpace { point, .. } if point.iter().all(|x| x.is_finite()) => {
                    "the normal of a half-space is zero or not finite: it is a direction, of any length but zero"
                }
                _ => "a coordinate or radius of the obstacle is not finite",
            };
            return complain(what.to_owned());
        }
        let rounding = self.rounding();
        if !(rounding >= 0.0 && rounding.is_finite()) {
            return complain(format!("an obstacle has the rounding radius {rounding}; it is a length, zero or more"));
        }
        let meshed = match self {
            Obstacle::Solid { of, .. } => Some(of.as_ref()),
            Obstacle::Grid(grid) => Some(grid.solid()),
            _ => None,
        };
        if let Some(found) = meshed.map(Polyhedron::dim)
            && found != dim
        {
            return complain(format!(
                "the mesh of an obstacle has {found} dimensions and the body {dim}: take the same"
            ));
        }
        if let Obstacle::HalfSpace { normal, .. } = self
            && (norm(normal) - 1.0).abs() > 1e-9
        {
            let size = norm(normal);
            return complain(format!(
                "the normal of a half-space has the length {size}; Obstacle::half_space makes it 1"
            ));
        }
        if let Obstacle::Box { low, high, .. } = self
            && (0..3).any(|i| high[i] - low[i] <= 2.0 * rounding)
        {
            if (0..3).all(|i| low[i] < high[i]) {
                return complain(format!(
                    "the rounding radius {rounding} of the box from {low:?} to {high:?} is more than half of its shortest side"
                ));
            }
            return complain(format!(
                "the box from {low:?} to {high:?} is empty; its second corner has the larger coordinates"
            ));
        }
        if !(radius > 0.0 && radius.is_finite()) {
            return complain(format!("an obstacle has the radius {radius}; radii are positive numbers"));
        }
        Ok(())
    }
}

/// Outside: the distance from the nearest point, beside an edge without curvature along it, before a face without any. Inside: minus that
/// from the nearest face.
fn from_box(low: &[f64; 3], high: &[f64; 3], x: &[f64; 3]) -> SignedDistance {
    let (beyond, inside) = beyond_box(low, high, x);
    let sides = beyond.iter().filter(|b| **b != 0.0).count();
    if sides == 0 {
        let face =
            |i: usize| if low[i] - x[i] > x[i] - high[i] { (low[i] - x[i], -1.0) } else { (x[i] - high[i], 1.0) };
        let normal = |axis: usize| std::array::from_fn(|i| if i == axis { face(i).1 } else { 0.0 });
        // of equal ones the last
        let axis = (0..3).rev().find(|&i| face(i).0 == inside).unwrap_or(0);
        return SignedDistance::round(inside, normal(axis), 0.0, [0.0; 3]);
    }
    let straight = beyond.map(|b| if sides == 2 && b == 0.0 { 1.0 } else { 0.0 });
    // about the nearest point, so that the value is that of `distance` to the bit
    let found = around(&[0.0; 3], &beyond, 0.0, straight);
    if sides == 1 { SignedDistance::round(found.value, found.gradient, 0.0, straight) } else { found }
}

/// The way from the nearest point of a box, zero inside; and minus the distance from the nearest face there.
fn beyond_box(low: &[f64; 3], high: &[f64; 3], x: &[f64; 3]) -> ([f64; 3], f64) {
    let beyond = std::array::from_fn(|i| x[i] - x[i].max(low[i]).min(high[i]));
    let inside = (0..3).map(|i| (low[i] - x[i]).max(x[i] - high[i])).fold(f64::NEG_INFINITY, f64::max);
    (beyond, inside)
}

fn norm(v: &[f64; 3]) -> f64 {
    V::from(*v).norm()
}

/// Before a face without curvature; inside, where the nearest edges are concave, with a negative one.
fn from_surface(near: &SurfacePoint) -> SignedDistance {
    let SurfacePoint { distance: value, normal, on, .. } = *near;
    let (curvature, straight) = match on {
        Feature::Face => (0.0, [0.0; 3]),
        Feature::Edge(axis) => (1.0, axis),
        Feature::Corner => (1.0, [0.0; 3]),
    };
    let curvature = if value == 0.0 { 0.0 } else { curvature / value };
    SignedDistance::round(value, normal, curvature, straight)
}

fn around(center: &[f64; 3], x: &[f64; 3], radius: f64, straight: [f64; 3]) -> SignedDistance {
    let offset: [f64; 3] = std::array::from_fn(|i| x[i] - center[i]);
    let away = norm(&offset);
    let (normal, curvature) = if away > 0.0 { (offset.map(|o| o / away), 1.0 / away) } else { ([0.0; 3], 0.0) };
    SignedDistance::round(away - radius, normal, curvature, straight)
}
