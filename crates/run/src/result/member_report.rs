//! States of all members as results show them.

use crate::result::inspection::Inspection;
use crate::result::summary;
use nastic_case::lower::{CaseMember, CaseProblem, LocatedProbe};
use nastic_control::{ControlError, CostPoint, EnsemblePoint};
use nastic_fem::{SolveReport, State};
use nastic_uncertainty::risk::deviation;
use rayon::prelude::*;
use serde_json::{Map, Value, json};
use std::borrow::Cow;
use std::sync::Arc;

/// A state of one member, with the values of its costs.
pub(crate) struct MemberReport<'a> {
    pub member: CaseMember<'a>,
    pub state: &'a State,
    /// Values of its cost terms; empty without costs.
    pub terms: Vec<f64>,
    /// The terms themselves, evaluated.
    pub costs: Cow<'a, [Arc<dyn CostPoint>]>,
    pub stage: usize,
    pub work: SolveReport,
    /// The smallest J, of a motion over all its states.
    pub min_j: f64,
    /// What was found in the state; nothing where only costs are told.
    pub inspection: Option<&'a Inspection>,
}

/// How much is told of a state.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Detail {
    /// The costs alone.
    Costs,
    /// All there is.
    Full,
}

/// What could not be told of a member.
pub(crate) type MemberError = (usize, ControlError);

/// The states of an evaluated control, with the work of its evaluation.
pub(crate) fn of_point<'a>(
    problem: &'a CaseProblem,
    point: &'a EnsemblePoint,
) -> Result<Vec<MemberReport<'a>>, MemberError> {
    let of = |(member, at): (CaseMember<'a>, &'a nastic_control::Evaluated)| {
        let costs = member.reduced().costs_of(at).map_err(|error| (member.index(), error))?;
        let (terms, work) = (at.terms.clone(), at.total_work());
        let min_j = at.min_j();
        Ok(MemberReport { member, state: at.state(), terms, costs, stage: at.stage, work, min_j, inspection: None })
    };
    problem.members().zip(&point.members).map(of).collect()
}

/// The same, with what was found in the states.
pub(crate) fn of_inspected<'a>(
    problem: &'a CaseProblem,
    point: &'a EnsemblePoint,
    inspections: &'a [Inspection],
) -> Result<Vec<MemberReport<'a>>, MemberError> {
    let mut reports = of_point(problem, point)?;
    reports.iter_mut().zip(inspections).for_each(|(one, found)| one.inspection = Some(found));
    Ok(reports)
}

/// All entries of a result: of a plain case those of its one state, else what holds for all members and, under
/// `scenarios` and `load_cases`, those of each.
pub(crate) fn entries(
    problem: &CaseProblem,
    reports: &[MemberReport<'_>],
    detail: Detail,
) -> Result<Map<String, Value>, MemberError> {
    let own: Vec<Map<String, Value>> =
        reports.par_iter().with_max_len(1).map(|one| entry(one, detail)).collect::<Result<_, _>>()?;
    if problem.is_plain() {
        return Ok(own.into_iter().next().unwrap_or_default());
    }
    let mut out = Map::new();
    let costs = costs(problem, reports);
    if problem.has_costs() {
        out.insert("stage".into(), json!(reports.iter().map(|one| one.stage).max()));
        let terms = problem.ensemble.expected_terms(reports.iter().map(|one| one.terms.as_slice()));
        let terms: Map<String, Value> = terms.into_iter().map(|(name, value)| (name, json!(value))).collect();
        let total = problem.ensemble.risk().value(problem.ensemble.probabilities(), &costs);
        out.insert("cost".into(), json!({ "total": total, "terms": terms }));
        if problem.has_scenarios() {
            out.insert("risk".into(), risk(problem, &costs));
        }
    }
    if detail == Detail::Full {
        out.extend(overall(&own, reports));
        if problem.has_scenarios() && !problem.probes.is_empty() {
            out.insert("probes".into(), probes(problem, reports));
        }
    }
    out.extend(tree(problem, &costs, own));
    Ok(out)
}

/// Cost of every scenario.
fn costs(problem: &CaseProblem, reports: &[MemberReport<'_>]) -> Vec<f64> {
    let mut out = vec![0.0; problem.ensemble.scenarios().len()];
    for one in reports {
        let part = one.member.part();
        out[part.scenario()] += part.weight() * one.terms.iter().sum::<f64>();
    }
    out
}

fn entry(one: &MemberReport<'_>, detail: Detail) -> Result<Map<String, Value>, MemberError> {
    let mut out = Map::new();
    if !one.terms.is_empty() {
        out.insert("stage".into(), json!(one.stage));
        out.insert("cost".into(), summary::cost(one));
        let told = [
            ("hausdorff", summary::hausdorff(one.member, &one.costs)),
            ("tracking", summary::tracking(one.member, &one.costs)),
            ("figures", summary::figures(one.member, &one.costs)),
        ];
        for (key, figures) in told {
            let figures = figures.map_err(|error| (one.member.index(), error))?;
            out.extend((!figures.is_empty()).then(|| (key.to_owned(), Value::Object(figures))));
        }
    }
    if detail == Detail::Full {
        out.extend(summary::state(one.member, one.state));
        out.insert("min_J".into(), json!(one.min_j));
        if let Some(found) = one.inspection {
            out.insert("inertia".into(), json!(found.inertia.as_ref().ok()));
            if let Err(uncounted) = &found.inertia {
                out.insert("inertia_missing".into(), uncounted.json());
            }
            out.insert("self_intersection".into(), found.intersection_json());
        }
        out.extend(summary::work(&one.work));
    }
    Ok(out)
}

/// `{ "measure", "value", "deviation", "measures": { NAME: { "value", "exact", "level" } } }`
fn risk(problem: &CaseProblem, costs: &[f64]) -> Value {
    let ensemble = &problem.ensemble;
    let (name, p) = (ensemble.risk().name(), ensemble.probabilities());
    let measures: Map<String, Value> = ensemble
        .risks_of(costs)
        .into_iter()
        .map(|measured| {
            let mut entry = json!({ "value": measured.value, "exact": measured.exact });
            if let Some(level) = measured.level {
                entry["level"] = json!(level);
            }
            (measured.name.to_owned(), entry)
        })
        .collect();
    json!({
        "measure": name, "value": ensemble.risk().value(p, costs), "deviation": deviation(p, costs),
        "measures": measures,
    })
}

/// Of all members together: the worst of states, the sum of work.
fn overall(own: &[Map<String, Value>], reports: &[MemberReport<'_>]) -> Map<String, Value> {
    let mut work = SolveReport::default();
    reports.iter().for_each(|one| work.add_work(&one.work));
    let min_j = reports.iter().map(|one| one.min_j).fold(f64::INFINITY, f64::min);
    let residual = reports.iter().map(|one| one.state.report.residual).fold(0.0, f64::max);
    // One member without a number leaves none for all.
    let inertia: Option<Vec<u64>> = own.iter().map(|entry| entry.get("inertia").and_then(Value::as_u64)).collect();
    let mut out = Map::new();
    out.insert("min_J".into(), json!(min_j));
    out.insert("residual".into(), json!(residual));
    out.insert("inertia".into(), json!(inertia.and_then(|all| all.into_iter().max())));
    if let Some(why) = own.iter().find_map(|entry| entry.get("inertia_missing")) {
        out.insert("inertia_missing".into(), why.clone());
    }
    out.extend(summary::work(&work));
    out
}

/// Probes over the scenarios: `{ NAME: { "point", "displacement", "position", "deviation" } }`, the expected values of displacement and
/// position and the standard deviations of their components; with load cases `{ CASE: { NAME: .. } }`.
fn probes(problem: &CaseProblem, reports: &[MemberReport<'_>]) -> Value {
    let (p, dim) = (problem.ensemble.probabilities(), problem.mesh().dim());
    let of_case = |load_case: Option<&str>| {
        let own: Vec<&MemberReport<'_>> = reports.iter().filter(|one| one.member.load_case() == load_case).collect();
        let of = |probe: &LocatedProbe| {
            let moved: Vec<[f64; 3]> = own.iter().map(|one| probe.displacement(&one.state.u, dim)).collect();
            let component = |c: usize| moved.iter().map(|u| u[c]).collect::<Vec<f64>>();
            let mean: [f64; 3] = std::array::from_fn(|c| component(c).iter().zip(p).map(|(u, p)| p * u).sum());
            let position: [f64; 3] = std::array::from_fn(|c| probe.point[c] + mean[c]);
            let spread: [f64; 3] = std::array::from_fn(|c| deviation(p, &component(c)));
            let entry =
                json!({ "point": probe.point, "displacement": mean, "position": position, "deviation": spread });
            (probe.name.clone(), entry)
        };
        Value::Object(problem.probes.iter().map(of).collect())
    };
    let of_lead = |lead: CaseMember<'_>| Some((lead.load_case()?.to_owned(), of_case(lead.load_case())));
    let by_case: Map<String, Value> = problem.leads().filter_map(of_lead).collect();
    if by_case.is_empty() { of_case(None) } else { Value::Object(by_case) }
}

/// The entries of all members by scenario and load case.
fn tree(problem: &CaseProblem, costs: &[f64], own: Vec<Map<String, Value>>) -> Map<String, Value> {
    let mut scenarios: Vec<Map<String, Value>> = costs.iter().map(|_| Map::new()).collect();
    for (member, entry) in problem.members().zip(own) {
        let scenario = &mut scenarios[member.part().scenario()];
        match member.load_case() {
            None => scenario.extend(entry),
            Some(name) => {
                let mut with_weight = Map::from_iter([("weight".to_owned(), json!(member.part().weight()))]);
                with_weight.extend(entry);
                let cases = scenario.entry("load_cases").or_insert_with(|| json!({}));
                cases[name] = Value::Object(with_weight);
            }
        }
    }
    if !problem.has_scenarios() {
        return scenarios.into_iter().next().unwrap_or_default();
    }
    let ensemble = &problem.ensemble;
    let head = |k: usize| {
        let mut out = Map::new();
        out.insert("probability".into(), json!(ensemble.probabilities()[k]));
        out.insert("set".into(), Value::Object(problem.differences(k).clone()));
        if problem.has_costs() {
            out.insert("cost".into(), json!({ "total": costs[k] }));
        }
        out
    };
    let entry = |(k, entry): (usize, Map<String, Value>)| {
        let mut out = head(k);
        out.extend(entry);
        (ensemble.scenarios()[k].clone(), Value::Object(out))
    };
    let all: Map<String, Value> = scenarios.into_iter().enumerate().map(entry).collect();
    Map::from_iter([("scenarios".to_owned(), Value::Object(all))])
}
