//! All tests of `nastic-opt`, in one program: `cargo test -p nastic-opt --test all NAME` runs the files and tests whose path has NAME in it.

mod accuracy;
mod bounded;
mod catalogue;
mod common;
mod constraints;
mod constraints_aborted;
mod feedback;
mod ill_posed;
mod inner_products;
mod limits;
mod manifold;
mod mma;
mod properties;
mod published;
mod saved;
mod sets;
mod spectrum;
mod stages;
mod taylor;
mod taylor_second;
mod together;
mod within;
