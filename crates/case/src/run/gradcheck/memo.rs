//! One state serves all terms: what was evaluated is kept by control vector.

use nastic_control::{ControlError, Evaluated, Reduced};
use nastic_opt::{Failed, Objective, Request};
use std::sync::Mutex;

/// Part of the cost.
#[derive(Clone, Debug)]
pub(super) struct Term {
    pub label: String,
    pub stage: usize,
    /// Number of the term; all of them if absent.
    pub of: Option<usize>,
}

/// The terms of the cost by stage at one control; none where there is no state.
type Values = Option<Vec<Vec<f64>>>;

/// The reduced problem around one control.
pub(super) struct Memo<'a> {
    reduced: &'a Reduced,
    accuracy: f64,
    /// The base control, valued by every stage.
    base: Vec<Evaluated>,
    known: Mutex<Vec<(Vec<f64>, Values)>>,
}

impl<'a> Memo<'a> {
    pub fn new(reduced: &'a Reduced, m: &[f64], accuracy: f64) -> Result<Self, ControlError> {
        let first = reduced.try_evaluate(m, &Request { near: None, accuracy, stage: 0 })?;
        let refuse = |failed: Failed| ControlError::Cost { what: failed.why };
        let later = (1..reduced.stages()).map(|stage| reduced.restage(stage, &first).map_err(refuse));
        let later = later.collect::<Result<Vec<_>, _>>()?;
        let base = std::iter::once(first).chain(later).collect();
        Ok(Self { reduced, accuracy, base, known: Mutex::new(vec![]) })
    }

    /// The total of every stage, then every term of every stage it has.
    pub fn terms(&self) -> Vec<Term> {
        let names = self.reduced.term_names();
        let stages = self.reduced.stages();
        let label = |name: &str, stage: usize, of: usize| {
            if of > 1 { format!("{name}, stage {}", stage + 1) } else { name.to_owned() }
        };
        let single = names.len() == 1;
        let whole = if single { names[0].as_str() } else { "total" };
        let mut out: Vec<Term> =
            (0..stages).map(|stage| Term { label: label(whole, stage, stages), stage, of: None }).collect();
        for (k, cost) in self.reduced.costs().iter().enumerate().filter(|_| !single) {
            let own = cost.stages();
            out.extend((0..own).map(|stage| Term { label: label(&names[k], stage, own), stage, of: Some(k) }));
        }
        out
    }

    fn values(&self, m: &[f64]) -> Values {
        if m == self.base[0].m.as_slice() {
            return Some(self.base.iter().map(|point| point.terms.clone()).collect());
        }
        let find = |known: &[(Vec<f64>, Values)]| known.iter().find(|(at, _)| at == m).map(|(_, v)| v.clone());
        if let Some(values) = self.known.lock().ok().and_then(|known| find(&known)) {
            return values;
        }
        let values = self.evaluate(m);
        if let Ok(mut known) = self.known.lock() {
            known.push((m.to_vec(), values.clone()));
        }
        values
    }

    fn evaluate(&self, m: &[f64]) -> Values {
        let how = Request { near: Some(&self.base[0]), accuracy: self.accuracy, stage: 0 };
        let first = self.reduced.try_evaluate(m, &how).ok()?;
        let mut out = vec![first.terms.clone()];
        for stage in 1..self.reduced.stages() {
            out.push(self.reduced.restage(stage, &first).ok()?.terms);
        }
        Some(out)
    }
}

/// One part of the cost as an objective.
pub(super) struct Column<'a> {
    pub memo: &'a Memo<'a>,
    pub term: Term,
}

/// A control and the value there.
pub(super) struct Valued {
    m: Vec<f64>,
    value: f64,
}

impl Objective for Column<'_> {
    type Point = Valued;

    fn evaluate(&self, m: &[f64], _: &Request<'_, Valued>) -> Result<Valued, Failed> {
        let values = self.memo.values(m).ok_or_else(|| Failed::new("no state there"))?;
        let terms = &values[self.term.stage];
        let value = self.term.of.map_or_else(|| terms.iter().sum(), |k| terms[k]);
        Ok(Valued { m: m.to_vec(), value })
    }

    fn value(&self, point: &Valued) -> f64 {
        point.value
    }

    fn derivative(&self, point: &Valued) -> Result<Vec<f64>, Failed> {
        let base = &self.memo.base[self.term.stage];
        if point.m != base.m {
            return Err(Failed::new("derivatives are kept at the base control alone"));
        }
        self.memo.reduced.derivative_of(base, self.term.of).map_err(|error| Failed::new(error.to_string()))
    }

    fn restage(&self, _: usize, point: &Valued) -> Result<Valued, Failed> {
        Ok(Valued { m: point.m.clone(), value: point.value })
    }
}
