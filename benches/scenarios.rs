//! One value and derivative of a robust problem of several scenarios, and the memory of a few trials, as a line of JSON.
//!
//! `cargo bench --bench scenarios -- count=8 n=6 threads=2`: the bar of `benches/forward.rs` with hex8, its tension
//! uniform per cell and its shear modulus from 80 % to 120 %. Compare count=1 threads=1 with count=8 threads=2, and
//! `rss_mb` of several counts with `factor_mb`, the size of one factor: `rss_mb` is the peak over three trials, each held
//! beside the point it starts from, as an optimiser does.

#![allow(clippy::print_stdout)] // programs talk, libraries do not

mod common;

use common::{Arguments, median, peak_memory, threads};
use nastic::control::EnsembleWorkspace;
use nastic::prelude::*;
use nastic::uncertainty::risk::Mean;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments = Arguments::read(&["count", "n", "repeat", "threads"])?;
    let (count, across) = (arguments.number("count", 8)?, arguments.number("n", 6)?);
    let repeat = arguments.number("repeat", 3)?;
    arguments.use_threads()?;

    let mesh = Discretization::new(box_mesh([1.0, 0.2, 0.2], [5 * across, across, across], CellKind::Hex8)?.into())?;
    let lifted = Target::position(|x| [0.95 * x[0], x[1], x[2] + 0.2]);
    let mut robust = Ensemble::new(Mean);
    for k in 0..count {
        let share = if count == 1 { 1.0 } else { 0.8 + 0.4 * k as f64 / (count - 1) as f64 };
        let body = Solid::on(mesh.clone())
            .material("body", MooneyRivlin::new(share * 1e5, share * 2e4, 1e6)?)?
            .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
            .clamp("x-")?;
        let problem =
            Reduced::new(body).control("tension", Space::Cell)?.cost(Tracking::surface("x+", lifted.clone()))?;
        robust = robust.scenario(&format!("{k}"), 1.0 / count as f64, problem);
    }
    let robust = robust.build()?;
    let centres = mesh.mesh().points().len();
    let control: Vec<f64> =
        (0..mesh.mesh().cells()).map(|c| -1e5 * ((c / (5 * across)) % across) as f64 / across as f64).collect();
    let seconds = median(repeat, || {
        let mut workspace = EnsembleWorkspace::default();
        let mut point = robust.evaluate(&control, &Request::default(), &mut workspace)?;
        robust.derivative(&mut point, &mut workspace).map(drop)
    })?;
    let mut workspace = EnsembleWorkspace::default();
    let mut point = robust.evaluate(&control, &Request::default(), &mut workspace)?;
    for _ in 0..3 {
        robust.derivative(&mut point, &mut workspace)?;
        let further: Vec<f64> = point.m.iter().map(|m| 1.1 * m).collect();
        point = robust.evaluate(&further, &Request::near(&point), &mut workspace)?;
    }
    let factor = workspace.factor_bytes() as f64 * 1e-6 / count as f64;
    println!(
        "{{\"peer\": \"nastic\", \"scenarios\": {count}, \"ndof\": {}, \"threads\": {}, \"value_and_derivative_s\": {seconds:.4}, \
         \"factor_mb\": {factor:.2}, \"rss_mb\": {:.1}}}",
        3 * centres,
        threads(),
        peak_memory(),
    );
    Ok(())
}
