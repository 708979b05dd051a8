//! What a user may choose beside the case.

use crate::run::modes_request::ModesRequest;
use crate::run::spectrum_request::SpectrumRequest;
use nastic_case::analysis::Analysis;
use nastic_case::part::Share;
use nastic_report::OnTrial;
use nastic_team::Team;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// What a user may choose beside the case.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Directory of all results; that of the case if absent.
    pub out: Option<PathBuf>,
    /// Whether nothing is written unless `out` says where, by any command.
    pub in_memory: bool,
    /// Number of threads; all processors if absent. Results do not depend on it.
    pub threads: Option<usize>,
    /// Overrides `path=value`, in order.
    pub set: Vec<String>,
    /// Whether warnings make a command fail, with [`Exit::Warned`](crate::run::Exit::Warned).
    pub strict: bool,
    /// Whether the page of results, `report.html`, is left out.
    pub no_report: bool,
    /// Whether `figure.png` and `figure.svg`, the result for print, are written.
    pub figure: bool,
    /// Whether the case's `expect` is left aside: it holds for the case as it is written.
    pub without_expect: bool,
    /// Whether `solve` and `optimize` may replace the checkpoint of a run that was interrupted, or one that cannot be read.
    pub restart: bool,
    /// What of the runs of a sweep or of the starts of `optimize` is done; other commands do not look at it.
    pub share: Share,
    /// Whether the columns of the table of trials are explained above it.
    pub explain: bool,
    /// What `solve` computes.
    pub analysis: Analysis,
    /// What `modes` computes.
    pub modes: ModesRequest,
    /// Eigenpairs of the reduced Hessian at the optimum of `optimize`.
    pub spectrum: Option<SpectrumRequest>,
    /// The ranks that run the same command: [`Command::Optimize`](nastic_language::schema::Command::Optimize), a sweep or a resumed optimisation. Alone if absent.
    pub team: Option<Arc<dyn Team>>,
    /// Called for every trial of an optimisation.
    pub on_trial: OnTrial,
    /// Once raised, the command stops as soon as it can, keeping what it has.
    pub cancel: Arc<AtomicBool>,
}
