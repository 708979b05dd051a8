//! `nastic gradcheck`: does the derivative belong to the cost? Per control field and per cost term.

mod memo;

use super::error::{Exit, RunError};
use super::number::scientific;
use super::session::Session;
use crate::lower::{Admitted, CaseProblem};
use memo::{Column, Memo, Term};
use nastic_opt::{Admissible, Objective, Taylor, TaylorDirection, TaylorError, Verdict};
use serde_json::{Value, json};

/// Random directions per control field.
const DIRECTIONS: usize = 2;
/// Accuracy asked of states: differences shall show the derivative, not the solver.
const ACCURACY: f64 = 1e-12;

/// The Taylor test of one control field and one part of the cost.
#[derive(Clone, PartialEq, Debug)]
pub struct GradientTest {
    /// Name of the control field.
    pub control: String,
    /// Name of the term, or "total"; with its stage where there are several.
    pub term: String,
    /// What was found, direction by direction.
    pub directions: Vec<TaylorDirection>,
}

impl GradientTest {
    /// Wrong if any direction is; undecided if none can tell.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        let is = |verdict| self.directions.iter().any(|d| d.verdict == verdict);
        [Verdict::Wrong, Verdict::Right, Verdict::Linear].into_iter().find(|v| is(*v)).unwrap_or(Verdict::Undecided)
    }
}

pub(super) fn run(session: &mut Session<'_>) -> Result<Exit, RunError> {
    session.require(true, true)?;
    let began = std::time::Instant::now();
    session.console.pass("solving at the start control");
    let memo = Memo::new(&session.problem.ensemble, &session.problem.start, ACCURACY);
    let memo = memo.map_err(|error| session.evaluation_failed(&error))?;
    let mut tests = Vec::new();
    let blocks = session.problem.ensemble.blocks().iter().zip(&session.problem.controls);
    for (block, field) in blocks {
        session.console.pass(format!("varying {}", field.name));
        let own = block.first..block.first + block.len;
        let taylor = Taylor {
            directions: DIRECTIONS,
            seed: session.problem.case.optimizer.seed.wrapping_add(1),
            size: size(&session.problem),
            components: Some(own),
            accuracy: ACCURACY,
            ..Taylor::default()
        };
        let found = test_field(&session.problem, &memo, &taylor, &field.name)?;
        session.console.clear();
        if session.is_cancelled() {
            return Err(RunError::Cancelled);
        }
        say(session, &field.name, &found);
        tests.extend(found);
    }
    session.note_time("gradient_check", began.elapsed().as_secs_f64());
    Ok(conclude(session, &tests))
}

fn test_field(
    problem: &CaseProblem,
    memo: &Memo<'_>,
    taylor: &Taylor,
    control: &str,
) -> Result<Vec<GradientTest>, TaylorError> {
    let test = |term: Term| -> Result<GradientTest, TaylorError> {
        let label = term.label.clone();
        test_gradient(&Column { memo, term }, &problem.set, &problem.start, taylor, control, &label)
    };
    memo.terms().into_iter().map(test).collect()
}

/// The Taylor test of an objective at a control, under the names of a control field and a term.
///
/// # Errors
/// As [`Taylor::test`].
pub fn test_gradient<O: Objective>(
    objective: &O,
    set: &dyn Admissible,
    m: &[f64],
    taylor: &Taylor,
    control: &str,
    term: &str,
) -> Result<GradientTest, TaylorError> {
    let report = taylor.test(objective, set, m)?;
    Ok(GradientTest { control: control.to_owned(), term: term.to_owned(), directions: report.directions })
}

/// Size of a control where neither its set nor its values tell: the law's bound on it, or the one bound it has.
pub(super) fn size(problem: &CaseProblem) -> Option<f64> {
    problem.controls.iter().find_map(|field| match field.admitted {
        Admitted::Between { lower, upper } => {
            let bounds = [field.limit.unwrap_or(0.0), lower, upper];
            bounds.into_iter().map(f64::abs).find(|bound| *bound > 0.0 && bound.is_finite())
        }
        Admitted::Norm(norm) | Admitted::MaxNorm(norm) => Some(norm),
        Admitted::Any => None,
    })
}

fn say(session: &Session<'_>, control: &str, tests: &[GradientTest]) {
    let Some(first) = tests.first() else { return };
    let width = tests.iter().map(|test| test.term.chars().count()).max().unwrap_or(0).max(10);
    for k in 0..first.directions.len() {
        session.console.say("");
        session.console.say(format!(
            "control {control}, direction {} of {}: remainder |j(m + t d) - j(m) - t dj.d| by step t",
            k + 1,
            first.directions.len()
        ));
        let heads: Vec<String> = tests.iter().map(|test| format!("{:>width$}  ", test.term)).collect();
        session.console.say(format!("{:>8}  {}", "t", heads.concat()));
        for row in 0..first.directions[k].rows.len() {
            let t = first.directions[k].rows[row].t;
            let cells: Vec<String> = tests.iter().map(|test| cell(&test.directions[k], row, width)).collect();
            session.console.say(format!("{:>8}  {}", scientific(t, 1), cells.concat()));
        }
        let line = |name: &str, of: &dyn Fn(&TaylorDirection) -> String| {
            let cells: Vec<String> =
                tests.iter().map(|test| format!("{:>width$}  ", of(&test.directions[k]))).collect();
            session.console.say(format!("{name:>8}  {}", cells.concat()));
        };
        line("dj.d", &|d| scientific(d.slope, 3));
        line("order", &|d| if d.order1.is_finite() { format!("{:.3}", d.order1) } else { "-".to_owned() });
        line("verdict", &|d| word(d.verdict).to_owned());
    }
}

/// A remainder; a star marks those the order is fitted to.
fn cell(direction: &TaylorDirection, row: usize, width: usize) -> String {
    let row = &direction.rows[row];
    let mark = if row.used { '*' } else { ' ' };
    match row.cost {
        Some(_) => format!("{:>width$}{mark} ", scientific(row.r1, 3)),
        None => format!("{:>width$}  ", "failed"),
    }
}

fn word(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Right => "right",
        Verdict::Wrong => "WRONG",
        Verdict::Linear => "linear",
        Verdict::Quadratic => "quadratic",
        Verdict::Undecided => "undecided",
    }
}

fn conclude(session: &mut Session<'_>, tests: &[GradientTest]) -> Exit {
    let wrong: Vec<&GradientTest> = tests.iter().filter(|test| test.verdict() == Verdict::Wrong).collect();
    let undecided = tests.iter().filter(|test| test.verdict() == Verdict::Undecided).count();
    session.console.say("");
    session
        .console
        .say("Order 2 shows that the derivative belongs to the cost; * marks the remainders it is fitted to, those");
    session.console.say("at round-off are not judged.");
    let verdict = match (wrong.is_empty(), undecided) {
        (false, _) => {
            let list: Vec<String> = wrong.iter().map(|t| format!("{} by {}", t.term, t.control)).collect();
            format!("WRONG: {}", list.join(", "))
        }
        (true, 0) => "right: every order is 2".to_owned(),
        (true, n) if n == tests.len() => "undecided: no remainder stands clear of round-off".to_owned(),
        (true, n) => format!("right where it can be judged; {n} of {} undecided", tests.len()),
    };
    session.console.say(format!("verdict     {verdict}"));
    let lowest = tests.iter().flat_map(|test| &test.directions).map(|d| d.order1).filter(|order| order.is_finite());
    let lowest = lowest.fold(f64::INFINITY, f64::min);
    let entries: Vec<Value> = tests.iter().map(entry).collect();
    let passed = wrong.is_empty();
    session.put("gradcheck", json!({ "passed": passed, "verdict": verdict, "lowest_order": lowest, "tests": entries }));
    if passed { Exit::Done } else { Exit::GradientWrong }
}

fn entry(test: &GradientTest) -> Value {
    let direction = |d: &TaylorDirection| {
        let rows: Vec<Value> =
            d.rows.iter().map(|row| json!({ "t": row.t, "r0": row.r0, "r1": row.r1, "used": row.used })).collect();
        json!({
            "slope": d.slope, "observed": d.observed, "noise": d.noise, "order0": d.order0, "order1": d.order1,
            "verdict": word(d.verdict), "rows": rows,
        })
    };
    let directions: Vec<Value> = test.directions.iter().map(direction).collect();
    json!({ "control": test.control, "term": test.term, "verdict": word(test.verdict()), "directions": directions })
}
