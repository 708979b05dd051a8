//! Viscous laws: derivatives against differences, objectivity, closed forms of relaxation, dissipation.

#![allow(clippy::unwrap_used)] // a test may

use nastic_energy::{
    EnergyError, EnergyTerm, Evolution, KelvinVoigt, MaterialPoint, MaxwellBranch, PointBatch, Response, Slots,
    SpringMeasure, Want, check,
};
use nastic_tensor::{Inverted, Kinematics, Mat3};
use std::sync::Arc;

const HERE: MaterialPoint = MaterialPoint { cell: 0, point: 0 };

type Named = (&'static str, Arc<dyn EnergyTerm>);

fn laws() -> Result<[Named; 3], EnergyError> {
    let maxwell = MaxwellBranch::new(3e4, 0.2)?;
    let neo_hooke = maxwell.clone().measure(SpringMeasure::NeoHooke);
    let damping = KelvinVoigt::new(2e3, 5e2)?;
    Ok([("maxwell", Arc::new(maxwell)), ("neo_hooke", Arc::new(neo_hooke)), ("kelvin_voigt", Arc::new(damping))])
}

/// Slots as they are after a step at a strained state.
fn slots(law: &dyn EnergyTerm, dt: f64) -> Option<Vec<f64>> {
    let (evolution, mut slots) = (law.evolution()?, vec![0.0; law.slots().len()]);
    let strained = Mat3::new(1.1, 0.3, 0.0, -0.1, 0.9, 0.2, 0.1, 0.0, 1.05);
    let mut next = slots.clone();
    evolution.advance(HERE, &Kinematics::new(strained).ok()?, &slots, &mut next);
    slots = next;
    evolution.set_step(HERE, dt, &mut slots);
    Some(slots)
}

fn at(law: &dyn EnergyTerm, f: &Mat3, slots: &[f64]) -> Result<(f64, Mat3), Inverted> {
    let k = [Kinematics::new(*f)?];
    let (mut energy, mut stress) = ([0.0], [Mat3::zeros()]);
    let mut out = Response { energy: &mut energy, stress: &mut stress, tangent: &mut [] };
    let want = Want { energy: true, stress: true, tangent: false };
    let points = PointBatch { kinematics: &k, cell: 0, first: 0 };
    law.respond(&points, Slots::by_point(slots, slots.len()), want, &mut out);
    Ok((energy[0], stress[0]))
}

fn advanced(law: &dyn EnergyTerm, f: &Mat3, slots: &[f64]) -> Option<Vec<f64>> {
    let mut next = slots.to_vec();
    law.evolution()?.advance(HERE, &Kinematics::new(*f).ok()?, slots, &mut next);
    Some(next)
}

#[test]
fn energies_of_steps_keep_the_contract_of_actuations() {
    for (name, law) in laws().unwrap() {
        let mut all = slots(&*law, 0.05).unwrap();
        check::stress(&law, HERE, &all).unwrap_or_else(|e| panic!("{name}: {e}"));
        check::tangent(&law, HERE, &all).unwrap_or_else(|e| panic!("{name}: {e}"));
        check::stress_change(&law, HERE, &all).unwrap_or_else(|e| panic!("{name}: {e}"));
        check::major_symmetry(&law, HERE, &all).unwrap_or_else(|e| panic!("{name}: {e}"));
        check::objectivity(&law, HERE, &all, &|_, _| {}).unwrap_or_else(|e| panic!("{name}: {e}"));
        if name == "kelvin_voigt" {
            all.iter_mut().take(6).for_each(|z| *z *= 3.0); // slots of one size, for the steps of the differences
            all[6] = 0.4;
        }
        check::control_derivative(&*law, HERE, &all).unwrap_or_else(|e| panic!("{name}: {e}"));
        // nothing in statics, second derivatives included
        let zero = vec![0.0; all.len()];
        assert_eq!(
            at(&*law, &Mat3::new(1.1, 0.3, 0.0, -0.1, 0.9, 0.2, 0.1, 0.0, 1.05), &zero).unwrap(),
            (0.0, Mat3::zeros())
        );
        assert!(check::second_stress_change(&law, HERE, &zero).unwrap().is_some(), "{name}");
        assert!(check::second_stress_change(&law, HERE, &all).unwrap().is_none(), "{name}");
    }
}

/// The transposed derivative of the internal variables, where stretches coincide too.
#[test]
fn derivatives_of_internal_variables_are_right() {
    let rest = Mat3::identity();
    let apart = Mat3::new(0.9, 0.4, 0.1, -0.2, 1.2, 0.3, 0.0, -0.3, 1.1);
    let double = Mat3::new(1.3, 0.0, 0.0, 0.0, 0.8, 0.0, 0.0, 0.0, 0.8);
    for (name, law) in laws().unwrap() {
        for f in [rest, apart, double] {
            for slots in [slots(&*law, 0.05).unwrap(), vec![0.0; law.slots().len()]] {
                let last = slots.len() - 1;
                let weights: Vec<f64> = (0..last).map(|k| (1.7 * k as f64 + 0.3).sin()).collect();
                let value = |f: &Mat3, slots: &[f64]| -> f64 {
                    advanced(&*law, f, slots).unwrap().iter().zip(&weights).map(|(z, w)| z * w).sum()
                };
                let mut padded = weights.clone();
                padded.push(0.0);
                let (mut by_f, mut by_slots) = (Mat3::zeros(), vec![0.0; slots.len()]);
                let k = Kinematics::new(f).unwrap();
                law.evolution().unwrap().advance_vjp(HERE, &k, &slots, &padded, &mut by_f, &mut by_slots);
                let h = 1e-3;
                // of sixth order
                let slope = |at: &dyn Fn(f64) -> f64| {
                    (45.0 * (at(h) - at(-h)) - 9.0 * (at(2.0 * h) - at(-2.0 * h)) + at(3.0 * h) - at(-3.0 * h))
                        / (60.0 * h)
                };
                for entry in 0..9 {
                    let at = |t: f64| {
                        let mut moved = f;
                        moved[(entry / 3, entry % 3)] += t;
                        value(&moved, &slots)
                    };
                    let (found, expected) = (by_f[(entry / 3, entry % 3)], slope(&at));
                    assert!((found - expected).abs() < 1e-9, "{name} by F_{entry}: {found} {expected}");
                }
                for entry in 0..last {
                    let at = |t: f64| {
                        let mut moved = slots.clone();
                        moved[entry] += t;
                        value(&f, &moved)
                    };
                    let (found, expected) = (by_slots[entry], slope(&at));
                    assert!((found - expected).abs() < 1e-9, "{name} by slot {entry}: {found} {expected}");
                }
            }
        }
    }
}

/// At a held stretch the logarithmic strain of the spring falls by 1/(1 + h/tau) a step: finite strains, exactly. A step without
/// end relaxes all of it.
#[test]
fn a_held_branch_relaxes_as_its_closed_form_says() {
    let (mu, tau, h) = (3e4, 0.2, 0.03);
    let law = MaxwellBranch::new(mu, tau).unwrap();
    let stretch = [1.5f64, 0.8, 1.1];
    let f = Mat3::from_diagonal(&stretch.into());
    let mean = stretch.iter().map(|l| l.ln()).sum::<f64>() / 3.0;
    let mut slots = vec![0.0; 10];
    for n in 1..=30 {
        law.set_step(HERE, h, &mut slots);
        let (_, stress) = at(&law, &f, &slots).unwrap();
        for (i, l) in stretch.iter().enumerate() {
            let expected = 2.0 * mu * (l.ln() - mean) / (1.0 + h / tau).powi(n) / l;
            assert!((stress[(i, i)] - expected).abs() < 1e-12 * mu, "step {n}: {} {expected}", stress[(i, i)]);
        }
        slots = advanced(&law, &f, &slots).unwrap();
        let viscous = Mat3::identity() + Mat3::from_row_slice(&slots[..9]);
        assert!((viscous.determinant() - 1.0).abs() < 1e-13);
    }
    law.set_step(HERE, f64::INFINITY, &mut slots);
    assert_eq!(at(&law, &f, &slots).unwrap().0, 0.0);
    slots = advanced(&law, &f, &slots).unwrap();
    law.set_step(HERE, 0.0, &mut slots);
    assert!(at(&law, &f, &slots).unwrap().1.norm() < 1e-10 * mu);
}

/// Of a neo-Hookean spring: without flow `mu (l^2 - tr/3)/l` in the axes; held, the spring flows by `d eps_a/dt = -(E_a - mean E)/(2 tau)`, which many
/// short steps follow; at small strains it is a Hencky spring.
#[test]
fn a_neo_hookean_spring_is_that_of_its_closed_forms() {
    let (mu, tau) = (3e4, 0.2);
    let law = MaxwellBranch::new(mu, tau).unwrap().measure(SpringMeasure::NeoHooke);
    let squares = |strain: [f64; 3]| strain.map(|strain| (2.0 * strain).exp());
    let deviator = |values: [f64; 3]| values.map(|value| value - values.iter().sum::<f64>() / 3.0);
    let stretch = [1.6f64, 0.7, 1.0 / 1.12];
    let (f, mut slots) = (Mat3::from_diagonal(&stretch.into()), vec![0.0; 10]);
    let trial = deviator(stretch.map(f64::ln));
    let expected = |strain: [f64; 3]| deviator(squares(strain)).map(|force| mu * force);
    law.set_step(HERE, 0.0, &mut slots);
    let (energy, stress) = at(&law, &f, &slots).unwrap();
    assert!((energy / (0.5 * mu * (squares(trial).iter().sum::<f64>() - 3.0)) - 1.0).abs() < 1e-13, "{energy}");
    (0..3).for_each(|i| assert!((stress[(i, i)] - expected(trial)[i] / stretch[i]).abs() < 1e-12 * mu));
    // Runge and Kutta's method for the flow against many steps of first order
    let rate = |strain: [f64; 3]| deviator(squares(strain)).map(|force| -0.5 * force / tau);
    let plus = |a: [f64; 3], s: f64, b: [f64; 3]| -> [f64; 3] { std::array::from_fn(|i| a[i] + s * b[i]) };
    let (mut exact, h) = (trial, 1e-3);
    let errors: Vec<f64> = [400, 800]
        .map(|steps: usize| {
            let (mut slots, dt) = (vec![0.0; 10], 0.2 / steps as f64);
            for _ in 0..steps {
                law.set_step(HERE, dt, &mut slots);
                slots = advanced(&law, &f, &slots).unwrap();
            }
            exact = trial;
            for _ in 0..200 {
                let k1 = rate(exact);
                let k2 = rate(plus(exact, h / 2.0, k1));
                let k3 = rate(plus(exact, h / 2.0, k2));
                let k4 = rate(plus(exact, h, k3));
                exact = std::array::from_fn(|i| exact[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
            }
            let viscous = Mat3::identity() + Mat3::from_row_slice(&slots[..9]);
            assert!((viscous.determinant() - 1.0).abs() < 1e-12);
            law.set_step(HERE, 0.0, &mut slots);
            let (_, stress) = at(&law, &f, &slots).unwrap();
            (stress[(0, 0)] * stretch[0] - expected(exact)[0]).abs() / mu
        })
        .to_vec();
    assert!(errors[0] < 1e-3 && (errors[0] / errors[1] - 2.0).abs() < 0.02, "{errors:?}");
    let hencky = MaxwellBranch::new(mu, tau).unwrap();
    let small = Mat3::identity() + Mat3::new(1.0, 0.3, 0.0, -0.1, -0.9, 0.2, 0.1, 0.0, 0.5) * 1e-6;
    let mut slots = vec![0.0; 10];
    law.set_step(HERE, 0.03, &mut slots);
    let (a, b) = (at(&law, &small, &slots).unwrap().1, at(&hencky, &small, &slots).unwrap().1);
    assert!((a - b).norm() < 1e-5 * b.norm(), "{a} {b}");
}

/// A turned body flows alike, and every step dissipates: stored energy at its end is below the energy of the step, which is below
/// what was stored before, at the same deformation.
#[test]
fn flow_is_objective_and_dissipates() {
    for measure in [SpringMeasure::Hencky, SpringMeasure::NeoHooke] {
        flows_and_dissipates(&MaxwellBranch::new(3e4, 0.2).unwrap().measure(measure));
    }
}

fn flows_and_dissipates(law: &MaxwellBranch) {
    let mut turned = vec![0.0; 10];
    let mut slots = turned.clone();
    let stored = |f: &Mat3, slots: &[f64]| {
        let mut instant = slots.to_vec();
        law.set_step(HERE, 0.0, &mut instant);
        at(law, f, &instant).unwrap().0
    };
    for n in 0..40 {
        let (a, b) = ((0.7 * f64::from(n)).sin(), (1.3 * f64::from(n)).cos());
        let f = Mat3::new(1.0 + 0.3 * a, 0.4 * b, 0.1, -0.2 * a, 1.1, 0.2 * b, 0.1, 0.3 * a, 0.9 + 0.2 * b);
        let (s, c) = (0.9 * f64::from(n)).sin_cos();
        let q = Mat3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0);
        for slots in [&mut slots, &mut turned] {
            law.set_step(HERE, 0.05, slots);
        }
        let (energy, stress) = at(law, &f, &slots).unwrap();
        let (same, also) = at(law, &(q * f), &turned).unwrap();
        assert!((energy - same).abs() < 1e-9 * energy && (q * stress - also).norm() < 1e-9 * stress.norm());
        let before = stored(&f, &slots);
        (slots, turned) = (advanced(law, &f, &slots).unwrap(), advanced(law, &(q * f), &turned).unwrap());
        let after = stored(&f, &slots);
        assert!(after <= energy * (1.0 + 1e-12) && energy <= before, "{after} {energy} {before}");
    }
}

#[test]
fn parameters_are_checked() {
    assert!(MaxwellBranch::new(0.0, 1.0).unwrap_err().to_string().contains("shear"));
    assert!(MaxwellBranch::new(1.0, -1.0).unwrap_err().to_string().contains("relaxation"));
    assert!(KelvinVoigt::new(-1.0, 1.0).unwrap_err().to_string().contains("shear"));
    assert!(KelvinVoigt::new(1.0, f64::NAN).unwrap_err().to_string().contains("bulk"));
}
