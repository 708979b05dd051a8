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
        /// How they become scenarios; none with the risk "first_order".
        pub rule: Option<Rule>,
        /// Seed of the samples.
        pub seed: u64 = 0,
        /// What becomes of scenarios no material can have.
        pub inadmissible: Inadmissible = Inadmissible::Error,
    }
}

object! {
    /// A random value.
    pub struct RandomParameter one of [gamma, beta, uniform, lognormal, gaussian] checked by check_parameter {
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
        /// Normal distribution, or a Gaussian field over the body.
        pub gaussian: Option<GaussianLaw>,
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
    /// Log-normal distribution; with a length, a log-normal field by modes.
    pub struct LognormalLaw checked by check_lognormal {
        /// Mean.
        pub mean: f64 as ANY_POSITIVE,
        /// Standard deviation.
        pub deviation: f64 as ANY_POSITIVE,
        /// Correlation length of a field.
        pub length: Option<f64> as POSITIVE_LENGTH,
        /// Number of modes of a field, or below 1 the share of its variance that they hold.
        pub modes: Option<f64> as POSITIVE,
        /// Covariance of a field.
        pub kernel: Option<Kernel>,
    }
}

object! {
    /// Normal distribution; with a length, a Gaussian field by modes.
    pub struct GaussianLaw checked by check_gaussian {
        /// Mean.
        pub mean: f64,
        /// Standard deviation.
        pub deviation: f64 as ANY_POSITIVE,
        /// Correlation length of a field.
        pub length: Option<f64> as POSITIVE_LENGTH,
        /// Number of modes of a field, or below 1 the share of its variance that they hold.
        pub modes: Option<f64> as POSITIVE,
        /// Covariance of a field.
        pub kernel: Option<Kernel>,
    }
}

choice! {
    /// The covariance of a random field.
    pub enum Kernel {
        /// exp(-r/length) between cell centres, a dense matrix: 4000 cells at most (the default).
        "exponential" => Exponential,
        /// That of Whittle and Matern by a sparse operator on the nodes: exp(-r/length) in space, up to a million cells.
        "matern" => Matern,
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
        /// Embedded lattice with this number of samples, a power of two; up to 256 random numbers.
        "lattice" => Lattice(usize) as POSITIVE,
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
        /// Cost + deviations * standard deviation, both to first order about the median of the random parameters: no scenarios.
        "first_order" => FirstOrder(FirstOrder),
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

object! {
    /// Cost and standard deviation to first order about the median.
    pub struct FirstOrder {
        /// Weight of the standard deviation.
        pub deviations: f64 as NOT_NEGATIVE,
        /// What the deviation D is rounded over where it is zero, as a share s of the cost q: sqrt(D^2 + (s q)^2).
        pub smoothing: f64 as POSITIVE = 1e-3,
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

fn check_lognormal(block: &LognormalLaw, reader: &mut Reader<'_>) {
    check_field(&block.at, block.length.is_some(), block.modes, block.kernel.is_some(), reader);
}

fn check_gaussian(block: &GaussianLaw, reader: &mut Reader<'_>) {
    check_field(&block.at, block.length.is_some(), block.modes, block.kernel.is_some(), reader);
}

fn check_field(at: &At, is_field: bool, modes: Option<f64>, has_kernel: bool, reader: &mut Reader<'_>) {
    for (key, what) in [("modes", modes.map(|_| "modes belong")), ("kernel", has_kernel.then_some("a kernel belongs"))]
    {
        if let (Some(what), false) = (what, is_field) {
            reader.complain_at(&at.key(key), format!("{what} to a field: give its correlation \"length\" too"));
        }
    }
    if let Some(modes) = modes.filter(|modes| *modes > 1.0 && modes.fract() != 0.0) {
        let message = format!("a number of modes, as 20, or a share of the variance below 1, as 0.9; found {modes}");
        reader.complain_at(&at.key("modes"), message);
    }
}

fn check_level(block: &ConditionalValueAtRisk, reader: &mut Reader<'_>) {
    if block.level >= 1.0 {
        reader.complain_at(&block.at.key("level"), format!("must lie between 0 and 1, found {}", block.level));
    }
}
