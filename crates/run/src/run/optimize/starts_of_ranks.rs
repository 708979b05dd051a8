//! Starts shared out over ranks: what each has found in a round, sent to all.

use crate::run::error::RunError;
use crate::run::optimize::journal::SharedJournal;
use crate::run::optimize::parted::Parted;
use crate::run::optimize::round::{RoundEnd, best_parted};
use crate::run::optimize::start_run::StartRun;
use crate::run::optimize::starts::read_best;
use crate::run::session::Session;
use nastic_opt::SavedRunError;
use nastic_opt::bytes::{Reader, Writer};
use nastic_team::{Team, TeamError, exchange};

/// What a rank has found.
struct Told {
    starts: Vec<StartRun>,
    best: Option<Parted>,
    interrupted: bool,
    aborted: Option<(usize, String)>,
}

/// Sends the starts of this rank to all and takes over those of the others, so that all ranks go on alike; the first one writes their lines of
/// `history.jsonl`, in the order of the starts.
pub(super) fn share(
    session: &Session<'_>,
    journal: &SharedJournal,
    starts: &mut [StartRun],
    found: &mut RoundEnd,
) -> Result<(), RunError> {
    let Some(team) = session.team_of_starts() else { return Ok(()) };
    let all = exchange(team, told(session, starts, found))?;
    for (rank, bytes) in all.iter().enumerate().filter(|(rank, _)| *rank != team.rank()) {
        let unfit = |_| TeamError::Unexpected { rank, what: "starts of another form" };
        let Told { starts: theirs, best, interrupted, aborted } =
            heard(bytes, rank, team, starts.len()).map_err(unfit)?;
        if let Some(best) = best {
            let best = read_best(session, &best).map_err(|failed| session.evaluation_failed(&failed))?;
            found.add(best.0, best.1);
        }
        found.interrupted |= interrupted;
        if let Some((index, why)) =
            aborted.filter(|(index, _)| found.aborted.as_ref().is_none_or(|(own, _)| index < own))
        {
            found.aborted = Some((index, why));
        }
        for start in theirs {
            let place = start.index;
            starts[place] = start;
        }
    }
    let best = found.best.as_ref().map(|best| best_parted(session, best));
    let mut journal = journal.lock();
    for start in &*starts {
        journal.add_recorded(start.lines());
        if !found.interrupted {
            journal.end_start(start, best.clone());
        }
    }
    Ok(())
}

fn told(session: &Session<'_>, starts: &[StartRun], found: &RoundEnd) -> Vec<u8> {
    let mut out = Writer::new("");
    let own = |start: &&StartRun| session.has_start(start.index);
    starts.iter().filter(own).for_each(|start| out.bytes(&start.to_parted().to_bytes()));
    let best = found.best.as_ref().filter(|(index, _)| session.has_start(*index));
    out.count(usize::from(best.is_some()));
    best.iter().for_each(|best| out.bytes(&best_parted(session, best).to_bytes()));
    out.count(usize::from(found.interrupted));
    out.count(usize::from(found.aborted.is_some()));
    if let Some((index, why)) = &found.aborted {
        out.count(*index);
        out.bytes(why.as_bytes());
    }
    out.finish()
}

fn heard(bytes: &[u8], rank: usize, team: &dyn Team, starts: usize) -> Result<Told, SavedRunError> {
    let mut input = Reader::new(bytes, "")?;
    let own = (0..starts).filter(|index| index % team.size() == rank);
    let starts =
        own.map(|index| StartRun::from_parted(index, Parted::from_bytes(&input.list()?)?)).collect::<Result<_, _>>()?;
    let best = if input.flag()? { Some(Parted::from_bytes(&input.list()?)?) } else { None };
    let interrupted = input.flag()?;
    let aborted = if input.flag()? { Some((input.number()?, input.text()?)) } else { None };
    input.finish()?;
    Ok(Told { starts, best, interrupted, aborted })
}
