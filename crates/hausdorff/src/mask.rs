//! Which parts of a tile are summed.

use super::lanes::WIDTH;
use super::tree::{CHUNK, LEAF};

/// Chunks of a leaf.
const CHUNKS: usize = LEAF / CHUNK;

/// Blocks of one chunk of rows and one chunk of columns each: bit `CHUNKS` i + j for rows i and columns j.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Mask(u16);

impl Mask {
    pub const NONE: Self = Self(0);
    /// The whole tile; also of grids, which may have more rows and columns than a leaf.
    pub const ALL: Self = Self(u16::MAX);

    pub fn insert(&mut self, rows: usize, columns: usize) {
        self.0 |= 1 << (CHUNKS * rows + columns);
    }

    pub fn contains(self, rows: usize, columns: usize) -> bool {
        self.0 >> (CHUNKS * rows + columns) & 1 == 1
    }

    pub fn join(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    pub fn blocks(self) -> usize {
        self.0.count_ones() as usize
    }

    /// Pairs in a tile of so many rows and columns, no more than a leaf has.
    pub fn pairs(self, rows: usize, columns: usize) -> usize {
        let size = |points: usize, chunk: usize| points.saturating_sub(CHUNK * chunk).min(CHUNK);
        let block = |bit: usize| size(rows, bit / CHUNKS) * size(columns, bit % CHUNKS);
        (0..CHUNKS * CHUNKS).filter(|bit| self.0 >> bit & 1 == 1).map(block).sum()
    }

    /// The columns that rows meet, as ranges of vectors; `vectors` in all, with so many numbers each.
    #[inline(always)]
    pub fn runs(self, vectors: usize, lanes: usize) -> Runs {
        let mut runs = [[(0, vectors), (0, 0)]; CHUNKS];
        if self != Self::ALL {
            let each = CHUNK / lanes;
            for (i, runs) in runs.iter_mut().enumerate() {
                let bits = u32::from(self.0) >> (CHUNKS * i) & ((1 << CHUNKS) - 1);
                let (first, after) = run(bits);
                let (second, end) = run(bits >> after << after);
                *runs = [(first * each, vectors.min(after * each)), (second * each, vectors.min(end * each))];
            }
        }
        Runs(runs)
    }
}

/// Ranges of columns for every chunk of rows.
pub(super) struct Runs([[(usize, usize); 2]; CHUNKS]);

impl Runs {
    /// Those that a row meets.
    #[inline(always)]
    pub fn of(&self, row: usize) -> [(usize, usize); 2] {
        self.0[row / CHUNK % CHUNKS]
    }
}

/// The lowest run of ones.
#[inline(always)]
fn run(bits: u32) -> (usize, usize) {
    if bits == 0 {
        return (0, 0);
    }
    let first = bits.trailing_zeros();
    (first as usize, (first + (bits >> first).trailing_ones()) as usize)
}

const _: () =
    assert!(CHUNKS * CHUNKS == 16 && CHUNK.is_multiple_of(2 * WIDTH), "as many bits as blocks, whole vectors");
