//! Scenarios made by a rule from random parameters.

use super::context::Context;
use super::material::inadmissible;
use super::random_field::FieldBlock;
use super::scenario::Scenario;
use super::variant::{read, set_field};
use nastic_energy::{EnergyError, Field};
use nastic_fem::Discretization;
use nastic_language::schema::{Case, Inadmissible, Parameter, RandomParameter, RandomScenarios, Rule};
use nastic_language::syntax::{At, Document, Node, Setting, SourcePosition, Value};
use nastic_uncertainty::{Beta, Gamma, Law, Normal, RandomField, Sample, StochasticError};
use serde_json::{Map, json};
use std::sync::Arc;

/// Scenarios at most: a small body takes milliseconds to build, and kilobytes.
const MOST_SCENARIOS: usize = 10_000;

/// The nodes of the rule as scenarios; `None` after a complaint.
pub(super) fn scenarios(
    block: &RandomScenarios,
    case: &Case,
    document: &Document,
    disc: &Discretization,
    context: &mut Context<'_>,
) -> Option<Vec<Scenario>> {
    let variables = variables(block, case, document, disc, context)?;
    let laws: Vec<&dyn Law> = variables.iter().flat_map(Variable::laws).collect();
    // a case without it has been refused
    let sample = sample(block.rule.as_ref()?, &laws, block.seed);
    let sample = context.take(&block.at.key("rule"), sample)?;
    let found = sample.nodes.len();
    if found > MOST_SCENARIOS {
        let message = format!(
            "the rule has {found} nodes for {} random numbers, each a scenario with a body of its own; at most \
             {MOST_SCENARIOS} are taken: use \"sparse\", \"lattice\" or \"quasi_monte_carlo\"",
            laws.len()
        );
        context.complain(&block.at.key("rule"), message);
        return None;
    }
    let nodes = sample.nodes.iter().zip(&sample.weights).enumerate();
    let nodes: Option<Vec<Scenario>> =
        nodes.map(|(k, (x, weight))| scenario(k, x, *weight, &variables, block, context)).collect();
    admissible(nodes?, block, case, document, disc, context)
}

/// The random parameters; `None` after a complaint.
pub(super) fn variables(
    block: &RandomScenarios,
    case: &Case,
    document: &Document,
    disc: &Discretization,
    context: &mut Context<'_>,
) -> Option<Vec<Variable>> {
    let all: Vec<Option<Variable>> =
        block.random.iter().map(|one| Variable::new(one, case, document, disc, context)).collect();
    all.into_iter().collect()
}

fn sample(rule: &Rule, laws: &[&dyn Law], seed: u64) -> Result<Sample, StochasticError> {
    match rule {
        Rule::Gauss(points) => Sample::tensor(laws, &vec![*points; laws.len()]),
        Rule::Sparse(level) => Sample::sparse(laws, *level),
        Rule::MonteCarlo(count) => Sample::monte_carlo(laws, *count, seed),
        Rule::QuasiMonteCarlo(count) => Sample::quasi_monte_carlo(laws, *count, seed),
        Rule::Lattice(count) => Sample::lattice(laws, *count, seed),
    }
}

/// A random parameter: independent numbers of known laws, and what they make of it.
pub(super) struct Variable {
    pub path: String,
    pub place: SourcePosition,
    pub kind: Kind,
}

pub(super) enum Kind {
    /// The number itself.
    Plain(Box<dyn Law>),
    /// `lower + width x`, x uniform on (0, 1).
    Uniform { unit: Beta, lower: f64, width: f64 },
    /// `mean exp(s g - s^2/2)`, g standard normal.
    LogNormal { mean: f64, variance: f64 },
    /// A field; its coefficients are standard normal.
    Field(Box<RandomField>),
}

impl Variable {
    fn new(
        one: &RandomParameter,
        case: &Case,
        document: &Document,
        disc: &Discretization,
        context: &mut Context<'_>,
    ) -> Option<Self> {
        let place = document.root().find(one.at.as_str())?.place.clone();
        let field = |own: Option<FieldBlock<'_>>, context: &mut Context<'_>| {
            own.map(|own| own.build(case, disc, context).map(|field| Kind::Field(Box::new(field))))
        };
        let kind = match (&one.gamma, &one.beta, &one.uniform, &one.lognormal, &one.gaussian) {
            (Some(law), ..) => {
                let gamma = Gamma::from_mean_variance(law.mean, law.deviation.powi(2));
                Kind::Plain(Box::new(context.take(&one.at.key("gamma"), gamma)?))
            }
            (_, Some(law), ..) => Kind::Plain(Box::new(context.take(&one.at.key("beta"), Beta::new(law.a, law.b))?)),
            (_, _, Some(law), ..) => {
                let unit = context.take(&one.at.key("uniform"), Beta::new(1.0, 1.0))?;
                Kind::Uniform { unit, lower: law.lower, width: law.upper - law.lower }
            }
            (_, _, _, Some(law), _) => match field(FieldBlock::log_normal(one, law), context) {
                Some(field) => field?,
                None => Kind::LogNormal { mean: law.mean, variance: (law.deviation / law.mean).powi(2).ln_1p() },
            },
            (.., Some(law)) => match field(FieldBlock::gaussian(one, law), context) {
                Some(field) => field?,
                None => {
                    let normal = Normal::from_mean_variance(law.mean, law.deviation.powi(2));
                    Kind::Plain(Box::new(context.take(&one.at.key("gaussian"), normal)?))
                }
            },
            (None, None, None, None, None) => return None,
        };
        Some(Self { path: one.path.clone(), place, kind })
    }

    fn laws(&self) -> Vec<&dyn Law> {
        match &self.kind {
            Kind::Plain(law) => vec![law.as_ref()],
            Kind::Uniform { unit, .. } => vec![unit],
            Kind::LogNormal { .. } => vec![&Normal::STANDARD],
            Kind::Field(field) => field.laws(),
        }
    }
}

/// The scenario at a node of the rule.
fn scenario(
    index: usize,
    node: &[f64],
    probability: f64,
    variables: &[Variable],
    block: &RandomScenarios,
    context: &mut Context<'_>,
) -> Option<Scenario> {
    let name = Some(index.to_string());
    let mut scenario =
        Scenario { name, probability, settings: vec![], fields: vec![], uncertain: Arc::default(), values: Map::new() };
    let mut rest = node;
    for variable in variables {
        let (own, behind) = rest.split_at_checked(variable.laws().len())?;
        rest = behind;
        let value = match &variable.kind {
            Kind::Plain(_) => own[0],
            Kind::Uniform { lower, width, .. } => lower + width * own[0],
            Kind::LogNormal { mean, variance } => mean * (variance.sqrt() * own[0] - 0.5 * variance).exp(),
            Kind::Field(field) => {
                let values = context.take(&block.at, field.realise(own))?;
                if let Field::Cell(values) = values {
                    scenario.fields.push((variable.path.clone(), values));
                }
                scenario.values.insert(variable.path.clone(), json!({ "coefficients": own }));
                continue;
            }
        };
        let node = Node { value: Value::Number(value), place: variable.place.clone() };
        scenario.settings.push(Setting { path: variable.path.clone(), node });
        scenario.values.insert(variable.path.clone(), json!(value));
    }
    Some(scenario)
}

/// The scenarios whose materials exist; what becomes of the others is for the case to say.
fn admissible(
    all: Vec<Scenario>,
    block: &RandomScenarios,
    case: &Case,
    document: &Document,
    disc: &Discretization,
    context: &mut Context<'_>,
) -> Option<Vec<Scenario>> {
    let touched = touched(block, case);
    let count = all.len();
    let (mut kept, mut lost, mut refused) = (Vec::new(), 0.0, Vec::new());
    for scenario in all {
        match fault(&scenario, &touched, case, document, disc, context) {
            None => kept.push(scenario),
            Some(error) => {
                lost += scenario.probability;
                refused.push((scenario, error));
            }
        }
    }
    let Some((first, error)) = refused.first() else { return Some(kept) };
    let at = block.at.key("random");
    if block.inadmissible == Inadmissible::Error {
        context.complain(&at, refusal(first, error, refused.len(), count));
        return None;
    }
    let sum: f64 = kept.iter().map(|scenario| scenario.probability).sum();
    if sum <= 0.0 {
        context
            .complain(&at, format!("of {count} nodes none is a material, or those that are have no weight: {error}"));
        return None;
    }
    for (index, scenario) in kept.iter_mut().enumerate() {
        scenario.probability /= sum;
        scenario.name = Some(index.to_string());
    }
    context.note(format!(
        "scenarios: {} of {count} nodes are no material and left out (probability {lost:.3e}); the others are scaled up",
        refused.len()
    ));
    Some(kept)
}

/// The materials that have a random parameter.
fn touched(block: &RandomScenarios, case: &Case) -> Vec<usize> {
    let has = |at: &At| block.random.iter().any(|one| one.path.starts_with(&format!("{at}/")));
    (0..case.materials.len()).filter(|k| has(&case.materials[*k].at)).collect()
}

/// What keeps a scenario's materials from being such.
fn fault(
    scenario: &Scenario,
    touched: &[usize],
    case: &Case,
    document: &Document,
    disc: &Discretization,
    context: &Context<'_>,
) -> Option<EnergyError> {
    // Whatever else is wrong will be reported when the scenario is built.
    let (document, mut own) = read(document, &scenario.settings, case.units).ok()?;
    for (path, values) in &scenario.fields {
        set_field(&mut own, path, Parameter::Cells(values.clone()));
    }
    let mut scratch = context.variant(&document);
    touched.iter().find_map(|k| inadmissible(&own, *k, disc, &mut scratch))
}

fn refusal(scenario: &Scenario, error: &EnergyError, refused: usize, count: usize) -> String {
    let name = scenario.name.as_deref().unwrap_or_default();
    let values: Vec<String> = scenario.values.iter().map(|(path, value)| format!("{path} = {value}")).collect();
    let others = match refused {
        1 => String::new(),
        n => format!(" ({} in all)", n),
    };
    format!(
        "node {name} of {count} (probability {:.3e}) is no material{others}: {}: {error}; raise the mean of the bulk \
         modulus or narrow the laws, take fewer Gauss points, or leave such nodes out (\"inadmissible\": \"truncate\"), \
         which scales up the probabilities of the others",
        scenario.probability,
        values.join(", ")
    )
}
