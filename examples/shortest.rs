//! The shortest program: a Gmsh bar, one actuation, a target shape, the optimal tension.
//!
//! `cargo run --release --example shortest` writes `out/shortest/optimum.vtu`.

#![allow(clippy::print_stdout)] // programs talk, libraries do not

use nastic::prelude::*;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let fiber = Vec3::new(1.0, 1.0, 0.0).normalize();
    let body = Solid::new(nastic::io::read_gmsh("meshes/cantilever.msh")?)?
        .material("body", TransverseMooneyRivlin::new(1e5, 0.2e5, 3e5, 10e5, fiber)?)?
        .actuate("body", "tension", FiberTension::along(Vec3::x())?)?
        .clamp("clamp")?;
    let target = nastic::io::read_gmsh("meshes/target.msh")?;
    let problem =
        Reduced::new(body).control("tension", Space::Cell)?.cost(SmoothedHausdorff::to(target).exponential(0.1))?;
    let best = Lbfgs::default().within(Bounds::new(-4e5, 1.9e5)?).minimize(&problem, 0.0)?;
    println!("{}", best.stop);
    println!("cost {:.4} after {} iterations", best.cost, best.counts.iterations);
    nastic::io::write_vtu("out/shortest/optimum.vtu", &problem.snapshot(&best.point, Some(&best.derivative))?)?;
    Ok(())
}
