//! Energies written as formulas of invariants: differentiated symbolically, evaluated as flat programs.

mod differentiate;
mod error;
mod expression;
mod graph;
mod hyper_dual;
mod lanes;
mod smoothness;
mod tape;

pub use error::{FormulaError, FormulaProblem};
pub use expression::{Expression, Invariant, Step};
pub(crate) use graph::{Graph, Id, MOST_NODES, Node};
pub use hyper_dual::{HyperDual, Number};
pub(crate) use lanes::{LANES, Lanes};
pub(crate) use smoothness::check_smooth;
pub(crate) use tape::Tape;
