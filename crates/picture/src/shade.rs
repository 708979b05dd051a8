//! Shading: a key light from the upper left, a head light, a weak specular term.

use super::colour::{Colour, Linear};
use super::vector::{V3, dot};

/// Direction to the lamp, as (right, up, towards the eye); unit.
const LAMP: V3 = [-0.434, 0.651, 0.623];

/// The colour of a surface with that normal (camera coordinates; either side is lit).
pub(super) fn lit(colour: Linear, normal: V3) -> Linear {
    let facing = if normal[2] < 0.0 { -1.0 } else { 1.0 };
    let normal = normal.map(|x| x * facing);
    let lamp = dot(normal, LAMP).max(0.0);
    let light = 0.40 + 0.24 * normal[2] + 0.46 * lamp;
    // Halfway between lamp and eye.
    let half = [LAMP[0], LAMP[1], LAMP[2] + 1.0];
    let size = dot(half, half).sqrt();
    let shine = 0.07 * (dot(normal, half) / size).max(0.0).powi(30);
    colour.map(|c| (f64::from(c) * light + shine).min(1.0) as f32)
}

/// Opacity of glass: more where it is seen edge-on.
pub(super) fn glass(normal: V3) -> f32 {
    let edge_on = 1.0 - normal[2].abs().min(1.0);
    (0.28 + 0.30 * edge_on * edge_on) as f32
}

/// What is drawn on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ground {
    /// A light grey that darkens a little towards the bottom.
    Shaded,
    White,
}

impl Ground {
    /// The colour at a height of 0 (top) to 1 (bottom).
    pub fn at(self, height: f64) -> Colour {
        let mix = |a: f64, b: f64| (a + (b - a) * height) as u8;
        match self {
            Self::Shaded => Colour([mix(252.0, 234.0), mix(253.0, 238.0), mix(254.0, 243.0)]),
            Self::White => Colour([255; 3]),
        }
    }

    /// The colour of halos.
    pub fn halo(self) -> Colour {
        self.at(0.0)
    }
}
