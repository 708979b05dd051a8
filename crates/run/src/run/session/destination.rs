//! [`Destination`]: the directory of a command, what this rank writes there, and what belongs to all.

use crate::run::error::RunError;
use crate::run::session::input::CommandInput;
use nastic_case::output_names::OutputNames;
use nastic_language::syntax::Document;
use nastic_result::files::Directory;
use nastic_result::listed::listed;
use nastic_result::target_files::named_targets;
use std::path::{Path, PathBuf};

/// Where results go.
#[derive(Default)]
pub(crate) struct Destination {
    /// `None` for commands that leave nothing behind unless given a directory.
    pub out: Option<Directory>,
    /// The same where starts write their own files: on any rank.
    pub own_out: Option<Directory>,
    /// Whether results of an earlier program, which went further, stay.
    pub leaves_results: bool,
}

impl Destination {
    /// Claims a directory for the results, on the first rank; the others write there what is their own.
    pub fn enter(&mut self, input: &CommandInput, directory: PathBuf) -> Result<(), RunError> {
        self.out = if input.leads() { Some(claim(input, directory.clone())?) } else { None };
        self.take_own(input, &directory);
        Ok(())
    }

    /// Goes on in a directory that is locked.
    pub fn go_on_in(&mut self, input: &CommandInput, out: Option<Directory>, path: &Path) -> Result<(), RunError> {
        self.out = out;
        if let Some(out) = &mut self.out {
            out.take_names(output_names(input))?;
        }
        self.take_own(input, path);
        Ok(())
    }

    /// Gives up the directory, and its lock.
    pub fn leave(&mut self) {
        (self.out, self.own_out) = (None, None);
    }

    /// The directory, unless what an earlier program left there stays.
    pub fn results(&self) -> Option<&Directory> {
        self.out.as_ref().filter(|_| !self.leaves_results)
    }

    fn take_own(&mut self, input: &CommandInput, path: &Path) {
        self.own_out = Some(self.out.clone().unwrap_or_else(|| Directory::of_another(path, output_names(input))));
    }

    /// A run that cannot begin leaves its directory as it is.
    pub fn refuse(&mut self, error: RunError) -> RunError {
        self.out = None;
        error
    }
}

/// The directory of the results, in which they replace nothing that the case reads, but for starts of controls that an earlier run there has written
/// (`optimize` warns of these), and nothing that nastic did not write.
fn claim(input: &CommandInput, directory: PathBuf) -> Result<Directory, RunError> {
    let problem = &input.problem;
    let results = listed(&directory);
    let starts: Vec<PathBuf> = start_files(&problem.document);
    let is_result = |file: &Path| {
        let name = file.file_name().and_then(|name| name.to_str());
        starts.iter().any(|start| start == file) && results.iter().any(|result| name == Some(result))
    };
    let read = problem.files.iter().map(PathBuf::as_path).filter(|file| !is_result(file));
    let inputs = read.chain(problem.case_file().map(Path::new));
    Ok(Directory::claim(directory, output_names(input), inputs)?)
}

/// The names of what is written.
fn output_names(input: &CommandInput) -> OutputNames {
    let targets = named_targets(&input.problem).into_iter().map(|(name, _)| name);
    OutputNames::of_command(&input.command, &input.problem, targets.collect())
}

/// Files at which controls start.
fn start_files(document: &Document) -> Vec<PathBuf> {
    let case = document.json();
    let files =
        case["controls"].as_array().into_iter().flatten().filter_map(|control| control["start"]["file"].as_str());
    files.map(|file| document.resolve(file)).collect()
}
