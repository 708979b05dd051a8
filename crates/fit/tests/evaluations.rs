//! What a fit of bars with fibres takes: points at which the law is asked for stresses.
#![allow(clippy::unwrap_used)] // a test may

use nastic_energy::catalogue::{FitForm, FitNumber, FitStarts, Made, MaterialRow, Parameter};
use nastic_energy::{EnergyTerm, Field, MaterialPoint, PointBatch, Response as Answer, Slot, Slots, Want};
use nastic_fit::{Fibers, FitOptions, Law, Mode, Response, Test, curve, fit};
use nastic_tensor::{Mat3, Vec3};
use std::sync::atomic::{AtomicUsize, Ordering};

static POINTS: AtomicUsize = AtomicUsize::new(0);

/// `W = mu/2 |F|^2 + k/4 (|F a|^2 - 1)^2`, a along x, at constant volume; counts the points.
#[derive(Debug)]
struct Counted {
    mu: Field<f64>,
    k: Field<f64>,
}

impl EnergyTerm for Counted {
    fn slots(&self) -> &[Slot] {
        &[]
    }

    fn stress_by_control(&self, _: &PointBatch, _: Slots, _: &mut [Mat3]) {}

    fn respond(&self, at: &PointBatch, _: Slots, _: Want, out: &mut Answer) {
        POINTS.fetch_add(at.len(), Ordering::Relaxed);
        for (q, stress) in out.stress.iter_mut().enumerate() {
            let (f, place) = (at.kinematics[q].f(), at.place(q));
            let fa: Vec3 = f * Vec3::x();
            *stress +=
                f * self.mu.at(place) + fa * Vec3::x().transpose() * (self.k.at(place) * (fa.norm_squared() - 1.0));
        }
    }

    fn direction(&self, _: MaterialPoint) -> Option<Vec3> {
        Some(Vec3::x())
    }
}

const NUMBERS: [FitNumber; 2] = [FitNumber::modulus("mu", 1.0), FitNumber::modulus("k", 1.0)];
static COUNTED: MaterialRow = MaterialRow::new(
    "counted",
    "a matrix with a stiff direction",
    &[&[
        Parameter::number("mu", "Pa", 1e5),
        Parameter::number("k", "Pa", 1e5),
        Parameter::number("bulk", "Pa", 1e8),
        Parameter::direction("fiber", [1.0, 0.0, 0.0]),
    ]],
    |given| Ok(Made::term(Counted { mu: given.number("mu")?, k: given.number("k")? })),
)
.fitted(&[FitForm { families: 1, shear: Some(|p| p[0]), ..FitForm::new(&NUMBERS, FitStarts::At(&[&[-0.5, -0.5]])) }]);

/// The sides of the bars are sought once for every step, not at every difference of a derivative: that took more than twice as many points.
#[test]
fn sides_of_bars_are_sought_once_for_every_step() {
    let law = Law::among([&COUNTED])[0];
    let at: Vec<f64> = (1..=30).map(|k| 1.0 + 0.02 * f64::from(k)).collect();
    let bar = |fibers: Fibers| {
        let made = law.incompressible(&[2e4, 5e4]).unwrap();
        let stresses = curve(&*made, Mode::Uniaxial, fibers, Response::Nominal, &at);
        let points = at.iter().zip(stresses).map(|(x, y)| [*x, y]).collect();
        Test::new("bar", Mode::Uniaxial, Response::Nominal, points).unwrap().loaded(fibers).unwrap()
    };
    let tests = [bar(Fibers::Along), bar(Fibers::Across)];
    POINTS.store(0, Ordering::Relaxed);
    let found = fit(law, &tests, &FitOptions::default()).unwrap();
    let points = POINTS.load(Ordering::Relaxed);
    for (found, expected) in found.values().iter().zip([2e4, 5e4]) {
        assert!((found / expected - 1.0).abs() < 1e-6, "{found} for {expected}");
    }
    println!("{points} points");
    assert!(points < 15_000, "{points}");
}
