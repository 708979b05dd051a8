//! `nastic sweep CASE --set path=a,b,c`: one run for every value, each in a directory of its own, and a table of them all.

mod one_run;
mod table;
mod told;

use crate::console::Console;
use crate::run::error::{Exit, RunError};
use crate::run::options::Options;
use crate::run::session::output_directory::directory_of;
use crate::run::sweep::one_run::{Absent, Left, OneRun, Origin};
use crate::run::sweep::table::{introduce, rows_there, table};
use crate::run::sweep::told::{Tally, line, say_missing};
use nastic_case::analysis::Analysis;
use nastic_case::lower::SweepPlan;
use nastic_case::output_names::{OutputNames, SWEEP};
use nastic_case::part::{Part, Share};
use nastic_language::catalogue::Catalogue;
use nastic_language::number::count;
use nastic_language::schema::Command;
use nastic_language::syntax::{Diagnostic, Diagnostics, nearest};
use nastic_report::record::RunRecord;
use nastic_report::{SweepRow, SweepTable};
use nastic_result::files::Directory;
use nastic_team::{broadcast, exchange};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

/// What is run for every value.
#[derive(Clone, Debug)]
pub struct Sweep {
    /// [`Command::Optimize`] or [`Command::Solve`].
    pub command: Command,
    /// Whether an optimisation starts from the controls of the last one before it that has some. The first starts as the case says.
    pub warm: bool,
    /// What the chart shows, by its path in results; unless it is given what is usual for the command.
    pub quantity: Option<String>,
}

/// What a sweep found.
#[derive(Clone, PartialEq, Debug)]
pub struct SweepOutcome {
    /// How the worst run ended; at least [`Exit::NotConverged`] where some are missing.
    pub exit: Exit,
    /// The content of `sweep.json`; of a part without the runs of others.
    pub result: Value,
}

/// Runs a case once for every value of the overrides in `options.set`, which are read as `path=a,b,c`: commas outside of
/// brackets, braces, parentheses and quotes stand between values. Several such options mean all combinations of their values; an option with
/// one value is fixed. A run that fails is a row of the table. Results go to `options.out`, else to where the case says.
///
/// A run whose finished result is there is kept, unless `options.restart`; one that was interrupted goes on from its checkpoint. With
/// [`Share::Part`] the runs of that part alone are made and no table is written, with [`Share::Join`] the table alone is made.
///
/// What the case expects of its results is left aside, and so are `analysis` and `in_memory` of the options. On several ranks all end as the first does.
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
    let Some(team) = options.team.as_ref().filter(|team| team.size() > 1) else {
        return make(catalogue, sweep, case, options, console);
    };
    if options.share != Share::Whole {
        return Err(RunError::OneRank { what: "sweep --part or --join".to_owned(), ranks: team.size() });
    }
    // the runs of a rank are one of as many parts, of which the first rank joins the table
    let of = |share| Options { share, team: None, restart: options.restart && share != Share::Join, ..options.clone() };
    let part = Part::of_rank(team.rank(), team.size());
    let own = make(catalogue, sweep, case, &of(Share::Part(part)), console);
    let failed = exchange(team.as_ref(), failure(&own))?;
    let joined = match own {
        Ok(_) if team.leads() => make(catalogue, sweep, case, &of(Share::Join), console),
        own => own,
    };
    // however their own runs ended: who started the ranks is told of one code
    let joined = joined.map(|mut joined| {
        for (rank, failed) in failed.iter().enumerate().filter(|_| team.leads()) {
            let Some((code, why)) = failed.split_first() else { continue };
            console.say(format!("FAILED      rank {rank}: {}", String::from_utf8_lossy(why)));
            joined.exit = joined.exit.worst(Exit::of_code(*code).unwrap_or(Exit::NotWritten));
        }
        joined
    });
    let code = joined.as_ref().map_or_else(RunError::exit, |joined| joined.exit).code();
    let first = Exit::of_code(broadcast(team.as_ref(), vec![code])?.first().copied().unwrap_or(code));
    if team.leads() {
        return joined;
    }
    let result = joined.map_or(Value::Null, |joined| joined.result);
    Ok(SweepOutcome { exit: first.unwrap_or(Exit::Parted), result })
}

/// The code and the words of what a rank failed for; nothing of one that has not.
fn failure(own: &Result<SweepOutcome, RunError>) -> Vec<u8> {
    own.as_ref().err().map_or_else(Vec::new, |error| {
        let code = [error.exit().code()];
        code.into_iter().chain(error.to_string().into_bytes()).collect()
    })
}

fn make(
    catalogue: &Catalogue,
    sweep: &Sweep,
    case: &Path,
    options: &Options,
    console: &Console,
) -> Result<SweepOutcome, RunError> {
    let plan = SweepPlan::read(catalogue, &sweep.command, sweep.warm, case, &options.set)?;
    check_quantity(sweep.quantity.as_deref())?;
    let own = || directory_of(&plan.document, plan.document.json()["output"]["directory"].as_str());
    let out = options.out.clone().unwrap_or_else(own);
    // Who writes the table holds the lock of its directory; parts hold those of their runs alone.
    let claimed = match options.share {
        Share::Part(_) => None,
        Share::Whole | Share::Join => Some(Directory::claim(out.clone(), OutputNames::of(SWEEP), [case])?),
    };
    introduce(&plan, sweep, console);
    let table = table(&plan, sweep, case);
    let (worst, warm_from) = (Exit::Done, None);
    let (others, left_alone) = (Vec::new(), None);
    let mut work =
        Work { sweep, case, plan: &plan, options, console, out, claimed, table, others, left_alone, worst, warm_from };
    work.run()?;
    let result = serde_json::to_value(work.table.record()).unwrap_or_default(); // records have keys that are texts
    Ok(SweepOutcome { exit: work.exit(), result })
}

/// Refuses a quantity that no results have, before any run; those of the first show the rest.
fn check_quantity(quantity: Option<&str>) -> Result<(), RunError> {
    let Some(quantity) = quantity else { return Ok(()) };
    let schema = RunRecord::schema();
    let known: Vec<&str> =
        schema["properties"].as_object().into_iter().flat_map(|keys| keys.keys()).map(String::as_str).collect();
    let first = quantity.split('/').next().unwrap_or_default();
    if known.contains(&first) {
        return Ok(());
    }
    let meant = nearest(first, &known).map_or_else(
        || "a path is probes/NAME/displacement/2, energy/elastic ..; nastic schema --results has all".to_owned(),
        |name| format!("did you mean \"{name}\"?"),
    );
    Err(wrong_quantity(format!("results have no \"{first}\": {meant}")))
}

fn wrong_quantity(message: String) -> RunError {
    Diagnostics::from(Diagnostic { file: "--quantity".to_owned(), path: String::new(), line: 0, column: 0, message })
        .into()
}

/// A sweep under way.
struct Work<'s> {
    sweep: &'s Sweep,
    case: &'s Path,
    plan: &'s SweepPlan,
    options: &'s Options,
    console: &'s Console,
    out: PathBuf,
    /// The same, where the table is written.
    claimed: Option<Directory>,
    table: SweepTable,
    /// Directories of runs that are missing where a table is joined, though they have a finished result: of another case, say.
    others: Vec<String>,
    /// How many rows the table has that is not replaced for them.
    left_alone: Option<usize>,
    /// The worst end so far.
    worst: Exit,
    /// The last run that has controls, where the next starts from these.
    warm_from: Option<String>,
}

impl Work<'_> {
    fn run(&mut self) -> Result<(), RunError> {
        let mut tally = Tally::default();
        for index in 0..self.plan.runs.len() {
            if !self.is_mine(index) {
                continue;
            }
            match self.find(index) {
                Err(Absent::Other) if self.options.share == Share::Join => {
                    self.others.push(self.plan.runs[index].directory.clone());
                }
                Err(_) => {}
                Ok((row, origin)) => {
                    tally.add(origin);
                    self.add(row, origin);
                    self.check_quantity()?;
                    if origin != Origin::Kept {
                        // After every run, so that what was found is kept however the sweep ends.
                        self.write()?;
                    }
                }
            }
        }
        self.write()?;
        self.conclude(&tally);
        Ok(())
    }

    /// Whether this process has to do with a run. In a warm sweep, where each starts from one before, all belong to the first part.
    fn is_mine(&self, index: usize) -> bool {
        match self.options.share {
            Share::Part(part) if self.sweep.warm => part.is_first(),
            Share::Part(part) => part.has(index),
            Share::Whole | Share::Join => true,
        }
    }

    /// Directories of the runs that have no row yet.
    fn missing(&self) -> Vec<String> {
        let mut rows = self.table.rows.iter().map(|row| row.index).peekable();
        let runs = self.plan.runs.iter().enumerate().filter(|(index, _)| self.is_mine(*index));
        let missing = runs.filter(|(index, _)| rows.next_if_eq(index).is_none());
        missing.map(|(_, run)| run.directory.clone()).collect()
    }

    /// The row of a run, or why it is missing: not made before, and not to be made now.
    fn find(&self, index: usize) -> Result<(SweepRow, Origin), Absent> {
        let run = &self.plan.runs[index];
        let directory = self.out.join(&run.directory);
        let warm_from = self.warm_from.as_ref().map(|before| self.out.join(before));
        let set = self.plan.settings(run, warm_from.as_deref());
        let mut document = self.plan.document.clone();
        // Those that do not fit the case were refused before any run.
        set.iter().for_each(|setting| drop(document.set(setting)));
        let one = OneRun { command: &self.sweep.command, case: self.case, directory: &directory, document };
        let makes = self.options.share != Share::Join && !self.options.cancel.load(Ordering::Relaxed);
        let again = |left: &Left| {
            // What a run was refused for, a missing file say, may be mended.
            makes && (self.options.restart || left.exit == Exit::BadInput)
        };
        let (left, origin) = match one.finished(self.options.strict) {
            Ok(left) if !again(&left) => (left, Origin::Kept),
            Err(absent) if !makes => return Err(absent),
            _ => {
                let runs = self.plan.runs.len();
                self.console.run(index, runs, &run.directory);
                let options = self.options_of(&directory, set);
                one.make(&options, &self.console.passing_alone())
            }
        };
        let Left { exit, error, record } = left;
        let values = self.plan.swept_values(run);
        let mut row = SweepRow::of(index, &run.directory, values, exit.code(), error, record);
        row.warm_from = self.warm_from.clone();
        Ok((row, origin))
    }

    fn options_of(&self, directory: &Path, set: Vec<String>) -> Options {
        Options {
            out: Some(directory.to_owned()),
            set,
            analysis: Analysis::Equilibrium,
            in_memory: false,
            without_expect: true,
            share: Share::Whole,
            ..self.options.clone()
        }
    }

    fn add(&mut self, row: SweepRow, origin: Origin) {
        if self.sweep.warm && row.figures.contains_key("stop") {
            self.warm_from = Some(row.directory.clone());
        }
        self.console.say(line(&row, origin, self.plan.runs.len()));
        self.worst = Exit::of_code(row.exit).map_or(self.worst, |exit| self.worst.worst(exit));
        self.table.rows.push(row);
    }

    /// The first run shows whether results have what is to be shown: before all others are made.
    fn check_quantity(&self) -> Result<(), RunError> {
        let (Some(quantity), Some(known)) = (&self.sweep.quantity, self.table.lacks_quantity()) else { return Ok(()) };
        Err(wrong_quantity(format!("\"{quantity}\" is no number of these results; there are: {}", known.join(", "))))
    }

    fn exit(&self) -> Exit {
        if self.table.missing.is_empty() { self.worst } else { self.worst.worst(Exit::NotConverged) }
    }

    /// Writes the table, unless others have a part in it. One that has more rows stays where finished runs are missing in that of now: who joins with an
    /// option too many is not to lose it.
    fn write(&mut self) -> Result<(), RunError> {
        self.table.missing = self.missing();
        self.table.exit = self.exit().code();
        let Some(out) = &self.claimed else { return Ok(()) };
        let more = || rows_there(out.path()).filter(|rows| *rows > self.table.rows.len());
        self.left_alone = if self.others.is_empty() { None } else { more() };
        if self.left_alone.is_none() {
            for name in self.table.files() {
                out.own(&name)?;
            }
            self.table.write(out.path())?;
        }
        Ok(())
    }

    fn conclude(&self, tally: &Tally) {
        let console = self.console;
        say_missing(&self.table.missing, &self.others, console);
        if let Some(rows) = self.left_alone {
            let (out, there, found) = (self.out.display(), count(rows, "run"), self.table.rows.len());
            console.say(format!(
                "unchanged   {out}: the table there has {there}; that of now has {found} and is not written (remove sweep.json to \
                 have it)"
            ));
            return;
        }
        match self.options.share {
            Share::Part(part) if self.sweep.warm && !part.is_first() => {
                console
                    .say(format!("part {part:<7}nothing to run: a warm sweep is one chain, which the first part runs"));
            }
            Share::Part(part) => {
                console.say(format!("part {part:<7}{tally}; --join makes the table when all parts are done"));
            }
            Share::Whole | Share::Join => {
                let files = "sweep.html, sweep.csv, sweep_table.csv, sweep_table.tex, sweep.json, sweep.svg, sweep.pvd";
                console.say(format!("results     {}: {files}", self.out.display()));
            }
        }
    }
}
