//! Programs on the ranks of MPI: [`run_on_ranks`]. MPI is called from the main thread alone; the program runs in another one, and leaves messages to it.

mod rank;
mod transport;

use mpi::Threading;
use mpi::traits::Communicator;
use nastic_cli::Ended;
use nastic_team::Team;
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

/// Runs a program on every rank that `mpirun` has started, or on one without it. One that has failed, or panicked, ends all.
///
/// What the first rank ends with ([`Ended::error`]) the program has to have said itself, as `nastic` does: it is not printed here. That of another rank is,
/// `rank 3: ..`, unless the first one ends all with the same within two seconds.
pub fn run_on_ranks(program: impl FnOnce(Arc<dyn Team>) -> Ended + Send + 'static) -> ExitCode {
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
    let team: Arc<dyn Team> = Arc::new(MpiRank::new((rank, size), commands));
    let ended = match std::thread::Builder::new().stack_size(STACK).spawn(move || program(team)) {
        Ok(thread) => {
            transport::serve(&world, &waiting);
            thread.join().unwrap_or_else(|_| Ended { code: 101, error: Some("the program has panicked".to_owned()) })
        }
        Err(error) => {
            let error = format!("threads: {error}");
            if rank == 0 {
                complain(&error);
            }
            Ended { code: 2, error: Some(error) }
        }
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
