//! What to try after an optimisation that stopped before it converged, or whose bounds decided: each with the command.

use crate::run::optimize::limit_advice;
use crate::run::optimize::starts::start_run::FinishedRun;
use crate::run::session::output_directory::usual_directory;
use crate::run::session::{CommandContext, CommandInput, Destination};
use nastic_case::lower::{Admitted, CaseProblem};
use nastic_control::Smoothing;
use nastic_ensemble::EnsemblePoint;
use nastic_language::schema::Cost;
use nastic_opt::{Best, Constrained, Stall, Stop};
use nastic_result::controls;
use serde_json::{Value, json};
use std::path::{Component, Path, PathBuf};

/// The method to take instead of another.
const QUASI_NEWTON: &str = "lbfgs";
/// Methods that make nothing of the cost's curvature, or little.
const FIRST_ORDER: [&str; 3] = ["projected_gradient", "spectral", "mma"];
/// Starts to try where one ended too high.
const STARTS: usize = 4;
/// Many of a control's values on bounds: the bounds may decide. Of one that converged, all of them.
const MANY: f64 = 0.5;

/// One thing to try.
pub(super) struct Advice {
    pub why: String,
    /// What to type; `None` where a program runs the optimisation.
    pub command: Option<String>,
}

/// Says what may help, the most likely first.
pub(super) fn say(context: CommandContext<'_>, ended: &FinishedRun) {
    let CommandContext { input, destination, console } = context;
    for (k, Advice { why, command }) in advices(input, destination, ended).iter().enumerate() {
        let head = if k == 0 { "to go on   " } else { "           " };
        match command {
            Some(command) => {
                console.say(format!("{head} {why}:"));
                console.say(format!("              {command}"));
            }
            None => console.say(format!("{head} {why}")),
        }
    }
}

fn advices(input: &CommandInput, destination: &Destination, ended: &FinishedRun) -> Vec<Advice> {
    let best = &ended.best;
    let optimizer = &input.problem.case.optimizer;
    let from_here = starts_from_here(input, destination, best);
    let again = |why: String, set: Vec<String>| Advice { why, command: optimize(input, destination, &set) };
    let with = |one: String| [vec![one], from_here.clone()].concat();
    let mut out = limit_advice::of(input, destination, ended);
    match &best.stop {
        Stop::Converged { .. } => {}
        stop if stop.is_interrupted() => {
            out.push(again("start from the control that was reached".into(), from_here.clone()));
        }
        Stop::MaxIterations { iterations, .. } => {
            let set =
                with(format!("optimizer/max_iterations={}", 2 * (*iterations).max(optimizer.max_iterations).max(1)));
            let anew = match input.problem.ensemble.constraints().is_empty() {
                true => "",
                false => {
                    " (the multipliers of the constraints begin anew: a run from the start with this limit keeps them)"
                }
            };
            out.push(again(format!("raise the limit of iterations, from the control that was reached{anew}"), set));
        }
        Stop::Stalled(Stall::Flat { relative_gradient, .. } | Stall::Stagnation { relative_gradient, .. }) => {
            let tolerance = loosened(*relative_gradient);
            let why = format!("this may be good enough: a run with a tolerance of {tolerance} would have converged");
            out.push(again(why, vec![format!("optimizer/tolerance={tolerance}")]));
        }
        // what limit points ask for stands there already
        Stop::Stalled(Stall::LineSearch { .. }) if ended.limits.count > 0 => {}
        Stop::Stalled(Stall::LineSearch { trials, failed, .. }) if 2 * failed >= *trials => {
            let set = narrowed(&input.problem);
            let why = "most trials had no equilibrium: narrow the bounds to where the body has one".to_owned();
            out.extend((!set.is_empty()).then(|| again(why, set)));
            out.push(Advice {
                why: "see how far the body goes along its path of equilibria".to_owned(),
                command: on_case(&input.problem, |case| format!("nastic solve {case} --path")),
            });
        }
        Stop::Stalled(Stall::LineSearch { .. }) => out.push(Advice {
            why: "no step lowered the cost: test its derivative".to_owned(),
            command: on_case(&input.problem, |case| format!("nastic gradcheck {case}")),
        }),
        Stop::Stalled(Stall::SecondDerivatives { .. }) => {
            let set = with(format!("optimizer/method={QUASI_NEWTON}"));
            out.push(again("take a method that needs first derivatives alone".into(), set));
        }
        Stop::Stalled(Stall::Stage { stage, .. }) => {
            let why = format!("stage {} has no value there: stop before it, or put one between", stage + 1);
            out.push(again(why, [stages_before(&input.problem, *stage), from_here.clone()].concat()));
        }
        _ => {}
    }
    // One that holds constraints itself may need fewer iterations than multipliers around another.
    let holds = optimizer.method.name() == "mma" && !input.problem.ensemble.constraints().is_empty();
    let first_order = FIRST_ORDER.contains(&optimizer.method.name()) && !holds;
    if first_order && !best.stop.is_interrupted() && !best.stop.is_converged() {
        let set = with(format!("optimizer/method={QUASI_NEWTON}"));
        out.insert(0, again("take the quasi-Newton method, which needs fewer iterations".into(), set));
    }
    if let (Stop::Stalled(_), 1) = (&best.stop, optimizer.starts) {
        let why = "the cost may have other minima: try several starts".to_owned();
        out.extend(bounded(&input.problem).then(|| again(why, vec![format!("optimizer/starts={STARTS}")])));
    }
    out.extend(widened(input, destination, best));
    out
}

/// A command on the case file, if there is one.
fn on_case(problem: &CaseProblem, command: impl Fn(&str) -> String) -> Option<String> {
    problem.case_file().map(|case| command(&quote(case)))
}

/// The command with the overrides of this run and others. What starts from the controls of this run goes to another
/// directory, so that these stay.
pub(super) fn optimize(input: &CommandInput, destination: &Destination, set: &[String]) -> Option<String> {
    let path = |setting: &str| setting.split_once('=').map_or("", |(path, _)| path).to_owned();
    let replaced = |old: &String| set.iter().any(|new| path(new) == path(old));
    let kept = input.options.set.iter().filter(|old| !replaced(old));
    let settings = kept.chain(set).map(|setting| format!(" --set {}", quote(setting)));
    let goes_on = set.iter().any(|setting| path(setting).ends_with("/start"));
    let out = destination.out.as_ref().map(|out| if goes_on { next_to(out.path()) } else { out.path().to_owned() });
    let out = out.filter(|out| *out != usual_directory(&input.problem));
    let out = out.map_or_else(String::new, |out| format!(" --out {}", quote(&out.display().to_string())));
    let settings: String = settings.collect();
    on_case(&input.problem, |case| format!("nastic {} {case}{out}{settings}", input.command.name()))
}

/// The directory beside another whose name ends in the next number: `finger_2` beside `finger`.
fn next_to(directory: &Path) -> PathBuf {
    let name = directory.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let numbered = name.rsplit_once('_').and_then(|(stem, number)| Some((stem, number.parse::<u32>().ok()?)));
    let (stem, number) = numbered.unwrap_or((&name, 1));
    directory.with_file_name(format!("{stem}_{}", number.saturating_add(1)))
}

/// Settings that let every control start where it has come to, and the run converge where this one would have.
fn starts_from_here(input: &CommandInput, destination: &Destination, best: &Best<EnsemblePoint>) -> Vec<String> {
    let Some(out) = &destination.out else { return vec![] };
    let file = from_case(Path::new(input.problem.document.name()), &out.file("controls.json"));
    let start = json!({ "file": file.display().to_string() });
    let starts = input.problem.controls.iter().map(|field| format!("{}/start={start}", field.at));
    let optimizer = &input.problem.case.optimizer;
    let aimed = relative_gradient(&best.stop)
        .map(|relative| optimizer.tolerance * best.gradient_norm / relative)
        .filter(|norm| norm.is_finite() && *norm > optimizer.absolute_tolerance);
    // The other starts would be random again.
    let alone = (optimizer.starts > 1).then(|| "optimizer/starts=1".to_owned());
    starts.chain(alone).chain(aimed.map(|norm| format!("optimizer/absolute_tolerance={norm:.2e}"))).collect()
}

/// The projected gradient at the end, relative to the first of the stage.
fn relative_gradient(stop: &Stop) -> Option<f64> {
    match stop {
        Stop::MaxIterations { relative_gradient, .. }
        | Stop::Stalled(
            Stall::Flat { relative_gradient, .. }
            | Stall::LineSearch { relative_gradient, .. }
            | Stall::Stagnation { relative_gradient, .. },
        ) => Some(*relative_gradient).filter(|relative| *relative > 0.0),
        _ => None,
    }
}

/// A file as a case names it: from the case's directory.
fn from_case(case: &Path, file: &Path) -> PathBuf {
    let directory = case.parent().unwrap_or(Path::new(""));
    if let Ok(below) = file.strip_prefix(directory) {
        return below.to_owned();
    }
    let is_below = directory.components().all(|part| matches!(part, Component::Normal(_)));
    if file.is_relative() && is_below {
        let up: PathBuf = directory.components().map(|_| "..").collect();
        return up.join(file);
    }
    std::path::absolute(file).unwrap_or_else(|_| file.to_owned())
}

/// The stages of every cost that has some, up to this one.
fn stages_before(problem: &CaseProblem, stage: usize) -> Vec<String> {
    let blocks = problem.case.costs.iter().filter(|block| block.weight() != 0.0);
    let values = |stage: &Smoothing| json!({ "alpha": stage.alpha(), "beta": stage.beta(), "gamma": stage.gamma() });
    let of = |(block, stages): (&Cost, Vec<Smoothing>)| {
        (stages.len() > stage).then(|| {
            let before: Value = stages[..stage.max(1)].iter().map(values).collect();
            format!("{}/stages={before}", block.at())
        })
    };
    let smoothings = problem.member(0).reduced().costs().iter().map(|cost| cost.smoothings());
    blocks.zip(smoothings).filter_map(of).collect()
}

/// Bounds of scalars at half their distance from zero.
fn narrowed(problem: &CaseProblem) -> Vec<String> {
    let fields = problem.ensemble.blocks().iter().zip(&problem.controls);
    let scalars = fields.filter(|(block, _)| problem.control_block(block).components == 1);
    let bounds = scalars.filter_map(|(_, field)| match field.admitted {
        Admitted::Between { lower, upper } => {
            Some([("lower", lower), ("upper", upper)].map(|(key, v)| (field, key, v)))
        }
        _ => None,
    });
    let finite = bounds.flatten().filter(|(.., value)| value.is_finite() && *value != 0.0);
    finite.map(|(field, key, value)| format!("{}/{key}={}", field.at, value * value / wider(key, value))).collect()
}

/// A bound at twice its distance from zero, or half of it, so that more is admitted.
fn wider(key: &str, bound: f64) -> f64 {
    if (key == "lower") == (bound > 0.0) { 0.5 * bound } else { 2.0 * bound }
}

/// Wider bounds, where most values of a control lie on them.
fn widened(input: &CommandInput, destination: &Destination, best: &Best<EnsemblePoint>) -> Option<Advice> {
    let problem = &input.problem;
    let fields = problem.ensemble.blocks().iter().zip(&problem.controls);
    let set: Vec<String> = fields
        .filter_map(|(block, field)| {
            let own = problem.control_block(block);
            // a design that is 0 or 1 is what is looked for
            if problem.case.has_design(&own.name) {
                return None;
            }
            let components = own.components;
            let m = block.of(&best.m);
            let on_bounds = controls::active(m, components, field) * components;
            let Admitted::Between { lower, upper } = field.admitted else { return None };
            let unknown = |bound: f64| if field.log { bound.ln() } else { bound };
            let at = |bound: f64| m.iter().filter(|value| **value == unknown(bound)).count();
            let (key, bound) = if at(lower) > at(upper) { ("lower", lower) } else { ("upper", upper) };
            let share = if best.stop.is_converged() { 1.0 } else { MANY };
            let many = on_bounds as f64 >= share * m.len() as f64 && !m.is_empty();
            // those of a vector are a list
            let many = many && components == 1;
            let borne = field.limit.is_none_or(|limit| 2.0 * bound <= limit);
            (many && borne && bound.is_finite() && bound != 0.0)
                .then(|| format!("{}/{key}={}", field.at, wider(key, bound)))
        })
        .collect();
    let why = "most values lie on a bound: widen it, if the body bears that".to_owned();
    (!set.is_empty()).then(|| Advice { why, command: optimize(input, destination, &set) })
}

/// Whether random starts can be drawn: every control is bounded.
fn bounded(problem: &CaseProblem) -> bool {
    problem.controls.iter().all(|field| match field.admitted {
        Admitted::Between { lower, upper } => lower.is_finite() && upper.is_finite(),
        Admitted::Norm(_) | Admitted::MaxNorm(_) => true,
        Admitted::Any => false,
    })
}

/// The next tolerance with one digit above what was reached.
fn loosened(relative_gradient: f64) -> String {
    let exponent = relative_gradient.max(1e-300).log10().floor();
    let digit = (relative_gradient / 10f64.powf(exponent)).ceil().max(1.0) + 1.0;
    if digit >= 10.0 { format!("1e{}", exponent + 1.0) } else { format!("{digit}e{exponent}") }
}

/// As a shell takes it.
fn quote(text: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "/._-=+:@".contains(c);
    if !text.is_empty() && text.chars().all(plain) {
        text.to_owned()
    } else {
        format!("'{}'", text.replace('\'', "'\\''"))
    }
}
