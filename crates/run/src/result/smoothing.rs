//! The exponents of smoothed Hausdorff distances, stage by stage.

use nastic_case::lower::{CaseMember, CaseProblem};
use nastic_language::number::short;
use nastic_language::schema::{Cost, Stages};
use serde_json::{Map, Value, json};

/// `{ TERM: [ { "alpha", "beta", "gamma", "length" } ] }`, of a load case's own terms `CASE/TERM`; empty without such a term.
pub(crate) fn json(problem: &CaseProblem) -> Map<String, Value> {
    let mut out = Map::new();
    for member in problem.leads() {
        for cost in member.reduced().costs() {
            let smoothings = cost.smoothings();
            let stage = |s: &nastic_control::Smoothing| json!({ "alpha": s.alpha(), "beta": s.beta(), "gamma": s.gamma(), "length": s.resolution() });
            if !smoothings.is_empty() {
                let case = member.load_case().map_or_else(String::new, |case| format!("{case}/"));
                out.insert(format!("{case}{}", cost.name()), smoothings.iter().map(stage).collect());
            }
        }
    }
    out
}

/// A line for every term whose stages are automatic.
pub(crate) fn automatic(problem: &CaseProblem) -> Vec<String> {
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
