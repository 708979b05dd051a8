//! What a case must fulfil beyond the form of its blocks, as far as that shows without the mesh.

mod contact;
mod controls;
mod designs;
mod electrodes;
mod motion;
mod variants;

use crate::quantity::Want;
use crate::schema::case::Case;
use crate::schema::cost::Cost;
use crate::schema::electrode::Electrode;
use crate::schema::mesh::MeshSource;
use crate::schema::read::{Read, Reader};
use crate::schema::scenario::{Risk, Scenarios};
use crate::syntax::{At, Value, quoted};
use std::ops::Deref;

/// The version of case files this program reads.
pub(super) const VERSION: f64 = 1.0;

/// The blocks as far as they can be read: a mistake elsewhere does not hide one in what they say of each other.
pub(crate) struct Blocks {
    case: Case,
    pub(crate) scenarios: Option<Scenarios>,
    pub(crate) risk: Option<Risk>,
    /// Paths of problems: what is missing there may be there, misspelt.
    troubled: Vec<String>,
}

impl Deref for Blocks {
    type Target = Case;

    fn deref(&self) -> &Case {
        &self.case
    }
}

/// Adds all problems between blocks to those of `reader`, which has read the whole case already. What could be read, without the entries of lists that cannot;
/// `None` where even the mesh cannot be read.
pub(crate) fn check(reader: &mut Reader<'_>) -> Option<Case> {
    let case = Case::readable(reader)?;
    let troubled = reader.problems.iter().map(|problem| problem.path.clone()).collect();
    let blocks = Blocks { case, scenarios: block(reader, "scenarios"), risk: block(reader, "risk"), troubled };
    check_version(reader);
    check_names(&blocks, reader);
    contact::check(&blocks, reader);
    controls::check(&blocks, reader);
    check_electrodes(&blocks, reader);
    check_designs(&blocks, reader);
    check_risk(&blocks, reader);
    motion::check(&blocks, reader);
    variants::check(&blocks, reader);
    block::<MeshSource>(reader, "mesh").map(|_| blocks.case)
}

impl Blocks {
    /// True if everything in this block could be read.
    fn complete(&self, block: &str) -> bool {
        self.is_sound(&At::root().key(block))
    }

    /// True if everything at this place could be read.
    fn is_sound(&self, at: &At) -> bool {
        let within =
            |path: &str| path.strip_prefix(at.as_str()).is_some_and(|rest| rest.is_empty() || rest.starts_with('/'));
        !self.troubled.iter().any(|path| within(path))
    }
}

fn check_electrodes(blocks: &Blocks, reader: &mut Reader<'_>) {
    if ["controls", "load_cases", "scenarios"].iter().all(|block| blocks.complete(block)) {
        let controls = blocks.controls.iter().chain(blocks.load_cases.iter().flat_map(|case| &case.controls));
        let sound = blocks.actuation.iter().filter_map(Electrode::of).filter(|own| blocks.is_sound(&own.at));
        electrodes::check_driven(sound, controls, reader);
        if blocks.complete("actuation") {
            electrodes::check_body(&blocks.actuation, reader);
        }
    }
}

/// A block without complaints: the full reading makes those.
pub(super) fn block<T: Read>(reader: &Reader<'_>, key: &str) -> Option<T> {
    let mut silent = Reader::new(reader.document, reader.units);
    T::read(reader.document.root().find(key)?, &At::root().key(key), Want::ANY, &mut silent)
}

fn check_version(reader: &mut Reader<'_>) {
    let at = At::root().key("nastic");
    let found = reader.document.root().find(at.as_str()).map(|node| node.value.clone());
    if let Some(Value::Number(found)) = found.filter(|value| *value != Value::Number(VERSION)) {
        reader.complain_at(&at, format!("this program reads version {VERSION} of case files, found {found}"));
    }
}

fn check_names(blocks: &Blocks, reader: &mut Reader<'_>) {
    let empty =
        matches!(reader.document.root().find("materials").map(|n| &n.value), Some(Value::Array(e)) if e.is_empty());
    if empty {
        reader.complain_at(&At::root().key("materials"), "at least one material is needed");
    }
    // those that add to another law stand beside it
    let materials = blocks.materials.iter().filter(|material| !material.law.reinforcing);
    let regions = materials.flat_map(|m| m.region.iter().map(|name| (name, m.at.key("region"))));
    unique(regions, "a material", reader);
    unique(blocks.actuation.iter().map(|a| (a.name.as_str(), a.at.key("name"))), "an actuation", reader);
    unique(blocks.probes.iter().map(|p| (p.name.as_str(), p.at.key("name"))), "a probe", reader);
    unique(blocks.load_cases.iter().map(|c| (c.name.as_str(), c.at.key("name"))), "a load case", reader);
    let actuations = || blocks.actuation.iter().map(|actuation| (actuation.name.as_str(), &actuation.at));
    for (k, material) in blocks.materials.iter().enumerate() {
        let Some(name) = &material.name else { continue };
        let at = material.at.key("name");
        plain(name, &at, &['.', '/'], reader);
        let before = blocks.materials[..k].iter().filter_map(|other| Some((other.name.as_deref()?, &other.at)));
        if let Some((_, first)) = before.chain(actuations()).find(|(other, _)| other == name) {
            reader.complain_at(&at, format!("{} is a name already, at {first}", quoted(name)));
        }
    }
    for actuation in &blocks.actuation {
        plain(&actuation.name, &actuation.at.key("name"), &['.', '/'], reader);
    }
    for row in blocks.blocks() {
        plain(&row.name(), &row.at().key("name"), &['/'], reader);
    }
    for probe in &blocks.probes {
        plain(&probe.name, &probe.at.key("name"), &['/'], reader);
    }
    // results have the distances of several such costs by name beside these
    let distances = blocks.costs.iter().filter(|cost| matches!(cost, Cost::SmoothedHausdorff(_)));
    for cost in distances.filter(|cost| ["smoothed", "true", "self"].contains(&cost.name())) {
        let message = format!("{} is the name of a distance in results; take another one", quoted(cost.name()));
        reader.complain_at(&cost.at().key("name"), message);
    }
    for case in &blocks.load_cases {
        plain(&case.name, &case.at.key("name"), &['/', '\\'], reader);
    }
}

fn check_designs(blocks: &Blocks, reader: &mut Reader<'_>) {
    let mut names: Vec<&str> = Vec::new();
    for design in blocks.designs() {
        if !names.contains(&design.name.as_str()) {
            plain(&design.name, &design.at.key("name"), &['.', '/'], reader);
            names.push(&design.name);
        }
    }
    let shared = || blocks.controls.iter().map(|control| control.of.as_str());
    let own = blocks.load_cases.iter().map(|case| case.controls.iter().map(|control| control.of.as_str()));
    let mut controlled: Vec<Vec<&str>> = own.map(|own| shared().chain(own).collect()).collect();
    if controlled.is_empty() {
        controlled.push(shared().collect());
    }
    let read = ["controls", "load_cases"].iter().all(|block| blocks.complete(block));
    let beside = designs::Beside {
        materials: &blocks.materials,
        are_all: blocks.complete("materials"),
        actuation: &blocks.actuation,
        controlled: read.then_some(controlled),
    };
    designs::check(blocks.designs(), &beside, reader);
}

/// Complains about every name that stood before.
fn unique<'a>(names: impl Iterator<Item = (&'a str, At)>, what: &str, reader: &mut Reader<'_>) {
    let mut seen: Vec<(&str, At)> = Vec::new();
    for (name, at) in names {
        match seen.iter().find(|(other, _)| *other == name) {
            Some((_, first)) => {
                let first = first.parent();
                reader.complain_at(&at, format!("{} has {what} already, at {first}", quoted(name)));
            }
            None => seen.push((name, at)),
        }
    }
}

/// File names have at most 255 bytes, of which what stands beside the name takes some.
const LONGEST_NAME: usize = 100;

/// Complains about signs that would make paths and file names ambiguous, and about names too long for those.
fn plain(name: &str, at: &At, forbidden: &[char], reader: &mut Reader<'_>) {
    if let Some(sign) = name.chars().find(|c| forbidden.contains(c) || c.is_control()) {
        reader.complain_at(at, format!("a name must not contain {}", quoted(&sign.to_string())));
    }
    if name.len() > LONGEST_NAME {
        let message = format!("a name of {} bytes; names of files bear it: at most {LONGEST_NAME}", name.len());
        reader.complain_at(at, message);
    }
}

fn check_risk(blocks: &Blocks, reader: &mut Reader<'_>) {
    let certain = blocks.scenarios.as_ref().is_some_and(Scenarios::is_empty)
        || reader.document.root().find("scenarios").is_none();
    if let Some(risk) = blocks.risk.as_ref().filter(|risk| certain && **risk != Risk::Mean) {
        let message = format!("\"{}\" has no meaning without scenarios", risk.name());
        reader.complain_at(&At::root().key("risk"), message);
    }
    check_rule(blocks, reader);
}

/// Random parameters become scenarios by a rule, or none do.
fn check_rule(blocks: &Blocks, reader: &mut Reader<'_>) {
    let unread = blocks.risk.is_none() && reader.document.root().find("risk").is_some();
    let Some(scenarios) = blocks.scenarios.as_ref().filter(|_| !unread) else { return };
    let first_order = matches!(&blocks.risk, Some(Risk::FirstOrder(_)));
    match scenarios {
        Scenarios::Random(block) if first_order && block.rule.is_some() => {
            let message = "the risk \"first_order\" makes no scenarios: leave \"rule\" out, or take another risk";
            reader.complain_at(&block.at.key("rule"), message);
        }
        Scenarios::Random(block) if !first_order && block.rule.is_none() => {
            let message = "missing key \"rule\": how they become scenarios, as { \"lattice\": 64 }; the risk \"first_order\" alone has none";
            reader.complain_at(&block.at, message);
        }
        Scenarios::List(list) if first_order && !list.is_empty() => {
            let message = "\"first_order\" is about random parameters, \"scenarios\": { \"random\": [...] }, and these are scenarios one by one";
            reader.complain_at(&At::root().key("risk"), message);
        }
        _ => {}
    }
}
