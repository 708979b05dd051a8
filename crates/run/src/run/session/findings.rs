//! [`CommandFindings`]: what a command has found so far.

use crate::run::session::clock::Clock;
use crate::run::states::Shown;
use nastic_case::warning::Warning;
use nastic_control::AdaptiveSteps;
use nastic_report::record::RunRecord;

/// What a command has found so far.
pub(crate) struct CommandFindings {
    /// The result as it stands.
    pub record: RunRecord,
    /// What deserves attention, as far as it is known.
    pub warnings: Vec<Warning>,
    /// The states that were found.
    pub shown: Option<Shown>,
    /// Of a case with a tolerance of time steps those of every member, once they were found.
    pub steps: Vec<AdaptiveSteps>,
    pub clock: Clock,
    /// Whether an optimisation came to its end; its checkpoint says so once the results are written.
    pub ended: bool,
    /// Whether something ended the command that has nothing to do with the case: a stop that was requested, a lack of memory.
    pub interrupted: bool,
}

impl CommandFindings {
    /// Nothing yet.
    pub fn new(clock: Clock) -> Self {
        Self {
            record: RunRecord::default(),
            warnings: Vec::new(),
            shown: None,
            steps: Vec::new(),
            clock,
            ended: false,
            interrupted: false,
        }
    }
}
