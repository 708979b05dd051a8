//! The balance of energy of motions: what schemes add by the closed forms of their amplification, works by hand, and sums that close.

#![allow(clippy::unwrap_used)] // helpers of tests

use crate::common;

use common::block::STRICT;
use common::motion::{motion, oscillator, schemes, steps, uniform};
use common::{Outcome, regular};
use nalgebra::{Complex, DMatrix};
use nastic_energy::{FiberTension, KelvinVoigt, MaxwellBranch, NeoHooke};
use nastic_fem::{
    Contact, Controls, EnergyBalance, EnergyLedger, Inertia, MovingSupport, Scheme, Solid, State, StepTo, TimeStepping,
    Trajectory, Workspace,
};
use nastic_mesh::CellKind;
use nastic_mesh::spatial::Obstacle;
use nastic_tensor::Vec3;

type C = Complex<f64>;

/// The balance at every state of a motion.
fn ledger(solid: &Solid, scheme: &Scheme, run: &Trajectory) -> Outcome<Vec<EnergyBalance>> {
    let mut ledger = EnergyLedger::new(solid.model(), scheme, &run.end().controls)?;
    run.states().iter().map(|state| Ok(ledger.add(solid.model(), state)?)).collect()
}

fn span(all: &[EnergyBalance], entry: usize) -> f64 {
    let values = || all.iter().map(|balance| balance.entries()[entry]);
    values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
}

/// Of the entries of physics the largest span.
fn largest_span(all: &[EnergyBalance]) -> f64 {
    (0..EnergyBalance::PHYSICAL).map(|entry| span(all, entry)).fold(0.0, f64::max)
}

/// `(u, v, a)` of one free unknown after a unit step.
fn amplification(solid: &Solid, scheme: &Scheme) -> Outcome<DMatrix<f64>> {
    let free = solid.supports().fixed().iter().position(|fixed| !fixed).unwrap();
    let mut matrix = DMatrix::zeros(3, 3);
    for k in 0..3 {
        let unit: [f64; 3] = std::array::from_fn(|i| if i == k { 1.0 } else { 0.0 });
        let run = motion(solid, scheme, uniform(solid, unit[0], unit[1], Some(unit[2])), 1, 1.0)?;
        let end = run.end();
        let entry = |values: &Option<std::sync::Arc<Vec<f64>>>| values.as_ref().map_or(0.0, |v| v[free]);
        matrix.set_column(
            k,
            &nalgebra::DVector::from_vec(vec![end.u[free], entry(&end.velocity), entry(&end.acceleration)]),
        );
    }
    Ok(matrix)
}

/// The principal eigenvalue and its vector, by the null space of `A - R`.
fn principal(matrix: &DMatrix<f64>) -> Option<(C, [C; 3])> {
    let root = matrix
        .complex_eigenvalues()
        .iter()
        .filter(|e| e.im > 0.0)
        .max_by(|a, b| a.norm().total_cmp(&b.norm()))
        .copied()?;
    let row = |i: usize| -> [C; 3] {
        std::array::from_fn(|j| C::from(matrix[(i, j)]) - if i == j { root } else { C::from(0.0) })
    };
    let cross =
        |a: [C; 3], b: [C; 3]| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let size = |v: &[C; 3]| v.iter().map(|c| c.norm_sqr()).sum::<f64>();
    let candidates = [cross(row(0), row(1)), cross(row(1), row(2)), cross(row(0), row(2))];
    let vector = candidates.into_iter().max_by(|a, b| size(a).total_cmp(&size(b)))?;
    Some((root, vector.map(|c| c / size(&vector).sqrt())))
}

/// Of the real and the imaginary part of the principal mode together a scheme adds `(|R|^2 - 1) E` in every step.
#[test]
fn a_scheme_adds_to_an_oscillator_what_its_amplification_says() -> Outcome {
    let mut seen = Vec::new();
    for (scheme, _) in schemes()?.into_iter().filter(|(scheme, _)| {
        // quasi_static has no oscillator; modes of siere are exact; bdf2 begins by another scheme: below
        !scheme.is_quasi_static() && scheme.exact_modes() == 0 && scheme.start().is_none()
    }) {
        for w in [0.1, 1.0, 10.0] {
            let solid = oscillator(w, 0.0)?;
            let found = principal(&amplification(&solid, &scheme)?);
            let Some((root, mode)) = found else { continue };
            seen.push(scheme.name());
            let mut sums = [[0.0; 2]; 5];
            for part in [mode.map(|c| c.re), mode.map(|c| c.im)] {
                let run = motion(&solid, &scheme, uniform(&solid, part[0], part[1], Some(part[2])), 4, 1.0)?;
                for (sum, balance) in sums.iter_mut().zip(ledger(&solid, &scheme, &run)?) {
                    sum[0] += balance.kinetic + balance.elastic;
                    sum[1] += balance.scheme;
                }
            }
            for pair in sums.windows(2) {
                let (share, expected) = (pair[1][1] - pair[0][1], (root.norm_sqr() - 1.0) * pair[0][0]);
                let off = (share - expected).abs() / pair[0][0];
                assert!(off < 1e-8, "{}, h w = {w}: {share:e}, not {expected:e}", scheme.name());
            }
        }
    }
    seen.dedup();
    assert_eq!(
        seen,
        [
            "backward_euler",
            "tr_bdf2",
            "trapezoidal",
            "implicit_midpoint",
            "newmark",
            "generalized_alpha",
            "linearly_implicit_euler"
        ]
    );
    Ok(())
}

/// Of bdf2, when its other root has died out: two motions, a quarter of a turn apart.
#[test]
fn bdf2_adds_what_its_amplification_says() -> Outcome {
    let scheme = Scheme::bdf2();
    for w in [0.1, 1.0] {
        let solid = oscillator(w, 0.0)?;
        let modulus = scheme.amplification(w, 0.0)?.modulus;
        let mut all = Vec::new();
        for [u, v] in [[1.0, 0.0], [0.0, w]] {
            let run = motion(&solid, &scheme, uniform(&solid, u, v, None), 60, 1.0)?;
            all.push(ledger(&solid, &scheme, &run)?);
        }
        let energy = |n: usize| all.iter().map(|run| run[n].kinetic + run[n].elastic).sum::<f64>();
        for n in 40..60 {
            let share: f64 = all.iter().map(|run| run[n + 1].scheme - run[n].scheme).sum();
            let expected = (modulus * modulus - 1.0) * energy(n);
            assert!((share - expected).abs() < 1e-8 * energy(n), "h w = {w}, {n}: {share:e}, not {expected:e}");
        }
    }
    Ok(())
}

/// A viscous bar held by a base that moves, over a floor that moves and rubs, under its weight, with a muscle.
fn driven() -> Outcome<(Solid, impl Fn(f64) -> Controls)> {
    let solid = Solid::new(regular(CellKind::Hex8, [1.0, 0.5, 0.5], [3, 1, 1])?)?
        .material("body", NeoHooke::new(1e4, 2e4)?)?
        .viscosity("body", MaxwellBranch::new(5e3, 0.1)?)?
        .viscosity("body", KelvinVoigt::new(100.0, 50.0)?)?
        .actuate("body", "muscle", FiberTension::along(Vec3::new(0.8, 0.0, 0.6))?)?
        .motion(MovingSupport::of("base", "x-"))?
        .inertia(Inertia::new("body", 1000.0))?
        .rayleigh_damping(0.1, 1e-3)?
        .body_force("body", Vec3::new(0.0, 0.0, -1000.0))?
        .contact(
            Contact::of("floor", "z-", Obstacle::half_space([0.0, 0.0, -0.15], [0.0, 0.0, 1.0]))
                .thickness(0.1)
                .stiffness(2e4)
                .friction(0.3, 0.05),
        )?;
    let blocks: Vec<usize> = ["muscle", "base", "floor"]
        .iter()
        .map(|name| solid.model().controllable().iter().position(|own| own.name == *name).unwrap())
        .collect();
    let at_rest = solid.controls();
    let at = move |t: f64| {
        let mut controls = at_rest.clone();
        controls.values_mut(blocks[0]).iter_mut().for_each(|m| *m = -2e3 * (3.0 * t).sin().powi(2));
        let base = controls.values_mut(blocks[1]);
        (base[2], base[4]) = (-0.05 * t * t, 0.1 * t * t);
        let floor = controls.values_mut(blocks[2]);
        (floor[0], floor[2], floor[4]) = (0.2 * t * t, 0.1 * t * t, 0.05 * t * t);
        controls
    };
    Ok((solid, at))
}

/// What has no formula closes by definition.
fn has_formula(scheme: &Scheme) -> bool {
    scheme.ends_at_its_last_stage()
}

#[test]
fn the_sum_closes_and_every_entry_is_seen() -> Outcome {
    let (solid, at) = driven()?;
    for name in ["backward_euler", "bdf2", "tr_bdf2", "newmark"] {
        let scheme = schemes()?.into_iter().map(|(scheme, _)| scheme).find(|scheme| scheme.name() == name).unwrap();
        assert!(has_formula(&scheme));
        let mut run =
            Trajectory::from_given(State { velocity: Some(vec![0.0; solid.rest().u.len()].into()), ..solid.rest() });
        let steps: Vec<StepTo> = steps(25, 0.02, &at);
        solid.model().advance(&mut run, &scheme, &steps, &STRICT, &mut Workspace::default())?;
        let all = ledger(&solid, &scheme, &run)?;
        let (largest, unbalanced) = (largest_span(&all), span(&all, 11));
        let spans: Vec<String> =
            (0..12).map(|k| format!("{} {:.2e}", EnergyBalance::NAMES[k], span(&all, k))).collect();
        println!("{name}: {}", spans.join(", "));
        assert!(unbalanced < 1e-6 * largest, "{name}: {unbalanced:e} of {largest:e}");
        for entry in (0..10).filter(|entry| *entry != 6) {
            assert!(span(&all, entry) > 1e-4 * largest, "{name}: no {}", EnergyBalance::NAMES[entry]);
        }
        let last = all[25];
        assert!(last.viscous_loss > 0.0 && last.friction_loss > 0.0, "{name}: {last:?}");
        // the sum of the names
        let sum = |b: &EnergyBalance| {
            let e = b.entries();
            e[..5].iter().sum::<f64>() - e[5..12].iter().sum::<f64>()
        };
        assert!((sum(&last) - sum(&all[0])).abs() < 1e-12 * largest, "{name}");
    }
    Ok(())
}

/// What the scheme adds falls with the step as its order says, so that the other entries are those of physics.
#[test]
fn the_share_of_a_scheme_falls_with_the_step() -> Outcome {
    let (solid, at) = driven()?;
    let share = |scheme: &Scheme, count: usize| -> Outcome<f64> {
        let mut run =
            Trajectory::from_given(State { velocity: Some(vec![0.0; solid.rest().u.len()].into()), ..solid.rest() });
        let steps = steps(count, 0.3 / count as f64, &at);
        solid.model().advance(&mut run, scheme, &steps, &STRICT, &mut Workspace::default())?;
        let all = ledger(&solid, scheme, &run)?;
        Ok(all[count].scheme.abs() / largest_span(&all))
    };
    let euler = Scheme::backward_euler();
    let [coarse, fine] = [share(&euler, 30)?, share(&euler, 120)?];
    assert!(coarse < 0.1 && fine < 0.35 * coarse, "{coarse} {fine}");
    Ok(())
}

/// A stiff block slides down an incline of tan = 1/2: the weight does `m g sin s`, friction takes `mu m g cos s`, the rest is kinetic.
#[test]
fn friction_takes_what_it_takes_by_hand() -> Outcome {
    let (sine, cosine, mu) = (0.2f64.sqrt(), 0.8f64.sqrt(), 0.3);
    let weight = 1000.0 * 9.81 * 0.25;
    let solid = Solid::new(regular(CellKind::Hex8, [1.0, 1.0, 0.25], [2, 2, 1])?)?
        .material("body", NeoHooke::new(4e9, 4e9)?)?
        .body_force("body", 1000.0 * 9.81 * Vec3::new(sine, 0.0, -cosine))?
        .inertia(Inertia::new("body", 1000.0))?
        .contact(
            Contact::of("floor", "z-", Obstacle::half_space([0.0; 3], [0.0, 0.0, 1.0]))
                .thickness(1e-3)
                .stiffness(4e5)
                .friction(mu, 1e-5),
        )?;
    let gap = 1e-3 * (1.0 - (weight * cosine / 4e5).sqrt());
    let u: Vec<f64> = (0..solid.rest().u.len()).map(|dof| if dof % 3 == 2 { gap } else { 0.0 }).collect();
    let begin = State { u: u.into(), velocity: Some(vec![0.0; solid.rest().u.len()].into()), ..solid.rest() };
    let run = motion(&solid, &Scheme::backward_euler(), begin, 40, 0.025)?;
    let all = ledger(&solid, &Scheme::backward_euler(), &run)?;
    let (end, slid) = (all[40], run.end().u[0]);
    let off = |found: f64, expected: f64| (found / expected - 1.0).abs();
    assert!(off(end.load_work, weight * sine * slid) < 1e-3, "{end:?}");
    // the first step begins without friction, by which it counts half
    let first = run.states()[1].u[0] / slid;
    assert!(off(end.friction_loss, mu * weight * cosine * slid) < 1e-3 + first, "{end:?}");
    assert!(end.unbalanced.abs() < 1e-4 * end.load_work, "{end:?}");
    Ok(())
}

/// A ledger that goes on from a state has the bits of one that never stopped.
#[test]
fn a_ledger_goes_on() -> Outcome {
    let (solid, at) = driven()?;
    let scheme = Scheme::backward_euler();
    let mut run =
        Trajectory::from_given(State { velocity: Some(vec![0.0; solid.rest().u.len()].into()), ..solid.rest() });
    solid.model().advance(&mut run, &scheme, &steps(8, 0.02, &at), &STRICT, &mut Workspace::default())?;
    let (all, states) = (ledger(&solid, &scheme, &run)?, run.states());
    let mut later = EnergyLedger::new(solid.model(), &scheme, &states[5].controls)?;
    later.go_on(solid.model(), Some(&states[4]), &states[5], all[5])?;
    for n in 6..=8 {
        assert_eq!(later.add(solid.model(), &states[n])?, all[n]);
    }
    Ok(())
}
