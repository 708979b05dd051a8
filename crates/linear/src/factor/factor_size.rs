//! [`FactorSize`]: what a factor takes, counted before it is made.

use crate::pattern::entries::Pattern;

/// Largest factor that is made by default: 8 GiB, without its workspace.
const MAX_FACTOR_BYTES: usize = 8 << 30;

/// What a factor of a pattern takes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FactorSize {
    /// Values stored, the explicit zeros of merged fronts and the upper triangles of their diagonal blocks among them.
    pub values: usize,
    /// Entries of the lower triangle, explicit zeros among them.
    pub nonzeros: u64,
    /// Floating-point operations of one factorisation, multiplications and additions counted separately.
    pub flops: f64,
}

impl FactorSize {
    /// `sum_f w_f h_f` values over the fronts of w columns and h rows.
    pub(super) fn new(pattern: &Pattern) -> Self {
        let (ordering, dim) = (pattern.ordering(), pattern.dim());
        let mut size = FactorSize::default();
        for (columns, &height) in ordering.fronts().windows(2).zip(ordering.heights()) {
            size.add(dim * (columns[1] - columns[0]) as usize, dim * height as usize);
        }
        size
    }

    /// Adds that of a front by its dofs.
    pub(super) fn add(&mut self, width: usize, height: usize) {
        self.values += width * height;
        let (w, h) = (width as u64, height as u64);
        self.nonzeros += w * h - w * w.saturating_sub(1) / 2;
        self.flops += front_flops(width as f64, height as f64);
    }

    /// Bytes of a factor in double precision.
    pub fn bytes(&self) -> usize {
        size_of::<f64>() * self.values
    }
}

/// Sum of `k^2` over the column lengths `k = height - width + 1 ..= height`.
pub(super) fn front_flops(width: f64, height: f64) -> f64 {
    let squares = |n: f64| n * (n + 1.0) * (2.0 * n + 1.0) / 6.0;
    squares(height) - squares(height - width)
}

/// Whether a factor of this number of bytes may be made by default.
pub(crate) fn fits(factor_bytes: usize) -> bool {
    factor_bytes <= MAX_FACTOR_BYTES
}
