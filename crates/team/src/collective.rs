//! What all ranks do together: [`gather`], [`broadcast`], [`exchange`].

use crate::error::TeamError;
use crate::team::Team;

/// The messages of all ranks, in their order, at rank 0; nothing elsewhere. `size - 1` messages, each straight to rank 0: of states that are megabytes no rank
/// between has to hold those of others.
///
/// # Errors
/// A rank has ended.
pub fn gather(team: &dyn Team, own: Vec<u8>) -> Result<Option<Vec<Vec<u8>>>, TeamError> {
    if !team.leads() {
        return team.send(0, own).map(|()| None);
    }
    let others = (1..team.size()).map(|rank| team.receive(rank));
    std::iter::once(Ok(own)).chain(others).collect::<Result<_, _>>().map(Some)
}

/// The message of rank 0 at all ranks, passed on along a binary tree: `size - 1` messages. What the others give is not looked at.
///
/// # Errors
/// A rank has ended.
pub fn broadcast(team: &dyn Team, message: Vec<u8>) -> Result<Vec<u8>, TeamError> {
    let (rank, size) = (team.rank(), team.size());
    // Rank r hears of it from the rank without r's lowest bit, and tells those with one more bit below that.
    let lowest = if rank == 0 { size.next_power_of_two() } else { 1 << rank.trailing_zeros() };
    let message = if rank == 0 { message } else { team.receive(rank - lowest)? };
    let mut bit = lowest / 2;
    while bit > 0 {
        if rank + bit < size {
            team.send(rank + bit, message.clone())?;
        }
        bit /= 2;
    }
    Ok(message)
}

/// The messages of all ranks, in their order, at all ranks. Rank r passes on what it knows of the ranks from r on to the rank 1, 2, 4, .. before it: so all know
/// everything after `ceil(log2 size)` rounds, in each of which every rank sends one message and receives one, and no message is sent twice to
/// the same rank (J. Bruck, C.-T. Ho, S. Kipnis, E. Upfal, D. Weathersby, IEEE Trans. Parallel Distrib. Syst. 8, 1997, 1143-1156).
///
/// # Errors
/// A rank has ended; what came is no list.
pub fn exchange(team: &dyn Team, own: Vec<u8>) -> Result<Vec<Vec<u8>>, TeamError> {
    let (rank, size) = (team.rank(), team.size());
    // those of this rank, the next one, ..
    let (mut known, mut step) = (vec![own], 1);
    while step < size {
        let count = step.min(size - step);
        let (to, from) = ((rank + size - step) % size, (rank + step) % size);
        let message = packed(&known[..count]);
        // A long message may not leave before it is received. Ranks a step apart form rings, in each of which some rank receives first.
        let came = if (rank / step).is_multiple_of(2) {
            team.send(to, message)?;
            team.receive(from)?
        } else {
            let came = team.receive(from)?;
            team.send(to, message)?;
            came
        };
        known.extend(unpacked(from, &came, count)?);
        step *= 2;
    }
    known.rotate_right(rank);
    Ok(known)
}

/// Messages, each behind its length.
fn packed(messages: &[Vec<u8>]) -> Vec<u8> {
    messages.iter().flat_map(|one| (one.len() as u64).to_le_bytes().into_iter().chain(one.iter().copied())).collect()
}

/// So many messages, each behind its length, that came from a rank.
fn unpacked(rank: usize, mut bytes: &[u8], count: usize) -> Result<Vec<Vec<u8>>, TeamError> {
    let mut one = || {
        let (length, rest) = bytes.split_first_chunk::<8>()?;
        let (message, rest) = rest.split_at_checked(usize::try_from(u64::from_le_bytes(*length)).ok()?)?;
        bytes = rest;
        Some(message.to_vec())
    };
    let all: Option<Vec<_>> = (0..count).map(|_| one()).collect();
    all.filter(|_| bytes.is_empty()).ok_or(TeamError::Unexpected { rank, what: "a list of another length" })
}
