//! Points of the body and where they were measured.

use crate::quantity::Want;
use crate::schema::json::{Definitions, any_of};
use crate::schema::read::{Read, Reader};
use crate::schema::target::Coordinates;
use crate::schema::value::Vector;
use crate::syntax::{At, Node, Value};
use serde_json::{Value as Json, json};

/// Points of the body and where they were measured.
#[derive(Clone, PartialEq, Debug)]
pub enum MarkerTable {
    /// A CSV file, relative to the case.
    File(String),
    /// Rows in the case itself.
    Rows(Vec<MarkerRow>),
}

object! {
    /// A point of the body and where it was measured.
    pub struct MarkerRow {
        /// Its name in results; its number if left out.
        pub name: Option<String>,
        /// The point of the body, at rest.
        pub point: Vector as LENGTH,
        /// Where it was measured; coordinates left out were not read.
        pub position: Coordinates,
        /// The standard deviation of a coordinate; that of the cost if left out.
        pub deviation: Option<f64> as POSITIVE_LENGTH,
    }
}

impl Read for MarkerTable {
    fn read(node: &Node, at: &At, want: Want, reader: &mut Reader<'_>) -> Option<Self> {
        match &node.value {
            Value::Text(_) => String::read(node, at, Want::ANY, reader).map(Self::File),
            Value::Array(_) => Read::read(node, at, want, reader).map(Self::Rows),
            _ => {
                reader.expected(node, at, "the name of a CSV file, or a list of rows,");
                None
            }
        }
    }

    fn schema(want: Want, definitions: &mut Definitions) -> Json {
        let rows = json!({ "type": "array", "items": MarkerRow::schema(want, definitions) });
        any_of(vec![String::schema(Want::ANY, definitions), rows])
    }
}
