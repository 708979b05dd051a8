//! All tests of `nastic`, in one program: `cargo test -p nastic --test all NAME` runs the files and tests whose path has NAME in it.

mod arrows;
mod cases;
mod examples;
mod key_tables;
mod mutation;
mod signatures;
mod structure;
mod test_programs;
