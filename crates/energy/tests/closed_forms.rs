//! Stresses of every law against formulas worked out by hand, with nothing of the chain rule in them.
#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use nastic_energy::network::{Network, NetworkInput, NetworkLayer};
use nastic_energy::{
    Arap, ArrudaBoyce, ConvexNetwork, EnergyTerm, FiberFamily, FiberTension, Gel, Gent, Guccione, HolzapfelGasserOgden,
    MaterialPoint, MooneyRivlin, NeoHooke, NeoHookeIsochoric, Ogden, PointBatch, SaintVenantKirchhoff, Slots,
    TransverseMooneyRivlin, Turgor, Yeoh, catalogue, check,
};
use nastic_tensor::{Kinematics, Mat3, Vec3};

const HERE: MaterialPoint = MaterialPoint { cell: 0, point: 0 };
const MU1: f64 = 1e5;
const MU2: f64 = 2e4;
const MU3: f64 = 3e5;
const MU4: f64 = 1e6;
const LAMBDA: f64 = 4e5;
const KAPPA: f64 = 5e5;
const C20: f64 = -2e3;
const C30: f64 = 4e2;
const JM: f64 = 40.0;
const LAMBDA_M: f64 = 2.5;
/// Of Treloar's rubber (R. W. Ogden, 1972), in Pa.
const OGDEN: [[f64; 2]; 3] = [[6.2e5, 1.3], [1.2e3, 5.0], [-1e4, -2.0]];
const K1: f64 = 4e4;
const K2: f64 = 0.3;
const DISPERSION: f64 = 0.1;
/// b_f, b_t, b_fs of Guccione's law; b_f + b_t = 2 b_fs, where beta is 0.
const B: [f64; 3] = [0.75, 0.25, 0.5];
/// N, c, chi and swelling of a gel.
const GEL: [f64; 4] = [2.0 * MU1, 1e7, 0.1, 2.0];
/// Of the fibres: nothing for `E < 0`, half of it less from there on.
const TOE: f64 = 1e-2;

/// A law by its catalogue name; fibre along x. A new law fails here until its closed forms are written.
fn law(name: &str) -> Box<dyn EnergyTerm> {
    match name {
        "mooney_rivlin" => Box::new(MooneyRivlin::new(MU1, MU2, MU3).unwrap()),
        "transverse_mooney_rivlin" => Box::new(TransverseMooneyRivlin::new(MU1, MU2, MU3, MU4, Vec3::x()).unwrap()),
        "neo_hooke" => Box::new(NeoHooke::new(MU1, LAMBDA).unwrap()),
        "gel" => {
            let [network, mixing, chi, swelling] = GEL;
            Box::new(Gel::new(network, mixing, chi, swelling).unwrap())
        }
        "neo_hooke_isochoric" => Box::new(NeoHookeIsochoric::new(MU1, KAPPA).unwrap()),
        "yeoh" => Box::new(Yeoh::new(MU1 / 2.0, C20, C30, KAPPA).unwrap()),
        "gent" => Box::new(Gent::new(MU1, JM, KAPPA).unwrap()),
        "arruda_boyce" => Box::new(ArrudaBoyce::new(MU1, LAMBDA_M, KAPPA).unwrap()),
        "ogden" => Box::new(Ogden::new(OGDEN.map(|pair| pair.map(Into::into)).to_vec(), KAPPA).unwrap()),
        "holzapfel_gasser_ogden" => {
            let fibers = [K1, K2, DISPERSION, TOE].map(Into::into);
            Box::new(HolzapfelGasserOgden::new([MU1, KAPPA].map(Into::into), fibers, Vec3::x(), None).unwrap())
        }
        "fiber_family" => Box::new(FiberFamily::new(K1, K2, DISPERSION, Vec3::x()).unwrap()),
        "saint_venant_kirchhoff" => Box::new(SaintVenantKirchhoff::new(LAMBDA, MU1).unwrap()),
        "arap" => Box::new(Arap::new(MU1).unwrap()),
        "guccione" => Box::new(Guccione::new(MU1, B.map(Into::into), KAPPA, Vec3::x()).unwrap()),
        "convex_network" => {
            let hidden = NetworkLayer { through: vec![vec![0.5]], bias: vec![-0.3], ..NetworkLayer::default() };
            let last = NetworkLayer { before: vec![vec![2.0]], ..NetworkLayer::default() };
            let network = Network { inputs: vec![NetworkInput::FirstIsochoric], layers: vec![hidden, last] };
            Box::new(ConvexNetwork::new(&network, MU1, KAPPA, None).unwrap())
        }
        // that of the Mooney-Rivlin law with the moduli above
        "formula" => {
            let row = catalogue::material("formula").unwrap();
            Box::new(row.build(&row.examples()[0]).unwrap())
        }
        other => panic!("no closed forms for {other}"),
    }
}

fn names() -> impl Iterator<Item = &'static str> {
    catalogue::materials().iter().map(|row| row.name)
}

fn evaluate(law: &dyn EnergyTerm, f: Mat3) -> check::Evaluation {
    check::evaluate(law, HERE, &Kinematics::new(f).unwrap(), &[])
}

fn assert_close(found: f64, expected: f64, what: &str) {
    assert!((found - expected).abs() <= 1e-11 * (expected.abs() + MU1), "{what}: {found} against {expected}");
}

/// W and dW/dI of the laws of `I = J^(-2/3) |F|^2`, as their papers print them.
fn of_first_invariant(name: &str, i: f64) -> Option<[f64; 2]> {
    let x = i - 3.0;
    Some(match name {
        "yeoh" => [MU1 / 2.0 * x + C20 * x.powi(2) + C30 * x.powi(3), MU1 / 2.0 + 2.0 * C20 * x + 3.0 * C30 * x * x],
        "gent" => [-MU1 * JM / 2.0 * (1.0 - x / JM).ln(), MU1 / 2.0 / (1.0 - x / JM)],
        "arruda_boyce" => {
            let n = LAMBDA_M.powi(2);
            let energy = x / 2.0
                + (i * i - 9.0) / (20.0 * n)
                + 11.0 * (i.powi(3) - 27.0) / (1050.0 * n * n)
                + 19.0 * (i.powi(4) - 81.0) / (7000.0 * n.powi(3))
                + 519.0 * (i.powi(5) - 243.0) / (673_750.0 * n.powi(4));
            let slope = 0.5
                + i / (10.0 * n)
                + 11.0 * i * i / (350.0 * n * n)
                + 19.0 * i.powi(3) / (1750.0 * n.powi(3))
                + 519.0 * i.powi(4) / (134_750.0 * n.powi(4));
            [MU1 * energy, MU1 * slope]
        }
        "holzapfel_gasser_ogden" => [MU1 / 2.0 * x, MU1 / 2.0],
        // 2 log(1 + exp(x/2 - 0.3)), less its value at rest
        "convex_network" => {
            let of = |x: f64| 2.0 * (0.5 * x - 0.3).exp().ln_1p();
            [MU1 * (of(x) - of(0.0)), MU1 / (1.0 + (0.3 - 0.5 * x).exp())]
        }
        "fiber_family" => [0.0, 0.0],
        _ => return None,
    })
}

/// W and dW/dE of the fibres.
fn of_fibers(name: &str, e: f64) -> [f64; 2] {
    if !["holzapfel_gasser_ogden", "fiber_family"].contains(&name) || e <= 0.0 {
        return [0.0; 2];
    }
    assert!(e > TOE, "within the toe: take another state");
    let r = e - TOE / 2.0;
    let grown = (K2 * r * r).exp();
    [K1 / (2.0 * K2) * (grown - 1.0), K1 * r * grown]
}

/// Volumetric part and its derivative.
fn volumetric(name: &str, j: f64) -> [f64; 2] {
    if name == "fiber_family" {
        return [0.0; 2];
    }
    [KAPPA / 4.0 * (j * j - 1.0 - 2.0 * j.ln()), KAPPA / 2.0 * (j - 1.0 / j)]
}

/// Energy and stress of a gel by J alone.
fn gel(j: f64) -> [f64; 2] {
    let [n, c, chi, s] = GEL;
    let mixed = |x: f64| (x - 1.0) * (1.0 - 1.0 / x).ln() + chi * (1.0 - 1.0 / x);
    let slope = |x: f64| (1.0 - 1.0 / x).ln() + 1.0 / x + chi / (x * x);
    let dry = s.powi(3);
    let at_rest = n * (1.0 / s - 1.0 / dry) + c * slope(dry);
    let energy = c / dry * (mixed(dry * j) - mixed(dry)) - n / dry * j.ln() - at_rest * (j - 1.0);
    [energy, c * slope(dry * j) - n / (dry * j) - at_rest]
}

/// Principal Kirchhoff stresses of Ogden's law without the volumetric part.
fn ogden(l: [f64; 3]) -> [f64; 3] {
    let root = (l[0] * l[1] * l[2]).cbrt();
    let of = |i: usize| {
        let term = |[mu, alpha]: &[f64; 2]| {
            let powers = l.map(|l| (l / root).powf(*alpha));
            mu * (powers[i] - powers.iter().sum::<f64>() / 3.0)
        };
        OGDEN.iter().map(term).sum::<f64>()
    };
    [0, 1, 2].map(of)
}

/// dW/dl_i of the energy in principal stretches.
fn principal_stress(name: &str, l: [f64; 3], i: usize) -> f64 {
    let (j, k) = ((i + 1) % 3, (i + 2) % 3);
    let volume = l[0] * l[1] * l[2];
    let side = l[j] * l[k];
    let square = l[0] * l[0] + l[1] * l[1] + l[2] * l[2];
    let mooney = |log: f64, jj: f64| {
        2.0 * MU1 * l[i] + 2.0 * MU2 * l[i] * (l[j] * l[j] + l[k] * l[k]) + 2.0 * jj * (volume - 1.0) * side
            - 2.0 * log / l[i]
    };
    match name {
        "mooney_rivlin" | "formula" => mooney(MU1 + 2.0 * MU2, MU3),
        // |F x|^2 = l0^2, |H x|^2 = (l1 l2)^2.
        "transverse_mooney_rivlin" => {
            let fiber = if i == 0 { l[0] } else { (l[1] * l[2]).powi(2) / l[i] };
            mooney(MU1 + 2.0 * MU2 + MU3, MU4) + 2.0 * MU3 * fiber
        }
        "neo_hooke" => MU1 * (l[i] - 1.0 / l[i]) + LAMBDA * (volume - 1.0) * side,
        "gel" => MU1 * l[i] + gel(volume)[1] * side,
        "neo_hooke_isochoric" => {
            MU1 * volume.powf(-2.0 / 3.0) * (l[i] - square / (3.0 * l[i]))
                + KAPPA / 2.0 * (volume * volume - 1.0) / l[i]
        }
        "ogden" => ogden(l)[i] / l[i] + volumetric(name, volume)[1] * side,
        "saint_venant_kirchhoff" => {
            let e = l.map(|l| (l * l - 1.0) / 2.0);
            l[i] * (LAMBDA * e.iter().sum::<f64>() + 2.0 * MU1 * e[i])
        }
        "arap" => 2.0 * MU1 * (l[i] - 1.0),
        "guccione" => {
            let e = l.map(|l| (l * l - 1.0) / 2.0);
            let b = [B[0], B[1], B[1]];
            let q: f64 = (0..3).map(|i| b[i] * e[i] * e[i]).sum();
            MU1 * q.exp() * l[i] * b[i] * e[i] + volumetric(name, volume)[1] * side
        }
        other => {
            let scale = volume.powf(-2.0 / 3.0);
            let [_, slope] = of_first_invariant(other, scale * square).unwrap();
            let fiber = scale * (DISPERSION * square + (1.0 - 3.0 * DISPERSION) * l[0] * l[0]);
            let own = if i == 0 { 1.0 - 2.0 * DISPERSION } else { DISPERSION };
            slope * 2.0 * scale * (l[i] - square / (3.0 * l[i]))
                + of_fibers(other, fiber - 1.0)[1] * (2.0 * scale * own * l[i] - 2.0 * fiber / (3.0 * l[i]))
                + volumetric(other, volume)[1] * side
        }
    }
}

#[test]
fn stretches_along_the_axes() {
    for name in names() {
        for l in [[1.7, 0.9, 0.8], [0.5, 1.3, 1.1], [2.0, 1.0, 1.0], [0.6, 0.7, 0.9]] {
            let stress = evaluate(&*law(name), Mat3::from_diagonal(&Vec3::from(l))).stress;
            for i in 0..3 {
                assert_close(stress[(i, i)], principal_stress(name, l, i), name);
            }
            assert!((stress - Mat3::from_diagonal(&stress.diagonal())).norm() < 1e-9);
        }
    }
}

/// A free gel in pure solvent has the volume ratio J over its dry network, whatever swollen state is the reference: numbers of the equation
/// `log(1 - 1/J) + 1/J + chi/J^2 + N v (J^(-1/3) - 1/J) = 0`, solved by itself.
#[test]
fn a_free_gel_swells_as_flory_and_rehner_say() {
    for (network, chi, volume) in [(1e-3, 0.1, 38.956632), (1e-3, 0.5, 9.965767), (1e-2, 0.1, 10.979649f64)] {
        let swelling: f64 = 1.5;
        let dry = swelling.powi(3);
        let gel = Gel::new(network, 1.0, chi, swelling).unwrap();
        // mu - mu0 of pure solvent, mu = 0
        let slope = (1.0 - 1.0 / dry).ln() + 1.0 / dry + chi / (dry * dry);
        let pressure = -(network * (1.0 / swelling - 1.0 / dry) + slope);
        let stress = |volume: f64| {
            let k = Kinematics::new(Mat3::identity() * (volume / dry).cbrt()).unwrap();
            let own = check::evaluate(&gel, HERE, &k, &[]).stress
                + check::evaluate(&Turgor::new(), HERE, &k, &[pressure]).stress;
            own[(0, 0)]
        };
        assert!(stress(volume * (1.0 - 1e-7)) < 0.0 && stress(volume * (1.0 + 1e-7)) > 0.0, "{network}, {chi}");
        // the same as a reference: the network is dry at J = 1 / volume
        let free = Gel::in_solvent(network, 1.0, chi).unwrap();
        let dry_at = |j: f64| {
            let k = [Kinematics::new(Mat3::identity() * j.cbrt()).unwrap()];
            let at = PointBatch { kinematics: &k, cell: 0, first: 0 };
            free.check_domain(&at, Slots::none())
        };
        assert!(dry_at((1.0 + 1e-6) / volume).is_ok());
        let outside = dry_at((1.0 - 1e-6) / volume).unwrap_err().to_string();
        assert!(outside.contains("gel") && outside.contains("no solvent is left"), "{outside}");
    }
    let dry = Gel::new(1.0, 1.0, 0.1, 1.0).unwrap_err().to_string();
    assert!(dry.contains("swelling") && dry.contains("above 1"), "{dry}");
    let poor = Gel::new(1.0, 1.0, 0.7, 2.0).unwrap_err().to_string();
    assert!(poor.contains("chi") && poor.contains("at most 1/2"), "{poor}");
}

#[test]
fn dilatation() {
    for name in names() {
        for s in [0.7f64, 0.95, 1.4] {
            let here = evaluate(&*law(name), Mat3::identity() * s);
            let (log, j) = (s.ln(), s.powi(3));
            let mooney = |jj: f64, log_factor: f64| {
                3.0 * MU1 * (s * s - 1.0) + 3.0 * MU2 * (s.powi(4) - 1.0) + jj * (j - 1.0).powi(2)
                    - 6.0 * log_factor * log
            };
            let energy = match name {
                "mooney_rivlin" | "formula" => mooney(MU3, MU1 + 2.0 * MU2),
                "transverse_mooney_rivlin" => mooney(MU4, MU1 + 2.0 * MU2 + MU3) + MU3 * (s * s + s.powi(4) - 2.0),
                "neo_hooke" => 1.5 * MU1 * (s * s - 1.0) - 3.0 * MU1 * log + LAMBDA / 2.0 * (j - 1.0).powi(2),
                "gel" => 1.5 * MU1 * (s * s - 1.0) + gel(j)[0],
                "neo_hooke_isochoric" => KAPPA / 4.0 * (j * j - 1.0 - 6.0 * log),
                "saint_venant_kirchhoff" => (4.5 * LAMBDA + 3.0 * MU1) * ((s * s - 1.0) / 2.0).powi(2),
                "arap" => 3.0 * MU1 * (s - 1.0).powi(2),
                "guccione" => {
                    let e = (s * s - 1.0) / 2.0;
                    MU1 / 2.0 * ((B[0] + 2.0 * B[1]) * e * e).exp_m1() + volumetric(name, j)[0]
                }
                // what is isochoric takes no part
                other => volumetric(other, j)[0],
            };
            assert_close(here.energy, energy, name);
        }
    }
}

/// Simple shear `F = I + g e1 e2`: `W` and the Cauchy stress `P F^T` (J = 1).
#[test]
fn simple_shear() {
    let g = 0.8;
    let mut f = Mat3::identity();
    f[(0, 1)] = g;
    for name in names() {
        let here = evaluate(&*law(name), f);
        let cauchy = here.stress * f.transpose();
        // Energy, shear stress, normal stresses.
        let linear = |modulus: f64, normal: [f64; 3]| (modulus / 2.0 * g * g, modulus * g, normal.map(|n| n * g * g));
        let (energy, shear, normal) = match name {
            "mooney_rivlin" | "formula" => linear(2.0 * (MU1 + MU2), [2.0 * (MU1 + MU2), 0.0, 2.0 * MU2]),
            // H x = x - g y, so |H x|^2 = 1 + g^2, |F x|^2 = 1; the fibre is not stretched, its normal plane is.
            "transverse_mooney_rivlin" => {
                linear(2.0 * (MU1 + MU2 + MU3), [2.0 * (MU1 + MU2 + MU3), 0.0, 2.0 * (MU2 + MU3)])
            }
            "neo_hooke" | "gel" => linear(MU1, [MU1, 0.0, 0.0]),
            "neo_hooke_isochoric" => linear(MU1, [2.0 * MU1 / 3.0, -MU1 / 3.0, -MU1 / 3.0]),
            "saint_venant_kirchhoff" => {
                // S = lambda tr E + 2 mu E with E = (g (e1 e2 + e2 e1) + g^2 e2 e2)/2, sigma = F S F^T
                let side = LAMBDA * g * g / 2.0;
                let (shear, along) = (MU1 * g, side + MU1 * g * g);
                let energy = LAMBDA / 8.0 * g.powi(4) + MU1 * (g * g / 2.0 + g.powi(4) / 4.0);
                (energy, shear + g * along, [side + 2.0 * g * shear + g * g * along, along, side])
            }
            "guccione" => {
                // the same sigma = F S F^T with S = C exp(Q) (b_fs E_12, b_t E_22), and E_11 = 0
                let (e12, e22) = (g / 2.0, g * g / 2.0);
                let q = B[1] * e22 * e22 + 2.0 * B[2] * e12 * e12;
                let (shear, along) = (MU1 * q.exp() * B[2] * e12, MU1 * q.exp() * B[1] * e22);
                let normal = [2.0 * g * shear + g * g * along, along, 0.0];
                (MU1 / 2.0 * q.exp_m1(), shear + g * along, normal)
            }
            "arap" => {
                // R turns by atan(g/2)
                let root = (4.0 + g * g).sqrt();
                let (cos, sin) = (2.0 / root, g / root);
                let p = [[1.0 - cos, g - sin], [sin, 1.0 - cos]].map(|row| row.map(|x| 2.0 * MU1 * x));
                let energy = MU1 * (4.0 + g * g - 2.0 * root);
                (energy, p[0][1], [p[0][0] + g * p[0][1], p[1][1], 0.0])
            }
            "ogden" => {
                // in its plane sigma = c0 + c1 F F^T
                let l = g / 2.0 + (1.0 + g * g / 4.0).sqrt();
                let [first, second, third] = ogden([l, 1.0 / l, 1.0]);
                let c1 = (first - second) / (l * l - 1.0 / (l * l));
                let c0 = first - c1 * l * l;
                let term = |[mu, alpha]: &[f64; 2]| mu / alpha * (l.powf(*alpha) + l.powf(-alpha) - 2.0);
                (OGDEN.iter().map(term).sum(), c1 * g, [c0 + c1 * (1.0 + g * g), c0 + c1, third])
            }
            other => {
                let [energy, slope] = of_first_invariant(other, 3.0 + g * g).unwrap();
                let [fibers, fiber_slope] = of_fibers(other, DISPERSION * g * g);
                let (of_b, of_a) =
                    (2.0 * (slope + DISPERSION * fiber_slope), 2.0 * (1.0 - 3.0 * DISPERSION) * fiber_slope);
                let normal = [2.0 / 3.0, -1.0 / 3.0, -1.0 / 3.0].map(|n| n * (of_b * g * g + of_a));
                (energy + fibers, of_b * g, normal)
            }
        };
        assert_close(here.energy, energy, name);
        assert_close(cauchy[(0, 1)], shear, name);
        assert_close(cauchy[(1, 0)], shear, name);
        for (i, normal) in normal.iter().enumerate() {
            assert_close(cauchy[(i, i)], *normal, &format!("{name} normal stress {i}"));
        }
    }
}

#[test]
fn small_strain_moduli_are_those_of_the_table() {
    for name in names() {
        let found = law(name).moduli(HERE).unwrap();
        let (lambda, mu_t, mu_l, alpha) = match name {
            "mooney_rivlin" | "formula" => (6.8e5, 2.4e5, 2.4e5, 0.0),
            "transverse_mooney_rivlin" => (3.28e6, 2.4e5, 8.4e5, -1.2e6),
            "neo_hooke" => (4e5, 1e5, 1e5, 0.0),
            // N/s^3 + c (x - 2 chi (x - 1)) / (x^2 (x - 1)) - N/s at x = 8
            "gel" => (2.5e4 + 1e7 * 6.6 / 448.0 - 1e5, 1e5, 1e5, 0.0),
            "neo_hooke_isochoric" => (5e5 - 2e5 / 3.0, 1e5, 1e5, 0.0),
            "yeoh" | "gent" | "holzapfel_gasser_ogden" => (5e5 - 2e5 / 3.0, 1e5, 1e5, 0.0),
            "arruda_boyce" => {
                let n = LAMBDA_M.powi(2);
                let ratio = 1.0
                    + 3.0 / (5.0 * n)
                    + 99.0 / (175.0 * n * n)
                    + 513.0 / (875.0 * n.powi(3))
                    + 42_039.0 / (67_375.0 * n.powi(4));
                (5e5 - 2e5 / 3.0 * ratio, 1e5 * ratio, 1e5 * ratio, 0.0)
            }
            "ogden" => (5e5 - 2.0 / 3.0 * 4.16e5, 4.16e5, 4.16e5, 0.0),
            "fiber_family" => (0.0, 0.0, 0.0, 0.0),
            "convex_network" => {
                let mu = 2e5 / (1.0 + 0.3f64.exp());
                (5e5 - 2.0 / 3.0 * mu, mu, mu, 0.0)
            }
            "saint_venant_kirchhoff" => (4e5, 1e5, 1e5, 0.0),
            "arap" => (0.0, 1e5, 1e5, 0.0),
            "guccione" => (5e5, 1.25e4, 2.5e4, 0.0),
            other => panic!("no moduli for {other}"),
        };
        for (found, expected) in [(found.lambda, lambda), (found.mu_t, mu_t), (found.mu_l, mu_l), (found.alpha, alpha)]
        {
            assert_close(found, expected, name);
        }
        assert_eq!(found.beta, 0.0);
    }
}

#[test]
fn engineering_constants_come_back() {
    let x = Vec3::x();
    let young = |term: &dyn EnergyTerm| term.moduli(HERE).unwrap().young(&x).unwrap();
    for share in [0.55, 0.8, 0.99] {
        let law = MooneyRivlin::from_young_poisson(3e5, 0.4, share).unwrap();
        assert_close(young(&law), 3e5, "young");
        assert_close(law.fiber_limit(HERE, &x).unwrap(), 3e5 / 2.8 * share, "mu1 carries the share");
        let law = MooneyRivlin::from_shear_bulk(1e5, 7e5, share).unwrap().moduli(HERE).unwrap();
        assert_close(law.mu_t, 1e5, "shear");
        assert_close(law.bulk(), 7e5, "bulk");
    }
    for nu in [0.0, 0.25, 0.49] {
        assert_close(young(&NeoHooke::from_young_poisson(3e5, nu).unwrap()), 3e5, "young");
    }
    for nu in [-0.5, 0.0, 0.49] {
        assert_close(young(&NeoHookeIsochoric::from_young_poisson(3e5, nu).unwrap()), 3e5, "young");
    }
    assert_close(NeoHooke::from_shear_bulk(1e5, 7e5).unwrap().moduli(HERE).unwrap().bulk(), 7e5, "bulk");
    assert_eq!(NeoHooke::from_young_poisson(3e5, 0.0).unwrap().moduli(HERE).unwrap().lambda, 0.0);
}

/// With `lambda = 0` the neo-Hookean stretches part: `mu (l - 1/l) = m l` along the fibre, 1 across it.
#[test]
fn free_cube_under_fiber_tension() {
    let law = NeoHooke::new(MU1, 0.0).unwrap();
    let a = Vec3::new(1.0, 2.0, -2.0) / 3.0;
    for m in [-4e5, -1e4, 3e4, 9e4] {
        let f = check::free_cube(&law, &FiberTension::along(a).unwrap(), HERE, &[m]).unwrap();
        let expected = 1.0 / (1.0 - m / MU1).sqrt();
        let across = Mat3::identity() - a * a.transpose();
        assert!((f - across - a * a.transpose() * expected).norm() < 1e-10, "{m}: {f}");
    }
}

/// `l - 1/l = (m/mu) l^2`, the root nearest to one.
#[test]
fn free_cube_under_turgor() {
    let law = NeoHooke::new(MU1, 0.0).unwrap();
    for m in [-5e4, 2e4, 3.5e4] {
        let f = check::free_cube(&law, &Turgor::new(), HERE, &[m]).unwrap();
        let l = f[(0, 0)];
        assert!((f - Mat3::identity() * l).norm() < 1e-12);
        assert!((l - 1.0 / l - m / MU1 * l * l).abs() < 1e-11, "{m}: {l}");
        assert_eq!(l > 1.0, m > 0.0);
    }
}

/// At `m = 2 mu1` the growth along the fibre is lost, yet the block stays in one piece: stretch 2.34 for
/// mu = (1, 0.2, 5); well beyond, it runs away.
#[test]
fn free_cube_at_and_beyond_the_limit() {
    let law = MooneyRivlin::new(1.0, 0.2, 5.0).unwrap();
    let tension = FiberTension::along(Vec3::x()).unwrap();
    assert_eq!(law.fiber_limit(HERE, &Vec3::x()), Some(2.0));
    let f = check::free_cube(&law, &tension, HERE, &[2.0]).unwrap();
    assert!((f[(0, 0)] - 2.34).abs() < 0.005, "{f}");
    assert!(check::free_cube(&law, &tension, HERE, &[3.5]).is_err());
}
