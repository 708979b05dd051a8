//! Where a command puts its results.

use crate::run::options::Options;
use nastic_case::lower::CaseProblem;
use nastic_language::schema::Command;
use nastic_language::syntax::Document;
use nastic_report::case_name;
use std::path::{Component, Path, PathBuf};

/// `--out`, else what the case says, else `out/CASE` beside it. Commands that leave nothing behind write only where
/// they are asked to.
pub(crate) fn directory(command: &Command, problem: &CaseProblem, options: &Options) -> Option<PathBuf> {
    let named = options.out.clone();
    if options.in_memory || matches!(command, Command::Check | Command::Gradcheck) {
        return named;
    }
    Some(named.unwrap_or_else(|| usual_directory(problem)))
}

/// What the case says, else `out/CASE` beside it.
pub(crate) fn usual_directory(problem: &CaseProblem) -> PathBuf {
    directory_of(&problem.document, problem.case.output.directory.as_deref())
}

/// `own` of a case, else `out/CASE` beside it.
pub(crate) fn directory_of(document: &Document, own: Option<&str>) -> PathBuf {
    plain(&document.resolve(own.unwrap_or(&format!("out/{}", case_name(document.name())))))
}

/// The same place with fewer words: `a/../b` is `b`, unless `a` is a link.
pub(crate) fn plain(path: &Path) -> PathBuf {
    let mut out = PathBuf::new();
    for part in path.components() {
        let is_named = matches!(out.components().next_back(), Some(Component::Normal(_)));
        if part == Component::ParentDir && is_named && !out.is_symlink() {
            out.pop();
        } else {
            out.push(part);
        }
    }
    if out.as_os_str().is_empty() { PathBuf::from(".") } else { out }
}
