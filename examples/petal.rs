//! A hard-magnetic petal of four arms, 130 times as long as thick, closes like a flower: its magnetisation is designed,
//! nodal, of one length everywhere and smoothed by an H1 gradient, together with the uniform field that closes it.
//!
//! Every arm shall bend upwards to an arc of 2.2 rad. The start knows nothing of that: magnetised and driven across the
//! plane, where the petal stays flat. `cargo run --release --example petal` prints one line per trial and writes VTU, PVD
//! and pictures to `out/petal`. As a case: `examples/cases/petal.json`.

#![allow(clippy::print_stdout)] // programs talk, libraries do not

use nastic::picture::{Appearance, Body, Colour, Picture, View};
use nastic::prelude::*;

const REMANENCE: f64 = 0.1; // T, everywhere
const FIELD: f64 = 1e-3; // T, at most
const HALF: f64 = 0.03; // m, from the centre to where the arms begin
const ARM: f64 = 0.13; // m
const ANGLE: f64 = 2.2; // rad, by which the arms shall bend

/// Where a point of the flat petal should be: along an arc, keeping its distance from the lower face.
fn closed(x: [f64; 3]) -> [f64; 3] {
    let radius = ARM / ANGLE;
    let axis = if x[0].abs() > x[1].abs() { 0 } else { 1 };
    let (s, side) = ((x[axis].abs() - HALF).max(0.0), x[axis].signum());
    let (sin, cos) = (s / radius).sin_cos();
    let mut out = x;
    out[axis] = side * (x[axis].abs().min(HALF) + (radius - x[2]) * sin);
    out[2] = radius - (radius - x[2]) * cos;
    out
}

fn draw(file: &str, shot: &Snapshot) -> Result<(), Box<dyn std::error::Error>> {
    let arrows = shot.cell_array("B_r").map(|a| a.values.chunks_exact(3).map(|v| [v[0], v[1], v[2]]).collect());
    Picture::new(&format!("Petal, {file}"))
        .subtitle("arrows: remanence in the reference body")
        .body(Body::of("petal", shot).appearance(Appearance::Solid(Colour::BLUE)).lines(false))
        .body(
            Body::new("flat", shot.mesh.clone())
                .appearance(Appearance::Glass(Colour::GREY))
                .arrows(Colour::RED, arrows.unwrap_or_default()),
        )
        .view(View::From([0.5, -1.0, 0.7]))
        .write(format!("out/petal/{file}.png"))?;
    Ok(nastic::io::write_vtu(format!("out/petal/{file}.vtu"), shot)?)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let body = Solid::new(nastic::io::read_gmsh("meshes/petal.msh")?)?
        .material("body", MooneyRivlin::new(5e4, 5e4, 2e5)?)?
        .actuate("body", "magnet", Magnet::new())?
        .clamp("square")?;
    let problem = Reduced::new(body)
        .control("magnet.remanence", Space::Node)?
        .of_length("magnet.remanence", REMANENCE)?
        .control("magnet.field", Space::Uniform)?
        .cost(Tracking::surface("bottom", Target::position(closed)))?
        .metric(Metric::H1 { length: 0.01 })
        .weigh("magnet.field", (REMANENCE / FIELD).powi(2))?;

    let vectors = problem.layout().blocks()[0].len();
    let set = Product::new().block(vectors, Sphere::new(3, REMANENCE)?).block(3, Ball::new(3, FIELD)?);
    let start = [[0.0, 0.0, REMANENCE].repeat(vectors / 3), vec![0.0, 0.0, 0.5 * FIELD]].concat();
    let first = problem.at(&start)?;
    let mut files: Vec<(f64, String)> = Vec::new();
    let print = |trial: &Trial<'_, Evaluated>| {
        println!("{trial}, newton {}", trial.summary.get("newton").unwrap_or(f64::NAN));
        let Some(point) = trial.point.filter(|_| trial.accepted) else { return };
        let name = format!("iteration_{:03}.vtu", trial.iteration);
        let shot = problem.snapshot(point, None);
        if shot.is_ok_and(|shot| nastic::io::write_vtu(format!("out/petal/{name}"), &shot).is_ok()) {
            files.push((trial.iteration as f64, name));
        }
    };
    let best =
        Lbfgs::default().within(set).tolerance(1e-2).max_iterations(30).observe(print).minimize(&problem, &first)?;
    nastic::io::write_pvd("out/petal/iterations.pvd", &files)?;
    let field = &best.m[vectors..];
    println!("{}", best.stop);
    println!(
        "tracking cost {:.4e} -> {:.4e} in a field of ({:.2e}, {:.2e}, {:.2e}) T",
        first.cost(),
        best.cost,
        field[0],
        field[1],
        field[2]
    );
    println!("negative pivots: {}", problem.solid().negative_pivots(best.point.state())?);
    draw("start", &problem.snapshot(&first, None)?)?;
    draw("optimum", &problem.snapshot(&best.point, Some(&best.derivative))?)
}
