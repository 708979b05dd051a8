//! The block `units`.

use crate::quantity::{UNITS, Unit, Units, Want};
use crate::schema::json::{Definitions, annotated, any_of};
use crate::schema::read::{Read, Reader};
use crate::syntax::{At, Node, Value, nearest, quoted};
use serde_json::{Value as Json, json};

object! {
    /// The consistent system of plain numbers, of the mesh and of results; pressures are force / length^2.
    pub struct UnitsBlock {
        /// Unit of length.
        pub length: Unit as LENGTH = Unit::METRE,
        /// Unit of force.
        pub force: Unit as FORCE = Unit::NEWTON,
        /// Unit of time.
        pub time: Unit as TIME = Unit::SECOND,
        /// Unit of the magnetic flux density.
        pub field: Unit as FIELD = Unit::TESLA,
    }
}

impl Read for Units {
    fn absent() -> Option<Self> {
        Some(Self::default())
    }

    fn read(node: &Node, at: &At, want: Want, reader: &mut Reader<'_>) -> Option<Self> {
        if let Value::Text(_) = node.value {
            let length = Unit::read(node, at, Want::LENGTH, reader)?;
            return Self::new(length, Unit::NEWTON, Unit::SECOND, Unit::TESLA);
        }
        let block = UnitsBlock::read(node, at, want, reader)?;
        Self::new(block.length, block.force, block.time, block.field)
    }

    fn schema(want: Want, definitions: &mut Definitions) -> Json {
        let length = annotated(Unit::schema(Want::LENGTH, definitions), "The unit of length, with N, s and T.", None);
        any_of(vec![length, UnitsBlock::schema(want, definitions)])
    }
}

impl Read for Unit {
    fn read(node: &Node, at: &At, want: Want, reader: &mut Reader<'_>) -> Option<Self> {
        let known = symbols(want);
        let Value::Text(text) = &node.value else {
            reader.expected(node, at, &format!("the name of a unit ({})", known.join(", ")));
            return None;
        };
        match (Self::named(text), want.dimension) {
            (Some(unit), Some(wanted)) if unit.dimension != wanted => {
                let list = known.join(", ");
                let found = unit.dimension;
                reader.complain(
                    node,
                    at,
                    format!("unit of the wrong kind: \"{text}\" is {found}, {wanted} is wanted ({list})"),
                );
                None
            }
            (None, _) => {
                let clause = nearest::clause(text, &known);
                reader.complain(node, at, format!("unknown unit {}{clause}", quoted(text)));
                None
            }
            (unit, _) => unit,
        }
    }

    fn schema(want: Want, _: &mut Definitions) -> Json {
        json!({ "enum": symbols(want) })
    }

    fn to_json(&self) -> Option<Json> {
        Some(self.symbol.into())
    }
}

fn symbols(want: Want) -> Vec<&'static str> {
    let fits = |unit: &&Unit| want.dimension.is_none_or(|dimension| unit.dimension == dimension);
    UNITS.iter().filter(fits).map(|unit| unit.symbol).collect()
}
