//! `nastic resume`: an optimisation, or the motion of a `solve`, that was interrupted goes on from its last checkpoint.

use crate::console::Console;
use crate::run::error::RunError;
use crate::run::options::Options;
use crate::run::session::Opened;
use crate::saved;
use crate::saved::CheckpointError;
use crate::saved::case_record::CaseRecord;
use crate::saved::checkpoint::{Checkpoint, Position, interrupted};
use crate::saved::motion_checkpoint;
use crate::saved::motion_checkpoint::MotionCheckpoint;
use nastic_case::lower::CaseProblem;
use nastic_language::catalogue::Catalogue;
use nastic_language::schema::Command;
use nastic_language::syntax::Document;
use nastic_result::files::Directory;
use nastic_team::{Shares, Team};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Where a run goes on.
pub(super) enum Resumed {
    /// An optimisation; `None` before its start was evaluated.
    Optimization(Box<Option<Position>>),
    /// A motion.
    Motion(MotionCheckpoint),
}

/// Reads the checkpoint of an output directory and the case it belongs to. A motion that was stopped comes before an optimisation: it was begun
/// later, or the optimisation would have removed its checkpoint.
pub(super) fn open<'c>(
    catalogue: &Catalogue,
    directory: &Path,
    options: &Options,
    console: &'c Console,
) -> Result<(Opened<'c>, Resumed), RunError> {
    let leads = options.team.as_ref().is_none_or(|team| team.leads());
    let (out, case, command, place) = if directory.join(motion_checkpoint::NAME).is_file() {
        let out = leads.then(|| Directory::lock(directory.to_owned())).transpose()?;
        let checkpoint = MotionCheckpoint::read(directory)?;
        check_program(&checkpoint.case, directory.join(motion_checkpoint::NAME))?;
        (out, checkpoint.case.clone(), Command::Solve, Resumed::Motion(checkpoint))
    } else {
        let (out, Checkpoint { case, command, position, .. }) = read(directory, options.team.as_deref())?;
        let is_identification = command == Command::Identify.name();
        let command = if is_identification { Command::Identify } else { Command::Optimize };
        (out, case, command, Resumed::Optimization(Box::new(position)))
    };
    let document = case.reopen(catalogue, directory)?;
    let began = Instant::now();
    console.phase("reading");
    let problem = CaseProblem::lower(document, options.cancel.clone())?;
    let own = Options { set: case.settings, ..options.clone() };
    let mut opened = Opened::on(command, problem, own, console, began);
    opened.destination.go_on_in(&opened.input, out, directory)?;
    opened.input.join_team()?;
    Ok((opened, place))
}

/// Whether a directory holds the checkpoint of this command on this case, interrupted after its start was evaluated. One that cannot be read is
/// none of it: the command itself says so.
pub(super) fn is_interrupted(directory: &Path, command: &Command, document: &Document) -> bool {
    let case = match (command, directory.join(motion_checkpoint::NAME).is_file()) {
        (Command::Solve, true) => MotionCheckpoint::read(directory).ok().map(|checkpoint| checkpoint.case),
        (Command::Optimize, false) => interrupted(directory).ok().flatten().map(|(case, _)| case),
        _ => None,
    };
    case.is_some_and(|case| case.is_of(document))
}

/// Claims an output directory, on the first rank of a team alone, and reads its checkpoint, each rank its own members.
pub(super) fn read(directory: &Path, team: Option<&dyn Team>) -> Result<(Option<Directory>, Checkpoint), RunError> {
    let leads = team.is_none_or(Team::leads);
    let file = directory.join(saved::NAME);
    if !file.is_file() {
        // A name that was mistyped is not made a directory.
        return Err(CheckpointError::Missing { directory: directory.to_owned() }.into());
    }
    let out = leads.then(|| Directory::lock(directory.to_owned())).transpose()?;
    let own = |members: usize| team.map_or(0..members, |team| Shares::even(members, team.size()).of(team.rank()));
    let checkpoint = Checkpoint::read(directory, &own)?;
    check_program(&checkpoint.case, file)?;
    Ok((out, checkpoint))
}

/// Another version may give other bits.
fn check_program(case: &CaseRecord, file: PathBuf) -> Result<(), CheckpointError> {
    if case.program == env!("CARGO_PKG_VERSION") {
        return Ok(());
    }
    Err(CheckpointError::Program { file, found: case.program.clone() })
}
