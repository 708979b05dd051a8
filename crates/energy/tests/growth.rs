//! Laws behind a strain map: every derivative by F, by their own slots and by growth; the stress-free state; the domain.

#![allow(clippy::unwrap_used, clippy::panic)] // a test may

use nastic_energy::catalogue::{self, Inputs};
use nastic_energy::{
    Dielectric, EnergyTerm, FiberTension, Gent, Grown, GrowthTensor, KinematicGrowth, Magnet, MaterialPoint,
    MaxwellBranch, MooneyRivlin, NeoHooke, PointBatch, ShapeGradient, Slots, SpontaneousStrain, StrainMap,
    ThermalExpansion, Turgor, check,
};
use nastic_tensor::{HyperDual, Kinematics, Mat3, Vec3};
use std::sync::Arc;

const HERE: MaterialPoint = MaterialPoint { cell: 0, point: 0 };

/// `G = exp(g_1) (1 + g_2 a (x) b)`: not symmetric, not linear in its two slots.
#[derive(Debug, Clone)]
struct Sheared(KinematicGrowth);

impl StrainMap for Sheared {
    fn tensor(&self, _: MaterialPoint, g: &[HyperDual]) -> [[HyperDual; 3]; 3] {
        let scale = nastic_tensor::Scalar::exp(g[0]);
        let one = |i: usize, k: usize| HyperDual::constant(f64::from(u8::from(i == k)));
        let shear = |i: usize, k: usize| if (i, k) == (0, 2) { g[1] } else { HyperDual::constant(0.0) };
        std::array::from_fn(|i| std::array::from_fn(|k| scale * (one(i, k) + shear(i, k))))
    }
}

const TWO: [nastic_energy::Slot; 2] =
    [nastic_energy::Slot::scalar("swell", "1"), nastic_energy::Slot::scalar("shear", "1")];

impl EnergyTerm for Sheared {
    fn respond(&self, at: &PointBatch, m: Slots, want: nastic_energy::Want, out: &mut nastic_energy::Response) {
        self.0.respond(at, m, want, out);
    }

    fn slots(&self) -> &[nastic_energy::Slot] {
        &TWO
    }

    fn stress_by_control(&self, _: &PointBatch, _: Slots, out: &mut [Mat3]) {
        out.fill(Mat3::zeros());
    }

    fn strain_map(&self) -> Option<&dyn StrainMap> {
        Some(self)
    }
}

const A: Vec3 = Vec3::new(0.6, 0.0, 0.8);

/// Maps with values of their slots.
fn maps() -> Vec<(Arc<dyn EnergyTerm>, Vec<f64>)> {
    let growth = KinematicGrowth::isotropic();
    let turned = SpontaneousStrain::elastomer(A).unwrap().with_direction_slots().unwrap();
    vec![
        (Arc::new(growth.clone()), vec![0.15]),
        (Arc::new(KinematicGrowth::across(A).unwrap()), vec![0.15]),
        (Arc::new(Sheared(growth)), vec![-0.1, 0.3]),
        (turned, vec![-0.2, 0.3, 0.7, -0.4]),
        (Arc::new(GrowthTensor::new()), vec![0.2, -0.1, 0.05, 0.1, -0.15, 0.2]),
        (Arc::new(ShapeGradient::new(3, None).unwrap()), vec![0.2, -0.1, 0.05, 0.1, -0.15, 0.2, 0.0, 0.07, 0.1]),
    ]
}

/// G of a map, without derivatives.
fn tensor(map: &dyn EnergyTerm, g: &[f64]) -> Mat3 {
    let numbers: Vec<HyperDual> = g.iter().map(|x| HyperDual::constant(*x)).collect();
    let g = map.strain_map().unwrap().tensor(HERE, &numbers);
    Mat3::from_fn(|i, k| g[i][k].real())
}

#[test]
fn laws_with_slots_of_their_own_keep_their_contract_behind_every_map() {
    let film = Dielectric::new(2.5e-11, Vec3::z()).unwrap();
    let inputs = Inputs::new().number("young", 1e5).number("poisson", 0.4).number("share", 0.7);
    let by_young = catalogue::material("mooney_rivlin").unwrap().parametrised(&inputs, &["young", "poisson"]).unwrap();
    // turgor is left out: its stress does not depend on growth, and rounding is nothing to compare with
    let laws: [(Arc<dyn EnergyTerm>, &[f64]); 5] = [
        (Arc::new(MooneyRivlin::new(1e5, 2e4, 1e6).unwrap()), &[]),
        (Arc::new(FiberTension::along(Vec3::x()).unwrap()), &[4e4]),
        (Arc::new(Magnet::new()), &[0.1, 0.05, 0.0, 0.0, 0.02, 0.01]),
        (Arc::new(film), &[3e7]),
        (by_young, &[1.2e5, 0.35]),
    ];
    for ((law, own), (map, of_map)) in laws.iter().flat_map(|law| maps().into_iter().map(move |map| (law, map))) {
        let grown = Grown::new(law.clone(), map.clone()).unwrap();
        let m = [*own, &of_map].concat();
        let report = check::actuation(&grown, HERE, &m).unwrap_or_else(|e| panic!("{law:?} behind {map:?}: {e}"));
        let names: Vec<_> = report.findings.iter().map(|finding| finding.check).collect();
        assert_eq!(names.len(), 9, "{law:?} behind {map:?}: {names:?}");
    }
}

#[test]
fn a_body_that_grows_freely_has_no_stress() {
    let law = Arc::new(MooneyRivlin::new(1e5, 2e4, 1e6).unwrap());
    for (map, m) in maps() {
        let g = tensor(&*map, &m);
        let grown = Grown::new(law.clone(), map).unwrap();
        let found = check::evaluate(&grown, HERE, &Kinematics::new(g).unwrap(), &m);
        assert!(found.stress.norm() < 1e-7 && found.energy.abs() < 1e-9, "{found:?}");
        assert!(check::evaluate(&grown, HERE, &Kinematics::rest(), &m).stress.norm() > 1e3);
    }
}

/// G of every kind by its formula, along A and across it.
#[test]
fn every_kind_has_the_tensor_of_its_formula() {
    let (along, across) = (A * A.transpose(), Mat3::identity() - A * A.transpose());
    let keeping = |l: f64| along * l + across / l.sqrt();
    let of: [(Arc<dyn EnergyTerm>, &[f64], Mat3); 8] = [
        (Arc::new(KinematicGrowth::along(A).unwrap()), &[0.2], along * 1.2 + across),
        (Arc::new(KinematicGrowth::across(A).unwrap()), &[0.2], along + across * 1.2),
        (Arc::new(ThermalExpansion::isotropic(2e-4).unwrap()), &[-50.0], Mat3::identity() * 0.99),
        (Arc::new(ThermalExpansion::along(A, 3e-4, -1e-4).unwrap()), &[100.0], along * 1.03 + across * 0.99),
        (Arc::new(SpontaneousStrain::elastomer(A).unwrap()), &[-0.36], keeping(0.64)),
        (Arc::new(SpontaneousStrain::muscle(A).unwrap()), &[0.36], keeping(0.64)),
        // the direction that is written gives way to that of the slots, of whatever length
        (
            SpontaneousStrain::muscle(Vec3::y()).unwrap().with_direction_slots().unwrap(),
            &[0.36, 1.2, 0.0, 1.6],
            keeping(0.64),
        ),
        (
            Arc::new(GrowthTensor::new()),
            &[0.1, 0.2, 0.3, 0.04, 0.05, 0.06],
            Mat3::new(1.1, 0.06, 0.05, 0.06, 1.2, 0.04, 0.05, 0.04, 1.3),
        ),
    ];
    for (map, g, expected) in of {
        assert!((tensor(&*map, g) - expected).norm() < 1e-15, "{map:?}: {}", tensor(&*map, g));
        assert_eq!(tensor(&*map, &vec![0.0; map.slots().len()][..1]), Mat3::identity(), "{map:?} at rest");
    }
    assert!((keeping(0.64).determinant() - 1.0).abs() < 1e-15);
}

/// Each says what it takes, and the shortening of a muscle is not negative.
#[test]
fn values_that_leave_nothing_are_outside_in_the_words_of_their_kind() {
    let of: [(Arc<dyn EnergyTerm>, &[f64], &str); 6] = [
        (Arc::new(KinematicGrowth::isotropic()), &[-1.0], "growth must stay above -1"),
        (Arc::new(SpontaneousStrain::elastomer(A).unwrap()), &[-1.0], "strain must stay above -1"),
        (Arc::new(SpontaneousStrain::muscle(A).unwrap()), &[1.0], "shortening must stay below 1"),
        (
            Arc::new(ThermalExpansion::isotropic(1e-2).unwrap()),
            &[-100.0],
            "1 + expansion * temperature must stay positive",
        ),
        (Arc::new(GrowthTensor::new()), &[0.0, 0.0, 0.0, 0.0, 0.0, 1.0], "must be positive definite"),
        // turned over twice, with a positive determinant
        (Arc::new(GrowthTensor::new()), &[-2.0, 0.0, -2.0, 0.0, 0.0, 0.0], "must be positive definite"),
    ];
    let k = [Kinematics::rest()];
    let batch = PointBatch { kinematics: &k, cell: 0, first: 0 };
    for (map, g, said) in of {
        let grown = Grown::new(Arc::new(NeoHooke::new(1e5, 4e5).unwrap()), map.clone()).unwrap();
        let inside: Vec<f64> = g.iter().map(|g| 0.99 * g).collect();
        let is_turned = g[0] == -2.0;
        assert_eq!(grown.check_domain(&batch, Slots::by_point(&inside, g.len())).is_ok(), !is_turned, "{map:?}");
        assert_eq!(map.strain_map().unwrap().admits(HERE, &inside), !is_turned, "{map:?}");
        let outside = grown.check_domain(&batch, Slots::by_point(g, g.len())).unwrap_err().to_string();
        assert!(outside.contains(said), "{outside}");
    }
    let pulls = |map: &dyn EnergyTerm| map.slots()[0].not_negative;
    assert!(pulls(&SpontaneousStrain::muscle(A).unwrap()) && !pulls(&SpontaneousStrain::elastomer(A).unwrap()));
    let long = SpontaneousStrain::elastomer(Vec3::new(0.0, 2.0, 0.0)).unwrap_err().to_string();
    assert!(long.contains("lce") && long.contains("direction"), "{long}");
    assert!(ThermalExpansion::isotropic(f64::NAN).unwrap_err().to_string().contains("expansion"));
}

#[test]
fn what_leaves_nothing_of_the_volume_or_the_law_is_outside() {
    let gent = Arc::new(Gent::new(1e5, 0.5, 1e6).unwrap());
    let grown = Grown::new(gent, Arc::new(KinematicGrowth::isotropic())).unwrap();
    let at = |f: f64| [Kinematics::new(Mat3::from_diagonal(&Vec3::new(f, 1.0 / f, 1.0))).unwrap()];
    let outside = |k: &[Kinematics], g: f64| {
        let at = PointBatch { kinematics: k, cell: 0, first: 0 };
        grown.check_domain(&at, Slots::by_point(&[g], 1)).err()
    };
    assert!(outside(&at(1.0), 0.2).is_none());
    assert_eq!(outside(&at(1.0), -1.0).unwrap().law, "growth");
    assert_eq!(outside(&at(2.0), 0.0).unwrap().law, "gent");
    // twice reflected in its plane, with a determinant of 1
    let across = Grown::new(Arc::new(Turgor::new()), Arc::new(KinematicGrowth::across(Vec3::z()).unwrap())).unwrap();
    let k = at(1.0);
    let at = PointBatch { kinematics: &k, cell: 0, first: 0 };
    assert!(across.check_domain(&at, Slots::by_point(&[0.0, -2.0], 2)).is_err());
}

#[test]
fn what_has_an_energy_maps_no_strains() {
    let law = Arc::new(Turgor::new());
    let refused = Grown::new(law.clone(), law).unwrap_err().to_string();
    assert!(refused.contains("maps no strains"), "{refused}");
}

/// Internal variables are those at `F G^-1`; their derivatives by F, by those before and by growth against differences.
#[test]
fn a_viscous_law_flows_as_it_grows() {
    let law = Arc::new(MaxwellBranch::new(3e4, 0.2).unwrap());
    let grown = Grown::new(law, Arc::new(KinematicGrowth::isotropic())).unwrap();
    let evolution = grown.evolution().unwrap();
    let f = Mat3::new(1.2, 0.3, 0.0, -0.1, 0.9, 0.2, 0.1, 0.0, 1.05);
    let mut slots = vec![0.02, 0.01, 0.0, -0.01, 0.03, 0.0, 0.0, 0.01, -0.02, 0.0, 0.1];
    evolution.set_step(HERE, 0.1, &mut slots[..10]);
    let advanced = |f: Mat3, slots: &[f64]| {
        let mut next = slots.to_vec();
        evolution.advance(HERE, &Kinematics::new(f).unwrap(), slots, &mut next);
        next
    };
    let by_next: Vec<f64> = (0..11).map(|k| if k < 9 { 0.3 + 0.1 * f64::from(k) } else { 0.0 }).collect();
    let (mut by_f, mut by_slots) = (Mat3::zeros(), vec![0.0; 11]);
    evolution.advance_vjp(HERE, &Kinematics::new(f).unwrap(), &slots, &by_next, &mut by_f, &mut by_slots);
    let value = |f: Mat3, slots: &[f64]| advanced(f, slots).iter().zip(&by_next).map(|(x, w)| x * w).sum::<f64>();
    let (h, direction) = (1e-5, Mat3::new(0.3, -0.2, 0.1, 0.5, 0.1, -0.4, 0.2, 0.3, -0.1));
    let difference = (value(f + direction * h, &slots) - value(f - direction * h, &slots)) / (2.0 * h);
    assert!((difference - by_f.dot(&direction)).abs() < 1e-7 * difference.abs().max(1.0));
    for k in (0..9).chain([10]) {
        let along = |h: f64| {
            let mut moved = slots.clone();
            moved[k] += h;
            value(f, &moved)
        };
        let difference = (along(h) - along(-h)) / (2.0 * h);
        assert!(
            (difference - by_slots[k]).abs() < 1e-7 * difference.abs().max(1.0),
            "{k}: {difference} {}",
            by_slots[k]
        );
    }
}
