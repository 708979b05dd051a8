//! Passive materials: every rest state is stress free with zero energy.

mod arap;
mod arruda_boyce;
mod convex_network;
mod engineering;
mod fiber_family;
mod formula;
mod gel;
mod gent;
mod guccione;
mod holzapfel_gasser_ogden;
mod isochoric;
mod mooney_rivlin;
mod neo_hooke;
mod neo_hooke_isochoric;
mod ogden;
mod power_trace;
mod saint_venant_kirchhoff;
mod transverse_mooney_rivlin;
mod volumetric;
mod yeoh;

pub use arap::Arap;
pub use arruda_boyce::ArrudaBoyce;
pub use convex_network::ConvexNetwork;
pub use fiber_family::FiberFamily;
pub use formula::FormulaLaw;
pub use gel::Gel;
pub use gent::Gent;
pub use guccione::Guccione;
pub use holzapfel_gasser_ogden::HolzapfelGasserOgden;
pub use mooney_rivlin::MooneyRivlin;
pub use neo_hooke::NeoHooke;
pub use neo_hooke_isochoric::NeoHookeIsochoric;
pub use ogden::Ogden;
pub use saint_venant_kirchhoff::SaintVenantKirchhoff;
pub use transverse_mooney_rivlin::TransverseMooneyRivlin;
pub use yeoh::Yeoh;
