//! The program `nastic` on the ranks of MPI: `mpirun -n 8 nastic-mpi optimize case.json`. The command line is that of `nastic`; a single process
//! needs no `mpirun`.

use nastic_language::catalogue::Catalogue;
use std::process::ExitCode;

fn main() -> ExitCode {
    nastic_mpi::run_on_ranks(|team| nastic_cli::run_on(&Catalogue::standard(), team))
}
