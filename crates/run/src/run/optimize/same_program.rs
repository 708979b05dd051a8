//! Whether a program that resumes has the laws and costs of the one before.

use nastic_control::{Ensemble, EnsemblePoint};
use nastic_fem::{Demand, Instant};
use nastic_numeric::format::scientific;
use nastic_opt::Objective;

/// The cost and the potential of a state computed again, relative: rounding is less, another law or cost is more.
const SAME: f64 = 1e-9;

/// Whether laws and costs, which no record holds, give a point of a checkpoint the values that it has there.
pub(super) fn same_program(ensemble: &Ensemble, point: &EnsemblePoint) -> Result<(), String> {
    let stage = point.members.iter().map(|at| at.stage).max().unwrap_or(0);
    let again = ensemble.restage(stage, point).map_err(|failed| failed.to_string())?;
    // A value that is no number is not the same either.
    let same = (again.risk - point.risk).abs() <= SAME * point.risk.abs();
    if !same {
        let (cost, was) = (scientific(again.risk, 6), scientific(point.risk, 6));
        return Err(format!("its control costs {cost} now and cost {was} before: a cost of the program has changed"));
    }
    for (member, at) in ensemble.members().iter().zip(&point.members) {
        let state = at.state();
        let place = Instant::of(state);
        let now = member.problem().solid().model().evaluate(&place, Demand { energy: true, force: false });
        let now = now.map_err(|error| error.to_string())?;
        let same = (now.energy - state.report.energy).abs() <= SAME * now.energy_scale;
        if !same {
            let (now, was) = (scientific(now.energy, 6), scientific(state.report.energy, 6));
            return Err(format!(
                "its state has the potential {now} now and had {was} before: a law or a load of the program has changed"
            ));
        }
    }
    Ok(())
}
