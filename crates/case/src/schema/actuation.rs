//! The blocks of `actuation`.

use crate::quantity::Want;
use crate::schema::catalogue::{Input, SlotName, form_schema, keys, read_inputs, slot_schema, slots};
use crate::schema::field::{Parameter, VectorField};
use crate::schema::json::Definitions;
use crate::schema::read::{Read, Reader};
use crate::schema::value::described_text;
use crate::syntax::{At, Node};
use nastic_energy::catalogue::ActuationRow;
use serde_json::{Map, Value as Json, json};
use std::collections::BTreeMap;

/// What moves the body from within; kinds and their keys are those of the catalogue.
#[derive(Clone, Debug)]
pub struct Actuation {
    /// Path of this block in the case.
    pub at: At,
    /// Name, by which controls refer to it.
    pub name: String,
    /// Region of the mesh.
    pub region: String,
    /// The kind.
    pub kind: &'static ActuationRow,
    /// Exactly the parameters of one of the kind's forms, in the case's units.
    pub parameters: BTreeMap<&'static str, Input>,
    /// Values of slots ("tension", "field", ...) where they are no controls; zero where absent.
    pub fixed: BTreeMap<&'static str, Fixed>,
}

/// The value of a slot that is no control.
#[derive(Clone, PartialEq, Debug)]
pub enum Fixed {
    /// Of a tension, a pressure.
    Scalar(Parameter),
    /// Of a remanence, a field.
    Vector(VectorField),
}

impl PartialEq for Actuation {
    fn eq(&self, other: &Self) -> bool {
        (&self.at, &self.name, &self.region, self.kind.name) == (&other.at, &other.name, &other.region, other.kind.name)
            && (&self.parameters, &self.fixed) == (&other.parameters, &other.fixed)
    }
}

const NAME: &str = "Name, by which controls refer to it.";
const REGION: &str = "Region of the mesh.";

impl Actuation {
    /// How a control names each slot, and the slot: "NAME" if there is one, otherwise "NAME.field", ...
    pub(crate) fn slots(&self) -> Vec<(String, SlotName)> {
        let slots = slots(self.kind);
        let several = slots.len() > 1;
        let name = |slot: &SlotName| if several { format!("{}.{}", self.name, slot.key) } else { self.name.clone() };
        slots.iter().map(|slot| (name(slot), *slot)).collect()
    }

    /// True if a slot has a fixed value other than zero.
    pub(crate) fn fixes(&self, key: &str) -> bool {
        match self.fixed.get(key) {
            None => false,
            Some(Fixed::Scalar(value)) => value.constant() != Some(0.0),
            Some(Fixed::Vector(value)) => value.constant() != Some([0.0; 3]),
        }
    }
}

impl Read for Actuation {
    fn read(node: &Node, at: &At, _: Want, reader: &mut Reader<'_>) -> Option<Self> {
        let rows = reader.document.catalogue().actuations();
        let kinds: Vec<&str> = rows.iter().map(|kind| kind.name).collect();
        let name: Option<String> = reader.key(node, at, "name", NAME, Want::ANY, None);
        let region: Option<String> = reader.key(node, at, "region", REGION, Want::ANY, None);
        let tag = reader.tag(node, at, "kind", &kinds)?;
        let kind = rows.iter().find(|kind| kind.name == tag)?;
        let slots = slots(kind);
        let members = reader.members(node, at)?;
        let own = keys(kind.forms).into_iter().map(|p| p.name).chain(slots.iter().map(|slot| slot.key));
        let known: Vec<&str> = ["name", "kind", "region"].into_iter().chain(own).collect();
        reader.refuse_unknown(members, at, &known);
        let parameters = read_inputs(kind.name, kind.forms, node, at, reader);
        let mut fixed = BTreeMap::new();
        for slot in slots {
            let member = members.iter().find(|member| member.key == slot.key);
            if let Some(value) = member.and_then(|m| read_fixed(&slot, &m.node, &at.key(slot.key), reader)) {
                fixed.insert(slot.key, value);
            }
        }
        Some(Self { at: at.clone(), name: name?, region: region?, kind, parameters: parameters?, fixed })
    }

    fn schema(_: Want, definitions: &mut Definitions) -> Json {
        definitions.part("Actuation", |definitions| {
            let mut options = Vec::new();
            for kind in definitions.catalogue.clone().actuations() {
                for form in kind.forms {
                    let mut properties = Map::new();
                    properties.insert("name".into(), described_text(NAME));
                    properties.insert("kind".into(), json!({ "const": kind.name }));
                    properties.insert("region".into(), described_text(REGION));
                    for slot in slots(kind) {
                        properties.insert(slot.key.into(), slot_schema(&slot, definitions));
                    }
                    options.push(form_schema(
                        kind.about,
                        properties,
                        vec!["name", "kind", "region"],
                        form,
                        definitions,
                    ));
                }
            }
            json!({ "description": "What moves the body from within.", "oneOf": options })
        })
    }
}

fn read_fixed(slot: &SlotName, node: &Node, at: &At, reader: &mut Reader<'_>) -> Option<Fixed> {
    if slot.vector {
        VectorField::read(node, at, slot.want, reader).map(Fixed::Vector)
    } else {
        Parameter::read(node, at, slot.want, reader).map(Fixed::Scalar)
    }
}
