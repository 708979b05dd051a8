//! `result.json`, and the page that shows it with the other files of a run: `nastic report DIR`, and the end of every run.

use crate::run::error::RunError;
use crate::run::session::{CommandFindings, CommandInput, Destination};
use nastic_case::lower::{CaseProblem, obstacle_shape};
use nastic_ensemble::EnsemblePoint;
use nastic_io::{WrittenFiles, write_atomically};
use nastic_language::schema::Command;
use nastic_report::FigureRequest;
use nastic_report::record::{MemberRecord, StateRecord};
use nastic_result::files::Directory;
use nastic_result::inspection::Inspection;
use nastic_result::listed::listed;
use nastic_result::member_report::{self, Detail};
use nastic_result::target_files::target_names;
use std::path::{Path, PathBuf};

/// The result for print.
const FIGURES: [&str; 2] = ["figure.png", "figure.svg"];
/// The case with its overrides.
const CASE: &str = "case.json";

/// Writes the page of a result folder, to `report.html` in it unless another file is named, which is replaced; where it went.
///
/// # Errors
/// [`RunError::Report`]: the directory holds no results, or damaged ones; [`RunError::Write`]; [`RunError::ReplacesOthers`],
/// [`RunError::ReplacesInput`].
pub fn report(directory: &Path, file: Option<&Path>) -> Result<PathBuf, RunError> {
    let page = nastic_report::html(directory)?;
    let file = place(directory, file, nastic_report::FILE)?;
    write_atomically(&file, |out| out.write_all(page.as_bytes()))?;
    Ok(file)
}

/// Draws a state of a result folder, to `figure.png` in it unless another file is named, which is replaced, PNG or SVG by its ending; where it
/// went.
///
/// # Errors
/// [`RunError::Report`]: the directory holds no results, or has not what is asked for; as [`report`].
pub fn figure(directory: &Path, request: &FigureRequest, file: Option<&Path>) -> Result<PathBuf, RunError> {
    let picture = nastic_report::figure(directory, request)?;
    let file = place(directory, file, FIGURES[0])?;
    picture.write(&file)?;
    Ok(file)
}

/// Where a file goes that is made of a result folder: the one that is named, or one of this name there, if nastic may write it.
pub(super) fn place(directory: &Path, named: Option<&Path>, name: &str) -> Result<PathBuf, RunError> {
    if let Some(named) = named {
        keep_results(directory, named)?;
        return Ok(named.to_owned());
    }
    let (file, written) = (directory.join(name), WrittenFiles::of(directory)?);
    let is_own = written.has(name) || listed(directory).iter().any(|one| one == name);
    if file.symlink_metadata().is_ok() && !is_own {
        return Err(RunError::ReplacesOthers { files: vec![file] });
    }
    written.add(name)?;
    Ok(file)
}

/// Whether a file that a user names, and which is replaced where it is there, is none of the results that are read: pages and figures may be made anew.
///
/// # Errors
/// [`RunError::ReplacesInput`]; [`RunError::Write`]: the list of results cannot be read.
pub fn keep_results(directory: &Path, file: &Path) -> Result<(), RunError> {
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    let parent = file.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let is_there =
        parent.canonicalize().ok().is_some_and(|parent| directory.canonicalize().is_ok_and(|own| own == parent));
    let is_made_anew = name == nastic_report::FILE || FIGURES.contains(&name.as_ref());
    if is_there
        && !is_made_anew
        && (listed(directory).contains(&name.to_string()) || WrittenFiles::of(directory)?.has(&name))
    {
        return Err(RunError::ReplacesInput { file: file.to_owned() });
    }
    Ok(())
}

/// Writes `case.json` and `result.json`, and the page if there is one to be.
pub(super) fn write_result(
    input: &CommandInput,
    destination: &Destination,
    findings: &mut CommandFindings,
) -> Result<(), RunError> {
    let Some(out) = destination.results() else { return Ok(()) };
    let is_shown = input.command.optimizes()
        || matches!(input.command, Command::Solve | Command::Modes | Command::Gradient | Command::Gains);
    let with_page = !input.options.no_report && is_shown && input.command != Command::Gradient;
    // a run that failed has nothing for print, and its own error to tell
    let with_figure = input.options.figure && is_shown && findings.record.error.is_none();
    if is_shown {
        findings.record.members = Some(members(&input.problem));
        let case = input.problem.case_file().is_some();
        let page = with_page.then_some(nastic_report::FILE);
        let figures = FIGURES.iter().filter(|_| with_figure).copied();
        findings.list_files(case.then_some(CASE).into_iter().chain(page).chain(figures).map(str::to_owned).collect());
        if case {
            out.write_json(CASE, &input.problem.document.json())?;
        } else {
            out.remove(CASE)?;
        }
    }
    out.write_json("result.json", &findings.record)?;
    for name in FIGURES.iter().filter(|_| with_figure) {
        figure(out.path(), &FigureRequest::default(), Some(&out.own(name)?))?;
    }
    if with_page { report(out.path(), Some(&out.own(nastic_report::FILE)?)).map(|_| ()) } else { remove_old(out) }
}

/// What is reported of the states of an evaluated control.
pub(super) fn entries(
    input: &CommandInput,
    destination: &Destination,
    point: &EnsemblePoint,
    found: &[Inspection],
) -> Result<StateRecord, RunError> {
    let reports = member_report::of_inspected(&input.problem, point, found);
    let entries = reports.and_then(|reports| member_report::entries(&input.problem, &reports, Detail::Full));
    entries.map_err(|error| destination.member_failed(input, error.0, error.1))
}

/// Removes what an earlier run of the same command wrote, as its `result.json` lists it: beside that of a run that fails it would
/// be taken for what that one found. Files that the case reads stay, and those of other commands.
pub(super) fn remove_earlier(input: &CommandInput, destination: &Destination) -> Result<(), RunError> {
    const RESULT: &str = "result.json";
    let Some(out) = &destination.out else { return Ok(()) };
    let text = std::fs::read_to_string(out.file(RESULT)).unwrap_or_default();
    let earlier = serde_json::from_str::<Earlier>(&text).unwrap_or_default();
    if earlier.command != input.command.name() {
        return Ok(());
    }
    let problem = &input.problem;
    let read = problem.files.iter().map(PathBuf::as_path).chain(problem.case_file().map(Path::new));
    let read: Vec<PathBuf> = read.filter_map(|file| file.canonicalize().ok()).collect();
    let is_read = |name: &str| out.file(name).canonicalize().is_ok_and(|file| read.contains(&file));
    let files = earlier.files.iter().map(String::as_str);
    // the case is written whatever happens, and checkpoints have rules of their own, by which no list names them
    for name in files.filter(|name| is_of_runs(name) && *name != CASE && !is_read(name)) {
        out.remove(name)?;
    }
    // the list goes last: one of a run that was killed here is still there for the next
    Ok(out.remove(RESULT)?)
}

/// What an earlier result says of itself, whichever program wrote it.
#[derive(Default, serde::Deserialize)]
#[serde(default)]
struct Earlier {
    command: String,
    files: Vec<String>,
}

/// Whether a name may be one of those that runs write into their directory; the list may be of another program, or edited.
fn is_of_runs(name: &str) -> bool {
    const ENDINGS: [&str; 10] = ["bin", "csv", "h", "html", "json", "jsonl", "png", "pvd", "svg", "vtu"];
    let path = Path::new(name);
    let is_plain = path.file_name().is_some_and(|file| file == name) && !name.starts_with('.');
    is_plain && path.extension().is_some_and(|ending| ENDINGS.iter().any(|known| ending == *known))
}

/// A page of an earlier run would show other results than those beside it.
fn remove_old(out: &Directory) -> Result<(), RunError> {
    Ok(out.remove(nastic_report::FILE)?)
}

/// Scenario and load case of every state, and what the names of its files begin with.
fn members(problem: &CaseProblem) -> Vec<MemberRecord> {
    let (targets, obstacles) = (target_names(problem), obstacle_shape::files(problem).1);
    let of = |member: nastic_case::lower::CaseMember<'_>| MemberRecord {
        name: member.name(),
        scenario: member.scenario().map(str::to_owned).into(),
        load_case: member.load_case().map(str::to_owned).into(),
        stem: member.file(""),
        case_stem: member.case_file(""),
        targets: targets[member.index()].clone(),
        obstacles: obstacles[member.index()].clone(),
        obstacle_names: obstacle_shape::names(member),
    };
    problem.members().map(of).collect()
}
