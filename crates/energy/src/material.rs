//! Passive materials: every rest state is stress free with zero energy.

mod engineering;
mod mooney_rivlin;
mod neo_hooke;
mod neo_hooke_isochoric;
mod transverse_mooney_rivlin;

pub use mooney_rivlin::MooneyRivlin;
pub use neo_hooke::NeoHooke;
pub use neo_hooke_isochoric::NeoHookeIsochoric;
pub use transverse_mooney_rivlin::TransverseMooneyRivlin;
