//! All tests of `nastic-fit`, in one program: `cargo test -p nastic-fit --test all NAME` runs the files and tests whose path has NAME in it.

mod evaluations;
mod fibers;
mod synthetic;
mod treloar;
