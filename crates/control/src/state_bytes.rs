//! States and reports of work as bytes.

use nastic_fem::{Controls, History, SolveReport, Solver, State};
use nastic_opt::SavedRunError;
use nastic_opt::bytes::{Reader, Writer};
use std::sync::Arc;

/// What a report that was read back calls a solver that is not in the catalogue.
const OWN: &str = "own";

/// A state with its controls.
pub fn write_whole_state(state: &State, out: &mut Writer) {
    (0..state.controls.len()).for_each(|k| out.floats(state.controls.values(k)));
    write_state(state, out);
}

/// The state that [`write_whole_state`] wrote; `like` is one of the same body.
///
/// # Errors
/// Bytes that end early, or a state of another body.
pub fn read_whole_state(input: &mut Reader<'_>, like: &State) -> Result<State, SavedRunError> {
    let mut controls = Controls::clone(&like.controls);
    for k in 0..controls.len() {
        let values = input.floats()?;
        if values.len() != controls.values(k).len() {
            return Err(input.damaged("controls of another body"));
        }
        controls.values_mut(k).copy_from_slice(&values);
    }
    let state = read_state(input, controls)?;
    let rates = || state.velocity.iter().chain(&state.acceleration);
    if state.u.len() != like.u.len() || rates().any(|rate| rate.len() != like.u.len()) {
        return Err(input.damaged("a state of another body"));
    }
    Ok(state)
}

/// All but the controls, which follow from the control vector.
pub(crate) fn write_state(state: &State, out: &mut Writer) {
    let State { u, controls: _, load, time, velocity, acceleration, history, report } = state;
    out.floats(u);
    out.float(*load);
    out.float(*time);
    for rate in [velocity, acceleration] {
        out.count(usize::from(rate.is_some()));
        rate.iter().for_each(|rate| out.floats(rate));
    }
    out.floats(&history.to_floats());
    write_report(report, out);
}

pub(crate) fn read_state(input: &mut Reader<'_>, controls: Controls) -> Result<State, SavedRunError> {
    Ok(State {
        u: Arc::new(input.floats()?),
        controls: Arc::new(controls),
        load: input.float()?,
        time: input.float()?,
        velocity: if input.flag()? { Some(Arc::new(input.floats()?)) } else { None },
        acceleration: if input.flag()? { Some(Arc::new(input.floats()?)) } else { None },
        history: Arc::new(read_history(input)?),
        report: read_report(input)?,
    })
}

fn read_history(input: &mut Reader<'_>) -> Result<History, SavedRunError> {
    let floats = input.floats()?;
    History::from_floats(&floats).ok_or_else(|| input.damaged("internal variables that are none"))
}

/// A report of work as bytes.
pub fn write_report(report: &SolveReport, out: &mut Writer) {
    let SolveReport {
        solver,
        newton,
        factorisations,
        reused,
        back_substitutions,
        hierarchies,
        cycles,
        unassembled,
        load_steps,
        cuts,
        residual,
        min_j,
        energy,
        restarts,
        shifted,
        unpredicted,
    } = *report;
    let position = Solver::CATALOGUE.iter().position(|factory| factory.name() == solver);
    out.count(position.unwrap_or(Solver::CATALOGUE.len()));
    let linear = [factorisations, reused, back_substitutions, hierarchies, cycles, unassembled];
    let counts = [newton].into_iter().chain(linear).chain([load_steps, cuts, restarts, shifted, unpredicted]);
    counts.for_each(|count| out.count(count));
    [residual, min_j, energy].into_iter().for_each(|x| out.float(x));
}

/// The report that [`write_report`] wrote.
///
/// # Errors
/// Bytes that end early, or an unknown linear solver.
pub fn read_report(input: &mut Reader<'_>) -> Result<SolveReport, SavedRunError> {
    Ok(SolveReport {
        solver: match input.number()? {
            known if known < Solver::CATALOGUE.len() => Solver::CATALOGUE[known].name(),
            own if own == Solver::CATALOGUE.len() => OWN,
            _ => return Err(input.damaged("an unknown linear solver")),
        },
        newton: input.number()?,
        factorisations: input.number()?,
        reused: input.number()?,
        back_substitutions: input.number()?,
        hierarchies: input.number()?,
        cycles: input.number()?,
        unassembled: input.number()?,
        load_steps: input.number()?,
        cuts: input.number()?,
        restarts: input.number()?,
        shifted: input.number()?,
        unpredicted: input.number()?,
        residual: input.float()?,
        min_j: input.float()?,
        energy: input.float()?,
    })
}
