//! What stands between the unknowns of a control and its field: projection, planes of symmetry.

use crate::number::short;
use crate::quantity::Want;
use crate::schema::direction::Direction;
use crate::schema::json::{Definitions, any_of};
use crate::schema::read::{Read, Reader};
use crate::schema::value::Vector;
use crate::syntax::{At, Node, Value};
use serde_json::{Value as Json, json};

object! {
    /// From grey to black and white: what is below the threshold goes to the lower end, what is above to the upper one.
    pub struct Projection {
        /// Threshold, as a share of the way from the lower end to the upper one.
        pub eta: f64 as NUMBER = 0.5,
        /// How sharply: one number, or one for each stage, which the optimisation goes through one after the other.
        pub sharpness: Sharpness,
    }
}

/// One number, or one for each stage.
#[derive(Clone, PartialEq, Debug)]
pub struct Sharpness(pub Vec<f64>);

impl Read for Sharpness {
    fn read(node: &Node, at: &At, _: Want, reader: &mut Reader<'_>) -> Option<Self> {
        let Value::Array(entries) = &node.value else {
            return f64::read(node, at, Want::POSITIVE, reader).map(|one| Self(vec![one]));
        };
        if entries.is_empty() {
            reader.complain(node, at, "at least one sharpness is needed");
            return None;
        }
        let read = Vec::<f64>::read(node, at, Want::POSITIVE, reader)?;
        if let Some(k) = (1..read.len()).find(|k| read[*k] <= read[*k - 1]) {
            let message = format!("stages become sharper: {} follows {}", short(read[k]), short(read[k - 1]));
            reader.complain(node, &at.index(k), message);
            return None;
        }
        (read.len() == entries.len()).then_some(Self(read))
    }

    fn schema(_: Want, definitions: &mut Definitions) -> Json {
        let one = f64::schema(Want::POSITIVE, definitions);
        any_of(vec![one.clone(), json!({ "type": "array", "items": one, "minItems": 1 })])
    }
}

/// A plane of symmetry.
#[derive(Clone, PartialEq, Debug)]
pub enum SymmetryPlane {
    /// Across an axis, 0 to 2, in the middle of the box around the places of the unknowns.
    Middle(usize),
    /// Anywhere.
    Given(GivenPlane),
}

object! {
    /// A plane by a point and its normal.
    pub struct GivenPlane {
        /// A point of it.
        pub point: Vector as LENGTH,
        /// Its normal.
        pub normal: Direction as NUMBER,
    }
}

const AXES: [&str; 3] = ["x", "y", "z"];

impl Read for SymmetryPlane {
    fn read(node: &Node, at: &At, want: Want, reader: &mut Reader<'_>) -> Option<Self> {
        match node.value {
            Value::Text(_) => {
                let axis = reader.word(node, at, "axis", &AXES)?;
                AXES.iter().position(|known| *known == axis).map(Self::Middle)
            }
            _ => GivenPlane::read(node, at, want, reader).map(Self::Given),
        }
    }

    fn schema(want: Want, definitions: &mut Definitions) -> Json {
        any_of(vec![json!({ "enum": AXES }), GivenPlane::schema(want, definitions)])
    }
}
