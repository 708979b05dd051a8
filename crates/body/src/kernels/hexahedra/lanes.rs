//! [`Lanes`]: numbers of several cells at a time, in either precision.

use super::CELLS;
use pulp::Simd;

/// Arithmetic on as many cells as the widest instructions take.
pub(super) trait Lanes: Copy {
    /// Numbers of so many cells.
    type Numbers: Copy;
    /// One of them.
    type One: Copy + Default;
    /// How often a batch is gone over.
    const PARTS: usize;

    fn splat(self, x: f64) -> Self::Numbers;
    /// `a b + c`
    fn mul_add(self, a: Self::Numbers, b: Self::Numbers, c: Self::Numbers) -> Self::Numbers;
    fn load(self, of_cells: &[Self::One; CELLS], part: usize) -> Self::Numbers;
    fn store(self, numbers: Self::Numbers, of_cells: &mut [Self::One; CELLS], part: usize);
    /// Moduli are stored in single precision.
    fn moduli(self, of_cells: &[f32; CELLS], part: usize) -> Self::Numbers;
}

/// Single precision.
#[derive(Clone, Copy)]
pub(super) struct Single<S>(pub S);

/// Double precision.
#[derive(Clone, Copy)]
pub(super) struct Double<S>(pub S);

impl<S: Simd> Lanes for Single<S> {
    type Numbers = S::f32s;
    type One = f32;
    const PARTS: usize = CELLS / S::F32_LANES;

    #[inline(always)]
    fn splat(self, x: f64) -> S::f32s {
        self.0.splat_f32s(x as f32)
    }

    #[inline(always)]
    fn mul_add(self, a: S::f32s, b: S::f32s, c: S::f32s) -> S::f32s {
        self.0.mul_add_e_f32s(a, b, c)
    }

    #[inline(always)]
    fn load(self, of_cells: &[f32; CELLS], part: usize) -> S::f32s {
        S::as_simd_f32s(of_cells).0[part]
    }

    #[inline(always)]
    fn store(self, numbers: S::f32s, of_cells: &mut [f32; CELLS], part: usize) {
        S::as_mut_simd_f32s(of_cells).0[part] = numbers;
    }

    #[inline(always)]
    fn moduli(self, of_cells: &[f32; CELLS], part: usize) -> S::f32s {
        self.load(of_cells, part)
    }
}

impl<S: Simd> Lanes for Double<S> {
    type Numbers = S::f64s;
    type One = f64;
    const PARTS: usize = CELLS / S::F64_LANES;

    #[inline(always)]
    fn splat(self, x: f64) -> S::f64s {
        self.0.splat_f64s(x)
    }

    #[inline(always)]
    fn mul_add(self, a: S::f64s, b: S::f64s, c: S::f64s) -> S::f64s {
        self.0.mul_add_e_f64s(a, b, c)
    }

    #[inline(always)]
    fn load(self, of_cells: &[f64; CELLS], part: usize) -> S::f64s {
        S::as_simd_f64s(of_cells).0[part]
    }

    #[inline(always)]
    fn store(self, numbers: S::f64s, of_cells: &mut [f64; CELLS], part: usize) {
        S::as_mut_simd_f64s(of_cells).0[part] = numbers;
    }

    #[inline(always)]
    fn moduli(self, of_cells: &[f32; CELLS], part: usize) -> S::f64s {
        let mut wide = [0.0; CELLS];
        for lane in 0..S::F64_LANES {
            wide[lane] = f64::from(of_cells[part * S::F64_LANES + lane]);
        }
        S::as_simd_f64s(&wide).0[0]
    }
}
