//! Growth: what a body is free of stress at, `G`, where all of its laws see `F G^-1`.

mod grown;
mod growth_tensor;
mod kinds;
mod shape_gradient;
mod shape_modes;
mod spontaneous_strain;
mod strain_map;
mod thermal_expansion;

pub use grown::Grown;
pub use growth_tensor::GrowthTensor;
pub use kinds::KinematicGrowth;
pub use shape_gradient::ShapeGradient;
pub use shape_modes::{ShapeMode, ShapeModes};
pub use spontaneous_strain::SpontaneousStrain;
pub use strain_map::StrainMap;
pub use thermal_expansion::ThermalExpansion;
