//! The program `nastic` on the ranks of MPI: `mpirun -n 8 nastic-mpi optimize case.json`. The command line is that of `nastic`; a single process
//! needs no `mpirun`.
//!
//! MPI is called from the main thread alone; the program runs in another one, and leaves messages to it.

mod rank;
mod transport;

use mpi::Threading;
use mpi::traits::Communicator;
use nastic_cli::Ended;
use nastic_language::catalogue::Catalogue;
use rank::MpiRank;
use std::io::Write;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::mpsc::channel;
use std::time::Duration;

/// Of the thread of the program: that of a main thread.
const STACK: usize = 8 << 20;
/// How long another rank than the first waits with what only it may know: the first one may be about to say the same.
const GRACE: Duration = Duration::from_secs(2);

fn main() -> ExitCode {
    let Some((universe, Threading::Funneled | Threading::Serialized | Threading::Multiple)) =
        mpi::initialize_with_threading(Threading::Funneled)
    else {
        complain("this MPI library cannot be used beside threads (MPI_THREAD_FUNNELED)");
        return ExitCode::from(2);
    };
    let world = universe.world();
    let numbers = (usize::try_from(world.rank()), usize::try_from(world.size()));
    let (Ok(rank), Ok(size)) = numbers else { return ExitCode::from(2) };
    let (commands, waiting) = channel();
    let team = Arc::new(MpiRank::new((rank, size), commands));
    let program = move || nastic_cli::run_on(&Catalogue::standard(), team);
    let ended = match std::thread::Builder::new().stack_size(STACK).spawn(program) {
        Ok(thread) => {
            transport::serve(&world, &waiting);
            thread.join().unwrap_or_else(|_| Ended { code: 101, error: Some("the program has panicked".to_owned()) })
        }
        Err(error) => Ended { code: 2, error: Some(format!("threads: {error}")) },
    };
    match ended {
        // the others wait for messages that will not come
        Ended { code, error: Some(error) } if size > 1 => {
            if rank > 0 {
                std::thread::sleep(GRACE);
                complain(&format!("rank {rank}: {error}"));
            }
            world.abort(i32::from(code))
        }
        Ended { code, .. } => ExitCode::from(code),
    }
}

/// Not lost where standard error is a file or a pipe that has gone.
fn complain(message: &str) {
    let _ = writeln!(std::io::stderr().lock(), "nastic-mpi: {message}");
}
