//! Axis-aligned boxes and the distances between them.

/// A box; empty when lo > hi.
#[derive(Clone, Copy, Debug)]
pub(super) struct BoundingBox {
    pub lo: [f64; 3],
    pub hi: [f64; 3],
}

impl BoundingBox {
    pub const EMPTY: Self = Self { lo: [f64::INFINITY; 3], hi: [f64::NEG_INFINITY; 3] };

    pub fn point(x: [f64; 3]) -> Self {
        Self { lo: x, hi: x }
    }

    pub fn join(&self, other: &Self) -> Self {
        let mut all = *self;
        for d in 0..3 {
            all.lo[d] = all.lo[d].min(other.lo[d]);
            all.hi[d] = all.hi[d].max(other.hi[d]);
        }
        all
    }

    pub fn centre(&self) -> [f64; 3] {
        std::array::from_fn(|d| 0.5 * (self.lo[d] + self.hi[d]))
    }

    /// Smallest distance between a point of one box and a point of the other.
    pub fn gap(&self, other: &Self) -> f64 {
        norm(self.gaps(other))
    }

    /// The same per direction.
    pub fn gaps(&self, other: &Self) -> [f64; 3] {
        std::array::from_fn(|d| (self.lo[d] - other.hi[d]).max(other.lo[d] - self.hi[d]).max(0.0))
    }

    /// Largest distance between a point of one box and a point of the other.
    pub fn reach(&self, other: &Self) -> f64 {
        norm(self.reaches(other))
    }

    /// The same per direction.
    pub fn reaches(&self, other: &Self) -> [f64; 3] {
        std::array::from_fn(|d| (self.hi[d] - other.lo[d]).max(other.hi[d] - self.lo[d]))
    }
}

pub(super) fn norm(x: [f64; 3]) -> f64 {
    (x[0] * x[0] + x[1] * x[1] + x[2] * x[2]).sqrt()
}
