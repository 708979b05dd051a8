//! What a shape looks like where it is seen.

use super::colour::Linear;
use super::scene::{Fill, Scene, Shape};
use super::shade;
use super::vector::V3;

/// The colours of a shape, by normal and value.
pub(super) struct Paint {
    fill: Fill,
    /// Whether backs are not seen.
    pub front_only: bool,
    shaded: bool,
    base: Linear,
    table: Vec<Linear>,
    range: (f64, f64),
}

impl Paint {
    pub fn new(scene: &Scene, shape: &Shape) -> Self {
        /// Colours of a map, between its ends.
        const ENTRIES: usize = 512;
        let base = match shape.fill {
            Fill::Opaque(colour) | Fill::Glass(colour) => colour.linear(),
            Fill::None | Fill::Mapped => [0.0; 3],
        };
        let (table, range) = match (&scene.bar, shape.fill) {
            (Some(bar), Fill::Mapped) => {
                let (low, high) = (bar.map.low, bar.map.high);
                let value = |k: usize| low + (high - low) * k as f64 / (ENTRIES - 1) as f64;
                let unknown = bar.map.colour(f64::NAN).linear();
                let known = (0..ENTRIES).map(|k| bar.map.colour(value(k)).linear());
                (known.chain([unknown]).collect(), (low, high))
            }
            _ => (Vec::new(), (0.0, 0.0)),
        };
        let front_only = !scene.plane && !shape.open && matches!(shape.fill, Fill::Glass(_));
        Self { fill: shape.fill, front_only, shaded: !scene.plane, base, table, range }
    }

    pub fn at(&self, normal: V3, value: f64) -> (Linear, f32) {
        let base = if self.fill == Fill::Mapped { self.mapped(value) } else { self.base };
        let colour = if self.shaded { shade::lit(base, normal) } else { base };
        let opacity = if matches!(self.fill, Fill::Glass(_)) { shade::glass(normal) } else { 1.0 };
        (colour, opacity)
    }

    fn mapped(&self, value: f64) -> Linear {
        let last = self.table.len() - 1;
        let (low, high) = self.range;
        if !value.is_finite() {
            return self.table[last];
        }
        let share = if high > low { ((value - low) / (high - low)).clamp(0.0, 1.0) } else { 0.5 };
        self.table[(share * (last - 1) as f64 + 0.5) as usize]
    }
}
