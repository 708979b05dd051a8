//! A flat triangle in samples: which of a row it covers, how deep, with what normal and value.

use super::scene::Corner;
use super::vector::V3;

/// Barycentric coordinates of a sample are linear in its place; so is its depth.
pub(super) struct Triangle<'a> {
    corners: [&'a Corner; 3],
    /// The first corner, in samples.
    origin: V3,
    /// Change of the second and the third coordinate to the right and downwards.
    slopes: [[f64; 2]; 2],
    /// Rise of the second and the third corner above the first towards the eye.
    rises: [f64; 2],
    bounds: [f64; 4],
}

impl<'a> Triangle<'a> {
    /// `scale` samples per pixel. `None` of a triangle without area, or one that shows its back where only fronts are seen.
    pub fn new(corners: [&'a Corner; 3], scale: f64, forward: f64, front_only: bool) -> Option<Self> {
        let sample = |corner: &Corner| [corner.at[0] * scale, corner.at[1] * scale, (corner.at[2] + forward) * scale];
        let [a, b, c] = corners.map(sample);
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        // Pixels run down: what faces the eye is clockwise there.
        if area == 0.0 || !area.is_finite() || (front_only && area > 0.0) {
            return None;
        }
        let slopes = [[(c[1] - a[1]) / area, -(c[0] - a[0]) / area], [-(b[1] - a[1]) / area, (b[0] - a[0]) / area]];
        let between = |k: usize| [a[k].min(b[k]).min(c[k]), a[k].max(b[k]).max(c[k])];
        let ([left, right], [top, bottom]) = (between(0), between(1));
        let bounds = [left, right, top, bottom];
        Some(Self { corners, origin: a, slopes, rises: [b[2] - a[2], c[2] - a[2]], bounds })
    }

    /// Left, right, top and bottom in samples.
    pub fn bounds(&self) -> [f64; 4] {
        self.bounds
    }

    /// The samples of a row that it covers, of `count` from `left` on; counted from there.
    pub fn span(&self, row: usize, left: usize, count: usize) -> Span {
        let down = row as f64 + 0.5 - self.origin[1];
        let [b, c] = self.slopes.map(|slope| [slope[0], slope[1] * down]);
        let a = [-(b[0] + c[0]), 1.0 - b[1] - c[1]];
        // Where all three coordinates are positive, measured from the first corner.
        let (mut low, mut high) = (self.bounds[0] - self.origin[0], self.bounds[1] - self.origin[0]);
        for [slope, start] in [a, b, c] {
            if slope > 0.0 {
                low = low.max(-start / slope);
            } else if slope < 0.0 {
                high = high.min(-start / slope);
            } else if start < 0.0 {
                return Span::EMPTY;
            }
        }
        // A sample stands in the middle of its column.
        let offset = left as f64 + 0.5 - self.origin[0];
        let start = (low - offset).ceil().clamp(0.0, count as f64) as usize;
        let end = (high - offset + 1.0).floor().clamp(0.0, count as f64) as usize;
        let [rise_b, rise_c] = self.rises;
        let step = b[0] * rise_b + c[0] * rise_c;
        let depth = self.origin[2] + b[1] * rise_b + c[1] * rise_c + step * offset;
        if start < end { Span { start, end, depth, step } } else { Span::EMPTY }
    }

    /// Normal and value at a sample.
    pub fn look_at(&self, row: usize, column: usize) -> (V3, f64) {
        let (right, down) = (column as f64 + 0.5 - self.origin[0], row as f64 + 0.5 - self.origin[1]);
        let [b, c] = self.slopes.map(|slope| slope[0] * right + slope[1] * down);
        let weights = [1.0 - b - c, b, c];
        let mean = |of: &dyn Fn(&Corner) -> f64| weights.iter().zip(self.corners).map(|(w, c)| w * of(c)).sum::<f64>();
        (std::array::from_fn(|k| mean(&|corner| corner.normal[k])), mean(&|corner| corner.value))
    }
}

/// The samples of a row that a triangle covers, and its depth there.
pub(super) struct Span {
    pub start: usize,
    pub end: usize,
    /// At column 0, and its change from column to column.
    depth: f64,
    step: f64,
}

impl Span {
    pub const EMPTY: Self = Self { start: usize::MAX, end: 0, depth: 0.0, step: 0.0 };

    pub fn depth_at(&self, column: usize) -> f64 {
        self.depth + self.step * column as f64
    }
}
