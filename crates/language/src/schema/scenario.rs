//! `scenarios` and `risk`: one control for several scenarios.

use crate::quantity::Want;
use crate::schema::json::{Definitions, any_of};
use crate::schema::read::{Read, Reader};
use crate::schema::settings::{Settings, check_path};
use crate::syntax::{At, Node, Value};
use serde_json::Value as Json;

/// The scenarios one control must serve.
#[derive(Clone, PartialEq, Debug)]
pub enum Scenarios {
    /// Given one by one; empty for a deterministic problem.
    List(Vec<Scenario>),
    /// Made by a rule from random parameters.
    Random(RandomScenarios),
}

object! {
    /// One scenario.
    pub struct Scenario {
        /// Name in results; its number if left out.
        pub name: Option<String>,
        /// Its probability; all equal if left out everywhere.
        pub probability: Option<f64> as POSITIVE,
        /// What differs: path and value.
        pub set: Settings,
    }
}

object! {
    /// Scenarios made by a rule from random parameters.
    pub struct RandomScenarios checked by check_random {
        /// The independent random parameters.
        pub random: Vec<RandomParameter>,
        /// How they become scenarios.
        pub rule: Rule,
        /// Seed of the samples.
        pub seed: u64 = 0,
        /// What becomes of scenarios no material can have.
        pub inadmissible: Inadmissible = Inadmissible::Error,
    }
}

object! {
    /// A random value.
    pub struct RandomParameter one of [gamma, beta, uniform, lognormal] checked by check_parameter {
        /// What is random: "materials/0/shear".
        pub path: String,
        /// Gamma distribution.
        pub gamma: Option<GammaLaw>,
        /// Beta distribution on (0, 1).
        pub beta: Option<BetaLaw>,
        /// Uniform distribution.
        pub uniform: Option<UniformLaw>,
        /// Log-normal distribution, or a log-normal field over the body.
        pub lognormal: Option<LognormalLaw>,
    }
}

object! {
    /// Gamma distribution.
    pub struct GammaLaw {
        /// Mean.
        pub mean: f64 as ANY_POSITIVE,
        /// Standard deviation.
        pub deviation: f64 as ANY_POSITIVE,
    }
}

object! {
    /// Beta distribution on (0, 1), density ~ x^(a-1) (1-x)^(b-1).
    pub struct BetaLaw {
        /// Exponent at 0.
        pub a: f64 as POSITIVE,
        /// Exponent at 1.
        pub b: f64 as POSITIVE,
    }
}

object! {
    /// Uniform distribution.
    pub struct UniformLaw checked by check_uniform {
        /// Least value.
        pub lower: f64,
        /// Largest value.
        pub upper: f64,
    }
}

object! {
    /// Log-normal distribution; with a length, a log-normal field by a Karhunen-Loeve expansion.
    pub struct LognormalLaw checked by check_field {
        /// Mean.
        pub mean: f64 as ANY_POSITIVE,
        /// Standard deviation.
        pub deviation: f64 as ANY_POSITIVE,
        /// Covariance length of a field.
        pub length: Option<f64> as POSITIVE_LENGTH,
        /// Number of modes of a field.
        pub modes: Option<usize> as POSITIVE,
    }
}

choice! {
    /// How random parameters become scenarios.
    pub enum Rule {
        /// Tensor Gauss rule with this number of points per parameter.
        "gauss" => Gauss(usize) as POSITIVE,
        /// Sparse tensor rule of this level.
        "sparse" => Sparse(usize) as POSITIVE,
        /// Monte Carlo with this number of samples.
        "monte_carlo" => MonteCarlo(usize) as POSITIVE,
        /// Quasi-Monte Carlo with this number of samples.
        "quasi_monte_carlo" => QuasiMonteCarlo(usize) as POSITIVE,
    }
}

choice! {
    /// What becomes of scenarios no material can have.
    pub enum Inadmissible {
        /// An error that names the scenario.
        "error" => Error,
        /// They are left out, and the other probabilities scaled.
        "truncate" => Truncate,
    }
}

choice! {
    /// What of the scenarios' costs is made small.
    pub enum Risk {
        /// The mean.
        "mean" => Mean,
        /// Mean + lambda * standard deviation.
        "mean_deviation" => MeanDeviation(MeanDeviation),
        /// Mean of the worst part of the scenarios, smoothed.
        "cvar" => ConditionalValueAtRisk(ConditionalValueAtRisk),
        /// The worst scenario, smoothed.
        "worst_case" => WorstCase(WorstCase),
    }
}

object! {
    /// Mean + lambda * standard deviation.
    pub struct MeanDeviation {
        /// Weight of the standard deviation.
        pub lambda: f64 as NOT_NEGATIVE,
    }
}

object! {
    /// Mean of the worst scenarios.
    pub struct ConditionalValueAtRisk checked by check_level {
        /// Probability of the scenarios left out, in (0, 1): 0.9 looks at the worst tenth.
        pub level: f64 as POSITIVE,
        /// Width over which the kink is rounded, as a share of the standard deviation of the costs.
        pub smoothing: f64 as POSITIVE = 0.05,
    }
}

object! {
    /// The worst scenario.
    pub struct WorstCase {
        /// Width over which the maximum is rounded, as a share of the standard deviation of the costs.
        pub smoothing: f64 as POSITIVE = 0.1,
    }
}

impl Scenarios {
    /// True for a deterministic problem.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        matches!(self, Self::List(list) if list.is_empty())
    }
}

impl Read for Scenarios {
    fn absent() -> Option<Self> {
        Some(Self::List(Vec::new()))
    }

    fn read(node: &Node, at: &At, want: Want, reader: &mut Reader<'_>) -> Option<Self> {
        match &node.value {
            Value::Object(_) => RandomScenarios::read(node, at, want, reader).map(Self::Random),
            Value::Array(_) => {
                let list = Vec::<Scenario>::read(node, at, want, reader)?;
                check_probabilities(&list, node, at, reader);
                Some(Self::List(list))
            }
            _ => {
                reader.expected(node, at, "a list of scenarios or { \"random\": [...], \"rule\": ... }");
                None
            }
        }
    }

    fn schema(want: Want, definitions: &mut Definitions) -> Json {
        any_of(vec![Vec::<Scenario>::schema(want, definitions), RandomScenarios::schema(want, definitions)])
    }
}

/// Rounded decimals of a few thousand scenarios still add up this well.
const PROBABILITY_TOLERANCE: f64 = 1e-6;

fn check_probabilities(list: &[Scenario], node: &Node, at: &At, reader: &mut Reader<'_>) {
    let complete = matches!(&node.value, Value::Array(entries) if entries.len() == list.len());
    let given: Vec<f64> = list.iter().filter_map(|scenario| scenario.probability).collect();
    if given.is_empty() || !complete {
        return;
    }
    if given.len() < list.len() {
        let message = format!("{} of {} scenarios have a probability: give all or none", given.len(), list.len());
        reader.complain(node, at, message);
        return;
    }
    let sum: f64 = given.iter().sum();
    if (sum - 1.0).abs() > PROBABILITY_TOLERANCE {
        reader.complain(node, at, format!("the probabilities add up to {sum}, not to 1"));
    }
}

fn check_random(block: &RandomScenarios, reader: &mut Reader<'_>) {
    if block.random.is_empty() {
        reader.complain_at(&block.at.key("random"), "at least one random parameter is needed");
    }
    for (i, one) in block.random.iter().enumerate() {
        if block.random[..i].iter().any(|other| other.path == one.path) {
            reader.complain_at(&one.at.key("path"), format!("\"{}\" is random twice", one.path));
        }
    }
}

fn check_parameter(block: &RandomParameter, reader: &mut Reader<'_>) {
    check_path(&block.path, &block.at.key("path"), reader);
}

fn check_uniform(block: &UniformLaw, reader: &mut Reader<'_>) {
    if block.lower >= block.upper {
        let message = format!("crossed bounds: \"lower\" is {}, not below \"upper\" {}", block.lower, block.upper);
        reader.complain_at(&block.at.key("lower"), message);
    }
}

fn check_field(block: &LognormalLaw, reader: &mut Reader<'_>) {
    if block.modes.is_some() && block.length.is_none() {
        reader.complain_at(&block.at.key("modes"), "modes belong to a field: give its covariance \"length\" too");
    }
}

fn check_level(block: &ConditionalValueAtRisk, reader: &mut Reader<'_>) {
    if block.level >= 1.0 {
        reader.complain_at(&block.at.key("level"), format!("must lie between 0 and 1, found {}", block.level));
    }
}
