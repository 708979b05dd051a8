//! Disjoint sets of the numbers 0 to n - 1 (union-find).

/// Sets that are merged pair by pair. The smallest member represents its set, so that the outcome does not depend on the
/// order of the unions.
#[derive(Clone, Debug)]
pub struct DisjointSets {
    parent: Vec<u32>,
}

impl DisjointSets {
    /// `n` sets of one member each.
    pub fn new(n: usize) -> Self {
        Self { parent: (0..n as u32).collect() }
    }

    /// The smallest member of the set of `member`. Halves the path on the way (Tarjan & van Leeuwen 1984).
    ///
    /// # Panics
    /// If there is no such member, as slices do.
    pub fn find(&mut self, member: u32) -> u32 {
        let mut at = member;
        while self.parent[at as usize] != at {
            let grandparent = self.parent[self.parent[at as usize] as usize];
            self.parent[at as usize] = grandparent;
            at = grandparent;
        }
        at
    }

    /// Merges the sets of two members.
    ///
    /// # Panics
    /// If there is no such member, as slices do.
    pub fn union(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find(a), self.find(b));
        self.parent[a.max(b) as usize] = a.min(b);
    }
}

#[cfg(test)]
mod tests {
    use super::DisjointSets;

    #[test]
    fn the_smallest_member_represents_whatever_the_order() {
        let pairs = [(6, 4), (1, 6), (3, 2), (7, 1), (5, 5)];
        let representatives = |pairs: &mut dyn Iterator<Item = (u32, u32)>| {
            let mut sets = DisjointSets::new(8);
            pairs.for_each(|(a, b)| sets.union(a, b));
            (0..8).map(|i| sets.find(i)).collect::<Vec<_>>()
        };
        assert_eq!(representatives(&mut pairs.into_iter()), [0, 1, 2, 2, 1, 5, 1, 1]);
        assert_eq!(representatives(&mut pairs.into_iter().rev().map(|(a, b)| (b, a))), [0, 1, 2, 2, 1, 5, 1, 1]);
    }
}
