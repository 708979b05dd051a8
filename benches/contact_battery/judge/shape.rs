//! Distances from obstacles.

use nastic::mesh::spatial::Obstacle;
use nastic::mesh::{CellKind, box_mesh, rectangle};
use nastic::tensor::{Mat3, Vec3};

/// An obstacle, where it is at rest.
#[derive(Debug, Clone)]
pub enum Shape {
    HalfSpace {
        point: Vec3,
        normal: Vec3,
    },
    Ball {
        center: Vec3,
        radius: f64,
    },
    Capsule {
        ends: [Vec3; 2],
        radius: f64,
    },
    /// Rounded inwards: its faces stay where they are.
    Brick {
        low: Vec3,
        high: Vec3,
        rounding: f64,
    },
    /// A meshed one, grown by the rounding.
    Meshed {
        low: Vec3,
        high: Vec3,
        rounding: f64,
    },
}

impl Shape {
    pub fn name(&self) -> &'static str {
        match self {
            Shape::HalfSpace { .. } => "a half-space",
            Shape::Ball { .. } => "a sphere",
            Shape::Capsule { .. } => "a capsule",
            Shape::Brick { .. } => "a box",
            Shape::Meshed { .. } => "a meshed box",
        }
    }

    /// The program's one.
    pub fn obstacle(&self, dim: usize) -> Result<Obstacle, Box<dyn std::error::Error>> {
        Ok(match self {
            Shape::HalfSpace { point, normal } => Obstacle::half_space((*point).into(), (*normal).into()),
            Shape::Ball { center, radius } => Obstacle::sphere((*center).into(), *radius),
            Shape::Capsule { ends, radius } => Obstacle::capsule(ends[0].into(), ends[1].into(), *radius),
            Shape::Brick { low, high, rounding } => {
                Obstacle::aligned_box((*low).into(), (*high).into()).rounded(*rounding)
            }
            Shape::Meshed { low, high, rounding } => {
                let sides = high - low;
                let mesh = match dim {
                    2 => rectangle([sides.x, sides.y], [1, 1], CellKind::Quad4)?,
                    _ => box_mesh(sides.into(), [1, 1, 1], CellKind::Hex8)?,
                };
                Obstacle::solid(&mesh.mapped(|x| (Vec3::from(x) + low).into())?)?.rounded(*rounding)
            }
        })
    }

    /// Below zero inside, of bodies in a plane with z = 0.
    pub fn distance(&self, x: &Vec3, dim: usize) -> f64 {
        match self {
            Shape::HalfSpace { point, normal } => normal.normalize().dot(&(x - point)),
            Shape::Ball { center, radius } => (x - center).norm() - radius,
            Shape::Capsule { ends: [a, b], radius } => {
                let axis = b - a;
                let along = (axis.dot(&(x - a)) / axis.norm_squared()).clamp(0.0, 1.0);
                (x - a - along * axis).norm() - radius
            }
            Shape::Brick { low, high, rounding } => {
                let r = Vec3::repeat(*rounding);
                from_box(&(low + r), &(high - r), x, 3) - rounding
            }
            Shape::Meshed { low, high, rounding } => from_box(low, high, x, dim) - rounding,
        }
    }
}

fn from_box(low: &Vec3, high: &Vec3, x: &Vec3, dim: usize) -> f64 {
    let beyond = |i: usize| (low[i] - x[i]).max(x[i] - high[i]);
    let outside = (0..dim).map(|i| beyond(i).max(0.0).powi(2)).sum::<f64>().sqrt();
    if outside > 0.0 { outside } else { (0..dim).map(beyond).fold(f64::NEG_INFINITY, f64::max) }
}

/// Where an obstacle is: moved by `shift`, turned by the vector `turn` about a centre.
pub struct Pose {
    pub centre: Vec3,
    pub shift: Vec3,
    turn: Mat3,
}

impl Pose {
    pub fn new(centre: Vec3, shift: Vec3, turn: Vec3) -> Self {
        let turn = exponential(&turn);
        Pose { centre, shift, turn }
    }

    /// Where a place of space is in the frame of the obstacle at rest.
    pub fn back(&self, x: &Vec3) -> Vec3 {
        self.centre + self.turn.transpose() * (x - self.centre - self.shift)
    }

    pub fn turned(&self, n: &Vec3) -> Vec3 {
        self.turn * n
    }
}

/// By the series of the exponential: angles here are below one.
fn exponential(theta: &Vec3) -> Mat3 {
    let cross = theta.cross_matrix();
    let (mut term, mut sum) = (Mat3::identity(), Mat3::identity());
    for n in 1..30 {
        term = term * cross / f64::from(n);
        sum += term;
    }
    sum
}
