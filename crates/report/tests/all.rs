//! All tests of `nastic-report`, in one program: `cargo test -p nastic-report --test all NAME` runs the files and tests whose path has NAME in it.

mod compare;
mod console;
mod iterates;
mod vendor;
