//! Directions: unit vectors, or the name of an axis.

use crate::expression::Formula;
use crate::quantity::Want;
use crate::schema::field::VectorField;
use crate::schema::json::{Definitions, annotated, any_of};
use crate::schema::read::{Read, Reader};
use crate::schema::value::Vector;
use crate::syntax::{At, Node, Value};
use serde_json::{Value as Json, json};

/// Words for directions along the axes.
const AXES: [(&str, [f64; 3]); 6] = [
    ("x", [1.0, 0.0, 0.0]),
    ("y", [0.0, 1.0, 0.0]),
    ("z", [0.0, 0.0, 1.0]),
    ("-x", [-1.0, 0.0, 0.0]),
    ("-y", [0.0, -1.0, 0.0]),
    ("-z", [0.0, 0.0, -1.0]),
];

/// A direction that is the same everywhere.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Direction([f64; 3]);

impl Direction {
    /// Its components; a third one left out is zero.
    #[must_use]
    pub fn xyz(&self) -> [f64; 3] {
        self.0
    }

    /// The same as a field.
    pub(crate) fn field(&self) -> VectorField {
        VectorField::Formulas(self.0.map(Formula::number).to_vec())
    }
}

impl Read for Direction {
    fn read(node: &Node, at: &At, want: Want, reader: &mut Reader<'_>) -> Option<Self> {
        match node.value {
            Value::Text(_) => axis(node, at, reader),
            _ => Vector::read(node, at, want, reader).map(|vector| Self(vector.xyz())),
        }
    }

    fn schema(want: Want, definitions: &mut Definitions) -> Json {
        any_of(vec![axes(), Vector::schema(want, definitions)])
    }
}

/// A direction that may vary over the body; its length is not checked.
pub(crate) fn read_field(node: &Node, at: &At, reader: &mut Reader<'_>) -> Option<VectorField> {
    match node.value {
        Value::Text(_) => axis(node, at, reader).map(|direction| direction.field()),
        _ => VectorField::read(node, at, Want::NUMBER, reader),
    }
}

/// The schema of a direction that may vary over the body.
pub(crate) fn field_schema(definitions: &mut Definitions) -> Json {
    let field = VectorField::schema(Want::NUMBER, definitions);
    annotated(any_of(vec![axes(), field]), "Unit vector, or the name of an axis.", None)
}

fn axis(node: &Node, at: &At, reader: &mut Reader<'_>) -> Option<Direction> {
    let word = reader.word(node, at, "direction", &AXES.map(|(word, _)| word))?;
    AXES.iter().find(|(known, _)| *known == word).map(|(_, xyz)| Direction(*xyz))
}

fn axes() -> Json {
    json!({ "enum": AXES.map(|(word, _)| word) })
}
