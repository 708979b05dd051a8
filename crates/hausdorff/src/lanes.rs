//! Vector arithmetic beyond what `pulp` offers: 1/sqrt, 2^z and log2 to about one unit in the last place, for AVX-512,
//! AVX2 and any other processor, chosen at run time. One kind of processor always gives the same bits.

#[cfg(target_arch = "x86_64")]
use pulp::x86::{V3, V4};
use pulp::{Scalar, Simd, WithSimd};

/// Width that columns of numbers are padded to; the vector length of every instruction set divides it.
pub(super) const WIDTH: usize = 8;

/// Below this argument `exp2` may give anything between zero and its value here, whose products with weights are
/// normal numbers.
pub(super) const EXP2_MIN: f64 = -960.0;

/// The vector instructions in use.
pub(super) trait Lanes: Simd {
    /// 1 / sqrt(x), for normal positive x.
    fn rsqrt(self, x: Self::f64s) -> Self::f64s;

    /// 2^z for z <= 1000 from `EXP2_MIN` on, relative error below 5e-15.
    fn exp2(self, z: Self::f64s) -> Self::f64s;

    /// x = m 2^n with 1/sqrt 2 <= m < sqrt 2, for finite x >= 1; gives (n, m).
    fn split(self, x: Self::f64s) -> (Self::f64s, Self::f64s);

    /// log2(x) for finite x >= 1, relative error about 4e-16.
    #[inline(always)]
    fn log2(self, x: Self::f64s) -> Self::f64s {
        let (n, m) = self.split(x);
        let one = self.splat_f64s(1.0);
        // log m = 2 artanh(s), s = (m - 1) / (m + 1), |s| < 0.172
        let s = self.div_f64s(self.sub_f64s(m, one), self.add_f64s(m, one));
        let s2 = self.mul_f64s(s, s);
        let mut p = self.splat_f64s(LOG2_SERIES[0]);
        for &c in &LOG2_SERIES[1..] {
            p = self.mul_add_e_f64s(p, s2, self.splat_f64s(c));
        }
        self.mul_add_e_f64s(p, s, n)
    }
}

/// 2 / ((2k + 1) log 2), k = 9 down to 0.
const LOG2_SERIES: [f64; 10] = [
    0.15186263588304877,
    0.16972882833987804,
    0.19235933878519512,
    0.22195308321368667,
    0.2623081892525388,
    0.3205988979753252,
    0.4121985831111324,
    0.5770780163555853,
    0.9617966939259756,
    2.8853900817779268,
];

/// Minimax polynomial of 2^f, |f| <= 1/2, highest power first; relative error 2.1e-16.
const EXP2_WIDE: [f64; 11] = [
    7.0372781531391626e-9,
    1.0208537936306622e-7,
    1.3215662840127102e-6,
    1.5252658116375961e-5,
    1.5403529961118467e-4,
    1.333355822856182e-3,
    9.618129108034603e-3,
    5.550410866445883e-2,
    2.4022650695908768e-1,
    6.931471805599497e-1,
    1.0,
];

/// Minimax polynomial of 2^f, |f| <= 1/32, highest power first; relative error 4.5e-15.
#[cfg(target_arch = "x86_64")]
const EXP2_NARROW: [f64; 6] = [
    1.3333334724335156e-3,
    9.618354739904515e-3,
    5.550410871118593e-2,
    2.4022650687647606e-1,
    6.931471805599324e-1,
    1.0000000000000044,
];

/// 2^(j/16).
#[cfg(target_arch = "x86_64")]
const EXP2_TABLE: [[f64; 8]; 2] = [
    [
        1.0,
        1.0442737824274138,
        1.0905077326652577,
        1.1387886347566916,
        1.189207115002721,
        1.241857812073484,
        1.2968395546510096,
        1.3542555469368927,
    ],
    [
        std::f64::consts::SQRT_2,
        1.4768261459394993,
        1.5422108254079407,
        1.6104903319492543,
        1.681792830507429,
        1.7562521603732995,
        1.8340080864093424,
        1.9152065613971474,
    ],
];

/// Adding and subtracting it rounds to a whole number, which the low bits of the sum then hold.
const ROUND: f64 = 6755399441055744.0; // 1.5 * 2^52

/// The same for sixteenths.
#[cfg(target_arch = "x86_64")]
const ROUND_16: f64 = ROUND / 16.0;

/// Bits of 1/sqrt 2.
const SQRT_HALF: u64 = 0x3FE6_A09E_667F_3BCD;

/// Bits of 2^52: or-ing a small whole number into it makes 2^52 plus that number.
const TWO_52: u64 = 0x4330_0000_0000_0000;

#[inline(always)]
fn exp2_reduced<S: Simd>(s: S, coefficients: &[f64], f: S::f64s) -> S::f64s {
    let mut p = s.splat_f64s(coefficients[0]);
    for &c in &coefficients[1..] {
        p = s.mul_add_e_f64s(p, f, s.splat_f64s(c));
    }
    p
}

#[cfg(target_arch = "x86_64")]
impl Lanes for V4 {
    #[inline(always)]
    fn rsqrt(self, x: Self::f64s) -> Self::f64s {
        // 14 bits to start with; e = 1 - x y^2 <= 2^-13, and y (1 + e/2 + 3/8 e^2 + 5/16 e^3) leaves 35/128 e^4 < 2^-53.
        let y: Self::f64s = pulp::cast(self.avx512f._mm512_rsqrt14_pd(pulp::cast(x)));
        let e = self.negate_mul_add_e_f64s(self.mul_f64s(x, y), y, self.splat_f64s(1.0));
        let p = self.mul_add_e_f64s(e, self.splat_f64s(0.3125), self.splat_f64s(0.375));
        let p = self.mul_add_e_f64s(p, e, self.splat_f64s(0.5));
        self.mul_add_e_f64s(self.mul_f64s(y, e), p, y)
    }

    #[inline(always)]
    fn exp2(self, z: Self::f64s) -> Self::f64s {
        // z = n + j/16 + f; the low bits of t are 16 n + j, and scalef multiplies by 2 to the floor of n + j/16.
        let [low, high] = EXP2_TABLE;
        let t = self.add_f64s(z, self.splat_f64s(ROUND_16));
        let rounded = self.sub_f64s(t, self.splat_f64s(ROUND_16));
        let f = self.sub_f64s(z, rounded);
        let table = self.avx512f._mm512_permutex2var_pd(pulp::cast(low), pulp::cast(t), pulp::cast(high));
        let p = self.mul_f64s(exp2_reduced(self, &EXP2_NARROW, f), pulp::cast(table));
        pulp::cast(self.avx512f._mm512_scalef_pd(pulp::cast(p), pulp::cast(rounded)))
    }

    #[inline(always)]
    fn split(self, x: Self::f64s) -> (Self::f64s, Self::f64s) {
        let f512 = self.avx512f;
        let splat = |bits: u64| f512._mm512_set1_epi64(bits as i64);
        let x = pulp::cast(x);
        let n = f512._mm512_srli_epi64::<52>(f512._mm512_sub_epi64(x, splat(SQRT_HALF)));
        let m = f512._mm512_sub_epi64(x, f512._mm512_slli_epi64::<52>(n));
        let n: Self::f64s = pulp::cast(f512._mm512_or_si512(n, splat(TWO_52)));
        (self.sub_f64s(n, self.splat_f64s(f64::from_bits(TWO_52))), pulp::cast(m))
    }
}

#[cfg(target_arch = "x86_64")]
impl Lanes for V3 {
    #[inline(always)]
    fn rsqrt(self, x: Self::f64s) -> Self::f64s {
        self.div_f64s(self.splat_f64s(1.0), self.sqrt_f64s(x))
    }

    #[inline(always)]
    fn exp2(self, z: Self::f64s) -> Self::f64s {
        let z = self.max_f64s(z, self.splat_f64s(EXP2_MIN));
        let t = self.add_f64s(z, self.splat_f64s(ROUND));
        let f = self.sub_f64s(z, self.sub_f64s(t, self.splat_f64s(ROUND)));
        let p = exp2_reduced(self, &EXP2_WIDE, f);
        let shift = self.avx2._mm256_slli_epi64::<52>(pulp::cast(t));
        pulp::cast(self.avx2._mm256_add_epi64(pulp::cast(p), shift))
    }

    #[inline(always)]
    fn split(self, x: Self::f64s) -> (Self::f64s, Self::f64s) {
        let splat = |bits: u64| self.avx._mm256_set1_epi64x(bits as i64);
        let x = pulp::cast(x);
        let n = self.avx2._mm256_srli_epi64::<52>(self.avx2._mm256_sub_epi64(x, splat(SQRT_HALF)));
        let m = self.avx2._mm256_sub_epi64(x, self.avx2._mm256_slli_epi64::<52>(n));
        let n: Self::f64s = pulp::cast(self.avx2._mm256_or_si256(n, splat(TWO_52)));
        (self.sub_f64s(n, self.splat_f64s(f64::from_bits(TWO_52))), pulp::cast(m))
    }
}

impl Lanes for Scalar {
    #[inline(always)]
    fn rsqrt(self, x: f64) -> f64 {
        1.0 / x.sqrt()
    }

    #[inline(always)]
    fn exp2(self, z: f64) -> f64 {
        let z = z.max(EXP2_MIN);
        let t = z + ROUND;
        let p = exp2_reduced(self, &EXP2_WIDE, z - (t - ROUND));
        f64::from_bits(p.to_bits().wrapping_add(t.to_bits() << 52))
    }

    #[inline(always)]
    fn split(self, x: f64) -> (f64, f64) {
        let n = (x.to_bits().wrapping_sub(SQRT_HALF)) >> 52;
        (n as f64, f64::from_bits(x.to_bits().wrapping_sub(n << 52)))
    }
}

/// Work written once for every instruction set.
pub(super) trait Task {
    /// What it gives back.
    type Output;
    /// Must be `#[inline(always)]`, like all it calls: only then is it compiled for its instructions.
    fn run<S: Lanes>(self, lanes: S) -> Self::Output;
}

/// The best vector instructions that this processor has.
#[derive(Clone, Copy, Debug)]
pub(super) enum InstructionSet {
    #[cfg(target_arch = "x86_64")]
    Avx512(V4),
    #[cfg(target_arch = "x86_64")]
    Avx2(V3),
    Portable,
}

impl InstructionSet {
    pub fn detect() -> Self {
        Self::all()[0]
    }

    /// Every instruction set that runs here, best first.
    pub fn all() -> Vec<Self> {
        let mut all = Vec::new();
        #[cfg(target_arch = "x86_64")]
        {
            all.extend(V4::try_new().map(Self::Avx512));
            all.extend(V3::try_new().map(Self::Avx2));
        }
        all.push(Self::Portable);
        all
    }

    #[inline(always)]
    pub fn run<T: Task>(self, task: T) -> T::Output {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Avx512(simd) => Simd::vectorize(simd, On { simd, task }),
            #[cfg(target_arch = "x86_64")]
            Self::Avx2(simd) => Simd::vectorize(simd, On { simd, task }),
            Self::Portable => Simd::vectorize(Scalar, On { simd: Scalar, task }),
        }
    }
}

/// A task bound to its instruction set.
struct On<S, T> {
    simd: S,
    task: T,
}

impl<S: Lanes, T: Task> WithSimd for On<S, T> {
    type Output = T::Output;

    #[inline(always)]
    fn with_simd<Same: Simd>(self, _: Same) -> T::Output {
        self.task.run(self.simd)
    }
}
