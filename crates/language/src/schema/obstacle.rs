//! The blocks of `obstacles`: shapes by formulas, and meshed ones, with their poses.

use crate::quantity::Want;
use crate::schema::field::VectorField;
use crate::schema::fixed::Fixed;
use crate::schema::json::{Definitions, any_of};
use crate::schema::mesh::MeshSource;
use crate::schema::read::{Read, Reader};
use crate::schema::time_table::TimeTable;
use crate::schema::value::Vector;
use crate::syntax::{At, Node, Value};
use serde_json::{Value as Json, json};

object! {
    /// Something rigid that contacts, costs and constraints refer to by its name.
    pub struct Obstacle checked by check_edges {
        /// Name, by which others refer to it; its pose is controlled as "NAME.translation" and "NAME.rotation".
        pub name: String,
        /// Its shape, where it is not moved.
        pub shape: Shape,
        /// Radius by which edges and corners are rounded: the faces of a box stay, a mesh grows by it.
        pub rounding: f64 as NOT_NEGATIVE_LENGTH = 0.0,
        /// Of a mesh: spacing of a grid on which its distance is interpolated with a continuous second derivative, in place of a rounding.
        pub grid: Option<f64> as POSITIVE_LENGTH,
        /// How far it is moved, where that is no control; numbers, or of a motion formulas of t or a table.
        pub translation: Option<VectorInTime> as LENGTH_IN_TIME,
        /// Rotation vector, in radians about its direction, where that is no control.
        pub rotation: Option<VectorInTime> as NUMBER_IN_TIME,
        /// The point about which it turns, where it is not moved; its middle if left out.
        pub centre: Option<Vector> as LENGTH,
    }
}

/// A vector that may change in time and is no control: a part of a pose, a load.
#[derive(Clone, PartialEq, Debug)]
pub struct VectorInTime(pub Fixed);

impl VectorInTime {
    /// Its formulas or array; none of a table.
    #[must_use]
    pub fn field(&self) -> Option<&VectorField> {
        if let Fixed::Vector(field) = &self.0 { Some(field) } else { None }
    }
}

impl Read for VectorInTime {
    fn read(node: &Node, at: &At, want: Want, reader: &mut Reader<'_>) -> Option<Self> {
        let fixed = match TimeTable::is_named_by(node) {
            true => TimeTable::read_for(Some(true), node, at, reader).map(Fixed::Table),
            false => VectorField::read(node, at, want, reader).map(Fixed::Vector),
        };
        fixed.map(Self)
    }

    fn schema(want: Want, definitions: &mut Definitions) -> Json {
        any_of(vec![VectorField::schema(want, definitions), TimeTable::schema(want, definitions)])
    }
}

fn check_edges(obstacle: &Obstacle, reader: &mut Reader<'_>) {
    if obstacle.grid.is_none() {
        return;
    }
    if !matches!(obstacle.shape, Shape::Mesh(_)) {
        let message = format!(
            "a {} has a distance in closed form: leave the grid out; it is for a shape from a mesh",
            obstacle.shape.name().replace('_', "-")
        );
        reader.complain_at(&obstacle.at.key("grid"), message);
    } else if obstacle.rounding > 0.0 {
        let message = "an obstacle has a rounding or a grid: a rounding grows it by that radius, a grid keeps its size and rounds edges within a \
                       spacing; leave one of them out";
        reader.complain_at(&obstacle.at.key("grid"), message);
    }
}

impl Obstacle {
    /// Its shape, and how its edges are treated.
    #[must_use]
    pub fn outline(&self) -> Outline<'_> {
        let grid = self.grid.map(|spacing| (spacing, self));
        Outline { shape: &self.shape, rounding: self.rounding, grid }
    }

    /// The parts of its pose that are no controls, with their keys.
    pub fn pose(&self) -> impl Iterator<Item = (&'static str, &Fixed)> {
        let parts = [("translation", &self.translation), ("rotation", &self.rotation)];
        parts.into_iter().filter_map(|(key, part)| part.as_ref().map(|part| (key, &part.0)))
    }
}

/// A shape, and how its edges are treated.
#[derive(Clone, Copy, Debug)]
pub struct Outline<'a> {
    /// The shape.
    pub shape: &'a Shape,
    /// Radius of its edges.
    pub rounding: f64,
    /// Of a meshed one the spacing of the grid of its distance, with the obstacle that says so.
    pub grid: Option<(f64, &'a Obstacle)>,
}

/// The obstacle of a cost or constraint: a shape, or the name of one of `obstacles`.
#[derive(Clone, PartialEq, Debug)]
pub enum ShapeOrName {
    /// A shape of its own.
    Shape(Shape),
    /// One of the case's obstacles, where it is not moved.
    Name(String),
}

impl ShapeOrName {
    /// The shape; `None` of a name that is not there.
    #[must_use]
    pub fn among<'a>(&'a self, obstacles: &'a [Obstacle]) -> Option<Outline<'a>> {
        match self {
            Self::Shape(shape) => Some(Outline { shape, rounding: 0.0, grid: None }),
            Self::Name(name) => obstacles.iter().find(|obstacle| obstacle.name == *name).map(Obstacle::outline),
        }
    }
}

impl Read for ShapeOrName {
    fn read(node: &Node, at: &At, want: Want, reader: &mut Reader<'_>) -> Option<Self> {
        match &node.value {
            Value::Text(name) => Some(Self::Name(name.clone())),
            _ => Shape::read(node, at, want, reader).map(Self::Shape),
        }
    }

    fn schema(want: Want, definitions: &mut Definitions) -> Json {
        let named = json!({ "type": "string", "description": "One of the case's obstacles." });
        any_of(vec![Shape::schema(want, definitions), named])
    }
}

choice! {
    /// A shape that the body keeps clear of, or touches.
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
    /// All points between two corners, the sides along the axes: "low" and "high", or "center" and "size".
    pub struct AlignedBox checked by check_box {
        /// The corner with the smallest coordinates.
        pub low: Option<Vector> as LENGTH,
        /// The corner with the largest ones.
        pub high: Option<Vector> as LENGTH,
        /// The middle.
        pub center: Option<Vector> as LENGTH,
        /// The lengths of the sides.
        pub size: Option<Vector> as POSITIVE_LENGTH,
    }
}

impl AlignedBox {
    /// Whether it is given by two coordinates.
    #[must_use]
    pub fn is_plane(&self) -> bool {
        let given = [&self.low, &self.high, &self.center, &self.size];
        given.into_iter().flatten().any(|vector| vector.entries().len() == 2)
    }

    /// The corners with the smallest and with the largest coordinates.
    #[must_use]
    pub fn corners(&self) -> [[f64; 3]; 2] {
        let given = |at: &Option<Vector>| at.as_ref().map(Vector::xyz);
        match (given(&self.low), given(&self.high), given(&self.center), given(&self.size)) {
            (Some(low), Some(high), ..) => [low, high],
            (.., Some(center), Some(size)) => {
                [-0.5, 0.5].map(|half: f64| std::array::from_fn(|i| center[i] + half * size[i]))
            }
            _ => [[0.0; 3]; 2],
        }
    }
}

fn check_box(block: &AlignedBox, reader: &mut Reader<'_>) {
    let given = [block.low.is_some(), block.high.is_some(), block.center.is_some(), block.size.is_some()];
    if ![[true, true, false, false], [false, false, true, true]].contains(&given) {
        reader.complain_at(&block.at, "a box takes {low, high} or {center, size}");
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
