//! Sums of vectors along the binary tree of the members' numbers.
//!
//! The node of `2^k` members from `s` on, a multiple of `2^k`, is the sum of its two halves; members that have no vector are left out, not
//! zero. Nothing but the numbers decides what is added to what, so the bits are those of one rank for any ranks and any ranges.

use crate::collective::broadcast;
use crate::error::TeamError;
use crate::shares::Shares;
use crate::team::Team;

/// The sum over `0..members`; zero where no member has a vector. At most one vector for every level of the tree is held at once.
pub fn sum_alone(members: usize, len: usize, mut leaf: impl FnMut(usize) -> Option<Vec<f64>>) -> Vec<f64> {
    node_alone(0, members.next_power_of_two(), members, &mut leaf).unwrap_or_else(|| vec![0.0; len])
}

fn node_alone(
    first: usize,
    size: usize,
    members: usize,
    leaf: &mut dyn FnMut(usize) -> Option<Vec<f64>>,
) -> Option<Vec<f64>> {
    match size {
        _ if first >= members => None,
        1 => leaf(first),
        _ => {
            let left = node_alone(first, size / 2, members, leaf);
            joined(left, node_alone(first + size / 2, size / 2, members, leaf))
        }
    }
}

fn joined(left: Option<Vec<f64>>, right: Option<Vec<f64>>) -> Option<Vec<f64>> {
    match (left, right) {
        (Some(mut left), Some(right)) => {
            left.iter_mut().zip(&right).for_each(|(left, right)| *left += right);
            Some(left)
        }
        (left, right) => left.or(right),
    }
}

/// The same sum over the members of all ranks, at all ranks; `leaf` is asked for this rank's own members alone. The owner of a node's first member
/// adds its halves, and is sent the second half by the owner of that one's first member: [`messages_of_sum`].
///
/// # Errors
/// A rank has ended; a vector of another length came.
pub fn sum(
    team: &dyn Team,
    shares: &Shares,
    len: usize,
    mut leaf: impl FnMut(usize) -> Option<Vec<f64>>,
) -> Result<Vec<f64>, TeamError> {
    if team.size() == 1 {
        return Ok(sum_alone(shares.members(), len, leaf));
    }
    let mut tree = Tree { team, shares, len, leaf: &mut leaf };
    let root = tree.node(0, shares.members().next_power_of_two())?;
    let bytes = broadcast(team, packed(root.as_deref()))?;
    Ok(unpacked(&bytes, len, 0)?.unwrap_or_else(|| vec![0.0; len]))
}

struct Tree<'t> {
    team: &'t dyn Team,
    shares: &'t Shares,
    len: usize,
    leaf: &'t mut dyn FnMut(usize) -> Option<Vec<f64>>,
}

impl Tree<'_> {
    /// The sum of a node at the owner of its first member, nothing elsewhere.
    fn node(&mut self, first: usize, size: usize) -> Result<Option<Vec<f64>>, TeamError> {
        let (own, members) = (self.shares.of(self.team.rank()), self.shares.members());
        let end = (first + size).min(members);
        if first >= end || own.end <= first || end <= own.start {
            return Ok(None);
        }
        if own.start <= first && end <= own.end {
            return Ok(node_alone(first, size, members, self.leaf));
        }
        let half = first + size / 2;
        let left = self.node(first, size / 2)?;
        if half >= members {
            return Ok(left);
        }
        let right = self.node(half, size / 2)?;
        let (here, to, from) = (self.team.rank(), self.shares.owner(first), self.shares.owner(half));
        match () {
            () if to == from => Ok(if here == to { joined(left, right) } else { None }),
            () if here == from => self.team.send(to, packed(right.as_deref())).map(|()| None),
            () if here == to => Ok(joined(left, unpacked(&self.team.receive(from)?, self.len, from)?)),
            () => Ok(None),
        }
    }
}

/// How many messages a [`sum`] takes: one for every node whose halves begin with members of different ranks, and one for every rank but the first, which
/// hears of the sum.
pub fn messages_of_sum(shares: &Shares) -> usize {
    fn crossing(shares: &Shares, first: usize, size: usize) -> usize {
        let half = first + size / 2;
        if size == 1 || first >= shares.members() {
            return 0;
        }
        let own = half < shares.members() && shares.owner(first) != shares.owner(half);
        usize::from(own) + crossing(shares, first, size / 2) + crossing(shares, half, size / 2)
    }
    crossing(shares, 0, shares.members().next_power_of_two()) + shares.ranks() - 1
}

/// Nothing is no bytes.
fn packed(vector: Option<&[f64]>) -> Vec<u8> {
    vector.unwrap_or_default().iter().flat_map(|x| x.to_le_bytes()).collect()
}

fn unpacked(bytes: &[u8], len: usize, rank: usize) -> Result<Option<Vec<f64>>, TeamError> {
    let (numbers, rest) = bytes.as_chunks::<8>();
    match () {
        () if bytes.is_empty() => Ok(None),
        () if numbers.len() == len && rest.is_empty() => {
            Ok(Some(numbers.iter().map(|x| f64::from_le_bytes(*x)).collect()))
        }
        () => Err(TeamError::Unexpected { rank, what: "a vector of another length" }),
    }
}
