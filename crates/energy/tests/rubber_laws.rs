//! Laws of rubber and tissue against the literature: incompressible tests, limits of one law in another, coinciding stretches,
//! the borders of their domains and of their parameters.
#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use nastic_energy::{
    Arap, ArrudaBoyce, EnergyTerm, Existence, FiberFamily, Field, Gent, Growth, HolzapfelGasserOgden, MaterialPoint,
    MooneyRivlin, NeoHookeIsochoric, Ogden, PointBatch, SaintVenantKirchhoff, Slots, TransverseMooneyRivlin, Yeoh,
    check,
};
use nastic_tensor::{Kinematics, Mat3, Vec3};

const HERE: MaterialPoint = MaterialPoint { cell: 0, point: 0 };

fn ogden(terms: &[[f64; 2]], bulk: f64) -> Ogden {
    Ogden::new(terms.iter().map(|pair| pair.map(Field::from)).collect(), bulk).unwrap()
}

fn diagonal(l: [f64; 3]) -> Mat3 {
    Mat3::from_diagonal(&Vec3::from(l))
}

fn evaluate(law: &dyn EnergyTerm, f: Mat3) -> check::Evaluation {
    check::evaluate(law, HERE, &Kinematics::new(f).unwrap(), &[])
}

/// Cauchy stress along axis `i` less that along axis `k`, at constant volume.
fn difference(law: &dyn EnergyTerm, l: [f64; 3], i: usize, k: usize) -> f64 {
    let stress = evaluate(law, diagonal(l)).stress;
    stress[(i, i)] * l[i] - stress[(k, k)] * l[k]
}

fn assert_close(found: f64, expected: f64, what: &str) {
    assert!((found - expected).abs() <= 1e-10 * (expected.abs() + 1.0), "{what}: {found} against {expected}");
}

/// sigma = 2 phi' (l^2 - 1/l), 2 phi' (l^2 - l^-4), 2 phi' (l^2 - l^-2) in tension, equibiaxial tension, pure shear; Ogden's
/// sum mu (l^alpha - l^(-alpha/2)), (l^alpha - l^(-2 alpha)), (l^alpha - l^-alpha).
#[test]
fn incompressible_tests() {
    let (mu, jm, n) = (2.0, 50.0, 9.0f64);
    for l in [0.6f64, 1.3, 2.5, 4.0] {
        let tests = [
            ("tension", [l, l.powf(-0.5), l.powf(-0.5)], l * l - 1.0 / l),
            ("equibiaxial", [l, l, l.powi(-2)], l * l - l.powi(-4)),
            ("pure shear", [l, 1.0, 1.0 / l], l * l - l.powi(-2)),
        ];
        for (name, stretches, factor) in tests {
            let i = stretches.iter().map(|l| l * l).sum::<f64>();
            let x = i - 3.0;
            let laws: [(Box<dyn EnergyTerm>, f64); 3] = [
                (Box::new(Yeoh::new(1.0, -0.01, 2e-3, 1e3).unwrap()), 1.0 - 0.02 * x + 6e-3 * x * x),
                (Box::new(Gent::new(mu, jm, 1e3).unwrap()), mu / 2.0 * jm / (jm - x)),
                (
                    Box::new(ArrudaBoyce::new(mu, n.sqrt(), 1e3).unwrap()),
                    mu * (0.5
                        + i / (10.0 * n)
                        + 33.0 * i * i / (1050.0 * n * n)
                        + 76.0 * i.powi(3) / (7000.0 * n.powi(3))
                        + 2595.0 * i.powi(4) / (673_750.0 * n.powi(4))),
                ),
            ];
            for (law, slope) in &laws {
                if name != "equibiaxial" || x < jm {
                    assert_close(
                        difference(&**law, stretches, 0, 2),
                        2.0 * slope * factor,
                        &format!("{name} {l} {law:?}"),
                    );
                }
            }
            let terms = [[6.3, 1.3], [0.012, 5.0], [-0.1, -2.0]];
            let other = stretches[2];
            let expected: f64 = terms.iter().map(|[mu, alpha]| mu * (l.powf(*alpha) - other.powf(*alpha))).sum();
            assert_close(difference(&ogden(&terms, 1e3), stretches, 0, 2), expected, &format!("{name} {l} ogden"));
        }
    }
}

/// Powers 2 and -2 are the two invariants: `sigma = 2 (C10 + C01/l) (l^2 - 1/l)` with C10 = mu1/2, C01 = -mu2/2.
#[test]
fn ogden_of_powers_two_is_mooney_rivlin() {
    let (c10, c01) = (0.7, 0.2);
    let law = ogden(&[[2.0 * c10, 2.0], [-2.0 * c01, -2.0]], 1e3);
    let states = check::states();
    for k in &states {
        let here = check::evaluate(&law, HERE, k, &[]);
        let (i1, i2) = (k.j().powf(-2.0 / 3.0) * k.f().norm_squared(), k.j().powf(-4.0 / 3.0) * k.h().norm_squared());
        let volumetric = 250.0 * (k.j() * k.j() - 1.0 - 2.0 * k.j().ln());
        assert_close(here.energy, c10 * (i1 - 3.0) + c01 * (i2 - 3.0) + volumetric, "energy");
    }
    for l in [0.5f64, 1.2, 3.0] {
        let s = l.powf(-0.5);
        assert_close(difference(&law, [l, s, s], 0, 2), 2.0 * (c10 + c01 / l) * (l * l - 1.0 / l), "tension");
    }
}

/// Gent with J_m -> inf, Arruda-Boyce with N -> inf, Ogden with alpha = 2, Yeoh with C20 = C30 = 0, without fibres in the way.
#[test]
fn limits_are_the_neo_hookean_law() {
    let neo = NeoHookeIsochoric::new(2.0, 30.0).unwrap();
    let laws: [Box<dyn EnergyTerm>; 4] = [
        Box::new(Gent::new(2.0, 1e14, 30.0).unwrap()),
        Box::new(ArrudaBoyce::new(2.0, 1e7, 30.0).unwrap()),
        Box::new(ogden(&[[2.0, 2.0]], 30.0)),
        Box::new(Yeoh::new(1.0, 0.0, 0.0, 30.0).unwrap()),
    ];
    for k in check::states() {
        let expected = check::evaluate(&neo, HERE, &k, &[]);
        let scale = expected.tangent.0.iter().map(|c| c.abs()).fold(0.0, f64::max);
        for law in &laws {
            let found = check::evaluate(&**law, HERE, &k, &[]);
            assert!((found.energy - expected.energy).abs() < 1e-11 * scale, "{law:?}");
            assert!((found.stress - expected.stress).norm() < 1e-11 * scale, "{law:?}");
            let error = found.tangent.0.iter().zip(&expected.tangent.0).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(error < 1e-11 * scale, "{law:?}: {error}");
        }
    }
}

/// A dispersion of 1/3 leaves no direction; of 0 the fibres are those of 2000: no stress where they are shorter.
#[test]
fn dispersion_from_aligned_to_isotropic() {
    let law = |dispersion: f64, a: Vec3| {
        let fibers = [5.0, 0.4, dispersion, 1e-2].map(Field::from);
        HolzapfelGasserOgden::new([1.0, 30.0].map(Field::from), fibers, a, None).unwrap()
    };
    let (one, other) = (law(1.0 / 3.0, Vec3::x()), law(1.0 / 3.0, Vec3::new(0.0, 0.6, -0.8)));
    for k in check::states() {
        let [a, b] = [&one, &other].map(|law| check::evaluate(law, HERE, &k, &[]));
        assert!((a.stress - b.stress).norm() < 1e-11 * (1.0 + a.stress.norm()));
    }
    let neo = NeoHookeIsochoric::new(1.0, 30.0).unwrap();
    let aligned = law(0.0, Vec3::x());
    for l in [0.7f64, 0.95] {
        let f = diagonal([l, l.powf(-0.5), l.powf(-0.5)]);
        let apart = evaluate(&aligned, f).stress - evaluate(&neo, f).stress;
        assert!(apart.norm() < 1e-14, "fibres bear no compression");
    }
    // sigma = mu (l^2 - 1/l) + 2 (4/3...): W' = mu (l - l^-2) + 2 k1 r l exp(k2 r^2), r = l^2 - 1 - toe/2
    let l = 1.2f64;
    let r = l * l - 1.0 - 5e-3;
    let expected = l * l - 1.0 / l + 2.0 * 5.0 * r * l * l * (0.4 * r * r).exp();
    assert_close(difference(&aligned, [l, l.powf(-0.5), l.powf(-0.5)], 0, 2), expected, "along the fibres");
}

/// Two families in a matrix are the sum of the law of one and of a family by itself.
#[test]
fn families_add_up() {
    let (a, b) = (Vec3::new(0.6, 0.8, 0.0), Vec3::new(0.6, -0.8, 0.0));
    let fibers = || [5.0, 0.4, 0.1, 1e-2].map(Field::from);
    let matrix = || [1.0, 30.0].map(Field::from);
    let both = HolzapfelGasserOgden::new(matrix(), fibers(), a, Some(b.into())).unwrap();
    let one = HolzapfelGasserOgden::new(matrix(), fibers(), a, None).unwrap();
    let family = FiberFamily::new(5.0, 0.4, 0.1, b).unwrap();
    for k in check::states() {
        let [both, one, family] =
            [&both as &dyn EnergyTerm, &one, &family].map(|law| check::evaluate(law, HERE, &k, &[]));
        assert!((both.stress - one.stress - family.stress).norm() < 1e-11 * (1.0 + both.stress.norm()));
    }
}

/// The switch of the fibres has three continuous derivatives: within its toe, at its ends, and where it is wide.
#[test]
fn the_toe_is_smooth() {
    let law = FiberFamily::new(1.0, 0.4, 0.1, Vec3::new(0.6, 0.8, 0.0)).unwrap().with_toe(20.0).unwrap();
    for k in check::states() {
        derivatives_by_differences(&law, *k.f());
    }
    let jump = |e: f64| {
        let law = FiberFamily::new(1.0, 0.4, 0.0, Vec3::x()).unwrap().with_toe(0.1).unwrap();
        let third = |e: f64| {
            let l = (1.0 + e).sqrt();
            let k = [Kinematics::new(diagonal([l, l.powf(-0.5), l.powf(-0.5)])).unwrap()];
            let at = PointBatch { kinematics: &k, cell: 0, first: 0 };
            let (change, mut out) = ([diagonal([1.0, 0.0, 0.0])], [Mat3::zeros()]);
            let slots = nastic_energy::Slots::none();
            law.second_stress_change(&at, slots, [&change, &change], &mut out).unwrap();
            out[0][(0, 0)]
        };
        (third(e + 1e-9) - third(e - 1e-9)).abs()
    };
    assert!(jump(0.0) < 1e-4 && jump(0.1) < 1e-4, "{} {}", jump(0.0), jump(0.1));
}

/// Stretches that coincide exactly, nearly, or to the last digit: all derivatives of Ogden's law against differences.
#[test]
fn coinciding_stretches() {
    let laws: [Box<dyn EnergyTerm>; 3] = [
        Box::new(ogden(&[[6.3, 1.3], [0.012, 5.0], [-0.1, -2.0]], 30.0)),
        Box::new(ogden(&[[-2.0, -0.7]], 5.0)),
        Box::new(Arap::new(2.0).unwrap()),
    ];
    let [turn, other] = [check::rotations()[0], check::rotations()[3]];
    for stretches in [
        [1.0, 1.0, 1.0],
        [1.4, 1.4, 0.6],
        [0.8, 0.8, 0.8],
        [1.4, 1.4 + 1e-9, 0.6],
        [0.9, 0.9 + 1e-15, 0.9 - 1e-7],
        [1.0, 1.04, 0.97],
    ] {
        let f = turn * diagonal(stretches) * other;
        for law in &laws {
            derivatives_by_differences(&**law, f);
        }
    }
}

fn derivatives_by_differences(law: &dyn EnergyTerm, f: Mat3) {
    let direction = |phase: f64| Mat3::from_fn(|i, j| (phase + 1.7 * i as f64 + 2.9 * j as f64).sin() / 3.0);
    let (a, b) = (direction(0.4), direction(2.2));
    let change = |f: Mat3, a: &Mat3| evaluate(law, f).tangent.apply(a);
    let step = 2e-3;
    let slope = |of: &dyn Fn(f64) -> Mat3| {
        ((of(1.0) - of(-1.0)) * 45.0 - (of(2.0) - of(-2.0)) * 9.0 + (of(3.0) - of(-3.0))) / (60.0 * step)
    };
    let here = evaluate(law, f);
    let scale = here.tangent.0.iter().map(|c| c.abs()).fold(1.0, f64::max); // moduli are about 1
    let energies = slope(&|t| Mat3::repeat(evaluate(law, f + a * (t * step)).energy))[(0, 0)];
    assert!((here.stress.dot(&a) - energies).abs() < 1e-10 * scale, "{law:?} stress at {f}");
    let stresses = slope(&|t| evaluate(law, f + a * (t * step)).stress);
    assert!((stresses - change(f, &a)).norm() < 1e-10 * scale, "{law:?} tangent at {f}");
    let tangents = slope(&|t| change(f + b * (t * step), &a));
    let k = [Kinematics::new(f).unwrap()];
    let mut out = [Mat3::zeros()];
    let at = PointBatch { kinematics: &k, cell: 0, first: 0 };
    law.second_stress_change(&at, nastic_energy::Slots::none(), [&[a], &[b]], &mut out).unwrap();
    assert!(
        (tangents - out[0]).norm() < 1e-9 * scale,
        "{law:?} third derivative at {f}: {}",
        (tangents - out[0]).norm() / scale
    );
}

#[test]
fn beyond_the_domain() {
    let at = |f: Mat3| Kinematics::new(f).unwrap();
    let found = |law: &dyn EnergyTerm, k: &[Kinematics]| {
        law.check_domain(&PointBatch { kinematics: k, cell: 0, first: 0 }, Slots::none())
    };
    let gent = Gent::new(1e5, 10.0, 1e6).unwrap();
    let inside = at(diagonal([3.5, 3.5f64.powf(-0.5), 3.5f64.powf(-0.5)]));
    let outside = at(diagonal([3.7, 3.7f64.powf(-0.5), 3.7f64.powf(-0.5)]));
    assert!(found(&gent, &[inside]).is_ok());
    let error = found(&gent, &[inside, outside]).unwrap_err();
    assert_eq!((error.law, error.point, error.limit), ("gent", 1, 10.0));
    assert!((error.value - (3.7 * 3.7 + 2.0 / 3.7 - 3.0)).abs() < 1e-12);
    assert!(check::evaluate(&gent, HERE, &inside, &[]).energy.is_finite());
    assert!(error.to_string().starts_with("gent: J^(-2/3) |F|^2 - 3 = 1.12"), "{error}");
    let fibers = FiberFamily::new(1e5, 40.0, 0.0, Vec3::x()).unwrap();
    assert!(found(&fibers, &[inside]).unwrap_err().to_string().contains("k2 E^2"));
    assert!(found(&fibers, &[at(Mat3::identity())]).is_ok());
}

#[test]
fn parameters_out_of_range_are_named() {
    let message = |error: nastic_energy::EnergyError| error.to_string();
    let error = message(Yeoh::new(1.0, -0.2, 0.01, 10.0).unwrap_err());
    assert_eq!(
        error,
        "yeoh: c20 = -2e-1, but it must be at least -sqrt(3 c10 c30): below, the energy falls with the stretch somewhere"
    );
    assert!(Yeoh::new(1.0, -0.17, 0.01, 10.0).is_ok());
    let terms = |pairs: &[[f64; 2]]| Ogden::new(pairs.iter().map(|pair| pair.map(Field::from)).collect(), 10.0);
    let error = message(terms(&[[1.0, 2.0], [0.5, -2.0]]).unwrap_err());
    assert_eq!(error, "ogden: mu2 = 5e-1, but it must have the sign of its alpha: mu alpha > 0 for every term");
    assert!(message(terms(&[]).unwrap_err()).contains("1 to 4 terms"));
    assert!(message(Gent::new(1.0, 0.0, 1.0).unwrap_err()).contains("jm"));
    assert!(message(ArrudaBoyce::new(1.0, 1.0, 1.0).unwrap_err()).contains("lambda_m"));
    assert!(message(FiberFamily::new(1.0, 1.0, 0.4, Vec3::x()).unwrap_err()).contains("[0, 1/3]"));
    assert!(message(SaintVenantKirchhoff::from_shear_bulk(1.0, 0.5).unwrap_err()).contains("2 shear / 3"));
}

/// Laws that are marked: waves that do not move, and energies that do not grow.
#[test]
fn laws_that_are_not_polyconvex_lose_ellipticity() {
    for law in [&SaintVenantKirchhoff::new(4e5, 1e5).unwrap() as &dyn EnergyTerm, &Arap::new(1e5).unwrap()] {
        assert!(!law.existence(HERE).unwrap().polyconvex);
        // along e1 e2: two stretches of 0.3
        let mut wave = Mat3::zeros();
        wave[(0, 1)] = 1.0;
        let curvature = wave.dot(&evaluate(law, diagonal([0.3, 0.3, 1.0])).tangent.apply(&wave));
        assert!(curvature < -1e4, "{law:?} is elliptic where it is said not to be: {curvature}");
        assert!(check::growth(law, HERE).is_err(), "{law:?} grows");
    }
}

#[test]
fn conditions_of_existence_by_parameters() {
    let of = |law: &dyn EnergyTerm| law.existence(HERE).unwrap();
    let yeoh = |c20: f64, c30: f64| of(&Yeoh::new(1.0, c20, c30, 10.0).unwrap());
    assert!(yeoh(0.1, 0.01).holds());
    assert!(!yeoh(0.1, 0.0).holds() && yeoh(0.1, 0.0).polyconvex);
    assert!(!yeoh(-0.1, 0.01).polyconvex && yeoh(-0.1, 0.01).growth.is_coercive());
    // with the cofactor the volume grows too, for J^2 <= |H|^3 up to a factor: no term of J is needed
    let mooney = |mu2: f64, mu3: f64| of(&MooneyRivlin::new(1.0, mu2, mu3).unwrap());
    assert!(mooney(0.1, 0.0).holds() && !mooney(0.0, 1.0).growth.is_coercive());
    let transverse = |mu2: f64, mu4: f64| of(&TransverseMooneyRivlin::new(1.0, mu2, 1.0, mu4, Vec3::x()).unwrap());
    assert!(transverse(0.1, 0.0).holds() && !transverse(0.0, 1.0).growth.is_coercive());
    assert!(of(&Gent::new(1.0, 10.0, 10.0).unwrap()).holds());
    assert!(!of(&NeoHookeIsochoric::new(1.0, 10.0).unwrap()).growth.is_coercive());
    // Treloar's rubber: 1.3 is less than 3/2, and its growth (p = 30/11, q = 6/5) less than what the theorem asks for
    assert!(!of(&ogden(&[[6.3, 1.3], [0.012, 5.0], [-0.1, -2.0]], 30.0)).polyconvex);
    assert!(of(&ogden(&[[6.3, 2.0], [0.012, 6.0]], 30.0)).holds());
    assert!(of(&ogden(&[[6.3, 3.0], [-0.012, -6.0]], 30.0)).holds());
    let growth = |p: f64, q: f64, r: f64| Growth { p, q, r };
    assert!(growth(2.0, 2.0, 2.0).is_coercive() && !growth(2.0, 0.0, 2.0).is_coercive());
    assert!(!growth(2.0, 0.0, 0.0).balances_pressure() && growth(2.0, 2.0, 0.0).balances_pressure());
    let sum = yeoh(0.1, 0.01).and(of(&FiberFamily::new(1.0, 1.0, 0.0, Vec3::x()).unwrap()));
    assert_eq!(sum, Existence { polyconvex: true, resists_collapse: true, growth: Growth::isochoric(3.0) });
}

/// Where fibres work: `E = 0.5` with the default toe of 0.01, at other volumes than 1 and turned, so that no curvature of the toe
/// helps. In equibiaxial stretch l of any volume all fibres of the plane have `E = d (2 l^2 + l^-4) + (1 - 3 d) l^2 - 1`.
#[test]
fn derivatives_of_fibers_beyond_the_toe() {
    let [turn, other] = [check::rotations()[1], check::rotations()[4]];
    for dispersion in [0.0, 0.1, 0.3] {
        let strain = |l: f64| dispersion * (2.0 * l * l + l.powi(-4)) + (1.0 - 3.0 * dispersion) * l * l - 1.0;
        let bisect = |(low, high): (f64, f64), _| {
            let middle = 0.5 * (low + high);
            if strain(middle) < 0.5 { (middle, high) } else { (low, middle) }
        };
        let (l, _) = (0..60).fold((1.0, 3.0), bisect);
        assert_close(strain(l), 0.5, "strain of the fibres");
        let [first, second] = [0.6f64, -0.6].map(|angle| other.transpose() * Vec3::new(angle.cos(), angle.sin(), 0.0));
        let family = FiberFamily::new(1.0, 1.5, dispersion, first).unwrap();
        let fibers = [1.0, 1.5, dispersion, FiberFamily::TOE].map(Field::from);
        let both = HolzapfelGasserOgden::new([0.8, 5.0].map(Field::from), fibers, first, Some(second.into())).unwrap();
        for volume in [0.8f64, 1.0, 1.3] {
            let f = turn * diagonal([l, l, l.powi(-2)]) * other * volume.cbrt();
            derivatives_by_differences(&family, f);
            derivatives_by_differences(&both, f);
            let energy = (1.5 * (0.5f64 - 0.005).powi(2)).exp_m1() / 3.0;
            assert_close(evaluate(&family, f).energy, energy, "energy of one family");
        }
    }
}
