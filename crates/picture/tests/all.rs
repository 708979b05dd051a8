//! All tests of `nastic-picture`, in one program: `cargo test -p nastic-picture --test all NAME` runs the files and tests whose path has NAME in it.

mod chart;
mod picture;
mod section;
