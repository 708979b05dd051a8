//! [`ControlMap`]: from the unknowns of a control field to values at points, in [`Chain`]s.

mod basis;
pub(crate) mod catalogue;
mod chain;
mod direction;
mod expansion;
mod exponential;
mod filter;
mod held;
mod interpolated;
mod length;
mod mirror;
mod power_law;
mod projection;
mod region_of_cells;
mod skin;
mod space;
mod staged;
mod step;
mod whole_body;

pub use basis::Basis;
pub use catalogue::{MAPS, MapRow};
pub use chain::Chain;
pub use direction::Direction;
pub use expansion::Expansion;
pub use exponential::Exponential;
pub use filter::Filter;
pub use held::Held;
pub use length::Length;
pub(crate) use length::Scaling;
pub use mirror::{Mirror, Plane};
pub use power_law::PowerLaw;
pub use projection::Projection;
pub(crate) use skin::Skin;
pub use space::{SPACES, Space, SpaceRow};
pub use staged::Staged;
pub use step::Step;
pub(crate) use whole_body::WholeBody;

use std::fmt::Debug;
use std::sync::Arc;

/// A differentiable map `y = f(x)` between values of a control field: a link of a [`Chain`].
///
/// Unknowns and values at points are flat, `components * point + component`. A map with a row in [`MAPS`] is held to the contract:
/// `change` is the derivative of `values`, `vjp` its transpose, `second_vjp` the derivative of `vjp`.
pub trait ControlMap: Debug + Send + Sync {
    /// What it does, in words that distinguish two maps of one kind.
    fn describe(&self) -> String;

    /// What bodies that share the field must agree in, in words: all of it, but for a map of which each may have a variant.
    fn shared(&self) -> String {
        self.describe()
    }

    /// `f(x)`.
    fn values(&self, x: &[f64]) -> Vec<f64>;

    /// `f'(x) v`.
    fn change(&self, x: &[f64], v: &[f64]) -> Vec<f64>;

    /// `f'(x)^T g`.
    fn vjp(&self, x: &[f64], g: &[f64]) -> Vec<f64>;

    /// The change of `f'(x)^T g` along a change v of x; `None` of a map whose derivative is constant.
    fn second_vjp(&self, _x: &[f64], _v: &[f64], _g: &[f64]) -> Option<Vec<f64>> {
        None
    }

    /// Whether `second_vjp` is `None`.
    fn is_affine(&self) -> bool {
        true
    }

    /// Number of stages of an optimisation in which it is another map.
    fn stages(&self) -> usize {
        1
    }

    /// The map that it is in a stage, the last one in later stages; `None` of one that stays as it is.
    fn at_stage(&self, _stage: usize) -> Option<Arc<dyn ControlMap>> {
        None
    }

    /// The length that it gives all vectors but zero, if it does.
    fn length(&self) -> Option<f64> {
        None
    }
}
