//! [`CommandInput`]: what was asked of a command.

use crate::run::options::Options;
use nastic_case::lower::CaseProblem;
use nastic_language::schema::Command;
use nastic_team::Team;
use std::sync::{Arc, atomic::AtomicBool};

/// What was asked, and what stands fixed while the command runs.
///
/// Who is given `&mut` finds the time steps of a case with a tolerance ([`crate::run::time_steps`]): they are motions, a part of the
/// command's work, and the problem with these steps takes the place of the one without. Nothing else changes it behind opening.
pub(crate) struct CommandInput {
    pub command: Command,
    pub problem: CaseProblem,
    /// What the user chose beside the case; `set` is what the case was changed by.
    pub options: Options,
    /// The ranks that run the same command; `None` where there is one.
    pub team: Option<Arc<dyn Team>>,
    pub cancel: Arc<AtomicBool>,
    /// The flag of this rank, which its solves look at: on a team that shares members out `cancel` is raised on all ranks behind the same evaluation.
    pub signal: Arc<AtomicBool>,
}
