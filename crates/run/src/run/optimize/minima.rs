//! Which of several starts ended in the same minimum.

use crate::run::optimize::starts::Starts;
use nastic_case::lower::CaseProblem;
use nastic_numeric::vector::sub;

/// Controls that differ by less than this part of the larger one, in the norm of the inner product, are one minimum.
pub(super) const SAME: f64 = 0.05;

/// Gives every start that came to an end `minimum`, the number of the minimum it found, counted from the lowest cost, and `distance`,
/// |m - m_best| / max(|m|, |m_best|); returns how many minima there are.
pub(super) fn warn_of_minima(problem: &CaseProblem, starts: &mut Starts) -> usize {
    let (Some(product), Some((best, _))) = (problem.inner_product(), &starts.best) else { return 0 };
    let distance = |a: &[f64], b: &[f64]| {
        let size = product.norm(a).max(product.norm(b));
        if size > 0.0 { product.norm(&sub(a, b)) / size } else { 0.0 }
    };
    let best = *best;
    let cost = |k: usize| starts.entries[k].cost.unwrap_or(f64::INFINITY);
    let mut ended: Vec<usize> = (0..starts.optima.len()).filter(|&k| !starts.optima[k].is_empty()).collect();
    ended.sort_by(|&a, &b| (b == best).cmp(&(a == best)).then(cost(a).total_cmp(&cost(b))).then(a.cmp(&b)));
    let mut minima: Vec<usize> = Vec::new();
    let mut shown = Vec::new();
    for &k in &ended {
        let near = |&of: &usize| distance(&starts.optima[k], &starts.optima[of]) < SAME;
        let minimum = minima.iter().position(near).unwrap_or_else(|| {
            minima.push(k);
            minima.len() - 1
        });
        shown.push((k, minimum, distance(&starts.optima[k], &starts.optima[best])));
    }
    for (k, minimum, distance) in shown {
        let entry = &mut starts.entries[k];
        (entry.minimum, entry.distance) = (Some(minimum), distance.into());
    }
    minima.len()
}
