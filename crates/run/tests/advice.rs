//! What an optimisation that stopped short says to try next: commands that can be typed, and that help.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::{BAR, CaseDirectory, Heard, with};
use nastic_language::schema::Command;
use nastic_run::console::Console;
use nastic_run::run::{Options, Outcome, run};

/// The result of an optimisation with its own output directory, and what is said.
fn optimize(place: &CaseDirectory, case: &str, set: &[String]) -> (Outcome, String) {
    let heard = Heard::default();
    let options = Options { set: set.to_vec(), no_report: true, ..place.options(&[]) };
    let file = place.write("case.json", case);
    let outcome =
        run(Command::Optimize, &file, &Options { out: None, ..options }, &Console::new(heard.clone())).unwrap();
    (outcome, heard.text())
}

/// The settings of the command behind the advice that begins so.
fn settings(said: &str, advice: &str, place: &CaseDirectory) -> Vec<String> {
    let line = said.lines().skip_while(|line| !line.contains(advice)).nth(1);
    let line = line.unwrap_or_else(|| panic!("no {advice} in:\n{said}")).trim();
    let case = place.path("case.json").display().to_string();
    let rest = line.strip_prefix(&format!("nastic optimize {case}")).unwrap_or_else(|| panic!("{line}"));
    let mut parts = rest.split(" --set ");
    // What starts where this run ended leaves its files alone.
    let out = parts.next().unwrap_or("");
    assert_eq!(rest.contains("controls.json"), out.ends_with("_2"), "{line}");
    parts.map(|part| part.trim().trim_matches('\'').to_owned()).collect()
}

fn cost(outcome: &Outcome, when: &str) -> f64 {
    let total =
        if when == "start" { &outcome.result["start"]["cost"]["total"] } else { &outcome.result["cost"]["total"] };
    total.as_f64().unwrap()
}

#[test]
fn a_limit_of_iterations_is_raised_from_where_it_ended() {
    let place = CaseDirectory::new();
    let set = ["optimizer/max_iterations=2", "optimizer/method=projected_gradient"].map(str::to_owned);
    let (first, said) = optimize(&place, BAR, &set);
    assert!(said.contains("to go on    take the quasi-Newton method"), "{said}");
    let next = settings(&said, "raise the limit of iterations", &place);
    assert!(next.contains(&"optimizer/max_iterations=4".to_owned()), "{next:?}");
    assert!(next.contains(&"optimizer/method=projected_gradient".to_owned()), "what was set stays: {next:?}");
    assert_eq!(next.iter().filter(|one| one.starts_with("optimizer/max_iterations")).count(), 1, "{next:?}");
    let other = settings(&said, "take the quasi-Newton method", &place);
    assert!(other.contains(&"optimizer/method=lbfgs".to_owned()), "{other:?}");
    let from = next.iter().find(|one| one.starts_with("controls/0/start=")).unwrap();
    assert!(from.ends_with("={\"file\":\"out/case/controls.json\"}"), "as the case names files: {from}");
    let (second, _) = optimize(&place, BAR, &next);
    let (reached, begun) = (cost(&first, "end"), cost(&second, "start"));
    assert!((reached - begun).abs() < 1e-8 * reached, "{reached} {begun}");
    assert!(cost(&second, "end") < reached);
    // It converges where the first run would have.
    let wanted = next.iter().find_map(|one| one.strip_prefix("optimizer/absolute_tolerance=")).unwrap();
    let relative = first.result["gradient_norm"].as_f64().unwrap() / wanted.parse::<f64>().unwrap();
    assert!(relative > 1.0, "{relative}");
}

#[test]
fn a_search_that_stalls_offers_a_tolerance_that_it_meets() {
    let place = CaseDirectory::new();
    let limits = ["optimizer/tolerance=1e-14", "optimizer/max_iterations=200"];
    // from here the cost creeps before its rounding hides all decrease
    let set = [&limits[..], &["controls/0/start=-1000"]].concat().iter().map(|&one| one.to_owned()).collect::<Vec<_>>();
    let (_, said) = optimize(&place, BAR, &set);
    assert!(said.contains("end         stalled"), "{said}");
    // which kind of stall it is hangs on rounding, and so on the instructions of the processor
    if said.contains("no decrease in ") {
        assert!(said.contains("gradient check"), "{said}");
        return;
    }
    let next = settings(&said, "would have converged", &place);
    let (again, said) = optimize(&place, BAR, &next);
    assert!(again.result["converged"].as_bool().unwrap(), "{next:?}\n{said}");
}

#[test]
fn values_on_bounds_offer_wider_ones() {
    let place = CaseDirectory::new();
    let narrow = with(BAR, r#""lower": "-200 kPa", "upper": "100 kPa""#, r#""lower": "-20 Pa", "upper": "10 Pa""#);
    let narrow = with(&narrow, r#""start": "-50 kPa * Z / 0.25 m""#, r#""start": 0"#);
    let (_, said) =
        optimize(&place, &narrow, &["optimizer/max_iterations=2".to_owned(), "optimizer/tolerance=1e-12".to_owned()]);
    let next = settings(&said, "widen it", &place);
    assert!(next.iter().any(|one| one == "controls/0/upper=20" || one == "controls/0/lower=-40"), "{next:?}\n{said}");
}
