//! The z-buffer: nine samples per pixel, one layer per shape, layers laid over each other from far to near.

use super::colour::{Colour, Linear, mix, tint};
use super::scene::{Corner, Fill, Scene, Shape, Stroke};
use super::shade;
use super::vector::V3;
use rayon::prelude::*;

/// Pixels in linear light.
pub(super) struct Image {
    pub width: usize,
    pub height: usize,
    pub pixels: Vec<Linear>,
}

/// Samples per pixel along each direction.
const SAMPLES: usize = 3;
/// Rows of pixels rendered at a time: their samples of a few shapes fit a processor's cache.
const BAND: usize = 8;

pub(super) fn render(scene: &Scene, width: usize, height: usize) -> Image {
    let mut pixels = vec![[0.0; 3]; width * height];
    let extents: Vec<[f64; 2]> = scene.shapes.iter().map(extent).collect();
    pixels.par_chunks_mut(BAND * width).enumerate().with_max_len(1).for_each(|(band, pixels)| {
        let (first, rows) = (band * BAND, pixels.len() / width);
        let is_seen = |[low, high]: &[f64; 2]| *low <= (first + rows) as f64 && *high >= first as f64;
        let seen = scene.shapes.iter().zip(&extents).filter(|(_, extent)| is_seen(extent));
        let layers: Vec<Layer> = seen.map(|(shape, _)| Layer::of(scene, shape, width, first, rows)).collect();
        for (row, pixels) in pixels.chunks_mut(width).enumerate() {
            let behind = Colour(shade::background((first + row) as f64 / height as f64)).linear();
            for (column, out) in pixels.iter_mut().enumerate() {
                *out = pixel(&layers, row, column, width, behind);
            }
        }
    });
    Image { width, height, pixels }
}

/// The first and the last row of pixels that a shape may touch.
fn extent(shape: &Shape) -> [f64; 2] {
    let pieces = shape.pieces.iter().flatten().map(|corner| (corner.at[1], 1.0));
    let strokes = shape.strokes.iter().flat_map(|stroke| stroke.points.iter().map(|p| (p[1], 1.0 + stroke.width)));
    let none = [f64::INFINITY, f64::NEG_INFINITY];
    pieces.chain(strokes).fold(none, |[low, high], (y, margin)| [low.min(y - margin), high.max(y + margin)])
}

/// The mean of a pixel's samples.
fn pixel(layers: &[Layer], row: usize, column: usize, width: usize, behind: Linear) -> Linear {
    let places: [usize; SAMPLES * SAMPLES] =
        std::array::from_fn(|k| (row * SAMPLES + k / SAMPLES) * width * SAMPLES + column * SAMPLES + k % SAMPLES);
    // Most of a picture is background.
    if layers.iter().all(|layer| places.iter().all(|at| layer.samples[*at].z == f32::NEG_INFINITY)) {
        return behind;
    }
    let mut sum = [0.0; 3];
    for at in places {
        let sample = through(layers, at, behind);
        sum = std::array::from_fn(|k| sum[k] + sample[k]);
    }
    sum.map(|value| value / (SAMPLES * SAMPLES) as f32)
}

/// What is seen through all layers at one sample. Glass before an opaque body shows by its lines only: tinting would
/// falsify the colours, in patches where two surfaces nearly coincide.
fn through(layers: &[Layer], at: usize, behind: Linear) -> Linear {
    let mut colour = behind;
    let mut opaque = false;
    // Layers are few: pick the farthest one not yet laid down.
    let mut done = 0_u64;
    for _ in 0..layers.len().min(64) {
        let mut next: Option<usize> = None;
        for (index, layer) in layers.iter().enumerate().take(64) {
            let z = layer.samples[at].z;
            if done >> index & 1 == 0 && z > f32::NEG_INFINITY && next.is_none_or(|n| z < layers[n].samples[at].z) {
                next = Some(index);
            }
        }
        let Some(index) = next else { break };
        done |= 1 << index;
        let sample = &layers[index].samples[at];
        if !(sample.glass && opaque) {
            let mixed = if sample.glass { tint } else { mix };
            colour = mixed(colour, sample.colour, sample.opacity);
        }
        opaque |= layers[index].opaque;
    }
    colour
}

#[derive(Clone, Copy)]
struct Sample {
    /// Towards the eye; minus infinity where there is nothing.
    z: f32,
    opacity: f32,
    colour: Linear,
    /// Whether it is glass without a line on it.
    glass: bool,
}

/// One shape over one band of the picture.
struct Layer {
    samples: Vec<Sample>,
    /// Samples per row.
    width: usize,
    /// First row of samples, and how many.
    first: usize,
    rows: usize,
    opaque: bool,
}

impl Layer {
    fn of(scene: &Scene, shape: &Shape, width: usize, first: usize, rows: usize) -> Self {
        let (width, first, rows) = (width * SAMPLES, first * SAMPLES, rows * SAMPLES);
        let nothing = Sample { z: f32::NEG_INFINITY, opacity: 0.0, colour: [0.0; 3], glass: false };
        let opaque = matches!(shape.fill, Fill::Opaque(_) | Fill::Mapped);
        let mut layer = Self { samples: vec![nothing; width * rows], width, first, rows, opaque };
        let paint = Paint::new(scene, shape);
        for piece in &shape.pieces {
            for k in 2..piece.len() {
                let triangle = [piece[0], piece[k - 1], piece[k]];
                layer.triangle(&triangle.map(|corner| magnified(corner, shape.forward)), &paint);
            }
        }
        for stroke in &shape.strokes {
            layer.stroke(stroke, shape);
        }
        layer
    }

    fn triangle(&mut self, corners: &[Corner; 3], paint: &Paint) {
        let [a, b, c] = corners.map(|corner| corner.at);
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        // Pixels run down: what faces the eye is clockwise there.
        if area == 0.0 || !area.is_finite() || (paint.front_only && area > 0.0) {
            return;
        }
        for row in self.rows_within(a[1].min(b[1]).min(c[1]), a[1].max(b[1]).max(c[1])) {
            let y = (self.first + row) as f64 + 0.5;
            for column in self.columns_within(a[0].min(b[0]).min(c[0]), a[0].max(b[0]).max(c[0])) {
                let x = column as f64 + 0.5;
                let wb = ((x - a[0]) * (c[1] - a[1]) - (y - a[1]) * (c[0] - a[0])) / area;
                let wc = ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / area;
                let wa = 1.0 - wb - wc;
                if wa < 0.0 || wb < 0.0 || wc < 0.0 {
                    continue;
                }
                let weights = [wa, wb, wc];
                let mean =
                    |of: &dyn Fn(&Corner) -> f64| weights.iter().zip(corners).map(|(w, c)| w * of(c)).sum::<f64>();
                let z = mean(&|corner| corner.at[2]) as f32;
                let sample = &mut self.samples[row * self.width + column];
                if z > sample.z {
                    let normal: V3 = std::array::from_fn(|k| mean(&|corner| corner.normal[k]));
                    let (colour, opacity) = paint.at(normal, mean(&|corner| corner.value));
                    *sample = Sample { z, opacity, colour, glass: opacity < 1.0 };
                }
            }
        }
    }

    fn stroke(&mut self, stroke: &Stroke, shape: &Shape) {
        let lift = stroke.lift * SAMPLES as f64;
        let grown = |p: &V3| {
            let s = SAMPLES as f64;
            [p[0] * s, p[1] * s, (p[2] + shape.forward) * s + lift]
        };
        let colour = stroke.colour.linear();
        let radius = 0.5 * stroke.width * SAMPLES as f64;
        for (index, pair) in stroke.points.windows(2).enumerate() {
            let segment = Segment { a: grown(&pair[0]), b: grown(&pair[1]), radius, first: index == 0 };
            self.segment(&segment, colour, stroke.opacity, shape.fill == Fill::None);
        }
    }

    fn segment(&mut self, segment: &Segment, colour: Linear, opacity: f32, bare: bool) {
        let Segment { a, b, radius, .. } = *segment;
        for row in self.rows_within(a[1].min(b[1]) - radius, a[1].max(b[1]) + radius) {
            let y = (self.first + row) as f64 + 0.5;
            for column in self.columns_within(a[0].min(b[0]) - radius, a[0].max(b[0]) + radius) {
                let Some(z) = segment.depth_at(column as f64 + 0.5, y) else { continue };
                let sample = &mut self.samples[row * self.width + column];
                if z < sample.z {
                    continue;
                }
                // A sample inked before (by a joint of the same line) must not be inked twice.
                let inked = sample.z.is_finite() && sample.colour == colour;
                if bare || sample.z == f32::NEG_INFINITY {
                    if !inked || sample.opacity < opacity {
                        *sample = Sample { z, opacity, colour, glass: false };
                    }
                } else if !inked {
                    let share = opacity / (opacity + sample.opacity * (1.0 - opacity));
                    sample.colour = mix(sample.colour, colour, share);
                    sample.opacity = opacity + sample.opacity * (1.0 - opacity);
                    (sample.z, sample.glass) = (z, false);
                }
            }
        }
    }

    fn rows_within(&self, low: f64, high: f64) -> std::ops::Range<usize> {
        let first = self.first as f64;
        let start = (low - first - 0.5).ceil().clamp(0.0, self.rows as f64) as usize;
        let end = (high - first + 0.5).floor().clamp(0.0, self.rows as f64) as usize;
        start..end.max(start)
    }

    fn columns_within(&self, low: f64, high: f64) -> std::ops::Range<usize> {
        let start = (low - 0.5).ceil().clamp(0.0, self.width as f64) as usize;
        let end = (high + 0.5).floor().clamp(0.0, self.width as f64) as usize;
        start..end.max(start)
    }
}

/// A straight piece of a line, in samples.
struct Segment {
    a: V3,
    b: V3,
    radius: f64,
    /// Only the first piece has a round start: each joint belongs to the piece before it.
    first: bool,
}

impl Segment {
    /// Depth of the line where it covers the sample.
    fn depth_at(&self, x: f64, y: f64) -> Option<f32> {
        let along = [self.b[0] - self.a[0], self.b[1] - self.a[1]];
        let size = along[0] * along[0] + along[1] * along[1];
        let t = if size > 0.0 { ((x - self.a[0]) * along[0] + (y - self.a[1]) * along[1]) / size } else { 0.0 };
        if t < 0.0 && !self.first {
            return None;
        }
        let t = t.clamp(0.0, 1.0);
        let off = [x - self.a[0] - t * along[0], y - self.a[1] - t * along[1]];
        let near = off[0] * off[0] + off[1] * off[1] <= self.radius * self.radius;
        near.then_some((self.a[2] + t * (self.b[2] - self.a[2])) as f32)
    }
}

/// From pixels to samples.
fn magnified(corner: Corner, forward: f64) -> Corner {
    let s = SAMPLES as f64;
    Corner { at: [corner.at[0] * s, corner.at[1] * s, (corner.at[2] + forward) * s], ..corner }
}

/// What a shape looks like at a normal and a value.
struct Paint {
    fill: Fill,
    front_only: bool,
    shaded: bool,
    base: Linear,
    table: Vec<Linear>,
    range: (f64, f64),
}

impl Paint {
    fn new(scene: &Scene, shape: &Shape) -> Self {
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

    fn at(&self, normal: V3, value: f64) -> (Linear, f32) {
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
        self.table[(share * (last - 1) as f64).round() as usize]
    }
}
