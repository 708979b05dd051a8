//! The commands, as functions of a library: `check`, `solve`, `modes`, `gradient`, `gradcheck`, `optimize`, `identify`, `gains`, `resume`, `sweep`.
//!
//! ```no_run
//! use nastic_run::console::Console;
//! use nastic_run::run::{Options, run};
//! use nastic_language::schema::Command;
//!
//! let outcome = run(Command::Solve, "case.json".as_ref(), &Options::default(), &Console::silent())?;
//! println!("{}", outcome.result["probes"]["tip"]["displacement"]);
//! # Ok::<(), nastic_run::run::RunError>(())
//! ```

mod check;
mod check_gradient;
mod commands;
mod conclusion;
mod constraints;
mod contacts;
mod ensemble_progress;
pub(crate) mod error;
mod fit;
mod frames;
mod gains;
mod gradcheck;
mod gradient;
mod modes;
mod modes_request;
mod motion;
pub(crate) mod optimize;
mod options;
mod outcome;
mod progress;
mod report;
mod resumption;
mod session;
mod solve;
mod spectrum_request;
mod state_columns;
mod states;
mod study;
mod sweep;
mod terminal;
mod time_steps;
mod unmet;

pub use commands::{case_of, resume, run, run_document, run_with, thread_pool};
pub use error::{Exit, RunError};
pub use fit::{FitOutcome, fit, fit_with};
pub use frames::frames;
pub use gradcheck::{GradientTest, test_gradient};
pub use modes_request::ModesRequest;
pub use nastic_case::analysis::Analysis;
pub use nastic_case::lower::LoneTable;
pub use nastic_case::part::{Part, PartError, Share};
pub use nastic_report::{FigureRequest, OnTrial};
pub use options::Options;
pub use outcome::Outcome;
pub use report::{figure, keep_results, report};
pub use spectrum_request::{SpectrumRefusal, SpectrumRequest};
pub use states::{ShowError, States};
pub use study::control_set::ControlSet;
pub use study::{Optimum, Study, StudyError};
pub use sweep::{Sweep, SweepOutcome, sweep};
