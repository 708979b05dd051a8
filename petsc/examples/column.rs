//! A column, clamped at one end and shortened beyond buckling, on the ranks of MPI: `mpirun -n 3 column [OPTIONS OF PETSC..]`.
//!
//! Its tangent is indefinite. Rank 0 prints a line of JSON: negative eigenvalues as PETSC counts them, those of one process by a factor of nastic, and
//! how a linear system ends whose right-hand side hardly bends the column. With `fail` or `panic` behind the options the last rank does that instead.

use nastic_energy::NeoHooke;
use nastic_fem::{Solid, SolveOptions, SolveReport, State};
use nastic_mesh::{CellKind, box_mesh};
use nastic_petsc::{PETSC, Session};
use nastic_team::Team;
use std::io::Write;

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

/// Shortening over length.
const SHORTER: f64 = 0.04;

fn column(body: Solid) -> Outcome<Solid> {
    Ok(body.material("body", NeoHooke::from_young_poisson(1e5, 0.3)?)?.clamp("x-")?)
}

fn shortened(solid: &Solid) -> State {
    let u = solid.mesh().points().iter().flat_map(|x| [-SHORTER * x[0], 0.0, 0.0]).collect();
    State::equilibrium(u, solid.controls(), 1.0, SolveReport::default())
}

fn looked_into(session: &Session) -> Outcome<String> {
    let (rank, how) = (session.rank().clone(), SolveOptions { parallel: false, ..SolveOptions::default() });
    let mesh = box_mesh([1.0, 0.1, 0.1], [12, 2, 2], CellKind::Hex8)?;
    let whole = column(Solid::new(mesh.clone())?)?;
    let expected = whole.model().stability().negative_pivots_by(&shortened(&whole), &how)?;
    let part = mesh.part(&mesh.bisected(rank.size())?, rank.rank() as u32)?;
    let solid = column(Solid::of_part(part, rank)?.solver(PETSC))?;
    let state = shortened(&solid);
    let negative = solid.model().stability().negative_pivots_by(&state, &how)?;
    // along the column, and a little across it
    let b: Vec<f64> = solid.mesh().points().iter().flat_map(|x| [1.0, 0.0, 1e-3 * x[0]]).collect();
    let ended = match solid.adjoint(&state, &[&b], &how) {
        Ok(_) => "solved".to_owned(),
        Err(error) => error.to_string(),
    };
    Ok(format!("{{\"negative\": {negative}, \"expected\": {expected}, \"ended\": {ended:?}}}"))
}

/// What a rank fails of.
fn say(session: &Session, error: Box<dyn std::error::Error>) {
    // nothing is left to do where this cannot be written either
    let _ = writeln!(std::io::stderr().lock(), "rank {}: {error}", session.rank().rank());
}

fn main() -> Outcome {
    let mut options: Vec<String> = std::env::args().skip(1).collect();
    let fails = options.pop_if(|last| last == "fail" || last == "panic");
    let work = |session: &Session| -> Outcome {
        if session.rank().rank() + 1 == session.rank().size() {
            match fails.as_deref() {
                Some("fail") => return Err("as it was told".into()),
                Some(_) => assert_eq!(options.first(), fails.as_ref(), "as it was told"),
                None => {}
            }
        }
        let line = looked_into(session)?;
        if session.rank().leads() {
            writeln!(std::io::stdout().lock(), "{line}")?;
        }
        Ok(())
    };
    Ok(Session::run(&options.join(" "), work, say)?)
}
