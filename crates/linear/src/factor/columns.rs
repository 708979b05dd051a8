//! One right-hand side through one front: the panel is read once, eight columns at a time.
//!
//! A substitution does two operations per entry of the factor, so memory decides: a triangular solve followed by a product
//! would read the work vector once per column.

use pulp::{Arch, Simd, WithSimd};

use super::real::Real;

/// Columns taken together.
const COLUMNS_PER_PASS: usize = 8;
/// Partial sums of a scalar product, a vector register or two of them.
const LANES: usize = 16;

/// `[x; y] -> [L^-1 x; y - B L^-1 x]` for a panel `[L; B]` of `width` columns.
pub(super) fn forward<T: Real>(panel: &[T], width: usize, work: &mut [T]) {
    Arch::new().dispatch(Forward { panel, width, work });
}

/// `[x; y] -> [L^-T (x - B^T y); y]`.
pub(super) fn backward<T: Real>(panel: &[T], width: usize, work: &mut [T]) {
    Arch::new().dispatch(Backward { panel, width, work });
}

struct Forward<'a, T> {
    panel: &'a [T],
    width: usize,
    work: &'a mut [T],
}

impl<T: Real> WithSimd for Forward<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let height = self.work.len();
        for first in (0..self.width).step_by(COLUMNS_PER_PASS) {
            let columns: &[T] = &self.panel[height * first..];
            let count = COLUMNS_PER_PASS.min(self.width - first);
            let (solved, rest) = self.work[first..].split_at_mut(count);
            for c in 0..count {
                let mut x = solved[c];
                for (k, other) in solved[..c].iter().enumerate() {
                    x -= columns[height * k + first + c] * *other;
                }
                solved[c] = x / columns[height * c + first + c];
            }
            let below = |c: usize| &columns[height * c + first + count..height * (c + 1)];
            match <&[T; COLUMNS_PER_PASS]>::try_from(&*solved) {
                Ok(x) => subtract(rest, std::array::from_fn(below), x),
                Err(_) => (0..count).for_each(|c| subtract(rest, [below(c)], &[solved[c]])),
            }
        }
    }
}

/// `y -= sum_c a_c x_c`.
#[inline(always)]
fn subtract<T: Real, const C: usize>(y: &mut [T], a: [&[T]; C], x: &[T; C]) {
    let a = a.map(|column| &column[..y.len()]);
    for (i, y) in y.iter_mut().enumerate() {
        let mut sum = a[0][i] * x[0];
        for c in 1..C {
            sum += a[c][i] * x[c];
        }
        *y -= sum;
    }
}

struct Backward<'a, T> {
    panel: &'a [T],
    width: usize,
    work: &'a mut [T],
}

impl<T: Real> WithSimd for Backward<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let height = self.work.len();
        for first in (0..self.width).step_by(COLUMNS_PER_PASS).rev() {
            let columns: &[T] = &self.panel[height * first..];
            let count = COLUMNS_PER_PASS.min(self.width - first);
            let (own, rest) = self.work[first..].split_at_mut(count);
            let below = |c: usize| &columns[height * c + first + count..height * (c + 1)];
            if count == COLUMNS_PER_PASS {
                let sums = products(std::array::from_fn::<_, COLUMNS_PER_PASS, _>(below), rest);
                own.iter_mut().zip(sums).for_each(|(x, sum)| *x -= sum);
            } else {
                own.iter_mut().enumerate().for_each(|(c, x)| *x -= products([below(c)], rest)[0]);
            }
            for c in (0..count).rev() {
                let mut x = own[c];
                for k in c + 1..count {
                    x -= columns[height * c + first + k] * own[k];
                }
                own[c] = x / columns[height * c + first + c];
            }
        }
    }
}

/// `a_c . y` for every c.
#[inline(always)]
fn products<T: Real, const C: usize>(a: [&[T]; C], y: &[T]) -> [T; C] {
    let (chunks, tail) = y.as_chunks::<LANES>();
    let a = a.map(|column| column[..y.len()].as_chunks::<LANES>());
    let mut sums = [[T::of(0.0); LANES]; C];
    for (k, y) in chunks.iter().enumerate() {
        for (sum, (a, _)) in sums.iter_mut().zip(&a) {
            for l in 0..LANES {
                sum[l] += a[k][l] * y[l];
            }
        }
    }
    let mut out = [T::of(0.0); C];
    for ((out, sum), (_, a)) in out.iter_mut().zip(&sums).zip(&a) {
        sum.iter().for_each(|s| *out += *s);
        a.iter().zip(tail).for_each(|(a, y)| *out += *a * *y);
    }
    out
}
