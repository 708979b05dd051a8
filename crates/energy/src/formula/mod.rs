//! Energies written as formulas of invariants: differentiated symbolically, evaluated as flat programs.

mod differentiate;
mod error;
mod expression;
mod graph;
mod lanes;
mod number;
mod smoothness;
mod tape;

pub use error::{FormulaError, FormulaProblem};
pub use expression::{Expression, Invariant, Step};
pub(crate) use graph::{Graph, Id, MOST_NODES, Node};
pub(crate) use lanes::{LANES, Lanes};
pub use number::Number;
pub(crate) use smoothness::check_smooth;
pub(crate) use tape::Tape;
