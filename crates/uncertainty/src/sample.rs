//! [`Sample`]: nodes and weights that stand for several random numbers.

use super::{Law, StochasticError, gauss_rule};
use nastic_numeric::Random;

/// Nodes with weights in place of independent random numbers: `E[f] = sum_i w_i f(x_i)`, nearly or exactly.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    /// One entry per law in each node.
    pub nodes: Vec<Vec<f64>>,
    /// Weights; they sum to one. Positive, except in [`sparse`](Sample::sparse) rules.
    pub weights: Vec<f64>,
}

impl Sample {
    /// The tensor product of Gauss rules, `counts[k]` nodes for law k; the last law varies fastest.
    ///
    /// Exact for polynomials of degree up to `2 counts[k] - 1` in each variable.
    ///
    /// # Errors
    /// [`StochasticError::Rule`]: counts that do not match the laws or are zero, more than a million nodes.
    pub fn tensor(laws: &[&dyn Law], counts: &[usize]) -> Result<Self, StochasticError> {
        let refuse = |what: String| Err(StochasticError::Rule { rule: "tensor", what });
        if laws.len() != counts.len() || laws.is_empty() {
            return refuse(format!("{} counts of nodes for {} laws; give one for each", counts.len(), laws.len()));
        }
        let total = counts.iter().try_fold(1usize, |product, n| product.checked_mul(*n));
        if total.is_none_or(|total| total > MOST_NODES) {
            return refuse(format!("{counts:?} nodes are too many; take a sparse rule or a quasi-Monte Carlo sample"));
        }
        let rules = laws.iter().zip(counts).map(|(law, n)| gauss_rule(*law, *n)).collect::<Result<Vec<_>, _>>()?;
        Ok(product(&rules))
    }

    /// Seeded random nodes of equal weight. Node i depends on the seed and on i, not on how many there are.
    ///
    /// # Errors
    /// [`StochasticError::Rule`] for no law or no node.
    pub fn monte_carlo(laws: &[&dyn Law], count: usize, seed: u64) -> Result<Self, StochasticError> {
        check("Monte Carlo", laws, count)?;
        let mut random = Random::new(seed);
        let nodes = (0..count).map(|_| laws.iter().map(|law| law.draw(&mut random)).collect()).collect();
        Ok(Sample { nodes, weights: vec![1.0 / count as f64; count] })
    }

    /// The Halton sequence (radical inverses in prime bases), moved by a random shift of the seed modulo one, through
    /// the quantiles of the laws. Equal weights.
    ///
    /// Source: Halton, Numer. Math. 2 (1960); Cranley & Patterson, SIAM J. Numer. Anal. 13 (1976).
    ///
    /// # Errors
    /// [`StochasticError::Rule`] for no law or node, or more than 16 laws, where the sequence is too regular.
    pub fn quasi_monte_carlo(laws: &[&dyn Law], count: usize, seed: u64) -> Result<Self, StochasticError> {
        const RULE: &str = "quasi-Monte Carlo";
        check(RULE, laws, count)?;
        if laws.len() > PRIMES.len() {
            let what = format!("{} laws are too many for it, {} is the most", laws.len(), PRIMES.len());
            return Err(StochasticError::Rule { rule: RULE, what });
        }
        let mut random = Random::new(seed);
        let shifts: Vec<f64> = laws.iter().map(|_| random.unit()).collect();
        let coordinate = |i: usize, k: usize| {
            let p = (radical_inverse(i, PRIMES[k]) + shifts[k]).fract();
            // Quantiles at 0 and 1 may be infinite.
            laws[k].quantile(p.clamp(f64::EPSILON, 1.0 - f64::EPSILON))
        };
        let nodes = (1..=count).map(|i| (0..laws.len()).map(|k| coordinate(i, k)).collect()).collect();
        Ok(Sample { nodes, weights: vec![1.0 / count as f64; count] })
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// `sum_i w_i f(x_i)`.
    pub fn expectation(&self, f: impl Fn(&[f64]) -> f64) -> f64 {
        self.nodes.iter().zip(&self.weights).map(|(x, w)| w * f(x)).sum()
    }
}

const MOST_NODES: usize = 1_000_000;
const PRIMES: [usize; 16] = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53];

fn check(rule: &'static str, laws: &[&dyn Law], count: usize) -> Result<(), StochasticError> {
    if !laws.is_empty() && (1..=MOST_NODES).contains(&count) {
        return Ok(());
    }
    let what = format!("{count} nodes for {} laws; take 1 to {MOST_NODES} nodes and at least one law", laws.len());
    Err(StochasticError::Rule { rule, what })
}

/// The tensor product of one-dimensional rules; the last varies fastest.
pub(super) fn product(rules: &[(Vec<f64>, Vec<f64>)]) -> Sample {
    let mut sample = Sample { nodes: vec![vec![]], weights: vec![1.0] };
    for (nodes, weights) in rules {
        let mut wider = Sample { nodes: vec![], weights: vec![] };
        for (node, weight) in sample.nodes.iter().zip(&sample.weights) {
            for (x, w) in nodes.iter().zip(weights) {
                wider.nodes.push(node.iter().copied().chain([*x]).collect());
                wider.weights.push(weight * w);
            }
        }
        sample = wider;
    }
    sample
}

/// The digits of i in a base, mirrored at the point.
fn radical_inverse(mut i: usize, base: usize) -> f64 {
    let (mut value, mut digit) = (0.0, 1.0);
    while i > 0 {
        digit /= base as f64;
        value += digit * (i % base) as f64;
        i /= base;
    }
    value
}
