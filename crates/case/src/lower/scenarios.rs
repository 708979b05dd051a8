//! The scenarios of a case: listed, made by a rule, or the one of a risk of first order.

use super::context::Context;
use super::first_order;
use super::random;
use super::scenario::Scenario;
use crate::warning::INPUT;
use nastic_fem::Discretization;
use nastic_language::schema::{Case, Scenario as ScenarioBlock, Scenarios};
use nastic_language::syntax::{At, Document};
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The scenarios of a case; `None` after a complaint.
pub(super) fn scenarios(
    case: &Case,
    document: &Document,
    disc: &Discretization,
    context: &mut Context<'_>,
) -> Option<Vec<Scenario>> {
    match &case.scenarios {
        Scenarios::List(list) if list.is_empty() => {
            let values = Map::new();
            let uncertain = Arc::default();
            Some(vec![Scenario { name: None, probability: 1.0, settings: vec![], fields: vec![], uncertain, values }])
        }
        Scenarios::List(list) => listed(list, context),
        Scenarios::Random(block) if first_order::block(case).is_some() => {
            first_order::scenario(block, case, document, disc, context).map(|one| vec![one])
        }
        Scenarios::Random(block) => random::scenarios(block, case, document, disc, context),
    }
}

fn listed(list: &[ScenarioBlock], context: &mut Context<'_>) -> Option<Vec<Scenario>> {
    let names: Vec<String> =
        list.iter().enumerate().map(|(k, one)| one.name.clone().unwrap_or_else(|| k.to_string())).collect();
    let mut sound = true;
    for (k, name) in names.iter().enumerate() {
        if let Some(first) = names[..k].iter().position(|other| other == name) {
            context.complain(&list[k].at, format!("\"{name}\" names a scenario already, at {}", list[first].at));
            sound = false;
        }
    }
    if same(list) {
        let message = format!(
            "all {} scenarios are the same: each takes its solves and none changes the result; let \"set\" differ, or leave them out",
            list.len()
        );
        context.warn(&INPUT, &At::root().key("scenarios"), message);
    }
    // The reader has seen that they add up to one, to rounding.
    let given: Vec<f64> = list.iter().map(|one| one.probability.unwrap_or(1.0)).collect();
    let sum: f64 = given.iter().sum();
    let scenario = |((one, name), p): ((&ScenarioBlock, String), f64)| Scenario {
        name: Some(name),
        probability: p / sum,
        settings: one.set.0.clone(),
        fields: vec![],
        uncertain: Arc::default(),
        values: one.set.0.iter().map(|setting| (setting.path.clone(), setting.node.to_json())).collect(),
    };
    sound.then(|| list.iter().zip(names).zip(given).map(scenario).collect())
}

/// Whether several scenarios set the same values.
fn same(list: &[ScenarioBlock]) -> bool {
    let values = |one: &ScenarioBlock| -> BTreeMap<String, Value> {
        one.set.0.iter().map(|setting| (setting.path.clone(), setting.node.to_json())).collect()
    };
    list.len() > 1 && list.windows(2).all(|pair| values(&pair[0]) == values(&pair[1]))
}
