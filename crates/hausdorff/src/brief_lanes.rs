//! Vector arithmetic to eleven digits, one or two steps shorter than to the last one: AVX-512. Other machines go all the way.

/// Relative errors of roots and of powers.
pub(super) const ROOT_ERROR: f64 = 1.5e-13;
pub(super) const POWER_ERROR: f64 = 2.6e-12;

#[cfg(target_arch = "x86_64")]
mod avx512 {
    use pulp::Simd;
    use pulp::x86::V4;

    use super::super::lanes::{EXP2_TABLE, ROUND_16};

    type Vector = <V4 as Simd>::f64s;

    /// Minimax polynomial of 2^f, |f| <= 1/32, highest power first; relative error 2.5e-12.
    const EXP2: [f64; 5] =
        [0.009617941078493583, 0.055505736251728104, 0.24022650728043596, 0.6931471801626149, 0.9999999999999551];

    /// 2^(j/16), with j taken off the bits to which 16 n + j is added.
    const TABLE: [[f64; 8]; 2] = {
        let mut table = EXP2_TABLE;
        let mut j = 0;
        while j < 16 {
            let bits = table[j / 8][j % 8].to_bits();
            table[j / 8][j % 8] = f64::from_bits(bits - ((j as u64) << 48));
            j += 1;
        }
        table
    };

    #[inline(always)]
    pub fn roots(s: V4, x: Vector) -> (Vector, Vector) {
        // e = 1 - x y^2 is within 2^-13 of zero; y (1 + c e + 3/8 e^2) lacks 5/16 e^3, of which c, a little off 1/2,
        // leaves a quarter.
        let y: Vector = pulp::cast(s.avx512f._mm512_rsqrt14_pd(pulp::cast(x)));
        let root = s.mul_f64s(x, y);
        let e = s.negate_mul_add_e_f64s(root, y, s.splat_f64s(1.0));
        let p = s.mul_add_e_f64s(e, s.splat_f64s(0.375), s.splat_f64s(0.5000000034924597));
        let p = s.mul_f64s(e, p);
        (s.mul_add_e_f64s(root, p, root), s.mul_add_e_f64s(y, p, y))
    }

    #[inline(always)]
    pub fn power(s: V4, base: f64, r: Vector) -> Vector {
        // base - r = n + j/16 + f; the low bits of t are 16 n + j.
        let start = s.splat_f64s(base + ROUND_16);
        let t = s.sub_f64s(start, r);
        let f = s.sub_f64s(s.sub_f64s(start, t), r);
        let [low, high] = TABLE;
        let table = s.avx512f._mm512_permutex2var_pd(pulp::cast(low), pulp::cast(t), pulp::cast(high));
        let scale = s.avx512f._mm512_add_epi64(pulp::cast(table), s.avx512f._mm512_slli_epi64::<48>(pulp::cast(t)));
        let mut p = s.splat_f64s(EXP2[0]);
        for &c in &EXP2[1..] {
            p = s.mul_add_e_f64s(p, f, s.splat_f64s(c));
        }
        s.mul_f64s(p, pulp::cast(scale))
    }
}

#[cfg(target_arch = "x86_64")]
pub(super) use avx512::{power, roots};
