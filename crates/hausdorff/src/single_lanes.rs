//! Vector arithmetic in single precision: twice as many numbers in a vector, half as many digits.

#[cfg(target_arch = "x86_64")]
use pulp::x86::{V3, V4};
use pulp::{Scalar, Simd};

use super::lanes::WIDTH;

/// Half a unit in the last place: what rounding errs by at most, relative.
pub(super) const ROUNDING: f64 = 1.0 / 16_777_216.0;

/// Below this argument `exp2_single` may give anything between zero and its value here.
const EXP2_MIN: f32 = -126.0;

/// What a vector machine does in single precision.
pub(super) trait SingleLanes: Simd {
    /// 1 / sqrt(x) for normal positive x, relative error below 4 `ROUNDING`.
    fn rsqrt_single(self, x: Self::f32s) -> Self::f32s;

    /// 2^z for z <= 120 from `EXP2_MIN` on, relative error below 5 `ROUNDING`.
    fn exp2_single(self, z: Self::f32s) -> Self::f32s;

    /// Adds `factor` times all numbers of `x` to `WIDTH` sums, number k to sum k modulo `WIDTH`.
    fn add_single(self, x: Self::f32s, factor: f64, sums: &mut [f64]);
}

/// Minimax polynomial of 2^f, |f| <= 1/2, highest power first; relative error 2.2e-7 with its rounding.
const EXP2: [f32; 6] = [0.0013276472, 0.009675541, 0.05550713, 0.2402212, 0.69314694, 1.0000001];

/// Adding and subtracting it rounds to a whole number, which the low bits of the sum then hold.
const ROUND: f32 = 12_582_912.0; // 1.5 * 2^23

#[inline(always)]
fn polynomial<S: Simd>(s: S, f: S::f32s) -> S::f32s {
    let mut p = s.splat_f32s(EXP2[0]);
    for &c in &EXP2[1..] {
        p = s.mul_add_e_f32s(p, f, s.splat_f32s(c));
    }
    p
}

/// One step of Newton's iteration for 1 / sqrt(x).
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn improve<S: Simd>(s: S, x: S::f32s, y: S::f32s) -> S::f32s {
    let e = s.negate_mul_add_e_f32s(s.mul_f32s(x, y), y, s.splat_f32s(1.0));
    s.mul_add_e_f32s(s.mul_f32s(y, s.splat_f32s(0.5)), e, y)
}

#[cfg(target_arch = "x86_64")]
impl SingleLanes for V4 {
    #[inline(always)]
    fn rsqrt_single(self, x: Self::f32s) -> Self::f32s {
        improve(self, x, pulp::cast(self.avx512f._mm512_rsqrt14_ps(pulp::cast(x))))
    }

    #[inline(always)]
    fn exp2_single(self, z: Self::f32s) -> Self::f32s {
        let t = self.add_f32s(z, self.splat_f32s(ROUND));
        let n = self.sub_f32s(t, self.splat_f32s(ROUND));
        let p = polynomial(self, self.sub_f32s(z, n));
        pulp::cast(self.avx512f._mm512_scalef_ps(pulp::cast(p), pulp::cast(n)))
    }

    #[inline(always)]
    fn add_single(self, x: Self::f32s, factor: f64, sums: &mut [f64]) {
        let [low, high]: [pulp::f32x8; 2] = pulp::cast(x);
        let low: Self::f64s = pulp::cast(self.avx512f._mm512_cvtps_pd(pulp::cast(low)));
        let high: Self::f64s = pulp::cast(self.avx512f._mm512_cvtps_pd(pulp::cast(high)));
        let sum = &mut Self::as_mut_simd_f64s(sums).0[0];
        *sum = self.mul_add_e_f64s(self.add_f64s(low, high), self.splat_f64s(factor), *sum);
    }
}

#[cfg(target_arch = "x86_64")]
impl SingleLanes for V3 {
    #[inline(always)]
    fn rsqrt_single(self, x: Self::f32s) -> Self::f32s {
        improve(self, x, pulp::cast(self.avx._mm256_rsqrt_ps(pulp::cast(x))))
    }

    #[inline(always)]
    fn exp2_single(self, z: Self::f32s) -> Self::f32s {
        let z = self.max_f32s(z, self.splat_f32s(EXP2_MIN));
        let t = self.add_f32s(z, self.splat_f32s(ROUND));
        let p = polynomial(self, self.sub_f32s(z, self.sub_f32s(t, self.splat_f32s(ROUND))));
        let shift = self.avx2._mm256_slli_epi32::<23>(pulp::cast(t));
        pulp::cast(self.avx2._mm256_add_epi32(pulp::cast(p), shift))
    }

    #[inline(always)]
    fn add_single(self, x: Self::f32s, factor: f64, sums: &mut [f64]) {
        let halves: [pulp::f32x4; 2] = pulp::cast(x);
        for (half, sum) in halves.into_iter().zip(Self::as_mut_simd_f64s(sums).0) {
            let half: Self::f64s = pulp::cast(self.avx._mm256_cvtps_pd(pulp::cast(half)));
            *sum = self.mul_add_e_f64s(half, self.splat_f64s(factor), *sum);
        }
    }
}

impl SingleLanes for Scalar {
    #[inline(always)]
    fn rsqrt_single(self, x: f32) -> f32 {
        1.0 / x.sqrt()
    }

    #[inline(always)]
    fn exp2_single(self, z: f32) -> f32 {
        let z = z.max(EXP2_MIN);
        let t = z + ROUND;
        let p = polynomial(self, z - (t - ROUND));
        f32::from_bits(p.to_bits().wrapping_add(t.to_bits() << 23))
    }

    #[inline(always)]
    fn add_single(self, x: f32, factor: f64, sums: &mut [f64]) {
        sums[0] += factor * f64::from(x);
    }
}

const _: () = assert!(WIDTH == 8, "half a vector of AVX-512, a vector of AVX2");
