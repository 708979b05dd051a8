//! How fast obstacles, supports and bodies are led through space, and how far within a time step.

use super::context::Context;
use crate::warning::{STEPS_PER_CONTACT, UNITS};
use nastic_language::number::short;
use nastic_language::quantity::Dimension;
use nastic_language::schema::Shape;
use nastic_language::syntax::At;
use nastic_mesh::Mesh;
use nastic_numeric::vector::{norm, sub};

/// m/s; soft robots move by less than 1 m/s, and what is dropped on them from a metre by 4.4 m/s.
const FASTEST: f64 = 10.0;
/// An obstacle that moves in a step by this share of its own width and the body's smallest side together may be through the body before any contact has
/// seen it.
const LONGEST: f64 = 0.25;

/// Strides that differ by less are equal.
const EQUAL: f64 = 1e-9;

/// The least width of a shape that a body may be through; none of a half-space, and of a mesh.
pub(super) fn width(shape: &Shape) -> Option<f64> {
    match shape {
        Shape::Sphere(ball) => Some(2.0 * ball.radius),
        Shape::Capsule(capsule) => Some(2.0 * capsule.radius),
        Shape::Box(block) => {
            let [low, high] = block.corners();
            (0..3).map(|i| high[i] - low[i]).filter(|side| *side > 0.0).reduce(f64::min)
        }
        Shape::HalfSpace(_) | Shape::Mesh(_) => None,
    }
}

/// Where something moves, and what is said of it.
pub(super) struct Course<'c, 'd> {
    pub mesh: &'c Mesh,
    pub at: &'c At,
    pub context: &'c mut Context<'d>,
}

impl Course<'_, '_> {
    /// Of a translation at the instants; `width`: of an obstacle that bodies may be through, the least it has.
    pub fn check(&mut self, instants: &[f64], values: &[[f64; 3]], width: Option<f64>) {
        let strides = values.windows(2).map(|pair| norm(&sub(&pair[1], &pair[0])));
        let steps = strides.zip(instants.windows(2).map(|pair| pair[1] - pair[0])).zip(instants);
        let (mut fastest, mut longest) = ((0.0f64, 0.0f64), (0.0f64, 0.0f64));
        for ((stride, dt), from) in steps {
            fastest = if stride / dt > fastest.0 { (stride / dt, *from) } else { fastest };
            longest = if stride > longest.0 * (1.0 + EQUAL) { (stride, *from) } else { longest };
        }
        self.check_speed(fastest.0, "it moves with");
        if let Some(width) = width {
            self.check_stride(longest.0, width, &format!("it moves, first from t = {} on,", short(longest.1)));
        }
    }

    /// Of a velocity, in the case's units; what is said before it.
    pub fn check_speed(&mut self, speed: f64, what: &str) {
        let metres = self.context.units.in_si(speed, Dimension::VELOCITY);
        if metres > FASTEST {
            let message = format!(
                "{what} {} m/s: soft robots move by less than 1 m/s, what falls on them from a metre by 4.4 m/s; is the unit right?",
                short(format!("{metres:.3e}").parse().unwrap_or(metres))
            );
            self.context.warn(&UNITS, self.at, message);
        }
    }

    /// Of a way within one time step of what is so wide.
    pub fn check_stride(&mut self, stride: f64, width: f64, what: &str) {
        let side = width + self.mesh.size()[..self.mesh.dim()].iter().copied().fold(f64::INFINITY, f64::min);
        if stride > LONGEST * side {
            let unit = self.context.units.length().symbol;
            let message = format!(
                "{what} {} {unit} within one time step, where obstacle and body have {} {unit} together: contacts are seen at the ends of \
                 steps alone",
                short(format!("{stride:.3e}").parse().unwrap_or(stride)),
                short(side)
            );
            self.context.warn(&STEPS_PER_CONTACT, self.at, message);
        }
    }
}
