//! Energies by own masses and laws against the ledger; that it closes; that no scheme creates energy unsaid.

use super::scene::Scene;
use super::{ENERGY, Found};
use crate::problem::Failure;
use crate::solve::Solved;
use nastic::fem::{EnergyBalance, EnergyLedger, Scheme};

/// What may be left in a ledger over the largest span of its entries, without friction and with.
const CLOSED: [f64; 2] = [1e-6, 1e-4];
/// From which share of the largest span on a warning says that a scheme adds energy.
const WARNED: f64 = 0.02;

pub(super) fn check(scene: &Scene, solved: &Solved, scheme: &Scheme, found: &mut Found) -> Result<(), Failure> {
    let model = scene.problem.solid.model();
    let mut ledger = EnergyLedger::new(model, scheme, &model.controls())?;
    let (mut all, mut own) = (Vec::<EnergyBalance>::new(), Vec::new());
    for state in &solved.states {
        let balance = ledger.add(model, state)?;
        let u = scene.vectors(&model.displacement(&state.u));
        let forces = scene.forces(&u, None, 0.0);
        let moves = state.velocity.as_ref().filter(|_| !scheme.is_quasi_static());
        let kinetic: f64 = moves.map_or(0.0, |v| {
            let v = scene.vectors(v);
            scene.momentum(&v).iter().zip(&v).map(|(p, v)| p.dot(v) / 2.0).sum()
        });
        let work: f64 = scene.weight().iter().zip(&u).map(|(force, u)| force.dot(u)).sum();
        all.push(balance);
        own.push([kinetic, forces.elastic, work]);
    }
    let span = span(&all);
    let at_rest = own[0][2];
    for (balance, [kinetic, elastic, work]) in all.iter().zip(&own) {
        found.add("kinetic energy", (balance.kinetic - kinetic).abs() / span, ENERGY);
        found.add("elastic energy", (balance.elastic - elastic).abs() / span, ENERGY);
        found.add("work of the weight", (balance.load_work - (work - at_rest)).abs() / span, ENERGY);
        let friction = scene.facts().friction > 0.0;
        found.add("ledger that closes", balance.unbalanced.abs() / span, CLOSED[usize::from(friction)]);
    }
    let held = |(balance, [kinetic, elastic, work]): (&EnergyBalance, &[f64; 3])| {
        let driven = balance.pressure_work + balance.drive_work + balance.support_work + balance.obstacle_work;
        kinetic + elastic + balance.contact - work - driven
    };
    let rise = rise(all.iter().zip(&own).map(held)) / span;
    let mut returned = 0.0;
    let mut before = all.first().copied();
    let created = all.iter().map(|balance| {
        let fell = before.replace(*balance).map_or(0.0, |before| before.friction_loss - balance.friction_loss);
        returned += fell.max(0.0);
        balance.scheme + returned
    });
    let told = self::rise(created) / span;
    // a warning stands where the scheme's share is told to be that large
    found.add("energy that rises unsaid", if told > WARNED { 0.0 } else { rise }, WARNED + 1e-6);
    Ok(())
}

/// The largest span of an entry of physics.
fn span(all: &[EnergyBalance]) -> f64 {
    let of = |entry: usize| {
        let values = || all.iter().map(|balance| balance.entries()[entry]);
        values().fold(if entry == 0 { 0.0 } else { f64::NEG_INFINITY }, f64::max)
            - values().fold(f64::INFINITY, f64::min)
    };
    (0..EnergyBalance::PHYSICAL).map(of).fold(f64::MIN_POSITIVE, f64::max)
}

/// The largest rise from any instant to a later one.
fn rise(values: impl Iterator<Item = f64>) -> f64 {
    let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
    for value in values {
        least = least.min(value);
        most = most.max(value - least);
    }
    most
}
