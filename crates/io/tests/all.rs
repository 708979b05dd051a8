//! All tests of `nastic-io`, in one program: `cargo test -p nastic-io --test all NAME` runs the files and tests whose path has NAME in it.

mod abaqus;
mod cloud;
mod foreign;
mod gmsh;
mod hostile;
#[cfg(unix)]
mod links;
mod parts;
mod readback;
mod vtk;
mod vtu;
