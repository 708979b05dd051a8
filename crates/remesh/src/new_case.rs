//! [`NewCase`]: the case of a cut design, for a mesh of its own.

use crate::error::RemeshError;
use crate::optimum::{Optimum, for_each_block};
use nastic_case::lower::ControlField;
use nastic_control::{ControlBlock, Space};
use nastic_language::schema::{DesignKind, Material};
use nastic_mesh::Mesh;
use nastic_result::made_body::{MadeBody, MadePart};
use serde_json::{Map, Value, json};
use std::collections::{BTreeMap, BTreeSet};

/// Its name.
pub(crate) const CASE: &str = "case.json";
/// Values of controls that do not vary over cells.
pub(crate) const CONTROLS: &str = "controls.json";
/// Fields on the new mesh.
pub(crate) const FIELDS: &str = "fields.vtu";
/// Keys of a control that have no meaning where its values are those behind them.
const CHAIN: [&str; 7] = ["filter", "projection", "cut", "least_bar", "least_gap", "symmetry", "fixed"];

/// A region of the new mesh that the old one does not have.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct MadeRegion {
    pub name: String,
    /// It lies in these regions of the old mesh.
    pub within: Vec<String>,
    /// The design that is above its level there; `None` where none of `mixed` is.
    pub above: Option<String>,
    /// The designs that divide the regions, the last one that is above its level counts.
    pub mixed: Vec<String>,
    /// Designs that are above their levels there, whatever the others.
    pub needs: Vec<String>,
}

impl MadeRegion {
    /// Whether a part that lies in these regions belongs to it.
    pub fn has(&self, part: &MadePart, within: &[&String]) -> bool {
        self.within.iter().any(|name| within.contains(&name))
            && winner(&self.mixed, &part.second) == self.above.as_ref()
            && self.needs.iter().all(|design| part.second.contains(design))
    }
}

/// A field of an array of the new [`FIELDS`].
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum FieldSource {
    /// Values of a control by cell or node of the old mesh, with so many components.
    Control { values: Vec<f64>, components: usize, by_node: bool },
    /// An array of a file.
    File { file: String, array: String },
}

/// The case of a cut design.
#[derive(Debug)]
pub(crate) struct NewCase {
    pub json: Value,
    pub regions: Vec<MadeRegion>,
    /// The fields of the new mesh, by the names of their arrays.
    pub fields: BTreeMap<String, FieldSource>,
    /// What became of it, in words.
    pub told: Vec<String>,
}

impl NewCase {
    /// The case of an optimum.
    pub fn of(optimum: &Optimum, made: &MadeBody) -> Result<Self, RemeshError> {
        let mut case = NewCase {
            json: optimum.document.json(),
            regions: Vec::new(),
            fields: BTreeMap::new(),
            told: optimum.dropped.iter().map(|what| format!("left out: {what}")).collect(),
        };
        refuse_scenarios(&case.json)?;
        let document = &optimum.document;
        let read: BTreeSet<_> = optimum.problem.files.iter().filter_map(|file| file.canonicalize().ok()).collect();
        let absolute = |text: &str| {
            let file = document.resolve(text).canonicalize().ok().filter(|file| read.contains(file));
            file.map(|file| file.display().to_string())
        };
        case.fields.extend(rebase(&mut case.json, &absolute));
        case.set_controls(optimum, made)?;
        case.set_materials(optimum, made);
        case.set_actuation(optimum, made);
        if let Some(root) = case.json.as_object_mut() {
            for key in ["surfaces", "regions"] {
                root.remove(key);
            }
            if root.remove("media").is_some() {
                case.told.push("left out: the media, as there is no void".to_owned());
            }
            let title = root.get("title").and_then(Value::as_str).unwrap_or("A design").to_owned();
            root.insert("title".to_owned(), json!(title + ", meshed along its outline"));
            root.insert("mesh".to_owned(), json!(crate::gmsh::MESH));
            root.insert("output".to_owned(), json!({ "directory": "solved" }));
        }
        Ok(case)
    }

    /// Removes what is cut; all others start from the values that they had.
    fn set_controls(&mut self, optimum: &Optimum, made: &MadeBody) -> Result<(), RemeshError> {
        let problem = &optimum.problem;
        for (block, field) in problem.ensemble.blocks().iter().zip(&problem.controls) {
            let member = problem.member(block.owner);
            let own = &member.layout().blocks()[block.field];
            let pointer = format!("/{}", field.at.as_str());
            let Some(control) = self.json.pointer_mut(&pointer) else { continue };
            let of = control["of"].as_str().unwrap_or_default().to_owned();
            if optimum.cut.contains(&of) {
                if !made.designs.iter().any(|design| design.name == field.name) {
                    return Err(not_carried(
                        field,
                        "it is not cut: it is of a load case alone, in time or not over cells",
                    ));
                }
                *control = Value::Null;
                continue;
            }
            if self.json["actuation"].as_array().into_iter().flatten().any(|actuation| {
                let is_shape = actuation["kind"].as_str().is_some_and(|kind| kind.ends_with("shape"));
                is_shape
                    && actuation["name"].as_str().is_some_and(|name| of == name || of.starts_with(&format!("{name}.")))
            }) {
                return Err(not_carried(
                    field,
                    "it moves the drawn body, and the new mesh is of the body as it is drawn; take it out of the case, or move the mesh",
                ));
            }
            let Some(control) = self.json.pointer_mut(&pointer).and_then(Value::as_object_mut) else { continue };
            let is_few = matches!(own.basis.space(), Space::Uniform)
                || own.basis.space() == Space::Region && own.knots.is_some();
            if is_few {
                control.insert("start".to_owned(), json!({ "file": CONTROLS }));
                continue;
            }
            if own.basis.is_of_contribution() || own.knots.is_some() {
                return Err(not_carried(
                    field,
                    "it varies over facets, or over cells and in time: make it \"uniform\"",
                ));
            }
            let array = field.name.replace(|c: char| !c.is_alphanumeric(), "_");
            control.insert("start".to_owned(), json!({ "file": FIELDS, "array": array }));
            CHAIN.iter().for_each(|key| {
                control.remove(*key);
            });
            if matches!(own.basis.space(), Space::Grid(_)) {
                control.insert("space".to_owned(), json!("cell"));
            }
            self.fields.insert(array, values(optimum, own, block.of(&problem.start), block.owner));
        }
        for_each_block(&mut self.json, &mut |block| {
            if let Some(Value::Array(all)) = block.get_mut("controls") {
                all.retain(|control| !control.is_null());
                if all.is_empty() {
                    block.remove("controls");
                }
            }
        });
        Ok(())
    }

    /// Materials without designs that are cut: of a mixture one for each law, the second ones behind all others.
    fn set_materials(&mut self, optimum: &Optimum, made: &MadeBody) {
        let (all, mesh) = (self.json["materials"].clone(), optimum.problem.mesh());
        let mut further = Vec::new();
        for (k, material) in optimum.problem.case.materials.iter().enumerate() {
            let block = &mut self.json["materials"][k];
            let Some(own) = block.as_object_mut() else { continue };
            remove_designs(own, &optimum.cut);
            if own.get("formulation") == Some(&json!("linear_dilatation")) {
                own.insert("formulation".to_owned(), json!("mean_dilatation"));
                self.told.push(format!("materials/{k}/formulation: \"mean_dilatation\", as triangles and tetrahedra have no \"linear_dilatation\""));
            }
            let mixed: Vec<String> = material
                .design
                .iter()
                .filter(|design| design.kind == DesignKind::Mixture && optimum.cut.contains(&design.name))
                .map(|design| design.name.clone())
                .collect();
            let within: Vec<String> = material.region.iter().map(ToString::to_string).collect();
            let has = |above: Option<&String>| made.parts.iter().any(|part| winner(&mixed, &part.second) == above);
            let called = material.name.clone().unwrap_or_else(|| within.join("_"));
            let mut blocks = Vec::new();
            for above in
                std::iter::once(None).chain(mixed.iter().map(Some)).filter(|above| !mixed.is_empty() && has(*above))
            {
                let name = new_region(mesh, format!("{called}_{}", above.map_or("rest", String::as_str)));
                let first = self.json["materials"][k].clone();
                let mut made =
                    above.map_or(first.clone(), |above| other_material(&all[k], &first, above, &all, material));
                made["region"] = json!(name);
                self.regions.push(MadeRegion {
                    name,
                    within: within.clone(),
                    above: above.cloned(),
                    mixed: mixed.clone(),
                    needs: Vec::new(),
                });
                blocks.push(made);
            }
            let mut blocks = blocks.into_iter();
            if let Some(first) = blocks.next() {
                self.json["materials"][k] = first;
                further.extend(blocks);
            }
        }
        if let Some(materials) = self.json["materials"].as_array_mut() {
            materials.extend(further);
        }
    }

    /// Actuations act where mixtures and electrodes in front of them are above their levels; a density is 1 wherever there is a body.
    fn set_actuation(&mut self, optimum: &Optimum, made: &MadeBody) {
        for block in self.json.get_mut("actuation").and_then(Value::as_array_mut).into_iter().flatten() {
            let designs = block["design"].as_array().into_iter().flatten().filter_map(|design| design["name"].as_str());
            let is_mixed = |name: &&str| made.parts.iter().any(|part| part.mixed.iter().any(|own| own == name));
            let needs: Vec<String> = designs.filter(is_mixed).map(str::to_owned).collect();
            let within = match &block["region"] {
                Value::String(name) => vec![name.clone()],
                names => names.as_array().into_iter().flatten().filter_map(Value::as_str).map(str::to_owned).collect(),
            };
            let name = block["name"].as_str().unwrap_or("actuation");
            let name = new_region(optimum.problem.mesh(), format!("{name}_{}", needs.join("_")));
            let Some(own) = block.as_object_mut() else { continue };
            remove_designs(own, &optimum.cut);
            if !needs.is_empty() {
                own.insert("region".to_owned(), json!(name));
                self.regions.push(MadeRegion { name, within, above: None, mixed: Vec::new(), needs });
            }
        }
    }
}

/// A name that no region of the old mesh has.
pub(crate) fn new_region(mesh: &Mesh, mut name: String) -> String {
    while mesh.regions().contains_key(&name) {
        name += "_cut";
    }
    name
}

/// The last of some designs that is above its level.
fn winner<'a>(mixed: &'a [String], above: &[String]) -> Option<&'a String> {
    mixed.iter().rev().find(|design| above.contains(design))
}

/// The values of a control behind its filter and projection, by cell or node of the old mesh.
fn values(optimum: &Optimum, own: &ControlBlock, m: &[f64], owner: usize) -> FieldSource {
    let solid = optimum.problem.member(owner).solid();
    let (n, values, disc) = (own.components, own.values_of(m), solid.discretization());
    if own.basis.space() == Space::Node {
        let mut nodal = vec![0.0; disc.mesh().points().len() * n];
        for (value, node) in values.chunks_exact(n).zip(own.basis.entities()) {
            nodal[*node as usize * n..][..n].copy_from_slice(value);
        }
        return FieldSource::Control { values: nodal, components: n, by_node: true };
    }
    let by_cell = disc.cell_average(&own.basis.values(&values, n), n);
    FieldSource::Control { values: by_cell, components: n, by_node: false }
}

fn remove_designs(block: &mut Map<String, Value>, cut: &BTreeSet<String>) {
    let Some(Value::Array(all)) = block.get_mut("design") else { return };
    all.retain(|design| design["name"].as_str().is_none_or(|name| !cut.contains(name)));
    if all.is_empty() {
        block.remove("design");
    }
}

/// The second law of a mixture as a material.
fn other_material(original: &Value, first: &Value, above: &str, all: &Value, material: &Material) -> Value {
    let design = original["design"].as_array().into_iter().flatten().find(|design| design["name"] == above);
    let with = design.map_or(&Value::Null, |design| &design["with"]);
    let named = all.as_array().into_iter().flatten().find(|other| with.is_string() && other["name"] == *with);
    let mut made = named.unwrap_or(with).clone();
    let Some(own) = made.as_object_mut() else { return made };
    ["name", "design", "rigid", "maxwell", "kelvin_voigt"].iter().for_each(|key| {
        own.remove(*key);
    });
    if let Some(formulation) = first.get("formulation") {
        own.insert("formulation".to_owned(), formulation.clone());
    }
    let has_own_mass = design.is_some_and(|design| design["mass"] != false) && own.contains_key("density");
    match (has_own_mass, first.get("density")) {
        (false, Some(density)) => drop(own.insert("density".to_owned(), density.clone())),
        (false, None) => drop(own.remove("density")),
        _ => {}
    }
    if let Some(name) = &material.name {
        own.insert("name".to_owned(), json!(format!("{name}_{above}")));
    }
    made
}

fn not_carried(field: &ControlField, why: &str) -> RemeshError {
    RemeshError::NotCarried {
        at: field.at.to_string(),
        what: format!("the control \"{}\"", field.name),
        why: why.to_owned(),
    }
}

/// Scenarios that change what is no more, or stands elsewhere.
fn refuse_scenarios(case: &Value) -> Result<(), RemeshError> {
    let blocks = ["scenarios", "load_cases"].iter().filter_map(|head| case[*head].as_array().map(|all| (head, all)));
    for (head, k, key) in blocks.flat_map(|(head, all)| {
        let keys = |(k, block): (usize, &Value)| {
            block["set"]
                .as_object()
                .into_iter()
                .flat_map(|set| set.keys().cloned())
                .map(move |key| (k, key))
                .collect::<Vec<_>>()
        };
        all.iter().enumerate().flat_map(keys).map(move |(k, key)| (head, k, key))
    }) {
        let is_of_mesh = ["controls/", "costs/", "constraints/", "mesh", "regions", "surfaces"]
            .iter()
            .any(|start| key.starts_with(start));
        if is_of_mesh || key.contains("/design") {
            let at = format!("{head}/{k}/set/{key}");
            let why = "what it changes is replaced, or stands elsewhere in the new case".to_owned();
            return Err(RemeshError::NotCarried { at, what: "this change".to_owned(), why });
        }
    }
    Ok(())
}

/// Names files by their absolute paths, and arrays on the old mesh by those that stand for them on the new one: these.
fn rebase(value: &mut Value, absolute: &dyn Fn(&str) -> Option<String>) -> BTreeMap<String, FieldSource> {
    let mut found = BTreeMap::new();
    rebase_into(value, absolute, &mut found);
    found
}

fn rebase_into(
    value: &mut Value,
    absolute: &dyn Fn(&str) -> Option<String>,
    found: &mut BTreeMap<String, FieldSource>,
) {
    match value {
        Value::Object(members) => {
            let array = members.get("array").and_then(Value::as_str).map(str::to_owned);
            let file = members.get("file").and_then(Value::as_str).and_then(absolute);
            if let (Some(array), Some(file)) = (array, file) {
                let name = format!("array_{}_{array}", found.len());
                found.insert(name.clone(), FieldSource::File { file, array });
                members.insert("file".to_owned(), json!(FIELDS));
                members.insert("array".to_owned(), json!(name));
                return;
            }
            members.values_mut().for_each(|own| rebase_into(own, absolute, found));
        }
        Value::Array(all) => all.iter_mut().for_each(|own| rebase_into(own, absolute, found)),
        Value::String(text) => {
            if let Some(file) = absolute(text) {
                *text = file;
            }
        }
        _ => {}
    }
}
