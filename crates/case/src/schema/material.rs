//! The blocks of `materials`.

use crate::quantity::Want;
use crate::schema::catalogue::{Input, form_schema, keys, read_inputs};
use crate::schema::json::{Definitions, annotated};
use crate::schema::read::{Read, Reader};
use crate::syntax::{At, Node};
use nastic_energy::catalogue::MaterialRow;
use nastic_mesh::GroupNames;
use serde_json::{Map, Value as Json, json};
use std::collections::BTreeMap;

/// A passive law on a region; laws and their keys are those of the catalogue.
#[derive(Clone, Debug)]
pub struct Material {
    /// Path of this block in the case.
    pub at: At,
    /// Region of the mesh.
    pub region: GroupNames,
    /// The law.
    pub law: &'static MaterialRow,
    /// Exactly the parameters of one of the law's forms, in the case's units.
    pub parameters: BTreeMap<&'static str, Input>,
}

impl PartialEq for Material {
    fn eq(&self, other: &Self) -> bool {
        (&self.at, &self.region, self.law.name, &self.parameters)
            == (&other.at, &other.region, other.law.name, &other.parameters)
    }
}

const REGION: &str = "Region of the mesh.";

impl Read for Material {
    fn read(node: &Node, at: &At, _: Want, reader: &mut Reader<'_>) -> Option<Self> {
        let laws = reader.document.catalogue().materials();
        let names: Vec<&str> = laws.iter().map(|law| law.name).collect();
        let region: Option<GroupNames> = reader.key(node, at, "region", REGION, Want::ANY, None);
        let name = reader.tag(node, at, "law", &names)?;
        let law = laws.iter().find(|law| law.name == name)?;
        let known: Vec<&str> = ["region", "law"].into_iter().chain(keys(law.forms).iter().map(|p| p.name)).collect();
        let members = reader.members(node, at)?;
        reader.refuse_unknown(members, at, &known);
        let parameters = read_inputs(law.name, law.forms, node, at, reader);
        Some(Self { at: at.clone(), region: region?, law, parameters: parameters? })
    }

    fn schema(_: Want, definitions: &mut Definitions) -> Json {
        definitions.part("Material", |definitions| {
            let mut options = Vec::new();
            for law in definitions.catalogue.clone().materials() {
                for form in law.forms {
                    let mut properties = Map::new();
                    properties
                        .insert("region".into(), annotated(GroupNames::schema(Want::ANY, definitions), REGION, None));
                    properties.insert("law".into(), json!({ "const": law.name }));
                    options.push(form_schema(law.about, properties, vec!["region", "law"], form, definitions));
                }
            }
            json!({ "description": "A passive law on a region.", "oneOf": options })
        })
    }
}
