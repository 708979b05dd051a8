//! A hard-magnetic T: one magnetisation is designed, cell by cell, that takes the T to its target in a uniform field, or to
//! two targets in two fields. Both targets are made by a magnetisation and fields of ours on another mesh, so that they can
//! be reached; the problem has many local minima, so four starts are run and all of them listed.
//!
//! `cargo run --release --example t_magnet` writes VTU files and pictures to `out/t_magnet`. As cases:
//! `examples/cases/t_magnet.json`, `examples/cases/t_two_loads.json`.

#![allow(clippy::print_stdout)] // programs talk, libraries do not

use nastic::picture::{Appearance, Body, Colour, Picture, View};
use nastic::prelude::*;
use nastic::uncertainty::risk::Mean;
use std::sync::Arc;

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

const REMANENCE: f64 = 0.1; // T, everywhere
const FIELD: f64 = 20e-3; // T, at most
const TARGETS: [(&str, [f64; 3]); 2] = [("lifted", [0.0, 4e-3, 16e-3]), ("lowered", [8e-3, 6e-3, -12e-3])]; // and their fields

fn body(disc: Arc<Discretization>) -> Outcome<Solid> {
    Ok(Solid::on(disc)
        .material("body", MooneyRivlin::new(5e4, 5e4, 2e5)?)?
        .actuate("body", "magnet", Magnet::new())?
        .clamp("clamp")?)
}

/// The magnetisation that makes the targets: along the stem, turning outwards along the arms.
fn known(x: &[f64; 3]) -> [f64; 3] {
    let angle = 2.4 * x[1];
    [REMANENCE * angle.cos(), REMANENCE * angle.sin(), 0.0]
}

/// Tracking of the upper side towards where it goes in a field under the known magnetisation, found on a mesh of
/// tetrahedra. The target is also written as a displacement of our own mesh, for the cases.
fn target(mesh: &Arc<Mesh>, (name, field): (&str, [f64; 3])) -> Outcome<Tracking> {
    let maker = body(Discretization::new(nastic::io::read_gmsh("meshes/t_tet.msh")?.into())?)?;
    let mut controls = maker.controls();
    let at = maker.discretization().points().positions(maker.mesh(), None);
    for (slots, x) in controls.values_mut(0).chunks_exact_mut(6).zip(&at) {
        slots.copy_from_slice(&[known(x), field].concat());
    }
    let u = maker.solve(&controls, &Default::default())?.u.to_vec();
    let ours = |x: &[f64; 3]| maker.mesh().locate(*x).map(|at| at.interpolate(&u, 3)).ok_or("the meshes do not agree");
    let displacement: Vec<[f64; 3]> = mesh.points().iter().map(ours).collect::<Result<_, _>>()?;
    let shot = Snapshot::new(mesh.clone()).with_points("displacement", 3, displacement.concat())?;
    nastic::io::write_vtu(format!("out/t_magnet/target_{name}.vtu"), &shot)?;
    Ok(Tracking::surface("top", Target::moved(maker.mesh().clone(), u)?))
}

fn problem(disc: &Arc<Discretization>, wanted: (&str, [f64; 3])) -> Outcome<Reduced> {
    Ok(Reduced::new(body(disc.clone())?)
        .control("magnet.remanence", Space::Cell)?
        .control("magnet.field", Space::Uniform)?
        .weigh("magnet.field", (REMANENCE / FIELD).powi(2))?
        .cost(target(disc.mesh(), wanted)?)?)
}

/// The state, and the body at rest with its magnetisation as arrows.
fn draw(file: &str, title: &str, shot: &Snapshot) -> Outcome {
    let arrows = shot.cell_array("B_r").map(|a| a.values.chunks_exact(3).map(|v| [v[0], v[1], v[2]]).collect());
    let rest = Body::new("at rest, with its remanence", shot.mesh.clone()).appearance(Appearance::Glass(Colour::GREY));
    Picture::new(title)
        .body(Body::of("in the field", shot).appearance(Appearance::Solid(Colour::BLUE)))
        .body(rest.arrows(Colour::RED, arrows.unwrap_or_default()))
        .view(View::From([0.6, -1.0, 0.6]))
        .write(format!("out/t_magnet/{file}.png"))?;
    Ok(nastic::io::write_vtu(format!("out/t_magnet/{file}.vtu"), shot)?)
}

fn main() -> Outcome {
    let disc = Discretization::new(nastic::io::read_gmsh("meshes/t.msh")?.into())?;
    let cells = disc.mesh().cells();
    let sphere = Sphere::new(3, REMANENCE)?;
    let along = [REMANENCE, 0.0, 0.0].repeat(cells);
    let starts = [along, sphere.random(cells, 1), sphere.random(cells, 2), sphere.random(cells, 3)];
    let upward = [0.0, 0.0, 0.5 * FIELD];

    let one = problem(&disc, TARGETS[0])?;
    let set = Product::new().block(3 * cells, sphere.clone()).block(3, Ball::new(3, FIELD)?);
    let mut search = Lbfgs::default().within(set).max_iterations(300);
    let mut least = f64::INFINITY;
    for (k, start) in starts.iter().enumerate() {
        let start = [start.as_slice(), &upward].concat();
        let first = one.at(&start)?;
        let best = search.minimize(&one, &first)?;
        println!(
            "one target, start {k}: cost {:.3e} -> {:.3e}, {} iterations, {}",
            first.cost(),
            best.cost,
            best.counts.iterations,
            best.stop
        );
        if best.cost < least {
            least = best.cost;
            draw("start", "T, start", &one.snapshot(&first, None)?)?;
            draw("optimum", "T, one target", &one.snapshot(&best.point, Some(&best.derivative))?)?;
        }
    }

    let case = |wanted: (&str, [f64; 3])| {
        Outcome::Ok(LoadCase::new(wanted.0, 1.0, problem(&disc, wanted)?).own("magnet.field"))
    };
    let two = Ensemble::new(Mean).load_cases(vec![case(TARGETS[0])?, case(TARGETS[1])?]).build()?;
    let set = Product::new().block(3 * cells, sphere).block(3, Ball::new(3, FIELD)?).block(3, Ball::new(3, FIELD)?);
    let mut search = Lbfgs::default().within(set).max_iterations(300);
    let mut least = f64::INFINITY;
    for (k, start) in starts.iter().enumerate() {
        let start = [start.as_slice(), &upward, &[0.0, 0.0, -0.5 * FIELD]].concat();
        let first = two.at(&start)?;
        let best = search.minimize(&two, &first)?;
        for (case, (from, to)) in two.members().iter().zip(first.members.iter().zip(&best.point.members)) {
            println!("two targets, start {k}, {}: cost {:.3e} -> {:.3e}", case.name(), from.cost(), to.cost());
        }
        println!("    {} iterations, {}", best.counts.iterations, best.stop);
        if best.cost < least {
            least = best.cost;
            for (case, at) in two.members().iter().zip(&best.point.members) {
                draw(
                    &format!("two_{}", case.name()),
                    &format!("T, two targets: {}", case.name()),
                    &case.problem().snapshot(at, None)?,
                )?;
            }
        }
    }
    Ok(())
}
