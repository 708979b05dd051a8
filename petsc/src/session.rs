//! [`Session`]: PETSc and MPI while they run, and the one thread that may call them.
#![allow(unsafe_code)] // calls of C

use crate::ffi;
use crate::ranks::MpiRank;
use std::ffi::{CString, c_int, c_void};
use std::marker::PhantomData;
use std::ptr::{null, null_mut};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};
use std::thread::ThreadId;

/// PETSc or MPI cannot do what is asked.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PetscError {
    /// A call came back with an error.
    #[error("{call} of PETSc ended with error {code}; its own message is above")]
    Call {
        /// Name of the function.
        call: &'static str,
        /// What it gave back.
        code: i32,
    },
    /// A second session, or one after the end of another: MPI begins once.
    #[error("PETSc has run in this process already; begin one session and keep it")]
    Again,
    /// A call from another thread than that of the session, or after its end.
    #[error("PETSc is called from the thread that began its session alone, while that runs")]
    Elsewhere,
    /// Numbers beyond 32 bits.
    #[error(
        "{what}: {count} are more than the 32-bit numbers of this PETSc can name; take more ranks, or a PETSc with 64-bit indices"
    )]
    TooMany {
        /// Of what.
        what: &'static str,
        /// How many.
        count: usize,
    },
    /// Options that contain a zero byte.
    #[error("options of PETSc contain a zero byte")]
    Options,
}

static THREAD: OnceLock<ThreadId> = OnceLock::new();
static RUNS: AtomicBool = AtomicBool::new(false);

/// PETSc from its beginning to its end, when this is dropped. One per process.
#[derive(Debug)]
pub struct Session {
    rank: Arc<MpiRank>,
    /// Stays in its thread.
    _thread: PhantomData<*const ()>,
}

impl Session {
    /// Begins MPI and PETSc with options as PETSc's command line has them, `-nastic_pc_type hypre`; those in `PETSC_OPTIONS` hold too.
    ///
    /// # Errors
    /// A second session; what PETSc says.
    pub fn begin(options: &str) -> Result<Self, PetscError> {
        THREAD.set(std::thread::current().id()).map_err(|_| PetscError::Again)?;
        let options = CString::new(options).map_err(|_| PetscError::Options)?;
        let (mut rank, mut size) = (0, 0);
        // SAFETY: MPI has not begun in this process (THREAD is set once); null arguments are allowed, and strings end with a zero.
        unsafe {
            check("PetscInitialize", ffi::PetscInitialize(null_mut(), null_mut(), null(), null()))?;
            RUNS.store(true, Ordering::SeqCst);
            check("PetscOptionsInsertString", ffi::PetscOptionsInsertString(null_mut(), options.as_ptr()))?;
            check("MPI_Comm_rank", ffi::MPI_Comm_rank(ffi::PETSC_COMM_WORLD, &raw mut rank))?;
            check("MPI_Comm_size", ffi::MPI_Comm_size(ffi::PETSC_COMM_WORLD, &raw mut size))?;
        }
        Ok(Session {
            rank: Arc::new(MpiRank::new(rank.unsigned_abs() as usize, size.unsigned_abs() as usize)),
            _thread: PhantomData,
        })
    }

    /// The rank of this process.
    pub fn rank(&self) -> &Arc<MpiRank> {
        &self.rank
    }

    /// Ends all ranks: the others wait for messages that will not come.
    pub fn abort(&self, code: u8) -> ! {
        // SAFETY: MPI runs as long as a session.
        unsafe { ffi::MPI_Abort(ffi::PETSC_COMM_WORLD, c_int::from(code)) };
        std::process::exit(i32::from(code))
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        if RUNS.swap(false, Ordering::SeqCst) {
            // SAFETY: begun, and not ended before.
            unsafe { ffi::PetscFinalize() };
        }
    }
}

/// Refuses calls that PETSc and MPI would not bear.
pub(crate) fn on_its_thread() -> Result<(), PetscError> {
    let here = THREAD.get() == Some(&std::thread::current().id()) && RUNS.load(Ordering::SeqCst);
    if here { Ok(()) } else { Err(PetscError::Elsewhere) }
}

pub(crate) fn check(call: &'static str, code: ffi::Code) -> Result<(), PetscError> {
    if code == 0 { Ok(()) } else { Err(PetscError::Call { call, code }) }
}

/// A count as PETSc has it.
pub(crate) fn count(what: &'static str, count: usize) -> Result<c_int, PetscError> {
    c_int::try_from(count).map_err(|_| PetscError::TooMany { what, count })
}

/// MPI's communicator of this rank alone.
pub(crate) fn alone() -> ffi::Comm {
    // An address, not a value.
    (&raw const ffi::ompi_mpi_comm_self).cast_mut().cast::<c_void>()
}
