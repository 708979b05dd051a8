//! A term of the cost whose keys are those of its row in the catalogue.

use crate::quantity::Want;
use crate::schema::json::{Definitions, block_schema};
use crate::schema::key_value::{KeyValue, key_schema, read_value};
use crate::schema::obstacle::ShapeOrName;
use crate::schema::read::{Key, Reader, check_alternatives};
use crate::schema::timing::When;
use crate::syntax::{At, Node};
use nastic_control::{CostForm, Counts, MakeCost, Need};
use serde_json::Value as Json;
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
    pub values: BTreeMap<&'static str, KeyValue>,
    /// Factor.
    pub weight: f64,
    /// When it counts in a motion, where the case says so.
    pub when: Option<When>,
}

impl PartialEq for CostTerm {
    fn eq(&self, other: &Self) -> bool {
        (&self.at, &self.name, self.form.name) == (&other.at, &other.name, other.form.name)
            && (&self.values, self.weight, &self.when) == (&other.values, other.weight, &other.when)
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

    /// The control it is of, where it is of one.
    #[must_use]
    pub fn control(&self) -> Option<&str> {
        self.controls().map(|(name, _)| name).next()
    }

    pub(crate) fn controls(&self) -> impl Iterator<Item = (&str, At)> {
        self.values.iter().filter_map(|(key, value)| match value {
            KeyValue::Control(name) => Some((name.as_str(), self.at.key(key))),
            _ => None,
        })
    }

    pub(crate) fn shapes(&self) -> impl Iterator<Item = (&ShapeOrName, At)> {
        self.values.iter().filter_map(|(key, value)| match value {
            KeyValue::Obstacle(shape) => Some((shape, self.at.key(key))),
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalogue::Catalogue;
    use crate::schema::catalogue::want;
    use nastic_control::KeyKind;
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
                if let KeyKind::Number { unit, .. } = key.kind {
                    assert!(want(unit) != Want::ANY, "{}: {unit}", form.name);
                }
            }
        }
    }
}
