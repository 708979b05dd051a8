//! What several crates share and no library we use has as we need it: vector operations with a fixed order of summation,
//! a seeded random generator, disjoint sets, numbers as text.

mod disjoint_sets;
pub mod format;
mod random;
pub mod vector;

pub use disjoint_sets::DisjointSets;
pub use random::Random;
