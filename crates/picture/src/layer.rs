//! One shape over one band of the picture.

use super::colour::{Linear, mix};
use super::paint::Paint;
use super::raster::{BAND, SAMPLES};
use super::scene::{Fill, Scene, Shape, Stroke};
use super::triangle::{Span, Triangle};
use super::vector::V3;

/// A shape in samples, its triangles and lines sorted by the bands that they touch.
pub(super) struct Drawable<'a> {
    shape: &'a Shape,
    paint: Paint,
    triangles: Vec<Triangle<'a>>,
    segments: Vec<Segment>,
    bands: Vec<Band>,
}

/// What of a shape touches one band.
#[derive(Clone)]
struct Band {
    triangles: Vec<u32>,
    segments: Vec<u32>,
    /// First column of pixels that they may touch, and one behind the last.
    columns: [usize; 2],
}

#[derive(Clone, Copy)]
enum Kind {
    Triangle,
    Segment,
}

impl<'a> Drawable<'a> {
    pub fn new(scene: &Scene, shape: &'a Shape, width: usize, height: usize) -> Self {
        let paint = Paint::new(scene, shape);
        let mut out = Self {
            shape,
            triangles: Vec::new(),
            segments: Vec::new(),
            bands: vec![
                Band { triangles: Vec::new(), segments: Vec::new(), columns: [width, 0] };
                height.div_ceil(BAND)
            ],
            paint,
        };
        for piece in &shape.pieces {
            for k in 2..piece.len() {
                let corners = [&piece[0], &piece[k - 1], &piece[k]];
                let triangle = Triangle::new(corners, SAMPLES as f64, shape.forward, out.paint.front_only);
                if let Some(triangle) = triangle {
                    out.register(Kind::Triangle, out.triangles.len(), triangle.bounds(), width);
                    out.triangles.push(triangle);
                }
            }
        }
        for stroke in &shape.strokes {
            for index in 1..stroke.points.len() {
                let segment = Segment::new(stroke, index, shape.forward);
                out.register(Kind::Segment, out.segments.len(), segment.bounds(), width);
                out.segments.push(segment);
            }
        }
        out
    }

    /// Sorts what has these bounds (left, right, top and bottom in samples) into its bands.
    fn register(&mut self, kind: Kind, index: usize, [left, right, top, bottom]: [f64; 4], width: usize) {
        let pixel = |x: f64, most: usize| (x / SAMPLES as f64).clamp(0.0, most as f64) as usize;
        let most = BAND * self.bands.len();
        let rows = [pixel(top - 1.0, most), (pixel(bottom + 1.0, most) + 1).min(most)];
        let columns = [pixel(left - 1.0, width), (pixel(right + 1.0, width) + 1).min(width)];
        for band in &mut self.bands[rows[0] / BAND..rows[1].div_ceil(BAND)] {
            band.columns = [band.columns[0].min(columns[0]), band.columns[1].max(columns[1])];
            match kind {
                Kind::Triangle => band.triangles.push(index as u32),
                Kind::Segment => band.segments.push(index as u32),
            }
        }
    }
}

/// What a shape looks like at samples beside each other.
#[derive(Clone, Copy)]
pub(super) struct Fragment {
    pub opacity: f32,
    pub colour: Linear,
    /// Whether it is glass without a line on it.
    pub glass: bool,
}

#[derive(Clone, Copy)]
struct Sample {
    /// Towards the eye.
    z: f32,
    /// Of which fragment.
    fragment: u32,
}

/// No fragment.
const NONE: u32 = u32::MAX;
const NOTHING: Sample = Sample { z: f32::NEG_INFINITY, fragment: NONE };

/// What a shape shows of itself in a pixel.
pub(super) enum Seen<'a> {
    Nothing,
    /// One look at all samples.
    Whole(&'a Fragment),
    /// Several, or some samples without any.
    Part,
}

/// One shape over one band of the picture.
pub(super) struct Layer {
    pub opaque: bool,
    samples: Vec<Sample>,
    /// Whether it shows anything at a pixel.
    touched: Vec<bool>,
    fragments: Vec<Fragment>,
    /// First column of samples, and how many in a row.
    left: usize,
    width: usize,
    /// First row of samples, and how many.
    first: usize,
    rows: usize,
}

impl Layer {
    /// `None` if the shape does not touch the band.
    pub fn of(drawable: &Drawable, band: usize, rows: usize) -> Option<Self> {
        let Band { triangles, segments, columns } = &drawable.bands[band];
        let [left, right] = columns.map(|column| column * SAMPLES);
        if (triangles.is_empty() && segments.is_empty()) || left >= right {
            return None;
        }
        let fill = drawable.shape.fill;
        let (first, rows) = (band * BAND * SAMPLES, rows * SAMPLES);
        let mut layer = Self {
            opaque: matches!(fill, Fill::Opaque(_) | Fill::Mapped),
            samples: vec![NOTHING; (right - left) * rows],
            touched: vec![false; (right - left) / SAMPLES * (rows / SAMPLES)],
            fragments: Vec::new(),
            left,
            width: right - left,
            first,
            rows,
        };
        for index in triangles {
            layer.triangle(&drawable.triangles[*index as usize], &drawable.paint);
        }
        for index in segments {
            layer.segment(&drawable.segments[*index as usize], fill == Fill::None);
        }
        Some(layer)
    }

    /// The columns of pixels that it may touch.
    pub fn columns(&self) -> std::ops::Range<usize> {
        self.left / SAMPLES..(self.left + self.width) / SAMPLES
    }

    /// Depth and look at a sample of the band.
    pub fn at(&self, row: usize, column: usize) -> Option<(f32, &Fragment)> {
        let column = column.checked_sub(self.left).filter(|column| *column < self.width)?;
        let sample = self.samples[row * self.width + column];
        Some((sample.z, self.fragments.get(sample.fragment as usize)?))
    }

    /// What is seen at a pixel of the band.
    pub fn seen(&self, row: usize, column: usize) -> Seen<'_> {
        let Some(column) = (column * SAMPLES).checked_sub(self.left).filter(|column| *column < self.width) else {
            return Seen::Nothing;
        };
        if !self.touched[self.pixel(row * SAMPLES, column)] {
            return Seen::Nothing;
        }
        let first = self.samples[row * SAMPLES * self.width + column].fragment;
        for k in 0..SAMPLES {
            let samples = &self.samples[(row * SAMPLES + k) * self.width + column..][..SAMPLES];
            if samples.iter().any(|sample| sample.fragment != first) {
                return Seen::Part;
            }
        }
        self.fragments.get(first as usize).map_or(Seen::Nothing, Seen::Whole)
    }

    /// The pixel of a sample.
    fn pixel(&self, row: usize, column: usize) -> usize {
        row / SAMPLES * (self.width / SAMPLES) + column / SAMPLES
    }

    /// Every pixel is shaded once, at the first of its samples that the triangle covers.
    fn triangle(&mut self, triangle: &Triangle, paint: &Paint) {
        let [_, _, top, bottom] = triangle.bounds();
        let rows = self.rows_within(top, bottom);
        let mut shaded = Vec::new();
        for pixel_row in rows.start / SAMPLES..rows.end.div_ceil(SAMPLES) {
            let spans: [Span; SAMPLES] = std::array::from_fn(|k| {
                let row = pixel_row * SAMPLES + k;
                if rows.contains(&row) { triangle.span(self.first + row, self.left, self.width) } else { Span::EMPTY }
            });
            let start = spans.iter().map(|span| span.start).min().unwrap_or(0) / SAMPLES;
            let end = spans.iter().map(|span| span.end).max().unwrap_or(0).div_ceil(SAMPLES);
            // fragment by pixel
            shaded.clear();
            shaded.resize(end.saturating_sub(start), NONE);
            for (k, span) in spans.iter().enumerate().filter(|(_, span)| span.start < span.end) {
                let row = pixel_row * SAMPLES + k;
                let samples = &mut self.samples[row * self.width..][span.start..span.end];
                for (column, sample) in (span.start..).zip(samples) {
                    let z = span.depth_at(column) as f32;
                    if z > sample.z {
                        let fragment = &mut shaded[column / SAMPLES - start];
                        if *fragment == NONE {
                            let (normal, value) = triangle.look_at(self.first + row, self.left + column);
                            let (colour, opacity) = paint.at(normal, value);
                            *fragment = self.fragments.len() as u32;
                            self.fragments.push(Fragment { opacity, colour, glass: opacity < 1.0 });
                            self.touched[pixel_row * (self.width / SAMPLES) + column / SAMPLES] = true;
                        }
                        *sample = Sample { z, fragment: *fragment };
                    }
                }
            }
        }
    }

    /// `bare`: lines stand alone, on no surface.
    fn segment(&mut self, segment: &Segment, bare: bool) {
        let Segment { colour, opacity, .. } = *segment;
        let [_, _, top, bottom] = segment.bounds();
        let own = self.push(Fragment { opacity, colour, glass: false });
        // Samples beside each other have the same look before, and so after.
        let mut last = (own, own);
        for row in self.rows_within(top, bottom) {
            let y = (self.first + row) as f64 + 0.5;
            let [left, right] = segment.columns_at(y);
            for column in self.columns_within(left, right) {
                let Some(z) = segment.depth_at((self.left + column) as f64 + 0.5, y) else { continue };
                let sample = self.samples[row * self.width + column];
                if z < sample.z {
                    continue;
                }
                // A sample inked before (by a joint of the same line) must not be inked twice.
                let before = self.fragments.get(sample.fragment as usize).copied();
                let inked = before.filter(|before| before.colour == colour);
                let Some(before) = before.filter(|_| !bare) else {
                    if inked.is_none_or(|inked| inked.opacity < opacity) {
                        self.ink(row, column, Sample { z, fragment: own });
                    }
                    continue;
                };
                if inked.is_none() {
                    if last.0 != sample.fragment {
                        last = (sample.fragment, self.push(over(&before, colour, opacity)));
                    }
                    self.ink(row, column, Sample { z, fragment: last.1 });
                }
            }
        }
    }

    fn ink(&mut self, row: usize, column: usize, sample: Sample) {
        self.samples[row * self.width + column] = sample;
        let pixel = self.pixel(row, column);
        self.touched[pixel] = true;
    }

    fn push(&mut self, fragment: Fragment) -> u32 {
        self.fragments.push(fragment);
        self.fragments.len() as u32 - 1
    }

    fn rows_within(&self, low: f64, high: f64) -> std::ops::Range<usize> {
        within(low, high, self.first, self.rows)
    }

    fn columns_within(&self, low: f64, high: f64) -> std::ops::Range<usize> {
        within(low, high, self.left, self.width)
    }
}

/// A line of a colour over what was there.
fn over(before: &Fragment, colour: Linear, opacity: f32) -> Fragment {
    let both = opacity + before.opacity * (1.0 - opacity);
    Fragment { opacity: both, colour: mix(before.colour, colour, opacity / both), glass: false }
}

/// Those of `count` samples from `first` on whose centres lie between the bounds.
fn within(low: f64, high: f64, first: usize, count: usize) -> std::ops::Range<usize> {
    let first = first as f64;
    let start = (low - first - 0.5).ceil().clamp(0.0, count as f64) as usize;
    let end = (high - first + 0.5).floor().clamp(0.0, count as f64) as usize;
    start..end.max(start)
}

/// A straight piece of a line, in samples.
struct Segment {
    a: V3,
    along: V3,
    /// One over the square of its length in the picture.
    inverse: f64,
    radius: f64,
    /// Only the first piece has a round start: each joint belongs to the piece before it.
    first: bool,
    colour: Linear,
    opacity: f32,
}

impl Segment {
    /// The piece that ends at a point of the line.
    fn new(stroke: &Stroke, end: usize, forward: f64) -> Self {
        let scale = SAMPLES as f64;
        let sample = |p: &V3| [p[0] * scale, p[1] * scale, (p[2] + forward + stroke.lift) * scale];
        let [a, b] = [end - 1, end].map(|k| sample(&stroke.points[k]));
        let along: V3 = std::array::from_fn(|k| b[k] - a[k]);
        let size = along[0] * along[0] + along[1] * along[1];
        let inverse = if size > 0.0 { 1.0 / size } else { 0.0 };
        let radius = 0.5 * stroke.width * scale;
        Self { a, along, inverse, radius, first: end == 1, colour: stroke.colour.linear(), opacity: stroke.opacity }
    }

    fn bounds(&self) -> [f64; 4] {
        let of = |k: usize| {
            let ends = [self.a[k], self.a[k] + self.along[k]];
            [ends[0].min(ends[1]) - self.radius, ends[0].max(ends[1]) + self.radius]
        };
        let ([left, right], [top, bottom]) = (of(0), of(1));
        [left, right, top, bottom]
    }

    /// Left and right end of what it may cover at a height: within its width of the whole straight line, and its bounds.
    fn columns_at(&self, y: f64) -> [f64; 2] {
        let ([left, right, ..], [x, y]) = (self.bounds(), [self.a[0], y - self.a[1]]);
        let [across, down, _] = self.along;
        let [middle, half] = [y * across / down, self.radius * (across.hypot(down) / down).abs()];
        let strip = [x + middle - half - 1.0, x + middle + half + 1.0];
        // a level line has no strip
        if strip.iter().all(|end| end.is_finite()) { [left.max(strip[0]), right.min(strip[1])] } else { [left, right] }
    }

    /// Depth of the line where it covers the sample.
    fn depth_at(&self, x: f64, y: f64) -> Option<f32> {
        let Self { a, along, .. } = self;
        let t = ((x - a[0]) * along[0] + (y - a[1]) * along[1]) * self.inverse;
        if t < 0.0 && !self.first {
            return None;
        }
        let t = t.clamp(0.0, 1.0);
        let off = [x - a[0] - t * along[0], y - a[1] - t * along[1]];
        let near = off[0] * off[0] + off[1] * off[1] <= self.radius * self.radius;
        near.then_some((a[2] + t * along[2]) as f32)
    }
}
