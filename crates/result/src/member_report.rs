//! States of all members as results show them.

use crate::inspection::{Inspection, Uncounted};
use crate::summary;
use nastic_case::lower::{CaseMember, CaseProblem, LocatedProbe};
use nastic_control::{ControlError, CostPoint, DistanceInTime};
use nastic_ensemble::{EnsemblePoint, FirstOrderPoint, Measured, VarianceShare};
use nastic_fem::{SolveReport, State};
use nastic_report::record::{
    ByName, CostRecord, FirstOrderRecord, MeasureRecord, ProbeRecord, ProbesRecord, RiskRecord, SourceRecord,
    StateRecord, numbers,
};
use nastic_uncertainty::risk::deviation;
use rayon::prelude::*;
use std::borrow::Cow;
use std::sync::Arc;

/// A state of one member, with the values of its costs.
pub struct MemberReport<'a> {
    /// The member.
    pub member: CaseMember<'a>,
    /// Its state, of a motion at the end.
    pub state: &'a State,
    /// Values of its cost terms; empty without costs.
    pub terms: Vec<f64>,
    /// The terms themselves, evaluated.
    pub costs: Cow<'a, [Arc<dyn CostPoint>]>,
    /// Of a motion by term the distances over its instants, of positions with a target.
    pub distances: Vec<Option<DistanceInTime>>,
    /// The stage of the values.
    pub stage: usize,
    /// Work of the state and of the adjoint.
    pub work: SolveReport,
    /// The smallest J, of a motion over all its states.
    pub min_j: f64,
    /// Of a risk of first order that of the point.
    pub first_order: Option<&'a FirstOrderPoint>,
    /// What was found in the state; nothing where only costs are reported.
    pub inspection: Option<&'a Inspection>,
}

/// How much is reported of a state.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Detail {
    /// The costs alone.
    Costs,
    /// All there is.
    Full,
}

/// What could not be reported of a member.
pub type MemberError = (usize, ControlError);

/// The states of an evaluated control, with the work of its evaluation.
///
/// # Errors
/// The number of a member and why it could not be reported.
pub fn of_point<'a>(problem: &'a CaseProblem, point: &'a EnsemblePoint) -> Result<Vec<MemberReport<'a>>, MemberError> {
    let of = |(member, at): (CaseMember<'a>, &'a nastic_control::Evaluated)| {
        let failed = |error: ControlError| (member.index(), error);
        let costs = member.reduced().costs_of(at).map_err(failed)?;
        let distances = member.reduced().distances_in_time(at).map_err(failed)?;
        let (terms, work) = (at.terms.clone(), at.total_work());
        let min_j = at.min_j();
        let (state, stage) = (at.state(), at.stage);
        let first_order = point.first_order.as_ref();
        Ok(MemberReport { member, state, terms, costs, distances, stage, work, min_j, first_order, inspection: None })
    };
    problem.members().zip(&point.members).map(of).collect()
}

/// The same, with what was found in the states.
///
/// # Errors
/// The number of a member and why it could not be reported.
pub fn of_inspected<'a>(
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
///
/// # Errors
/// The number of a member and why it could not be reported.
pub fn entries(
    problem: &CaseProblem,
    reports: &[MemberReport<'_>],
    detail: Detail,
) -> Result<StateRecord, MemberError> {
    let own: Vec<StateRecord> =
        reports.par_iter().with_max_len(1).map(|one| entry(one, detail)).collect::<Result<_, _>>()?;
    if problem.is_plain() {
        let mut lone = own.into_iter().next().unwrap_or_default();
        add_first_order(&mut lone, problem, reports);
        return Ok(lone);
    }
    let costs = costs(problem, reports);
    let mut out = if detail == Detail::Full { overall(&own, reports) } else { StateRecord::default() };
    if problem.has_costs() {
        out.stage = reports.iter().map(|one| one.stage).max();
        let terms = problem.ensemble.expected_terms(reports.iter().map(|one| one.terms.as_slice()));
        let terms = terms.into_iter().map(|(name, value)| (name, value.into())).collect();
        let total = problem.ensemble.risk().value(problem.ensemble.probabilities(), &costs);
        out.cost = CostRecord { total: total.into(), terms };
        if problem.has_scenarios() {
            out.risk = risk(problem, &costs);
        }
        add_first_order(&mut out, problem, reports);
    }
    if detail == Detail::Full && problem.has_scenarios() && !problem.probes.is_empty() {
        out.probes = Some(probes(problem, reports));
    }
    add_members(&mut out, problem, &costs, own);
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

fn entry(one: &MemberReport<'_>, detail: Detail) -> Result<StateRecord, MemberError> {
    let mut out = if detail == Detail::Full { summary::state(one.member, one.state) } else { StateRecord::default() };
    if !one.terms.is_empty() {
        let failed = |error: ControlError| (one.member.index(), error);
        out.stage = Some(one.stage);
        out.cost = summary::cost(one);
        out.hausdorff = summary::hausdorff(one.member, &one.costs).map_err(failed)?;
        out.tracking = summary::tracking(one.member, &one.costs).map_err(failed)?;
        out.figures = summary::figures(one.member, &one.costs).map_err(failed)?;
        summary::add_distances(&mut out.figures, one.member, &one.distances);
    }
    if detail == Detail::Full {
        out.min_j = one.min_j.into();
        if let Some(found) = one.inspection {
            out.inertia = found.inertia.as_ref().ok().map(|(negative, _)| *negative).into();
            out.inertia_by_factor = found.inertia.as_ref().ok().and_then(|(_, by_factor)| *by_factor);
            out.inertia_missing = found.inertia.as_ref().err().map(Uncounted::record);
            out.free_motion = found.free.as_ref().map(crate::failure::free_motion);
            out.self_intersection = Some(found.intersection_record());
        }
        summary::add_work(&mut out, &one.work);
    }
    Ok(out)
}

/// Mean and deviation to first order, and the cost that is made of them.
fn add_first_order(out: &mut StateRecord, problem: &CaseProblem, reports: &[MemberReport<'_>]) {
    let (Some(of), Some(at)) = (problem.ensemble.first_order(), reports.first().and_then(|one| one.first_order)) else {
        return;
    };
    let source = |own: VarianceShare| SourceRecord { parameter: own.name, region: own.part, share: own.share.into() };
    out.cost.total = of.value(at).into();
    out.first_order = Some(FirstOrderRecord {
        mean: at.mean.into(),
        deviation: at.deviation.into(),
        rounded: at.rounded.into(),
        about: "the expansion is about the medians of the random parameters: what is said of the mean of a log-normal one differs by the factor exp(v/2), v the variance of its logarithm"
            .to_owned(),
        sources: of.shares(at).into_iter().map(source).collect(),
    });
}

fn risk(problem: &CaseProblem, costs: &[f64]) -> RiskRecord {
    let ensemble = &problem.ensemble;
    let p = ensemble.probabilities();
    let of = |measured: Measured| {
        let Measured { name, level, value, exact } = measured;
        (name.to_owned(), MeasureRecord { value: value.into(), exact: exact.into(), level })
    };
    RiskRecord {
        measure: ensemble.risk().name().to_owned(),
        value: ensemble.risk().value(p, costs).into(),
        exact: ensemble.risk().exact(p, costs).into(),
        deviation: deviation(p, costs).into(),
        measures: Some(ensemble.risks_of(costs).into_iter().map(of).collect()),
    }
}

/// Of all members together: the worst of states, the sum of work.
fn overall(own: &[StateRecord], reports: &[MemberReport<'_>]) -> StateRecord {
    let mut work = SolveReport::default();
    reports.iter().for_each(|one| work.add_work(&one.work));
    // One member without a number leaves none for all.
    let inertia: Option<Vec<usize>> = own.iter().map(|entry| *entry.inertia).collect();
    let mut out = StateRecord {
        min_j: reports.iter().map(|one| one.min_j).fold(f64::INFINITY, f64::min).into(),
        residual: reports.iter().map(|one| one.state.report.residual).fold(0.0, f64::max).into(),
        inertia: inertia.and_then(|all| all.into_iter().max()).into(),
        inertia_by_factor: own.iter().map(|entry| entry.inertia_by_factor).reduce(|a, b| Some(a? && b?)).flatten(),
        free_motion: own.iter().find_map(|entry| entry.free_motion.clone()),
        inertia_missing: own.iter().find_map(|entry| entry.inertia_missing.clone()),
        ..StateRecord::default()
    };
    summary::add_work(&mut out, &work);
    out
}

/// Probes over the scenarios: the expected values of displacement and position and the standard deviations of their components; with
/// load cases those of each.
fn probes(problem: &CaseProblem, reports: &[MemberReport<'_>]) -> ByName<ProbesRecord> {
    let (p, dim) = (problem.ensemble.probabilities(), problem.mesh().dim());
    let of_case = |load_case: Option<&str>| -> ByName<ProbeRecord> {
        let own: Vec<&MemberReport<'_>> = reports.iter().filter(|one| one.member.load_case() == load_case).collect();
        let of = |probe: &LocatedProbe| {
            let moved: Vec<[f64; 3]> = own.iter().map(|one| probe.displacement(&one.state.u, dim)).collect();
            let component = |c: usize| moved.iter().map(|u| u[c]).collect::<Vec<f64>>();
            let mean: [f64; 3] = std::array::from_fn(|c| component(c).iter().zip(p).map(|(u, p)| p * u).sum());
            let spread: [f64; 3] = std::array::from_fn(|c| deviation(p, &component(c)));
            let entry = ProbeRecord { deviation: Some(numbers(&spread)), ..summary::moved(probe, mean) };
            (probe.name.clone(), entry)
        };
        problem.probes.iter().map(of).collect()
    };
    let of_lead = |lead: CaseMember<'_>| {
        let name = lead.load_case()?.to_owned();
        Some((name, ProbesRecord::OfLoadCase(of_case(lead.load_case()))))
    };
    let by_case: ByName<ProbesRecord> = problem.leads().filter_map(of_lead).collect();
    if !by_case.is_empty() {
        return by_case;
    }
    of_case(None).into_iter().map(|(name, probe)| (name, ProbesRecord::One(probe))).collect()
}

/// Adds the entries of all members by scenario and load case.
fn add_members(out: &mut StateRecord, problem: &CaseProblem, costs: &[f64], own: Vec<StateRecord>) {
    let ensemble = &problem.ensemble;
    if problem.has_scenarios() {
        for (k, name) in ensemble.scenarios().iter().enumerate() {
            let head = StateRecord {
                probability: Some(ensemble.probabilities()[k]),
                set: Some(problem.differences(k).clone().into_iter().collect()),
                cost: if problem.has_costs() {
                    CostRecord { total: costs[k].into(), ..CostRecord::default() }
                } else {
                    CostRecord::default()
                },
                ..StateRecord::default()
            };
            out.scenarios.insert(name.clone(), head);
        }
    }
    for (member, entry) in problem.members().zip(own) {
        let place = out.member_mut(member.scenario(), member.load_case());
        let cost =
            if entry.cost == CostRecord::default() { std::mem::take(&mut place.cost) } else { entry.cost.clone() };
        let (probability, set) = (place.probability, place.set.take());
        let weight = member.load_case().map(|_| member.part().weight());
        *place = StateRecord { probability, set, weight, cost, ..entry };
    }
}
