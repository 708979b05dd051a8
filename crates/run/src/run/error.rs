//! How commands end.

use crate::run::spectrum_request::SpectrumRefusal;
use crate::saved::CheckpointError;
use nastic_control::ControlError;
use nastic_io::{LockError, WriteError};
use nastic_language::syntax::Diagnostics;
use nastic_result::ResultError;
use nastic_result::files::DirectoryError;
use nastic_team::TeamError;
use std::path::PathBuf;
use thiserror::Error;

/// How a command ended; the codes are those of the program.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Exit {
    /// Done.
    Done,
    /// Bad input.
    BadInput,
    /// The forward solve failed.
    ForwardFailed,
    /// Stopped before converging.
    NotConverged,
    /// The gradient check failed.
    GradientWrong,
    /// An expectation of the case was missed.
    ExpectMissed,
    /// A file could not be written.
    NotWritten,
    /// There were warnings, and none were wanted.
    Warned,
    /// The ranks of a team could not go on together.
    Parted,
}

impl Exit {
    /// The exit code.
    #[must_use]
    pub fn code(self) -> u8 {
        match self {
            Self::Done => 0,
            Self::BadInput => 2,
            Self::ForwardFailed => 3,
            Self::NotConverged => 4,
            Self::GradientWrong => 5,
            Self::ExpectMissed => 6,
            Self::NotWritten => 7,
            Self::Warned => 8,
            Self::Parted => 9,
        }
    }

    /// That of a code.
    pub(crate) fn of_code(code: u8) -> Option<Self> {
        const ALL: [Exit; 9] = [
            Exit::Done,
            Exit::BadInput,
            Exit::ForwardFailed,
            Exit::NotConverged,
            Exit::GradientWrong,
            Exit::ExpectMissed,
            Exit::NotWritten,
            Exit::Warned,
            Exit::Parted,
        ];
        ALL.into_iter().find(|exit| exit.code() == code)
    }

    /// What it is where warnings make a command fail, or do not.
    pub(crate) fn under(self, strict: bool, warnings: usize) -> Self {
        match self {
            Self::Done | Self::Warned if strict && warnings > 0 => Self::Warned,
            Self::Warned => Self::Done,
            other => other,
        }
    }

    /// The worse one of two, as a sweep ends: done, warned, an expectation missed, not converged, a wrong gradient, no equilibrium, bad
    /// input, not written, ranks parted.
    #[must_use]
    pub fn worst(self, other: Self) -> Self {
        let rank = |exit: Self| match exit {
            Self::Done => 0,
            Self::Warned => 1,
            Self::ExpectMissed => 2,
            Self::NotConverged => 3,
            Self::GradientWrong => 4,
            Self::ForwardFailed => 5,
            Self::BadInput => 6,
            Self::NotWritten => 7,
            Self::Parted => 8,
        };
        if rank(other) > rank(self) { other } else { self }
    }
}

/// Why a command has no result.
#[derive(Debug, Error)]
pub enum RunError {
    /// The case is wrong: all problems found.
    #[error(transparent)]
    Input(#[from] Diagnostics),
    /// A number of threads that cannot be had.
    #[error("threads: {0}")]
    Threads(String),
    /// The limit of memory in the environment is no size.
    #[error(transparent)]
    MemoryLimit(#[from] nastic_fem::MemoryLimitError),
    /// There is no equilibrium, or no cost, where the command needs one.
    #[error("{}{error}{}", prefix(.of), kept(.file))]
    Forward {
        /// Scenario and load case; empty where there is but one state.
        member: String,
        /// The same in words, with the rank that has it: `member 4 (scenario s4) on rank 2`.
        of: String,
        /// What failed.
        error: Box<ControlError>,
        /// Where the last good state was written.
        file: Option<PathBuf>,
    },
    /// The same of a motion, or its end by a signal; what it found is kept.
    #[error("{source}; {kept}")]
    Motion {
        /// What ended it.
        source: Box<RunError>,
        /// How far it came, and where that is.
        kept: String,
    },
    /// The optimiser could not begin.
    #[error("the optimisation cannot begin: {0}")]
    Start(#[from] nastic_opt::RunError),
    /// The gradient check could not be made.
    #[error("{0}")]
    Taylor(#[from] nastic_opt::TaylorError),
    /// No law could be fitted to test data.
    #[error(transparent)]
    Fit(#[from] nastic_fit::FitError),
    /// A file could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// A file could not be written by another rank.
    #[error("{message} (on rank {rank})")]
    NotWrittenByRank {
        /// The rank.
        rank: usize,
        /// What it says.
        message: String,
    },
    /// Another program writes to the output directory.
    #[error(
        "{} is in use by another program{}: wait until it has ended, or choose another directory with --out",
        directory.display(),
        number(.process)
    )]
    InUse {
        /// The directory.
        directory: PathBuf,
        /// The other program, where its number is known.
        process: Option<u32>,
    },
    /// What the command writes would replace what it reads.
    #[error(
        "results would replace {}, which is read: choose another directory with --out, or give that file another name",
        file.display()
    )]
    ReplacesInput {
        /// The file that is read.
        file: PathBuf,
    },
    /// What the command writes would replace files that nastic did not write.
    #[error(
        "results would replace {}, which nastic did not write: move {} or give {} another name, or write elsewhere with --out",
        list(.files), them(.files), them(.files)
    )]
    ReplacesOthers {
        /// The files.
        files: Vec<PathBuf>,
    },
    /// An optimisation would replace the checkpoint of one that was interrupted.
    #[error(
        "{} holds the checkpoint of an interrupted optimisation (iteration {iteration}): go on with it by nastic resume {}, begin anew \
         with --restart, or choose another directory with --out",
        directory.display(), directory.display()
    )]
    Interrupted {
        /// The directory.
        directory: PathBuf,
        /// Iteration of the checkpoint.
        iteration: usize,
    },
    /// A command would replace the checkpoint of a motion that was interrupted.
    #[error(
        "{} holds the checkpoint of an interrupted motion: go on with it by nastic resume {}, begin anew with --restart, or choose another \
         directory with --out",
        directory.display(), directory.display()
    )]
    InterruptedMotion {
        /// The directory.
        directory: PathBuf,
    },
    /// An optimisation would replace a checkpoint that cannot be read.
    #[error("{0}; begin anew with --restart, which replaces it, or choose another directory with --out")]
    UnreadableCheckpoint(#[source] CheckpointError),
    /// The start as written, without which there is no result, has not ended.
    #[error(
        "{} has no finished run of the start as written, of this case and these options: nastic optimize .. --part 1/N makes it",
        directory.display()
    )]
    NothingToJoin {
        /// The output directory.
        directory: PathBuf,
    },
    /// There is no checkpoint to go on from.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// The spectrum that was asked for cannot be had.
    #[error("no spectrum of the reduced Hessian: {0}")]
    Spectrum(#[from] SpectrumRefusal),
    /// A result folder gives no page.
    #[error(transparent)]
    Report(#[from] nastic_report::ReportError),
    /// An array that does not fit its mesh.
    #[error(transparent)]
    Snapshot(#[from] ControlError),
    /// The ranks of the team cannot go on together.
    #[error(transparent)]
    Team(#[from] TeamError),
    /// Several ranks were started for what one does.
    #[error(
        "{what} runs on one rank, not on {ranks}: optimize (its members, or its starts where there are several), resume and sweep are \
         shared out over ranks"
    )]
    OneRank {
        /// What was to run.
        what: String,
        /// How many ranks there are.
        ranks: usize,
    },
    /// A stop was requested before there was a result.
    #[error("stopped before there was a result")]
    Cancelled,
}

fn prefix(of: &str) -> String {
    if of.is_empty() { String::new() } else { format!("{of}: ") }
}

/// The first of them, and how many more.
fn list(files: &[PathBuf]) -> String {
    let first = files.first().map_or_else(String::new, |file| file.display().to_string());
    if files.len() > 1 { format!("{first} and {} more", files.len() - 1) } else { first }
}

fn them(files: &[PathBuf]) -> &'static str {
    if files.len() > 1 { "them" } else { "it" }
}

fn number(process: &Option<u32>) -> String {
    process.map_or_else(String::new, |process| format!(" (process {process})"))
}

fn kept(file: &Option<PathBuf>) -> String {
    match file {
        Some(file) => format!("; the last good state was written to {}", file.display()),
        None => String::new(),
    }
}

impl RunError {
    /// The exit code that belongs to it.
    #[must_use]
    pub fn exit(&self) -> Exit {
        match self {
            Self::Input(_) | Self::Threads(_) | Self::MemoryLimit(_) | Self::Report(_) => Exit::BadInput,
            Self::Checkpoint(_)
            | Self::UnreadableCheckpoint(_)
            | Self::Interrupted { .. }
            | Self::InterruptedMotion { .. } => Exit::BadInput,
            Self::Spectrum(_) | Self::Fit(_) => Exit::BadInput,
            Self::Start(nastic_opt::RunError::Start(_)) => Exit::ForwardFailed,
            Self::Start(_) | Self::ReplacesInput { .. } | Self::ReplacesOthers { .. } | Self::OneRank { .. } => {
                Exit::BadInput
            }
            Self::Team(_) => Exit::Parted,
            Self::Taylor(nastic_opt::TaylorError::Base(_)) | Self::Forward { .. } => Exit::ForwardFailed,
            Self::Taylor(_) => Exit::BadInput,
            Self::Write(_) | Self::NotWrittenByRank { .. } | Self::InUse { .. } | Self::Snapshot(_) => Exit::NotWritten,
            Self::Cancelled | Self::NothingToJoin { .. } => Exit::NotConverged,
            Self::Motion { source, .. } => source.exit(),
        }
    }

    /// Whether the machine had too little memory: on another one, or later, the command may succeed.
    pub(crate) fn is_lack_of_memory(&self) -> bool {
        match self.cause() {
            Self::Forward { error, .. } => error.is_lack_of_memory(),
            Self::Start(nastic_opt::RunError::Start(failed)) | Self::Taylor(nastic_opt::TaylorError::Base(failed)) => {
                failed.is_fatal()
            }
            _ => false,
        }
    }

    /// What ended a motion; every other error itself.
    #[must_use]
    pub fn cause(&self) -> &Self {
        match self {
            Self::Motion { source, .. } => source.cause(),
            other => other,
        }
    }
}

impl From<DirectoryError> for RunError {
    fn from(error: DirectoryError) -> Self {
        match error {
            DirectoryError::Write(error) | DirectoryError::Lock(LockError::Write(error)) => Self::Write(error),
            DirectoryError::Lock(LockError::InUse { directory, process }) => Self::InUse { directory, process },
            DirectoryError::Input { file } => Self::ReplacesInput { file },
            DirectoryError::Others { files } => Self::ReplacesOthers { files },
        }
    }
}

impl From<ResultError> for RunError {
    fn from(error: ResultError) -> Self {
        match error {
            ResultError::Write(error) => Self::Write(error),
            ResultError::Snapshot(error) => Self::Snapshot(error),
        }
    }
}
