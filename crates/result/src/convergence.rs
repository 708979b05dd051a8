//! The trials of an optimisation as a table, `history.csv`, and as a chart, `convergence.svg`.

use crate::files::Directory;
use nastic_io::{WriteError, write_atomically};
use nastic_picture::{Chart, Curve};
use nastic_report::csv;
use nastic_report::record::{Number, TrialRecord};
use serde_json::Value;

/// Writes both from `history.jsonl`; the names of the files. `start` is the one that is drawn, where there are several.
///
/// # Errors
/// What the system answers.
pub fn write(out: &Directory, title: &str, start: Option<usize>) -> Result<Vec<String>, WriteError> {
    let file = out.file("history.jsonl");
    let text = std::fs::read_to_string(&file).map_err(|source| WriteError::System { file, source })?;
    let trials: Vec<TrialRecord> = text.lines().filter_map(|line| serde_json::from_str(line).ok()).collect();
    let table = csv::table(&trials.iter().filter_map(without_seconds).collect::<Vec<_>>());
    write_atomically(out.own("history.csv")?, |out| out.write_all(table.as_bytes()))?;
    let mut files = vec!["history.csv".to_owned()];
    let drawn = trials.iter().filter(|trial| start.is_none() || trial.start == start);
    if let Some(chart) = chart(title, &drawn.collect::<Vec<_>>()) {
        chart.write(out.own("convergence.svg")?)?;
        files.push("convergence.svg".to_owned());
    }
    Ok(files)
}

/// What does not depend on the clock.
fn without_seconds(trial: &TrialRecord) -> Option<Value> {
    serde_json::to_value(TrialRecord { seconds: Number::default(), ..trial.clone() }).ok()
}

/// Cost, projected gradient and distances of the trials over their first values; `None` where nothing can be drawn.
fn chart(title: &str, trials: &[&TrialRecord]) -> Option<Chart> {
    type Column = fn(&TrialRecord) -> Number;
    let columns: [(Column, &str); 4] = [
        (|trial| trial.cost, "cost"),
        (|trial| trial.gradient_norm, "projected gradient"),
        (|trial| trial.hausdorff_true, "true Hausdorff distance"),
        (|trial| trial.tracking_root_mean_square, "distance, root mean square"),
    ];
    let mut chart = Chart::new(&format!("{title}: convergence"), "trial", "log10 of the value over the first");
    let mut drawn = false;
    for (of, label) in columns {
        let value = |trial: &&TrialRecord| of(trial).filter(|x| *x > 0.0);
        let Some(first) = trials.iter().find_map(value) else { continue };
        let point = |(k, trial): (usize, &&TrialRecord)| Some((k as f64, (value(trial)? / first).log10(), true));
        let points: Vec<(f64, f64, bool)> = trials.iter().enumerate().filter_map(point).collect();
        if points.len() > 1 {
            chart = chart.curve(Curve::new(label, points));
            drawn = true;
        }
    }
    drawn.then_some(chart)
}
