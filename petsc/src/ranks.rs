//! [`MpiRank`]: messages through MPI.
#![allow(unsafe_code)] // calls of C

use crate::ffi;
use crate::session::{on_its_thread, world};
use nastic_team::{Team, TeamError};
use std::ffi::{c_int, c_void};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// As good as for ever.
const FOR_EVER: Duration = Duration::from_secs(1 << 32);
/// What distinguishes these messages from PETSc's own.
const TAG: c_int = 7203;

/// A rank of MPI's world, whose messages go out from the thread of the [`Session`](crate::Session) alone. A send may wait for the other rank to receive, and messages are
/// waited for without limit unless [`wait_at_most`](Team::wait_at_most) sets one: calls of PETSc among them have none.
#[derive(Debug)]
pub struct MpiRank {
    rank: usize,
    size: usize,
    state: Mutex<State>,
}

#[derive(Debug)]
struct State {
    limit: Duration,
    failed: Option<TeamError>,
}

impl MpiRank {
    pub(crate) fn new(rank: usize, size: usize) -> Self {
        MpiRank { rank, size, state: Mutex::new(State { limit: FOR_EVER, failed: None }) }
    }

    /// What the first failure was, to all that comes after it.
    fn once<T>(&self, call: impl FnOnce(Duration) -> Result<T, TeamError>) -> Result<T, TeamError> {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(failed) = &state.failed {
            return Err(failed.clone());
        }
        let thread = on_its_thread().map_err(|error| TeamError::Transport { what: error.to_string() });
        thread.and_then(|()| call(state.limit)).inspect_err(|error| state.failed = Some(error.clone()))
    }
}

fn number(what: &str, number: usize) -> Result<c_int, TeamError> {
    c_int::try_from(number).map_err(|_| TeamError::Transport {
        what: format!("{number} {what}: MPI counts with 32 bits; take more ranks"),
    })
}

fn sent(call: &str, code: c_int) -> Result<(), TeamError> {
    if code == 0 { Ok(()) } else { Err(TeamError::Transport { what: format!("{call} ended with error {code}") }) }
}

fn bytes() -> *const c_void {
    // An address, not a value.
    &raw const ffi::ompi_mpi_byte
}

/// The length of the next message of a rank, within a time.
fn probe(from: c_int, limit: Duration) -> Result<c_int, TeamError> {
    const EAGER: Duration = Duration::from_micros(200);
    let (began, mut flag, mut length) = (Instant::now(), 0, 0);
    let mut status = ffi::Status { source: 0, tag: 0, error: 0, cancelled: 0, bytes: 0 };
    loop {
        // SAFETY: MPI runs, in this thread; the pointers are to values of ours.
        unsafe {
            sent("MPI_Iprobe", ffi::MPI_Iprobe(from, TAG, world(), &raw mut flag, &raw mut status))?;
            if flag != 0 {
                sent("MPI_Get_count", ffi::MPI_Get_count(&raw const status, bytes(), &raw mut length))?;
                return Ok(length);
            }
        }
        match began.elapsed() {
            waited if waited > limit => {
                return Err(TeamError::Silent { rank: from.unsigned_abs() as usize, seconds: waited.as_secs() });
            }
            waited if waited < EAGER => std::thread::yield_now(),
            waited => std::thread::sleep((waited / 10).min(Duration::from_millis(1))),
        }
    }
}

impl Team for MpiRank {
    fn rank(&self) -> usize {
        self.rank
    }

    fn size(&self) -> usize {
        self.size
    }

    fn send(&self, to: usize, message: Vec<u8>) -> Result<(), TeamError> {
        self.once(|_| {
            let (to, length) = (number("ranks", to)?, number("bytes", message.len())?);
            let data = message.as_ptr().cast::<c_void>();
            // SAFETY: MPI runs, in this thread; the message has so many bytes, and outlives the call.
            sent("MPI_Send", unsafe { ffi::MPI_Send(data, length, bytes(), to, TAG, world()) })
        })
    }

    fn receive(&self, from: usize) -> Result<Vec<u8>, TeamError> {
        self.once(|limit| {
            let (rank, from) = (from, number("ranks", from)?);
            let length = probe(from, limit)?;
            let wrong = |_| TeamError::Unexpected { rank, what: "a length that MPI cannot tell" };
            let mut message = vec![0u8; usize::try_from(length).map_err(wrong)?];
            let data = message.as_mut_ptr().cast::<c_void>();
            let mut status = ffi::Status { source: 0, tag: 0, error: 0, cancelled: 0, bytes: 0 };
            // SAFETY: MPI runs, in this thread; the message has room for so many bytes.
            let code = unsafe { ffi::MPI_Recv(data, length, bytes(), from, TAG, world(), &raw mut status) };
            sent("MPI_Recv", code).map(|()| message)
        })
    }

    fn wait_at_most(&self, limit: Duration) {
        self.state.lock().unwrap_or_else(PoisonError::into_inner).limit = limit;
    }
}
