//! [`Shares`]: which rank owns which members.

use std::ops::Range;

/// A range of members for every rank, in the order of their numbers. Rank 0 owns member 0; ranks beyond the number of members own none.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Shares {
    /// The first member of every rank, and at the end the number of members.
    bounds: Vec<usize>,
}

impl Shares {
    /// Of members that take as much as each other.
    pub fn even(members: usize, ranks: usize) -> Self {
        Self::balanced(&vec![1; members], ranks)
    }

    /// Of members that have taken so much, in any unit that is counted: each boundary where the work before it is nearest to its part of the
    /// whole. Decided by counts alone, so that all ranks decide the same.
    pub fn balanced(work: &[usize], ranks: usize) -> Self {
        let (members, ranks) = (work.len(), ranks.max(1));
        let used = ranks.min(members);
        // what took nothing is there all the same
        let work: Vec<u128> = work.iter().map(|count| (*count).max(1) as u128).collect();
        let whole: u128 = work.iter().sum();
        let (mut bounds, mut at, mut before) = (vec![0], 0, 0);
        for rank in 1..used {
            let aim = whole * rank as u128;
            // every rank has at least one member
            let (least, most) = (bounds[rank - 1] + 1, members - (used - rank));
            while at < most && (at < least || (2 * before + work[at]) * used as u128 <= 2 * aim) {
                before += work[at];
                at += 1;
            }
            bounds.push(at);
        }
        bounds.resize(ranks, members);
        if members == 0 {
            bounds = vec![0; ranks];
        }
        bounds.push(members);
        Self { bounds }
    }

    /// How many members there are.
    pub fn members(&self) -> usize {
        self.bounds.last().copied().unwrap_or(0)
    }

    /// How many ranks there are.
    pub fn ranks(&self) -> usize {
        self.bounds.len() - 1
    }

    /// The members of a rank.
    pub fn of(&self, rank: usize) -> Range<usize> {
        match self.bounds.get(rank..rank + 2) {
            Some([first, end]) => *first..*end,
            _ => 0..0,
        }
    }

    /// The rank that owns a member; 0 of one that there is not.
    pub fn owner(&self, member: usize) -> usize {
        if member >= self.members() { 0 } else { self.bounds.partition_point(|first| *first <= member) - 1 }
    }
}

#[cfg(test)]
mod tests {
    use super::Shares;

    #[test]
    fn every_member_has_one_owner_and_every_rank_one_member_while_there_are_some() {
        for members in 0..40 {
            for ranks in 1..70 {
                let work: Vec<usize> = (0..members).map(|k| k * k % 17).collect();
                for shares in [Shares::even(members, ranks), Shares::balanced(&work, ranks)] {
                    assert_eq!((shares.members(), shares.ranks()), (members, ranks));
                    let all: Vec<usize> = (0..ranks).flat_map(|rank| shares.of(rank)).collect();
                    assert_eq!(all, (0..members).collect::<Vec<_>>());
                    for rank in 0..ranks {
                        assert_eq!(shares.of(rank).is_empty(), rank >= members, "{shares:?}");
                        assert!(shares.of(rank).all(|member| shares.owner(member) == rank));
                    }
                }
            }
        }
    }

    #[test]
    fn counts_balance() {
        assert_eq!(Shares::even(10, 4).of(0), 0..3);
        let shares = Shares::balanced(&[8, 1, 1, 1, 1, 4, 4, 4], 3);
        assert_eq!([shares.of(0), shares.of(1), shares.of(2)], [0..1, 1..6, 6..8]);
    }
}
