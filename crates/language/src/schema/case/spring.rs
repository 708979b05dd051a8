//! The blocks of `springs`: a row of the case's blocks.

use crate::number::{quantity, short};
use crate::quantity::{Dimension, Units, Want};
use crate::schema::block::{Block, at_rest};
use crate::schema::body_point::point_in_words;
use crate::schema::hints::{Hint, hint};
use crate::schema::json::{Definitions, any_of};
use crate::schema::read::{Read, Reader};
use crate::schema::value::Vector;
use crate::syntax::{At, Node, Value};
use nastic_fem::{BodyPoint, FemError, Solid};
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

const SPRING: &str = "a spring stands in \"springs\": [ { \"from\": [0, 0, 5], \"to\": { \"ground\": [0, 0, 9] }, \
    \"stiffness\": \"2 N/mm\" } ]; an elastic bed of a surface is a \"foundation\" in \"supports\"";

/// What people try in its place, and in it.
pub(super) const HINTS: &[Hint] = &[
    hint("", &["spring", "elastic", "rubber_band"], SPRING),
    hint("supports", &["spring", "springs", "elastic", "stiffness", "k"], SPRING),
    hint("actuation", &["spring", "elastic_band"], SPRING),
    hint("springs", &["k", "constant", "rate", "spring_constant"], "force per elongation stands under \"stiffness\""),
    hint("springs", &["rest_length", "rest", "l0", "natural_length"], "the rest length stands under \"length\""),
    hint(
        "springs",
        &["ground", "points", "ends", "point", "between", "nodes", "surface"],
        "a spring goes \"from\" a point of the body \"to\" another one, or \"to\" a fixed one, { \"ground\": [0, 0, 9] }",
    ),
];

/// Rest lengths that differ so much from the distance of the ends are in another unit.
const REST_APART: f64 = 50.0;

impl Block for Spring {
    fn kind(&self) -> &'static str {
        "spring"
    }

    fn head(&self) -> &'static str {
        "springs"
    }

    fn at(&self) -> &At {
        &self.at
    }

    fn name(&self) -> String {
        let number = || self.at.as_str().rsplit('/').next().unwrap_or_default().to_owned();
        self.name.clone().unwrap_or_else(|| format!("spring {}", number()))
    }

    fn attach(&self, solid: Solid) -> Result<Solid, FemError> {
        let (name, from, stiffness) = (self.name(), self.from.clone(), self.stiffness);
        let built = match &self.to {
            SpringEnd::Body(to) => nastic_fem::Spring::between(&name, from, to.clone(), stiffness),
            SpringEnd::Ground(to) => nastic_fem::Spring::to_ground(&name, from, to.ground.xyz(), stiffness),
        };
        solid.spring(self.length.into_iter().fold(built, nastic_fem::Spring::rest_length))
    }

    fn words(&self, solid: &Solid, units: &Units) -> String {
        let name = self.name();
        let to = match &self.to {
            SpringEnd::Body(to) => point_in_words(to),
            SpringEnd::Ground(to) => format!("the ground at {}", point_in_words(&BodyPoint::At(to.ground.xyz()))),
        };
        let shown = |what: &str, dimension: Dimension| {
            at_rest(solid, &name, what).map_or_else(String::new, |value| quantity(value, dimension, units))
        };
        format!(
            "{name}: from {} to {to}; stiffness {}; rest length {}, force {} where the body is at rest",
            point_in_words(&self.from),
            quantity(self.stiffness, Dimension::STIFFNESS, units),
            shown("rest_length", Dimension::LENGTH),
            shown("force", Dimension::FORCE)
        )
    }

    fn stiffness(&self) -> Option<f64> {
        Some(self.stiffness)
    }

    fn doubt(&self, solid: &Solid, units: &Units) -> Option<(&'static str, String)> {
        let length = self.length.filter(|length| *length > 0.0)?;
        let distance = at_rest(solid, &self.name(), "length").filter(|distance| *distance > 0.0)?;
        let unit = units.length().symbol;
        let (said, apart) = (short(length), short(distance));
        let message =
            format!("a rest length of {said} {unit} where its ends are {apart} {unit} apart: is it in another unit?");
        (!(1.0 / REST_APART..=REST_APART).contains(&(length / distance))).then_some(("length", message))
    }

    fn idle(&self, is_held: &dyn Fn(&BodyPoint) -> bool) -> Option<&'static str> {
        let is_idle = is_held(&self.from)
            && match &self.to {
                SpringEnd::Body(to) => is_held(to),
                SpringEnd::Ground(_) => true,
            };
        is_idle.then_some("both its ends are held: its force ends in the supports and moves nothing")
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
