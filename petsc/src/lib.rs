//! One body over the ranks of MPI: [`nastic_fem::Solid::of_part`] with tangent systems solved by PETSc (algebraic multigrid GAMG unless options say
//! otherwise).
//!
//! ```no_run
//! use nastic_fem::Solid;
//! use nastic_mesh::{CellKind, box_mesh};
//! use nastic_petsc::{PETSC, Session};
//! use nastic_team::Team;
//!
//! fn work(session: &Session) -> Result<(), Box<dyn std::error::Error>> {
//!     let rank = session.rank().clone();
//!     let mesh = box_mesh([1.0, 0.2, 0.2], [30, 6, 6], CellKind::Hex8)?;
//!     let part = mesh.part(&mesh.bisected(rank.size())?, rank.rank() as u32)?;
//!     let solid = Solid::of_part(part, rank)?.solver(PETSC);
//!     Ok(())
//! }
//!
//! // an error on one rank ends all of them
//! Session::run("", work, |session, error| eprintln!("rank {}: {error}", session.rank().rank()))?;
//! # Ok::<(), nastic_petsc::PetscError>(())
//! ```

mod ffi;
mod numbering;
mod object;
mod ranks;
mod rows;
mod session;
mod solver;
mod system;

pub use ranks::MpiRank;
pub use session::{PetscError, Session};
pub use solver::PETSC;
