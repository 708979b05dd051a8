//! Load cases and scenarios in words.

use nastic_case::describe::{Line, cost_line, line};
use nastic_case::lower::CaseProblem;
use nastic_language::number::{count, short};
use nastic_language::schema::{LoadCase, Rule, Scenarios};
use nastic_report::record::{RiskRecord, StateRecord};

/// Scenarios listed one by one; the result has them all.
const LISTED: usize = 12;

/// The load cases, in words.
pub fn load_cases(problem: &CaseProblem) -> Vec<Line> {
    let mut out = Vec::new();
    for member in problem.leads() {
        let block = problem.case.load_cases.iter().find(|block| Some(block.name.as_str()) == member.load_case());
        let Some(block) = block else { continue };
        out.push(line("load cases", format!("{}: weight {}{}", block.name, short(block.weight), differs(block))));
        let own = member.case().controls.iter().skip(problem.case.controls.len());
        let own: Vec<String> = own.map(|control| format!("{}.{}", block.name, control.name())).collect();
        if !own.is_empty() {
            out.push(line("load cases", format!("  own controls: {}", own.join(", "))));
        }
        for cost in &block.costs {
            let text = cost_line("load cases", cost).text;
            out.push(line("load cases", format!("  {text}")));
        }
    }
    out
}

/// What a load case has alone.
fn differs(block: &LoadCase) -> String {
    let settings = block.set.0.iter().map(|setting| format!("{} = {}", setting.path, setting.node.to_json()));
    let counts = [(block.supports.len(), "support"), (block.loads.len(), "load")];
    let counts = counts.into_iter().filter(|(n, _)| *n > 0).map(|(n, what)| format!("own {}", count(n, what)));
    settings.chain(counts).map(|text| format!(", {text}")).collect()
}

/// The scenarios, in words.
pub fn scenarios(problem: &CaseProblem) -> Vec<Line> {
    if let Some(of) = problem.ensemble.first_order() {
        let sources: Vec<String> = of
            .sources
            .iter()
            .map(|own| match own.slopes.len() {
                1 => own.name.clone(),
                modes => format!("{} ({})", own.name, count(modes, "mode")),
            })
            .collect();
        let what = format!(
            "none; the cost at the medians plus {} standard deviations to first order in {}; the deviation D is rounded to sqrt(D^2 + ({} cost)^2)",
            short(of.deviations),
            sources.join(", "),
            short(of.smoothing)
        );
        return vec![line("scenarios", what)];
    }
    if !problem.has_scenarios() {
        return vec![];
    }
    let (ensemble, head) = (&problem.ensemble, "scenarios");
    let how = match &problem.case.scenarios {
        Scenarios::List(_) => "listed".to_owned(),
        Scenarios::Random(block) => match block.rule {
            Some(Rule::Gauss(n)) => format!("Gauss rule, {} per parameter", count(n, "point")),
            Some(Rule::Sparse(n)) => format!("sparse rule of level {n}"),
            Some(Rule::MonteCarlo(_)) => format!("Monte Carlo, seed {}", block.seed),
            Some(Rule::QuasiMonteCarlo(_)) => format!("quasi-Monte Carlo, seed {}", block.seed),
            Some(Rule::Lattice(_)) => format!("lattice, seed {}", block.seed),
            None => String::new(),
        },
    };
    let total = ensemble.scenarios().len();
    let mut out =
        vec![line(head, format!("{} ({how}); risk measure {}", count(total, "scenario"), ensemble.risk().name()))];
    for (k, (name, p)) in ensemble.scenarios().iter().zip(ensemble.probabilities()).enumerate().take(LISTED) {
        let differs: String =
            problem.differences(k).iter().map(|(path, value)| format!(", {path} = {value}")).collect();
        out.push(line(head, format!("{name}: probability {}{differs}", short(*p))));
    }
    if total > LISTED {
        out.push(line(head, format!("and {} more", total - LISTED)));
    }
    out
}

/// The same for programs.
pub(super) fn describe(problem: &CaseProblem, state: &mut StateRecord) {
    let ensemble = &problem.ensemble;
    for member in problem.leads().filter(|member| member.load_case().is_some()) {
        let own = member.fields().filter(|(_, field)| field.load_case.is_some()).map(|(_, field)| field.name.clone());
        let entry = StateRecord {
            weight: Some(member.part().weight()),
            own_controls: Some(own.collect()),
            terms: Some(member.reduced().term_names()),
            ..StateRecord::default()
        };
        state.load_cases.insert(member.load_case().unwrap_or_default().to_owned(), entry);
    }
    if problem.has_scenarios() {
        for (k, (name, p)) in ensemble.scenarios().iter().zip(ensemble.probabilities()).enumerate() {
            let set = Some(problem.differences(k).clone().into_iter().collect());
            state.scenarios.insert(name.clone(), StateRecord { probability: Some(*p), set, ..StateRecord::default() });
        }
        state.risk = RiskRecord { measure: ensemble.risk().name().to_owned(), ..RiskRecord::default() };
    }
}
