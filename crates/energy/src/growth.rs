//! Growth: what a body is free of stress at, `G`, where all of its laws see `F G^-1`.

mod grown;
mod kinds;
mod strain_map;

pub use grown::Grown;
pub use kinds::KinematicGrowth;
pub use strain_map::StrainMap;
