//! What deserves attention in states and motions that were found.

mod compression;
mod determination;
mod flight;
mod stillness;
pub mod touches;

pub use compression::compression;
pub use determination::determination;
pub use flight::flight;
pub use stillness::stillness;
