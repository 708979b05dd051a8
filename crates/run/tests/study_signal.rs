//! A Ctrl-C stops a study, which keeps what it found. A process of its own: signals are the whole process's.

#![cfg(unix)]

use nastic_control::{Reduced, Space, Target, Tracking};
use nastic_energy::{FiberTension, NeoHooke};
use nastic_fem::Solid;
use nastic_mesh::{CellKind, box_mesh};
use nastic_opt::{Bounds, Lbfgs};
use nastic_run::record::TrialRecord;
use nastic_run::run::{Exit, OnTrial, Study};
use nastic_run::signals::cancelled_by_signals;
use nastic_tensor::Vec3;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

#[test]
fn ctrl_c_stops_a_study_that_is_interruptible() -> Result<(), Box<dyn std::error::Error>> {
    let place = tempfile::tempdir()?;
    let body = Solid::new(box_mesh([1.0, 0.2, 0.2], [4, 1, 2], CellKind::Hex8)?)?
        .material("body", NeoHooke::from_young_poisson(3e5, 0.3)?)?
        .actuate("body", "top", FiberTension::along(Vec3::x())?)?
        .clamp("x-")?;
    let target = Target::position(|x| [0.95 * x[0], x[1], x[2] + 0.05]);
    let problem = Reduced::new(body).control("top", Space::Cell)?.cost(Tracking::surface("x+", target))?;
    let interrupt = |line: &TrialRecord| {
        if line.trial == 3 {
            signal_hook::low_level::raise(signal_hook::consts::SIGINT).unwrap();
            // The same flag, which another thread raises.
            let flag = cancelled_by_signals(|_| {});
            let began = Instant::now();
            while !flag.load(Ordering::Relaxed) && began.elapsed() < Duration::from_secs(60) {
                std::thread::yield_now();
            }
        }
    };
    let study = Study::new(problem)?.within("top", Bounds::new(-1e5, 0.0)?).start("top", vec![-1e3]);
    let study = study.directory(place.path()).checkpoints_every(1).on_trial(OnTrial::call(interrupt)).interruptible();
    let found = study.optimize(&Lbfgs::default())?;
    assert_eq!(found.outcome.exit, Exit::NotConverged);
    assert!(
        found.outcome.result["stop"].as_str().is_some_and(|stop| stop == "cancelled"),
        "{}",
        found.outcome.result["stop"]
    );
    assert_eq!(found.outcome.result["trials"], 3);
    assert!(place.path().join("checkpoint.bin").is_file() && place.path().join("optimum.vtu").is_file());
    Ok(())
}
