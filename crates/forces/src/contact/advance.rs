//! [`Advance`]: conservative advancement.

/// Steps of the conservative advancement.
const MAX_ADVANCES: usize = 64;
/// Distance from the lower bound at which the advancement stops, as a share of the way to it.
pub(super) const BOUND_TOLERANCE: f64 = 1e-3;

/// How far a distance may go that changes by no more than `reach` over the whole way: a distance changes no faster than its ends move
/// against each other. Li, Kaufman, Jiang, "Codimensional incremental potential contact", ACM Trans. Graph. 40 (2021), appendix B.
pub(super) struct Advance {
    /// Below which it may not come, and where it is near enough to that.
    pub floor: f64,
    pub nearest: f64,
    pub reach: f64,
    /// The longest share of the way that is asked for.
    pub most: f64,
}

impl Advance {
    pub fn share(&self, distance: impl Fn(f64) -> f64) -> f64 {
        let mut share = 0.0;
        for _ in 0..MAX_ADVANCES {
            let d = distance(share);
            if d - self.floor >= (self.most - share) * self.reach {
                return self.most;
            }
            if d <= self.nearest {
                break;
            }
            share += (d - self.floor) / self.reach;
        }
        share
    }
}
