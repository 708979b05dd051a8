//! Arrows and lines that a body carries.

use crate::carried::carried;
use nastic_mesh::{NamedArray, Polyline, Snapshot};
use nastic_picture::{Body, Colour};

/// The body with its magnetisation (black, as the body carries it) and an applied field that varies (orange), where there are any; tendons,
/// orange where they pull; springs, green.
#[must_use]
pub fn with_marks(mut drawn: Body, shot: &Snapshot) -> Body {
    let positions = shot.positions();
    for (name, colour) in [("B_r", Colour::INK), ("B_a", FIELD)] {
        let is_one = name == "B_a" && uniform_field(shot).is_some();
        let is_there = |array: &&NamedArray| !is_one && array.values.iter().any(|x| *x != 0.0);
        let Some(array) = shot.cell_array(name).filter(is_there) else {
            continue;
        };
        let vectors = array.values.chunks_exact(3).enumerate().map(|(cell, v)| {
            let v = [v[0], v[1], v[2]];
            if name == "B_r" { carried(&shot.mesh, &positions, cell as u32, v) } else { v }
        });
        drawn = drawn.arrows(colour, vectors.collect());
    }
    for line in &shot.lines {
        let colour = match tension(line) {
            None => Colour::GREEN,
            Some(tension) if tension > 0.0 => Colour::ORANGE,
            Some(_) => Colour::GREY,
        };
        drawn = drawn.polyline(colour, line.points.clone());
    }
    drawn
}

/// The colour of an applied field.
pub const FIELD: Colour = Colour::ORANGE;

/// The applied magnetic field, where it is the same everywhere and not zero.
#[must_use]
pub fn uniform_field(shot: &Snapshot) -> Option<[f64; 3]> {
    let values = shot.cell_array("B_a")?.values.as_chunks::<3>().0;
    let first = *values.first()?;
    let size = first.iter().fold(0.0, |size: f64, x| size.max(x.abs()));
    let is_first = |own: &[f64; 3]| own.iter().zip(first).all(|(a, b)| (a - b).abs() <= 1e-6 * size);
    (size > 0.0 && values.iter().all(is_first)).then_some(first)
}

/// The tension of a tendon; `None` of a spring.
#[must_use]
pub fn tension(line: &Polyline) -> Option<f64> {
    line.quantities.iter().find(|(name, _)| name == "tension").map(|(_, value)| *value)
}
