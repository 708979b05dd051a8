//! Rates and momentum of motions.

use super::scene::Scene;
use super::{Check, Found};
use crate::solve::Solved;
use nastic::fem::{Instant, Scheme, State, TimeStep};
use nastic::prelude::Vec3;
use std::sync::Arc;

/// Of momentum, over the sum of what its steps bring and take.
const MOMENTUM: f64 = 1e-7;
/// Of velocities and accelerations by the formula of the scheme.
const RATES: f64 = 1e-8;

pub(super) fn check(scene: &Scene, solved: &Solved, scheme: &Scheme, found: &mut Found) {
    if scheme.is_quasi_static() {
        return;
    }
    mass(scene, &solved.states[0], found);
    if solved.states.iter().any(|state| state.report.cuts > 0) {
        return;
    }
    rates(scene, solved, scheme, found);
    if scene.facts().held.is_empty() {
        momentum(scene, solved, scheme, found);
    }
}

fn mass(scene: &Scene, state: &State, found: &mut Found) {
    let all = scene.problem.solid.model().quantities(&Instant::of(state)).unwrap_or_default();
    let told = all.iter().find(|(_, what, _)| *what == "mass").map_or(f64::NAN, |own| own.2);
    let along = vec![Vec3::x(); scene.places.len()];
    let own: f64 = scene.momentum(&along).iter().map(|p| p.x).sum();
    found.add("mass", (own / told - 1.0).abs(), RATES);
}

fn rates(scene: &Scene, solved: &Solved, scheme: &Scheme, found: &mut Found) {
    let states = &solved.states;
    let dofs = scene.dim * scene.places.len();
    let field =
        |values: &Option<Arc<Vec<f64>>>| values.as_ref().map_or_else(|| vec![0.0; dofs], |v| v[..dofs].to_vec());
    for n in 1..states.len() {
        let h = states[n].time - states[n - 1].time;
        let (v, a) = (field(&states[n].velocity), field(&states[n].acceleration));
        let (u, before) = (&states[n].u[..dofs], &states[n - 1].u[..dofs]);
        let old = field(&states[n - 1].velocity);
        // rounding of places in a quotient counts, of second order too: the program makes accelerations of places
        let rounding = 1e-6 * scene.size() / h;
        let slow = largest(&v) + rounding;
        let off = |formula: &dyn Fn(usize) -> f64, of: &[f64], size: f64| {
            (0..dofs).map(|i| (formula(i) - of[i]).abs()).fold(0.0, f64::max) / size
        };
        match scheme.name() {
            "backward_euler" => {
                found.add("velocity of backward_euler", off(&|i| (u[i] - before[i]) / h, &v, slow), RATES);
                let size = largest(&a) + 1e-3 * largest(&v) / h + rounding / h;
                found.add("acceleration of backward_euler", off(&|i| (v[i] - old[i]) / h, &a, size), RATES);
            }
            "bdf2" if n > 1 => {
                let older = field(&states[n - 2].velocity);
                let formula = |i: usize| (1.5 * v[i] - 2.0 * old[i] + 0.5 * older[i]) / h;
                found.add(
                    "acceleration of bdf2",
                    off(&formula, &a, largest(&a) + 1e-3 * largest(&v) / h + rounding / h),
                    RATES,
                );
            }
            _ => {}
        }
    }
}

fn largest(of: &[f64]) -> f64 {
    of.iter().fold(0.0, |most, x| most.max(x.abs()))
}

/// Of a body that nothing but obstacles and its weight act on: by steps of backward Euler the momentum changes by the reported forces; where
/// nothing acts it stays, by any scheme.
fn momentum(scene: &Scene, solved: &Solved, scheme: &Scheme, found: &mut Found) {
    let facts = scene.facts();
    let total = |state: &State| -> (Vec3, f64) {
        let v = state.velocity.as_ref().map_or_else(|| vec![Vec3::zeros(); scene.places.len()], |v| scene.vectors(v));
        let p = scene.momentum(&v);
        (p.iter().sum(), p.iter().map(|p| p.norm()).sum())
    };
    let weight: Vec3 = scene.weight().iter().sum();
    let (begin, mut scale) = total(&solved.states[0]);
    let alone = facts.touching.is_empty() && weight.norm() == 0.0;
    if !alone && scheme.name() != "backward_euler" {
        return;
    }
    let (mut gained, mut worst) = (Vec3::zeros(), Check { name: "momentum", off: 0.0, most: MOMENTUM });
    for pair in solved.states.windows(2) {
        let h = pair[1].time - pair[0].time;
        let step = TimeStep::between(&pair[0], &pair[1]);
        let touches = scene.problem.solid.model().contacts().touches(&Instant::of(&pair[1]).in_step(&step));
        let of_obstacle = |name: &str| facts.touching.iter().any(|touching| touching.name == name);
        let push: Vec3 =
            touches.iter().filter(|(name, _)| of_obstacle(name)).map(|(_, touch)| Vec3::from(touch.force)).sum();
        gained += h * (push + weight);
        let (now, size) = total(&pair[1]);
        scale = scale.max(size).max(gained.norm());
        worst.off = worst.off.max((now - begin - gained).norm() / scale);
    }
    found.add(worst.name, worst.off, worst.most);
}
