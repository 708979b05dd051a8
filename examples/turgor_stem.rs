//! A stem lifts itself: the cells on its lower flank swell and bend it upwards against its own weight, as plants do that
//! were laid flat. The left end is clamped; only a part of the surface is tracked, the right half of the upper skin (the
//! setting of the survey's figure 5). Where the left half goes is left to the stem.
//!
//! A rod of 0.1 m, radius 5 mm; Mooney-Rivlin with shear modulus 0.8 MPa, bulk modulus 6 MPa, share 0.7; own weight
//! 10 kN/m^3. The pressure in each of the ten cells of the flank is between 0 and 2 MPa. The target: bent on an arc of 0.5 rad.
//!
//! `cargo run --release --example turgor_stem` writes `start.vtu`, `optimum.vtu`, `target.vtu` and a picture to
//! `out/turgor_stem`. The same as a case: `examples/cases/turgor_stem.json`.

#![allow(clippy::print_stdout)] // programs talk, libraries do not

use nastic::picture::{Appearance, Body, Colour, Field, Picture};
use nastic::prelude::*;

const LENGTH: f64 = 0.1;
const ANGLE: f64 = 0.5;
/// What jumps of the pressure cost, mm^2/(Pa^2 m): 1 MPa between all neighbours costs 0.7 mm^2.
const ROUGHNESS: f64 = 1e-10;

/// The stem bent on an arc of the angle: its axis keeps its length, its sections stay plane.
fn on_arc(x: [f64; 3]) -> [f64; 3] {
    let radius = LENGTH / ANGLE;
    let (s, c) = (x[0] / radius).sin_cos();
    [(radius - x[2]) * s, x[1], radius - (radius - x[2]) * c]
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let body = Solid::new(nastic::io::read_gmsh("meshes/stem.msh")?)?
        .material("body", MooneyRivlin::from_shear_bulk(0.8e6, 6e6, 0.7)?)?
        .actuate("flank", "turgor", Turgor::new())?
        .body_force("body", Vec3::new(0.0, 0.0, -1e4))?
        .clamp("clamp")?;

    // Over the tracked area: the cost is half the mean squared distance, in square millimetres.
    let weight = 1e6 / body.mesh().surface_area("track")?;
    let tracking = Tracking::surface("track", Target::position(on_arc)).weight(weight);
    let problem = Reduced::new(body)
        .control("turgor", Space::Cell)?
        .cost(tracking)?
        .cost(ControlSmoothness::of("turgor", ROUGHNESS)?)?;

    let start = problem.at(&vec![0.0; problem.layout().len()])?;
    let print = |trial: &Trial<'_, Evaluated>| println!("{trial}");
    let best = Lbfgs::default().within(Bounds::new(0.0, 2e6)?).observe(print).minimize(&problem, &start)?;
    println!("{}", best.stop);
    let distance = |cost: f64| (2.0 * cost).sqrt();
    println!("distance of the tracked part {:.3} mm -> {:.4} mm", distance(start.cost()), distance(best.cost));
    println!("pressures from the clamp on (kPa): {}", kilopascals(&problem, &best.m)?);

    let optimum = problem.snapshot(&best.point, Some(&best.derivative))?;
    let mesh = problem.solid().mesh();
    let bent = mesh.points().iter().map(|x| on_arc(*x)).collect();
    let target = mesh.as_ref().clone().with_points(bent)?.named("target");
    nastic::io::write_vtu("out/turgor_stem/start.vtu", &problem.snapshot(&start, None)?)?;
    nastic::io::write_vtu("out/turgor_stem/optimum.vtu", &optimum)?;
    nastic::io::write_vtu("out/turgor_stem/target.vtu", &Snapshot::new(target.clone()))?;
    let pressure = optimum.cell_array("turgor").map(|a| a.values.clone()).unwrap_or_default();
    Picture::new("A stem lifts itself")
        .subtitle(&format!("{:.2} mm -> {:.3} mm from the target", distance(start.cost()), distance(best.cost)))
        .body(Body::of("start", &problem.snapshot(&start, None)?).appearance(Appearance::Glass(Colour::GREY)))
        .body(Body::new("target", target).appearance(Appearance::Wire(Colour::ORANGE)))
        .body(Body::of("optimum", &optimum).appearance(Appearance::Field(Field::at_cells("turgor", "Pa", pressure))))
        .write("out/turgor_stem/picture.png")?;
    Ok(())
}

/// The pressures of the flank's cells, by distance from the clamp.
fn kilopascals(problem: &Reduced, m: &[f64]) -> Result<String, Box<dyn std::error::Error>> {
    let mesh = problem.solid().mesh();
    let cells = problem.layout().block("turgor")?.basis.entities();
    let place = |cell: &u32| mesh.cell_centre(*cell as usize)[0];
    let mut along: Vec<(f64, f64)> = cells.iter().map(place).zip(m.iter().map(|m| m / 1e3)).collect();
    along.sort_by(|a, b| a.0.total_cmp(&b.0));
    Ok(along.iter().map(|(_, p)| format!("{p:.0}")).collect::<Vec<_>>().join(" "))
}
