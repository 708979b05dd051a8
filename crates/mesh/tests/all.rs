//! All tests of `nastic-mesh`, in one program: `cargo test -p nastic-mesh --test all NAME` runs the files and tests whose path has NAME in it.

mod build;
mod columns;
mod distance_grid;
mod elements;
mod generate;
mod least_width;
mod level_body;
mod level_part;
mod locate;
mod obstacle;
mod parts;
mod polyhedron;
mod quadrature;
mod quality;
mod snapshots;
mod spatial;
mod spatial_hausdorff;
mod spatial_self_intersection;
