//! Numbers that start on a cache line, so that no vector straddles two.

use std::ops::{Deref, DerefMut};

const CACHE_LINE: usize = 64;

/// An array on a cache line; its length changes only through `reset`.
#[derive(Debug, Default)]
pub(super) struct Aligned {
    data: Vec<f64>,
    start: usize,
    len: usize,
}

impl Aligned {
    pub fn zeros(len: usize) -> Self {
        let data = vec![0.0; len + CACHE_LINE / size_of::<f64>()];
        // The allocation never moves; an address that cannot be aligned only costs speed.
        let start = data.as_ptr().align_offset(CACHE_LINE).min(CACHE_LINE / size_of::<f64>());
        Self { data, start, len }
    }
}

impl Aligned {
    /// Takes this length, all zeros; allocates only to grow.
    pub fn reset(&mut self, len: usize) -> &mut [f64] {
        if self.start + len > self.data.len() {
            *self = Self::zeros(len.next_power_of_two());
        }
        self.len = len;
        self.fill(0.0);
        self
    }
}

impl FromIterator<f64> for Aligned {
    fn from_iter<I: IntoIterator<Item = f64>>(values: I) -> Self {
        let values: Vec<f64> = values.into_iter().collect();
        let mut aligned = Self::zeros(values.len());
        aligned.copy_from_slice(&values);
        aligned
    }
}

impl Deref for Aligned {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        &self.data[self.start..self.start + self.len]
    }
}

impl DerefMut for Aligned {
    fn deref_mut(&mut self) -> &mut [f64] {
        &mut self.data[self.start..self.start + self.len]
    }
}
