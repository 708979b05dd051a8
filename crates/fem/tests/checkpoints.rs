//! Motions that keep few of their states: the same bits, as much work and memory as was announced.

use crate::common;

use common::block::STRICT;
use common::motion::{schemes, steps};
use common::{Outcome, noise, regular};
use nastic_energy::{FiberTension, MaxwellBranch, NeoHooke};
use nastic_fem::{
    Checkpoints, Controls, Inertia, Recording, RecordingCounts, ReverseSweep, Scheme, Solid, State, StateError,
    StatePartials, StepTo, TimeStepping, Trajectory, Workspace,
};
use nastic_mesh::CellKind;
use nastic_tensor::Vec3;
use std::time::Instant;

const H: f64 = 0.1;

fn body() -> Outcome<Solid> {
    Ok(elastic()?.viscosity("body", MaxwellBranch::new(0.5, 0.3)?)?.viscosity("body", MaxwellBranch::new(0.2, 3.0)?)?)
}

fn elastic() -> Outcome<Solid> {
    Ok(Solid::new(regular(CellKind::Quad4, [3.0, 1.0, 0.0], [3, 1, 1])?)?
        .material("body", NeoHooke::new(1.0, 2.0)?)?
        .actuate("body", "fibre", FiberTension::along(Vec3::x())?)?
        .body_force("body", Vec3::new(0.0, -2e-3, 0.0))?
        .clamp("x-")?
        .inertia(Inertia::new("body", 1.0))?)
}

/// Controls of one motion at an instant.
fn to(solid: &Solid, n: usize) -> StepTo {
    let mut controls = solid.controls();
    let fibre = solid.model().controllable().iter().position(|known| known.name == "fibre").unwrap_or(usize::MAX);
    let wave = (0.7 * H * n as f64).sin();
    controls.values_mut(fibre).iter_mut().enumerate().for_each(|(i, v)| *v = 0.1 * wave + 0.01 * noise(i));
    StepTo { dt: H, controls }
}

/// `sum_n h (w_n . u_n + |u_n|^2 / 2 + w_n . v_n)`
fn partials(n: usize, state: &State) -> StatePartials {
    let weight = |i: usize| noise(77 + 100 * n + i);
    let u = state.u.iter().enumerate().map(|(i, u)| H * (weight(i) + u)).collect();
    let velocity = if n > 0 { (0..state.u.len()).map(|i| H * weight(i)).collect() } else { Vec::new() };
    StatePartials { u, velocity, ..StatePartials::default() }
}

/// A run and its derivative by the controls of each instant, from the last to the first.
struct Run {
    end: State,
    derivative: Vec<Controls>,
    counts: RecordingCounts,
    /// Of the motion alone.
    factorisations: usize,
    /// Of motion and derivative.
    seconds: (f64, f64),
}

fn run(solid: &Solid, scheme: Scheme, plan: Checkpoints) -> Outcome<Run> {
    let model = solid.model();
    let first = to(solid, 0).controls;
    let mut workspace = Workspace::default();
    let begin = Trajectory::from(model.solve_with(&first, &STRICT, &mut workspace)?);
    let mut motion = Recording::new(begin, scheme, plan);
    let (mut factorisations, clock) = (0, Instant::now());
    for n in 1..=plan.steps() {
        motion.advance(model, &to(solid, n), &STRICT, &mut workspace)?;
        factorisations += motion.part().end().report.factorisations;
    }
    let forward = clock.elapsed().as_secs_f64();
    let clock = Instant::now();
    let end = motion.part().end().clone();
    let mut sweep = ReverseSweep::new(model, &STRICT, &mut workspace);
    let (mut derivative, mut first) = (Vec::new(), None);
    motion.backwards(model, &mut |n| Ok::<_, StateError>(to(solid, n)), &STRICT, &mut |part, k| {
        let n = part.first() + k + 1;
        derivative.push(sweep.step(part, k, partials(n, &part.states()[k + 1]))?.controls);
        if n == 1 {
            first = Some(part.clone());
        }
        Ok(())
    })?;
    let first = first.ok_or("no step")?;
    derivative.push(sweep.begin(&first, partials(0, &first.states()[0]))?.0.controls);
    let seconds = (forward, clock.elapsed().as_secs_f64());
    Ok(Run { end, derivative, counts: motion.counts(), factorisations, seconds })
}

fn bits(controls: &[Controls]) -> Vec<u64> {
    let of = |c: &Controls| (0..c.len()).flat_map(|k| c.values(k).to_vec()).map(f64::to_bits).collect::<Vec<_>>();
    controls.iter().flat_map(of).collect()
}

/// Two Maxwell branches and a scheme over two steps; 70 steps in segments of 1, 4 and 16.
#[test]
fn derivatives_with_few_states_have_the_same_bits() -> Outcome {
    let solid = body()?;
    for scheme in [Scheme::bdf2(), Scheme::tr_bdf2()] {
        for segment in [1, 4, 16] {
            let all = run(&solid, scheme.clone(), Checkpoints::all(70, segment)?)?;
            assert_eq!((all.counts.recomputed_steps, all.counts.states), (0, 71));
            for most in if segment > 1 { [1, 3, 5] } else { [3, 5, 9] } {
                let plan = Checkpoints::at_most(most, 70, segment)?;
                let few = run(&solid, scheme.clone(), plan)?;
                let name = scheme.name();
                println!(
                    "{name:<8} segments of {segment:>2}, {most} checkpoints: {} steps again, {} states at once of at most {}",
                    few.counts.recomputed_steps,
                    few.counts.states,
                    plan.states(&scheme)
                );
                assert_eq!(few.end.u, all.end.u, "{name}");
                assert_eq!(few.end.velocity, all.end.velocity, "{name}");
                assert!(bits(&few.derivative) == bits(&all.derivative), "{name}, {segment}, {most}");
                assert_eq!(few.counts.recomputed_steps, plan.recomputed_steps());
                assert!(few.counts.states <= plan.states(&scheme), "{:?}", few.counts);
                assert!(4 * few.counts.states >= 3 * plan.states(&scheme), "{:?}", few.counts);
            }
        }
    }
    Ok(())
}

/// Every scheme, over 18 steps in segments of four; its last one is short. A linearised step has no adjoint beside viscous laws.
#[test]
fn every_scheme_may_keep_few_states() -> Outcome {
    for (scheme, _) in schemes()?.into_iter().filter(|(scheme, _)| scheme.has_adjoint()) {
        let solid = if scheme.is_linearised() { elastic()? } else { body()? };
        let all = run(&solid, scheme.clone(), Checkpoints::all(18, 4)?)?;
        let few = run(&solid, scheme.clone(), Checkpoints::at_most(2, 18, 4)?)?;
        assert!(bits(&few.derivative) == bits(&all.derivative), "{}", scheme.name());
        assert!(few.counts.recomputed_steps > 0);
    }
    Ok(())
}

/// The least number of segments to be computed again, by its recursion: the first checkpoint behind the beginning at any place.
fn least(segments: usize, checkpoints: usize) -> Vec<Vec<usize>> {
    let mut table = vec![vec![0; segments + 1]; checkpoints + 1];
    for l in 2..=segments {
        for s in 1..=checkpoints {
            // each time from the beginning, or with a checkpoint on the way
            let again = l * (l - 1) / 2;
            let with = (1..l).filter(|_| s > 1).map(|j| j + table[s][j] + table[s - 1][l - j]).min();
            table[s][l] = with.map_or(again, |with| with.min(again));
        }
    }
    table
}

/// The binomial formula against the recursion, and its published cases: l = beta(s, r) takes r l - beta(s + 1, r - 1).
#[test]
fn no_other_places_of_checkpoints_take_less_work() -> Outcome {
    let table = least(80, 7);
    for l in 1..=80 {
        for s in 1..=7 {
            let message = Checkpoints::at_most(s, 3 * l, 3)?.recomputed_steps();
            assert_eq!(message, 3 * table[s][l], "{l} segments, {s} checkpoints");
        }
    }
    // beta(5, 3) = 56, beta(6, 2) = 28; beta(10, 3) = 286 < 1000 <= beta(10, 4) = 1001, beta(11, 3) = 364
    assert_eq!(Checkpoints::at_most(5, 56, 1)?.recomputed_steps(), 3 * 56 - 28);
    assert_eq!(Checkpoints::at_most(10, 1000, 1)?.recomputed_steps(), 4 * 1000 - 364);
    // the last segment may be short
    assert_eq!(Checkpoints::at_most(2, 10, 4)?.recomputed_steps(), Checkpoints::at_most(2, 12, 4)?.recomputed_steps());
    Ok(())
}

#[test]
fn memory_is_told_beforehand() -> Outcome {
    let solid = body()?;
    let (model, scheme) = (solid.model(), Scheme::bdf2());
    let all = Checkpoints::all(200, 8)?;
    let whole = all.bytes(model, &scheme);
    assert_eq!(Checkpoints::within(whole, 200, 8, model, &scheme)?, all);
    let half = Checkpoints::within(whole / 2, 200, 8, model, &scheme)?;
    assert!(half.bytes(model, &scheme) <= whole / 2 && half.recomputed_steps() > 0);
    let most = half.most().ok_or("checkpoints")?;
    let more = Checkpoints::at_most(most + 1, 200, 8)?;
    assert!(more.bytes(model, &scheme) > whole / 2 || most == half.segments(), "{most}");
    let refused = Checkpoints::within(1000, 200, 8, model, &scheme).err().ok_or("too little")?.to_string();
    let least = Checkpoints::at_most(1, 200, 8)?.bytes(model, &scheme);
    assert!(refused.contains(&least.to_string()), "{refused}");
    assert!(Checkpoints::at_most(0, 8, 2).is_err() && Checkpoints::all(8, 0).is_err());

    // the states of a motion as they are
    let trajectory = {
        let mut run = Trajectory::from_given(solid.rest());
        let all = steps(20, H, |t| to(&solid, (t / H).round() as usize).controls);
        model.advance(&mut run, &scheme, &all, &STRICT, &mut Workspace::default())?;
        run
    };
    let of = |state: &State| {
        let rates = [&state.velocity, &state.acceleration].into_iter().flatten().map(|v| v.len()).sum::<usize>();
        let controls: usize = (0..state.controls.len()).map(|k| state.controls.values(k).len()).sum();
        let history: usize = (0..state.history.len()).map(|k| state.history.values(k).len()).sum();
        8 * (state.u.len() + rates + controls + history)
    };
    let found: usize = trajectory.states()[1..].iter().map(of).sum();
    let message = Checkpoints::all(19, 8)?.bytes(model, &scheme);
    assert_eq!(message, found);
    Ok(())
}

/// Times of forward runs and derivatives, and factorisations by the length of segments: a table, nothing asserted but bits.
#[test]
#[ignore = "a table of times: a minute or two"]
fn what_few_states_cost() -> Outcome {
    let solid = Solid::new(regular(CellKind::Hex8, [3.0, 1.0, 1.0], [9, 3, 3])?)?
        .material("body", NeoHooke::new(1.0, 2.0)?)?
        .viscosity("body", MaxwellBranch::new(0.5, 0.3)?)?
        .viscosity("body", MaxwellBranch::new(0.2, 3.0)?)?
        .actuate("body", "fibre", FiberTension::along(Vec3::x())?)?
        .clamp("x-")?
        .inertia(Inertia::new("body", 1.0))?;
    for segment in [1000, 16, 4, 1] {
        let all = run(&solid, Scheme::bdf2(), Checkpoints::all(64, segment)?)?;
        let (forward, gradient) = all.seconds;
        println!(
            "segments of {segment}: {} factorisations, forward {forward:.2} s, gradient {gradient:.2} s, {:.2} of it",
            all.factorisations,
            gradient / forward
        );
        for most in [3, 5].into_iter().filter(|_| segment < 64) {
            let plan = Checkpoints::at_most(most, 64, segment)?;
            let few = run(&solid, Scheme::bdf2(), plan)?;
            assert!(bits(&few.derivative) == bits(&all.derivative));
            let share = plan.recomputed_steps() as f64 / 64.0;
            println!(
                "  {most} checkpoints: {} states, {} kB of {}, {} steps again; gradient {:.2} of its forward run, {:.2} expected",
                plan.states(&Scheme::bdf2()),
                plan.bytes(solid.model(), &Scheme::bdf2()) / 1000,
                Checkpoints::all(64, segment)?.bytes(solid.model(), &Scheme::bdf2()) / 1000,
                plan.recomputed_steps(),
                few.seconds.1 / few.seconds.0,
                gradient / forward + share
            );
        }
    }
    Ok(())
}
