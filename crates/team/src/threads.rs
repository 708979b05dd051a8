//! Ranks that are threads of one process: for tests of everything that ranks do, with counted messages and planted faults.

use crate::error::TeamError;
use crate::team::Team;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// A stand-in for ever.
const FOR_EVER: Duration = Duration::from_secs(3600);

/// What goes wrong, by rank; the number of a message counts what that rank sends and receives, from 0 on.
#[derive(Clone, Debug, Default)]
pub struct Faults {
    /// The rank that ends at this message.
    pub lost: Option<(usize, usize)>,
    /// The message of a rank that never arrives.
    pub dropped: Option<(usize, usize)>,
    /// A rank that waits so long before every message it sends.
    pub slow: Option<(usize, Duration)>,
    /// How long messages are waited for, whatever [`Team::wait_at_most`] says.
    pub patience: Option<Duration>,
}

/// Messages and bytes that were sent by all ranks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Traffic {
    /// Messages.
    pub messages: usize,
    /// Their bytes, without what a network adds.
    pub bytes: usize,
}

#[derive(Debug, Default)]
struct Counters {
    messages: AtomicUsize,
    bytes: AtomicUsize,
}

/// A message behind its number among those of the same two ranks.
type Numbered = (usize, Vec<u8>);

/// One of the threads. Once it is dropped it is lost to the others.
#[derive(Debug)]
pub struct ThreadRank {
    rank: usize,
    to: Vec<Mutex<Option<Sender<Numbered>>>>,
    from: Vec<Mutex<Receiver<Numbered>>>,
    /// Messages sent to, and received from, every other rank: one that was left out shows.
    sent: Vec<AtomicUsize>,
    received: Vec<AtomicUsize>,
    done: AtomicUsize,
    ended: AtomicBool,
    limit: Mutex<Duration>,
    faults: Faults,
    counters: Arc<Counters>,
}

/// Calls `work` in so many threads, each with its rank; what they gave, by rank. A thread that panics passes that on.
pub fn run<T: Send>(size: usize, faults: &Faults, work: impl Fn(ThreadRank) -> T + Sync) -> Vec<T> {
    let (ranks, work) = (ranks(size, faults), &work);
    std::thread::scope(|scope| {
        let threads: Vec<_> = ranks.into_iter().map(|rank| scope.spawn(move || work(rank))).collect();
        let join = |thread: std::thread::ScopedJoinHandle<'_, T>| {
            thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
        };
        threads.into_iter().map(join).collect()
    })
}

/// The ranks of a team, for threads that are started elsewhere.
pub fn ranks(size: usize, faults: &Faults) -> Vec<ThreadRank> {
    let counters = Arc::new(Counters::default());
    let counts = || (0..size).map(|_| AtomicUsize::new(0)).collect();
    let rank = |rank| ThreadRank {
        rank,
        to: Vec::with_capacity(size),
        from: Vec::with_capacity(size),
        sent: counts(),
        received: counts(),
        done: AtomicUsize::new(0),
        ended: AtomicBool::new(false),
        limit: Mutex::new(faults.patience.unwrap_or(FOR_EVER)),
        faults: faults.clone(),
        counters: counters.clone(),
    };
    let mut ranks: Vec<ThreadRank> = (0..size).map(rank).collect();
    for to in 0..size {
        for from in 0..size {
            let (sender, receiver) = channel();
            ranks[from].to.push(Mutex::new(Some(sender)));
            ranks[to].from.push(Mutex::new(receiver));
        }
    }
    ranks
}

impl ThreadRank {
    /// What all ranks have sent so far.
    pub fn traffic(&self) -> Traffic {
        let Counters { messages, bytes } = &*self.counters;
        Traffic { messages: messages.load(Ordering::Relaxed), bytes: bytes.load(Ordering::Relaxed) }
    }

    /// The number of the next message, unless the rank has ended or ends at it.
    fn next(&self) -> Result<usize, TeamError> {
        let number = self.done.fetch_add(1, Ordering::Relaxed);
        if self.faults.lost == Some((self.rank, number)) {
            self.end();
        }
        if self.ended.load(Ordering::Relaxed) { Err(TeamError::Lost { rank: self.rank }) } else { Ok(number) }
    }

    /// Nothing is sent from here on: the others find it gone.
    fn end(&self) {
        self.ended.store(true, Ordering::Relaxed);
        self.to.iter().for_each(|to| drop(to.lock().unwrap_or_else(PoisonError::into_inner).take()));
    }

    fn failed<T>(&self, error: TeamError) -> Result<T, TeamError> {
        self.end();
        Err(error)
    }
}

impl Team for ThreadRank {
    fn rank(&self) -> usize {
        self.rank
    }

    fn size(&self) -> usize {
        self.to.len()
    }

    fn send(&self, to: usize, message: Vec<u8>) -> Result<(), TeamError> {
        let number = self.next()?;
        if let Some((_, wait)) = self.faults.slow.filter(|(rank, _)| *rank == self.rank) {
            std::thread::sleep(wait);
        }
        self.counters.messages.fetch_add(1, Ordering::Relaxed);
        self.counters.bytes.fetch_add(message.len(), Ordering::Relaxed);
        let count = self.sent[to].fetch_add(1, Ordering::Relaxed);
        if self.faults.dropped == Some((self.rank, number)) {
            return Ok(());
        }
        let sender = self.to[to].lock().unwrap_or_else(PoisonError::into_inner);
        let sent = sender.as_ref().is_some_and(|sender| sender.send((count, message)).is_ok());
        drop(sender);
        if sent { Ok(()) } else { self.failed(TeamError::Lost { rank: to }) }
    }

    fn receive(&self, from: usize) -> Result<Vec<u8>, TeamError> {
        self.next()?;
        let limit = *self.limit.lock().unwrap_or_else(PoisonError::into_inner);
        let due = self.received[from].fetch_add(1, Ordering::Relaxed);
        let came = self.from[from].lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(limit);
        match came {
            Ok((count, message)) if count == due => Ok(message),
            Ok(_) => self.failed(TeamError::Unexpected { rank: from, what: "one before it is missing" }),
            Err(RecvTimeoutError::Disconnected) => self.failed(TeamError::Lost { rank: from }),
            Err(RecvTimeoutError::Timeout) => self.failed(TeamError::Silent { rank: from, seconds: limit.as_secs() }),
        }
    }

    fn wait_at_most(&self, limit: Duration) {
        *self.limit.lock().unwrap_or_else(PoisonError::into_inner) = self.faults.patience.unwrap_or(limit);
    }
}
