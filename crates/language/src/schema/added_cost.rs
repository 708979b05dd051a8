//! A term of the cost whose kind a program has added to the catalogue.

use crate::quantity::Want;
use crate::schema::catalogue::{Input, form_schema, keys, read_inputs};
use crate::schema::json::{Definitions, annotated};
use crate::schema::read::{Read, Reader};
use crate::schema::timing::When;
use crate::schema::value::described_text;
use crate::syntax::{At, Node};
use nastic_control::CostForm;
use serde_json::{Map, Value as Json, json};
use std::collections::BTreeMap;

/// A term that the program has added.
#[derive(Clone, Debug)]
pub struct AddedCost {
    /// Path of this block in the case.
    pub at: At,
    /// Name in results; the kind if left out.
    pub name: Option<String>,
    /// The kind.
    pub row: &'static CostForm,
    /// Exactly the parameters of one of the kind's forms, in the case's units.
    pub parameters: BTreeMap<&'static str, Input>,
    /// Factor.
    pub weight: f64,
    /// When it counts in a motion; at the end if left out.
    pub when: Option<When>,
}

impl PartialEq for AddedCost {
    fn eq(&self, other: &Self) -> bool {
        (&self.at, &self.name, self.row.name) == (&other.at, &other.name, other.row.name)
            && (&self.parameters, self.weight, &self.when) == (&other.parameters, other.weight, &other.when)
    }
}

const NAME: &str = "Name in results; the kind if left out.";
const WEIGHT: &str = "Factor.";
const WHEN: &str = "When it counts in a motion; at the end if left out.";

impl AddedCost {
    pub(crate) fn kind(&self) -> &'static str {
        self.row.name
    }

    pub(crate) fn kinds(reader: &Reader<'_>) -> Vec<&'static str> {
        reader.document.catalogue().costs().iter().map(|row| row.name).collect()
    }

    pub(crate) fn read(kind: &str, node: &Node, at: &At, reader: &mut Reader<'_>) -> Option<Self> {
        let row = reader.document.catalogue().costs().iter().find(|row| row.name == kind).copied()?;
        let known: Vec<&str> =
            ["kind", "name", "weight", "when"].into_iter().chain(keys(row.forms).iter().map(|p| p.name)).collect();
        let members = reader.members(node, at)?;
        reader.refuse_unknown(members, at, &known);
        let name: Option<Option<String>> = reader.key(node, at, "name", NAME, Want::ANY, Some(None));
        let weight: Option<f64> = reader.key(node, at, "weight", WEIGHT, Want::ANY_NOT_NEGATIVE, Some(1.0));
        let when: Option<Option<When>> = reader.key(node, at, "when", WHEN, Want::ANY, Some(None));
        let parameters = read_inputs(row.name, row.forms, node, at, reader);
        Some(Self { at: at.clone(), name: name?, row, parameters: parameters?, weight: weight?, when: when? })
    }

    pub(crate) fn schemas(definitions: &mut Definitions) -> Vec<Json> {
        let mut out = Vec::new();
        for row in definitions.catalogue.clone().costs() {
            for form in row.forms {
                let mut properties = Map::new();
                properties.insert("kind".into(), json!({ "const": row.name }));
                properties.insert("name".into(), described_text(NAME));
                properties.insert("weight".into(), f64::schema(Want::ANY_NOT_NEGATIVE, definitions));
                properties.insert("when".into(), annotated(When::schema(Want::ANY, definitions), WHEN, None));
                out.push(form_schema(row.about, properties, vec!["kind"], form, definitions));
            }
        }
        out
    }
}
