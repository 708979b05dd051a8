//! All tests of `nastic-ensemble`, in one program: `cargo test -p nastic-ensemble --test all NAME` runs the files and tests whose path has NAME in it.

mod ensemble;
mod first_order;
mod random_field;
mod teams;
