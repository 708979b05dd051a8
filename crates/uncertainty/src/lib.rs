//! Random parameters, the rules that replace them by scenarios, and measures of risk over scenarios.
//!
//! A [`Law`] is one random number (Gamma, Beta, normal), independent of the others. A [`Sample`] is a finite set of
//! nodes with weights that stands for several of them: a tensor or sparse Gauss rule, a Monte Carlo or quasi-Monte
//! Carlo sample. [`StochasticMooneyRivlin`] makes materials of the nodes; every material is a scenario of an
//! ensemble. [`LogNormalField`] makes a parameter that varies over the body.

mod beta;
mod error;
mod gamma;
mod gauss;
mod law;
mod log_normal;
mod material;
mod normal;
pub mod risk;
mod sample;
mod smolyak;
mod special;

pub use beta::Beta;
pub use error::StochasticError;
pub use gamma::Gamma;
pub use gauss::gauss_rule;
pub use law::{CATALOGUE, Law, LawRow};
pub use log_normal::{LogNormalField, Modes};
pub use material::{Inadmissible, MaterialScenario, MaterialScenarios, StochasticMooneyRivlin};
pub use normal::Normal;
pub use risk::Risk;
pub use sample::Sample;
