//! A risk of first order: random parameters without scenarios.

use super::context::Context;
use super::cost_term::SECOND_ORDER;
use super::design::law_name;
use super::random::{Kind, Variable, variables};
use super::random_field::material_of;
use super::scenario::Scenario;
use super::uncertain::Uncertain;
use nastic_control::Space;
use nastic_ensemble::{FirstOrder, UncertainSource};
use nastic_fem::Discretization;
use nastic_language::schema::{Case, FirstOrder as Block, RandomScenarios, Risk};
use nastic_language::syntax::{At, Document, Node, Setting, Value};
use nastic_uncertainty::Law;
use serde_json::Map;
use std::sync::Arc;

/// The block of a case whose risk is of first order.
pub(super) fn block(case: &Case) -> Option<&Block> {
    if let Risk::FirstOrder(block) = &case.risk { Some(block) } else { None }
}

/// The one scenario of a case whose risk is of first order, at the medians; `None` after a complaint.
pub(super) fn scenario(
    random: &RandomScenarios,
    case: &Case,
    document: &Document,
    disc: &Discretization,
    context: &mut Context<'_>,
) -> Option<Scenario> {
    if case.time.is_some() {
        let message = "\"first_order\" takes equilibria: second derivatives of motions are not there; make scenarios by a \"rule\" and take \"mean_deviation\"";
        context.complain(&At::root().key("risk"), message);
        return None;
    }
    let method = case.optimizer.method.name();
    if SECOND_ORDER.contains(&method) {
        let message = format!(
            "\"{method}\" takes second derivatives, and those of \"first_order\" are third ones of the costs: take \"lbfgs\" or another method of first derivatives"
        );
        context.complain(&At::root().key("optimizer").key("method"), message);
        return None;
    }
    let all = variables(random, case, document, disc, context)?;
    let mut scenario = Scenario {
        name: None,
        probability: 1.0,
        settings: vec![],
        fields: vec![],
        uncertain: Arc::default(),
        values: Map::new(),
    };
    let mut found = Vec::new();
    for (variable, one) in all.iter().zip(&random.random) {
        let Some(number) = material_of(case, &variable.path) else {
            let message = "\"first_order\" takes numbers of materials, as \"materials/0/mu\"; for others make scenarios by a \"rule\"";
            context.complain(&one.at.key("path"), message);
            continue;
        };
        let sets = |setting: &Setting| {
            let (path, own) = (&setting.path, &variable.path);
            path == own || own.starts_with(&format!("{path}/")) || path.starts_with(&format!("{own}/"))
        };
        if let Some(load_case) = case.load_cases.iter().find(|own| own.set.0.iter().any(sets)) {
            let message = format!(
                "the load case \"{}\" sets it too: with \"first_order\" a random number is one of all load cases; leave one of them out",
                load_case.name
            );
            context.complain(&one.at.key("path"), message);
            continue;
        }
        let own = linearised(variable);
        let parts = match &variable.kind {
            Kind::Field(field) if number.material.region.are_several() => {
                let part = |name: &str| {
                    let cells = disc.mesh().region(name).unwrap_or_default();
                    let at = cells.iter().filter_map(|cell| field.cells().binary_search(cell).ok());
                    (name.to_owned(), at.collect())
                };
                number.material.region.iter().map(part).collect()
            }
            _ => vec![],
        };
        let node = Node { value: Value::Number(own.everywhere), place: variable.place.clone() };
        scenario.settings.push(Setting { path: variable.path.clone(), node });
        found.push(Uncertain {
            material: number.index,
            of: format!("{}.{}", law_name(number.material), number.number),
            number: number.number,
            at: one.at.clone(),
            path: variable.path.clone(),
            space: if matches!(variable.kind, Kind::Field(_)) { Space::Cell } else { Space::Uniform },
            medians: own.medians,
            slopes: own.slopes,
            parts,
        });
    }
    if !context.is_sound() {
        return None;
    }
    context.note(
        "first_order: mean and deviation are to first order about the medians of the random parameters (of log-normal ones mean exp(-v/2), v the variance \
         of the logarithm), in the parameters themselves, of log-normal ones in their logarithms"
            .to_owned(),
    );
    scenario.uncertain = Arc::new(found);
    Some(scenario)
}

/// A random parameter about its median.
struct Linearised {
    /// The median of a lone number; of a field that of one with all of its variance.
    everywhere: f64,
    medians: Vec<f64>,
    slopes: Vec<Vec<f64>>,
}

fn linearised(variable: &Variable) -> Linearised {
    let number =
        |median: f64, slope: f64| Linearised { everywhere: median, medians: vec![median], slopes: vec![vec![slope]] };
    match &variable.kind {
        Kind::Plain(law) => number(law.quantile(0.5), law.variance().sqrt()),
        Kind::Uniform { unit, lower, width } => number(lower + 0.5 * width, width * unit.variance().sqrt()),
        Kind::LogNormal { mean, variance } => {
            let median = mean * (-0.5 * variance).exp();
            number(median, median * variance.sqrt())
        }
        Kind::Field(field) => {
            let (medians, slopes) = field.linearised();
            Linearised { everywhere: field.median(), medians, slopes }
        }
    }
}

/// The measure, of the sources of a scenario.
pub(super) fn risk(block: &Block, scenario: &Scenario) -> FirstOrder {
    let source = |own: &Uncertain| UncertainSource {
        name: own.path.clone(),
        slopes: own.slopes.clone(),
        parts: own.parts.clone(),
    };
    FirstOrder {
        deviations: block.deviations,
        smoothing: block.smoothing,
        sources: scenario.uncertain.iter().map(source).collect(),
    }
}
