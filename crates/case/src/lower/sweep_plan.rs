//! [`SweepPlan`]: the runs of a sweep before any is made.

use crate::lower::{Combination, Swept, combinations};
use nastic_language::catalogue::Catalogue;
use nastic_language::schema::Command;
use nastic_language::syntax::{Diagnostic, Diagnostics, Document, Node, Value as Tree};
use serde_json::json;
use std::path::Path;

/// What a sweep will run.
pub struct SweepPlan {
    /// The case without its values.
    pub document: Document,
    /// A run for every combination of values.
    pub runs: Vec<Combination>,
    /// The options, those with one value too.
    pub swept: Vec<Swept>,
    /// Paths of all controls.
    controls: Vec<String>,
}

impl SweepPlan {
    /// Reads case and options, and checks what must hold of all runs.
    ///
    /// # Errors
    /// What cannot be read, a command that no sweep has, paths that the case lacks.
    pub fn read(
        catalogue: &Catalogue,
        command: &Command,
        warm: bool,
        case: &Path,
        set: &[String],
    ) -> Result<Self, Diagnostics> {
        let swept = Swept::read(set)?;
        let runs = combinations(&swept);
        let document = Document::open(case)?.with_catalogue(catalogue);
        let controls = controls(&document);
        let plan = Self { document, runs, swept, controls };
        plan.check(command, warm)?;
        Ok(plan)
    }

    /// A fitting command, paths that the case has.
    fn check(&self, command: &Command, warm: bool) -> Result<(), Diagnostics> {
        let complain = |file: &str, message: String| {
            Diagnostics::from(Diagnostic { file: file.to_owned(), path: String::new(), line: 0, column: 0, message })
        };
        if !matches!(command, Command::Optimize | Command::Solve) {
            let message = format!("a sweep runs \"optimize\" or \"solve\", not \"{}\"", command.name());
            return Err(complain("--command", message));
        }
        if warm && *command != Command::Optimize {
            return Err(complain("--warm", "only optimisations start from the optimum before".to_owned()));
        }
        if let Some(one) = self.swept.iter().find(|one| warm && is_start(&one.path)) {
            let message = format!("the starts are those of the run before: leave out --set {}", one.path);
            return Err(complain("--warm", message));
        }
        let mut problems: Vec<Diagnostic> = Vec::new();
        for run in &self.runs {
            let mut changed = self.document.clone();
            for setting in self.values(run) {
                let found = changed.set(&setting).err();
                let found = found.iter().flat_map(Diagnostics::list).filter(|one| !problems.contains(one)).cloned();
                problems.extend(found.collect::<Vec<_>>());
            }
        }
        Diagnostics::new(problems).into_result()
    }

    /// The options of one run: its values, and the controls of another run to start from.
    pub fn settings(&self, run: &Combination, warm_from: Option<&Path>) -> Vec<String> {
        let mut settings = self.values(run);
        if let Some(directory) = warm_from {
            let file = directory.join("controls.json");
            let file = std::path::absolute(&file).unwrap_or(file);
            let start = json!({ "file": file.display().to_string() });
            settings.extend(self.controls.iter().map(|path| format!("{path}/start={start}")));
        }
        settings
    }

    fn values(&self, run: &Combination) -> Vec<String> {
        self.swept.iter().zip(&run.at).map(|(one, &k)| one.setting(k)).collect()
    }

    /// The swept paths with the values of one run.
    pub fn swept_values(&self, run: &Combination) -> Vec<(String, String)> {
        let values = self.swept.iter().zip(&run.at).filter(|(one, _)| one.is_swept());
        values.map(|(one, &k)| (one.path.clone(), one.values[k].clone())).collect()
    }
}

/// Whether a path is, or holds, the start of a control.
fn is_start(path: &str) -> bool {
    path.split('/').any(|part| part == "controls") && (path.ends_with("/start") || path.ends_with("controls"))
}

/// Paths of all controls, those of load cases too.
fn controls(document: &Document) -> Vec<String> {
    let entries = |node: Option<&Node>| match node.map(|node| &node.value) {
        Some(Tree::Array(entries)) => entries.len(),
        _ => 0,
    };
    let mut out: Vec<String> = Vec::new();
    let cases = entries(document.root().find("load_cases"));
    for block in std::iter::once("controls".to_owned()).chain((0..cases).map(|k| format!("load_cases/{k}/controls"))) {
        out.extend((0..entries(document.root().find(&block))).map(|k| format!("{block}/{k}")));
    }
    out
}
