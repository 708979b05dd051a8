//! 3x3 kinematics, the tensor cross product and elasticity tensors.
//!
//! Constitutive code is always three-dimensional: plane strain embeds its gradient as `diag(F_2x2, 1)` before it gets
//! here. A matrix index pair is written `(i, J)`: row `i` lives in space, column `J` in the reference body.
//!
//! The tensor cross product is that of Bonet, Gil & Ortigosa, *A computational framework for polyconvex large strain
//! elasticity*, Comput. Methods Appl. Mech. Engrg. 283 (2015), doi 10.1016/j.cma.2014.10.002.

mod cross;
mod hyper_dual;
mod kinematics;
mod polar;
mod spectrum;
mod tangent;

pub use cross::{cofactor, cross};
pub use hyper_dual::{HyperDual, Scalar};
pub use kinematics::{Inverted, Kinematics};
pub use polar::polar_rotation;
pub use spectrum::SymmetricSpectrum;
pub use tangent::Tangent;

/// A vector of three components.
pub type Vec3 = nalgebra::Vector3<f64>;
/// A two-point tensor, `m[(i, J)]`.
pub type Mat3 = nalgebra::Matrix3<f64>;
