//! Random parameters, the rules that replace them by scenarios, and measures of risk over scenarios.
//!
//! A [`Law`] is one random number (Gamma, Beta, normal), independent of the others. A [`Sample`] is a finite set of
//! nodes with weights that stands for several of them: a tensor or sparse Gauss rule, a Monte Carlo or quasi-Monte
//! Carlo sample. [`StochasticMooneyRivlin`] makes materials of the nodes; every material is a scenario of an
//! ensemble. [`RandomField`] makes a parameter that varies over the body.

mod beta;
mod error;
mod gamma;
mod gauss;
mod lattice;
mod lattice_vector;
mod law;
mod material;
mod normal;
mod random_field;
pub mod risk;
mod sample;
mod smolyak;
mod special;

pub use beta::Beta;
pub use error::StochasticError;
pub use gamma::Gamma;
pub use gauss::gauss_rule;
pub use lattice::MOST_LATTICE_NUMBERS;
pub use law::{CATALOGUE, Law, LawRow};
pub use material::{Inadmissible, MaterialScenario, MaterialScenarios, StochasticMooneyRivlin};
pub use normal::Normal;
pub use random_field::{FieldLaw, Modes, RandomField, UnitModes};
pub use risk::Risk;
pub use sample::Sample;
