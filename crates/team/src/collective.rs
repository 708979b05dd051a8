//! What all ranks do together: [`gather`], [`broadcast`], [`exchange`].

use crate::error::TeamError;
use crate::team::Team;

/// The messages of all ranks, in their order, at rank 0; nothing elsewhere. `size - 1` messages.
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

/// The messages of all ranks, in their order, at all ranks: gathered at rank 0 and sent to all, `2 (size - 1)` messages.
///
/// # Errors
/// A rank has ended; what came is no list.
pub fn exchange(team: &dyn Team, own: Vec<u8>) -> Result<Vec<Vec<u8>>, TeamError> {
    if team.size() == 1 {
        return Ok(vec![own]);
    }
    let packed = gather(team, own)?.map(|all| {
        let with_length = |one: Vec<u8>| (one.len() as u64).to_le_bytes().into_iter().chain(one);
        all.into_iter().flat_map(with_length).collect()
    });
    unpacked(&broadcast(team, packed.unwrap_or_default())?, team.size())
}

/// So many messages, each behind its length.
fn unpacked(mut bytes: &[u8], count: usize) -> Result<Vec<Vec<u8>>, TeamError> {
    let mut one = || {
        let (length, rest) = bytes.split_first_chunk::<8>()?;
        let (message, rest) = rest.split_at_checked(usize::try_from(u64::from_le_bytes(*length)).ok()?)?;
        bytes = rest;
        Some(message.to_vec())
    };
    let all: Option<Vec<_>> = (0..count).map(|_| one()).collect();
    all.filter(|_| bytes.is_empty()).ok_or(TeamError::Unexpected { rank: 0, what: "a list of another length" })
}
