//! Motions of bodies whose cavity has a given volume, whose tendon cannot stretch: derivatives by the volume and by the pull in time.

use nastic_control::{
    Interpolation, KineticEnergy, Knots, MotionMemory, Reduced, Space, Target, Timeline, Tracking, When,
};
use nastic_fem::catalogue::CATALOGUE;
use nastic_fem::{Inertia, Scheme, Solid};
use nastic_opt::{Bounds, Objective, Taylor, Verdict};

type Done<T = ()> = Result<T, Box<dyn std::error::Error>>;

const END: f64 = 0.4;

/// The cup of the catalogue with a contribution, as heavy as water.
fn cup(name: &str) -> Done<Solid> {
    let entry = CATALOGUE.iter().find(|entry| entry.name == name).ok_or("it is not in the catalogue")?;
    Ok((entry.example)()?.inertia(Inertia::new("body", 1000.0))?)
}

fn driven(solid: Solid, control: &str, scheme: Scheme, memory: MotionMemory) -> Done<Reduced> {
    let wider = Target::position(|x| [1.06 * x[0], x[1], x[2]]);
    Ok(Reduced::new(solid)
        .in_time(Timeline::uniform(scheme, END, 16)?.segments_of(4).keep(memory))?
        .control_in_time(control, Space::Uniform, Knots::every(0.1, END, Interpolation::Linear)?)?
        .cost_when(When::Integral, Tracking::surface("x+", wider))?)
}

/// An added volume, and a pull under which the tendon stays taut.
fn problems() -> Done<Vec<(String, Solid, f64)>> {
    let (volume, pull) = ("cavity of a volume", "tendon that cannot stretch");
    Ok(vec![(volume.to_owned(), cup(volume)?, 0.05), (pull.to_owned(), cup(pull)?, 0.1)])
}

#[test]
fn derivatives_by_constrained_quantities_in_time_are_exact() -> Done {
    for scheme in [Scheme::backward_euler(), Scheme::bdf2()] {
        for (control, solid, size) in problems()? {
            let problem = driven(solid, &control, scheme.clone(), MotionMemory::All)?
                .trajectory_cost(KineticEnergy::new(When::Integral, 1.0)?)?;
            let m: Vec<f64> = (0..problem.layout().len()).map(|k| size * (1.0 + 0.05 * k as f64)).collect();
            let report = Taylor::default().test(&problem, &Bounds::new(0.5 * size, 2.0 * size)?, &m)?;
            println!("{control} by {}: {report}", scheme.name());
            assert_eq!(report.verdict(), Verdict::Right, "{control} by {}: {report}", scheme.name());
            assert!(report.directions.iter().all(|direction| direction.order1 > 1.95), "{control}: {report}");
        }
    }
    Ok(())
}

/// From checkpoints as with all states.
#[test]
fn few_states_give_the_same_bits() -> Done {
    let derivative = |memory: MotionMemory| -> Done<Vec<u64>> {
        let (control, solid, size) = problems()?.swap_remove(0);
        let problem = driven(solid, &control, Scheme::bdf2(), memory)?;
        let m = vec![size; problem.layout().len()];
        let mut workspace = Default::default();
        let mut point = problem.evaluate(&m, &Default::default(), &mut workspace)?;
        Ok(problem.derivative(&mut point, &mut workspace)?.iter().map(|x| x.to_bits()).collect())
    };
    assert_eq!(derivative(MotionMemory::All)?, derivative(MotionMemory::Checkpoints(2))?);
    Ok(())
}
