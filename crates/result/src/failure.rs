//! What a state solve that failed reports: the entry `failure` of results, and the arrays of `failure.vtu`.

use nastic_case::lower::CaseMember;
use nastic_control::{ControlError, StateFields};
use nastic_energy::Outside;
use nastic_fem::{Cause, ExcessTension, FreeMotion, Inadmissible, InvertedAt, MeetingGuides, State, StateError};
use nastic_mesh::Snapshot;
use nastic_report::record::{
    CellRecord, DomainRecord, ExcessTensionRecord, FailureRecord, FreeMotionRecord, MeetingGuidesRecord,
    PenetrationRecord, TensionRecord, numbers,
};

/// Cells that are named.
const NAMED: usize = 10;

/// The last equilibrium on the way, where there is one.
pub fn last_state(error: &StateError) -> Option<&State> {
    match of_solve(error) {
        StateError::Inadmissible { last, .. }
        | StateError::NoConvergence { last, .. }
        | StateError::EndOfStep { last, .. } => Some(last),
        _ => None,
    }
}

/// Of a time step why its solve failed.
fn of_solve(error: &StateError) -> &StateError {
    match error {
        StateError::InStep { source, .. } => source,
        other => other,
    }
}

/// What a failure reports: `kind`, and what that kind knows.
pub fn record(member: CaseMember<'_>, error: &StateError) -> FailureRecord {
    let mut out = FailureRecord { kind: error.code().to_owned(), ..FailureRecord::default() };
    out.member = Some(member.name()).filter(|name| !name.is_empty());
    if let StateError::InStep { time, dt, .. } | StateError::EndOfStep { time, dt, .. } = error {
        (out.t, out.step) = ((*time).into(), (*dt).into());
    }
    match of_solve(error) {
        StateError::NoConvergence { load, cuts, newton, residual, reached, cause, .. } => {
            (out.load, out.reached, out.residual) = ((*load).into(), (*reached).into(), (*residual).into());
            (out.load_steps_cut, out.newton_iterations) = (Some(*cuts), Some(*newton));
            add_cause(&mut out, cause);
        }
        StateError::Inadmissible { at, load, cuts, .. } => {
            (out.load, out.load_steps_cut) = ((*load).into(), Some(*cuts));
            add_place(&mut out, at);
        }
        _ => {}
    }
    let cells = last_state(error).and_then(|last| ranked(member, last));
    let entry = |(cell, j): (usize, f64)| CellRecord { cell, min_j: j.into() };
    out.worst_cells = cells.map(|cells| cells.into_iter().take(NAMED).map(entry).collect());
    out
}

fn add_cause(out: &mut FailureRecord, cause: &Cause) {
    out.cause = Some(cause.code().to_owned());
    match cause {
        Cause::LimitPoint { load } => out.limit_point = (*load).into(),
        Cause::Convexity(ExcessTension { actuation, tension, limit, beside }) => {
            let of = |name: &String, tension: f64| TensionRecord { actuation: name.clone(), tension: tension.into() };
            out.convexity_bound = Some(ExcessTensionRecord {
                actuation: actuation.clone(),
                tension: (*tension).into(),
                limit: (*limit).into(),
                beside: beside.iter().map(|(name, tension)| of(name, *tension)).collect(),
            });
        }
        Cause::GuidesMeet(MeetingGuides { name, places, share, limit }) => {
            out.limit_point = (*limit).into();
            let places = places.iter().map(|place| numbers(place)).collect();
            out.guides_meet = Some(MeetingGuidesRecord { name: name.clone(), places, share: (*share).into() });
        }
        Cause::FreeMotion(free) => out.free_motion = Some(free_motion(free)),
        Cause::Saddle { negative } => out.inertia = Some(*negative),
        Cause::Unknown => {}
    }
}

/// As results have it.
pub(crate) fn free_motion(FreeMotion { count, what, example }: &FreeMotion) -> FreeMotionRecord {
    FreeMotionRecord { count: *count, what: what.clone(), example: example.clone() }
}

fn add_place(out: &mut FailureRecord, at: &Inadmissible) {
    if let Some(InvertedAt { cell, point, jacobian }) = at.cell() {
        (out.cell, out.point, out.jacobian) = (Some(*cell), Some(*point), (*jacobian).into());
    }
    if let Inadmissible::Penetrates { name, place, depth } = at {
        let (name, place) = (name.clone(), numbers(place));
        out.penetrates = Some(PenetrationRecord { name, place, depth: (*depth).into() });
    }
    if let Some(Outside { law, measure, value, limit, .. }) = at.outside() {
        let (law, measure) = ((*law).to_owned(), (*measure).to_owned());
        out.domain = Some(DomainRecord { law, measure, value: (*value).into(), limit: (*limit).into() });
    }
}

/// The last good state: cell data `min_J` (smallest J of the cell) and `failure_rank` (1 for the cell with the lowest, 2 for
/// the next ..); where a cell inverted, `failed` is 1 there.
///
/// # Errors
/// An array that does not fit its mesh.
pub fn snapshot(
    member: CaseMember<'_>,
    fields: &StateFields<'_>,
    error: &StateError,
) -> Result<Snapshot, ControlError> {
    let mut out = crate::snapshot::snapshot(member, fields)?;
    let cells = member.mesh().cells();
    if let Some(all) = ranked(member, fields.state) {
        let (mut lowest, mut rank) = (vec![0.0; cells], vec![0.0; cells]);
        for (k, (cell, j)) in all.into_iter().enumerate() {
            (lowest[cell], rank[cell]) = (j, (k + 1) as f64);
        }
        out = out.with_cells("min_J", 1, lowest)?.with_cells("failure_rank", 1, rank)?;
    }
    if let StateError::Inadmissible { at, .. } | StateError::EndOfStep { at, .. } = of_solve(error)
        && let Some(at) = at.cell()
    {
        let mut failed = vec![0.0; cells];
        failed[at.cell] = 1.0;
        out = out.with_cells("failed", 1, failed)?;
    }
    Ok(out)
}

/// Cells with their smallest J, the lowest first.
fn ranked(member: CaseMember<'_>, state: &State) -> Option<Vec<(usize, f64)>> {
    let lowest = member.solid().min_j_of_cells(state).ok()?;
    let mut cells: Vec<(usize, f64)> = lowest.into_iter().enumerate().collect();
    cells.sort_by(|a, b| a.1.total_cmp(&b.1));
    Some(cells)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_saddle_says_its_negative_pivots() {
        let mut out = FailureRecord::default();
        add_cause(&mut out, &Cause::Saddle { negative: 2 });
        assert_eq!((out.cause.as_deref(), out.inertia), (Some("saddle"), Some(2)));
    }
}
