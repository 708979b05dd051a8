//! What messages between ranks take: `mpirun -n 4 messages [CONTROLS [BATCHES]]`, an even number of ranks.
//!
//! Ranks r and r + 1 pass a message to and fro, all pairs at once: its time by its length. Then all ranks exchange and add up what an iteration of one trial and
//! one derivative does (docs/clusters.md), eight members on each rank, one iteration after the other. Rank 0 prints a line of JSON with medians over batches, in
//! seconds; `scripts/message_times.py` compares them with the formula.

use nastic_cli::Ended;
use nastic_team::{Shares, Team, TeamError, exchange, sum};
use std::io::Write;
use std::process::ExitCode;
use std::time::Instant;

/// Lengths of messages that pass to and fro, in bytes.
const LENGTHS: [usize; 5] = [64, 1 << 12, 1 << 15, 1 << 18, 1 << 20];
/// Passes or iterations of a batch.
const BATCH: usize = 40;
/// Members of a rank: a power of two, so that the fewest nodes of the tree are between ranks.
const MEMBERS: usize = 8;
/// Bytes of a member in the exchanges of an iteration, the first two those of a trial and a derivative.
const EXCHANGES: [usize; 5] = [168, 136, 24, 16, 24];

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

/// Seconds that one of `BATCH` repetitions takes, the median of batches.
fn timed(batches: usize, mut work: impl FnMut() -> Result<(), TeamError>) -> Result<f64, TeamError> {
    let mut times = Vec::new();
    for _ in 0..batches {
        let began = Instant::now();
        (0..BATCH).try_for_each(|_| work())?;
        times.push(began.elapsed().as_secs_f64() / BATCH as f64);
    }
    Ok(median(times))
}

/// Half of the time there and back.
fn passed(team: &dyn Team, bytes: usize, batches: usize) -> Result<f64, TeamError> {
    let (peer, message) = (team.rank() ^ 1, vec![1; bytes]);
    let both = timed(batches, || {
        if team.rank().is_multiple_of(2) {
            team.send(peer, message.clone())?;
            team.receive(peer)?;
        } else {
            let came = team.receive(peer)?;
            team.send(peer, came)?;
        }
        Ok(())
    })?;
    Ok(0.5 * both)
}

/// What sending a short message takes the sender.
fn overhead(team: &dyn Team, batches: usize) -> Result<f64, TeamError> {
    let peer = team.rank() ^ 1;
    let mut times = Vec::new();
    for _ in 0..batches {
        let began = Instant::now();
        for _ in 0..BATCH {
            team.send(peer, vec![1; 64])?;
        }
        times.push(began.elapsed().as_secs_f64() / BATCH as f64);
        for _ in 0..BATCH {
            team.receive(peer)?;
        }
    }
    Ok(median(times))
}

fn measured(team: &dyn Team, controls: usize, batches: usize) -> Result<String, TeamError> {
    let together = |bytes: usize| exchange(team, vec![1; 16 + bytes * MEMBERS]).map(drop);
    let shares = Shares::even(MEMBERS * team.size(), team.size());
    let added = || sum(team, &shares, controls, |member| Some(vec![member as f64; controls])).map(drop);

    together(8)?;
    let mut passes = Vec::new();
    for bytes in LENGTHS {
        passes.push(format!("\"{bytes}\": {:.3e}", passed(team, bytes, batches)?));
    }
    let overhead = overhead(team, batches)?;
    // what eight members add up to on a rank is no message
    let alone = median((0..9).map(|_| seconds_of(&|| nastic_team::sum_alone(MEMBERS, controls, |_| Some(vec![1.0; controls])))).collect());
    together(8)?;
    let exchanged = timed(batches, || together(EXCHANGES[0]))?;
    let sum = timed(batches, added)?;
    let iteration = timed(batches, || EXCHANGES.iter().try_for_each(|bytes| together(*bytes)).and_then(|()| added()))?;
    Ok(format!(
        "{{\"ranks\": {}, \"members\": {}, \"controls\": {controls}, \"passes\": {{{}}}, \"overhead\": {overhead:.3e}, \"alone\": {alone:.3e}, \
         \"exchange\": {exchanged:.3e}, \"sum\": {sum:.3e}, \"iteration\": {iteration:.3e}}}",
        team.size(),
        MEMBERS * team.size(),
        passes.join(", ")
    ))
}

fn seconds_of<T>(work: &dyn Fn() -> T) -> f64 {
    let began = Instant::now();
    std::hint::black_box(work());
    began.elapsed().as_secs_f64()
}

fn main() -> ExitCode {
    let number = |at: usize, default: usize| std::env::args().nth(at).map_or(Some(default), |text| text.parse().ok());
    let (Some(controls), Some(batches @ 1..)) = (number(1, 10_000), number(2, 15)) else { return ExitCode::from(2) };
    nastic_mpi::run_on_ranks(move |team| {
        if !team.size().is_multiple_of(2) {
            return Ended { code: 2, error: Some("an even number of ranks, please: they are measured in pairs".to_owned()) };
        }
        match measured(&*team, controls, batches) {
            Ok(line) => {
                let written = if team.leads() { writeln!(std::io::stdout().lock(), "{line}") } else { Ok(()) };
                let error = written.err().map(|error| error.to_string());
                Ended { code: u8::from(error.is_some()), error }
            }
            Err(error) => Ended { code: 9, error: Some(error.to_string()) },
        }
    })
}
