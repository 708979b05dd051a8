//! Laws with a number of the body in front: densities, fillers, mixtures.

mod scale;
mod weighted;

pub use scale::Scale;
pub use weighted::Weighted;
