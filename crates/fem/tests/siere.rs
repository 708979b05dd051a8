//! `siere`: the lowest modes without numerical damping, the others as by linearly implicit Euler; what it refuses.

use crate::common;

use common::block::STRICT;
use common::motion::{motion, oscillators, steps, uniform};
use common::own_contributions::Oscillators;
use common::{Outcome, distance, nodal, regular};
use nalgebra::{DMatrix, DVector};
use nastic_energy::{MaxwellBranch, NeoHooke};
use nastic_fem::{
    Demand, Inertia, Instant, Scheme, Solid, State, StateError, StatePartials, StepTo, TimeStepping, Trajectory,
    Workspace,
};
use nastic_linear::LinearError;
use nastic_mesh::CellKind;
use nastic_tensor::Vec3;
use std::sync::Arc;

/// `q'' + d q' + k q = f` from (u, v): closed form.
fn exact(t: f64, (d, k, f): (f64, f64, f64), [u, v]: [f64; 2]) -> [f64; 2] {
    let (w, rest) = ((k - 0.25 * d * d).sqrt(), f / k);
    let (a, decay) = (u - rest, (-0.5 * d * t).exp());
    let b = (v + 0.5 * d * a) / w;
    let (sin, cos) = (w * t).sin_cos();
    let q = decay * (a * cos + b * sin);
    [rest + q, -0.5 * d * q + decay * w * (b * cos - a * sin)]
}

/// Backward Euler.
fn euler(h: f64, (d, k, f): (f64, f64, f64), [u, v]: [f64; 2]) -> [f64; 2] {
    let next = (v + h * (f - k * u)) / (1.0 + h * d + h * h * k);
    [u + h * next, next]
}

/// Point masses on springs of their own: those with the six softest ones move exactly, damped or not and under a force, the
/// others as backward Euler says. The damping seen jumps from 0 to ln(1 + t^2)/t between two neighbours.
#[test]
fn the_damping_jumps_behind_the_exact_modes() -> Outcome {
    const EXACT: usize = 6;
    for (t, damping, push) in [(0.1, 0.0, 0.0), (1.0, 0.0, 0.0), (10.0, 0.0, 0.0), (1.0, 0.2, 3e-3), (3.0, 0.5, -1e-2)]
    {
        let masses = Oscillators { mass: 1.0, damping, stiffness: t * t, spread: 0.05 };
        let solid = oscillators(masses.clone())?;
        let free: Vec<usize> = (0..24).filter(|&dof| !solid.supports().fixed()[dof]).collect();
        assert!(free.len() == 12 && free.windows(2).all(|pair| pair[0] < pair[1]));
        let mut run = Trajectory::from_given(uniform(&solid, 1e-2, 3e-3, None));
        let mut controls = solid.controls();
        controls.values_mut(0)[0] = push;
        let to = steps(20, 1.0, |_| controls.clone());
        solid.model().advance(&mut run, &Scheme::siere(EXACT)?, &to, &STRICT, &mut Workspace::default())?;
        for (rank, &dof) in free.iter().enumerate() {
            let spring = (damping, masses.stiffness_of(dof), push);
            let mut expected = [1e-2, 3e-3];
            for state in &run.states()[1..] {
                expected = if rank < EXACT { exact(1.0, spring, expected) } else { euler(1.0, spring, expected) };
                let found = [state.u[dof], state.velocity.as_ref().ok_or("at rest")?[dof]];
                let error = (0..2).map(|i| (found[i] - expected[i]).abs()).fold(0.0, f64::max);
                assert!(error < 1e-12, "h w = {t}, mode {rank}, t = {}: {found:?}, not {expected:?}", state.time);
            }
        }
        if (damping, push) == (0.0, 0.0) {
            let decay = |rank: usize| -> Outcome<f64> {
                let size = |state: &State| -> Outcome<f64> {
                    let v = state.velocity.as_ref().ok_or("at rest")?[free[rank]];
                    Ok((masses.stiffness_of(free[rank]).sqrt() * state.u[free[rank]]).hypot(v))
                };
                Ok(-2.0 / t * (size(&run.states()[1])? / size(&run.states()[0])?).ln())
            };
            let hw = masses.stiffness_of(free[EXACT]).sqrt();
            let (last, first) = (decay(EXACT - 1)?, decay(EXACT)? * t / hw);
            println!("h w = {t:4}: d/w = {last:.1e} of mode {EXACT}, {first:.10} of the next one");
            assert!(last.abs() < 1e-10 && (first - (1.0 + hw * hw).ln() / hw).abs() < 1e-10, "{last:e} {first}");
        }
    }
    Ok(())
}

fn bar() -> Outcome<Solid> {
    Ok(Solid::new(regular(CellKind::Quad4, [1.0, 0.25, 0.0], [4, 1, 1])?)?
        .material("body", NeoHooke::new(200.0, 400.0)?)?
        .clamp("x-")?
        .inertia(Inertia::new("body", 1.0))?)
}

fn bent(solid: &Solid) -> State {
    State {
        u: Arc::new(nodal(solid.mesh(), |x| Vec3::new(0.05 * x.x, 0.1 * x.x * x.x, 0.0))),
        velocity: Some(Arc::new(nodal(solid.mesh(), |x| Vec3::new(0.5 * x.x, -x.x, 0.0)))),
        ..solid.rest()
    }
}

/// A step of a bar far from rest, with the modes by a dense eigenvalue problem of its own and sines of them.
#[test]
fn a_step_is_a_linear_system_and_the_exact_modes() -> Outcome {
    const EXACT: usize = 3;
    let (solid, h) = (bar()?, 0.05);
    let (model, begin) = (solid.model(), bent(&solid));
    let to = [StepTo { dt: h, controls: solid.controls() }];
    let mut run = Trajectory::from_given(begin.clone());
    model.advance(&mut run, &Scheme::siere(EXACT)?, &to, &STRICT, &mut Workspace::default())?;

    let free: Vec<usize> = (0..begin.u.len()).filter(|&i| !solid.supports().fixed()[i]).collect();
    let dense = |multiply: &dyn Fn(&[f64], &mut [f64])| {
        let column = |j: &usize| {
            let (mut unit, mut image) = (vec![0.0; begin.u.len()], vec![0.0; begin.u.len()]);
            unit[*j] = 1.0;
            multiply(&unit, &mut image);
            image
        };
        let columns: Vec<Vec<f64>> = free.iter().map(column).collect();
        DMatrix::from_fn(free.len(), free.len(), |i, j| columns[j][free[i]])
    };
    let (mass, mut tangent) = (model.energies().mass()?, model.tangents().matrix());
    let at = Instant::new(&begin.u, &to[0].controls, 1.0);
    model.tangents().add_tangent(&at, &mut tangent)?;
    let (m, k) = (dense(&|x, y| mass.multiply(x, y)), dense(&|x, y| tangent.multiply(x, y)));
    let gather = |values: &[f64]| DVector::from_iterator(free.len(), free.iter().map(|&i| values[i]));
    let force = -gather(&model.evaluate(&at, Demand { energy: false, force: true })?.force);
    let v = gather(begin.velocity.as_ref().ok_or("at rest")?);

    let mut step = (&m / (h * h) + &k).lu().solve(&(&m * &v / h + &force)).ok_or("singular")?;
    let mut rate = &step / h;
    let l = m.clone().cholesky().ok_or("no mass")?.l();
    let inverse = l.try_inverse().ok_or("no mass")?;
    let eigen = (&inverse * &k * inverse.transpose()).symmetric_eigen();
    let mut ranks: Vec<usize> = (0..free.len()).collect();
    ranks.sort_by(|a, b| eigen.eigenvalues[*a].total_cmp(&eigen.eigenvalues[*b]));
    for &rank in &ranks[..EXACT] {
        let shape = inverse.transpose() * eigen.eigenvectors.column(rank);
        let momentum = &m * &shape;
        let oscillator = (0.0, eigen.eigenvalues[rank], force.dot(&shape));
        let [q, dq] = exact(h, oscillator, [0.0, momentum.dot(&v)]);
        let (of_step, of_rate) = (momentum.dot(&step), momentum.dot(&rate));
        step += &shape * (q - of_step);
        rate += &shape * (dq - of_rate);
    }
    let end = run.end();
    let found = gather(&end.u) - gather(&begin.u);
    let gap = (&found - &step).norm() / step.norm();
    let of_rate = (gather(end.velocity.as_ref().ok_or("at rest")?) - &rate).norm() / rate.norm();
    assert!(gap < 1e-10 && of_rate < 1e-10, "{gap:e} {of_rate:e}");
    Ok(())
}

/// A cantilever that swings through the length of its thickness, T/40 a step: linearly implicit Euler stops it, siere does not.
#[test]
fn a_swinging_bar_keeps_its_lowest_mode() -> Outcome {
    let solid = bar()?;
    let modes = solid.model().vibration_modes(&solid.rest(), 1, &STRICT)?;
    let period = std::f64::consts::TAU / modes[0].square.sqrt();
    let kick: Vec<f64> = modes[0].shape.iter().map(|x| 0.02 * x).collect();
    let begin = State { u: Arc::new(kick), ..solid.rest() };
    let left = |scheme: &Scheme| -> Outcome<f64> {
        let run = motion(&solid, scheme, begin.clone(), 200, period / 40.0)?;
        let far = |states: &[State]| states.iter().flat_map(|s| s.u.iter()).fold(0.0, |most: f64, x| most.max(x.abs()));
        Ok(far(&run.states()[160..]) / far(&run.states()[..1]))
    };
    let (euler, siere) = (left(&Scheme::linearly_implicit_euler())?, left(&Scheme::siere(4)?)?);
    println!("of the amplitude after 4 to 5 periods: {euler:.3}, siere {siere:.3}");
    assert!(euler < 0.2 && (siere - 1.0).abs() < 0.05, "{euler} {siere}");
    Ok(())
}

#[test]
fn what_it_cannot_do_is_said() -> Outcome {
    let solid = bar()?;
    let fail = |solid: &Solid, begin: State, h: f64| -> Outcome<StateError> {
        let mut run = Trajectory::from_given(begin);
        let to = [StepTo { dt: h, controls: solid.controls() }];
        let failed = solid.model().advance(&mut run, &Scheme::siere(2)?, &to, &STRICT, &mut Workspace::default());
        Ok(failed.err().ok_or("a step")?)
    };
    let thrown = nodal(solid.mesh(), |x| Vec3::new(-300.0 * x.x, 0.0, 0.0));
    let error = fail(&solid, State { velocity: Some(Arc::new(thrown)), ..solid.rest() }, 0.01)?;
    assert!(matches!(error, StateError::InStep { .. }) && error.code() == "inverted", "{error}");
    let squeezed = State { u: Arc::new(nodal(solid.mesh(), |x| Vec3::new(-0.8 * x.x, 0.0, 0.0))), ..solid.rest() };
    let error = fail(&solid, squeezed, 1e3)?;
    let StateError::InStep { source, .. } = &error else { return Err(error.to_string().into()) };
    assert!(matches!(**source, StateError::Linear(LinearError::Indefinite { .. })), "{error}");
    let viscous = bar()?.viscosity("body", MaxwellBranch::new(100.0, 0.1)?)?;
    let message = fail(&viscous, viscous.rest(), 0.01)?.to_string();
    assert!(message.contains("\"viscous laws\"") && message.contains("take tr_bdf2"), "{message}");

    let run = motion(&solid, &Scheme::siere(2)?, bent(&solid), 2, 0.01)?;
    let partials = vec![StatePartials::default(); 3];
    let swept = solid.model().reverse_sweep(&run, &partials, &STRICT, &mut Workspace::default());
    let message = swept.err().ok_or("an adjoint")?.to_string();
    assert!(message.contains("the adjoint does not go with \"siere\""), "{message}");
    assert!(Scheme::siere(0).is_err());

    // more modes than unknowns: all of them
    let all = motion(&solid, &Scheme::siere(1000)?, bent(&solid), 3, 0.01)?;
    let most = motion(&solid, &Scheme::siere(16)?, bent(&solid), 3, 0.01)?;
    assert!(distance(&all.end().u, &most.end().u) == 0.0);
    Ok(())
}
