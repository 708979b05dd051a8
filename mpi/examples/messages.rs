//! What messages between ranks take: `mpirun -n 4 messages [CONTROLS [BATCHES]]`, an even number of ranks.
//!
//! Ranks r and r + 1 pass a message to and fro, all pairs at once: its time by its length. Then all ranks exchange and add up what an iteration of one trial and
//! one derivative does (docs/development/messages-of-ranks.md), eight members on each rank, one iteration after the other. Rank 0 prints a line of JSON with medians over batches, in
//! seconds; `scripts/message_times.py` compares them with the formula.

use nastic_cli::Ended;
use nastic_team::{Shares, Team, TeamError, exchange, sum, sum_alone};
use std::io::Write;
use std::process::ExitCode;
use std::time::Instant;

/// Length of the short messages that pass to and fro, in bytes; long ones are as long as those of a sum.
const SHORT: usize = 64;
/// Repetitions of one kind before the next one.
const BATCH: usize = 20;
/// Members of a rank: a power of two, so that the fewest nodes of the tree are between ranks.
const MEMBERS: usize = 8;
/// Bytes of a member in the exchanges of an iteration, the first two those of a trial and a derivative.
const EXCHANGES: [usize; 5] = [89, 71, 17, 4, 10];
const NAMES: [&str; 7] = ["short", "long", "overhead", "alone", "exchange", "sum", "iteration"];

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

/// Seconds that one of `BATCH` repetitions takes.
fn timed(mut work: impl FnMut() -> Result<(), TeamError>) -> Result<f64, TeamError> {
    let began = Instant::now();
    (0..BATCH).try_for_each(|_| work())?;
    Ok(began.elapsed().as_secs_f64() / BATCH as f64)
}

/// There and back: twice the time of a message.
fn passed(team: &dyn Team, message: &[u8]) -> Result<(), TeamError> {
    let peer = team.rank() ^ 1;
    if team.rank().is_multiple_of(2) {
        team.send(peer, message.to_vec())?;
        team.receive(peer).map(drop)
    } else {
        let came = team.receive(peer)?;
        team.send(peer, came)
    }
}

/// What sending a short message takes the sender.
fn overhead(team: &dyn Team) -> Result<f64, TeamError> {
    let peer = team.rank() ^ 1;
    let seconds = timed(|| team.send(peer, vec![1; SHORT]))?;
    (0..BATCH).try_for_each(|_| team.receive(peer).map(drop))?;
    Ok(seconds)
}

/// Seconds by [`NAMES`], the median of batches. Kinds take turns, so that what else the machine does meets all of them.
fn measured(team: &dyn Team, controls: usize, batches: usize) -> Result<[f64; 7], TeamError> {
    let [short, long] = [SHORT, 8 * controls].map(|length| vec![1; length]);
    let shares = Shares::even(MEMBERS * team.size(), team.size());
    let leaf = |member: usize| Some(vec![member as f64; controls]);
    let together = |bytes: usize| exchange(team, vec![1; 4 + bytes * MEMBERS]).map(drop);
    let added = || sum(team, &shares, controls, leaf).map(drop);
    let mut times: [Vec<f64>; 7] = Default::default();
    for _ in 0..batches {
        let of_batch = [
            0.5 * timed(|| passed(team, &short))?,
            0.5 * timed(|| passed(team, &long))?,
            overhead(team)?,
            timed(|| {
                std::hint::black_box(sum_alone(MEMBERS, controls, leaf));
                Ok(())
            })?,
            timed(|| together(EXCHANGES[0]))?,
            timed(added)?,
            timed(|| EXCHANGES.iter().try_for_each(|bytes| together(*bytes)).and_then(|()| added()))?,
        ];
        times.iter_mut().zip(of_batch).for_each(|(times, seconds)| times.push(seconds));
    }
    Ok(times.map(median))
}

/// Rank 0 prints what was measured; an exit code and why, where nothing was.
fn run(team: &dyn Team) -> Result<(), (u8, String)> {
    let number = |at: usize, default: usize| std::env::args().nth(at).map_or(Some(default), |text| text.parse().ok());
    let (Some(controls), Some(batches @ 1..)) = (number(1, 10_000), number(2, 41)) else {
        return Err((2, "messages [CONTROLS [BATCHES]], please: two numbers, of batches at least one".to_owned()));
    };
    if !team.size().is_multiple_of(2) {
        return Err((2, "an even number of ranks, please: they are measured in pairs".to_owned()));
    }
    let seconds = measured(team, controls, batches).map_err(|error| (9, error.to_string()))?;
    if team.leads() {
        let found: Vec<String> =
            NAMES.iter().zip(seconds).map(|(name, time)| format!("\"{name}\": {time:.3e}")).collect();
        let (ranks, members) = (team.size(), MEMBERS * team.size());
        let begin = format!("{{\"ranks\": {ranks}, \"members\": {members}, \"controls\": {controls}");
        let written = writeln!(std::io::stdout().lock(), "{begin}, {}}}", found.join(", "));
        written.map_err(|error| (1, error.to_string()))?;
    }
    Ok(())
}

fn main() -> ExitCode {
    nastic_mpi::run_on_ranks(|team| match run(&*team) {
        Ok(()) => Ended { code: 0, error: None },
        Err((code, error)) => {
            if team.leads() {
                let _ = writeln!(std::io::stderr().lock(), "messages: {error}");
            }
            Ended { code, error: Some(error) }
        }
    })
}
