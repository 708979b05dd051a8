//! Points of the body: positions, or names of node sets.

use crate::quantity::Want;
use crate::schema::json::{Definitions, any_of};
use crate::schema::read::{Read, Reader};
use crate::schema::value::Vector;
use crate::syntax::{At, Node, Value};
use nastic_fem::BodyPoint;
use serde_json::{Value as Json, json};

/// A list of points of the body; plain numbers in the case's unit of length.
pub(crate) struct BodyPoints(pub(crate) Vec<BodyPoint>);

impl Read for BodyPoints {
    fn read(node: &Node, at: &At, want: Want, reader: &mut Reader<'_>) -> Option<Self> {
        let Value::Array(entries) = &node.value else {
            reader.expected(node, at, "a list of points, [[0, 0, 1], [2, 0, 1]],");
            return None;
        };
        let entries = entries.iter().enumerate();
        let points: Vec<Option<BodyPoint>> =
            entries.map(|(i, entry)| BodyPoint::read(entry, &at.index(i), want, reader)).collect();
        points.into_iter().collect::<Option<_>>().map(Self)
    }

    fn schema(want: Want, definitions: &mut Definitions) -> Json {
        json!({ "type": "array", "items": BodyPoint::schema(want, definitions) })
    }
}

impl Read for BodyPoint {
    fn read(node: &Node, at: &At, want: Want, reader: &mut Reader<'_>) -> Option<Self> {
        match &node.value {
            Value::Text(_) => String::read(node, at, Want::ANY, reader).map(Self::Nodes),
            _ => Vector::read(node, at, want, reader).map(|place| Self::At(place.xyz())),
        }
    }

    fn schema(want: Want, definitions: &mut Definitions) -> Json {
        any_of(vec![Vector::schema(want, definitions), String::schema(Want::ANY, definitions)])
    }
}

/// A point of the body in words.
#[must_use]
pub fn point_in_words(point: &BodyPoint) -> String {
    match point {
        BodyPoint::At([x, y, z]) => format!("({x}, {y}, {z})"),
        BodyPoint::Nodes(name) => format!("\"{name}\""),
    }
}
