//! `nastic check`: what the case says, as it was understood. Nothing is solved.

use crate::run::error::{Exit, RunError};
use crate::run::session::Opened;
use nastic_case::describe as words;
use nastic_case::describe::Line;
use nastic_result::describe;

pub(super) fn run(opened: &mut Opened<'_>) -> Result<Exit, RunError> {
    let Opened { input, console, findings, .. } = opened;
    let problem = &input.problem;
    let sections = [
        words::units(problem),
        words::mesh(problem),
        describe::memory(problem),
        words::groups(problem),
        words::materials(problem),
        describe::existence(problem),
        describe::actuation(problem),
        words::controls(problem),
        words::supports(problem),
        words::blocks(problem),
        words::contacts(problem),
        words::rigid_bodies(problem),
        words::time(problem),
        words::costs(problem),
        describe::load_cases(problem),
        describe::scenarios(problem),
        words::optimizer(problem),
        // It takes as long as a Newton iteration.
        if console.is_silent() { vec![] } else { describe::duration(problem) },
        words::conventions(problem),
    ];
    for lines in &sections {
        let mut head = "";
        for Line { head: own, text } in lines {
            let reports = if *own == head { "" } else { own };
            head = own;
            console.say(format!("{reports:<12}{text}"));
        }
    }
    let warnings = findings.warnings.len();
    describe::describe(problem, &mut findings.record);
    console.say(match warnings {
        0 => "check       the case is complete and consistent".to_owned(),
        n => format!(
            "check       the case is complete and consistent, with {}",
            nastic_language::number::count(n, "warning")
        ),
    });
    Ok(Exit::Done)
}
