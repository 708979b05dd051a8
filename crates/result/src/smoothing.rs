//! The exponents of smoothed Hausdorff distances, stage by stage.

use nastic_case::lower::{CaseMember, CaseProblem};
use nastic_language::number::short;
use nastic_language::schema::{Cost, Stages};
use nastic_report::record::{ByName, SmoothingRecord};

/// The stages of every such term, of a load case's own terms `CASE/TERM`; empty without one.
pub fn record(problem: &CaseProblem) -> ByName<Vec<SmoothingRecord>> {
    let stage = |s: &nastic_control::Smoothing| SmoothingRecord {
        alpha: s.alpha().into(),
        beta: s.beta().into(),
        gamma: s.gamma().into(),
        length: s.resolution().into(),
    };
    let of = |member: CaseMember<'_>| {
        let case = member.load_case().map_or_else(String::new, |case| format!("{case}/"));
        let costs = member.reduced().costs().iter().filter(|cost| !cost.smoothings().is_empty());
        costs
            .map(|cost| (format!("{case}{}", cost.name()), cost.smoothings().iter().map(stage).collect()))
            .collect::<Vec<_>>()
    };
    problem.leads().flat_map(of).collect()
}

/// A line for every term whose stages are automatic.
pub fn automatic(problem: &CaseProblem) -> Vec<String> {
    let unit = problem.units().length().symbol;
    let of = |member: CaseMember<'_>| -> Vec<String> {
        let blocks = member.case().costs.iter().filter(|block| block.weight() != 0.0);
        let automatic = blocks.zip(member.reduced().costs()).filter(
            |(block, _)| matches!(block, Cost::SmoothedHausdorff(block) if matches!(block.stages, Stages::Auto)),
        );
        let line = |cost: &dyn nastic_control::Cost| {
            let stage = |s: &nastic_control::Smoothing| {
                let exponents = [s.alpha(), s.beta(), s.gamma()].map(short).join(", ");
                format!("({exponents}) resolve {} {unit}", short(s.resolution()))
            };
            let stages: Vec<String> = cost.smoothings().iter().map(stage).collect();
            format!("{}: automatic, (alpha, beta, gamma) = {}", cost.name(), stages.join(", then "))
        };
        automatic.map(|(_, cost)| line(cost.as_ref())).collect()
    };
    problem.leads().flat_map(of).collect()
}
