//! `nastic check`: what the case says, as it was understood. Nothing is solved.

use crate::run::describe;
use crate::run::describe::line::Line;
use crate::run::error::{Exit, RunError};
use crate::run::session::Session;

pub(super) fn run(session: &mut Session<'_>) -> Result<Exit, RunError> {
    let problem = &session.problem;
    let sections = [
        describe::units(problem),
        describe::mesh(problem),
        describe::memory(problem),
        describe::groups(problem),
        describe::materials(problem),
        describe::existence(problem),
        describe::actuation(problem),
        describe::controls(problem),
        describe::supports(problem),
        describe::springs(problem),
        describe::contacts(problem),
        describe::time(problem),
        describe::costs::costs(problem),
        describe::load_cases(problem),
        describe::scenarios(problem),
        describe::optimizer(problem),
        // It takes as long as a Newton iteration.
        if session.console.is_silent() { vec![] } else { describe::duration(problem) },
        describe::conventions(problem),
    ];
    for lines in &sections {
        let mut head = "";
        for Line { head: own, text } in lines {
            let reports = if *own == head { "" } else { own };
            head = own;
            session.console.say(format!("{reports:<12}{text}"));
        }
    }
    let warnings = session.warnings.len();
    describe::describe(problem, &mut session.record);
    session.console.say(match warnings {
        0 => "check       the case is complete and consistent".to_owned(),
        n => format!(
            "check       the case is complete and consistent, with {}",
            nastic_language::number::count(n, "warning")
        ),
    });
    Ok(Exit::Done)
}
