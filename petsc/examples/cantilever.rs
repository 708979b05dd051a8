//! The fibre cantilever of docs/development/verification.md on the ranks of MPI, 5n x n x n cells: `mpirun -n 4 cantilever hex8 6 [1.0 OPTIONS OF PETSC..]`.
//!
//! With `serial` in the place of options every process solves the whole body by a solver of nastic. Rank 0 prints a line of JSON: unknowns, tip,
//! Newton and CG iterations, the cost `|u_tip - (0, 0, 0.2)|^2 / 2` and its derivative by the tension, from the adjoint.

use nastic_energy::{FiberTension, MooneyRivlin};
use nastic_fem::{Controls, Instant, Solid, SolveOptions, State};
use nastic_linear::Space;
use nastic_mesh::{CellKind, box_mesh};
use nastic_petsc::{PETSC, Session};
use nastic_team::Team;
use nastic_tensor::Vec3;
use std::io::Write;
use std::time::Instant as Clock;

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

const TIP: [f64; 3] = [1.0, 0.2, 0.2];

/// `m(X) = -1.5e5 f Z / 0.2` at the quadrature points.
fn tension(solid: &Solid, factor: f64) -> Outcome<Controls> {
    let mut controls = solid.controls();
    let at = solid.discretization().points().positions(solid.mesh(), None);
    let tension: Vec<f64> = at.iter().map(|x| -1.5e5 * factor * x[2] / 0.2).collect();
    controls.set(0, 0, &tension)?;
    Ok(controls)
}

/// The node at the tip, where this rank has it.
fn tip(solid: &Solid) -> Option<usize> {
    let off = |x: &[f64; 3]| (0..3).map(|k| (x[k] - TIP[k]).abs()).sum::<f64>();
    solid.mesh().points().iter().position(|x| off(x) < 1e-9)
}

/// Its displacement, on all ranks.
fn tip_displacement(solid: &Solid, state: &State) -> [f64; 3] {
    let space: &Space = solid.model().unknowns();
    let own = tip(solid).filter(|node| space.share().is_none_or(|share| *node < share.owned()));
    [0, 1, 2].map(|k| space.total(own.map_or(0.0, |node| state.u[3 * node + k])))
}

fn solved(session: &Session, (kind, n, factor): (CellKind, usize, f64), serial: bool) -> Outcome<String> {
    let (rank, began) = (session.rank().clone(), Clock::now());
    let mesh = box_mesh([1.0, 0.2, 0.2], [5 * n, n, n], kind)?;
    let unknowns = 3 * mesh.points().len();
    let body = if serial {
        Solid::new(mesh)?
    } else {
        let part = mesh.part(&mesh.bisected(rank.size())?, rank.rank() as u32)?;
        Solid::of_part(part, rank.clone())?.solver(PETSC)
    };
    let solid = body
        .material("body", MooneyRivlin::new(1e5, 2e4, 1e6)?)?
        .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
        .clamp("x-")?;
    let how = SolveOptions { parallel: false, ..SolveOptions::default() };
    let state = solid.solve(&tension(&solid, factor)?, &how)?;
    let forward = began.elapsed().as_secs_f64();

    let tip_at = tip_displacement(&solid, &state);
    let off = [tip_at[0], tip_at[1], tip_at[2] - 0.2];
    let mut rhs = vec![0.0; state.u.len()];
    if let Some(node) = tip(&solid) {
        (0..3).for_each(|k| rhs[3 * node + k] = -off[k]);
    }
    let adjoint = solid.adjoint(&state, &[&rhs], &how)?;
    let found = solid.model().vjp(&Instant::of(&state), &adjoint.lambda[0])?;
    let along = tension(&solid, 1.0)?;
    let own: f64 = found.controls.values(0).iter().zip(along.values(0)).map(|(a, b)| a * b).sum();
    let slope = solid.model().unknowns().total(own);

    let report = state.report;
    let cost = 0.5 * off.iter().map(|x| x * x).sum::<f64>();
    Ok(format!(
        "{{\"ranks\": {}, \"unknowns\": {unknowns}, \"tip\": [{:.12}, {:.12}, {:.12}], \"energy\": {:.10e}, \"newton\": {}, \"load_steps\": {}, \
         \"systems\": {}, \"iterations\": {}, \"adjoint_iterations\": {}, \"cost\": {cost:.16e}, \"slope\": {slope:.16e}, \
         \"forward_seconds\": {forward:.2}, \"seconds\": {:.2}}}",
        rank.size(),
        tip_at[0],
        tip_at[1],
        tip_at[2],
        report.energy,
        report.newton,
        report.load_steps,
        report.hierarchies,
        report.cycles,
        adjoint.report.cycles,
        began.elapsed().as_secs_f64()
    ))
}

/// What a rank fails of.
fn say(session: &Session, error: Box<dyn std::error::Error>) {
    // nothing is left to do where this cannot be written either
    let _ = writeln!(std::io::stderr().lock(), "rank {}: {error}", session.rank().rank());
}

fn main() -> Outcome {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let usage = "cantilever hex8|hex27 N [FACTOR [OPTIONS OF PETSC..]]";
    let kind = match arguments.first().map(String::as_str) {
        Some("hex8") => CellKind::Hex8,
        Some("hex27") => CellKind::Hex27,
        _ => return Err(usage.into()),
    };
    let n = arguments.get(1).ok_or(usage)?.parse()?;
    let factor = arguments.get(2).map_or(Ok(1.0), |factor| factor.parse())?;
    let options = arguments.get(3..).unwrap_or_default();
    let serial = options == ["serial"];
    let work = |session: &Session| -> Outcome {
        let line = solved(session, (kind, n, factor), serial)?;
        if session.rank().leads() {
            writeln!(std::io::stdout().lock(), "{line}")?;
        }
        Ok(())
    };
    Ok(Session::run(&if serial { String::new() } else { options.join(" ") }, work, say)?)
}
