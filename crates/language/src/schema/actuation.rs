//! The blocks of `actuation`.

use crate::quantity::Want;
use crate::schema::catalogue::{Input, SlotName, form_schema, read_inputs, row_schema, slot_names, slot_schema, slots};
use crate::schema::design::{self, Design};
use crate::schema::field::{Parameter, VectorField};
use crate::schema::fixed::Fixed;
use crate::schema::json::Definitions;
use crate::schema::key_value::{KeyValue, key_schema, read_value};
use crate::schema::read::{Key, Read, Reader};
use crate::schema::time_table::TimeTable;
use crate::syntax::{At, Node, Property};
use nastic_energy::ShapeModes;
use nastic_energy::catalogue::ActuationRow;
use nastic_fem::catalogue::{Form, FormValues, KeyKind};
use nastic_mesh::GroupNames;
use serde_json::{Value as Json, json};
use std::collections::BTreeMap;

/// What moves the body; kinds and their keys are those of the catalogues.
#[derive(Clone, Debug)]
pub struct Actuation {
    /// Path of this block in the case.
    pub at: At,
    /// Name, by which controls refer to it.
    pub name: String,
    /// What it is and where.
    pub means: Means,
    /// Values of slots ("tension", "field", ...) where they are no controls; zero where absent.
    pub fixed: BTreeMap<&'static str, Fixed>,
}

/// An actuation is a law of the cells of a region, or a contribution that has a form in case files.
#[derive(Clone, Debug)]
pub enum Means {
    /// A law.
    Law {
        /// Its row.
        row: &'static ActuationRow,
        /// Region of the mesh.
        region: GroupNames,
        /// Exactly the parameters of one of the row's forms, in the case's units.
        parameters: BTreeMap<&'static str, Input>,
        /// Numbers in front of the law.
        design: Vec<Design>,
    },
    /// A contribution.
    Contribution {
        /// Its kind.
        kind: &'static str,
        /// How it stands in case files.
        form: &'static Form,
        /// What its keys say.
        values: FormValues,
    },
}

impl PartialEq for Actuation {
    fn eq(&self, other: &Self) -> bool {
        let same = match (&self.means, &other.means) {
            (
                Means::Law { region, parameters, design, .. },
                Means::Law { region: other_region, parameters: others, design: other_design, .. },
            ) => region == other_region && parameters == others && design == other_design,
            (Means::Contribution { values, .. }, Means::Contribution { values: others, .. }) => values == others,
            _ => false,
        };
        same && (&self.at, &self.name, self.kind(), &self.fixed) == (&other.at, &other.name, other.kind(), &other.fixed)
    }
}

/// The direction of a growth as a control.
const DIRECTION: SlotName = SlotName { key: "direction", want: Want::NUMBER, vector: true, not_negative: false };

const NAME: &str = "Name, by which controls refer to it.";
const REGION: &str = "Region of the mesh.";

impl Actuation {
    /// A contribution that stands in a block of its own.
    pub(crate) fn read_contribution(
        kind: &'static str,
        form: &'static Form,
        node: &Node,
        at: &At,
        reader: &mut Reader<'_>,
    ) -> Option<Self> {
        let name: Option<String> = reader.key(node, at, "name", NAME, Want::ANY, None);
        let read = read_contribution(kind, form, node, at, reader);
        Head { at, name: name?, keys: &["name"] }.finish(read, node, reader)
    }

    /// The kind, as case files name it.
    #[must_use]
    pub fn kind(&self) -> &'static str {
        match &self.means {
            Means::Law { row, .. } => row.name,
            Means::Contribution { kind, .. } => kind,
        }
    }

    /// What it is, in a sentence.
    #[must_use]
    pub fn about(&self) -> &'static str {
        match &self.means {
            Means::Law { row, .. } => row.about,
            Means::Contribution { form, .. } => form.about,
        }
    }

    /// Numbers in front of its law.
    #[must_use]
    pub fn design(&self) -> &[Design] {
        if let Means::Law { design, .. } = &self.means { design } else { &[] }
    }

    /// Whether a flag of it is set.
    pub(crate) fn has_flag(&self, key: &str) -> bool {
        matches!(&self.means, Means::Contribution { values, .. } if values.flags.contains(key))
    }

    /// Whether it acts where nothing drives it.
    pub(crate) fn is_passive(&self) -> bool {
        matches!(&self.means, Means::Contribution { form, .. } if form.passive)
    }

    /// How a control names each slot, and the slot: "NAME" if there is one, or it is the first of those of which one drives; otherwise
    /// "NAME.field", ...
    pub fn slots(&self) -> Vec<(String, SlotName)> {
        let direction = self.direction().map(|name| (name, DIRECTION));
        self.loads().into_iter().chain(direction).collect()
    }

    /// How a control names its direction, where that may be one.
    #[must_use]
    pub fn direction(&self) -> Option<String> {
        let Means::Law { row, .. } = &self.means else { return None };
        let law = row.examples().into_iter().next().and_then(|inputs| row.build(&inputs).ok())?;
        law.with_direction_slots().map(|_| format!("{}.{}", self.name, DIRECTION.key))
    }

    /// The displacement fields of a change of shape, by name.
    #[must_use]
    pub fn modes(&self) -> Option<&BTreeMap<String, VectorField>> {
        let Means::Law { parameters, .. } = &self.means else { return None };
        parameters.values().find_map(|input| if let Input::Modes(modes) = input { Some(modes) } else { None })
    }

    /// Whether each of its slots acts by itself: those of a growth.
    pub(crate) fn has_independent_slots(&self) -> bool {
        let Means::Law { row, .. } = &self.means else { return false };
        let law = row.examples().into_iter().next().and_then(|inputs| row.build(&inputs).ok());
        law.is_some_and(|law| law.strain_map().is_some())
    }

    /// The same of what drives it.
    pub(crate) fn loads(&self) -> Vec<(String, SlotName)> {
        if let Some(modes) = self.modes() {
            let amplitudes = modes.keys().map(|name| ShapeModes::slot(name));
            let own = slot_names(&amplitudes.collect::<Vec<_>>());
            return own.into_iter().map(|slot| (format!("{}.{}", self.name, slot.key), slot)).collect();
        }
        let slots = match &self.means {
            Means::Law { row, .. } => slots(row),
            Means::Contribution { form, .. } => slot_names(form.slots),
        };
        let alone = |k: usize| slots.len() == 1 || (self.has_one_driver() && k == 0);
        let name = |k: usize, slot: &SlotName| match alone(k) {
            true => self.name.clone(),
            false => format!("{}.{}", self.name, slot.key),
        };
        slots.iter().enumerate().map(|(k, slot)| (name(k, slot), *slot)).collect()
    }

    /// Whether one of its slots drives it, and the others follow.
    pub(crate) fn has_one_driver(&self) -> bool {
        matches!(&self.means, Means::Contribution { form, .. } if form.one_of)
    }

    /// True if a slot has a fixed value other than zero.
    pub(crate) fn fixes(&self, key: &str) -> bool {
        match self.fixed.get(key) {
            None => false,
            Some(Fixed::Scalar(value)) => value.constant() != Some(0.0),
            Some(Fixed::Vector(value)) => value.constant() != Some([0.0; 3]),
            Some(Fixed::Table(_)) => true,
        }
    }
}

impl Read for Actuation {
    fn read(node: &Node, at: &At, _: Want, reader: &mut Reader<'_>) -> Option<Self> {
        let catalogue = reader.document.catalogue().clone();
        let laws = catalogue.actuations().iter().map(|row| row.name);
        let mut kinds: Vec<&str> = laws.chain(catalogue.contributions().map(|(kind, _)| kind)).collect();
        kinds.dedup();
        let name: Option<String> = reader.key(node, at, "name", NAME, Want::ANY, None);
        let tag = reader.tag(node, at, "kind", &kinds)?;
        let (means, slots, known) = match catalogue.actuations().iter().find(|row| row.name == tag) {
            Some(row) => read_law(row, node, at, reader),
            None => {
                let members = reader.members(node, at)?;
                let of_kind = catalogue.contributions().filter(|(kind, _)| *kind == tag);
                // The form that was meant has the most of the keys that are there.
                let (kind, form) = of_kind.min_by_key(|(_, form)| strange(form, members))?;
                read_contribution(kind, form, node, at, reader)
            }
        };
        let head = Head { at, name: name?, keys: &["name", "kind"] };
        head.finish((means, slots, known), node, reader)
    }

    fn schema(_: Want, definitions: &mut Definitions) -> Json {
        definitions.part("Actuation", |definitions| {
            let catalogue = definitions.catalogue.clone();
            let mut options = Vec::new();
            for kind in catalogue.actuations() {
                for form in kind.forms {
                    let mut keys = common_keys(kind.name, &slots(kind), definitions);
                    keys.push(Key::new::<GroupNames>("region", REGION, Want::ANY, None, definitions));
                    keys.push(design::list_key(definitions));
                    options.push(form_schema(kind.about, keys, form, definitions));
                }
            }
            for (kind, form) in catalogue.contributions() {
                options.push(contribution_schema(kind, form, definitions));
            }
            json!({ "description": "What moves the body.", "oneOf": options })
        })
    }
}

/// What an entry begins with.
struct Head<'a> {
    at: &'a At,
    name: String,
    keys: &'a [&'static str],
}

impl Head<'_> {
    /// The entry with the fixed values of its slots.
    fn finish(self, keys: ActuationKeys, node: &Node, reader: &mut Reader<'_>) -> Option<Actuation> {
        let (means, slots, known) = keys;
        let Head { at, name, keys } = self;
        let members = reader.members(node, at)?;
        let known: Vec<&str> = keys.iter().copied().chain(known).chain(slots.iter().map(|s| s.key)).collect();
        reader.refuse_unknown(members, at, &known);
        let mut fixed = BTreeMap::new();
        for slot in slots {
            let member = members.iter().find(|member| member.key == slot.key);
            if let Some(value) = member.and_then(|m| read_fixed(&slot, &m.node, &at.key(slot.key), reader)) {
                fixed.insert(slot.key, value);
            }
        }
        Some(Actuation { at: at.clone(), name, means: means?, fixed })
    }
}

/// How many keys of a block are not those of the form.
fn strange(form: &Form, members: &[Property]) -> usize {
    let common = ["name", "kind"].into_iter().chain(form.keys.iter().map(|key| key.name));
    let known: Vec<&str> = common.chain(form.slots.iter().map(|slot| slot.group)).collect();
    members.iter().filter(|member| !known.contains(&member.key.as_str())).count()
}

type ActuationKeys = (Option<Means>, Vec<SlotName>, Vec<&'static str>);

/// A law, its slots, and its keys.
fn read_law(row: &'static ActuationRow, node: &Node, at: &At, reader: &mut Reader<'_>) -> ActuationKeys {
    let region: Option<GroupNames> = reader.key(node, at, "region", REGION, Want::ANY, None);
    let parameters = read_inputs(row.name, row.forms, node, at, reader);
    let design = design::read_list(node, at, Some(row.name), reader);
    let read = region.zip(parameters).zip(design);
    let means = read.map(|((region, parameters), design)| Means::Law { row, region, parameters, design });
    (means, slots(row), row.parameters().into_iter().map(|p| p.name).chain(["region", "design"]).collect())
}

/// A contribution, its slots, and its keys.
fn read_contribution(
    kind: &'static str,
    form: &'static Form,
    node: &Node,
    at: &At,
    reader: &mut Reader<'_>,
) -> ActuationKeys {
    let mut values = FormValues::default();
    let mut complete = true;
    for key in form.keys {
        let value = read_value(key, node, at, reader);
        if matches!(key.kind, KeyKind::Surface | KeyKind::Region | KeyKind::Nodes) {
            values.names.insert(key.name, vec![]);
        }
        complete &= value.is_some();
        if value.flatten().is_some_and(|value| !put(&mut values, key.name, value)) {
            reader.complain(node, &at.key(key.name), "no contribution takes a value of this kind");
            complete = false;
        }
    }
    let means = complete.then_some(Means::Contribution { kind, form, values });
    (means, slot_names(form.slots), form.keys.iter().map(|key| key.name).collect())
}

/// Puts a value where the form finds it; false of what no form takes.
fn put(values: &mut FormValues, key: &'static str, value: KeyValue) -> bool {
    match value {
        KeyValue::Names(names) => values.names.entry(key).or_default().extend(names.iter().map(str::to_owned)),
        KeyValue::Point(place) => values.places.extend([(key, place.xyz())]),
        KeyValue::Points(points) => values.points.extend([(key, points)]),
        KeyValue::Components(fix) => values.components.extend([(key, fix.components())]),
        KeyValue::Flag(flag) => values.flags.extend(flag.then_some(key)),
        KeyValue::Number(number) => values.numbers.extend([(key, number)]),
        _ => return false,
    }
    true
}

/// The keys that every kind has.
fn common_keys(kind: &str, slots: &[SlotName], definitions: &mut Definitions) -> Vec<Key> {
    let name = Key::new::<String>("name", NAME, Want::ANY, None, definitions);
    let slots = slots.iter().map(|slot| slot_schema(slot, definitions));
    [name, Key::as_is("kind", true, json!({ "const": kind }))].into_iter().chain(slots).collect()
}

fn contribution_schema(kind: &str, form: &'static Form, definitions: &mut Definitions) -> Json {
    let mut keys = contribution_keys(form, definitions);
    keys.insert(1, Key::as_is("kind", true, json!({ "const": kind })));
    row_schema(form.about, keys)
}

/// The keys of a contribution but for its kind.
pub(crate) fn contribution_keys(form: &'static Form, definitions: &mut Definitions) -> Vec<Key> {
    let mut keys = vec![Key::new::<String>("name", NAME, Want::ANY, None, definitions)];
    keys.extend(slot_names(form.slots).iter().map(|slot| slot_schema(slot, definitions)));
    keys.extend(form.keys.iter().map(|key| key_schema(key, definitions)));
    keys
}

fn read_fixed(slot: &SlotName, node: &Node, at: &At, reader: &mut Reader<'_>) -> Option<Fixed> {
    if TimeTable::is_named_by(node) {
        return TimeTable::read_for(Some(slot.vector), node, at, reader).map(Fixed::Table);
    }
    if slot.vector {
        VectorField::read(node, at, slot.want.in_time(), reader).map(Fixed::Vector)
    } else {
        Parameter::read(node, at, slot.want.in_time(), reader).map(Fixed::Scalar)
    }
}
