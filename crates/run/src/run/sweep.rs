//! `nastic sweep CASE --set path=a,b,c`: one run for every value, each in a directory of its own, and a table of them all.

mod plot;
mod row;

use crate::console::Console;
use crate::result::files::Directory;
use crate::result::output_names::SWEEP;
use crate::run::analysis::Analysis;
use crate::run::commands::run_with;
use crate::run::error::{Exit, RunError};
use crate::run::options::Options;
use crate::run::output_directory::directory_of;
use crate::run::sweep::row::Row;
use nastic_case::lower::{Combination, Swept, combinations};
use nastic_io::write_atomically;
use nastic_language::catalogue::Catalogue;
use nastic_language::number::{count, short};
use nastic_language::schema::Command;
use nastic_language::syntax::{Diagnostic, Diagnostics, Document, Node, Value as Tree};
use nastic_report::case_name;
use nastic_report::csv;
use nastic_report::record::{SweepRecord, SweptRecord};
use serde_json::{Value, json};
use std::path::Path;
use std::sync::atomic::Ordering;

/// What is run for every value.
#[derive(Clone, Debug)]
pub struct Sweep {
    /// [`Command::Optimize`] or [`Command::Solve`].
    pub command: Command,
    /// Whether an optimisation starts from the controls of the last one before it that has some. The first starts as the case says.
    pub warm: bool,
}

/// What a sweep found.
#[derive(Clone, PartialEq, Debug)]
pub struct SweepOutcome {
    /// How the worst run ended; at least [`Exit::NotConverged`] where not all were made.
    pub exit: Exit,
    /// The content of `sweep.json`.
    pub result: Value,
}

/// Runs a case once for every value of the overrides in `options.set`, which are read as `path=a,b,c`: commas outside of
/// brackets, braces, parentheses and quotes stand between values. Several such options mean all combinations of their values; an option with
/// one value is fixed. A run that fails is a row of the table. Results go to `options.out`, else to where the case says.
///
/// What the case expects of its results is left aside, and so are `analysis` and `in_memory` of the options.
///
/// # Errors
/// [`RunError::Input`]: a case that cannot be read, an option that does not fit it or is none of a sweep; [`RunError::Write`],
/// [`RunError::InUse`].
pub fn sweep(
    catalogue: &Catalogue,
    sweep: &Sweep,
    case: &Path,
    options: &Options,
    console: &Console,
) -> Result<SweepOutcome, RunError> {
    let swept = Swept::read(&options.set)?;
    let runs = combinations(&swept);
    let document = Document::open(case)?.with_catalogue(catalogue);
    check(&document, sweep, &swept, &runs)?;
    let case_json = document.json();
    let out = options.out.clone().unwrap_or_else(|| directory_of(&document, case_json["output"]["directory"].as_str()));
    let out = Directory::claim(out, SWEEP, [case])?;
    introduce(sweep, &swept, runs.len(), console);
    let starts = controls(&document);
    let title = title(&case_json, case);
    let mut table = Table { swept: &swept, sweep, case, title, planned: runs.len(), rows: Vec::new() };
    let mut warm_from: Option<String> = None;
    for (index, run) in runs.iter().enumerate() {
        let mut set = settings(&swept, run);
        if let Some(before) = &warm_from {
            let file = out.path().join(before).join("controls.json");
            let file = std::path::absolute(&file).unwrap_or(file);
            set.extend(
                starts.iter().map(|path| format!("{path}/start={}", json!({ "file": file.display().to_string() }))),
            );
        }
        let own = Options {
            out: Some(out.file(&run.directory)),
            set,
            analysis: Analysis::Equilibrium,
            in_memory: false,
            without_expect: true,
            ..options.clone()
        };
        console.pass(format!("run {} of {}: {}", index + 1, runs.len(), run.directory));
        let ran = run_with(catalogue, sweep.command.clone(), case, &own, &console.passing_alone());
        let values = swept.iter().zip(&run.at).filter(|(one, _)| one.is_swept());
        let values = values.map(|(one, &k)| (one.path.clone(), one.values[k].clone())).collect();
        let mut row = Row::of(&run.directory, values, ran, out.path());
        row.warm_from = warm_from.clone();
        if sweep.warm && row.figures.contains_key("stop") {
            warm_from = Some(run.directory.clone());
        }
        console.say(line(&row, index, runs.len()));
        table.rows.push(row);
        // After every run, so that what was found is kept however the sweep ends.
        table.write(&out)?;
        if options.cancel.load(Ordering::Relaxed) {
            break;
        }
    }
    let missing = runs.len() - table.rows.len();
    if missing > 0 {
        console.say(format!("stopped     {} not made", count(missing, "run")));
    }
    console.say(format!("results     {}: sweep.csv, sweep.json, sweep.svg, sweep.pvd", out.path().display()));
    let result = serde_json::to_value(table.record()).unwrap_or_default(); // records have keys that are texts
    Ok(SweepOutcome { exit: table.exit(), result })
}

/// What must hold of all runs: a fitting command, paths that the case has.
fn check(document: &Document, sweep: &Sweep, swept: &[Swept], runs: &[Combination]) -> Result<(), Diagnostics> {
    let complain = |file: &str, message: String| {
        Diagnostics::from(Diagnostic { file: file.to_owned(), path: String::new(), line: 0, column: 0, message })
    };
    if !matches!(sweep.command, Command::Optimize | Command::Solve) {
        let message = format!("a sweep runs \"optimize\" or \"solve\", not \"{}\"", sweep.command.name());
        return Err(complain("--command", message));
    }
    if sweep.warm && sweep.command != Command::Optimize {
        return Err(complain("--warm", "only optimisations start from the optimum before".to_owned()));
    }
    if let Some(one) = swept.iter().find(|one| sweep.warm && is_start(&one.path)) {
        return Err(complain(
            "--warm",
            format!("the starts are those of the run before: leave out --set {}", one.path),
        ));
    }
    let mut problems: Vec<Diagnostic> = Vec::new();
    for run in runs {
        let mut changed = document.clone();
        for setting in settings(swept, run) {
            let found = changed.set(&setting).err();
            let found = found.iter().flat_map(Diagnostics::list).filter(|one| !problems.contains(one)).cloned();
            problems.extend(found.collect::<Vec<_>>());
        }
    }
    Diagnostics::new(problems).into_result()
}

/// Whether a path is, or holds, the start of a control.
fn is_start(path: &str) -> bool {
    path.split('/').any(|part| part == "controls") && (path.ends_with("/start") || path.ends_with("controls"))
}

/// The options of one run.
fn settings(swept: &[Swept], run: &Combination) -> Vec<String> {
    swept.iter().zip(&run.at).map(|(one, &k)| one.setting(k)).collect()
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

fn title(case: &Value, file: &Path) -> String {
    let name = || case_name(&file.display().to_string());
    format!("{}: sweep", case["title"].as_str().map_or_else(name, str::to_owned))
}

fn introduce(sweep: &Sweep, swept: &[Swept], runs: usize, console: &Console) {
    let several = swept.iter().filter(|one| one.is_swept()).count() > 1;
    let how = if several { ", all combinations" } else { "" };
    console.say(format!("sweep       {} of {}{how}", count(runs, "run"), sweep.command.name()));
    for one in swept {
        let head = if one.is_swept() { "swept" } else { "fixed" };
        console.say(format!("{head:<12}{} = {}", one.path, one.values.join(", ")));
    }
    if sweep.warm {
        console
            .say("warm        every run after the first starts from the controls of the last one before that has some");
    }
}

/// What is said of one run.
fn line(row: &Row, index: usize, runs: usize) -> String {
    let number = |figure: &str, label: &str| row.number(figure).map(|value| format!("{label} {}", short(value)));
    let iterations = row.number("iterations").map(|n| count(n as usize, "iteration"));
    let parts = [number("cost/total", "cost"), number("hausdorff/true", "true Hausdorff"), iterations];
    let mut text = format!("{:<12}{}: ", format!("run {}/{runs}", index + 1), row.directory);
    text +=
        &parts.into_iter().flatten().chain([format!("exit code {}", row.exit.code())]).collect::<Vec<_>>().join(", ");
    if let Some(error) = &row.error {
        text += &format!(" ({error})");
    } else if !row.is_done() {
        text += &row.figures.get("stop").and_then(Value::as_str).map_or_else(String::new, |stop| format!(" ({stop})"));
    }
    if !row.warnings.is_empty() {
        text += &format!("; WARNING: {}", row.warnings.join(", "));
    }
    text
}

/// All runs so far.
struct Table<'s> {
    swept: &'s [Swept],
    sweep: &'s Sweep,
    case: &'s Path,
    title: String,
    planned: usize,
    rows: Vec<Row>,
}

impl Table<'_> {
    fn exit(&self) -> Exit {
        let worst = self.rows.iter().fold(Exit::Done, |worst, row| worst.worst(row.exit));
        if self.rows.len() < self.planned { worst.worst(Exit::NotConverged) } else { worst }
    }

    fn record(&self) -> SweepRecord {
        let (swept, fixed): (Vec<&Swept>, Vec<&Swept>) = self.swept.iter().partition(|one| one.is_swept());
        let of = |one: &Swept| SweptRecord { path: one.path.clone(), values: one.values.clone() };
        SweepRecord {
            command: self.sweep.command.name().to_owned(),
            case: self.case.display().to_string(),
            swept: swept.into_iter().map(of).collect(),
            fixed: fixed.into_iter().map(|one| one.setting(0)).collect(),
            warm: self.sweep.warm,
            planned: self.planned,
            runs: self.rows.iter().map(Row::record).collect(),
            exit: self.exit().code(),
        }
    }

    /// Writes `sweep.json`, `sweep.csv`, `sweep.svg` and a `sweep.pvd` for every load case.
    fn write(&self, out: &Directory) -> Result<(), RunError> {
        out.write_json("sweep.json", &self.record())?;
        let text = csv::table(&self.rows.iter().map(Row::cells).collect::<Vec<_>>());
        write_atomically(out.file("sweep.csv"), |out| out.write_all(text.as_bytes()))?;
        match plot::chart(&self.title, self.swept, &self.rows) {
            Some(chart) => chart.write(out.file("sweep.svg"))?,
            None => out.remove("sweep.svg")?,
        }
        let collections = self.collections();
        if collections.is_empty() {
            out.remove("sweep.pvd")?;
        }
        for (name, entries) in collections {
            nastic_io::write_pvd(out.file(&name), &entries)?;
        }
        Ok(())
    }

    /// Names of collections, and the states that the runs found.
    fn collections(&self) -> Vec<(String, Vec<(f64, String)>)> {
        let file = if self.sweep.command == Command::Optimize { "optimum.vtu" } else { "start.vtu" };
        let mut out: Vec<(String, Vec<(f64, String)>)> = vec![];
        let times = plot::times(self.swept, self.planned);
        for (row, time) in self.rows.iter().zip(times).filter(|(row, _)| row.figures.contains_key("min_J")) {
            for (stem, case) in &row.stems {
                let name = format!("{case}sweep.pvd");
                let entry = (time, format!("{}/{stem}{file}", row.directory));
                match out.iter_mut().find(|(known, _)| *known == name) {
                    Some((_, entries)) => entries.push(entry),
                    None => out.push((name, vec![entry])),
                }
            }
        }
        out
    }
}
