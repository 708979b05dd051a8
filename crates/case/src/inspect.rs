//! What deserves attention in states and motions that were found.

mod compression;
mod flight;
mod stillness;

pub use compression::compression;
pub use flight::flight;
pub use stillness::stillness;
