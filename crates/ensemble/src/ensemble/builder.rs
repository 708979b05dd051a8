//! [`EnsembleBuilder`]: scenarios and load cases, one after the other.

use super::{Ensemble, Finished, Watch};
use crate::blocks::enter;
use crate::error::EnsembleError;
use crate::first_order::FirstOrder;
use crate::member::{LoadCase, Member};
use crate::product::EnsembleProduct;
use crate::ranks::Ranks;
use nastic_control::{ControlError, Reduced, inner_product};
use nastic_uncertainty::risk::Risk;
use std::collections::BTreeSet;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex};

/// What [`Ensemble::new`] begins. Nothing is checked before [`build`](Self::build).
#[derive(Debug)]
pub struct EnsembleBuilder {
    risk: Box<dyn Risk>,
    first_order: Option<FirstOrder>,
    scenarios: Vec<(String, f64, Vec<LoadCase>)>,
    watch: Watch,
    cancel: Option<Arc<AtomicBool>>,
    keep_factors: bool,
}

/// Name of the one scenario of a problem that has load cases alone.
const ALONE: &str = "";

impl EnsembleBuilder {
    pub(super) fn new(risk: Box<dyn Risk>) -> Self {
        EnsembleBuilder {
            risk,
            first_order: None,
            scenarios: vec![],
            watch: Watch(None),
            cancel: None,
            keep_factors: true,
        }
    }

    /// Adds a scenario of one problem.
    pub fn scenario(self, name: &str, probability: f64, problem: Reduced) -> Self {
        self.scenario_of(name, probability, vec![LoadCase::new("", 1.0, problem)])
    }

    /// Adds a scenario of several load cases; its cost is their weighted sum.
    pub fn scenario_of(mut self, name: &str, probability: f64, cases: Vec<LoadCase>) -> Self {
        self.scenarios.push((name.to_owned(), probability, cases));
        self
    }

    /// Adds load cases without uncertainty: one scenario of probability one.
    pub fn load_cases(self, cases: Vec<LoadCase>) -> Self {
        self.scenario_of(ALONE, 1.0, cases)
    }

    /// Calls `watch` after every evaluated member, from the thread that computed it, in no particular order.
    pub fn watched_by(mut self, watch: impl Fn(&Finished) + Send + Sync + 'static) -> Self {
        self.watch = Watch(Some(Arc::new(watch)));
        self
    }

    /// A flag that ends the state solves of all members.
    pub fn cancelled_by(mut self, flag: Arc<AtomicBool>) -> Self {
        self.cancel = Some(flag);
        self
    }

    /// Whether the workspace keeps a factor per member for the next solve (the default). Without,
    /// memory does not grow by factors, and every solve makes its own: for samples that are evaluated once.
    pub fn keep_factors(mut self, keep: bool) -> Self {
        self.keep_factors = keep;
        self
    }

    /// Adds the deviation to first order in the uncertain numbers of its members, which are the load cases of one scenario.
    #[must_use]
    pub fn first_order(self, first_order: FirstOrder) -> Self {
        EnsembleBuilder { first_order: Some(first_order), ..self }
    }

    /// Checks all members and joins their controls.
    ///
    /// # Errors
    /// Members that are incomplete or share a control they do not agree about; names given twice; probabilities that do
    /// not fit the risk measure.
    pub fn build(self) -> Result<Ensemble, EnsembleError> {
        self.check_names()?;
        let probabilities: Vec<f64> = self.scenarios.iter().map(|(_, p, _)| *p).collect();
        self.risk.check(&probabilities)?;
        self.check_first_order()?;
        let alone = self.scenarios.iter().map(|(_, _, cases)| cases.len()).sum::<usize>() == 1;
        let (mut members, mut blocks, mut names) = (Vec::new(), Vec::new(), Vec::new());
        for (scenario, (name, _, cases)) in self.scenarios.into_iter().enumerate() {
            for case in cases {
                // One member without a name needs none in messages.
                let own =
                    if name.is_empty() && case.name.is_empty() { String::new() } else { label(&name, &case.name) };
                // its members are solved in an order of each process's own, by which messages between ranks cannot go
                let whole =
                    case.problem.solid().model().ranks().refuse_ranks("an ensemble").map_err(ControlError::from);
                let fields = whole.and_then(|()| field_names(&case)).map_err(|e| EnsembleError::member(&own, e))?;
                let mut member = Member {
                    name: own,
                    case: case.name,
                    scenario,
                    weight: case.weight,
                    problem: prepared(case.problem, alone, self.cancel.as_ref(), self.keep_factors),
                    blocks: vec![],
                };
                enter(&mut blocks, &members, &mut member, fields)?;
                members.push(member);
            }
            names.push(name);
        }
        // Only the inner products of owners are used, so only theirs are built.
        let mut products = Vec::new();
        for (index, member) in members.iter().enumerate() {
            let failed = |e| EnsembleError::member(&member.name, e);
            member.problem.check_body().map_err(failed)?;
            if blocks.iter().any(|block| block.owner == index) {
                let (problem, of) = (&member.problem, member.problem.metric_kind());
                products.push((index, inner_product(problem.solid(), problem.layout(), of).map_err(failed)?));
            }
        }
        let len = blocks.iter().map(|block| block.len).sum();
        let product = Arc::new(EnsembleProduct::new(&blocks, &members, products));
        let (risk, first_order, watch) = (self.risk, self.first_order, self.watch);
        let (ranks, kept) = (Ranks::alone(members.len()), Mutex::default());
        Ok(Ensemble { members, names, probabilities, blocks, len, risk, first_order, product, watch, ranks, kept })
    }

    fn check_first_order(&self) -> Result<(), EnsembleError> {
        let Some(of) = &self.first_order else { return Ok(()) };
        if self.scenarios.len() > 1 {
            let what = format!("{} scenarios; it has the load cases of one", self.scenarios.len());
            return Err(EnsembleError::FirstOrder { who: String::new(), what });
        }
        let mut cases = self.scenarios.iter().flat_map(|(_, _, cases)| cases);
        cases.try_for_each(|case| {
            case.problem
                .check_uncertain()
                .map_err(|e| EnsembleError::FirstOrder { who: case.name.clone(), what: e.to_string() })?;
            of.check(&case.name, &case.problem.uncertain_numbers())
        })
    }

    fn check_names(&self) -> Result<(), EnsembleError> {
        if self.scenarios.is_empty() {
            return Err(EnsembleError::Empty { what: "the ensemble".into() });
        }
        let mut seen = BTreeSet::new();
        for (scenario, probability, cases) in &self.scenarios {
            if !seen.insert(label(scenario, "")) {
                return Err(EnsembleError::Twice { name: scenario.clone() });
            }
            if !probability.is_finite() {
                return Err(EnsembleError::Weight { who: label(scenario, ""), weight: *probability });
            }
            if cases.is_empty() {
                return Err(EnsembleError::Empty { what: label(scenario, "") });
            }
            let mut seen = BTreeSet::new();
            for case in cases {
                let who = label(scenario, &case.name);
                if !(case.weight.is_finite() && case.weight > 0.0) {
                    return Err(EnsembleError::Weight { who, weight: case.weight });
                }
                if !seen.insert(&case.name) {
                    return Err(EnsembleError::Twice { name: who });
                }
            }
        }
        Ok(())
    }
}

/// Members run side by side, each on one thread; a single one may have them all.
fn prepared(problem: Reduced, alone: bool, cancel: Option<&Arc<AtomicBool>>, keep_factors: bool) -> Reduced {
    let problem = if alone { problem } else { problem.sequential().share_equal_parts() };
    let problem = if keep_factors { problem } else { problem.keep_factors(false) };
    match cancel {
        Some(flag) => problem.cancelled_by(flag.clone()),
        None => problem,
    }
}

fn label(scenario: &str, case: &str) -> String {
    match (scenario, case) {
        ("", "") => "the load cases".into(),
        (name, "") | ("", name) => name.into(),
        (scenario, case) => format!("{scenario}/{case}"),
    }
}

/// Names of a load case's control fields in the ensemble.
fn field_names(case: &LoadCase) -> Result<Vec<String>, ControlError> {
    let layout = case.problem.layout();
    for own in &case.own {
        layout.block(own)?;
    }
    let name = |own: bool, name: &str| if own { format!("{}/{name}", case.name) } else { name.to_owned() };
    Ok(layout.blocks().iter().map(|block| name(case.own.contains(&block.name), &block.name)).collect())
}
