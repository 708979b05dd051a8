//! Laws with a number in front: every derivative by F, by that number and by the slots of the law; values; mistakes.

#![allow(clippy::unwrap_used, clippy::panic)] // a test may

use nastic_energy::{
    Dielectric, EnergyTerm, FiberFamily, FiberTension, Gent, KinematicGrowth, LinearInModuli, Magnet, MaterialPoint,
    MaxwellBranch, MooneyRivlin, NeoHooke, Parametrised, PointBatch, Scale, Shared, Slots, Weighted, check,
};
use nastic_tensor::{Kinematics, Mat3, Vec3};
use std::sync::Arc;

const HERE: MaterialPoint = MaterialPoint { cell: 0, point: 0 };
const SIMP: Scale = Scale::Simp { floor: 1e-4, exponent: 3.0 };
const RAMP: Scale = Scale::Ramp { floor: 1e-4, penalty: 5.0 };

fn rubber() -> MooneyRivlin {
    MooneyRivlin::new(1e5, 2e4, 1e6).unwrap()
}

fn laws() -> Vec<(Arc<dyn EnergyTerm>, Vec<f64>)> {
    vec![
        (Arc::new(rubber()), vec![]),
        (Arc::new(Parametrised::new(rubber())), vec![1.2e5, 1.5e4, 8e5]),
        (Arc::new(FiberTension::along(Vec3::x()).unwrap()), vec![4e4]),
        (Arc::new(Magnet::new()), vec![0.1, 0.05, 0.0, 0.0, 0.02, 0.01]),
    ]
}

fn assert_contract(law: &Weighted, m: &[f64]) {
    let report = check::actuation(law, HERE, m).unwrap_or_else(|error| panic!("{law:?}: {error}"));
    assert_eq!(report.findings.len(), 9, "{law:?}: {:?}", report.findings);
}

#[test]
fn laws_keep_their_contract_behind_every_scale() {
    for (law, own) in laws() {
        for (scale, s) in [
            (SIMP, 0.6),
            (RAMP, 0.4),
            (Scale::Mooney, 0.2),
            (Scale::Guth, 0.15),
            (Scale::Hill, 0.1),
            (Scale::Factor, 0.7),
            (Scale::Electrode, 0.7),
        ] {
            assert_contract(&Weighted::scaled("s", law.clone(), scale).unwrap(), &[&[s][..], &own].concat());
        }
    }
}

#[test]
fn laws_keep_their_contract_in_mixtures() {
    let soft: Arc<dyn EnergyTerm> = Arc::new(NeoHooke::new(2e4, 8e4).unwrap());
    for (law, own) in laws() {
        let m = [&[0.3][..], &own].concat();
        assert_contract(&Weighted::mixture("share", soft.clone(), law.clone()).unwrap(), &m);
        assert_contract(&Weighted::mixture("share", law, soft.clone()).unwrap(), &m);
    }
    // a mixture of what is scaled, and scaled once more
    let filled = Arc::new(Weighted::scaled("phi", soft, Scale::Guth).unwrap());
    let mixed = Arc::new(Weighted::mixture("share", filled, Arc::new(Parametrised::new(rubber()))).unwrap());
    assert_contract(&Weighted::scaled("s", mixed, SIMP).unwrap(), &[0.7, 0.4, 0.1, 1.2e5, 1.5e4, 8e5]);
}

/// A name of a design is that of its slot, and none twice.
#[test]
fn numbers_in_front_have_names() {
    let named = |law: Arc<dyn EnergyTerm>, name| Weighted::scaled(name, law, Scale::Factor);
    let inner = named(Arc::new(FiberTension::along(Vec3::x()).unwrap()), "phi").unwrap();
    assert_eq!(inner.slots().iter().map(|slot| slot.group).collect::<Vec<_>>(), ["phi", "tension"]);
    let inner: Arc<dyn EnergyTerm> = Arc::new(inner);
    let both = named(inner.clone(), "rho").unwrap();
    assert_eq!(both.slots().iter().map(|slot| slot.group).collect::<Vec<_>>(), ["rho", "phi", "tension"]);
    assert_contract(&both, &[0.7, 0.4, 4e4]);
    assert!(named(inner, "phi").is_err());
}

/// The weights by their formulas, derivatives by differences.
#[test]
fn scales_are_their_formulas() {
    let s: f64 = 0.3;
    let expected = [
        (SIMP, 1e-4 + (1.0 - 1e-4) * s.powi(3)),
        (RAMP, 1e-4 + (1.0 - 1e-4) * s / (1.0 + 5.0 * (1.0 - s))),
        (Scale::Mooney, (2.5 * s / (1.0 - 1.35 * s)).exp()),
        (Scale::Guth, 1.0 + 2.5 * s + 14.1 * s * s),
        (Scale::Hill, 1.0 / (1.0 - 2.5 * s)),
        (Scale::Factor, s),
        (Scale::Electrode, s * s),
    ];
    for (scale, value) in expected {
        let [chi, first, second] = scale.derivatives(s);
        assert!((chi / value - 1.0).abs() < 1e-14, "{}: {chi} {value}", scale.name());
        let h = 1e-5;
        let [above, below] = [h, -h].map(|h| scale.derivatives(s + h));
        assert!(((above[0] - below[0]) / (2.0 * h) / first - 1.0).abs() < 1e-7, "{}", scale.name());
        let bent = (above[1] - below[1]) / (2.0 * h);
        assert!((bent - second).abs() < 1e-7 * (1.0 + second), "{}", scale.name());
    }
    assert_eq!(SIMP.derivatives(0.0), [1e-4, 0.0, 0.0]);
    assert_eq!(Scale::Simp { floor: 0.5, exponent: 1.0 }.derivatives(0.0), [0.5, 0.5, 0.0]);
    for (scale, rest) in [(SIMP, 1.0), (RAMP, 1.0), (Scale::Mooney, 0.0), (Scale::Guth, 0.0), (Scale::Hill, 0.0)] {
        assert!((scale.derivatives(rest)[0] - 1.0).abs() < 1e-14);
    }
}

#[test]
fn weighted_laws_are_sums() {
    let k = Kinematics::new(Mat3::new(1.2, 0.3, 0.0, -0.1, 0.9, 0.2, 0.1, 0.0, 1.05)).unwrap();
    let at = |law: &dyn EnergyTerm, m: &[f64]| check::evaluate(law, HERE, &k, m);
    let [soft, stiff] = [2e4, 9e4].map(|mu| NeoHooke::new(mu, 4.0 * mu).unwrap());
    let mixed = Weighted::mixture("share", Arc::new(soft.clone()), Arc::new(stiff.clone())).unwrap();
    let (a, b, both) = (at(&soft, &[]), at(&stiff, &[]), at(&mixed, &[0.25]));
    assert!((both.energy - (0.75 * a.energy + 0.25 * b.energy)).abs() < 1e-12 * b.energy);
    assert!((both.stress - (a.stress * 0.75 + b.stress * 0.25)).norm() < 1e-12 * b.stress.norm());
    // scaling neo-Hooke's moduli is scaling the law
    let scaled = Weighted::scaled("s", Arc::new(soft.clone()), Scale::Guth).unwrap();
    let stiffer = soft.with_moduli(&soft.own().iter().map(|(_, field)| 1.641 * field.at(HERE)).collect::<Vec<_>>());
    assert!((at(&scaled, &[0.14256]).stress.norm() / at(&stiffer, &[]).stress.norm() - 1.0).abs() < 0.01);
    // nothing given: at rest
    assert_eq!(at(&mixed, &[0.0]).stress, a.stress);
    assert_eq!(mixed.moduli(HERE), soft.moduli(HERE));
    let (stated, own) = (mixed.existence(HERE).unwrap(), soft.existence(HERE).unwrap());
    assert!(stated.polyconvex && stated.resists_collapse && stated.growth == own.growth.implied(), "{stated:?}");
    // at a share of 1 fibres alone are left, which do not resist collapse
    let fibers: Arc<dyn EnergyTerm> = Arc::new(FiberFamily::new(5e4, 0.8, 0.1, Vec3::x()).unwrap());
    let mixed = Weighted::mixture("share", Arc::new(soft.clone()), fibers).unwrap().existence(HERE).unwrap();
    assert!(soft.existence(HERE).unwrap().resists_collapse && !mixed.resists_collapse && mixed.polyconvex);
}

/// The breakdown of a film is judged behind a density too.
#[test]
fn a_film_is_judged_behind_a_density() {
    let film = || Arc::new(Dielectric::new(2.5e-11, Vec3::z()).unwrap());
    let scaled = Weighted::scaled("s", film(), RAMP).unwrap();
    assert_eq!(scaled.point_quantity().map(|own| own.name), film().point_quantity().map(|own| own.name));
    let k = [Kinematics::new(Mat3::from_diagonal(&Vec3::new(1.1, 1.1, 0.8))).unwrap()];
    let at = PointBatch { kinematics: &k, cell: 0, first: 0 };
    let (mut own, mut behind) = ([0.0], [0.0]);
    film().point_values(&at, Slots::by_point(&[3e7], 1), &mut own);
    scaled.point_values(&at, Slots::by_point(&[0.4, 3e7], 2), &mut behind);
    assert!(own[0] > 1e7 && own == behind, "{own:?} {behind:?}");
    let passive = Arc::new(rubber());
    assert!(Weighted::mixture("share", passive, film()).unwrap().point_quantity().is_some());
}

#[test]
fn numbers_out_of_range_are_outside_and_mistakes_are_named() {
    let gent = Arc::new(Gent::new(1e5, 0.5, 1e6).unwrap());
    let filled = Weighted::scaled("s", gent, Scale::Hill).unwrap();
    let outside = |f: f64, s: f64| {
        let k = [Kinematics::new(Mat3::from_diagonal(&Vec3::new(f, 1.0 / f, 1.0))).unwrap()];
        let at = PointBatch { kinematics: &k, cell: 0, first: 0 };
        filled.check_domain(&at, Slots::by_point(&[s], 1)).err().map(|outside| outside.law)
    };
    assert_eq!([outside(1.0, 0.1), outside(1.0, 0.5), outside(1.0, -0.1)], [None, Some("hill"), Some("hill")]);
    assert_eq!(outside(2.0, 0.1), Some("gent"));
    // rounding of sums of shape functions
    let void = Weighted::scaled("s", Arc::new(rubber()), Scale::Simp { floor: 1e-3, exponent: 2.5 }).unwrap();
    for (s, chi) in [(1.0 + f64::EPSILON, 1.0), (-1e-15, 1e-3)] {
        let k = [Kinematics::new(Mat3::from_diagonal(&Vec3::new(1.2, 1.0, 1.0))).unwrap()];
        let at = PointBatch { kinematics: &k, cell: 0, first: 0 };
        assert!(void.check_domain(&at, Slots::by_point(&[s], 1)).is_ok());
        let energies = [check::evaluate(&void, HERE, &k[0], &[s]), check::evaluate(&rubber(), HERE, &k[0], &[])];
        assert!((energies[0].energy / (chi * energies[1].energy) - 1.0).abs() < 1e-12);
    }
    assert!(Shared::new(KinematicGrowth::isotropic()).is_err());
    // where chi is infinite
    assert_eq!(outside(1.0, 0.4), Some("hill"));
    let k = [Kinematics::rest()];
    let at = PointBatch { kinematics: &k, cell: 0, first: 0 };
    let dense = Weighted::scaled("s", Arc::new(rubber()), Scale::Mooney).unwrap();
    assert!(dense.check_domain(&at, Slots::by_point(&[0.74], 1)).is_err());
    assert!(dense.check_domain(&at, Slots::by_point(&[0.3], 1)).is_ok());
    let refused = |scale| Weighted::scaled("s", Arc::new(rubber()), scale).unwrap_err().to_string();
    assert!(refused(Scale::Simp { floor: 0.0, exponent: 3.0 }).contains("floor"));
    assert!(refused(Scale::Simp { floor: 0.1, exponent: 1.5 }).contains("exponent"));
    assert!(refused(Scale::Ramp { floor: 0.1, penalty: -1.0 }).contains("penalty"));
    let wrapped = |law: Arc<dyn EnergyTerm>| Weighted::scaled("s", law, SIMP).unwrap_err().to_string();
    assert!(wrapped(Arc::new(KinematicGrowth::isotropic())).contains("no energy of its own"));
    assert!(wrapped(Arc::new(MaxwellBranch::new(3e4, 0.2).unwrap())).contains("internal variables"));
    let by_mu = || Arc::new(Parametrised::new(NeoHooke::new(1e5, 4e5).unwrap()));
    let twice = Weighted::mixture("share", by_mu(), by_mu()).unwrap_err().to_string();
    assert!(twice.contains("of the same name"), "{twice}");
}
