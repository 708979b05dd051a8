//! Viscous bodies against closed forms of linear viscoelasticity at small strains, and an equation solved by itself at large ones.

use crate::common;

use common::block::STRICT;
use common::motion::{schemes, steps};
use common::{Outcome, regular};
use nastic_energy::{FiberTension, KelvinVoigt, MaxwellBranch, NeoHooke};
use nastic_fem::{Demand, Inertia, Instant, Scheme, Solid, State, StepTo, TimeStepping, Trajectory, Workspace};
use nastic_mesh::CellKind;
use nastic_tensor::Vec3;
use std::sync::Arc;

/// Elastic constants of the passive law and one branch: shear, bulk; shear of the branch, relaxation time.
const G: f64 = 2.0;
const K: f64 = 5.0;
const G1: f64 = 3.0;
const TAU: f64 = 0.7;
const STRAIN: f64 = 9e-9;

/// A cube held in uniaxial tension at x+, or pulled there; without mass, which shows in no step.
fn cube(ends: Option<f64>, traction: f64) -> Outcome<Solid> {
    let solid = Solid::new(regular(CellKind::Hex8, [1.0; 3], [1; 3])?)?
        .material("body", NeoHooke::new(G, K - 2.0 * G / 3.0)?)?
        .displace("x-", [Some(0.0), None, None])?
        .displace("y-", [None, Some(0.0), None])?
        .displace("z-", [None, None, Some(0.0)])?;
    Ok(match ends {
        Some(by) => solid.displace("x+", [Some(by), None, None])?,
        None => solid.traction("x+", Vec3::x() * traction)?,
    })
}

/// Nodal force at x+, and the displacement there.
fn pulled(solid: &Solid, state: &State) -> Outcome<[f64; 2]> {
    let sums = solid.model().evaluate(&Instant::of(state), Demand { energy: true, force: true })?;
    let nodes = solid.nodes_of("x+")?;
    let force = nodes.iter().map(|&node| sums.force[3 * node as usize]).sum();
    Ok([force, state.u[3 * nodes[0] as usize]])
}

/// From rest, so many steps of quasi-static motion.
fn run(solid: &Solid, scheme: &Scheme, count: usize, h: f64) -> Outcome<Trajectory> {
    let mut trajectory = Trajectory::from_given(solid.rest());
    let steps = steps(count, h, |_| solid.controls());
    solid.model().advance(&mut trajectory, scheme, &steps, &STRICT, &mut Workspace::default())?;
    Ok(trajectory)
}

/// Of E(t) = E_inf + (E_0 - E_inf) exp(-t/tau_E), tau_E = tau (3 K + G_0)/(3 K + G_inf).
fn moduli() -> [f64; 3] {
    let young = |g: f64| 9.0 * K * g / (3.0 * K + g);
    [young(G), young(G + G1), TAU * (3.0 * K + G + G1) / (3.0 * K + G)]
}

/// The limit of a first-order sequence in h at h, h/2, h/4, h/8: Richardson's extrapolation.
fn limit(mut values: Vec<f64>) -> f64 {
    let mut power = 2.0;
    while values.len() > 1 {
        values = values.windows(2).map(|pair| (power * pair[1] - pair[0]) / (power - 1.0)).collect();
        power *= 2.0;
    }
    values[0]
}

#[test]
fn a_held_bar_relaxes_as_its_prony_series() -> Outcome {
    let solid = cube(Some(STRAIN), 0.0)?.viscosity("body", MaxwellBranch::new(G1, TAU)?)?;
    let [long, instant, tau] = moduli();
    let force = |count: usize| -> Outcome<f64> {
        let h = TAU / count as f64;
        // the end is moved in a first step so short that nothing flows
        let mut trajectory = Trajectory::from_given(solid.rest());
        let mut all = vec![StepTo { dt: 1e-9 * TAU, controls: solid.controls() }];
        all.extend(steps(count, h, |_| solid.controls()));
        let scheme = Scheme::quasi_dynamic();
        solid.model().advance(&mut trajectory, &scheme, &all, &STRICT, &mut Workspace::default())?;
        let [first, _] = pulled(&solid, &trajectory.states()[1])?;
        assert!((first / (instant * STRAIN) - 1.0).abs() < 1e-6, "{first:e}");
        Ok(pulled(&solid, trajectory.end())?[0])
    };
    let forces: Vec<f64> = [8, 16, 32, 64, 128].into_iter().map(force).collect::<Outcome<_>>()?;
    let expected = STRAIN * (long + (instant - long) * (-TAU / tau).exp());
    let errors: Vec<f64> = forces.iter().map(|f| f / expected - 1.0).collect();
    println!("relaxation, relative errors at tau/8 .. tau/128: {errors:?}");
    let order = (errors[3] / errors[4]).log2();
    assert!((order - 1.0).abs() < 0.05, "order {order}");
    let converged = limit(forces) / expected - 1.0;
    assert!(converged.abs() < 1e-6, "{converged:e}");
    Ok(())
}

/// Creep under a held force: J(t) = 1/E_inf - (1/E_inf - 1/E_0) exp(-t/t_c), t_c = tau_E E_0/E_inf.
#[test]
fn a_pulled_bar_creeps_as_its_closed_form_says() -> Outcome {
    let [long, instant, tau] = moduli();
    let force = STRAIN * long;
    let solid = cube(None, force)?.viscosity("body", MaxwellBranch::new(G1, TAU)?)?;
    let time = 1.3;
    let stretch = |count: usize| -> Outcome<f64> {
        Ok(pulled(&solid, run(&solid, &Scheme::quasi_dynamic(), count, time / count as f64)?.end())?[1])
    };
    let found = limit([16, 32, 64, 128, 256].into_iter().map(stretch).collect::<Outcome<_>>()?);
    let expected = force * (1.0 / long - (1.0 / long - 1.0 / instant) * (-time * long / (instant * tau)).exp());
    assert!((found / expected - 1.0).abs() < 1e-6, "{found:e} {expected:e}");
    // Kelvin-Voigt with viscosities in proportion to the moduli: E (eps + t_r eps') = sigma
    let t_r = 0.4;
    let solid = cube(None, force)?.viscosity("body", KelvinVoigt::new(G * t_r, K * t_r)?)?;
    let stretch = |count: usize| -> Outcome<f64> {
        Ok(pulled(&solid, run(&solid, &Scheme::quasi_dynamic(), count, time / count as f64)?.end())?[1])
    };
    let found = limit([16, 32, 64, 128, 256].into_iter().map(stretch).collect::<Outcome<_>>()?);
    let expected = force / long * (1.0 - (-time / t_r).exp());
    assert!((found / expected - 1.0).abs() < 1e-6, "{found:e} {expected:e}");
    Ok(())
}

/// Uniaxial relaxation at a stretch of 1.6, the sides free. By itself: with a = ln of the lateral stretch, e the axial logarithmic
/// strain of the spring (lateral -e/2), de/dt = -e/tau + (2/3) d(ln l - a)/dt, and a from the lateral force
/// G (a^2 - 1) + lambda ln J + ... = 0: by Runge and Kutta in small steps.
#[test]
fn large_strains_relax_as_their_own_equation_says() -> Outcome {
    let stretch = 1.6f64;
    let solid = cube(Some(stretch - 1.0), 0.0)?.viscosity("body", MaxwellBranch::new(G1, TAU)?)?;
    // the passive Kirchhoff stresses from the library's law at homogeneous stretches
    let passive = |axial: f64, lateral: f64| -> Outcome<[f64; 2]> {
        let free = cube(None, 0.0)?;
        let u: Vec<f64> = free
            .mesh()
            .points()
            .iter()
            .flat_map(|x| [(axial - 1.0) * x[0], (lateral - 1.0) * x[1], (lateral - 1.0) * x[2]])
            .collect();
        let force = free.body().evaluate(&u, &free.controls(), true, false)?.force;
        let sum = |name: &str, k: usize| -> Outcome<f64> {
            Ok(free.nodes_of(name)?.iter().map(|&node| force[3 * node as usize + k]).sum())
        };
        Ok([axial * sum("x+", 0)?, lateral * sum("y+", 1)?])
    };
    // lateral balance: passive + branch = 0, the branch -G1 e with e the axial deviator (tau_dev = 2 G1 (e, -e/2, -e/2))
    let lateral_of = |e: f64| -> Outcome<f64> {
        let (mut low, mut high) = (0.5f64, 1.1f64);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if passive(stretch, middle)?[1] - G1 * e > 0.0 { high = middle } else { low = middle }
        }
        Ok(0.5 * (low + high))
    };
    // at the beginning the spring has all of the deviator: e = (2/3) (ln l - ln a)
    let mut e = 0.3;
    for _ in 0..60 {
        e = 2.0 / 3.0 * (stretch.ln() - lateral_of(e)?.ln());
    }
    // the change of e at a fixed axial stretch: e' (1 + (2/3) d ln a/de) = -e/tau
    let rate = |e: f64| -> Outcome<f64> {
        let d = 1e-5;
        let slope = (lateral_of(e + d)?.ln() - lateral_of(e - d)?.ln()) / (2.0 * d);
        Ok(-e / TAU / (1.0 + 2.0 / 3.0 * slope))
    };
    let count = 20;
    let h = TAU / f64::from(count);
    for _ in 0..count {
        let k1 = rate(e)?;
        let k2 = rate(e + 0.5 * h * k1)?;
        let k3 = rate(e + 0.5 * h * k2)?;
        let k4 = rate(e + h * k3)?;
        e += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    }
    let expected = (passive(stretch, lateral_of(e)?)?[0] + 2.0 * G1 * e) / stretch;
    let force = |count: usize| -> Outcome<f64> {
        let mut trajectory = Trajectory::from_given(solid.rest());
        let mut all = vec![StepTo { dt: 1e-9 * TAU, controls: solid.controls() }];
        all.extend(steps(count, TAU / count as f64, |_| solid.controls()));
        let scheme = Scheme::quasi_dynamic();
        solid.model().advance(&mut trajectory, &scheme, &all, &STRICT, &mut Workspace::default())?;
        Ok(pulled(&solid, trajectory.end())?[0])
    };
    let found = limit([8, 16, 32, 64, 128].into_iter().map(force).collect::<Outcome<_>>()?);
    println!("relaxation at a stretch of 1.6: {found} against {expected}");
    assert!((found / expected - 1.0).abs() < 1e-5, "{found} {expected}");
    Ok(())
}

/// A bar that is bent and let go: every scheme takes energy out of it through both laws, and a body that only turns loses none.
#[test]
fn motions_lose_energy_unless_they_are_rigid() -> Outcome {
    let bar = |law: usize| -> Outcome<Solid> {
        let solid = Solid::new(regular(CellKind::Hex8, [1.0, 0.2, 0.2], [4, 1, 1])?)?
            .material("body", NeoHooke::new(1e3, 2e3)?)?
            .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
            .inertia(Inertia::new("body", 1.0))?;
        Ok(match law {
            0 => solid.viscosity("body", MaxwellBranch::new(500.0, 0.05)?)?,
            1 => solid.viscosity("body", KelvinVoigt::new(5.0, 5.0)?)?,
            _ => solid,
        })
    };
    let energy = |solid: &Solid, state: &State| -> Outcome<f64> {
        let mut product = vec![0.0; state.u.len()];
        let v = state.velocity.as_deref().ok_or("no velocity")?;
        solid.model().energies().mass()?.multiply(v, &mut product);
        let kinetic: f64 = v.iter().zip(&product).map(|(v, p)| 0.5 * v * p).sum();
        Ok(kinetic + solid.body().evaluate(&state.u, &solid.controls(), false, false)?.energy)
    };
    for (scheme, order) in schemes()?.into_iter().filter(|(_, order)| *order == 2) {
        for law in 0..2 {
            let solid = bar(law)?;
            let points = solid.mesh().points().to_vec();
            let turning: Vec<f64> =
                points.iter().flat_map(|x| [-2.0 * (x[1] - 0.1), 2.0 * (x[0] - 0.5), 0.0]).collect();
            let stretching: Vec<f64> = points.iter().flat_map(|x| [4.0 * (x[0] - 0.5), 0.0, 0.0]).collect();
            let run = |solid: &Solid, v: &[f64]| -> Outcome<[f64; 2]> {
                let begin = State { velocity: Some(Arc::new(v.to_vec())), ..solid.rest() };
                let mut trajectory = Trajectory::from_given(begin);
                let all = steps(40, 0.005, |_| solid.controls());
                let first = [StepTo { dt: 0.005, controls: solid.controls() }];
                // Kelvin-Voigt's force is not known where a motion begins
                let (model, work) = (solid.model(), &mut Workspace::default());
                model.advance(&mut trajectory, &Scheme::backward_euler(), &first, &STRICT, work)?;
                let before = energy(solid, trajectory.end())?;
                model.advance(&mut trajectory, &scheme, &all, &STRICT, work)?;
                Ok([before, energy(solid, trajectory.end())?])
            };
            let [before, after] = run(&solid, &stretching)?;
            let [_, kept] = run(&bar(2)?, &stretching)?;
            assert!(
                after < 0.8 * before && after < kept,
                "{} of order {order}: {before} {after} {kept}",
                scheme.name()
            );
            let [before, after] = run(&solid, &turning)?;
            assert!(after > 0.98 * before, "{}, law {law}: turning loses {}", scheme.name(), 1.0 - after / before);
        }
    }
    Ok(())
}

#[test]
fn what_cannot_be_is_refused() -> Outcome {
    let solid = Solid::new(regular(CellKind::Hex8, [1.0; 3], [1; 3])?)?
        .material("body", NeoHooke::new(1.0, 2.0)?)?
        .inertia(Inertia::new("body", 1.0))?;
    let tension = solid.clone().viscosity("body", FiberTension::along(Vec3::x())?);
    assert!(tension.unwrap_err().to_string().contains("no viscous law"));
    let solid = solid.viscosity("body", KelvinVoigt::new(1.0, 1.0)?)?;
    assert!(solid.model().controllable().iter().all(|known| known.slots.is_empty()));
    let velocity = Some(Arc::new(vec![1.0; 24]));
    let mut trajectory = Trajectory::from_given(State { velocity, ..solid.rest() });
    let step = [StepTo { dt: 0.1, controls: solid.controls() }];
    let refused = solid.model().advance(&mut trajectory, &Scheme::tr_bdf2(), &step, &STRICT, &mut Workspace::default());
    assert!(refused.unwrap_err().to_string().contains("Kelvin-Voigt"));
    Ok(())
}
