//! All tests of `nastic-uncertainty`, in one program: `cargo test -p nastic-uncertainty --test all NAME` runs the files and tests whose path has NAME in it.

mod lattice;
mod risk;
mod stochastic;
mod stochastic_field;
