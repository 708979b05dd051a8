//! A fibre-driven cantilever finds its way to a bar bent on a circular arc, which it cannot reach exactly: the law of the
//! survey's section 4.2.1, fibre tension cell by cell, smoothed Hausdorff distance to a Gmsh mesh.
//!
//! `cargo run --release --example fiber_cantilever` prints one line per trial and writes a picture and VTU files to
//! `out/fiber_cantilever`. The same as a case: `examples/cases/cantilever_arc.json`.

#![allow(clippy::print_stdout)] // programs talk, libraries do not

use nastic::picture::{Appearance, Body, Colour, Field, Picture};
use nastic::prelude::*;
use std::sync::Arc;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // The body: stiff fibres at 45 degrees in the x-y plane, muscle along x. The law itself says how much tension keeps
    // the total energy polyconvex.
    let fiber = Vec3::new(1.0, 1.0, 0.0).normalize();
    let body = Solid::new(nastic::io::read_gmsh("meshes/cantilever.msh")?)?
        .material("body", TransverseMooneyRivlin::new(1e5, 0.2e5, 3e5, 10e5, fiber)?)?
        .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
        .clamp("clamp")?;
    let limit = body.body().fiber_limit(0).ok_or("the law states no bound")?;
    println!("tension stays below 95 % of {limit:.3e} Pa");

    // The target: l = 0.1 m is half the bar's height; the second stage resolves a quarter of it.
    let target = Arc::new(nastic::io::read_gmsh("meshes/target.msh")?);
    let cost = SmoothedHausdorff::to(target.clone()).exponential(0.1).stages([(1.0, 4.0, 4.0), (4.0, 16.0, 8.0)]);
    let distance = cost.clone().bind_to(&body)?;
    let problem = Reduced::new(body).control("tension", Space::Cell)?.cost(cost)?;

    let start = problem.at(&vec![0.0; problem.layout().len()])?;
    let before = distance.true_distance(problem.solid(), &start.state().u)?.distance;

    let set = Bounds::new(-4e5, 0.95 * limit)?;
    let print = |trial: &Trial<'_, Evaluated>| println!("{trial}");
    let best = Lbfgs::default().within(set).tolerance(2e-2).observe(print).minimize(&problem, &start)?;
    let after = distance.true_distance(problem.solid(), &best.point.state().u)?.distance;
    println!("{}", best.stop);
    println!("true Hausdorff distance {before:.4} m -> {after:.4} m");

    let optimum = problem.snapshot(&best.point, Some(&best.derivative))?;
    nastic::io::write_vtu("out/fiber_cantilever/start.vtu", &problem.snapshot(&start, None)?)?;
    nastic::io::write_vtu("out/fiber_cantilever/optimum.vtu", &optimum)?;
    nastic::io::write_vtu("out/fiber_cantilever/target.vtu", &Snapshot::new(target.clone()))?;
    let tension = optimum.cell_array("tension").map(|a| a.values.clone()).unwrap_or_default();
    Picture::new("Fibre-driven cantilever")
        .subtitle(&format!("true Hausdorff distance to the target {before:.3} m -> {after:.4} m"))
        .body(Body::of("start", &problem.snapshot(&start, None)?).appearance(Appearance::Glass(Colour::GREY)))
        .body(Body::new("target", target).appearance(Appearance::Wire(Colour::ORANGE)))
        .body(Body::of("optimum", &optimum).appearance(Appearance::Field(Field::at_cells("tension", "Pa", tension))))
        .write("out/fiber_cantilever/picture.png")?;
    Ok(())
}
