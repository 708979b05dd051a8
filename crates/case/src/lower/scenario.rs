//! [`Scenario`]: one of those that a control must serve, and the measure of risk over them.

use super::uncertain::Uncertain;
use nastic_language::schema::{Case, Risk as RiskBlock};
use nastic_language::syntax::{At, Setting};
use nastic_uncertainty::risk::{Cvar, Mean, MeanDeviation, Risk, WorstCase};
use serde_json::{Map, Value};
use std::sync::Arc;

/// One scenario: how likely it is, and what differs in it.
#[derive(Clone, Debug)]
pub(super) struct Scenario {
    /// `None` for the one scenario of a case without scenarios.
    pub name: Option<String>,
    pub probability: f64,
    pub settings: Vec<Setting>,
    /// Random fields: the parameter, and its values by cell.
    pub fields: Vec<(String, Arc<[f64]>)>,
    /// Random parameters that are held at their medians.
    pub uncertain: Arc<Vec<Uncertain>>,
    /// What differs, for results.
    pub values: Map<String, Value>,
}

/// The measure of risk.
pub(super) fn risk(case: &Case) -> Box<dyn Risk> {
    match &case.risk {
        // that of first order is the mean of one scenario, and more
        RiskBlock::Mean | RiskBlock::FirstOrder(_) => Box::new(Mean),
        RiskBlock::MeanDeviation(block) => Box::new(MeanDeviation { lambda: block.lambda }),
        RiskBlock::ConditionalValueAtRisk(block) => Box::new(Cvar { level: block.level, smoothing: block.smoothing }),
        RiskBlock::WorstCase(block) => Box::new(WorstCase { smoothing: block.smoothing }),
    }
}

/// Where the measure of risk stands in the case, or would.
pub(super) fn risk_at(case: &Case) -> At {
    let key = if case.risk == RiskBlock::Mean { "scenarios" } else { "risk" };
    At::root().key(key)
}
