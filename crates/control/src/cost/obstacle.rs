//! [`Obstacle`]: shapes a body must keep clear of, by their signed distance; [`ObstaclePenetration`]: the cost of being inside.

use super::body_points::{BodyPoints, Place};
use super::{Cost, CostContext, CostPoint, Figure, FigureKind, IntoCost, Partials, check_weight};
use crate::error::ControlError;
use nastic_fem::Solid;
use nastic_mesh::spatial::{Feature, Polyhedron, SurfacePoint};
use nastic_mesh::{GroupNames, Mesh};
use nastic_numeric::vector::{dot, norm};
use std::sync::Arc;

/// A shape in space with its signed distance d(x): positive outside, negative inside, `|grad d| = 1`. In plane strain its section
/// with the plane z = 0 counts.
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
    },
    /// A meshed solid with flat faces: `d(x) = +-|x - p(x)|`, p the nearest point of its surface. The derivative of d jumps where the
    /// nearest face changes inside of it, and in front of its concave edges.
    Solid(Arc<Polyhedron>),
}

/// The signed distance of a point: `d`, `grad d`, and what its second derivative takes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Distance {
    pub value: f64,
    /// grad d; zero where the distance has no gradient (the center of a sphere).
    pub normal: [f64; 3],
    /// `1 / |x - p|`, the curvature of the surface of equal distance; zero of a plane.
    curvature: f64,
    /// A direction without curvature, beside the normal: that of the axis of a capsule between its ends.
    straight: [f64; 3],
}

impl Distance {
    /// `d2d/dx2 v = (v - n (n . v) - a (a . v)) / |x - p|`
    pub fn second(&self, v: &[f64]) -> [f64; 3] {
        let v: [f64; 3] = std::array::from_fn(|i| v.get(i).copied().unwrap_or(0.0));
        let (n, a) = (&self.normal, &self.straight);
        let (along_n, along_a) = (dot(n, &v), dot(a, &v));
        std::array::from_fn(|i| self.curvature * (v[i] - n[i] * along_n - a[i] * along_a))
    }
}

impl Obstacle {
    /// A sphere.
    pub fn sphere(center: [f64; 3], radius: f64) -> Self {
        Obstacle::Sphere { center, radius }
    }

    /// The half-space behind a plane; the body belongs where the normal points to, which need not have unit length.
    pub fn half_space(point: [f64; 3], normal: [f64; 3]) -> Self {
        let size = norm(&normal);
        Obstacle::HalfSpace { point, normal: normal.map(|n| n / size) }
    }

    /// A cylinder with half spheres on its ends.
    pub fn capsule(from: [f64; 3], to: [f64; 3], radius: f64) -> Self {
        Obstacle::Capsule { ends: [from, to], radius }
    }

    /// A box along the axes.
    pub fn aligned_box(low: [f64; 3], high: [f64; 3]) -> Self {
        Obstacle::Box { low, high }
    }

    /// The cells of a mesh: linear ones.
    ///
    /// # Errors
    /// As [`Polyhedron::of`].
    pub fn solid(mesh: &Mesh) -> Result<Self, ControlError> {
        let solid = Polyhedron::of(mesh, None).map_err(|error| ControlError::Cost { what: error.to_string() })?;
        Ok(Obstacle::Solid(Arc::new(solid)))
    }

    /// Its signed distance at x: positive outside.
    pub fn distance(&self, x: &[f64; 3]) -> f64 {
        self.at(x).value
    }

    pub(crate) fn at(&self, x: &[f64; 3]) -> Distance {
        match self {
            Obstacle::Sphere { center, radius } => around(center, x, *radius, [0.0; 3]),
            Obstacle::HalfSpace { point, normal } => {
                let value = (0..3).map(|i| normal[i] * (x[i] - point[i])).sum();
                Distance { value, normal: *normal, curvature: 0.0, straight: [0.0; 3] }
            }
            Obstacle::Capsule { ends: [from, to], radius } => {
                let along: [f64; 3] = std::array::from_fn(|i| to[i] - from[i]);
                let (length, offset) = (norm(&along), std::array::from_fn::<f64, 3, _>(|i| x[i] - from[i]));
                let axis = along.map(|a| if length > 0.0 { a / length } else { 0.0 });
                let place = dot(&axis, &offset);
                let straight = if place > 0.0 && place < length { axis } else { [0.0; 3] };
                let nearest = std::array::from_fn(|i| from[i] + place.max(0.0).min(length) * axis[i]);
                around(&nearest, x, *radius, straight)
            }
            Obstacle::Box { low, high } => from_box(low, high, x),
            Obstacle::Solid(solid) => from_surface(&solid.nearest(*x)),
        }
    }

    /// Checks its numbers, and the distance to keep from it.
    pub(crate) fn check(&self, clearance: f64, dim: usize) -> Result<(), ControlError> {
        let complain = |what: String| Err(ControlError::Cost { what });
        if !clearance.is_finite() {
            return complain(format!("an obstacle has the clearance {clearance}; clearances are finite lengths"));
        }
        let (numbers, radius) = match self {
            Obstacle::Sphere { center, radius } => (center.to_vec(), *radius),
            Obstacle::HalfSpace { point, normal } => ([*point, *normal].concat(), 1.0),
            Obstacle::Capsule { ends, radius } => (ends.concat(), *radius),
            Obstacle::Box { low, high } => ([*low, *high].concat(), 1.0),
            Obstacle::Solid(_) => (Vec::new(), 1.0),
        };
        if numbers.iter().any(|x| !x.is_finite()) {
            return complain(format!(
                "the obstacle {self:?} is not finite; a half-space needs a normal that is not zero"
            ));
        }
        if let Obstacle::Solid(solid) = self
            && solid.dim() != dim
        {
            let found = solid.dim();
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
        if let Obstacle::Box { low, high } = self
            && (0..3).any(|i| low[i] >= high[i])
        {
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
fn from_box(low: &[f64; 3], high: &[f64; 3], x: &[f64; 3]) -> Distance {
    let nearest: [f64; 3] = std::array::from_fn(|i| x[i].max(low[i]).min(high[i]));
    let beyond: Vec<usize> = (0..3).filter(|&i| nearest[i] != x[i]).collect();
    if beyond.is_empty() {
        let faces = (0..3).flat_map(|i| [(i, -1.0, low[i] - x[i]), (i, 1.0, x[i] - high[i])]);
        let (axis, sense, value) = faces.max_by(|a, b| a.2.total_cmp(&b.2)).unwrap_or((0, 1.0, 0.0));
        let normal = std::array::from_fn(|i| if i == axis { sense } else { 0.0 });
        return Distance { value, normal, curvature: 0.0, straight: [0.0; 3] };
    }
    let edge = (0..3).find(|i| !beyond.contains(i)).filter(|_| beyond.len() == 2);
    let straight = std::array::from_fn(|i| if edge == Some(i) { 1.0 } else { 0.0 });
    let found = around(&nearest, x, 0.0, straight);
    if beyond.len() == 1 { Distance { curvature: 0.0, ..found } } else { found }
}

/// Before a face without curvature; inside, where the nearest edges are concave, with a negative one.
fn from_surface(near: &SurfacePoint) -> Distance {
    let SurfacePoint { distance: value, normal, on, .. } = *near;
    let (curvature, straight) = match on {
        Feature::Face => (0.0, [0.0; 3]),
        Feature::Edge(axis) => (1.0, axis),
        Feature::Corner => (1.0, [0.0; 3]),
    };
    let curvature = if value == 0.0 { 0.0 } else { curvature / value };
    Distance { value, normal, curvature, straight }
}

fn around(center: &[f64; 3], x: &[f64; 3], radius: f64, straight: [f64; 3]) -> Distance {
    let offset: [f64; 3] = std::array::from_fn(|i| x[i] - center[i]);
    let away = norm(&offset);
    let (normal, curvature) = if away > 0.0 { (offset.map(|o| o / away), 1.0 / away) } else { ([0.0; 3], 0.0) };
    Distance { value: away - radius, normal, curvature, straight }
}

/// `j = (weight/2) int_{Gamma_0} max(0, clearance - d(x))^2 dA` over a named surface of the reference body (`dX` over a region, a plain
/// sum over a node set), with `x = X + u(X)` and d the signed distance from an [`Obstacle`].
///
/// With `p = clearance - d > 0`: `dj/du [v] = -weight int p grad d . v dA`,
/// `d2j/du2 [v, w] = weight int (grad d . v)(grad d . w) - p v . (d2d/dx2 w) dA`; points with p <= 0 add nothing. A penalty: the
/// body enters the obstacle a little. [`ObstacleDistance`](crate::ObstacleDistance) keeps it out.
/// Units: length^4 times the weight's on a surface, length^5 over a region, length^2 over nodes. Source: docs/model.md section 5.
#[derive(Clone, Debug)]
pub struct ObstaclePenetration {
    place: Place,
    obstacle: Obstacle,
    clearance: f64,
    weight: f64,
}

impl ObstaclePenetration {
    fn of(place: Place, obstacle: Obstacle) -> Self {
        ObstaclePenetration { place, obstacle, clearance: 0.0, weight: 1.0 }
    }

    /// Of a named surface, or of the union of several.
    pub fn surface(names: impl Into<GroupNames>, obstacle: Obstacle) -> Self {
        Self::of(Place::Surface(names.into()), obstacle)
    }

    /// Of a named region, or of the union of several.
    pub fn region(names: impl Into<GroupNames>, obstacle: Obstacle) -> Self {
        Self::of(Place::Region(names.into()), obstacle)
    }

    /// Of the nodes of named node sets (or of surfaces), each with weight one.
    pub fn nodes(names: impl Into<GroupNames>, obstacle: Obstacle) -> Self {
        Self::of(Place::Nodes(names.into()), obstacle)
    }

    /// The distance to keep; zero if not given.
    pub fn clearance(mut self, clearance: f64) -> Self {
        self.clearance = clearance;
        self
    }

    /// Multiplies the cost.
    pub fn weight(mut self, weight: f64) -> Self {
        self.weight = weight;
        self
    }
}

impl IntoCost for ObstaclePenetration {
    fn bind(self, solid: &Solid) -> Result<Box<dyn Cost>, ControlError> {
        self.obstacle.check(self.clearance, solid.discretization().dim())?;
        let weight = check_weight("obstacle", self.weight)?;
        let (points, _) = self.place.points(solid)?;
        Ok(Box::new(Bound { points: Arc::new(points), obstacle: self.obstacle, clearance: self.clearance, weight }))
    }
}

/// [`ObstaclePenetration`] bound to a body.
#[derive(Debug)]
struct Bound {
    points: Arc<BodyPoints>,
    obstacle: Obstacle,
    clearance: f64,
    weight: f64,
}

impl Cost for Bound {
    fn name(&self) -> &str {
        "obstacle"
    }

    fn at(&self, at: &CostContext) -> Result<Arc<dyn CostPoint>, ControlError> {
        let dim = at.solid.discretization().dim();
        let distances: Vec<Distance> =
            self.points.positions(at.solid, Some(at.u)).iter().map(|x| self.obstacle.at(x)).collect();
        let square = |(q, d): (usize, &Distance)| self.points.weight(q) * (self.clearance - d.value).max(0.0).powi(2);
        let value = 0.5 * self.weight * distances.iter().enumerate().map(square).sum::<f64>();
        let (points, clearance, weight) = (self.points.clone(), self.clearance, self.weight);
        Ok(Arc::new(Point { points, clearance, weight, dim, value, distances }))
    }
}

/// The cost evaluated.
#[derive(Debug)]
struct Point {
    points: Arc<BodyPoints>,
    clearance: f64,
    weight: f64,
    dim: usize,
    value: f64,
    distances: Vec<Distance>,
}

impl CostPoint for Point {
    fn value(&self) -> f64 {
        self.value
    }

    fn add_partials(&self, out: &mut Partials) -> Result<(), ControlError> {
        let mut forces = vec![0.0; self.dim * self.distances.len()];
        for (q, (force, d)) in forces.chunks_exact_mut(self.dim).zip(&self.distances).enumerate() {
            let depth = (self.clearance - d.value).max(0.0);
            let factor = -self.weight * self.points.weight(q) * depth;
            force.iter_mut().zip(&d.normal).for_each(|(f, n)| *f = factor * n);
        }
        self.points.spread(&forces, self.dim, &mut out.u);
        Ok(())
    }

    fn add_second_partials(&self, along: &Partials, out: &mut Partials) -> Result<(), ControlError> {
        let mut forces = self.points.weighted(&along.u, self.dim, self.weight);
        for (v, d) in forces.chunks_exact_mut(self.dim).zip(&self.distances) {
            let depth = self.clearance - d.value;
            if depth <= 0.0 {
                v.fill(0.0);
                continue;
            }
            let (slope, bent) = (dot(&d.normal[..v.len()], v), d.second(v));
            v.iter_mut().zip(d.normal).zip(bent).for_each(|((v, n), bent)| *v = slope * n - depth * bent);
        }
        self.points.spread(&forces, self.dim, &mut out.u);
        Ok(())
    }

    /// The smallest distance of a quadrature point or node from the obstacle, negative inside.
    fn figures(&self) -> Result<Vec<Figure>, ControlError> {
        let smallest = self.distances.iter().map(|d| d.value).fold(f64::INFINITY, f64::min);
        Ok(vec![Figure::length(FigureKind::Other("obstacle_distance"), smallest)])
    }
}
