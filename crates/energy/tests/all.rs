//! All tests of `nastic-energy`, in one program: `cargo test -p nastic-energy --test all NAME` runs the files and tests whose path has NAME in it.

mod checks_catch;
mod closed_forms;
mod contract;
mod convex_network;
mod fiber_limit;
mod growth;
mod law_parameters;
mod magnet;
mod matter;
mod parameters;
mod rubber_laws;
mod viscosity;
mod weighted;
