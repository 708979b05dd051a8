//! The plots of a run: columns of `history.jsonl` over trials, and the costs of scenarios.

use crate::record::{Nullable, RunRecord, StateRecord, TrialRecord, number_of};
use serde_json::{Value, json};

/// One curve.
struct Curve {
    label: String,
    values: Vec<Option<f64>>,
}

/// All plots, as `{ "title", "x", "y", "log", "points", "columns": [x, ..], "labels": [..] }`; empty without a history.
pub(crate) fn plots(result: &RunRecord, history: &[TrialRecord]) -> Vec<Value> {
    let mut out = convergence(result, &of_best_start(result, history));
    out.extend(scenarios(result));
    out
}

/// The trials of the start that everything else speaks of.
fn of_best_start<'a>(result: &RunRecord, history: &'a [TrialRecord]) -> Vec<&'a TrialRecord> {
    history.iter().filter(|line| result.optimum.best_start.is_none_or(|best| line.start == Some(best))).collect()
}

fn convergence(result: &RunRecord, trials: &[&TrialRecord]) -> Vec<Value> {
    if trials.len() < 2 {
        return Vec::new();
    }
    let column = |label: &str, value: &dyn Fn(&TrialRecord) -> Option<f64>| Curve {
        label: label.to_owned(),
        values: trials.iter().map(|trial| value(trial)).collect(),
    };
    let count =
        |label: &str, value: fn(&TrialRecord) -> &Nullable<u64>| column(label, &|trial| value(trial).map(|n| n as f64));
    let mut costs = vec![column("cost", &|trial| *trial.cost)];
    let terms: Vec<&String> =
        trials.iter().find_map(|trial| trial.terms.as_ref()).into_iter().flat_map(|terms| terms.keys()).collect();
    if terms.len() > 1 {
        let term = |name: &&String| column(name, &|trial| number_of(trial.terms.as_ref()?, name));
        costs.extend(terms.iter().take(6).map(term));
    }
    let x: Vec<Option<f64>> = trials.iter().map(|trial| Some(trial.trial as f64)).collect();
    let plot = |title: &str, y: &str, curves: Vec<Curve>| plot(title, "trial", y, &x, curves);
    let all = [
        plot("Cost", "cost", costs),
        plot(
            "Distance from the target",
            &result.units.length,
            vec![
                column("true Hausdorff distance", &|trial| *trial.hausdorff_true),
                column("largest tracked distance", &|trial| *trial.tracking_largest),
                column("root mean square", &|trial| *trial.tracking_root_mean_square),
                column("position from its target", &|trial| *trial.position_distance),
            ],
        ),
        plot(
            "Projected gradient",
            "norm in the control's product",
            vec![column("projected gradient", &|trial| *trial.gradient_norm)],
        ),
        plot("Step length", "step", vec![column("step length", &|trial| *trial.step)]),
        plot(
            "Work per trial",
            "count",
            vec![
                count("Newton iterations", |trial| &trial.newton),
                count("factorisations", |trial| &trial.factorisations),
                count("linear solves and iterations", |trial| &trial.back_substitutions),
            ],
        ),
        plot("Values on their bounds", "count", vec![column("on a bound", &|trial| Some(trial.active as f64))]),
        plot("Smallest volume ratio", "J", vec![column("smallest J", &|trial| *trial.min_j)]),
    ];
    all.into_iter().flatten().collect()
}

/// A plot of the curves that have two values or more; none without one. Logarithmic where all values are positive (zeros
/// are left out then) and span more than a decade, but for small whole numbers.
fn plot(title: &str, x_label: &str, y_label: &str, x: &[Option<f64>], curves: Vec<Curve>) -> Option<Value> {
    let shown = |curve: &Curve| curve.values.iter().flatten().count() > 1;
    let mut curves: Vec<Curve> = curves.into_iter().filter(shown).collect();
    let values = || curves.iter().flat_map(|curve| curve.values.iter().flatten());
    let (low, high) = values().filter(|y| **y > 0.0).fold((f64::INFINITY, 0.0f64), |(l, h), y| (l.min(*y), h.max(*y)));
    let is_whole = values().all(|y| y.fract() == 0.0) && high < 1e3;
    let log = values().all(|y| *y >= 0.0) && high > 10.0 * low && !is_whole;
    if curves.is_empty() || values().all(|y| *y == 0.0) {
        return None;
    }
    if log {
        let positive = |y: &mut Option<f64>| *y = y.filter(|y| *y > 0.0);
        curves.iter_mut().for_each(|curve| curve.values.iter_mut().for_each(positive));
    }
    let labels: Vec<&str> = curves.iter().map(|curve| curve.label.as_str()).collect();
    let columns: Vec<&[Option<f64>]> =
        [x].into_iter().chain(curves.iter().map(|curve| curve.values.as_slice())).collect();
    Some(json!({
        "title": title, "x": x_label, "y": y_label, "log": log, "points": false, "labels": labels, "columns": columns,
    }))
}

/// The cost of every scenario at the optimum and at the start, in the order of the former.
fn scenarios(result: &RunRecord) -> Option<Value> {
    let all = Some(&result.scenarios).filter(|all| all.len() > 1)?;
    let begin = |name: &str| result.start.scenarios.get(name).and_then(|entry| *entry.cost.total);
    let of = |(name, entry): (&String, &StateRecord)| (*entry.cost.total, begin(name));
    let mut costs: Vec<(Option<f64>, Option<f64>)> = all.iter().map(of).collect();
    costs.sort_by(|a, b| a.0.unwrap_or(f64::NAN).total_cmp(&b.0.unwrap_or(f64::NAN)));
    let (now, begin): (Vec<_>, Vec<_>) = costs.into_iter().unzip();
    let ranks: Vec<Option<f64>> = (1..=now.len()).map(|k| Some(k as f64)).collect();
    let what = if begin.iter().any(Option::is_some) { "at the optimum" } else { "cost" };
    let curves =
        vec![Curve { label: what.to_owned(), values: now }, Curve { label: "at the start".to_owned(), values: begin }];
    let mut plot = plot("Costs of the scenarios", "scenario, in the order of costs", "cost", &ranks, curves)?;
    plot["points"] = json!(true);
    Some(plot)
}
