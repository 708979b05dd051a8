//! The trials of an optimisation as a table, `history.csv`, and as a chart, `convergence.svg`.

use super::files::Directory;
use nastic_io::{WriteError, write_atomically};
use nastic_picture::{Chart, Curve};
use serde_json::Value;

/// Writes both from `history.jsonl`; the names of the files. `start` is the one that is drawn, where there are several.
pub(crate) fn write(out: &Directory, title: &str, start: Option<usize>) -> Result<Vec<String>, WriteError> {
    let file = out.file("history.jsonl");
    let text = std::fs::read_to_string(&file).map_err(|source| WriteError::System { file, source })?;
    let trials: Vec<Value> = text.lines().filter_map(|line| serde_json::from_str(line).ok()).collect();
    let table = csv(&trials);
    write_atomically(out.file("history.csv"), |out| out.write_all(table.as_bytes()))?;
    let mut files = vec!["history.csv".to_owned()];
    let drawn = trials.iter().filter(|trial| start.is_none_or(|start| trial["start"] == start));
    if let Some(chart) = chart(title, &drawn.collect::<Vec<_>>()) {
        chart.write(out.file("convergence.svg"))?;
        files.push("convergence.svg".to_owned());
    }
    Ok(files)
}

/// One row per trial, the columns those of `history.jsonl` but for `seconds`; entries of terms and scenarios as `terms/NAME`
/// and `scenarios/0`.
fn csv(trials: &[Value]) -> String {
    let rows: Vec<Vec<(String, String)>> = trials.iter().map(cells).collect();
    let mut head: Vec<&str> = Vec::new();
    for (name, _) in rows.iter().flatten() {
        if !head.contains(&name.as_str()) {
            head.push(name);
        }
    }
    let mut text = head.iter().map(|name| quoted(name)).collect::<Vec<_>>().join(",") + "\n";
    for row in &rows {
        let cell = |name: &&str| row.iter().find(|(known, _)| known == name).map_or("", |(_, cell)| cell.as_str());
        text += &(head.iter().map(cell).collect::<Vec<_>>().join(",") + "\n");
    }
    text
}

fn cells(trial: &Value) -> Vec<(String, String)> {
    let mut out = Vec::new();
    for (name, value) in trial.as_object().into_iter().flatten().filter(|(name, _)| *name != "seconds") {
        match value {
            Value::Object(own) => out.extend(own.iter().map(|(key, value)| (format!("{name}/{key}"), cell(value)))),
            Value::Array(own) => {
                out.extend(own.iter().enumerate().map(|(k, value)| (format!("{name}/{k}"), cell(value))));
            }
            other => out.push((name.clone(), cell(other))),
        }
    }
    out
}

fn cell(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => quoted(text),
        other => other.to_string(),
    }
}

fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
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

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn rows_have_all_columns_and_gaps_where_nothing_is_known() {
        let trials = [
            json!({ "trial": 0, "reason": "start", "cost": 2.5, "terms": { "a": 1.5, "b, c": 1 }, "seconds": 3 }),
            json!({ "trial": 1, "reason": "no, \"never\"", "cost": null, "terms": {}, "scenarios": [1, 2] }),
        ];
        let expected = "trial,reason,cost,terms/a,\"terms/b, c\",scenarios/0,scenarios/1\n0,start,2.5,1.5,1,,\n\
                        1,\"no, \"\"never\"\"\",,,,1,2\n";
        assert_eq!(csv(&trials), expected);
    }
}
