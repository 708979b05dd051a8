//! The blocks of `materials`.

use crate::quantity::Want;
use crate::schema::catalogue::{Input, form_schema, keys, read_inputs};
use crate::schema::json::{Definitions, annotated};
use crate::schema::read::{Read, Reader};
use crate::schema::time::{KelvinVoigt, Maxwell};
use crate::syntax::{At, Node};
use nastic_energy::catalogue::MaterialRow;
use nastic_fem::Formulation;
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
    /// How the cells represent changes of volume; where none is named, that of another law on them, or the standard one.
    pub formulation: Option<Formulation>,
    /// Whether the region moves as a rigid body.
    pub rigid: bool,
    /// Mass per reference volume, which motions and weight need.
    pub density: Option<f64>,
    /// Maxwell branches beside the law, in motion.
    pub maxwell: Vec<Maxwell>,
    /// A dashpot beside the law, in motion.
    pub kelvin_voigt: Option<KelvinVoigt>,
    /// Exactly the parameters of one of the law's forms, in the case's units.
    pub parameters: BTreeMap<&'static str, Input>,
}

impl PartialEq for Material {
    fn eq(&self, other: &Self) -> bool {
        (&self.at, &self.region, self.law.name, self.formulation, self.rigid, &self.parameters)
            == (&other.at, &other.region, other.law.name, other.formulation, other.rigid, &other.parameters)
            && (self.density, &self.maxwell, &self.kelvin_voigt) == (other.density, &other.maxwell, &other.kelvin_voigt)
    }
}

const REGION: &str = "Region of the mesh.";
const FORMULATION: &str = "How the cells represent changes of volume.";
const RIGID: &str = "Whether the region moves as a rigid body: then its law gives contacts their stiffness alone.";
const DENSITY: &str = "Mass per reference volume, which motions and weight need.";
const MAXWELL: &str = "Maxwell branches beside the law, which relax in motion: a Prony series of the shear modulus.";
const KELVIN_VOIGT: &str = "A dashpot beside the law, which damps motion.";
/// The keys that every law has.
const COMMON: [&str; 7] = ["region", "law", "formulation", "rigid", "density", "maxwell", "kelvin_voigt"];

impl Read for Material {
    fn read(node: &Node, at: &At, _: Want, reader: &mut Reader<'_>) -> Option<Self> {
        let laws = reader.document.catalogue().materials();
        let names: Vec<&str> = laws.iter().map(|law| law.name).collect();
        let region: Option<GroupNames> = reader.key(node, at, "region", REGION, Want::ANY, None);
        let name = reader.tag(node, at, "law", &names)?;
        let law = laws.iter().find(|law| law.name == name)?;
        let known: Vec<&str> = COMMON.into_iter().chain(keys(law.forms).iter().map(|p| p.name)).collect();
        let members = reader.members(node, at)?;
        reader.refuse_unknown(members, at, &known);
        let parameters = read_inputs(law.name, law.forms, node, at, reader);
        let formulation = match members.iter().find(|member| member.key == "formulation") {
            Some(member) => Some(read_formulation(&member.node, &at.key("formulation"), reader)?),
            None => None,
        };
        let rigid: Option<bool> = reader.key(node, at, "rigid", RIGID, Want::ANY, Some(false));
        let density: Option<Option<f64>> = reader.key(node, at, "density", DENSITY, Want::DENSITY, Some(None));
        let maxwell: Option<Vec<Maxwell>> = reader.key(node, at, "maxwell", MAXWELL, Want::ANY, Some(vec![]));
        let kelvin_voigt: Option<Option<KelvinVoigt>> =
            reader.key(node, at, "kelvin_voigt", KELVIN_VOIGT, Want::ANY, Some(None));
        Some(Self {
            at: at.clone(),
            region: region?,
            law,
            formulation,
            rigid: rigid?,
            density: density?,
            maxwell: maxwell?,
            kelvin_voigt: kelvin_voigt?,
            parameters: parameters?,
        })
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
                    properties.insert("formulation".into(), definitions.part("Formulation", |_| formulation_schema()));
                    let rigid = bool::schema(Want::ANY, definitions);
                    properties.insert("rigid".into(), annotated(rigid, RIGID, Some(false.into())));
                    let density = f64::schema(Want::DENSITY, definitions);
                    properties.insert("density".into(), annotated(density, DENSITY, None));
                    let maxwell = Vec::<Maxwell>::schema(Want::ANY, definitions);
                    properties.insert("maxwell".into(), annotated(maxwell, MAXWELL, None));
                    let kelvin_voigt = KelvinVoigt::schema(Want::ANY, definitions);
                    properties.insert("kelvin_voigt".into(), annotated(kelvin_voigt, KELVIN_VOIGT, None));
                    options.push(form_schema(law.about, properties, vec!["region", "law"], form, definitions));
                }
            }
            json!({ "description": "A passive law on a region.", "oneOf": options })
        })
    }
}

fn read_formulation(node: &Node, at: &At, reader: &mut Reader<'_>) -> Option<Formulation> {
    let name = reader.word(node, at, "formulation", &Formulation::ALL.map(Formulation::name))?;
    Formulation::ALL.into_iter().find(|formulation| formulation.name() == name)
}

fn formulation_schema() -> Json {
    let word = |formulation: Formulation| {
        let kinds: Vec<&str> = formulation.kinds().iter().map(|kind| kind.name()).collect();
        let about = format!("{} Elements: {}.", formulation.about(), kinds.join(", "));
        json!({ "const": formulation.name(), "description": about })
    };
    let default = Formulation::default().name();
    json!({ "description": FORMULATION, "oneOf": Formulation::ALL.map(word), "default": default })
}
