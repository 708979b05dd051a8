//! A rigid cylinder and a rigid ball on a half-space beside Hertz, without a contact layer and with one, as rows of a table.
//!
//! `cargo bench --bench hertz -- dim=3 fine=4,6,8 far=400 radius=50 thickness=0.01`: contact radius (half-width) 1, `fine` cells across it, all even; the
//! body, clamped there, reaches `far`; `thickness` of the layer in depths. Ratios of what is found to closed forms: of a ball force and largest pressure by the
//! depth, of a cylinder (`dim=2`) the largest pressure by the force; of the layer to without. Then both extrapolated by h^2, and of a ball the offset of layers
//! of `stiffness=4,16,64` largest pressures on the first mesh, in their thicknesses, beside `1 - (2/3) sqrt(p0/k)`. `what=shear fine=16,32`: the cylinder drawn
//! along the half-space, the half-width of what sticks beside Cattaneo and Mindlin.

#![allow(clippy::print_stdout)] // programs talk, libraries do not
#![allow(dead_code)] // shared with tests

mod common;
#[path = "../crates/fem/tests/common/half_space.rs"]
mod half_space;
#[path = "../crates/fem/tests/common/indentation.rs"]
mod indentation;
#[path = "../crates/fem/tests/common/sheared.rs"]
mod sheared;

use common::Arguments;
use indentation::{BALL, CYLINDER, Carried, Indentation, extrapolated};
use sheared::Sheared;
use std::time::Instant;

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    let arguments = Arguments::read(&["what", "dim", "fine", "far", "radius", "thickness", "stiffness", "threads"])?;
    arguments.use_threads()?;
    let number = |key: &str, default: &str| -> Result<f64, Failure> { Ok(arguments.text(key, default).parse()?) };
    if arguments.text("what", "press") == "shear" {
        return shear(&arguments, number("far", "200")?);
    }
    let like = if arguments.number("dim", 3)? == 2 { CYLINDER } else { BALL };
    let of = Indentation {
        far: number("far", "400")?,
        radius: number("radius", "50")?,
        thickness: number("thickness", "0.01")?,
        ..like
    };
    let (mut forces, mut pressures, mut first) = (Vec::new(), Vec::new(), None);
    println!(
        "| a/h | force | largest pressure | contact radius | layer: force | contact radius | Newton iterations | s |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for fine in arguments.text("fine", "4,6,8").split(',') {
        let of = Indentation { fine: fine.parse()?, ..of };
        let clock = Instant::now();
        let [layered, exact] = of.press()?;
        let seconds = clock.elapsed().as_secs_f64();
        let [force, pressure] = ratios(&of, &exact);
        println!(
            "| {fine} | {force:.4} | {pressure:.4} | {} | {:.4} | {} | {} | {seconds:.1} |",
            radius(&of, &exact),
            layered.force / exact.force,
            radius(&of, &layered),
            exact.newton,
        );
        forces.push((of.cell(), force));
        pressures.push((of.cell(), pressure));
        first.get_or_insert((of, exact));
    }
    println!("| 0 | {:.4} | {:.4} | | | | | |", extrapolated(&forces), extrapolated(&pressures));
    if let Some((of, exact)) = first.filter(|(of, _)| of.dim == 3) {
        offsets(&arguments, &of, &exact)?;
    }
    Ok(())
}

/// Force and largest pressure over those of closed forms; the force of a cylinder is what these begin with.
fn ratios(of: &Indentation, found: &Carried) -> [f64; 2] {
    match of.dim {
        3 => {
            let [force, pressure] = of.of_ball(of.depth());
            [found.force / force, found.largest_pressure / pressure]
        }
        _ => [1.0, found.largest_pressure / of.of_cylinder(found.force)[1]],
    }
}

/// Between the last node that is pressed and the first that is not, over that of the closed form.
fn radius(of: &Indentation, found: &Carried) -> String {
    let expected = if of.dim == 3 { 1.0 } else { of.of_cylinder(found.force)[0] };
    format!("{:.3} to {:.3}", found.radius[0] / expected, found.radius[1] / expected)
}

fn offsets(arguments: &Arguments, of: &Indentation, exact: &Carried) -> Result<(), Failure> {
    const THICKNESS: f64 = 0.02;
    // by how much the force on this mesh grows with the depth
    let [_, deeper] = Indentation { deep: 1.0 + THICKNESS, ..*of }.press()?;
    let power = (deeper.force / exact.force).ln() / (1.0 + THICKNESS).ln();
    for stiffness in arguments.text("stiffness", "4,16,64").split(',') {
        let share: f64 = stiffness.parse()?;
        let [layered, _] = Indentation { stiffness: Some(share), thickness: THICKNESS, ..*of }.press()?;
        let offset = ((layered.force / exact.force).powf(1.0 / power) - 1.0) / THICKNESS;
        println!("k/p0 {stiffness}: offset {offset:.4}, closed form {:.4}", 1.0 - 2.0 / 3.0 / share.sqrt());
    }
    Ok(())
}

fn shear(arguments: &Arguments, far: f64) -> Result<(), Failure> {
    println!("| a/h | Q/(mu P) | half-width that sticks | by nodes, in cells more | Newton iterations |");
    println!("|---|---|---|---|---|");
    for fine in arguments.text("fine", "16,32").split(',') {
        let of = Sheared { fine: fine.parse()?, far };
        for at in of.run()? {
            let [sticks, slides] = at.found.map(|found| (found - at.expected) / of.cell());
            println!("| {fine} | {:.3} | {:.4} | {sticks:.2} to {slides:.2} | {} |", at.share, at.expected, at.newton);
        }
    }
    Ok(())
}
