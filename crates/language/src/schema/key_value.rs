//! Values of the keys of costs and contributions, whose rows say what each takes: one reader, one schema.

use crate::quantity::Want;
use crate::schema::body_point::BodyPoints;
use crate::schema::catalogue::want;
use crate::schema::direction::Direction;
use crate::schema::json::{Definitions, any_of};
use crate::schema::markers::MarkerTable;
use crate::schema::mesh::MeshSource;
use crate::schema::obstacle::ShapeOrName;
use crate::schema::read::{self, Read, Reader};
use crate::schema::support::Fix;
use crate::schema::target::{Coordinates, Target};
use crate::schema::time_table::TimeTable;
use crate::schema::value::Vector;
use crate::syntax::{At, Node};
use nastic_fem::BodyPoint;
use nastic_fem::catalogue::{Key, KeyKind, Need};
use nastic_mesh::GroupNames;
use serde_json::{Value as Json, json};

/// The value of a key of a cost or of a contribution.
#[derive(Clone, PartialEq, Debug)]
pub enum KeyValue {
    /// Surfaces, regions or node sets.
    Names(GroupNames),
    /// A point at rest.
    Point(Vector),
    /// A line through points of the body at rest.
    Line(Vec<Vector>),
    /// Points of the body.
    Points(Vec<BodyPoint>),
    /// A direction.
    Direction(Direction),
    /// Components.
    Components(Fix),
    /// Whether something is so.
    Flag(bool),
    /// A number.
    Number(f64),
    /// A whole number of at least 1.
    Count(usize),
    /// One of a few words.
    Word(&'static str),
    /// Markers that were measured.
    Markers(MarkerTable),
    /// The position of one point.
    Position(Box<Coordinates>),
    /// The same over the time, from a file.
    Path(TimeTable),
    /// Positions of all points.
    Target(Target),
    /// A mesh.
    Mesh(MeshSource),
    /// An obstacle.
    Obstacle(ShapeOrName),
    /// A contact.
    Contact(String),
    /// A control.
    Control(String),
}

impl KeyValue {
    /// Whether it changes in time.
    pub(crate) fn uses_time(&self) -> bool {
        match self {
            Self::Position(position) => position.use_time(),
            Self::Target(target) => target.uses_time(),
            Self::Path(_) => true,
            _ => false,
        }
    }

    /// That at an instant.
    pub(crate) fn at_time(&self, t: f64) -> Self {
        match self {
            Self::Position(position) => Self::Position(Box::new(position.at_time(t))),
            Self::Target(target) => Self::Target(target.at_time(t)),
            other => other.clone(),
        }
    }
}

/// The value of a key, none where it may be left out and is; `None` after a complaint.
pub(crate) fn read_value(key: &Key, node: &Node, at: &At, reader: &mut Reader<'_>) -> Option<Option<KeyValue>> {
    let absent = match key.kind {
        KeyKind::Number { default, .. } => default.map(KeyValue::Number),
        KeyKind::Count { default } => default.map(|default| KeyValue::Count(default as usize)),
        KeyKind::Flag => Some(KeyValue::Flag(false)),
        _ => None,
    };
    let absent = (key.need != Need::Required).then_some(absent);
    reader.key_by(node, at, key.name, key.about, absent, |node, at, reader| given(key, node, at, reader).map(Some))
}

/// The value that a node has.
fn given(key: &Key, node: &Node, at: &At, reader: &mut Reader<'_>) -> Option<KeyValue> {
    match key.kind {
        KeyKind::Surface | KeyKind::Region | KeyKind::Nodes => {
            Read::read(node, at, Want::ANY, reader).map(KeyValue::Names)
        }
        KeyKind::Point => Read::read(node, at, Want::LENGTH, reader).map(KeyValue::Point),
        KeyKind::Line => Read::read(node, at, Want::LENGTH, reader).map(KeyValue::Line),
        KeyKind::Points => BodyPoints::read(node, at, Want::LENGTH, reader).map(|points| KeyValue::Points(points.0)),
        KeyKind::Direction => Read::read(node, at, Want::ANY, reader).map(KeyValue::Direction),
        KeyKind::Components => Read::read(node, at, Want::ANY, reader).map(KeyValue::Components),
        KeyKind::Flag => Read::read(node, at, Want::ANY, reader).map(KeyValue::Flag),
        KeyKind::Number { unit, .. } => Read::read(node, at, want(unit), reader).map(KeyValue::Number),
        KeyKind::Positive { unit } => Read::read(node, at, want(unit).positive(), reader).map(KeyValue::Number),
        KeyKind::Count { .. } => Read::read(node, at, Want::POSITIVE, reader).map(KeyValue::Count),
        KeyKind::Word { of } => reader.word(node, at, key.name, of).map(KeyValue::Word),
        KeyKind::Markers => Read::read(node, at, Want::ANY, reader).map(KeyValue::Markers),
        KeyKind::Position if TimeTable::is_named_by(node) => {
            TimeTable::read_for_position(Some(true), node, at, reader).map(KeyValue::Path)
        }
        KeyKind::Position => Read::read(node, at, Want::ANY, reader).map(KeyValue::Position),
        KeyKind::Target => Read::read(node, at, Want::ANY, reader).map(KeyValue::Target),
        KeyKind::Mesh => Read::read(node, at, Want::ANY, reader).map(KeyValue::Mesh),
        KeyKind::Obstacle => Read::read(node, at, Want::ANY, reader).map(KeyValue::Obstacle),
        KeyKind::Contact => Read::read(node, at, Want::ANY, reader).map(KeyValue::Contact),
        KeyKind::Control => Read::read(node, at, Want::ANY, reader).map(KeyValue::Control),
    }
}

/// What the schema says of a key.
pub(crate) fn key_schema(key: &Key, definitions: &mut Definitions) -> read::Key {
    let number = |default: Option<f64>| default.map(Json::from);
    let required = key.need == Need::Required;
    let (schema, default) = match key.kind {
        KeyKind::Surface | KeyKind::Region | KeyKind::Nodes => (GroupNames::schema(Want::ANY, definitions), None),
        KeyKind::Point => (Vector::schema(Want::LENGTH, definitions), None),
        KeyKind::Line => (Vec::<Vector>::schema(Want::LENGTH, definitions), None),
        KeyKind::Points => (BodyPoints::schema(Want::LENGTH, definitions), None),
        KeyKind::Direction => (Direction::schema(Want::ANY, definitions), None),
        KeyKind::Components => (Fix::schema(Want::ANY, definitions), None),
        KeyKind::Flag => {
            let schema = json!({ "description": key.about, "type": "boolean", "default": false });
            return read::Key::as_is(key.name, required, schema);
        }
        KeyKind::Number { unit, default } => (f64::schema(want(unit), definitions), number(default)),
        KeyKind::Positive { unit } => (f64::schema(want(unit).positive(), definitions), None),
        KeyKind::Count { default } => (usize::schema(Want::POSITIVE, definitions), default.map(Json::from)),
        KeyKind::Word { of } => (json!({ "enum": of }), None),
        KeyKind::Markers => (MarkerTable::schema(Want::ANY, definitions), None),
        KeyKind::Position => {
            let forms = vec![Coordinates::schema(Want::ANY, definitions), TimeTable::schema(Want::ANY, definitions)];
            (any_of(forms), None)
        }
        KeyKind::Target => (Target::schema(Want::ANY, definitions), None),
        KeyKind::Mesh => (MeshSource::schema(Want::ANY, definitions), None),
        KeyKind::Obstacle => (ShapeOrName::schema(Want::ANY, definitions), None),
        KeyKind::Contact | KeyKind::Control => (String::schema(Want::ANY, definitions), None),
    };
    read::Key { name: key.name, about: key.about.to_owned(), required, default, schema }
}
