//! `nastic fit DATA`: parameters of laws from test data, and what they are worth.

mod entry;
mod plot;
mod print;

use crate::console::Console;
use crate::run::error::{Exit, RunError};
use crate::run::fit::entry::Fitted;
use crate::run::session::output_directory::directory_of;
use nastic_case::lower::{LoneTable, read_tests};
use nastic_case::output_names::{FIT, OutputNames};
use nastic_fit::{FitError, FitOptions, Law, Test, fit as fit_law};
use nastic_io::write_atomically;
use nastic_language::schema::FitData;
use nastic_report::record::{FailedLawRecord, FitRecord};
use nastic_result::files::Directory;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// The results.
const FILE: &str = "fit.json";
/// The page.
const PAGE: &str = "fit.html";

/// What a fit found.
#[derive(Clone, PartialEq, Debug)]
pub struct FitOutcome {
    /// How it ended.
    pub exit: Exit,
    /// The content of `fit.json`.
    pub result: Value,
}

/// Fits the laws of a data file to its tests, writes `fit.json`, `fit.html` and `fit.svg` to `out` (else to `out/DATA` beside the file), and says what was found.
///
/// # Errors
/// [`RunError::Input`]: a file that cannot be read, an invalid row of a table; [`RunError::Fit`]: no law could be fitted;
/// [`RunError::Write`], [`RunError::InUse`].
pub fn fit(data: &Path, out: Option<PathBuf>, console: &Console) -> Result<FitOutcome, RunError> {
    fit_with(data, &LoneTable::default(), out, console)
}

/// The same; `data` may be the CSV file of one test, of which `table` says what a data file would.
///
/// # Errors
/// As [`fit`].
pub fn fit_with(
    data: &Path,
    table: &LoneTable,
    out: Option<PathBuf>,
    console: &Console,
) -> Result<FitOutcome, RunError> {
    let document = &table.document(data)?;
    let asked = FitData::read_document(document)?;
    let (tests, doubtful) = read_tests(document, &asked)?;
    let out = Directory::claim(out.unwrap_or_else(|| directory_of(document, None)), OutputNames::of(FIT), [data])?;
    // They belong to an earlier fit, and would stand there as results of this one if it fails.
    out.remove(FILE)?;
    out.remove(PAGE)?;
    plot::files().chain(entry::network_files()).try_for_each(|name| out.remove(&name))?;
    let errors = asked.errors.errors();
    let options = FitOptions { errors, starts: asked.starts, seed: asked.seed, ..FitOptions::default() };
    let laws: Vec<Law> = asked.laws.iter().map(|law| law.0).collect();
    let known = || Law::among(document.catalogue().materials().iter().copied());
    let laws = if laws.is_empty() { asked.all_laws(known()) } else { laws };
    let trained = tests.iter().zip(&asked.tests).filter(|(_, own)| !own.held_out).map(|(test, _)| test.clone());
    let trained: Vec<Test> = trained.collect();
    print::introduce(&asked, &tests, console);
    doubtful.iter().for_each(|warning| console.say(format!("WARNING     {warning}")));
    let (mut fitted, mut failed): (Vec<Fitted>, Vec<(Law, FitError)>) = (Vec::new(), Vec::new());
    for law in laws {
        console.phase(&format!("fitting {}", law.label()));
        let found = fit_law(law, &trained, &options).and_then(|found| Fitted::new(found, &asked, &tests));
        match found {
            Ok(found) => fitted.push(found),
            Err(error) => failed.push((law, error)),
        }
    }
    console.clear();
    fitted.sort_by(|a, b| a.fit.criteria.compare(&b.fit.criteria));
    let Some(best) = fitted.first() else {
        return Err(RunError::Fit(failed.into_iter().next().map_or(FitError::NoStress, |(_, error)| error)));
    };
    print::found(&fitted, &trained, &failed, errors, console);
    let charts = plot::charts(&fitted, &tests, asked.title.as_deref());
    for (name, chart) in &charts {
        chart.write(out.own(name)?)?;
    }
    let networks: Vec<_> = fitted.iter().filter_map(Fitted::network_file).collect();
    networks.iter().try_for_each(|(name, network)| out.write_json(name, network))?;
    let names = [PAGE, FILE].into_iter().map(str::to_owned);
    let others = charts.iter().map(|(name, _)| name).chain(networks.iter().map(|(name, _)| name));
    let files: Vec<String> = names.chain(others.cloned()).collect();
    let least = best.fit.criteria.aicc;
    let failure = |(law, why): &(Law, FitError)| FailedLawRecord { law: law.label(), why: why.to_string() };
    let record = FitRecord {
        command: "fit".to_owned(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        title: asked.title.clone().into(),
        errors: asked.errors.name().to_owned(),
        tests: tests.iter().zip(&asked.tests).map(|(test, own)| entry::of_test(test, own.held_out)).collect(),
        seen: entry::seen(&trained),
        best: best.fit.law.label(),
        laws: fitted.iter().map(|one| one.record(least, errors)).collect(),
        failed: failed.iter().map(failure).collect(),
        files,
        exit: Exit::Done.code(),
    };
    out.write_json(FILE, &record)?;
    let page = record.page(&charts.iter().filter_map(|(_, chart)| chart.svg()).collect::<Vec<_>>());
    write_atomically(out.own(PAGE)?, |file| file.write_all(page.as_bytes()))?;
    console.say(format!("results     {}: {}", out.path().display(), record.files.join(", ")));
    let result = serde_json::to_value(record).unwrap_or_default(); // records have keys that are texts
    Ok(FitOutcome { exit: Exit::Done, result })
}
