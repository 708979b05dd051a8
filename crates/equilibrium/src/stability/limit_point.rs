//! [`LimitPoint`]: the load at which a path of equilibria turns back, estimated from the states on it.

/// Estimates of the load s* at a limit point, near which `u* - u(s) ~ sqrt(s* - s)`: two steps (s0, s1, s2) with changes of
/// displacement d1, d2 (norms) give s* from
///
/// `d2 / d1 = (sqrt(s* - s1) - sqrt(s* - s2)) / (sqrt(s* - s0) - sqrt(s* - s1))`.
///
/// Source: the normal form of a fold; Riks, Int. J. Solids Struct. 15 (1979), section 2.
#[derive(Debug, Default)]
pub(crate) struct LimitPoint {
    /// The last step: where it began, and the change of the displacement.
    last: Option<(f64, f64)>,
    estimate: Option<f64>,
    /// Whether the last two estimates agree.
    agrees: bool,
}

/// Distance of a limit point over the last two steps, beyond which the path counts as straight.
const MAX_DISTANCE_RATIO: f64 = 4.0;
/// Two estimates agree when they differ by less than this share of the way left to the later one, or of the last step.
const AGREEMENT_TOLERANCE: f64 = 0.5;

impl LimitPoint {
    /// A step along the path from load `from` to load `to` that changed the displacement by `change` (norm).
    pub fn record(&mut self, from: f64, to: f64, change: f64) {
        let estimate = self.last.and_then(|(first, before)| fold(first, from, to, change / before));
        self.agrees = match (self.estimate, estimate) {
            (Some(before), Some(at)) => (before - at).abs() < AGREEMENT_TOLERANCE * (at - to).max(to - from),
            _ => false,
        };
        (self.last, self.estimate) = (Some((from, change)), estimate);
    }

    /// The load at which the path turns back, once two consecutive estimates agree.
    pub fn load(&self) -> Option<f64> {
        self.estimate.filter(|_| self.agrees)
    }
}

/// The load s* >= s2 of the equation above for `ratio = d2 / d1`; s2 itself where the displacement grows faster than towards any
/// later one, none where it does not grow faster than the load.
fn fold(s0: f64, s1: f64, s2: f64, ratio: f64) -> Option<f64> {
    let law = |beyond: f64| {
        let root = |s: f64| (s2 + beyond - s).sqrt();
        (root(s1) - root(s2)) / (root(s0) - root(s1))
    };
    let (mut low, mut high) = (0.0, MAX_DISTANCE_RATIO * (s2 - s0));
    if ratio.is_nan() || ratio <= law(high) {
        return None;
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if law(middle) > ratio { low = middle } else { high = middle }
    }
    Some(s2 + low)
}

#[cfg(test)]
mod tests {
    use super::LimitPoint;

    /// u = 1 - sqrt(s* - s) in steps that are halved towards s* = 0.8.
    #[test]
    fn finds_a_square_root_and_nothing_on_a_straight_path() {
        let (mut fold, mut line) = (LimitPoint::default(), LimitPoint::default());
        let u = |s: f64| 1.0 - (0.8 - s).sqrt();
        let (mut s, mut step) = (0.0, 0.4);
        for _ in 0..6 {
            fold.record(s, s + step, u(s + step) - u(s));
            line.record(s, s + step, 2.0 * step);
            s += step;
            step *= 0.5;
            assert!(fold.load().is_none_or(|at| (at - 0.8).abs() < 1e-6), "{:?} at {s}", fold.load());
            assert_eq!(line.load(), None);
        }
        assert!(fold.load().is_some());
    }
}
