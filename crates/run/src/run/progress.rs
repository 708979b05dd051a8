//! What the terminal shows of a command under way.

use crate::console::Console;
use crate::run::ensemble_progress::EnsembleProgress;
use nastic_case::lower::CaseProblem;
use nastic_control::StepUnderWay;
use nastic_fem::Progress;
use nastic_language::number::short;

/// What a phase is called, by its name in the times of results.
pub(super) fn words(phase: &'static str) -> &'static str {
    match phase {
        "adjoint" => "derivative",
        "cut" => "solving the design with each cell 0 or 1",
        "deflation" => "searching other equilibria",
        "descent" => "searching a minimum of the energy",
        "gradient_check" => "gradient check",
        "inspect" => "looking into the states",
        "solve" => "solving at the start",
        "steps" => "finding time steps",
        "write" => "writing results",
        other => other,
    }
}

/// Lets the terminal show how solves and motions go.
pub(super) fn watch(problem: &mut CaseProblem, console: &Console) {
    if problem.members().nth(1).is_some() {
        problem.ensemble.watch(EnsembleProgress::new(problem, console).watcher());
        return;
    }
    let terminal = console.clone();
    problem.ensemble.watch_solves(move |_, Progress { load, newton, residual, .. }| {
        let line = format!("solving: load {load:.4}, Newton iteration {newton}, residual {residual:.1e}");
        terminal.progress(*newton, line);
    });
    let (terminal, unit) = (console.clone(), problem.units().time().symbol);
    problem.ensemble.watch_steps(move |_, StepUnderWay { done, of, time, end }| {
        terminal.instant(*time, *end);
        terminal.step(*done, *of, format!("t = {} of {} {unit}", short(*time), short(*end)));
    });
}
