//! The derivative of motions by what moves a surface, and by what drives the body beside it.

#![allow(clippy::unwrap_used)] // helpers of tests

use crate::common;

use common::block::STRICT;
use common::motion::schemes_with_moving_supports;
use common::{Outcome, noise, regular};
use nastic_energy::{FiberTension, KelvinVoigt, MaxwellBranch, NeoHooke};
use nastic_fem::{
    Checkpoints, Controls, Inertia, MovingSupport, Recording, ReverseSweep, Scheme, Solid, State, StateError,
    StatePartials, StepTo, TimeStepping, Trajectory, Workspace,
};
use nastic_mesh::CellKind;
use nastic_tensor::Vec3;

const H: f64 = 0.1;

#[derive(Debug, Clone, Copy, PartialEq)]
enum Dissipation {
    None,
    Rayleigh,
    Maxwell,
    KelvinVoigt,
}

impl Dissipation {
    /// Viscous laws give no second derivatives, which the adjoint of a linearised step takes.
    fn goes_with(self, scheme: &Scheme) -> bool {
        !scheme.is_linearised() || matches!(self, Self::None | Self::Rayleigh)
    }
}

/// A plane strip that is moved at one end, and held at its other one in y.
fn strip(dissipation: Dissipation) -> Outcome<Solid> {
    let solid = Solid::new(regular(CellKind::Quad4, [3.0, 1.0, 0.0], [3, 1, 1])?)?
        .material("body", NeoHooke::new(1.0, 2.0)?)?
        .actuate("body", "fibre", FiberTension::along(Vec3::x())?)?
        .body_force("body", Vec3::new(0.0, -2e-3, 0.0))?
        .motion(MovingSupport::of("base", "x-").about([-0.5, 0.2, 0.0]))?
        .displace("x+", [None, Some(0.0), None])?
        .inertia(Inertia::new("body", 1.0))?;
    Ok(match dissipation {
        Dissipation::None => solid,
        Dissipation::Rayleigh => solid.rayleigh_damping(0.02, 0.05)?,
        Dissipation::Maxwell => {
            solid.viscosity("body", MaxwellBranch::new(0.5, 0.3)?)?.viscosity("body", MaxwellBranch::new(0.2, 3.0)?)?
        }
        Dissipation::KelvinVoigt => solid.viscosity("body", KelvinVoigt::new(0.05, 0.02)?)?,
    })
}

/// What is changed: of which block of controls which slots.
#[derive(Debug, Clone, Copy)]
enum Along {
    Translation,
    Rotation,
    Fibre,
}

impl Along {
    const ALL: [Self; 3] = [Self::Translation, Self::Rotation, Self::Fibre];

    fn block(self, solid: &Solid) -> usize {
        let name = if matches!(self, Along::Fibre) { "fibre" } else { "base" };
        solid.model().controllable().iter().position(|known| known.name == name).unwrap()
    }

    /// Of entries of the block, at an instant.
    fn direction(self, n: usize, entry: usize) -> f64 {
        let free = match self {
            Along::Translation => entry < 2,
            Along::Rotation => entry == 5,
            Along::Fibre => true,
        };
        if free { noise(1000 * (n + 1) + entry) } else { 0.0 }
    }
}

/// At the n-th instant, t = n h, a change added.
fn controls(solid: &Solid, n: usize, (along, change): (Along, f64)) -> Controls {
    let mut controls = solid.controls();
    let wave = |period: f64| (std::f64::consts::TAU * H * n as f64 / period + period).sin();
    controls.values_mut(Along::Fibre.block(solid)).fill(0.1 * wave(7.0));
    let base = [0.1 * wave(2.0), 0.15 * wave(3.0), 0.0, 0.0, 0.0, 0.3 * wave(4.0)];
    controls.values_mut(Along::Translation.block(solid)).copy_from_slice(&base);
    let changed = controls.values_mut(along.block(solid)).iter_mut().enumerate();
    changed.for_each(|(entry, value)| *value += change * along.direction(n, entry));
    controls
}

/// From the equilibrium under the first controls; `change(n)` in those of an instant.
fn run(
    solid: &Solid,
    parts: &[(Scheme, f64, usize)],
    along: Along,
    change: impl Fn(usize) -> f64,
) -> Outcome<Trajectory> {
    let of = |n: usize| controls(solid, n, (along, change(n)));
    let mut trajectory = Trajectory::from(solid.solve(&of(0), &STRICT)?);
    let mut done = 0;
    for (scheme, dt, count) in parts {
        let steps: Vec<StepTo> = (done + 1..=done + count).map(|n| StepTo { dt: *dt, controls: of(n) }).collect();
        solid.model().advance(&mut trajectory, scheme, &steps, &STRICT, &mut Workspace::default())?;
        done += count;
    }
    Ok(trajectory)
}

/// `sum_n h (w_n . u_n + |u_n|^2 / 2 + z_n . v_n)`, of held nodes too.
fn weight(n: usize, i: usize) -> f64 {
    noise(77 + 100 * n + i)
}

fn functional(trajectory: &Trajectory) -> f64 {
    let mut sum = 0.0;
    for (n, state) in trajectory.states().iter().enumerate() {
        for (i, u) in state.u.iter().enumerate() {
            let v = state.velocity.as_ref().filter(|_| n > 0).map_or(0.0, |v| v[i]);
            sum += H * (weight(n, i) * u + 0.5 * u * u + weight(n + 7, i) * v);
        }
    }
    sum
}

fn partials(n: usize, state: &State) -> StatePartials {
    let u = state.u.iter().enumerate().map(|(i, u)| H * (weight(n, i) + u)).collect();
    let velocity = if n > 0 { (0..state.u.len()).map(|i| H * weight(n + 7, i)).collect() } else { Vec::new() };
    StatePartials { u, velocity, ..StatePartials::default() }
}

fn sweep(solid: &Solid, trajectory: &Trajectory) -> Outcome<Vec<Controls>> {
    let partials: Vec<_> = trajectory.states().iter().enumerate().map(|(n, state)| partials(n, state)).collect();
    Ok(solid.model().reverse_sweep(trajectory, &partials, &STRICT, &mut Workspace::default())?.controls)
}

/// The derivative along a change at an instant.
fn slope(solid: &Solid, along: Along, n: usize, by: &Controls) -> f64 {
    by.values(along.block(solid)).iter().enumerate().map(|(entry, d)| d * along.direction(n, entry)).sum()
}

#[test]
fn the_adjoint_of_every_scheme_is_exact_with_a_moving_support() -> Outcome {
    for dissipation in [Dissipation::None, Dissipation::Rayleigh, Dissipation::Maxwell, Dissipation::KelvinVoigt] {
        let solid = strip(dissipation)?;
        for (scheme, _) in
            schemes_with_moving_supports()?.into_iter().filter(|(scheme, _)| dissipation.goes_with(scheme))
        {
            let parts = [(scheme, H, 40)];
            let steady = run(&solid, &parts, Along::Fibre, |_| 0.0)?;
            let (value, swept) = (functional(&steady), sweep(&solid, &steady)?);
            let mut orders = Vec::new();
            for along in Along::ALL {
                let slope: f64 = swept.iter().enumerate().map(|(n, by)| slope(&solid, along, n, by)).sum();
                let change = |t: f64| -> Outcome<f64> { Ok(functional(&run(&solid, &parts, along, |_| t)?) - value) };
                let [coarse, fine] = [1e-3, 1e-4].map(|t| change(t).map(|change| (change, (change - t * slope).abs())));
                let ((whole, coarse), (_, fine)) = (coarse?, fine?);
                assert!(coarse < 0.5 * whole.abs() && coarse > 1e-11, "{coarse:e} of {whole:e}, {along:?}");
                orders.push((coarse / fine).log10());
            }
            println!("{:<24} {dissipation:?}: orders {orders:.3?}", parts[0].0.name());
            let exact = orders.iter().all(|order| *order > 1.95);
            assert!(exact, "{}, {dissipation:?}: {orders:?}", parts[0].0.name());
        }
    }
    Ok(())
}

/// Each instant by itself, the first included, over a change of the step's length and of the scheme: after the midpoint rule an
/// acceleration has to be found.
#[test]
fn every_instant_of_a_moving_support_has_its_derivative() -> Outcome {
    for dissipation in [Dissipation::Rayleigh, Dissipation::Maxwell] {
        let solid = strip(dissipation)?;
        let of_kind = schemes_with_moving_supports()?.into_iter().filter(|(scheme, _)| dissipation.goes_with(scheme));
        let mut mixtures: Vec<Vec<Scheme>> = of_kind.map(|(scheme, _)| vec![scheme]).collect();
        mixtures.push(vec![Scheme::implicit_midpoint(), Scheme::trapezoidal(), Scheme::bdf2()]);
        for mixture in mixtures {
            let schemes = mixture.iter().cycle().zip([0.4, 0.4, 0.7]);
            let parts: Vec<_> = schemes.map(|(scheme, dt)| (scheme.clone(), dt, 2)).collect();
            let swept = sweep(&solid, &run(&solid, &parts, Along::Fibre, |_| 0.0)?)?;
            for (n, by) in swept.iter().enumerate() {
                let along = Along::ALL[n % 2];
                let at = |t: f64| run(&solid, &parts, along, |k| if k == n { t } else { 0.0 }).map(|r| functional(&r));
                let difference = |t: f64| -> Outcome<f64> { Ok(at(t)? - at(-t)?) };
                let expected = (8.0 * difference(5e-3)? - difference(1e-2)?) / 0.06;
                let found = slope(&solid, along, n, by);
                let error = (found - expected).abs();
                let name = mixture[0].name();
                assert!(
                    error < 1e-6 * expected.abs() + 1e-9,
                    "{name}, {dissipation:?}, {along:?} at instant {n}: {found:e}, {expected:e}"
                );
            }
        }
    }
    Ok(())
}

/// From states that are computed again, the same bits.
#[test]
fn a_moving_support_has_the_same_derivative_from_few_states() -> Outcome {
    for (scheme, _) in schemes_with_moving_supports()? {
        let solid = strip(if scheme.is_linearised() { Dissipation::None } else { Dissipation::Maxwell })?;
        let to = |n: usize| StepTo { dt: H, controls: controls(&solid, n, (Along::Fibre, 0.0)) };
        let derivative = |plan: Checkpoints| -> Outcome<(Vec<u64>, usize)> {
            let (model, mut workspace) = (solid.model(), Workspace::default());
            let begin = Trajectory::from(model.solve_with(&to(0).controls, &STRICT, &mut workspace)?);
            let mut motion = Recording::new(begin, scheme.clone(), plan);
            for n in 1..=plan.steps() {
                motion.advance(model, &to(n), &STRICT, &mut workspace)?;
            }
            let mut sweep = ReverseSweep::new(model, &STRICT, &mut workspace);
            let (mut all, mut first) = (Vec::new(), None);
            let bits = |by: &Controls| (0..by.len()).flat_map(|k| by.values(k).to_vec()).map(f64::to_bits).collect();
            motion.backwards(model, &mut |n| Ok::<_, StateError>(to(n)), &STRICT, &mut |part, k| {
                let n = part.first() + k + 1;
                let by: Vec<u64> = bits(&sweep.step(part, k, partials(n, &part.states()[k + 1]))?.controls);
                all.extend(by);
                first = (n == 1).then(|| part.clone());
                Ok(())
            })?;
            let first = first.ok_or("no step")?;
            all.extend::<Vec<u64>>(bits(&sweep.begin(&first, partials(0, &first.states()[0]))?.0.controls));
            Ok((all, motion.counts().recomputed_steps))
        };
        let (all, none) = derivative(Checkpoints::all(18, 4)?)?;
        let (few, again) = derivative(Checkpoints::at_most(2, 18, 4)?)?;
        assert!(none == 0 && again > 0);
        assert!(all == few, "{}", scheme.name());
    }
    Ok(())
}
