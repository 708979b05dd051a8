//! Symmetric rules on triangle and tetrahedron, conical products beyond the tables. All weights positive, all points
//! inside.
//!
//! Sources: Strang & Fix; Dunavant (1985) degrees 4, 6, 8; Radon (1948) degree 5; Walkington (2000) degree 5 in 3D;
//! Keast (1986) degree 6 in 3D. Weights below are shares of the measure.

use super::Rule;
use super::gauss::gauss_jacobi;
use std::collections::BTreeSet;

/// A symmetric orbit: barycentric coordinates of one point and the weight of each of its images.
type Orbit = ([f64; 4], f64);

impl Rule {
    /// Rule on the unit triangle, exact for total degree `degree`.
    pub fn triangle(degree: usize) -> Rule {
        match degree {
            0 | 1 => orbits::<3>(&[([1.0 / 3.0; 4], 1.0)]),
            2 => orbits::<3>(&[(pair(1.0 / 6.0), 1.0 / 3.0)]),
            3 | 4 => orbits::<3>(&TRIANGLE_4),
            5 => orbits::<3>(&radon()),
            6 => orbits::<3>(&TRIANGLE_6),
            7 | 8 => orbits::<3>(&TRIANGLE_8),
            _ => conical(2, degree),
        }
    }

    /// Rule on the unit tetrahedron, exact for total degree `degree`.
    pub fn tetrahedron(degree: usize) -> Rule {
        match degree {
            0 | 1 => orbits::<4>(&[([0.25; 4], 1.0)]),
            2 => {
                let a = (5.0 - 5f64.sqrt()) / 20.0;
                orbits::<4>(&[([a, a, a, 1.0 - 3.0 * a], 0.25)])
            }
            3..=5 => orbits::<4>(&TETRAHEDRON_5),
            6 => orbits::<4>(&TETRAHEDRON_6),
            _ => conical(3, degree),
        }
    }
}

/// Triangle orbit (a, a, 1 - 2a).
const fn pair(a: f64) -> [f64; 4] {
    [a, a, 1.0 - 2.0 * a, 0.0]
}

/// Tetrahedron orbit (a, a, a, 1 - 3a).
const fn triple(a: f64) -> [f64; 4] {
    [a, a, a, 1.0 - 3.0 * a]
}

const TRIANGLE_4: [Orbit; 2] = [
    (pair(0.091_576_213_509_770_74), 0.109_951_743_655_321_87),
    (pair(0.445_948_490_915_964_9), 0.223_381_589_678_011_47),
];

fn radon() -> [Orbit; 3] {
    let r = 15f64.sqrt();
    [
        ([1.0 / 3.0; 4], 0.225),
        (pair((6.0 - r) / 21.0), (155.0 - r) / 1200.0),
        (pair((6.0 + r) / 21.0), (155.0 + r) / 1200.0),
    ]
}

const TRIANGLE_6: [Orbit; 3] = [
    (pair(0.249_286_745_170_910_42), 0.116_786_275_726_379_37),
    (pair(0.063_089_014_491_502_23), 0.050_844_906_370_206_82),
    ([0.053_145_049_844_816_95, 0.310_352_451_033_784_4, 0.636_502_499_121_398_7, 0.0], 0.082_851_075_618_373_57),
];

const TRIANGLE_8: [Orbit; 5] = [
    ([1.0 / 3.0; 4], 0.144_315_607_677_787_17),
    (pair(0.170_569_307_751_760_2), 0.103_217_370_534_718_25),
    (pair(0.050_547_228_317_030_98), 0.032_458_497_623_198_08),
    (pair(0.459_292_588_292_723_2), 0.095_091_634_267_284_62),
    ([0.263_112_829_634_638_1, 0.728_492_392_955_404_3, 0.008_394_777_409_957_605, 0.0], 0.027_230_314_174_434_994),
];

const TETRAHEDRON_5: [Orbit; 3] = [
    (triple(0.310_885_919_263_300_6), 0.112_687_925_718_015_85),
    (triple(0.092_735_250_310_891_23), 0.073_493_043_116_361_95),
    (
        [0.045_503_704_125_649_65, 0.045_503_704_125_649_65, 0.454_496_295_874_350_35, 0.454_496_295_874_350_35],
        0.042_546_020_777_081_47,
    ),
];

const TETRAHEDRON_6: [Orbit; 4] = [
    (triple(0.214_602_871_259_151_68), 0.039_922_750_258_167_49),
    (triple(0.040_673_958_534_611_34), 0.010_077_211_055_320_657),
    (triple(0.322_337_890_142_275_65), 0.055_357_181_543_654_39),
    (
        [0.063_661_001_875_017_53, 0.063_661_001_875_017_53, 0.269_672_331_458_315_9, 0.603_005_664_791_649_1],
        27.0 / 560.0,
    ),
];

/// Every distinct permutation of each orbit's coordinates, in a fixed order.
fn orbits<const N: usize>(table: &[Orbit]) -> Rule {
    let measure = if N == 3 { 0.5 } else { 1.0 / 6.0 };
    table
        .iter()
        .flat_map(|(l, w)| {
            let images: BTreeSet<[u64; N]> = permutations::<N>().map(|p| p.map(|k| l[k].to_bits())).collect();
            images.into_iter().map(move |image| (point(image.map(f64::from_bits)), w * measure))
        })
        .collect()
}

/// xi_k = L_{k+1}.
fn point<const N: usize>(l: [f64; N]) -> [f64; 3] {
    std::array::from_fn(|k| if k + 1 < N { l[k + 1] } else { 0.0 })
}

fn permutations<const N: usize>() -> impl Iterator<Item = [usize; N]> {
    (0..N.pow(N as u32)).map(|code| std::array::from_fn(|k| code / N.pow(k as u32) % N)).filter(|p: &[usize; N]| {
        let used = p.iter().fold(0u32, |bits, k| bits | 1 << k);
        used == (1 << N) - 1
    })
}

/// Collapsed coordinates: Gauss-Jacobi with weight (1 - x)^k along the k-th collapsed axis (Stroud 1971).
/// x_0 = s_0, x_1 = (1 - s_0) s_1, x_2 = (1 - s_0)(1 - s_1) s_2 with s on [0,1].
fn conical(dim: usize, degree: usize) -> Rule {
    let n = degree / 2 + 1;
    let mut rule = Rule { points: vec![[0.0; 3]], weights: vec![1.0] };
    for d in 0..dim {
        let alpha = (dim - 1 - d) as u32;
        let (x, w) = gauss_jacobi(n, alpha);
        let scale = f64::from(2u32.pow(alpha + 1));
        rule = rule
            .iter()
            .flat_map(|(&p, v)| {
                let rest = 1.0 - p[..d].iter().sum::<f64>();
                x.iter().zip(&w).map(move |(x, w)| (super::with(p, d, 0.5 * rest * (1.0 + x)), v * w / scale))
            })
            .collect();
    }
    rule
}
