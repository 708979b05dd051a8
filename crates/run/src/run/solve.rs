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
use crate::run::session::Opened;
use crate::run::solve::equilibrium::equilibrium;
use nastic_case::analysis::Analysis;

pub(super) fn run(opened: &mut Opened<'_>, analysis: &Analysis) -> Result<Exit, RunError> {
    let Opened { input, destination, .. } = opened;
    if let Some(option) = analysis.option().filter(|_| input.problem.is_motion() && !analysis.goes_with_time()) {
        let refused = motion::refused(&input.problem, option);
        return Err(destination.refuse(refused));
    }
    // a ramp is read first
    if !matches!(analysis, Analysis::Ramp(_)) {
        remove_earlier(input, destination)?;
    }
    if let Some(out) = &destination.out {
        // It belongs to an earlier command, and would stand beside the files of this one.
        out.remove("failure.vtu")?;
    }
    if input.problem.is_motion() {
        return moving::run(opened, None, analysis);
    }
    match analysis {
        Analysis::Equilibrium
        | Analysis::Minimum
        | Analysis::ExactContact
        | Analysis::HalfThickness
        | Analysis::Modes(_)
        | Analysis::Equilibria(_) => {
            let (context, findings) = opened.parts();
            equilibrium(context, findings, analysis)
        }
        Analysis::Ramp(text) => ramp::run(opened, text),
        Analysis::Path => path::run(opened, false),
        Analysis::PathToLimit => path::run(opened, true),
    }
}
