//! All tests of `nastic-linear`, in one program: `cargo test -p nastic-linear --test all NAME` runs the files and tests whose path has NAME in it.

mod beyond;
mod direct;
mod eigenpairs;
mod iterative;
mod maxima;
mod single;
mod solvers;
mod structure;
mod support;
mod volume_modes;
