//! The blocks of `springs`.

use crate::quantity::Want;
use crate::schema::json::{Definitions, any_of};
use crate::schema::read::{Read, Reader};
use crate::schema::value::Vector;
use crate::syntax::{At, Node, Value};
use nastic_fem::BodyPoint;
use serde_json::Value as Json;

object! {
    /// A linear spring between two points of the body, or from one to a fixed point of space.
    pub struct Spring {
        /// Name in results; "spring" and its number, from 0, if left out.
        pub name: Option<String>,
        /// A point of the reference body, or the name of a node set, whose mean it is.
        pub from: BodyPoint as LENGTH,
        /// The other end: another point of the body, or a fixed point of space.
        pub to: SpringEnd as LENGTH,
        /// Force per elongation.
        pub stiffness: f64 as STIFFNESS,
        /// Rest length; the distance of its ends in the reference body if left out.
        pub length: Option<f64> as NOT_NEGATIVE_LENGTH,
    }
}

object! {
    /// A fixed point of space.
    pub struct Ground {
        /// Where.
        pub ground: Vector as LENGTH,
    }
}

/// The end of a spring.
#[derive(Clone, PartialEq, Debug)]
pub enum SpringEnd {
    /// A point of the body.
    Body(BodyPoint),
    /// A fixed point of space.
    Ground(Ground),
}

impl Spring {
    /// The name in results.
    #[must_use]
    pub fn name(&self) -> String {
        let number = || self.at.as_str().rsplit('/').next().unwrap_or_default().to_owned();
        self.name.clone().unwrap_or_else(|| format!("spring {}", number()))
    }
}

impl Read for SpringEnd {
    fn read(node: &Node, at: &At, want: Want, reader: &mut Reader<'_>) -> Option<Self> {
        match node.value {
            Value::Object(_) => Ground::read(node, at, want, reader).map(Self::Ground),
            _ => BodyPoint::read(node, at, want, reader).map(Self::Body),
        }
    }

    fn schema(want: Want, definitions: &mut Definitions) -> Json {
        any_of(vec![BodyPoint::schema(want, definitions), Ground::schema(want, definitions)])
    }
}
