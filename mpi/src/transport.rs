//! Messages through MPI, from the thread that may call it.

use crate::rank::Command;
use mpi::request::scope;
use mpi::topology::{Process, SimpleCommunicator};
use mpi::traits::{Communicator, Destination, MatchedReceiveVec, Source};
use nastic_team::TeamError;
use std::sync::mpsc::Receiver;
use std::time::{Duration, Instant};

/// Longer messages go in pieces: MPI counts with 32 bits. A piece of this length is followed by another one, which may be empty.
const PIECE: usize = 1 << 30;
/// Exit code of a rank that gives up on another: that of `nastic`.
const PARTED: i32 = 9;

/// Does what the program asks for until it has ended. The first failure is the answer to all that comes later.
pub fn serve(world: &SimpleCommunicator, commands: &Receiver<Command>) {
    let mut failed: Option<TeamError> = None;
    for command in commands {
        let left = failed.clone().map_or(Ok(()), Err);
        match command {
            Command::Send(to, message, limit, answer) => {
                let sent = left.and_then(|()| send(world, to, &message, limit));
                failed = sent.clone().err().or(failed);
                let _ = answer.send(sent);
            }
            Command::Receive(from, limit, answer) => {
                let received = left.and_then(|()| receive(world, from, limit));
                failed = received.as_ref().err().cloned().or(failed);
                let _ = answer.send(received);
            }
        }
    }
}

fn process(world: &SimpleCommunicator, rank: usize) -> Result<Process<'_>, TeamError> {
    i32::try_from(rank).map(|rank| world.process_at_rank(rank)).map_err(|_| TeamError::Lost { rank })
}

fn send(world: &SimpleCommunicator, to: usize, message: &[u8], limit: Duration) -> Result<(), TeamError> {
    let process = process(world, to)?;
    let last: &[u8] = if message.len().is_multiple_of(PIECE) { &[] } else { &message[message.len() / PIECE * PIECE..] };
    for piece in message.chunks_exact(PIECE).chain([last]) {
        let mut wait = Wait::new(limit);
        scope(|scope| {
            let mut request = process.immediate_send(scope, piece);
            loop {
                match request.test() {
                    Ok(_) => return,
                    Err(_) if wait.is_over() => {
                        // MPI has the message until it is sent: there is no way back to the program
                        crate::complain(&wait.silent(to).to_string());
                        world.abort(PARTED)
                    }
                    Err(still) => request = still,
                }
                wait.pause();
            }
        });
    }
    Ok(())
}

fn receive(world: &SimpleCommunicator, from: usize, limit: Duration) -> Result<Vec<u8>, TeamError> {
    let (process, mut message) = (process(world, from)?, Vec::new());
    loop {
        let mut wait = Wait::new(limit);
        let piece = loop {
            if let Some(probed) = process.immediate_matched_probe() {
                break probed.matched_receive_vec::<u8>().0;
            }
            if wait.is_over() {
                return Err(wait.silent(from));
            }
            wait.pause();
        };
        let is_last = piece.len() < PIECE;
        message.extend(piece);
        if is_last {
            return Ok(message);
        }
    }
}

/// Waiting for another rank: first eagerly, then without taking a processor from ranks that compute.
struct Wait {
    began: Instant,
    limit: Duration,
}

impl Wait {
    fn new(limit: Duration) -> Self {
        Self { began: Instant::now(), limit }
    }

    fn is_over(&self) -> bool {
        self.began.elapsed() > self.limit
    }

    fn pause(&mut self) {
        // Longer than the shortest sleep takes (some 60 us): two ranks that answer each other would each go to sleep for want of the other's answer.
        const EAGER: Duration = Duration::from_micros(250);
        const LONGEST: Duration = Duration::from_millis(1);
        match self.began.elapsed() {
            waited if waited < EAGER => std::thread::yield_now(),
            waited => std::thread::sleep((waited / 10).min(LONGEST)),
        }
    }

    fn silent(&self, rank: usize) -> TeamError {
        TeamError::Silent { rank, seconds: self.began.elapsed().as_secs() }
    }
}
