//! [`Optimum`]: what an optimisation found, read from its output directory.

use crate::error::RemeshError;
use nastic_case::lower::CaseProblem;
use nastic_language::catalogue::Catalogue;
use nastic_language::syntax::Document;
use nastic_run::run::case_of;
use serde_json::{Map, Value, json};
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;

/// Kinds of designs that are 0 or 1 where a body is made.
const MADE: [&str; 3] = ["density", "mixture", "electrode"];

/// The optimum of a design as a case that starts from it: continuation is at its last stage, and costs and constraints of designs that are cut are left out.
#[derive(Debug)]
pub struct Optimum {
    /// The case.
    pub document: Document,
    /// The same, ready to compute; its start is the optimum.
    pub problem: CaseProblem,
    /// The names of designs that are cut.
    pub cut: BTreeSet<String>,
    /// What was left out, in words.
    pub dropped: Vec<String>,
}

impl Optimum {
    /// Of an output directory.
    ///
    /// # Errors
    /// A directory without an optimum, or whose case has changed since.
    pub fn open(catalogue: &Catalogue, directory: &Path) -> Result<Self, RemeshError> {
        let missing = |why: String| RemeshError::NoOptimum { directory: directory.to_owned(), why };
        let file = directory.join("result.json");
        let text =
            std::fs::read_to_string(&file).map_err(|error| missing(format!("it has no result.json ({error})")))?;
        let result: Value = serde_json::from_str(&text).map_err(|source| RemeshError::Json { file, source })?;
        if result["command"] != "optimize" {
            return Err(missing(format!("it has the result of {}", result["command"])));
        }
        let controls = directory.join("controls.json");
        if !controls.is_file() {
            return Err(missing("it has no controls.json, as the optimisation found none".to_owned()));
        }
        let controls = std::path::absolute(&controls).unwrap_or(controls).display().to_string();
        let document = case_of(catalogue, directory)?;
        let (mut case, mut dropped) = (document.json(), Vec::new());
        let cut = made_designs(&case);
        let mut names = cut.clone();
        for_each_block(&mut case, &mut |block| {
            let own = listed(block, "controls").filter(|control| cut.iter().any(|design| control["of"] == **design));
            names.extend(own.filter_map(|control| control["name"].as_str()).map(str::to_owned));
        });
        for_each_block(&mut case, &mut |block| to_optimum(block, &controls, &names, &mut dropped));
        if let Some(case) = case.as_object_mut() {
            case.remove("expect");
        }
        let document = Document::from_json(document.name(), &case).with_catalogue(catalogue);
        let problem = CaseProblem::lower(document.clone(), Arc::default())?;
        Ok(Optimum { document, problem, cut, dropped })
    }
}

/// The names of densities, mixtures and electrodes.
fn made_designs(case: &Value) -> BTreeSet<String> {
    let blocks = ["materials", "actuation"].iter().filter_map(|head| case[*head].as_array()).flatten();
    let designs = blocks.filter_map(|block| block["design"].as_array()).flatten();
    let made = designs.filter(|design| MADE.iter().any(|kind| design["kind"] == *kind));
    made.filter_map(|design| design["name"].as_str()).map(str::to_owned).collect()
}

/// The case itself and its load cases.
pub(crate) fn for_each_block(case: &mut Value, what: &mut dyn FnMut(&mut Map<String, Value>)) {
    let Some(root) = case.as_object_mut() else { return };
    what(root);
    let cases = root.get_mut("load_cases").and_then(Value::as_array_mut).into_iter().flatten();
    cases.filter_map(Value::as_object_mut).for_each(what);
}

fn listed<'a>(block: &'a Map<String, Value>, head: &str) -> impl Iterator<Item = &'a Value> {
    block.get(head).and_then(Value::as_array).into_iter().flatten()
}

/// Controls start from the optimum; what has stages is at the last one; costs of the designs `names` go.
fn to_optimum(block: &mut Map<String, Value>, controls: &str, names: &BTreeSet<String>, dropped: &mut Vec<String>) {
    for control in block.get_mut("controls").and_then(Value::as_array_mut).into_iter().flatten() {
        control["start"] = json!({ "file": controls });
        if let Some(sharpness) = control.pointer_mut("/projection/sharpness") {
            last_of(sharpness);
        }
    }
    for (head, what) in [("costs", "cost"), ("constraints", "constraint")] {
        let Some(Value::Array(all)) = block.get_mut(head) else { continue };
        all.retain(|own| {
            let is_kept = !refers_to(own, names);
            if !is_kept {
                let kind = own["kind"].as_str().or(own["cost"]["kind"].as_str()).unwrap_or_default();
                dropped.push(format!("the {what} \"{kind}\", which is of a design that is cut"));
            }
            is_kept
        });
        for stages in all.iter_mut().filter_map(|own| own.get_mut("stages")) {
            if let Value::Array(stages) = stages {
                stages.drain(..stages.len().saturating_sub(1));
            }
        }
        if all.is_empty() {
            block.remove(head);
        }
    }
}

/// The last entry in the place of a list.
fn last_of(value: &mut Value) {
    if let Some(last) = value.as_array().and_then(|all| all.last()).cloned() {
        *value = last;
    }
}

/// Whether a key "of" within has one of the names.
fn refers_to(value: &Value, names: &BTreeSet<String>) -> bool {
    match value {
        Value::Object(members) => members.iter().any(|(key, own)| {
            key == "of" && own.as_str().is_some_and(|name| names.contains(name)) || refers_to(own, names)
        }),
        Value::Array(all) => all.iter().any(|own| refers_to(own, names)),
        _ => false,
    }
}
