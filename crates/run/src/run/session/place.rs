//! The directory of a session: what this rank writes, and what belongs to all.

use crate::run::error::RunError;
use crate::run::session::Session;
use crate::run::session::output_directory::usual_directory;
use nastic_case::output_names::OutputNames;
use nastic_language::syntax::Document;
use nastic_result::files::Directory;
use nastic_result::listed::listed;
use nastic_result::target_files::named_targets;
use std::path::{Path, PathBuf};

impl Session<'_> {
    /// Claims a directory for the results, on the first rank; the others write there what is their own.
    pub fn enter(&mut self, directory: PathBuf) -> Result<(), RunError> {
        self.destination.out = if self.leads() { Some(self.claim(directory.clone())?) } else { None };
        self.take_own(&directory);
        Ok(())
    }

    /// Goes on in a directory that is locked.
    pub fn go_on_in(&mut self, out: Option<Directory>, path: &Path) -> Result<(), RunError> {
        self.destination.out = out;
        let names = self.output_names();
        if let Some(out) = &mut self.destination.out {
            out.take_names(names)?;
        }
        self.take_own(path);
        Ok(())
    }

    /// Gives up the directory, and its lock.
    pub fn leave(&mut self) {
        (self.destination.out, self.destination.own_out) = (None, None);
    }

    fn take_own(&mut self, path: &Path) {
        self.destination.own_out =
            Some(self.destination.out.clone().unwrap_or_else(|| Directory::of_another(path, self.output_names())));
    }

    /// The directory of the results, in which they replace nothing that the case reads, but for starts of controls that an earlier run there has written
    /// (`optimize` warns of these), and nothing that nastic did not write.
    fn claim(&self, directory: PathBuf) -> Result<Directory, RunError> {
        let problem = &self.input.problem;
        let results = listed(&directory);
        let starts: Vec<PathBuf> = start_files(&problem.document);
        let is_result = |file: &Path| {
            let name = file.file_name().and_then(|name| name.to_str());
            starts.iter().any(|start| start == file) && results.iter().any(|result| name == Some(result))
        };
        let read = problem.files.iter().map(PathBuf::as_path).filter(|file| !is_result(file));
        let inputs = read.chain(problem.case_file().map(Path::new));
        Ok(Directory::claim(directory, self.output_names(), inputs)?)
    }

    /// The names of what is written.
    fn output_names(&self) -> OutputNames {
        let targets = named_targets(&self.input.problem).into_iter().map(|(name, _)| name);
        OutputNames::of_command(&self.input.command, &self.input.problem, targets.collect())
    }

    /// Where results go unless `--out` says otherwise.
    pub fn usual_directory(&self) -> PathBuf {
        usual_directory(&self.input.problem)
    }
}

/// Files at which controls start.
fn start_files(document: &Document) -> Vec<PathBuf> {
    let case = document.json();
    let files =
        case["controls"].as_array().into_iter().flatten().filter_map(|control| control["start"]["file"].as_str());
    files.map(|file| document.resolve(file)).collect()
}
