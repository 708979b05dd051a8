//! The blocks of `materials`.

use crate::quantity::Want;
use crate::schema::catalogue::{Input, SlotName, form_schema, read_inputs, want};
use crate::schema::design::{self, Design, DesignKind, MixedLaw};
use crate::schema::json::Definitions;
use crate::schema::read::{Key, Read, Reader};
use crate::schema::time::{KelvinVoigt, Maxwell};
use crate::syntax::{At, Node};
use nastic_energy::catalogue::{MaterialRow, Takes};
use nastic_fem::Formulation;
use nastic_mesh::GroupNames;
use serde_json::{Value as Json, json};
use std::collections::BTreeMap;

/// A passive law on a region; laws and their keys are those of the catalogue.
#[derive(Clone, Debug)]
pub struct Material {
    /// Path of this block in the case.
    pub at: At,
    /// Name by which controls refer to its numbers.
    pub name: Option<String>,
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
    /// Numbers in front of the law.
    pub design: Vec<Design>,
    /// Exactly the parameters of one of the law's forms, in the case's units.
    pub parameters: BTreeMap<&'static str, Input>,
}

impl PartialEq for Material {
    fn eq(&self, other: &Self) -> bool {
        (&self.at, &self.name, &self.region, self.law.name, self.formulation, self.rigid, &self.parameters)
            == (
                &other.at,
                &other.name,
                &other.region,
                other.law.name,
                other.formulation,
                other.rigid,
                &other.parameters,
            )
            && (self.density, &self.maxwell, &self.kelvin_voigt, &self.design)
                == (other.density, &other.maxwell, &other.kelvin_voigt, &other.design)
    }
}

const NAME: &str = "Name, by which controls refer to its numbers: \"rubber.mu\".";
const REGION: &str = "Region of the mesh.";
const FORMULATION: &str = "How the cells represent changes of volume.";
const RIGID: &str = "Whether the region moves as a rigid body: then its law gives contacts their stiffness alone.";
const DENSITY: &str = "Mass per reference volume, which motions and weight need.";
const MAXWELL: &str = "Maxwell branches beside the law, which relax in motion: a Prony series of the shear modulus.";
const KELVIN_VOIGT: &str = "A dashpot beside the law, which damps motion.";
/// The keys that every law has.
const COMMON: [&str; 9] =
    ["name", "region", "law", "formulation", "rigid", "density", "maxwell", "kelvin_voigt", "design"];

impl Material {
    /// How a control names each number that the law is written with, and the number; none without a name.
    pub fn slots(&self) -> Vec<(String, SlotName)> {
        let Some(name) = &self.name else { return vec![] };
        let slot = |key, want| SlotName { key, want, vector: false, not_negative: false };
        let unit = |key: &str| match self.law.parameters().into_iter().find(|known| known.name == key)?.takes {
            Takes::Number { unit, .. } => Some(unit),
            _ => None,
        };
        let mut out = Vec::new();
        for (key, input) in &self.parameters {
            match input {
                Input::Number(_) => out.push((format!("{name}.{key}"), slot(key, unit(key).map_or(Want::ANY, want)))),
                Input::Numbers(values) => {
                    out.extend(values.keys().map(|own| (format!("{name}.{own}"), slot(key, Want::ANY))));
                }
                _ => {}
            }
        }
        out
    }

    /// Whether mass and weight follow a design, where the material has a mass: a density, and a mixture if the other law, its own or that of one of these, has one too.
    #[must_use]
    pub fn follows(design: &Design, materials: &[Material]) -> bool {
        let of_kind = match &design.kind {
            DesignKind::Density => true,
            DesignKind::Mixture => Self::other_density(design, materials).is_some(),
            _ => false,
        };
        of_kind && design.mass.unwrap_or(true)
    }

    /// The density of the other law of a mixture.
    #[must_use]
    pub fn other_density(design: &Design, materials: &[Material]) -> Option<f64> {
        match design.with.as_ref()? {
            MixedLaw::Law(law) => law.density,
            MixedLaw::Name(name) => materials.iter().find(|own| own.name.as_ref() == Some(name))?.density,
        }
    }

    /// The number that a control of this name is of.
    pub fn number_of<'c>(&self, of: &'c str) -> Option<&'c str> {
        of.strip_prefix(self.name.as_deref()?)?.strip_prefix('.')
    }
}

impl Read for Material {
    fn read(node: &Node, at: &At, _: Want, reader: &mut Reader<'_>) -> Option<Self> {
        let laws = reader.document.catalogue().materials();
        let names: Vec<&str> = laws.iter().map(|law| law.name).collect();
        let own_name: Option<Option<String>> = reader.key(node, at, "name", NAME, Want::ANY, Some(None));
        let region: Option<GroupNames> = reader.key(node, at, "region", REGION, Want::ANY, None);
        let name = reader.tag(node, at, "law", &names)?;
        let law = laws.iter().find(|law| law.name == name)?;
        let known: Vec<&str> = COMMON.into_iter().chain(law.parameters().iter().map(|p| p.name)).collect();
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
        let design = design::read_list(node, at, None, reader);
        Some(Self {
            at: at.clone(),
            name: own_name?,
            region: region?,
            law,
            formulation,
            rigid: rigid?,
            density: density?,
            maxwell: maxwell?,
            kelvin_voigt: kelvin_voigt?,
            design: design?,
            parameters: parameters?,
        })
    }

    fn schema(_: Want, definitions: &mut Definitions) -> Json {
        definitions.part("Material", |definitions| {
            let mut options = Vec::new();
            for law in definitions.catalogue.clone().materials() {
                for form in law.forms {
                    let formulation = definitions.part("Formulation", |_| formulation_schema());
                    let keys = vec![
                        Key::new::<Option<String>>("name", NAME, Want::ANY, Some(None), definitions),
                        Key::new::<GroupNames>("region", REGION, Want::ANY, None, definitions),
                        Key::as_is("law", true, json!({ "const": law.name })),
                        Key::as_is("formulation", false, formulation),
                        Key::new("rigid", RIGID, Want::ANY, Some(false), definitions),
                        Key::new::<Option<f64>>("density", DENSITY, Want::DENSITY, Some(None), definitions),
                        Key::new::<Option<Vec<Maxwell>>>("maxwell", MAXWELL, Want::ANY, Some(None), definitions),
                        Key::new::<Option<KelvinVoigt>>(
                            "kelvin_voigt",
                            KELVIN_VOIGT,
                            Want::ANY,
                            Some(None),
                            definitions,
                        ),
                        design::list_key(definitions),
                    ];
                    options.push(form_schema(law.about, keys, form, definitions));
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
