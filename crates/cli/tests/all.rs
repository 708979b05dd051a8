//! All tests of `nastic-cli`, in one program: `cargo test -p nastic-cli --test all NAME` runs the files and tests whose path has NAME in it.

mod clusters;
mod common;
mod compare;
mod features;
mod figure;
mod keys;
mod memory;
mod new;
mod own_program;
mod program;
#[cfg(target_os = "linux")]
mod progress;
mod remesh;
mod report;
mod resume;
mod signals;
mod start_parts;
mod stopped_motions;
mod sweep;
mod tutorials;
