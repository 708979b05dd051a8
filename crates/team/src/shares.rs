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

    /// Of members that have taken so much, in any unit that is counted: the largest share of a rank is as small as ranges allow, and each boundary as near
    /// as it may be then to where the work before it is its part of the whole. Decided by counts alone, so that all ranks decide the same.
    pub fn balanced(work: &[usize], ranks: usize) -> Self {
        let (members, ranks) = (work.len(), ranks.max(1));
        let used = ranks.min(members);
        let mut before = vec![0_u128];
        // what took nothing is there all the same
        before.extend(work.iter().scan(0, |sum, count| {
            *sum += (*count).max(1) as u128;
            Some(*sum)
        }));
        let earliest = earliest(&before, used);
        let mut bounds = vec![0];
        for rank in 1..used {
            let (from, largest) = (bounds[rank - 1], earliest.largest);
            let end = before.partition_point(|sum| *sum <= before[from] + largest) - 1;
            let (least, most) = (earliest.bounds[rank].max(from + 1), end.min(members - (used - rank)));
            // the nearest to `aim / used`
            let aim = before[members] * rank as u128;
            let above = before.partition_point(|sum| sum * (used as u128) < aim);
            let below = above.saturating_sub(1);
            let nearest = if (before[above] + before[below]) * used as u128 <= 2 * aim { above } else { below };
            bounds.push(nearest.clamp(least, most.max(least)));
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

/// The smallest possible largest share of `used` ranges, one member each at least, and the first members that they may begin with at the earliest.
struct Earliest {
    largest: u128,
    bounds: Vec<usize>,
}

/// By bisection in the largest share; `before` are the sums of the work before every member and of all.
fn earliest(before: &[u128], used: usize) -> Earliest {
    let members = before.len() - 1;
    // from behind, each range as long as it may be
    let begins = |largest: u128| {
        let (mut bounds, mut end) = (vec![0; used], members);
        for rank in (0..used).rev() {
            let begin = before.partition_point(|sum| *sum + largest < before[end]).max(rank);
            (bounds[rank], end) = (begin, begin);
        }
        (end == 0).then_some(bounds)
    };
    let most = before.windows(2).map(|pair| pair[1] - pair[0]).max().unwrap_or(0);
    let (mut low, mut high) = (most, before[members]);
    while low < high {
        let middle = low + (high - low) / 2;
        if begins(middle).is_some() { high = middle } else { low = middle + 1 }
    }
    Earliest { largest: high, bounds: begins(high).unwrap_or_else(|| (0..used).collect()) }
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

    /// Against all ways to cut the members into ranges.
    #[test]
    fn the_largest_share_is_the_smallest_possible() {
        fn best(work: &[usize], ranks: usize) -> usize {
            if ranks == 1 {
                return work.iter().sum();
            }
            let first = |n: usize| work[..n].iter().sum::<usize>().max(best(&work[n..], ranks - 1));
            (1..=work.len() + 1 - ranks).map(first).min().unwrap_or(0)
        }
        let mut number = 1_usize;
        for members in 1..12 {
            for ranks in 1..=members {
                let work: Vec<usize> = (0..members)
                    .map(|_| {
                        number = number * 1_103_515_245 % 2_147_483_647;
                        1 + number % 9
                    })
                    .collect();
                let shares = Shares::balanced(&work, ranks);
                let of = |rank| work[shares.of(rank)].iter().sum::<usize>();
                assert!((0..ranks).all(|rank| !shares.of(rank).is_empty()), "{work:?} {shares:?}");
                assert_eq!((0..ranks).map(of).max(), Some(best(&work, ranks)), "{work:?} {shares:?}");
            }
        }
    }
}
