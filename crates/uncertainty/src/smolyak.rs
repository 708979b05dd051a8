//! Sparse Gauss rules.

use super::sample::product;
use super::{Law, Sample, StochasticError, gauss_rule};

impl Sample {
    /// Smolyak's sparse rule of Gauss rules with 1, 2, 3, .. nodes:
    ///
    /// `A_q = sum_{|i| = max(0, q-d+1)..q} (-1)^(q-|i|) C(d-1, q-|i|) (U_{i1} x .. x U_{id})`, U_i with i + 1 nodes, d
    /// laws.
    ///
    /// Exact for polynomials of total degree up to `2 q + 1`, with a number of nodes that grows like `d^q` where a
    /// tensor rule of that degree has `(q+1)^d`. Some weights are negative: it goes with the
    /// [`Mean`](crate::risk::Mean) alone. Nodes are in lexicographic order, each once.
    ///
    /// Source: Smolyak 1963; Wasilkowski & Wozniakowski, J. Complexity 11 (1995).
    ///
    /// # Errors
    /// [`StochasticError::Rule`] for no law, more than 16, or a level above 12.
    pub fn sparse(laws: &[&dyn Law], level: usize) -> Result<Self, StochasticError> {
        let dimension = laws.len();
        if dimension == 0 || dimension > MOST_LAWS || level > MOST_LEVEL {
            let what =
                format!("level {level} for {dimension} laws; take 1 to {MOST_LAWS} laws, a level up to {MOST_LEVEL}");
            return Err(StochasticError::Rule { rule: "sparse", what });
        }
        let of_law = |law: &&dyn Law| (0..=level).map(|i| gauss_rule(*law, i + 1)).collect::<Result<Vec<_>, _>>();
        let rules = laws.iter().map(of_law).collect::<Result<Vec<_>, _>>()?;
        let mut terms: Vec<(Vec<f64>, f64)> = Vec::new();
        for order in (level + 1).saturating_sub(dimension)..=level {
            let sign = if (level - order).is_multiple_of(2) { 1.0 } else { -1.0 };
            let factor = sign * binomial(dimension - 1, level - order);
            for index in compositions(order, dimension) {
                let rules: Vec<_> = index.iter().zip(&rules).map(|(i, rules)| rules[*i].clone()).collect();
                let tensor = product(&rules);
                terms.extend(tensor.nodes.into_iter().zip(tensor.weights.iter().map(|w| factor * w)));
            }
        }
        Ok(merged(terms, laws))
    }
}

const MOST_LAWS: usize = 16;
const MOST_LEVEL: usize = 12;
/// Nodes closer than this share of a law's deviation are one: computed in two rules.
const SAME: f64 = 1e-10;

/// Joins terms at the same node.
fn merged(mut terms: Vec<(Vec<f64>, f64)>, laws: &[&dyn Law]) -> Sample {
    // Rounded keys make the order, and with it the joining, proof against rounding of the nodes.
    let key = |x: &[f64]| -> Vec<i64> {
        x.iter().zip(laws).map(|(x, law)| ((x - law.mean()) / (SAME * law.variance().sqrt())).round() as i64).collect()
    };
    terms.sort_by_cached_key(|(x, _)| key(x));
    let mut sample = Sample { nodes: vec![], weights: vec![] };
    let mut last: Vec<i64> = vec![];
    for (x, weight) in terms {
        let here = key(&x);
        let near = !sample.nodes.is_empty() && here.iter().zip(&last).all(|(a, b)| a.abs_diff(*b) <= 1);
        match sample.weights.last_mut() {
            Some(sum) if near => *sum += weight,
            _ => {
                sample.nodes.push(x);
                sample.weights.push(weight);
                last = here;
            }
        }
    }
    sample
}

/// All ways to write `sum` as `parts` numbers from zero on, in lexicographic order.
fn compositions(sum: usize, parts: usize) -> Vec<Vec<usize>> {
    if parts == 1 {
        return vec![vec![sum]];
    }
    let with =
        |first: usize| compositions(sum - first, parts - 1).into_iter().map(move |rest| [vec![first], rest].concat());
    (0..=sum).flat_map(with).collect()
}

fn binomial(n: usize, k: usize) -> f64 {
    (0..k).fold(1.0, |product, i| product * (n - i) as f64 / (i + 1) as f64)
}
