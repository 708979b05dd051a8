//! Obstacles: shapes by formulas, and meshed ones.

use crate::schema::mesh::MeshSource;
use crate::schema::value::Vector;

choice! {
    /// A shape that the body keeps clear of.
    pub enum Shape {
        /// All points within a radius of the center.
        "sphere" => Sphere(Sphere),
        /// All points behind a plane.
        "half_space" => HalfSpace(HalfSpace),
        /// All points within a radius of a segment.
        "capsule" => Capsule(Capsule),
        /// All points between two corners.
        "box" => Box(AlignedBox),
        /// All points in the cells of a mesh: linear ones.
        "mesh" => Mesh(MeshSource),
    }
}

object! {
    /// All points within a radius of the center.
    pub struct Sphere {
        /// Center.
        pub center: Vector as LENGTH,
        /// Radius.
        pub radius: f64 as POSITIVE_LENGTH,
    }
}

object! {
    /// All points behind a plane.
    pub struct HalfSpace {
        /// A point of the plane.
        pub point: Vector as LENGTH,
        /// Towards where the body belongs; of any length but zero.
        pub normal: Vector,
    }
}

object! {
    /// All points between two corners, the sides along the axes.
    pub struct AlignedBox {
        /// The corner with the smallest coordinates.
        pub low: Vector as LENGTH,
        /// The corner with the largest ones.
        pub high: Vector as LENGTH,
    }
}

object! {
    /// All points within a radius of a segment.
    pub struct Capsule {
        /// One end of the segment.
        pub from: Vector as LENGTH,
        /// The other.
        pub to: Vector as LENGTH,
        /// Radius.
        pub radius: f64 as POSITIVE_LENGTH,
    }
}
