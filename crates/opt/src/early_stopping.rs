//! Early stopping: which of several starts cannot reach the best one any more.

use crate::Progress;
use serde::{Deserialize, Serialize};

/// Iterations at which starts are compared for the first time; each further round has twice as many as all before.
const FIRST_COMPARISON: usize = 10;
/// Iterations within the last stage before a decrease is extrapolated.
const MIN_ITERATIONS: usize = 4;
/// An extrapolated cost is divided by this: far from a minimum a decrease may become faster.
const EXTRAPOLATION_MARGIN: f64 = 2.0;

/// A start in the last continuation stage, where costs of different starts compare.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Standing {
    /// The lowest so far.
    pub cost: f64,
    /// The cost that it may yet reach: c (c/c_half) / 2, c_half the lowest after half of the iterations; the factor of the latter half
    /// once more, and a margin of 2.
    pub within_reach: f64,
}

/// A start that is stopped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outperformed {
    /// Its number.
    pub start: usize,
    /// What it had reached.
    pub standing: Standing,
    /// The cost of the best start.
    pub best: f64,
}

impl Standing {
    /// Of a run under way; none in an earlier stage, after too few iterations, or where the cost is not above zero.
    pub fn of(progress: &Progress, last_stage: usize) -> Option<Self> {
        let costs = &progress.costs;
        let done = costs.len().checked_sub(1).filter(|done| *done >= MIN_ITERATIONS && progress.stage == last_stage)?;
        // Costs of a method that is not monotone may have been lower before: the best start would be stopped for a rise.
        let least = |costs: &[f64]| costs.iter().copied().fold(f64::INFINITY, f64::min);
        let (cost, half) = (least(costs), least(&costs[..=done / 2]));
        (cost > 0.0).then(|| Self { cost, within_reach: cost * (cost / half) / EXTRAPOLATION_MARGIN })
    }

    /// Of a run that has ended.
    pub fn ended(cost: f64) -> Self {
        Self { cost, within_reach: cost }
    }
}

/// Number of iterations at which a round ends: 10, 20, 40 ..
pub fn limit(round: usize) -> usize {
    FIRST_COMPARISON.saturating_mul(1_usize.checked_shl(round.try_into().unwrap_or(u32::MAX)).unwrap_or(usize::MAX))
}

/// Those starts under way that cannot reach the lowest cost so far: the worst first, at most half of all under way (rounded down).
/// The best one is never among them, since what it may reach is no more than its cost.
pub fn outperformed(under_way: &[(usize, Option<Standing>)], ended: &[Standing]) -> Vec<Outperformed> {
    let known = under_way.iter().filter_map(|(_, standing)| standing.as_ref()).chain(ended);
    let best = known.map(|standing| standing.cost).fold(f64::INFINITY, f64::min);
    let hopeless = |(start, standing): &(usize, Option<Standing>)| {
        let standing = standing.filter(|standing| standing.within_reach > best)?;
        Some(Outperformed { start: *start, standing, best })
    };
    let mut found: Vec<Outperformed> = under_way.iter().filter_map(hopeless).collect();
    found.sort_by(|a, b| b.standing.within_reach.total_cmp(&a.standing.within_reach).then(b.start.cmp(&a.start)));
    found.truncate(under_way.len() / 2);
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn progress(stage: usize, costs: &[f64]) -> Progress {
        Progress { stage, costs: costs.to_vec(), ..Progress::default() }
    }

    #[test]
    fn rounds_double() {
        assert_eq!((0..4).map(limit).collect::<Vec<_>>(), [10, 20, 40, 80]);
        assert_eq!(limit(500), usize::MAX);
    }

    #[test]
    fn a_decrease_is_extrapolated_in_the_last_stage_alone() {
        let costs = [9.0, 5.0, 4.0, 3.5, 3.25];
        let standing = Standing::of(&progress(1, &costs), 1).unwrap();
        assert_eq!(standing, Standing { cost: 3.25, within_reach: 3.25 * 3.25 / (4.0 * EXTRAPOLATION_MARGIN) });
        assert_eq!(Standing::of(&progress(0, &costs), 1), None);
        assert_eq!(Standing::of(&progress(1, &costs[..4]), 1), None);
        assert_eq!(Standing::of(&progress(1, &[1.0, 0.5, 0.2, 0.1, -0.1]), 1), None);
    }

    #[test]
    fn a_rise_does_not_stop_the_best() {
        let rising = Standing::of(&progress(0, &[9.0, 2.0, 1.0, 8.0, 7.0]), 0).unwrap();
        assert_eq!(rising, Standing { cost: 1.0, within_reach: 1.0 / EXTRAPOLATION_MARGIN });
        let other = Standing::of(&progress(0, &[9.0, 8.0, 7.5, 7.2, 7.1]), 0);
        let stopped = outperformed(&[(0, Some(rising)), (1, other)], &[]);
        assert_eq!(stopped.iter().map(|one| one.start).collect::<Vec<_>>(), [1]);
    }

    #[test]
    fn the_worst_half_at_most_is_stopped_and_never_the_best() {
        let at = |cost: f64, within_reach: f64| Some(Standing { cost, within_reach });
        let under_way = [(0, at(1.0, 0.9)), (2, at(5.0, 4.0)), (3, at(5.0, 0.5)), (4, None), (5, at(2.0, 1.5))];
        let stopped =
            |ended: &[Standing]| outperformed(&under_way, ended).iter().map(|one| one.start).collect::<Vec<_>>();
        assert_eq!(stopped(&[]), [2, 5]);
        // One that has ended lower makes all hopeless; two of five are stopped.
        assert_eq!(stopped(&[Standing::ended(0.1)]), [2, 5]);
        // Alone it is never stopped.
        assert_eq!(outperformed(&[(1, at(3.0, 3.0))], &[Standing::ended(0.1)]), []);
        assert_eq!(outperformed(&[(0, at(1.0, 1.0)), (1, at(1.0, 1.0))], &[]), []);
    }
}
