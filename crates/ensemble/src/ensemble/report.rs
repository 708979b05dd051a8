//! What is reported of an ensemble: every risk, every scenario, the work of all.

use super::Ensemble;
use crate::parcel::MemberValues;
use crate::point::EnsemblePoint;
use nastic_control::work_summary;
use nastic_fem::SolveReport;
use nastic_opt::Summary;
use nastic_uncertainty::risk::{CATALOGUE, Risk, deviation};

/// A measure of risk at a point.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// The measure.
    pub name: &'static str,
    /// The share of cases that it ignores, if it has such a level.
    pub level: Option<f64>,
    /// R as it is optimised.
    pub value: f64,
    /// Without its smoothing, if it has one.
    pub exact: Option<f64>,
}

impl Ensemble {
    /// Every measure of the catalogue that is defined for these probabilities, whichever is optimised: the optimised
    /// one with its parameters, the others with their defaults.
    pub fn risks(&self, point: &EnsemblePoint) -> Vec<Measured> {
        self.risks_of(&point.costs)
    }

    /// The same of given costs, one per scenario.
    pub fn risks_of(&self, costs: &[f64]) -> Vec<Measured> {
        let (p, j) = (&self.probabilities, costs);
        let measured = |risk: &dyn Risk| Measured {
            name: risk.name(),
            level: risk.level(),
            value: risk.value(p, j),
            exact: risk.exact(p, j),
        };
        let mut all: Vec<Measured> = Vec::new();
        for row in CATALOGUE {
            let default = (row.make)();
            match () {
                () if row.name == self.risk.name() => all.push(measured(self.risk.as_ref())),
                () if default.check(p).is_ok() => all.push(measured(default.as_ref())),
                () => {}
            }
        }
        if !all.iter().any(|measured| measured.name == self.risk.name()) {
            all.push(measured(self.risk.as_ref()));
        }
        all
    }

    /// `risk/NAME` and `risk/NAME/exact`, `risk/deviation`; `terms/NAME`, expected; `scenarios/NAME/cost`, and
    /// `scenarios/NAME/LOAD_CASE/terms/TERM` for every member; work summed over members, the smallest J.
    pub(super) fn summary_of(&self, point: &EnsemblePoint) -> Summary {
        let mut entries = Vec::new();
        for risk in self.risks(point) {
            entries.push((format!("risk/{}", risk.name), risk.value));
            if let Some(exact) = risk.exact {
                entries.push((format!("risk/{}/exact", risk.name), exact));
            }
        }
        entries.push(("risk/deviation".into(), deviation(&self.probabilities, &point.costs)));
        let reports = point.values();
        let terms = self.expected_terms(reports.iter().map(|own| own.terms.as_slice()));
        entries.extend(terms.into_iter().map(|(name, value)| (format!("terms/{name}"), value)));
        for (name, cost) in self.names.iter().zip(&point.costs).filter(|(name, _)| !name.is_empty()) {
            entries.push((format!("scenarios/{name}/cost"), *cost));
        }
        let kind = if self.names.iter().all(String::is_empty) { "load_cases" } else { "scenarios" };
        for (member, at) in self.members.iter().zip(&reports).filter(|(member, _)| !member.name.is_empty()) {
            for (term, value) in member.problem.term_names().iter().zip(&at.terms) {
                entries.push((format!("{kind}/{}/terms/{term}", member.name), *value));
            }
        }
        entries.extend(work_entries(&reports));
        Summary(entries)
    }

    /// `sum_s p_s sum_l w_l` of every term, by name; `terms` has those of every member.
    pub fn expected_terms<'t>(&self, terms: impl IntoIterator<Item = &'t [f64]>) -> Vec<(String, f64)> {
        let mut sums: Vec<(String, f64)> = Vec::new();
        for (member, terms) in self.members.iter().zip(terms) {
            let weight = self.probabilities[member.scenario] * member.weight;
            for (name, value) in member.problem.term_names().into_iter().zip(terms) {
                match sums.iter_mut().find(|(known, _)| *known == name) {
                    Some((_, sum)) => *sum += weight * value,
                    None => sums.push((name, weight * value)),
                }
            }
        }
        sums
    }
}

/// Work summed over members, and the smallest J.
fn work_entries(reports: &[MemberValues]) -> Vec<(String, f64)> {
    let mut work = SolveReport::default();
    let mut min_j = f64::INFINITY;
    for report in reports {
        work.add_work(&report.total_work());
        min_j = min_j.min(report.min_j);
    }
    work_summary(&work).into_iter().chain([("min_J".to_owned(), min_j)]).collect()
}
