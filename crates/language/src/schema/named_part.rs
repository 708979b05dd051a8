//! Surfaces and regions by where they are: the blocks `surfaces` and `regions`.

use crate::schema::direction::Direction;
use crate::schema::obstacle::Shape;
use crate::schema::read::Reader;

object! {
    /// A surface of the body by where it is, beside those of its mesh.
    pub struct NamedSurface checked by check_surface {
        /// Its name.
        pub name: String,
        /// Outer facets all of whose nodes lie in this shape.
        pub inside: Option<Shape>,
        /// Outer facets whose normal is within 45 degrees of this direction.
        pub facing: Option<Direction>,
    }
}

object! {
    /// A region of the body by where it is, beside those of its mesh.
    pub struct NamedRegion {
        /// Its name.
        pub name: String,
        /// Cells whose center lies in this shape.
        pub inside: Shape,
    }
}

fn check_surface(surface: &NamedSurface, reader: &mut Reader<'_>) {
    if surface.inside.is_none() && surface.facing.is_none() {
        reader.complain_at(&surface.at, "a surface needs \"inside\", \"facing\" or both");
    }
    if surface.facing.is_some_and(|direction| direction.xyz() == [0.0; 3]) {
        reader.complain_at(&surface.at.key("facing"), "the direction is zero");
    }
}
