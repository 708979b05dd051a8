//! The one grammar of quantities: `"100 kPa * (X < 0.6 m)"`.
//!
//! ```text
//! comparison = sum [ ("<" | "<=" | ">" | ">=" | "==" | "!=") sum ]        1 or 0; not chained
//! sum        = product { ("+" | "-") product }
//! product    = signed { ("*" | "/") signed }
//! signed     = { "+" | "-" } power                                        -2^2 = -4
//! power      = operand [ "^" signed ]                                     2^3^2 = 2^9
//! operand    = ( NUMBER | "(" comparison ")" | CALL ) [ UNIT [ "^" INTEGER ] ] | NAME | UNIT
//! CALL       = NAME "(" comparison { "," comparison } ")"
//! ```
//!
//! Names: `X Y Z` (reference coordinates), `pi`, `sin cos tan exp log sqrt abs min max`. A unit binds tighter than any
//! operator (`1 N / 2 m` is 0.5 N/m). A number without unit is in the case's units and fits wherever it stands; only
//! what a written unit or a coordinate fixes can contradict.

mod analysis;
mod energy;
mod evaluate;
mod formula;
mod parser;
mod program;
mod token;

pub use energy::EnergyFormula;
pub use evaluate::{EvaluationError, Fault};
pub use formula::dimension_of;
pub use formula::{Formula, FormulaError};
