//! Energy terms: passive materials and actuations.
//!
//! A body's energy density is a sum of terms. Each gives, from the one place where it is written, its energy, the first
//! Piola-Kirchhoff stress `P`, the elasticity tensor `dP/dF` and the derivatives `dP/dm` by its slots m: controls of an
//! actuation, numbers of a material, internal variables of a viscous law ([`Role`]).
//! Formulas are three-dimensional throughout; plane strain embeds its gradient before it comes here.
//!
//! A law of one's own implements [`ConvexDensity`] (a function of `F`, `H` and `J` with its partial derivatives) or
//! [`EnergyTerm`] directly, in any crate.

mod actuation;
mod by_parameters;
pub mod catalogue;
pub mod check;
mod design;
mod director;
mod error;
mod existence;
mod field;
pub mod formula;
mod growth;
mod material;
mod matter;
mod moduli;
pub mod network;
mod parametrised;
mod polyconvex;
mod shared;
mod slot;
mod tension_bound;
mod term;
mod viscosity;

pub use actuation::{
    Dielectric, FiberTension, Magnet, MagnetIsochoric, MagnetRotation, PointQuantity, Turgor, dielectric, magnet,
};
pub use by_parameters::{ByParameters, Conversion};
pub use design::{Scale, Weighted};
pub use error::{EnergyError, Outside};
pub use existence::{Existence, Growth};
pub use field::{Entry, Field, MaterialPoint, combine};
pub use growth::{
    Grown, GrowthTensor, KinematicGrowth, ShapeGradient, ShapeMode, ShapeModes, SpontaneousStrain, StrainMap,
    ThermalExpansion,
};
pub use material::*;
pub use matter::{Gradients, Matter, MatterPoint};
pub use moduli::Moduli;
pub use parametrised::{LinearInModuli, Parametrised};
pub use polyconvex::{Block, Change, Conjugates, ConvexDensity, Curvature, Partials};
pub use shared::Shared;
pub use slot::{Role, Scope, Slot, SlotGroup};
pub use tension_bound::TensionBound;
pub use term::{EnergyTerm, PointBatch, Response, Slots, Want};
pub use viscosity::{Evolution, KelvinVoigt, MaxwellBranch, SpringMeasure};
