//! When controls change, when costs count and when constraints hold, in a motion.

use crate::quantity::Want;
use crate::schema::json::{Definitions, any_of};
use crate::schema::read::{Choice, Read, Reader};
use crate::syntax::{At, Node, Value};
use serde_json::{Value as Json, json};

object! {
    /// A control that changes in time has a value at every knot.
    pub struct InTime {
        /// Time between knots, a whole part of the end.
        pub every: f64 as POSITIVE_TIME,
        /// How it goes from knot to knot.
        pub interpolation: KnotInterpolation = KnotInterpolation::Linear,
    }
}

choice! {
    /// How a control goes from knot to knot.
    pub enum KnotInterpolation {
        /// Linear between values at the knots.
        "linear" => Linear,
        /// One value in every interval between knots; a jump is bridged linearly within the first step of an interval.
        "constant" => Constant,
    }
}

/// The part of a motion over which a cost counts.
#[derive(Clone, PartialEq, Debug)]
pub enum When {
    /// At the end.
    End,
    /// Its integral over the time.
    Integral,
    /// The sum over these instants.
    At(Vec<f64>),
    /// The time in which it lies above about this value, smoothed: the integral of cost/(cost + value).
    TimeAbove(f64),
}

const ABOUT: [(&str, &str); 4] = [
    ("end", "At the end."),
    ("integral", "Its integral over the time."),
    ("at", "The sum over these instants, to which steps lead."),
    (
        "time_above",
        "The integral of cost / (cost + value) over the time: about the time that passes before the cost vanishes.",
    ),
];

const CHOICES: &[Choice] = &[
    Choice { name: ABOUT[0].0, about: ABOUT[0].1, schema: None },
    Choice { name: ABOUT[1].0, about: ABOUT[1].1, schema: None },
    Choice { name: ABOUT[2].0, about: ABOUT[2].1, schema: Some(instants_schema) },
    Choice {
        name: ABOUT[3].0,
        about: ABOUT[3].1,
        schema: Some(|definitions| f64::schema(Want::ANY_POSITIVE, definitions)),
    },
];

impl Read for When {
    fn read(node: &Node, at: &At, _: Want, reader: &mut Reader<'_>) -> Option<Self> {
        let (chosen, value) = reader.choose(node, at, CHOICES)?;
        let at = at.key(chosen);
        match (chosen, value) {
            ("end", _) => Some(Self::End),
            ("integral", _) => Some(Self::Integral),
            ("at", Some(node)) => instants(node, &at, reader).map(Self::At),
            ("time_above", Some(node)) => f64::read(node, &at, Want::ANY_POSITIVE, reader).map(Self::TimeAbove),
            _ => None,
        }
    }

    fn schema(_: Want, definitions: &mut Definitions) -> Json {
        definitions.choice(CHOICES)
    }
}

/// The instants of a motion at which a constraint holds.
#[derive(Clone, PartialEq, Debug)]
pub enum HoldsWhen {
    /// At the end.
    End,
    /// At all instants that controls can change.
    Always,
    /// At these.
    At(Vec<f64>),
}

const HOLDS: &[Choice] = &[
    Choice { name: "end", about: "At the end.", schema: None },
    Choice {
        name: "always",
        about: "At the end of every step, and at t = 0 where the motion begins at an equilibrium.",
        schema: None,
    },
    Choice { name: "at", about: "At these instants, to which steps lead.", schema: Some(instants_schema) },
];

impl Read for HoldsWhen {
    fn read(node: &Node, at: &At, _: Want, reader: &mut Reader<'_>) -> Option<Self> {
        let (chosen, value) = reader.choose(node, at, HOLDS)?;
        match (chosen, value) {
            ("end", _) => Some(Self::End),
            ("always", _) => Some(Self::Always),
            ("at", Some(node)) => instants(node, &at.key(chosen), reader).map(Self::At),
            _ => None,
        }
    }

    fn schema(_: Want, definitions: &mut Definitions) -> Json {
        definitions.choice(HOLDS)
    }
}

fn instants_schema(definitions: &mut Definitions) -> Json {
    let one = f64::schema(Want::NOT_NEGATIVE_TIME, definitions);
    any_of(vec![one.clone(), json!({ "type": "array", "items": one, "minItems": 1 })])
}

/// One instant or several.
fn instants(node: &Node, at: &At, reader: &mut Reader<'_>) -> Option<Vec<f64>> {
    let Value::Array(entries) = &node.value else {
        return f64::read(node, at, Want::NOT_NEGATIVE_TIME, reader).map(|t| vec![t]);
    };
    if entries.is_empty() {
        reader.complain(node, at, "at least one instant is needed");
        return None;
    }
    let read = Vec::<f64>::read(node, at, Want::NOT_NEGATIVE_TIME, reader)?;
    (read.len() == entries.len()).then_some(read)
}
