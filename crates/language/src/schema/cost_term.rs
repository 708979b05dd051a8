//! A term of the cost whose keys are those of its row in the catalogue.

use crate::quantity::Want;
use crate::schema::catalogue::want;
use crate::schema::direction::Direction;
use crate::schema::json::{Definitions, any_of, block_schema};
use crate::schema::mesh::MeshSource;
use crate::schema::obstacle::ShapeOrName;
use crate::schema::read::{Key, Read, Reader, check_alternatives};
use crate::schema::target::{Coordinates, Target};
use crate::schema::time_table::TimeTable;
use crate::schema::timing::When;
use crate::schema::value::Vector;
use crate::syntax::{At, Node};
use nastic_control::{CostForm, CostKey, CostTakes, Counts, MakeCost, Need};
use nastic_mesh::GroupNames;
use serde_json::{Value as Json, json};
use std::collections::BTreeMap;

/// A term of the cost whose keys are those of its row.
#[derive(Clone, Debug)]
pub struct CostTerm {
    /// Path of this block in the case.
    pub at: At,
    /// Name in results; the kind if left out.
    pub name: Option<String>,
    /// The row.
    pub form: &'static CostForm,
    /// The values of its keys, in the case's units; those left out without a default are not among them.
    pub values: BTreeMap<&'static str, TermValue>,
    /// Factor.
    pub weight: f64,
    /// When it counts in a motion, where the case says so.
    pub when: Option<When>,
}

/// The value of a key of a term.
#[derive(Clone, PartialEq, Debug)]
pub enum TermValue {
    /// Surfaces, regions or node sets.
    Names(GroupNames),
    /// A point of the body at rest.
    Point(Vector),
    /// A line through points of the body at rest.
    Line(Vec<Vector>),
    /// A direction.
    Direction(Direction),
    /// A number.
    Number(f64),
    /// A whole number of at least 1.
    Count(usize),
    /// One of a few words.
    Word(&'static str),
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

impl PartialEq for CostTerm {
    fn eq(&self, other: &Self) -> bool {
        (&self.at, &self.name, self.form.name) == (&other.at, &other.name, other.form.name)
            && (&self.values, self.weight, &self.when) == (&other.values, other.weight, &other.when)
    }
}

impl TermValue {
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

const NAME: &str = "Name in results; the kind if left out.";
const WEIGHT: &str = "Factor.";

/// What `when` says; nothing of a cost without it.
fn when_of(form: &CostForm) -> Option<&'static str> {
    match form.counts {
        Counts::AtEnd => Some("When it counts in a motion; at the end if left out."),
        Counts::OverTime => Some("When it counts in a motion; over the whole time if left out."),
        Counts::Always => None,
    }
}

/// The keys exactly one of which must be there.
fn alternatives(form: &CostForm) -> Vec<&'static str> {
    form.keys.iter().filter(|key| key.need == Need::OneOf).map(|key| key.name).collect()
}

impl CostTerm {
    pub(crate) fn read(form: &'static CostForm, node: &Node, at: &At, reader: &mut Reader<'_>) -> Option<Self> {
        let members = reader.members(node, at)?;
        let own = form.keys.iter().map(|key| key.name).chain(["weight"]).chain(when_of(form).map(|_| "when"));
        let known: Vec<&str> = ["kind", "name"].into_iter().chain(own).collect();
        reader.refuse_unknown(members, at, &known);
        let fits = check_alternatives(&alternatives(form), node, at, reader);
        let name: Option<Option<String>> = reader.key(node, at, "name", NAME, Want::ANY, Some(None));
        let mut values = BTreeMap::new();
        let mut complete = true;
        for key in form.keys {
            let value = read_value(key, node, at, reader);
            complete &= value.is_some();
            values.extend(value.flatten().map(|value| (key.name, value)));
        }
        let weight: Option<f64> = reader.key(node, at, "weight", WEIGHT, Want::ANY_NOT_NEGATIVE, Some(1.0));
        let when = match when_of(form) {
            Some(about) => reader.key(node, at, "when", about, Want::ANY, Some(None))?,
            None => None,
        };
        let out = Self { at: at.clone(), name: name?, form, values, weight: weight?, when };
        (fits && complete).then_some(out)
    }

    pub(crate) fn schema(form: &'static CostForm, definitions: &mut Definitions) -> Json {
        definitions.part(&part_name(form.name), |definitions| {
            let mut keys = vec![Key::new::<Option<String>>("name", NAME, Want::ANY, Some(None), definitions)];
            keys.extend(form.keys.iter().map(|key| key_schema(key, definitions)));
            keys.push(Key::new("weight", WEIGHT, Want::ANY_NOT_NEGATIVE, Some(1.0), definitions));
            keys.extend(
                when_of(form).map(|about| Key::new::<Option<When>>("when", about, Want::ANY, Some(None), definitions)),
            );
            block_schema(form.about, Some(("kind", form.name)), keys, &alternatives(form))
        })
    }

    pub(crate) fn is_of_motion(&self) -> bool {
        matches!(self.form.make, MakeCost::OfMotion(_))
    }

    pub(crate) fn controls(&self) -> impl Iterator<Item = (&str, At)> {
        self.values.iter().filter_map(|(key, value)| match value {
            TermValue::Control(name) => Some((name.as_str(), self.at.key(key))),
            _ => None,
        })
    }

    pub(crate) fn shapes(&self) -> impl Iterator<Item = (&ShapeOrName, At)> {
        self.values.iter().filter_map(|(key, value)| match value {
            TermValue::Obstacle(shape) => Some((shape, self.at.key(key))),
            _ => None,
        })
    }
}

/// What its block is called in the schema: no other one ends so.
fn part_name(kind: &str) -> String {
    let capital = |word: &str| -> String {
        let (first, rest) = (word.chars().take(1), word.chars().skip(1));
        first.flat_map(char::to_uppercase).chain(rest).collect()
    };
    kind.split('_').map(capital).collect::<String>() + "Cost"
}

/// The value of a key, none where it may be left out and is; `None` after a complaint.
fn read_value(key: &CostKey, node: &Node, at: &At, reader: &mut Reader<'_>) -> Option<Option<TermValue>> {
    let mut place = Keyed { key, node, at, reader };
    match key.takes {
        CostTakes::Surface | CostTakes::Region | CostTakes::Nodes => place.read(Want::ANY, None, TermValue::Names),
        CostTakes::Point => place.read(Want::LENGTH, None, TermValue::Point),
        CostTakes::Line => place.read(Want::LENGTH, None, TermValue::Line),
        CostTakes::Direction => place.read(Want::ANY, None, TermValue::Direction),
        CostTakes::Number { unit, default } => place.read(want(unit), default, TermValue::Number),
        CostTakes::Count { default } => {
            place.read(Want::POSITIVE, default.map(|default| default as usize), TermValue::Count)
        }
        CostTakes::Word { of } => place.read_word(of),
        CostTakes::Position => place.read_position(),
        CostTakes::Target => place.read(Want::ANY, None, TermValue::Target),
        CostTakes::Mesh => place.read(Want::ANY, None, TermValue::Mesh),
        CostTakes::Obstacle => place.read(Want::ANY, None, TermValue::Obstacle),
        CostTakes::Contact => place.read(Want::ANY, None, TermValue::Contact),
        CostTakes::Control => place.read(Want::ANY, None, TermValue::Control),
    }
}

/// A key where it stands.
struct Keyed<'k, 'r, 'd> {
    key: &'k CostKey,
    node: &'k Node,
    at: &'k At,
    reader: &'r mut Reader<'d>,
}

impl Keyed<'_, '_, '_> {
    fn read<T: Read>(&mut self, want: Want, default: Option<T>, make: fn(T) -> TermValue) -> Option<Option<TermValue>> {
        let CostKey { name, about, need, .. } = *self.key;
        match need {
            Need::Required => {
                self.reader.key(self.node, self.at, name, about, want, None).map(|value| Some(make(value)))
            }
            Need::Optional | Need::OneOf => {
                let value: Option<T> = self.reader.key(self.node, self.at, name, about, want, Some(default))?;
                Some(value.map(make))
            }
        }
    }

    /// Coordinates, or a table of them over the time.
    fn read_position(&mut self) -> Option<Option<TermValue>> {
        let CostKey { name, about, need, .. } = *self.key;
        let default = (need != Need::Required).then_some(None);
        self.reader.key_by(self.node, self.at, name, about, default, |node, at, reader| {
            match TimeTable::is_named_by(node) {
                true => TimeTable::read_for_position(Some(true), node, at, reader).map(|t| Some(TermValue::Path(t))),
                false => Box::read(node, at, Want::ANY, reader).map(|position| Some(TermValue::Position(position))),
            }
        })
    }

    fn read_word(&mut self, of: &[&'static str]) -> Option<Option<TermValue>> {
        let CostKey { name, about, need, .. } = *self.key;
        let default = (need != Need::Required).then_some(None);
        self.reader.key_by(self.node, self.at, name, about, default, |node, at, reader| {
            reader.word(node, at, name, of).map(|word| Some(TermValue::Word(word)))
        })
    }
}

/// What the schema says of a key.
fn key_schema(key: &CostKey, definitions: &mut Definitions) -> Key {
    let number = |default: Option<f64>| default.map(Json::from);
    let (schema, default) = match key.takes {
        CostTakes::Surface | CostTakes::Region | CostTakes::Nodes => (GroupNames::schema(Want::ANY, definitions), None),
        CostTakes::Point => (Vector::schema(Want::LENGTH, definitions), None),
        CostTakes::Line => (Vec::<Vector>::schema(Want::LENGTH, definitions), None),
        CostTakes::Direction => (Direction::schema(Want::ANY, definitions), None),
        CostTakes::Number { unit, default } => (f64::schema(want(unit), definitions), number(default)),
        CostTakes::Count { default } => (usize::schema(Want::POSITIVE, definitions), default.map(Json::from)),
        CostTakes::Word { of } => (json!({ "enum": of }), None),
        CostTakes::Position => {
            let forms = vec![Coordinates::schema(Want::ANY, definitions), TimeTable::schema(Want::ANY, definitions)];
            (any_of(forms), None)
        }
        CostTakes::Target => (Target::schema(Want::ANY, definitions), None),
        CostTakes::Mesh => (MeshSource::schema(Want::ANY, definitions), None),
        CostTakes::Obstacle => (ShapeOrName::schema(Want::ANY, definitions), None),
        CostTakes::Contact | CostTakes::Control => (String::schema(Want::ANY, definitions), None),
    };
    let required = key.need == Need::Required;
    Key { name: key.name, about: key.about.to_owned(), required, default, schema }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalogue::Catalogue;
    use std::collections::BTreeSet;

    #[test]
    fn the_keys_of_every_row_are_told_apart_described_and_of_known_dimensions() {
        for form in Catalogue::standard().costs() {
            let names: BTreeSet<&str> =
                form.keys.iter().map(|key| key.name).chain(["kind", "name", "weight", "when"]).collect();
            assert_eq!(names.len(), form.keys.len() + 4, "{}", form.name);
            assert!(form.reported_at.is_none_or(|key| names.contains(key)), "{}", form.name);
            for key in form.keys {
                assert!(key.about.ends_with('.'), "{}: {}", form.name, key.name);
                if let CostTakes::Number { unit, .. } = key.takes {
                    assert!(want(unit) != Want::ANY, "{}: {unit}", form.name);
                }
            }
        }
    }
}
