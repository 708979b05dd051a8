//! Starts shared out over ranks: what each has found in a round, told to all.

use crate::run::error::RunError;
use crate::run::optimize::minimization::Minimization;
use crate::run::optimize::starts::round::RoundEnd;
use crate::run::optimize::starts::start_run::{FinishedRun, PointBytes, StartRun};
use crate::run::optimize::starts::{restored_best, saved_best};
use nastic_opt::saved::{pack, unpack};
use nastic_team::{TeamError, exchange};
use serde::{Deserialize, Serialize};

/// What a rank has found.
#[derive(Serialize, Deserialize)]
struct Told {
    starts: Vec<StartRun>,
    best: Option<(usize, FinishedRun<PointBytes>)>,
    interrupted: bool,
    aborted: Option<(usize, String)>,
}

/// Tells the starts of this rank to all and takes over those of the others, so that all ranks go on alike; the first one writes their lines of
/// `history.jsonl`, in the order of the starts.
pub(super) fn share(
    Minimization { input, destination, journal, .. }: &Minimization<'_>,
    starts: &mut [StartRun],
    found: &mut RoundEnd,
) -> Result<(), RunError> {
    let Some(team) = input.team_of_starts() else { return Ok(()) };
    let own = |start: &&StartRun| input.has_start(start.index);
    let best = found.best.as_ref().filter(|(index, _)| input.has_start(*index));
    let told = Told {
        starts: starts.iter().filter(own).map(StartRun::saved).collect(),
        best: best.map(|best| saved_best(&input.problem, best)),
        interrupted: found.interrupted,
        aborted: found.aborted.clone(),
    };
    let all = exchange(team, pack(&told))?;
    for (rank, bytes) in all.iter().enumerate().filter(|(rank, _)| *rank != team.rank()) {
        let unfit = TeamError::Unexpected { rank, what: "starts of another form" };
        let Told { starts: theirs, best, interrupted, aborted } = unpack(bytes).map_err(|_| unfit.clone())?;
        if let Some(best) = best {
            let best =
                restored_best(&input.problem, best).map_err(|failed| destination.evaluation_failed(input, &failed))?;
            found.add(best.0, best.1);
        }
        found.interrupted |= interrupted;
        if let Some((index, why)) =
            aborted.filter(|(index, _)| found.aborted.as_ref().is_none_or(|(own, _)| index < own))
        {
            found.aborted = Some((index, why));
        }
        for start in theirs {
            let place = starts.get_mut(start.index).ok_or_else(|| unfit.clone())?;
            *place = start;
        }
    }
    let best = found.best.as_ref().map(|best| saved_best(&input.problem, best));
    let mut journal = journal.lock();
    for start in &*starts {
        journal.add_recorded(start.lines());
        if !found.interrupted {
            journal.end_start(start, best.clone());
        }
    }
    Ok(())
}
