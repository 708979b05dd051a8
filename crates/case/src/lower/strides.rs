//! How fast obstacles, supports and bodies are led through space, and how far within a time step.

use super::context::Context;
use crate::warning::{TIME_STEP, UNITS};
use nastic_language::number::short;
use nastic_language::quantity::Dimension;
use nastic_language::syntax::At;
use nastic_mesh::Mesh;

/// m/s; soft robots move by less than 1 m/s, and what is dropped on them from a metre by 4.4 m/s.
const FASTEST: f64 = 10.0;
/// An obstacle that moves by this share of the body's smallest side in a step may be within it before any contact has seen it.
const LONGEST: f64 = 0.25;

/// Where something moves, and what is said of it.
pub(super) struct Course<'c, 'd> {
    pub mesh: &'c Mesh,
    pub at: &'c At,
    pub context: &'c mut Context<'d>,
}

impl Course<'_, '_> {
    /// Of a component of a translation at the instants; only `obstacles` meet bodies.
    pub fn check(&mut self, instants: &[f64], values: &[f64], obstacles: bool) {
        let strides = values.windows(2).map(|pair| (pair[1] - pair[0]).abs());
        let steps = strides.zip(instants.windows(2).map(|pair| pair[1] - pair[0])).zip(instants);
        let (mut fastest, mut longest) = ((0.0f64, 0.0f64), (0.0f64, 0.0f64));
        for ((stride, dt), from) in steps {
            fastest = if stride / dt > fastest.0 { (stride / dt, *from) } else { fastest };
            longest = if stride > longest.0 { (stride, *from) } else { longest };
        }
        self.check_speed(fastest.0, "it moves with");
        if obstacles {
            self.check_stride(longest.0, &format!("it moves, from t = {} on,", short(longest.1)));
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

    /// Of a way within one time step.
    pub fn check_stride(&mut self, stride: f64, what: &str) {
        let side = self.mesh.size()[..self.mesh.dim()].iter().copied().fold(f64::INFINITY, f64::min);
        if stride > LONGEST * side {
            let unit = self.context.units.length().symbol;
            let message = format!(
                "{what} {} {unit} within one time step, where the body's smallest side has {} {unit}: contacts are seen at the ends of steps \
                 alone",
                short(format!("{stride:.3e}").parse().unwrap_or(stride)),
                short(side)
            );
            self.context.warn(&TIME_STEP, self.at, message);
        }
    }
}
