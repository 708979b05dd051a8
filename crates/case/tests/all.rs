//! All tests of `nastic-case`, in one program: `cargo test -p nastic-case --test all NAME` runs the files and tests whose path has NAME in it.

mod search_cost;
mod weights;
