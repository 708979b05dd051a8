//! One state serves all terms: what was evaluated is kept by control vector.

use nastic_control::ControlError;
use nastic_ensemble::{Ensemble, EnsemblePoint, EnsembleWorkspace};
use nastic_fem::{Instant, Onsets, State, TimeStep};
use nastic_numeric::Random;
use nastic_numeric::vector::dot;
use nastic_opt::{Constrained, ConstraintGroup, Failed, Hessian, Objective, Request};
use std::sync::Mutex;

/// Of the weights of constraints.
const SEED: u64 = 1;

/// A functional that is tested.
#[derive(Clone, Debug)]
pub(super) struct Term {
    pub label: String,
    pub stage: usize,
    pub of: Functional,
}

/// What a test is of.
#[derive(Clone, Debug)]
pub(super) enum Functional {
    /// The whole cost.
    Cost,
    /// The expected value of the cost term of this name.
    Term(String),
    /// `y . c`, the values of one constraint weighed by fixed numbers between 0.5 and 1.5; y is zero for the others.
    Constraint(Vec<f64>),
}

/// The whole cost and its terms.
#[derive(Clone, Debug)]
struct Value {
    whole: f64,
    terms: Vec<(String, f64)>,
    constraints: Vec<f64>,
}

/// The values by stage at one control; none where there is no state.
type CostValues = Option<Vec<Value>>;

/// The problem around one control.
pub(super) struct Memo<'a> {
    ensemble: &'a Ensemble,
    accuracy: f64,
    /// The base control, valued by every stage.
    base: Vec<EnsemblePoint>,
    /// What samples of contacts do there.
    onsets: Onsets,
    known: Mutex<Known>,
}

/// What was evaluated so far, and the workspace of the next evaluation.
#[derive(Default)]
struct Known {
    values: Vec<(Vec<f64>, CostValues, Onsets)>,
    workspace: EnsembleWorkspace,
}

impl<'a> Memo<'a> {
    pub fn new(ensemble: &'a Ensemble, m: &[f64], accuracy: f64) -> Result<Self, Failed> {
        let mut known = Known::default();
        let how = Request { near: None, accuracy, stage: 0, ..Request::default() };
        let first = ensemble.evaluate(m, &how, &mut known.workspace)?;
        let later = (1..ensemble.stages()).map(|stage| ensemble.restage(stage, &first));
        let later = later.collect::<Result<Vec<_>, _>>()?;
        let onsets = onsets(ensemble, &first);
        let base = std::iter::once(first).chain(later).collect();
        Ok(Self { ensemble, accuracy, base, onsets, known: Mutex::new(known) })
    }

    /// How many samples of contacts are near to where they begin or cease to touch or to slip.
    pub fn near_onset(&self) -> usize {
        self.onsets.near
    }

    /// How many samples of contacts do something else at another control that was evaluated, over all instants.
    pub fn changed(&self, m: &[f64]) -> usize {
        let Ok(known) = self.known.lock() else { return 0 };
        let Some((.., there)) = known.values.iter().find(|(at, ..)| at == m) else { return 0 };
        self.onsets.states.iter().zip(&there.states).filter(|(here, there)| here != there).count()
    }

    /// The total of every stage, then every term of every stage it has, then every constraint.
    pub fn terms(&self) -> Vec<Term> {
        let all = self.values_of(&self.base[0]).terms;
        let names: Vec<&String> = all.iter().map(|(name, _)| name).collect();
        let stages = self.ensemble.stages();
        // With one state, one term is the total.
        let single = names.len() == 1 && self.ensemble.members().len() == 1;
        let whole = if single { names[0].as_str() } else { "total" };
        let mut out: Vec<Term> =
            (0..stages).map(|stage| Term { label: label(whole, stage, stages), stage, of: Functional::Cost }).collect();
        for name in names.into_iter().filter(|_| !single) {
            let own = self.stages_of(name);
            let term = |stage| Term { label: label(name, stage, own), stage, of: Functional::Term(name.clone()) };
            out.extend((0..own).map(term));
        }
        out.extend(self.constraints());
        out
    }

    /// Every constraint, in every stage that the maps of controls have.
    fn constraints(&self) -> Vec<Term> {
        let groups = self.ensemble.constraints();
        let all: usize = groups.iter().map(|group| group.len).sum();
        let (mut random, mut first) = (Random::new(SEED), 0);
        let stages = self.ensemble.members().iter().map(|part| part.problem().layout().stages()).max().unwrap_or(1);
        let mut of = |group: ConstraintGroup| {
            let mut y = vec![0.0; all];
            y[first..first + group.len].iter_mut().for_each(|y| *y = 0.5 + random.unit());
            first += group.len;
            let name = format!("constraint {}", group.name);
            let term =
                move |stage| Term { label: label(&name, stage, stages), stage, of: Functional::Constraint(y.clone()) };
            (0..stages).map(term)
        };
        groups.into_iter().flat_map(&mut of).collect()
    }

    /// The most stages that a term of this name has.
    fn stages_of(&self, name: &str) -> usize {
        let of = |part: &nastic_ensemble::Member| {
            let problem = part.problem();
            let own = problem.term_names().iter().position(|term| term == name)?;
            // costs of a motion stand behind those of states, and have one stage
            let of_cost = problem.costs().get(own).map_or(1, |cost| cost.stages());
            Some(of_cost.max(problem.layout().stages()))
        };
        self.ensemble.members().iter().filter_map(of).max().unwrap_or(1)
    }

    fn values_of(&self, point: &EnsemblePoint) -> Value {
        let terms = self.ensemble.expected_terms(point.members.iter().map(|at| at.terms.as_slice()));
        Value { whole: point.risk, terms, constraints: self.ensemble.constraint_values(point) }
    }

    fn values(&self, m: &[f64]) -> CostValues {
        if m == self.base[0].m.as_slice() {
            return Some(self.base.iter().map(|point| self.values_of(point)).collect());
        }
        let mut known = self.known.lock().ok()?;
        if let Some((_, values, _)) = known.values.iter().find(|(at, ..)| at == m) {
            return values.clone();
        }
        let (values, onsets) = self.evaluate(m, &mut known.workspace).unzip();
        known.values.push((m.to_vec(), values.clone(), onsets.unwrap_or_default()));
        values
    }

    fn evaluate(&self, m: &[f64], workspace: &mut EnsembleWorkspace) -> Option<(Vec<Value>, Onsets)> {
        let how = Request { near: Some(&self.base[0]), accuracy: self.accuracy, stage: 0, ..Request::default() };
        let first = self.ensemble.evaluate(m, &how, workspace).ok()?;
        let mut out = vec![self.values_of(&first)];
        for stage in 1..self.ensemble.stages() {
            out.push(self.values_of(&self.ensemble.restage(stage, &first).ok()?));
        }
        Some((out, onsets(self.ensemble, &first)))
    }
}

fn label(name: &str, stage: usize, of: usize) -> String {
    if of > 1 { format!("{name}, stage {}", stage + 1) } else { name.to_owned() }
}

/// What samples of contacts do, over all members and instants.
fn onsets(ensemble: &Ensemble, point: &EnsemblePoint) -> Onsets {
    let mut all = Onsets::default();
    for (member, at) in ensemble.members().iter().zip(&point.members) {
        let (problem, mut before) = (member.problem(), None::<State>);
        let model = problem.solid().model();
        if model.contacts().parameters().is_empty() {
            continue;
        }
        let each = &mut |_: usize, state: &State| {
            let step = before.as_ref().map(|before| TimeStep::between(before, state));
            let instant = Instant::of(state);
            let found = model.contacts().onsets(&step.as_ref().map_or(instant, |step| instant.in_step(step)));
            all.states.extend(found.states);
            all.near += found.near;
            before = Some(state.clone());
            Ok::<(), ControlError>(())
        };
        // what cannot be computed again is not compared
        let _ = problem.for_each_state(at, each);
    }
    all
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
    type Workspace = ();

    fn evaluate(&self, m: &[f64], _: &Request<'_, Valued>, (): &mut ()) -> Result<Valued, Failed> {
        let values = self.memo.values(m).ok_or_else(|| Failed::because("no state there"))?;
        let value = &values[self.term.stage];
        let term = |name: &String| value.terms.iter().find(|(known, _)| known == name).map(|(_, value)| *value);
        let value = match &self.term.of {
            Functional::Cost => value.whole,
            Functional::Term(name) => term(name).ok_or_else(|| Failed::because(format!("no term {name}")))?,
            Functional::Constraint(y) => dot(y, &value.constraints),
        };
        Ok(Valued { m: m.to_vec(), value })
    }

    fn value(&self, point: &Valued) -> f64 {
        point.value
    }

    fn derivative(&self, point: &mut Valued, (): &mut ()) -> Result<Vec<f64>, Failed> {
        let (base, ensemble) = (&self.memo.base[self.term.stage], self.memo.ensemble);
        if point.m != base.m {
            return Err(Failed::because("derivatives are kept at the base control alone"));
        }
        let mut known = self.memo.known.lock().map_err(|_| Failed::because("an earlier evaluation broke off"))?;
        match &self.term.of {
            Functional::Cost => ensemble.derivative(&mut base.clone(), &mut known.workspace),
            Functional::Term(name) => Ok(ensemble.derivative_of_term(base, name, &mut known.workspace)?),
            Functional::Constraint(y) => Ok(ensemble.constraint_derivative(base, y, &mut known.workspace)?),
        }
    }

    fn hessian_vector(&self, point: &Valued, v: &[f64], which: Hessian, (): &mut ()) -> Result<Vec<f64>, Failed> {
        let (base, ensemble) = (&self.memo.base[self.term.stage], self.memo.ensemble);
        if point.m != base.m {
            return Err(Failed::because("derivatives are kept at the base control alone"));
        }
        let mut known = self.memo.known.lock().map_err(|_| Failed::because("an earlier evaluation broke off"))?;
        match &self.term.of {
            Functional::Cost => Objective::hessian_vector(ensemble, base, v, which, &mut known.workspace),
            Functional::Constraint(y) => {
                Ok(ensemble.constraint_hessian_vector(base, y, v, which, &mut known.workspace)?)
            }
            Functional::Term(_) if which != Hessian::Exact => {
                Err(Failed::because("of a single term there is the exact one alone"))
            }
            Functional::Term(name) => Ok(ensemble.hessian_vector_of_term(base, name, v, &mut known.workspace)?),
        }
    }

    fn restage(&self, _: usize, point: &Valued) -> Result<Valued, Failed> {
        Ok(Valued { m: point.m.clone(), value: point.value })
    }
}
