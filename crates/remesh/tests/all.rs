//! All tests of `nastic-remesh`, in one program: `cargo test -p nastic-remesh --test all NAME` runs the files and tests whose path has NAME in it.

mod common;
mod meshed;
mod mistakes;
mod outlines;
