//! All tests of `nastic-language`, in one program: `cargo test -p nastic-language --test all NAME` runs the files and tests whose path has NAME in it.

mod case;
mod common;
mod contradictions;
mod energy_formula;
mod expression;
mod hostile;
mod mistakes;
mod schema;
mod syntax;
