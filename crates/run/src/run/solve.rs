//! `nastic solve`: the equilibrium at the start controls.

mod equilibria;
pub(crate) mod equilibrium;
mod exact_contact;
mod half_thickness;
mod minimum;
pub(super) mod modes;
mod moving;
mod path;
mod ramp;
mod ramp_failure;
mod ramp_jumps;
mod series;
mod series_charts;

pub(super) use crate::run::solve::moving::resume;

use crate::run::error::{Exit, RunError};
use crate::run::motion;
use crate::run::report::remove_earlier;
use crate::run::session::Session;
use crate::run::solve::equilibrium::equilibrium;
use nastic_case::analysis::Analysis;

pub(super) fn run(session: &mut Session<'_>, analysis: &Analysis) -> Result<Exit, RunError> {
    if let Some(option) = analysis.option().filter(|_| session.input.problem.is_motion() && !analysis.goes_with_time())
    {
        let refused = motion::refused(&session.input.problem, option);
        return Err(session.refuse(refused));
    }
    // a ramp is read first
    if !matches!(analysis, Analysis::Ramp(_)) {
        remove_earlier(session)?;
    }
    if let Some(out) = &session.destination.out {
        // It belongs to an earlier command, and would stand beside the files of this one.
        out.remove("failure.vtu")?;
    }
    if session.input.problem.is_motion() {
        return moving::run(session, None, analysis);
    }
    match analysis {
        Analysis::Equilibrium
        | Analysis::Minimum
        | Analysis::ExactContact
        | Analysis::HalfThickness
        | Analysis::Modes(_)
        | Analysis::Equilibria(_) => equilibrium(session, analysis),
        Analysis::Ramp(text) => ramp::run(session, text),
        Analysis::Path => path::run(session, false),
        Analysis::PathToLimit => path::run(session, true),
    }
}
