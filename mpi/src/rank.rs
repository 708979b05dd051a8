//! [`MpiRank`]: a rank as the program sees it.

use nastic_team::{Team, TeamError};
use std::sync::mpsc::{Sender, channel};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// As good as for ever.
const FOR_EVER: Duration = Duration::from_secs(1 << 32);

/// What the program asks of the thread that calls MPI. The answer goes to the sender; a thread that has gone answers nothing.
pub enum Command {
    /// Send a message to a rank.
    Send(usize, Vec<u8>, Duration, Sender<Result<(), TeamError>>),
    /// Wait for the next one of a rank.
    Receive(usize, Duration, Sender<Result<Vec<u8>, TeamError>>),
}

/// A rank of MPI's world.
#[derive(Debug)]
pub struct MpiRank {
    rank: usize,
    size: usize,
    commands: Mutex<Sender<Command>>,
    limit: Mutex<Duration>,
}

impl MpiRank {
    /// Which of how many; `commands` go to the thread that calls MPI.
    pub fn new((rank, size): (usize, usize), commands: Sender<Command>) -> Self {
        Self { rank, size, commands: Mutex::new(commands), limit: Mutex::new(FOR_EVER) }
    }

    fn ask<T>(&self, command: impl FnOnce(Duration, Sender<Result<T, TeamError>>) -> Command) -> Result<T, TeamError> {
        let (answer, answered) = channel();
        let limit = *self.limit.lock().unwrap_or_else(PoisonError::into_inner);
        let gone = |_| TeamError::Transport { what: "the thread that calls MPI has ended".to_owned() };
        let sent = self.commands.lock().unwrap_or_else(PoisonError::into_inner).send(command(limit, answer));
        sent.map_err(|_| gone(std::sync::mpsc::RecvError))?;
        answered.recv().map_err(gone)?
    }
}

impl Team for MpiRank {
    fn rank(&self) -> usize {
        self.rank
    }

    fn size(&self) -> usize {
        self.size
    }

    fn send(&self, to: usize, message: Vec<u8>) -> Result<(), TeamError> {
        self.ask(|limit, answer| Command::Send(to, message, limit, answer))
    }

    fn receive(&self, from: usize) -> Result<Vec<u8>, TeamError> {
        self.ask(|limit, answer| Command::Receive(from, limit, answer))
    }

    fn wait_at_most(&self, limit: Duration) {
        *self.limit.lock().unwrap_or_else(PoisonError::into_inner) = limit;
    }
}
