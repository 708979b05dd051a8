//! Scenarios and load cases: each must be a correct case with its own values.

use crate::schema::case::Case;
use crate::schema::check::Blocks;
use crate::schema::read::Reader;
use crate::schema::scenario::{RandomParameter, Scenarios};
use crate::syntax::{Document, Node, Setting, Value};

/// Reads every variant and adds what is wrong with it; problems it shares with the case itself count once.
pub(super) fn check(blocks: &Blocks, reader: &mut Reader<'_>) {
    let base = reader.document.without(&["scenarios", "load_cases", "risk", "expect"]);
    for settings in variants(blocks, reader.document) {
        match base.with(&settings) {
            Err(problems) => reader.problems.extend(problems.list().iter().cloned()),
            Ok(variant) => {
                let mut own = Case::reader(&variant, reader.units);
                Case::read_document(&mut own);
                reader.problems.extend(own.problems);
            }
        }
    }
}

/// All paths that some variant sets.
pub(super) fn paths(blocks: &Blocks) -> impl Iterator<Item = &str> {
    let listed = match &blocks.scenarios {
        Some(Scenarios::List(list)) => list.as_slice(),
        _ => &[],
    };
    let random = match &blocks.scenarios {
        Some(Scenarios::Random(random)) => random.random.as_slice(),
        _ => &[],
    };
    let settings = blocks.load_cases.iter().map(|case| &case.set).chain(listed.iter().map(|scenario| &scenario.set));
    let settings = settings.flat_map(|set| set.0.iter().map(|setting| setting.path.as_str()));
    settings.chain(random.iter().map(|parameter| parameter.path.as_str()))
}

fn variants(blocks: &Blocks, document: &Document) -> Vec<Vec<Setting>> {
    let mut out: Vec<Vec<Setting>> = blocks.load_cases.iter().map(|case| case.set.0.clone()).collect();
    match &blocks.scenarios {
        Some(Scenarios::List(list)) => out.extend(list.iter().map(|scenario| scenario.set.0.clone())),
        Some(Scenarios::Random(random)) => {
            out.push(random.random.iter().filter_map(|parameter| typical(parameter, document)).collect());
        }
        None => {}
    }
    out.retain(|settings| !settings.is_empty());
    out
}

/// A random parameter at a value it may well have, so that its path and unit are checked.
fn typical(parameter: &RandomParameter, document: &Document) -> Option<Setting> {
    let written = ["gamma/mean", "lognormal/mean", "uniform/lower"];
    let written = written.iter().find_map(|key| document.root().find(parameter.at.key(key).as_str()));
    let node = match (written, &parameter.beta) {
        (Some(node), _) => node.clone(),
        (None, Some(law)) => {
            let place = document.root().find(parameter.at.as_str())?.place.clone();
            Node { value: Value::Number(law.a / (law.a + law.b)), place }
        }
        (None, None) => return None,
    };
    Some(Setting { path: parameter.path.clone(), node })
}
