//! Laws behind a strain map: every derivative by F, by their own slots and by growth; the stress-free state; the domain.

#![allow(clippy::unwrap_used, clippy::panic)] // a test may

use nastic_energy::catalogue::{self, Inputs};
use nastic_energy::{
    Dielectric, EnergyTerm, FiberTension, Gent, Grown, KinematicGrowth, Magnet, MaterialPoint, MaxwellBranch,
    MooneyRivlin, PointBatch, Slots, StrainMap, Turgor, check,
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

fn maps() -> [Arc<dyn EnergyTerm>; 3] {
    let growth = KinematicGrowth::isotropic();
    let a = Vec3::new(0.6, 0.0, 0.8);
    [Arc::new(growth.clone()), Arc::new(KinematicGrowth::across(a).unwrap()), Arc::new(Sheared(growth))]
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
    for ((law, own), map) in laws.iter().flat_map(|law| maps().map(|map| (law, map))) {
        let grown = Grown::new(law.clone(), map.clone()).unwrap();
        let of_map: &[f64] = if map.slots().len() == 1 { &[0.15] } else { &[-0.1, 0.3] };
        let m = [*own, of_map].concat();
        let report = check::actuation(&grown, HERE, &m).unwrap_or_else(|e| panic!("{law:?} behind {map:?}: {e}"));
        let names: Vec<_> = report.findings.iter().map(|finding| finding.check).collect();
        assert_eq!(names.len(), 9, "{law:?} behind {map:?}: {names:?}");
    }
}

#[test]
fn a_body_that_grows_freely_has_no_stress() {
    let law = Arc::new(MooneyRivlin::new(1e5, 2e4, 1e6).unwrap());
    for map in maps() {
        let m: &[f64] = if map.slots().len() == 1 { &[0.3] } else { &[0.2, -0.4] };
        let numbers: Vec<HyperDual> = m.iter().map(|x| HyperDual::constant(*x)).collect();
        let g = map.strain_map().unwrap().tensor(HERE, &numbers);
        let g = Mat3::from_fn(|i, k| g[i][k].real());
        let grown = Grown::new(law.clone(), map).unwrap();
        let found = check::evaluate(&grown, HERE, &Kinematics::new(g).unwrap(), m);
        assert!(found.stress.norm() < 1e-7 && found.energy.abs() < 1e-9, "{found:?}");
        assert!(check::evaluate(&grown, HERE, &Kinematics::rest(), m).stress.norm() > 1e3);
    }
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
