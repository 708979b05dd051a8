//! What a state solve that failed tells: the entry `failure` of results, and the arrays of `failure.vtu`.

use nastic_case::lower::CaseMember;
use nastic_control::{ControlError, StateFields};
use nastic_energy::Outside;
use nastic_fem::{Cause, ExcessTension, Inadmissible, InvertedAt, MeetingGuides, State, StateError};
use nastic_mesh::Snapshot;
use serde_json::{Map, Value, json};

/// Cells that are named.
const NAMED: usize = 10;

/// The last equilibrium on the way, where there is one.
pub(crate) fn last_state(error: &StateError) -> Option<&State> {
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

/// `kind`, and what that kind knows: `load`, `reached`, `cause`, `worst_cells` ..
pub(crate) fn entries(member: CaseMember<'_>, error: &StateError) -> Map<String, Value> {
    let mut out = Map::new();
    out.insert("kind".into(), json!(error.code()));
    if !member.name().is_empty() {
        out.insert("member".into(), json!(member.name()));
    }
    if let StateError::InStep { time, dt, .. } | StateError::EndOfStep { time, dt, .. } = error {
        out.insert("t".into(), json!(time));
        out.insert("step".into(), json!(dt));
    }
    match of_solve(error) {
        StateError::NoConvergence { load, cuts, newton, residual, reached, cause, .. } => {
            out.insert("load".into(), json!(load));
            out.insert("reached".into(), json!(reached));
            out.insert("load_steps_cut".into(), json!(cuts));
            out.insert("newton_iterations".into(), json!(newton));
            out.insert("residual".into(), json!(residual));
            out.insert("cause".into(), json!(cause.code()));
            match cause {
                Cause::LimitPoint { load } => {
                    out.insert("limit_point".into(), json!(load));
                }
                Cause::Convexity(ExcessTension { actuation, tension, limit, beside }) => {
                    let beside: Vec<Value> =
                        beside.iter().map(|(name, tension)| json!({ "actuation": name, "tension": tension })).collect();
                    let bound = json!({ "actuation": actuation, "tension": tension, "limit": limit, "beside": beside });
                    out.insert("convexity_bound".into(), bound);
                }
                Cause::GuidesMeet(MeetingGuides { name, places, share }) => {
                    out.insert("guides_meet".into(), json!({ "name": name, "places": places, "share": share }));
                }
                Cause::Unknown => {}
            }
        }
        StateError::Inadmissible { at, load, cuts, .. } => {
            out.insert("load".into(), json!(load));
            out.insert("load_steps_cut".into(), json!(cuts));
            if let Some(InvertedAt { cell, point, jacobian }) = at.cell() {
                out.insert("cell".into(), json!(cell));
                out.insert("point".into(), json!(point));
                out.insert("J".into(), json!(jacobian));
            }
            if let Inadmissible::Penetrates { name, place, depth } = at {
                out.insert("penetrates".into(), json!({ "name": name, "place": place, "depth": depth }));
            }
            if let Some(outside) = at.outside() {
                let Outside { law, measure, value, limit, .. } = outside;
                let domain = json!({ "law": law, "measure": measure, "value": value, "limit": limit });
                out.insert("domain".into(), domain);
            }
        }
        _ => {}
    }
    if let Some(cells) = last_state(error).and_then(|last| ranked(member, last)) {
        let entry = |(cell, j): &(usize, f64)| json!({ "cell": cell, "min_J": j });
        out.insert("worst_cells".into(), cells.iter().take(NAMED).map(entry).collect());
    }
    out
}

/// The last good state: cell data `min_J` (smallest J of the cell) and `failure_rank` (1 for the cell with the lowest, 2 for
/// the next ..); where a cell inverted, `failed` is 1 there.
pub(crate) fn snapshot(
    member: CaseMember<'_>,
    fields: &StateFields<'_>,
    error: &StateError,
) -> Result<Snapshot, ControlError> {
    let mut out = crate::result::snapshot::snapshot(member, fields)?;
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
