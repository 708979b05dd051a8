//! [`Cut`]: a design cut into a body, with the case and the names that go with it.

use crate::comparison::CarriedGroup;
use crate::error::RemeshError;
use crate::kept_body::KeptBody;
use crate::new_case::{NewCase, new_region};
use crate::optimum::Optimum;
use nastic_mesh::Mesh;
use nastic_result::made_body::{MadeBody, made_parts};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// A cut design before it is meshed.
#[derive(Debug)]
pub(crate) struct Cut {
    pub made: MadeBody,
    pub body: KeptBody,
    /// The volumes of what nothing holds, which is dropped.
    pub islands: Vec<f64>,
    /// The case that goes with it.
    pub case: NewCase,
    /// All texts of that.
    pub names: BTreeSet<String>,
    /// The regions of the old mesh that the case names.
    pub regions: Vec<String>,
}

impl Cut {
    /// Cuts the body where its designs are at their levels and where regions of the case end; also the case that goes with it, and the names that it holds.
    pub fn of(optimum: &Optimum, mesh: &Mesh) -> Result<Self, RemeshError> {
        let problem = &optimum.problem;
        let case = NewCase::of(optimum, &made_parts(problem, &problem.start, 0, &[]))?;
        let mut names = BTreeSet::new();
        names_within(&case.json, &mut names);
        names.extend(case.regions.iter().flat_map(|region| region.within.iter().cloned()));
        let named = mesh.regions().iter().filter(|(name, _)| names.contains(*name));
        let (regions, cells): (Vec<String>, Vec<Vec<u32>>) =
            named.map(|(name, cells)| (name.clone(), cells.clone())).unzip();
        let made = made_parts(problem, &problem.start, 0, &cells);
        let mut body = KeptBody::of(mesh, &made.parts);
        let islands = body.drop_islands(mesh, &held(&problem.document.json(), mesh));
        if made.designs.is_empty() {
            return Err(RemeshError::NoDesign);
        }
        if body.pieces.is_empty() {
            return Err(RemeshError::Empty);
        }
        Ok(Cut { made, body, islands, case, names, regions })
    }

    /// The pieces of all regions of the new mesh: those of the old one that are left, what designs fill, and those that materials need.
    pub fn pieces_of_regions(&self, mesh: &Mesh) -> BTreeMap<String, BTreeSet<u32>> {
        let mut all: BTreeMap<String, BTreeSet<u32>> = BTreeMap::new();
        for (number, piece) in self.body.pieces.iter().enumerate() {
            let (part, number) = (&self.made.parts[piece.part], number as u32);
            let within: Vec<&String> = part.regions.iter().map(|k| &self.regions[*k]).collect();
            let designs = part.names.iter().map(|name| new_region(mesh, name.clone()));
            let made = self.case.regions.iter().filter(|region| region.has(part, &within));
            for name in
                within.iter().map(|name| (*name).clone()).chain(designs).chain(made.map(|region| region.name.clone()))
            {
                all.entry(name).or_default().insert(number);
            }
        }
        all
    }

    /// Complains of groups that the case names and of which nothing is left.
    pub fn refuse_gone(&self, key: &'static str, groups: &BTreeMap<String, CarriedGroup>) -> Result<(), RemeshError> {
        let kind = if key == "surface" { "surface" } else { "node set" };
        for (name, _) in groups.iter().filter(|(_, group)| group.used && group.after <= 0.0) {
            if let Some(at) = place_of(&self.case.json, key, name) {
                return Err(RemeshError::Gone { at, kind, name: name.clone(), islands: self.islands.len() });
            }
        }
        Ok(())
    }
}

/// The nodes that supports hold.
fn held(case: &Value, mesh: &Mesh) -> BTreeSet<u32> {
    let mut nodes = BTreeSet::new();
    for support in case["supports"].as_array().into_iter().flatten() {
        let names = |key: &str| {
            let mut names = BTreeSet::new();
            names_within(&support[key], &mut names);
            names
        };
        for name in names("surface").into_iter().chain(names("nodes")) {
            nodes.extend(mesh.surface(&name).map(|facets| mesh.nodes_of_facets(facets)).unwrap_or_default());
            nodes.extend(mesh.node_set(&name).unwrap_or_default());
        }
        for name in names("region") {
            nodes.extend(mesh.region(&name).map(|cells| mesh.nodes_of_cells(cells)).unwrap_or_default());
        }
    }
    nodes
}

/// All texts within, keys too.
pub(crate) fn names_within(value: &Value, found: &mut BTreeSet<String>) {
    match value {
        Value::String(text) => drop(found.insert(text.clone())),
        Value::Array(all) => all.iter().for_each(|own| names_within(own, found)),
        Value::Object(members) => members.iter().for_each(|(key, own)| {
            found.insert(key.clone());
            names_within(own, found);
        }),
        _ => {}
    }
}

/// Where a key has a name, or a list with it.
fn place_of(value: &Value, key: &str, name: &str) -> Option<String> {
    let below = |step: &str, own: &Value| {
        place_of(own, key, name).map(|rest| if rest.is_empty() { step.to_owned() } else { format!("{step}/{rest}") })
    };
    match value {
        Value::Object(members) => members.iter().find_map(|(own_key, own)| {
            let has = |own: &Value| own == name || own.as_array().is_some_and(|all| all.iter().any(|one| one == name));
            if own_key == key && has(own) { Some(key.to_owned()) } else { below(own_key, own) }
        }),
        Value::Array(all) => all.iter().enumerate().find_map(|(k, own)| below(&k.to_string(), own)),
        _ => None,
    }
}
