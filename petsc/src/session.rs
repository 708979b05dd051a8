//! [`Session`]: PETSc and MPI while they run, and the one thread that may call them.
#![allow(unsafe_code)] // calls of C

use crate::ffi;
use crate::ranks::MpiRank;
use nastic_team::TeamError;
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
    #[error("{what}: {count} are more than the 32-bit numbers of this PETSc can name; take more ranks")]
    TooMany {
        /// Of what.
        what: &'static str,
        /// How many.
        count: usize,
    },
    /// Options choose what does not solve by signs of curvature.
    #[error("options of PETSc choose another {option} than is solved by; it can only be {only}")]
    Method {
        /// Which option.
        option: &'static str,
        /// What it can be.
        only: &'static str,
    },
    /// A PETSc of another release or with other numbers than was built for.
    #[error(
        "this is PETSc {found}; nastic-petsc is for PETSc 3.18 with real numbers of 8 bytes and indices of 4: name another by PETSC_LIB when it is built"
    )]
    Library {
        /// Its release, its numbers.
        found: String,
    },
    /// Messages between ranks that have failed.
    #[error(transparent)]
    Team(#[from] TeamError),
    /// Options that contain a zero byte.
    #[error("options of PETSc contain a zero byte")]
    Options,
}

static THREAD: OnceLock<ThreadId> = OnceLock::new();
static RUNS: AtomicBool = AtomicBool::new(false);

/// PETSc from its beginning to its end, when this is dropped. One per process.
///
/// The end waits for all ranks. One that fails alone has to end the others too, which wait for its messages: [`run`](Self::run) does, [`abort`](Self::abort), and a
/// panic, but no `?` past a session.
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
    /// A second session; another PETSc than was built for; what PETSc says.
    pub fn begin(options: &str) -> Result<Self, PetscError> {
        let options = CString::new(options).map_err(|_| PetscError::Options)?;
        THREAD.set(std::thread::current().id()).map_err(|_| PetscError::Again)?;
        let (mut rank, mut size) = (0, 0);
        // SAFETY: MPI has not begun in this process (THREAD is set once); null arguments are allowed, and strings end with a zero.
        unsafe {
            check("PetscInitialize", ffi::PetscInitialize(null_mut(), null_mut(), null(), null()))?;
            RUNS.store(true, Ordering::SeqCst);
            ffi::MPI_Comm_rank(world(), &raw mut rank);
            ffi::MPI_Comm_size(world(), &raw mut size);
        }
        // from here on what fails ends PETSc
        let rank = MpiRank::new(rank.unsigned_abs() as usize, size.unsigned_abs() as usize);
        let session = Session { rank: Arc::new(rank), _thread: PhantomData };
        check_library()?;
        // SAFETY: PETSc runs; the string ends with a zero.
        let inserted = unsafe { ffi::PetscOptionsInsertString(null_mut(), options.as_ptr()) };
        check("PetscOptionsInsertString", inserted).map(|()| session)
    }

    /// Begins, works and ends. Where the work fails on a rank, that rank says so by `failed` and ends the job with exit code 1: the others would wait for it.
    ///
    /// # Errors
    /// As [`begin`](Self::begin); those of the work do not come back.
    pub fn run<T, E>(
        options: &str,
        work: impl FnOnce(&Session) -> Result<T, E>,
        failed: impl FnOnce(&Session, E),
    ) -> Result<T, PetscError> {
        let session = Session::begin(options)?;
        work(&session).or_else(|error| {
            failed(&session, error);
            session.abort(1)
        })
    }

    /// The rank of this process.
    pub fn rank(&self) -> &Arc<MpiRank> {
        &self.rank
    }

    /// Ends all ranks: the others wait for messages that will not come.
    pub fn abort(&self, code: u8) -> ! {
        // SAFETY: MPI runs as long as a session.
        unsafe { ffi::MPI_Abort(world(), c_int::from(code)) };
        std::process::exit(i32::from(code))
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.abort(1);
        }
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

/// Refuses a PETSc whose functions and numbers are not those declared.
fn check_library() -> Result<(), PetscError> {
    // room for indices of 8 bytes, of which the first 4 are the number all the same where bytes ascend
    let mut release = [[0 as c_int; 2]; 4];
    let [major, minor, subminor, is_release] = release.each_mut().map(|number| number.as_mut_ptr());
    let (mut index, mut scalar, mut known) = (0, 0, 0);
    // SAFETY: PETSc runs; the pointers are to values of ours.
    unsafe {
        check("PetscGetVersionNumber", ffi::PetscGetVersionNumber(major, minor, subminor, is_release))?;
        check("PetscDataTypeGetSize", ffi::PetscDataTypeGetSize(ffi::INT, &raw mut index))?;
        let code = ffi::PetscDataTypeFromString(c"scalar".as_ptr(), &raw mut scalar, &raw mut known);
        check("PetscDataTypeFromString", code)?;
    }
    let (major, minor) = (release[0][0], release[1][0]);
    if (major, minor) == ffi::RELEASE && index == size_of::<c_int>() && known != 0 && scalar == ffi::DOUBLE {
        return Ok(());
    }
    let numbers =
        if scalar == ffi::DOUBLE { "real numbers of 8 bytes" } else { "other numbers than real ones of 8 bytes" };
    Err(PetscError::Library { found: format!("{major}.{minor} with {numbers} and indices of {index} bytes") })
}

/// MPI's communicator of all ranks.
pub(crate) fn world() -> ffi::Comm {
    // SAFETY: what PetscInitialize has written, and nothing writes any more; null before.
    unsafe { (&raw const ffi::PETSC_COMM_WORLD).read() }
}

/// MPI's communicator of this rank alone.
pub(crate) fn alone() -> ffi::Comm {
    // An address, not a value.
    (&raw mut ffi::ompi_mpi_comm_self).cast::<c_void>()
}
