//! Gauss rules of a law.

use super::{Law, StochasticError};
use nalgebra::DMatrix;

/// The Gauss rule of `count` nodes under a law, nodes ascending: exact for polynomials up to degree `2 count - 1`; the
/// weights are positive and sum to one.
///
/// Nodes: eigenvalues of the Jacobi matrix of the law's recurrence (Golub & Welsch, Math. Comp. 23, 1969), polished by
/// Newton's method. Weights: `1/sum_k p_k(x)^2` over the orthonormal polynomials below degree n, a sum of positive
/// terms, so that small weights far out are accurate relative to themselves too.
///
/// # Errors
/// [`StochasticError::Rule`] for no node at all, or more than 64.
pub fn gauss_rule(law: &dyn Law, count: usize) -> Result<(Vec<f64>, Vec<f64>), StochasticError> {
    if !(1..=MOST).contains(&count) {
        let what = format!("{count} nodes for the {} law; take 1 to {MOST}", law.name());
        return Err(StochasticError::Rule { rule: "Gauss", what });
    }
    // In units of the law's spread: the matrix then has entries of order one whatever the unit.
    let (mean, unit) = (law.mean(), law.variance().sqrt());
    let recurrence: Vec<(f64, f64)> = (0..=count)
        .map(|k| {
            let (a, b) = law.recurrence(k);
            ((a - mean) / unit, if k == 0 { 1.0 } else { b.sqrt() / unit })
        })
        .collect();
    let matrix = DMatrix::from_fn(count, count, |i, j| match i.abs_diff(j) {
        0 => recurrence[i].0,
        1 => recurrence[i.max(j)].1,
        _ => 0.0,
    });
    let mut nodes: Vec<f64> = matrix.symmetric_eigenvalues().iter().copied().collect();
    nodes.sort_by(f64::total_cmp);
    let mut weights = Vec::with_capacity(count);
    for x in &mut nodes {
        for _ in 0..POLISH {
            let (value, slope, _) = orthonormal(&recurrence, *x);
            *x -= value / slope;
        }
        weights.push(1.0 / orthonormal(&recurrence, *x).2);
    }
    let sum: f64 = weights.iter().sum();
    weights.iter_mut().for_each(|w| *w /= sum);
    Ok((nodes.into_iter().map(|x| mean + unit * x).collect(), weights))
}

/// More nodes than anybody can solve for; the recurrence is stable far beyond.
const MOST: usize = 64;
const POLISH: usize = 2;

/// `p_n(x)`, its derivative, and `sum_{k<n} p_k(x)^2`; `recurrence[k]` holds `a_k` and the root of `b_k`.
fn orthonormal(recurrence: &[(f64, f64)], x: f64) -> (f64, f64, f64) {
    let n = recurrence.len() - 1;
    let (mut before, mut here) = ((0.0, 0.0), (1.0, 0.0));
    let mut sum = 0.0;
    for k in 0..n {
        sum += here.0 * here.0;
        let ((a, root), next_root) = (recurrence[k], recurrence[k + 1].1);
        let value = ((x - a) * here.0 - root * before.0) / next_root;
        let slope = (here.0 + (x - a) * here.1 - root * before.1) / next_root;
        (before, here) = (here, (value, slope));
    }
    (here.0, here.1, sum)
}
