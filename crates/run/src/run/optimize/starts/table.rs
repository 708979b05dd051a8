//! The starts in the result and on the terminal: names, seeds, entries.

use crate::console::Console;
use crate::run::optimize::starts::start_run::FinishedRun;
use nastic_case::lower::{Admitted, CaseProblem};
use nastic_numeric::format::scientific;
use nastic_opt::Stop;
use nastic_report::record::{GradientCheckRecord, Number, StartRecord};

/// The seed of a start; the first is as written.
pub(crate) fn seed(problem: &CaseProblem, index: usize) -> Option<u64> {
    // Seeds of neighbouring cases shall not share their starts.
    let of = |index: usize| problem.case.optimizer.seed.wrapping_mul(1_000_003).wrapping_add(index as u64);
    (index > 0).then(|| of(index))
}

/// The entry of a start that ended.
pub(crate) fn entry(seed: Option<u64>, ended: &FinishedRun, certificate: GradientCheckRecord) -> StartRecord {
    let best = &ended.best;
    let violation = (!ended.constraints.groups.is_empty()).then_some(ended.constraints.violation);
    StartRecord {
        seed: seed.into(),
        start_cost: ended.start.risk.into(),
        cost: best.cost.into(),
        gradient_norm: best.gradient_norm.into(),
        iterations: Some(best.counts.iterations),
        trials: Some(best.counts.trials),
        converged: Some(best.stop.is_converged()),
        stop: Some(best.stop.to_string()),
        stopped_early: Some(matches!(best.stop, Stop::Outperformed { .. })),
        violation: violation.map(Number::from).unwrap_or_default(),
        // That of the start as written is the result's own.
        gradient_check: seed.map(|_| certificate),
        ..StartRecord::default()
    }
}

/// The entry of a start that did not begin.
pub(crate) fn failed_entry(seed: Option<u64>, why: impl Into<String>) -> StartRecord {
    StartRecord { seed: seed.into(), failed: Some(why.into()), ..StartRecord::default() }
}

/// One line per start.
pub(crate) fn say(problem: &CaseProblem, console: &Console, entries: &[StartRecord], best: usize) {
    let directions = problem.controls.iter().any(|field| matches!(field.admitted, Admitted::Norm(_)));
    if entries.len() == 1 && problem.case.optimizer.starts == 1 && directions {
        let hint = "one; vectors of given length often have several minima: --set optimizer/starts=4 tries three more";
        console.say(format!("starts      {hint}"));
    }
    for (k, start) in entries.iter().enumerate().filter(|_| entries.len() > 1) {
        let head = if k == 0 { "starts" } else { "" };
        let seed = start.seed.map_or_else(|| "as written".to_owned(), |seed| format!("seed {seed}"));
        let what = match *start.cost {
            Some(cost) => {
                let iterations = start.iterations.unwrap_or_default();
                format!("cost {} after {iterations} iterations", scientific(cost, 6))
            }
            None => format!("failed: {}", start.failed.as_deref().unwrap_or_default()),
        };
        let mark = match (start.minimum, k == best) {
            (_, true) => ", the best".to_owned(),
            (Some(0), _) => ", the same minimum".to_owned(),
            (Some(minimum), _) => {
                let percent = 100.0 * start.distance.unwrap_or(f64::NAN);
                format!(", minimum {}, its control {percent:.0} % away", minimum + 1)
            }
            (None, _) if start.stopped_early == Some(true) => ", stopped early".to_owned(),
            (None, _) => String::new(),
        };
        console.say(format!("{head:<12}{} ({seed}): {what}{mark}", k + 1));
    }
}
