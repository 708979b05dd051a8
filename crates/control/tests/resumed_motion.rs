//! A motion that is cut and goes on from the bytes it left gives the bits of one that was not.

use nastic_control::{
    ControlError, CostLimit, Evaluated, Instants, Interpolation, KineticEnergy, Knots, MotionMemory, MotionObserver,
    Reduced, ReducedWorkspace, Space, Target, Timeline, Tracking, When,
};
use nastic_energy::{FiberTension, MaxwellBranch, NeoHooke};
use nastic_fem::{Inertia, Scheme, Solid, State};
use nastic_mesh::{CellKind, box_mesh};
use nastic_opt::Request;
use nastic_tensor::Vec3;
use std::sync::{Mutex, PoisonError};

type Done<T = ()> = Result<T, Box<dyn std::error::Error>>;

const END: f64 = 0.2;

/// A viscoelastic arm with two Maxwell branches, which begins at an equilibrium.
fn arm() -> Done<Solid> {
    Ok(Solid::new(box_mesh([0.5, 0.05, 0.05], [4, 1, 1], CellKind::Hex8)?)?
        .material("body", NeoHooke::from_young_poisson(1e5, 0.3)?)?
        .viscosity("body", MaxwellBranch::new(1e4, 0.05)?)?
        .viscosity("body", MaxwellBranch::new(2e4, 0.01)?)?
        .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
        .clamp("x-")?
        .inertia(Inertia::new("body", 1000.0))?)
}

/// 22 steps, of two lengths, in segments of four.
fn problem(scheme: Scheme, memory: MotionMemory) -> Done<Reduced> {
    in_segments(4, scheme, memory)
}

/// 22 steps, of two lengths, in segments of so many.
fn in_segments(of: usize, scheme: Scheme, memory: MotionMemory) -> Done<Reduced> {
    let instants = (0..=22).map(|n| END * if n <= 10 { f64::from(n) / 20.0 } else { f64::from(n - 10) / 24.0 + 0.5 });
    let timeline = Timeline::through(scheme, instants.collect())?.segments_of(of).keep(memory);
    let raised = |by: f64| Target::position(move |x| [x[0], x[1], x[2] + by]);
    Ok(Reduced::new(arm()?)
        .in_time(timeline)?
        .control_in_time("tension", Space::Cell, Knots::every(0.05, END, Interpolation::Linear)?)?
        .cost_when(When::Integral, Tracking::surface("x+", raised(0.05)))?
        .cost(Tracking::surface("x+", raised(0.1)))?
        .constrain_when(Instants::All, CostLimit::at_most(Tracking::surface("x+", raised(0.02)), 1e-6))?)
}

/// States, and places to go on from, with their numbers.
type Told = (Vec<(usize, State)>, Vec<(usize, Vec<u8>)>);

/// Keeps what is reported, and cuts the motion at a state.
#[derive(Default)]
struct Cut {
    at: usize,
    from: Option<Vec<u8>>,
    message: Mutex<Told>,
}

impl MotionObserver for Cut {
    fn resume(&self) -> Option<Vec<u8>> {
        self.from.clone()
    }

    fn reached(&self, n: usize, state: &State) -> Result<(), ControlError> {
        self.message.lock().unwrap_or_else(PoisonError::into_inner).0.push((n, state.clone()));
        if n == self.at { Err(ControlError::Cost { what: "cut".to_owned() }) } else { Ok(()) }
    }

    fn resumable(&self, n: usize, bytes: &dyn Fn() -> Vec<u8>) {
        self.message.lock().unwrap_or_else(PoisonError::into_inner).1.push((n, bytes()));
    }
}

fn observe(problem: &Reduced, at: usize, from: Option<Vec<u8>>) -> Done<(Result<Evaluated, ControlError>, Told)> {
    let m: Vec<f64> = (0..problem.layout().len()).map(|i| -1e4 * (1.0 + 0.1 * (i % 7) as f64)).collect();
    let cut = Cut { at, from, message: Mutex::default() };
    let found = problem.observe(&m, &Request::default(), &cut, &mut ReducedWorkspace::default());
    Ok((found, cut.message.into_inner().unwrap_or_else(PoisonError::into_inner)))
}

fn bits(state: &State) -> Vec<u64> {
    let controls = (0..state.controls.len()).flat_map(|k| state.controls.values(k));
    let rates = state.velocity.iter().chain(&state.acceleration).flat_map(|rate| rate.iter());
    let history = (0..state.history.len()).flat_map(|k| state.history.values(k)).chain([&state.history.dt]);
    let numbers = state.u.iter().chain(history).chain(controls).chain(rates);
    numbers.chain([&state.time, &state.report.min_j]).map(|x| x.to_bits()).collect()
}

#[test]
fn a_motion_goes_on_with_the_same_bits() -> Done {
    for (scheme, memory) in [
        (Scheme::bdf2(), MotionMemory::All),
        (Scheme::bdf2(), MotionMemory::Checkpoints(2)),
        (Scheme::tr_bdf2(), MotionMemory::All),
    ] {
        let name = scheme.name();
        let problem = problem(scheme, memory)?;
        let (whole, (states, places)) = observe(&problem, usize::MAX, None)?;
        let whole = whole?;
        assert_eq!(places.iter().map(|(n, _)| *n).collect::<Vec<_>>(), [0, 4, 8, 12, 16, 20, 22]);
        // cut before the steps change their length, behind that, and within the first segment
        for at in [10, 17, 2] {
            let (cut, (_, places)) = observe(&problem, at, None)?;
            assert!(cut.is_err_and(|error| error.to_string() == "cut"));
            let (n, bytes) = places.last().cloned().ok_or("no place to go on from")?;
            assert_eq!(n, at / 4 * 4);
            let (again, (rest, _)) = observe(&problem, usize::MAX, Some(bytes))?;
            let again = again?;
            assert_eq!(rest.iter().map(|(k, _)| *k).collect::<Vec<_>>(), (n + 1..=22).collect::<Vec<_>>());
            for (k, state) in &rest {
                assert_eq!(bits(state), bits(&states[*k].1), "{name}: state {k} of a motion cut at {at}");
            }
            assert_eq!((&again.terms, again.work), (&whole.terms, whole.work), "{name} {at}");
            assert_eq!((again.constraints.len(), &again.constraints), (23, &whole.constraints), "{name} {at}");
            let run = |point: &Evaluated| (point.solved.min_j, point.solved.error);
            assert_eq!(run(&again), run(&whole));
            // its states are found again where they are asked for; a derivative is refused
            let mut count = 0;
            problem.for_each_state(&again, &mut |k, state| {
                assert_eq!(bits(state), bits(&states[k].1));
                count += 1;
                Ok(())
            })?;
            assert_eq!(count, 23);
            let term = problem.derivative_of_term(&again, 0, &mut ReducedWorkspace::default());
            assert!(term.is_err_and(|error| error.to_string().contains("resumed")));
        }
        // the end is a place too: nothing is computed
        let (n, bytes) = places.last().cloned().ok_or("no end")?;
        let (again, (rest, _)) = observe(&problem, usize::MAX, Some(bytes))?;
        assert_eq!((n, rest.len(), &again?.terms), (22, 0, &whole.terms));
    }
    Ok(())
}

/// Steps that take much work end what is lost of a stopped motion before its segment does, by counts that come out the same when they are computed again.
#[test]
fn hard_steps_make_places_to_go_on_from_within_segments() -> Done {
    for memory in [MotionMemory::All, MotionMemory::Checkpoints(1)] {
        let problem = in_segments(21, Scheme::tr_bdf2(), memory)?;
        let (whole, (states, places)) = observe(&problem, usize::MAX, None)?;
        let (mut whole, mut sum, mut expected) = (whole?, 0, vec![0]);
        for (n, state) in &states[1..] {
            sum += state.report.newton;
            if sum >= 96 || [21, 22].contains(n) {
                expected.push(*n);
                sum = 0;
            }
        }
        assert_eq!(places.iter().map(|(n, _)| *n).collect::<Vec<_>>(), expected);
        assert!(expected.len() > 3, "no step is hard: {expected:?}");
        let (n, bytes) = places[1].clone();
        let (again, (rest, _)) = observe(&problem, usize::MAX, Some(bytes))?;
        assert_eq!((&again?.terms, rest.len()), (&whole.terms, 22 - n));
        assert!(rest.iter().all(|(k, state)| bits(state) == bits(&states[*k].1)));
        // states that were not kept come out the same
        let derivative = problem.derivative_of_term(&whole, 0, &mut ReducedWorkspace::default())?;
        let kept = in_segments(21, Scheme::tr_bdf2(), MotionMemory::All)?;
        whole = observe(&kept, usize::MAX, None)?.0?;
        assert_eq!(derivative, kept.derivative_of_term(&whole, 0, &mut ReducedWorkspace::default())?);
    }
    Ok(())
}

#[test]
fn bytes_of_another_problem_are_refused() -> Done {
    let own = problem(Scheme::bdf2(), MotionMemory::All)?;
    let (_, (_, places)) = observe(&own, 9, None)?;
    let (_, bytes) = places.last().cloned().ok_or("no place")?;
    let other = Reduced::new(arm()?)
        .in_time(Timeline::uniform(Scheme::bdf2(), END, 20)?.segments_of(4))?
        .control_in_time("tension", Space::Cell, Knots::every(0.05, END, Interpolation::Linear)?)?
        .cost_when(When::Integral, Tracking::surface("x+", Target::position(|x| x)))?
        .cost(Tracking::surface("x+", Target::position(|x| x)))?;
    let other_scheme = problem(Scheme::implicit_midpoint(), MotionMemory::All)?;
    for (problem, bytes, wanted) in [
        (&other, bytes.clone(), "costs at other instants"),
        (&own, bytes[..bytes.len() - 3].to_vec(), "they end early"),
        (&own, b"something else".to_vec(), "not a saved run"),
        (&other_scheme, bytes.clone(), "by another time scheme"),
    ] {
        let error = observe(problem, usize::MAX, Some(bytes))?.0.err().map(|error| error.to_string());
        assert!(error.as_ref().is_some_and(|error| error.contains(wanted)), "{error:?}: {wanted}");
    }
    // what looks at all states leaves no place to go on from
    let looking =
        problem(Scheme::bdf2(), MotionMemory::All)?.trajectory_cost(KineticEnergy::new(When::Integral, 1.0)?)?;
    let (found, (_, places)) = observe(&looking, usize::MAX, None)?;
    assert!(found.is_ok() && places.is_empty());
    Ok(())
}
