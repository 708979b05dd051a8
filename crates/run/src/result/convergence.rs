//! The trials of an optimisation as a table, `history.csv`, and as a chart, `convergence.svg`.

use crate::result::files::Directory;
use nastic_io::{WriteError, write_atomically};
use nastic_picture::{Chart, Curve};
use nastic_report::csv;
use serde_json::Value;

/// Writes both from `history.jsonl`; the names of the files. `start` is the one that is drawn, where there are several.
pub(crate) fn write(out: &Directory, title: &str, start: Option<usize>) -> Result<Vec<String>, WriteError> {
    let file = out.file("history.jsonl");
    let text = std::fs::read_to_string(&file).map_err(|source| WriteError::System { file, source })?;
    let trials: Vec<Value> = text.lines().filter_map(|line| serde_json::from_str(line).ok()).collect();
    let table = csv::table(&trials.iter().cloned().map(without_seconds).collect::<Vec<_>>());
    write_atomically(out.file("history.csv"), |out| out.write_all(table.as_bytes()))?;
    let mut files = vec!["history.csv".to_owned()];
    let drawn = trials.iter().filter(|trial| start.is_none_or(|start| trial["start"] == start));
    if let Some(chart) = chart(title, &drawn.collect::<Vec<_>>()) {
        chart.write(out.file("convergence.svg"))?;
        files.push("convergence.svg".to_owned());
    }
    Ok(files)
}

/// What does not depend on the clock.
fn without_seconds(mut trial: Value) -> Value {
    if let Value::Object(entries) = &mut trial {
        entries.shift_remove("seconds");
    }
    trial
}

/// Cost, projected gradient and distances of the trials over their first values; `None` where nothing can be drawn.
fn chart(title: &str, trials: &[&Value]) -> Option<Chart> {
    let columns = [
        ("cost", "cost"),
        ("gradient_norm", "projected gradient"),
        ("hausdorff_true", "true Hausdorff distance"),
        ("tracking_root_mean_square", "distance, root mean square"),
    ];
    let mut chart = Chart::new(&format!("{title}: convergence"), "trial", "log10 of the value over the first");
    let mut drawn = false;
    for (key, label) in columns {
        let value = |trial: &&Value| trial[key].as_f64().filter(|x| *x > 0.0);
        let Some(first) = trials.iter().find_map(value) else { continue };
        let point = |(k, trial): (usize, &&Value)| Some((k as f64, (value(trial)? / first).log10(), true));
        let points: Vec<(f64, f64, bool)> = trials.iter().enumerate().filter_map(point).collect();
        if points.len() > 1 {
            chart = chart.curve(Curve::new(label, points));
            drawn = true;
        }
    }
    drawn.then_some(chart)
}
