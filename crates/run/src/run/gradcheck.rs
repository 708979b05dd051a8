//! `nastic gradcheck`: do the derivative and the second derivative belong to the cost? Per control field and per cost term.

mod memo;

use crate::console::Console;
use crate::run::error::{Exit, RunError};
use crate::run::gradcheck::memo::{Column, Memo, Term};
use crate::run::session::{CommandFindings, Opened};
use crate::run::time_steps;
use nastic_case::lower::{Admitted, CaseProblem};
use nastic_ensemble::EnsembleError;
use nastic_language::number;
use nastic_numeric::format::scientific;
use nastic_opt::{Admissible, Failed, Objective, SecondOrder, Taylor, TaylorDirection, TaylorError, Verdict};
use nastic_report::record::{
    DirectionRecord, GradcheckRecord, RemainderRecord, SecondDirectionRecord, SecondGradcheckRecord, TermCheckRecord,
    numbers,
};

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
    /// Why there are no second derivatives, where there are none.
    pub without_second: Option<String>,
    /// By direction and step, how many samples of contacts touch, part, stick or slip other than at the control itself.
    pub changed: Vec<Vec<usize>>,
}

impl GradientTest {
    /// Wrong if any direction is; undecided if none can decide.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        let is = |verdict| self.directions.iter().any(|d| d.verdict == verdict);
        [Verdict::Wrong, Verdict::Right, Verdict::Linear].into_iter().find(|v| is(*v)).unwrap_or(Verdict::Undecided)
    }

    /// Whether the remainders that a direction is judged by lead over an onset of contact or slip, where second derivatives jump, and are not those of
    /// a smooth function; of the second derivative, or of the first.
    #[must_use]
    pub fn is_kink(&self, direction: usize, second: bool) -> bool {
        let (Some(d), Some(changed)) = (self.directions.get(direction), self.changed.get(direction)) else {
            return false;
        };
        let over = |row: usize| changed.get(row).is_some_and(|count| *count > 0);
        match (&d.second, second) {
            (Some(found), true) => {
                let mut rows = found.used.iter().map(|row| over(*row));
                match found.verdict {
                    // steps that lead over no onset show the error of a wrong one as well
                    Verdict::Wrong => !found.used.is_empty() && rows.all(|over| over),
                    Verdict::Undecided => rows.any(|over| over),
                    _ => false,
                }
            }
            (None, true) => false,
            (_, false) => {
                let judged = d.verdict == Verdict::Undecided && d.order1 < Taylor::default().order;
                judged && d.rows.iter().enumerate().any(|(row, of)| of.used && over(row))
            }
        }
    }

    fn has_kink(&self, second: bool) -> bool {
        (0..self.directions.len()).any(|direction| self.is_kink(direction, second))
    }

    /// The verdict on the second derivative; undecided at a kink; `None` where there is none.
    #[must_use]
    pub fn second_verdict(&self) -> Option<Verdict> {
        let of = |(k, d): (usize, &TaylorDirection)| {
            let found = d.second.as_ref()?.verdict;
            Some(if self.is_kink(k, true) { Verdict::Undecided } else { found })
        };
        let found: Vec<Verdict> = self.directions.iter().enumerate().filter_map(of).collect();
        let is = |verdict| found.contains(&verdict);
        let first = [Verdict::Wrong, Verdict::Right, Verdict::Quadratic].into_iter().find(|v| is(*v));
        (!found.is_empty()).then_some(first.unwrap_or(Verdict::Undecided))
    }
}

pub(super) fn run(opened: &mut Opened<'_>) -> Result<Exit, RunError> {
    opened.input.require(true, true)?;
    time_steps::find(opened)?;
    let Opened { input, destination, console, findings } = opened;
    let began = std::time::Instant::now();
    console.phase("solving at the start control");
    let memo = Memo::new(&input.problem.ensemble, &input.problem.start, ACCURACY);
    let memo = memo.map_err(|error| destination.evaluation_failed(input, &error))?;
    let mut tests = Vec::new();
    let blocks = input.problem.ensemble.blocks().iter().zip(&input.problem.controls);
    for (block, field) in blocks {
        console.phase(&format!("varying {}", field.name));
        let own = block.first..block.first + block.len;
        let taylor = Taylor {
            directions: DIRECTIONS,
            seed: input.problem.case.optimizer.seed.wrapping_add(1),
            size: size(&input.problem),
            components: Some(own),
            accuracy: ACCURACY,
            ..Taylor::default()
        };
        let found = test_field(&input.problem, &memo, &taylor, &field.name)?;
        console.clear();
        if input.is_cancelled() {
            return Err(RunError::Cancelled);
        }
        say(console, &field.name, &found);
        tests.extend(found);
    }
    let near_onset = memo.near_onset();
    findings.clock.note("gradient_check", began.elapsed().as_secs_f64());
    Ok(conclude(console, findings, &tests, near_onset))
}

fn test_field(
    problem: &CaseProblem,
    memo: &Memo<'_>,
    taylor: &Taylor,
    control: &str,
) -> Result<Vec<GradientTest>, TaylorError> {
    let test = |term: Term| -> Result<GradientTest, TaylorError> {
        let (label, column) = (term.label.clone(), Column { memo, term });
        let with = |taylor: &Taylor| -> Result<GradientTest, TaylorError> {
            let test = test_gradient(&column, &problem.set, &problem.start, taylor, control, &label)?;
            let changed = test.directions.iter().map(|d| changed(problem, memo, d)).collect();
            Ok(GradientTest { changed, ..test })
        };
        match with(&Taylor { second: true, ..taylor.clone() }) {
            // No state was solved before this was known.
            Err(TaylorError::Base(failed)) if lacks_second_derivatives(&failed) => {
                Ok(GradientTest { without_second: Some(failed.to_string()), ..with(taylor)? })
            }
            tested => tested,
        }
    };
    memo.terms().into_iter().map(test).collect()
}

/// By step along a direction, how many samples of contacts do something else than at the start.
fn changed(problem: &CaseProblem, memo: &Memo<'_>, along: &TaylorDirection) -> Vec<usize> {
    let mut m = problem.start.clone();
    let at = |t: f64| {
        problem.set.retract(&problem.start, &along.direction, t, &mut m);
        memo.changed(&m)
    };
    along.rows.iter().map(|row| row.t).map(at).collect()
}

fn lacks_second_derivatives(failed: &Failed) -> bool {
    failed.downcast_ref::<EnsembleError>().is_some_and(EnsembleError::lacks_second_derivatives)
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
    let (control, term) = (control.to_owned(), term.to_owned());
    Ok(GradientTest { control, term, directions: report.directions, without_second: None, changed: vec![] })
}

/// Size of a control where neither its set nor its values show: the law's bound on it, or the one bound it has.
pub(super) fn size(problem: &CaseProblem) -> Option<f64> {
    problem.controls.iter().find_map(|field| match field.admitted {
        Admitted::Between { .. } if field.log => Some(1.0),
        Admitted::Between { lower, upper } => {
            let bounds = [field.limit.unwrap_or(0.0), lower, upper];
            bounds.into_iter().map(f64::abs).find(|bound| *bound > 0.0 && bound.is_finite())
        }
        Admitted::Norm(norm) | Admitted::MaxNorm(norm) => Some(norm),
        Admitted::Any => None,
    })
}

fn say(console: &Console, control: &str, tests: &[GradientTest]) {
    let Some(first) = tests.first() else { return };
    let width = tests.iter().map(|test| test.term.chars().count()).max().unwrap_or(0).max(10);
    for k in 0..first.directions.len() {
        console.say("");
        console.say(format!(
            "control {control}, direction {} of {}: remainder |j(m + t d) - j(m) - t dj.d| by step t",
            k + 1,
            first.directions.len()
        ));
        let heads: Vec<String> = tests.iter().map(|test| format!("{:>width$}  ", test.term)).collect();
        console.say(format!("{:>8}  {}", "t", heads.concat()));
        for row in 0..first.directions[k].rows.len() {
            let t = first.directions[k].rows[row].t;
            let cells: Vec<String> = tests.iter().map(|test| cell(&test.directions[k], row, width)).collect();
            console.say(format!("{:>8}  {}", scientific(t, 1), cells.concat()));
        }
        let line = |name: &str, of: &dyn Fn(&TaylorDirection) -> String| {
            let cells: Vec<String> =
                tests.iter().map(|test| format!("{:>width$}  ", of(&test.directions[k]))).collect();
            console.say(format!("{name:>8}  {}", cells.concat()));
        };
        line("dj.d", &|d| scientific(d.slope, 3));
        line("order", &|d| order(d.order1));
        let verdicts = |second: bool, of: &dyn Fn(&TaylorDirection) -> String| {
            let cell = |test: &GradientTest| match test.is_kink(k, second) {
                true => format!("{KINK:>width$}  "),
                false => format!("{:>width$}  ", of(&test.directions[k])),
            };
            tests.iter().map(cell).collect::<Vec<_>>().concat()
        };
        console.say(format!("{:>8}  {}", "verdict", verdicts(false, &|d| word(d.verdict).to_owned())));
        say_changed(console, first, k);
        if tests.iter().any(|test| test.directions[k].second.is_some()) {
            let of = |d: &TaylorDirection, of: &dyn Fn(&SecondOrder) -> String| {
                d.second.as_ref().map_or_else(|| "-".to_owned(), of)
            };
            line("d.Hd", &|d| of(d, &|second| scientific(second.curvature, 3)));
            line("order", &|d| of(d, &|second| order(second.order)));
            let second = verdicts(true, &|d| of(d, &|second| word(second.verdict).to_owned()));
            console.say(format!("{:>8}  {second}", "second"));
        }
    }
}

/// From which step on samples of contacts do something else.
fn say_changed(console: &Console, test: &GradientTest, direction: usize) {
    let rows = test.directions[direction].rows.iter().zip(test.changed.get(direction).into_iter().flatten());
    if let Some((row, count)) = rows.filter(|(_, changed)| **changed > 0).last() {
        console.say(format!(
            "contacts    from a step of {} on {} do not touch, or slip, as at the start: second derivatives jump between",
            scientific(row.t, 1),
            number::count(*count, "sample")
        ));
    }
}

fn order(order: f64) -> String {
    if order.is_finite() { format!("{order:.3}") } else { "-".to_owned() }
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

const KINK: &str = "kink";

fn word(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Right => "right",
        Verdict::Wrong => "WRONG",
        Verdict::Linear => "linear",
        Verdict::Quadratic => "quadratic",
        Verdict::Undecided => "undecided",
    }
}

fn conclude(console: &Console, findings: &mut CommandFindings, tests: &[GradientTest], near_onset: usize) -> Exit {
    console.say("");
    console.say("Order 2 shows that the derivative belongs to the cost; * marks the remainders it is fitted to, those");
    console
        .say("at round-off are not judged. Order 3 of what the second derivative d.Hd leaves shows the same of that.");
    let first: Vec<_> = tests.iter().map(|test| (test, test.verdict())).collect();
    let second: Vec<_> = tests.iter().filter_map(|test| Some((test, test.second_verdict()?))).collect();
    let (verdict, second_verdict) = (summary(&first, 2, false), summary(&second, 3, true));
    console.say(format!("verdict     {verdict}"));
    let missing = tests.iter().find_map(|test| test.without_second.as_ref());
    let second_verdict = match (missing, second.is_empty()) {
        (Some(why), true) => format!("not tested: {why}"),
        (Some(why), false) => format!("{second_verdict}; not of every term: {why}"),
        (None, _) => second_verdict,
    };
    console.say(format!("second      {second_verdict}"));
    if near_onset > 0 {
        console.say(format!(
            "contacts    {} within 1 % of where they begin to touch or to slip: second derivatives jump there",
            number::count(near_onset, "sample")
        ));
    }
    let lowest = |orders: &mut dyn Iterator<Item = f64>| {
        let lowest = orders.filter(|order| order.is_finite()).fold(f64::INFINITY, f64::min);
        lowest.is_finite().then_some(lowest)
    };
    let directions = || tests.iter().flat_map(|test| &test.directions);
    let lowest_first = lowest(&mut directions().map(|d| d.order1));
    let lowest_second = lowest(&mut directions().filter_map(|d| Some(d.second.as_ref()?.order)));
    let right = |found: &[(&GradientTest, Verdict)]| found.iter().all(|(_, verdict)| *verdict != Verdict::Wrong);
    let (passed, second_passed) = (right(&first), right(&second));
    findings.record.gradcheck = Some(GradcheckRecord {
        passed,
        verdict,
        lowest_order: lowest_first.into(),
        second: SecondGradcheckRecord {
            passed: second_passed,
            verdict: second_verdict,
            lowest_order: lowest_second.into(),
        },
        near_onset,
        tests: tests.iter().map(record).collect(),
    });
    if passed && second_passed { Exit::Done } else { Exit::GradientWrong }
}

/// In words, of tests that should have this order.
fn summary(tests: &[(&GradientTest, Verdict)], order: usize, of_second: bool) -> String {
    let kinks = tests.iter().filter(|(test, _)| test.has_kink(of_second)).count();
    let of = |wanted| tests.iter().filter(move |(_, verdict)| *verdict == wanted);
    let wrong: Vec<String> = of(Verdict::Wrong).map(|(t, _)| format!("{} by {}", t.term, t.control)).collect();
    match (wrong.is_empty(), of(Verdict::Undecided).count()) {
        (false, _) => format!("WRONG: {}", wrong.join(", ")),
        (true, _) if kinks > 0 => format!(
            "a kink in {kinks} of {}: contacts begin or cease to touch or to slip within the steps, where second derivatives jump",
            tests.len()
        ),
        (true, 0) => format!("right: every order is {order}"),
        (true, n) if n == tests.len() => "undecided: no remainder stands clear of round-off".to_owned(),
        (true, n) => format!("right where it can be judged; {n} of {} undecided", tests.len()),
    }
}

fn record(test: &GradientTest) -> TermCheckRecord {
    TermCheckRecord {
        control: test.control.clone(),
        term: test.term.clone(),
        verdict: word(test.verdict()).to_owned(),
        second: test.second_verdict().map(|verdict| word(verdict).to_owned()).into(),
        kink: test.has_kink(false) || test.has_kink(true),
        directions: test.directions.iter().enumerate().map(|(k, d)| direction(test, k, d)).collect(),
    }
}

fn direction(test: &GradientTest, k: usize, d: &TaylorDirection) -> DirectionRecord {
    let changed = |row: usize| test.changed.get(k).and_then(|of| of.get(row)).copied().unwrap_or(0);
    let row = |(k, row): (usize, &nastic_opt::Row)| RemainderRecord {
        t: row.t.into(),
        r0: row.r0.into(),
        r1: row.r1.into(),
        used: row.used,
        changed: changed(k),
    };
    let second = |SecondOrder { curvature, remainders, used, order, verdict }: &SecondOrder| SecondDirectionRecord {
        curvature: (*curvature).into(),
        r2: numbers(remainders),
        used: used.clone(),
        order: (*order).into(),
        verdict: word(*verdict).to_owned(),
    };
    DirectionRecord {
        slope: d.slope.into(),
        observed: d.observed.into(),
        noise: d.noise.into(),
        order0: d.order0.into(),
        order1: d.order1.into(),
        verdict: word(d.verdict).to_owned(),
        rows: d.rows.iter().enumerate().map(row).collect(),
        second: d.second.as_ref().map(second).into(),
    }
}
